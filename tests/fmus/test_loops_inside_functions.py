"""Functions with loops in loops, with records, calling each other: values worked out by hand."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_function_operations import Made, P, Q, domain, pure_call, values

from axisrig.fmus.reading.expressions import Expr, UnsupportedError, apply, const
from axisrig.fmus.reading.functions import Functions


def binder(made: Made, of_domain: int, number: int = 0, within: int | None = None) -> int:
    """A loop variable. within: the loop that it is read in, its own without."""
    place = {"kind": "binder", "domain": of_domain, "ordinal": number}
    return made.add("coordinate", of_domain if within is None else within, coordinate=place)


def carried(made: Made, fold: int, number: int, within: int) -> int:
    return made.add("function_fold_parameter", within, fold=fold, carried=number)


def fold(
    made: Made,
    of_domain: int,
    *variables: tuple[int, int],
    parameters: Sequence[int] = (),
    within: int | None = None,
) -> list[int]:
    """A loop; variables: what each begins with and what becomes of it. Returns its outputs."""
    number = len(made.folds)
    made.folds.append({
        "ordinal": number, "domain": of_domain,
        "initial_definitions": [made.define(first) for first, _ in variables],
        "update_definitions": [made.define(update) for _, update in variables],
        "parameter_definitions": list(parameters),
    })  # fmt: skip
    return [
        made.add("function_fold_output", within, function=0, fold=number, carried=k)
        for k in range(len(variables))
    ]


# Loops


def test_an_array_of_arrays_has_the_variables_of_both_loops() -> None:
    """{{10 i + j for j in 1:3} for i in 1:2}: the outer one first, and its size first."""
    made = Made()
    made.domains = [domain((1, 2, 1)), domain((1, 3, 1))]
    ten = made.binary("multiply", made.real(10.0), binder(made, 0), 0)
    inner = made.add("comprehension", 0, domain=1, body=made.binary("add", ten, binder(made, 1), 1))
    array = made.add("comprehension", domain=0, body=inner)
    found = values(made.call([array, made.builtin("size", array)], P))
    assert found == [11, 12, 13, 21, 22, 23, 2, 3]


def test_each_variable_of_a_loop_over_two_is_its_own() -> None:
    """{10 i + j for i in 1:2, j in 5:6} and {i - j ...}."""
    made = Made()
    made.domains = [domain((1, 2, 1), (5, 6, 1))]
    i, j = (binder(made, 0, number) for number in (0, 1))
    ten = made.binary("multiply", made.real(10.0), i, 0)
    sums = made.add("comprehension", domain=0, body=made.binary("add", ten, j, 0))
    ways = made.add("comprehension", domain=0, body=made.binary("subtract", i, j, 0))
    found = values(made.call([sums, ways], P))
    assert found == [15, 16, 25, 26, -4, -5, -3, -4]


def test_two_loops_in_a_row_have_results_of_their_own() -> None:
    """s = 0 + 1 + 2 + 3, then p = 1 * 2 * 2 * 2 * 2 beside t = s + p - 16 in each pass."""
    made = Made()
    made.domains = [domain((1, 3, 1)), domain((1, 4, 1))]
    s = made.binary("add", carried(made, 0, 0, 0), binder(made, 0), 0)
    (total,) = fold(made, 0, (made.real(0.0), s))
    twice = made.binary("multiply", carried(made, 1, 0, 1), made.real(2.0), 1)
    more = made.binary("add", carried(made, 1, 1, 1), total, 1)
    outputs = fold(made, 1, (made.real(1.0), twice), (made.real(0.5), more))
    assert values(made.call([total, *outputs], P)) == [6.0, 16.0, 24.5]


@pytest.mark.parametrize("within", [0, 1])
@pytest.mark.parametrize("passes", [0, 1, 3])
def test_a_loop_in_a_loop_begins_anew_in_each_pass_and_reads_what_the_outer_one_carries(
    passes: int, within: int
) -> None:
    """s = 1; for i in 1:n loop t = s; for j in 1:2 loop t = t + s*j; end for; s = t; end for.

    In each pass t = s + s + 2 s. within: the loop in which the inner one reads s.
    """
    made = Made()
    made.domains = [domain((1, passes, 1)), domain((1, 2, 1))]
    outer = carried(made, 0, 0, 0)
    step = made.binary("multiply", carried(made, 0, 0, within), binder(made, 1), 1)
    made.folds.append({})
    (inner,) = fold(made, 1, (outer, made.binary("add", carried(made, 1, 0, 1), step, 1)), within=0)
    (_, plan) = made.folds
    made.folds[0] = {
        "ordinal": 0, "domain": 0, "initial_definitions": [made.define(made.real(1.0))],
        "update_definitions": [made.define(inner)], "parameter_definitions": [],
    }  # fmt: skip
    assert plan["ordinal"] == 1
    result = made.add("function_fold_output", function=0, fold=0, carried=0)
    assert values(made.call([result], P)) == [4.0**passes]


def test_a_definition_is_its_expression_or_what_a_loop_carries_under_its_number() -> None:
    """a = 3 p; then s, u = 1, 10 with s = s + a, u = u - s in two passes.

    Inside the loop the compiler names both by the numbers of definitions.
    """
    made = Made()
    made.domains = [domain((1, 2, 1))]
    plain = made.define(made.binary("multiply", made.real(3.0), made.argument()))
    names = [made.define(made.add("miracle")) for _ in range(2)]
    a, s, u = (
        made.add("function_value", within, function=0, definition=number)
        for within, number in ((None, plain), (0, names[0]), (0, names[1]))
    )
    outputs = fold(
        made, 0,
        (made.real(1.0), made.binary("add", s, a, 0)),
        (made.real(10.0), made.binary("subtract", u, s, 0)),
        parameters=names,
    )  # fmt: skip
    found = made.call([*outputs, a], const(5.0))
    assert values(found) == [31.0, 10.0 - 1.0 - 16.0, 15.0]


def test_a_loop_variable_outside_its_loop_is_refused() -> None:
    for number in range(3):
        made = Made()
        made.domains = [domain((1, 2, 1)), domain((1, 3, 1))]
        if number == 0:
            wrong = binder(made, 0)
        elif number == 1:  # it is read in another loop
            wrong = made.add("comprehension", domain=0, body=binder(made, 1))
        else:
            body = made.binary("add", made.real(1.0), made.real(2.0), 1)
            wrong = made.add("comprehension", domain=0, body=body)
        with pytest.raises(UnsupportedError, match="a loop variable outside its loop"):
            made.call([wrong], P)


# Arguments, arrays, records


def test_a_type_may_be_that_of_another_one() -> None:
    made = Made()
    made.types = [
        {"value_type": {"dimensions": [2], "scalar": "real"}, "scalar": "record"},
        {"dimensions": [], "scalar": "real"},
    ]
    array, number = made.argument(0), made.argument(1)
    starts = [0, 2]
    found = made.functions([array, number]).call(0, {0: P, 1: Q, 2: const(5.0)}, starts)
    assert found == [P, Q, const(5.0)]
    for kind in (
        {"value_type": {"dimensions": [], "scalar": "record"}},
        {"dimensions": [], "scalar": "record"},
    ):
        made.types = [kind]
        with pytest.raises(UnsupportedError, match=r"^a record as argument of f$"):
            made.functions([number]).call(0, {0: P}, [0])


def test_powers_by_element_and_sizes_of_nested_arrays() -> None:
    made = Made()
    rows = [made.add("array", elements=[made.real(float(k + 3 * row)) for k in (1, 2, 3)])
            for row in (0, 1)]  # fmt: skip
    matrix = made.add("array", elements=rows)
    square = made.binary("elementwise_power", rows[0], made.real(2.0))
    found = made.call([made.builtin("size", matrix), matrix, square], P)
    assert values(found[:8]) == [2, 3, 1, 2, 3, 4, 5, 6]
    assert found[8:] == [apply("Pow", const(k), const(2.0)) for k in (1.0, 2.0, 3.0)]


def test_parts_of_a_matrix_keep_their_rows_first() -> None:
    """m = (1 2 3; 4 5 6): all of it, the columns 1 and 3, and the second row."""
    made = Made([(2, 3)])
    matrix, every = made.argument(), {"kind": "colon"}
    ends = made.add("array", elements=[made.real(1.0), made.real(3.0)])
    some = {"kind": "index", "expression": ends}
    second = {"kind": "index", "expression": made.real(2.0)}
    for subscripts, expected, size in (
        ([every, every], [1, 2, 3, 4, 5, 6], [2, 3]),
        ([every], [1, 2, 3, 4, 5, 6], [2, 3]),
        ([every, some], [1, 3, 4, 6], [2, 2]),
        ([some, every][::-1], [1, 3, 4, 6], [2, 2]),
        ([second, every], [4, 5, 6], [3]),
        ([second], [4, 5, 6], [3]),
        ([every, second], [2, 5], [2]),
    ):
        part = made.add("index", base=matrix, subscripts=subscripts)
        numbers = [const(float(n)) for n in range(1, 7)]
        found = values(made.call([part, made.builtin("size", part)], *numbers))
        assert found == [*expected, *size]


def test_a_record_with_any_array_is_refused() -> None:
    for place in (0, 1, 2):
        made = Made()
        array = made.add("array", elements=[made.real(1.0), made.real(2.0)])
        fields = [array if k == place else made.real(float(k)) for k in range(3)]
        with pytest.raises(UnsupportedError, match="a record with arrays"):
            made.call([made.add("record", fields=fields)], P)


@pytest.mark.parametrize(
    ("kind", "operation", "words"),
    [
        ("builtin", {"builtin": "inverse", "arguments": []}, r"inverse\(\) in a function"),
        ("unary", {"operator": "turn", "operand": 0}, "the operator turn in a function"),
        ("binary", {"operator": "elementwise_turn", "lhs": 0, "rhs": 0}, "the operator turn in"),
        ("coordinate", {"coordinate": {"kind": "state"}}, "^state in a function"),
        ("literal", {"value": {"string": "x"}}, "^a string in a function"),
        ("miracle", {}, "^miracle in a function"),
    ],
)
def test_what_has_no_meaning_is_named(kind: str, operation: dict[str, Any], words: str) -> None:
    made = Made()
    made.real(1.0)
    with pytest.raises(UnsupportedError, match=words):
        made.call([made.add(kind, **operation)], P)


def test_an_external_function_is_named_before_anything_in_it() -> None:
    for external in ({"language": "C"}, {}):
        made = Made()
        made.external, made.statements = external, [{"kind": "while"}]
        with pytest.raises(UnsupportedError, match=r"^the external function f$"):
            made.call([made.argument()], P)


# Functions that call each other


def several(made: Made, *results: Sequence[int]) -> Functions:
    """Functions f, g, h of one number, by their results; call n is that of function n."""
    functions = [
        {"name": name, "external": None, "statements": [], "folds": [],
         "definitions": made.definitions, "results": [made.define(one) for one in each],
         "parameter_types": [0]}
        for name, each in zip("fgh", results, strict=False)
    ]  # fmt: skip
    rest = {"provenance": {}, "variability": "constant"}
    spans = [{"source": 1, "start": 10 * n, "end": 10 * n + 5} for n in range(len(functions))]
    calls = [
        {"operation": {"kind": "call", "function": n}, "provenance": {"span": span},
         "variability": "continuous", "binder_domain": None}
        for n, span in enumerate(spans)
    ]  # fmt: skip
    programs = [{"span": span, "ops": [pure_call(n)]} for n, span in enumerate(spans)]
    ir: Any = SimpleNamespace(
        dae={"functions": functions, "domains": made.domains, "value_types": made.types,
             "expressions": [*({**one, **rest} for one in made.expressions), *calls]},
        solve={"continuous": programs, "initialization": {"residual": {"nodes": []}}},
        files={},
    )  # fmt: skip
    return Functions(ir)


def test_a_call_takes_the_result_that_is_meant_for_its_own_arguments() -> None:
    """g(x) = (x + 1, 10 x); f(x) = (g.2(x), g.1(2 x), g.2(2 x))."""
    made = Made()
    x = made.argument()
    twice = made.binary("multiply", made.real(2.0), x)
    of_g = [made.binary("add", x, made.real(1.0)), made.binary("multiply", made.real(10.0), x)]
    calls = [
        made.add("call", function=1, output=output, arguments=[argument])
        for output, argument in ((1, x), (0, twice), (1, twice))
    ]
    known = several(made, calls, of_g)
    assert values(known.call(0, {0: const(3.0)}, [0])) == [30.0, 7.0, 60.0]
    assert values(known.call(1, {0: const(3.0)}, [0])) == [4.0, 30.0]


def test_functions_that_call_each_other_in_a_circle_are_refused_by_their_name() -> None:
    made = Made()
    x = made.argument()
    to_g, to_h, to_f = (made.add("call", function=n, output=0, arguments=[x]) for n in (1, 2, 0))
    for start, name in enumerate("fgh"):
        with pytest.raises(UnsupportedError, match=f"the function {name}, which calls itself"):
            several(made, [to_g], [to_h], [to_f]).call(start, {0: P}, [0])
    twice = made.binary("add", to_h, to_h)
    found: list[Expr] = several(made, [twice], [x], [x]).call(0, {0: P}, [0])
    assert found == [Expr("Add", (P, P))], "one that is called again after its end is no circle"
