"""Functions that are put into expressions: each operation, with what the compiler would give.

Definitions are written in the compiler's form: numbered expressions, an operation each.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.calls import read_owners
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import ONE, Expr, UnsupportedError, apply, const, parameter
from axisrig.fmus.reading.functions import Functions

P, Q = parameter(0), parameter(1)


class Made:
    """A function of arguments whose results are the last expressions; call() gives its parts."""

    def __init__(self, shapes: Sequence[Sequence[int]] = ((),)) -> None:
        self.expressions: list[dict[str, Any]] = []
        self.folds: list[dict[str, Any]] = []
        self.definitions: list[dict[str, int]] = []
        self.domains: list[dict[str, Any]] = []
        self.types = [{"dimensions": list(shape), "scalar": "real"} for shape in shapes]
        self.statements: list[dict[str, Any]] = [{"kind": "assignment"}]
        self.external: dict[str, str] | None = None

    def add(self, kind: str, within: int | None = None, **operation: Any) -> int:
        made = {"operation": {"kind": kind, **operation}, "binder_domain": within}
        self.expressions.append(made)
        return len(self.expressions) - 1

    def real(self, value: float) -> int:
        return self.add("literal", value={"real": value})

    def argument(self, number: int = 0) -> int:
        place = {"kind": "function_parameter", "ordinal": number}
        return self.add("coordinate", coordinate=place)

    def binary(self, operator: str, left: int, right: int, domain: int | None = None) -> int:
        return self.add("binary", domain, operator=operator, lhs=left, rhs=right)

    def builtin(self, name: str, *arguments: int) -> int:
        return self.add("builtin", builtin=name, arguments=list(arguments))

    def define(self, number: int) -> int:
        self.definitions.append({"rhs": number})
        return len(self.definitions) - 1

    def call(self, results: Sequence[int], *registers: Expr) -> list[Expr]:
        starts, place = [], 0
        for kind in self.types:
            starts.append(place)
            place += math.prod(kind["dimensions"])
        return self.functions(results).call(0, dict(enumerate(registers)), starts)

    def functions(self, results: Sequence[int]) -> Functions:
        """The function alone, which call 0 means."""
        function = {
            "name": "f", "external": self.external, "statements": self.statements,
            "folds": self.folds, "definitions": self.definitions,
            "results": [self.define(each) for each in results],
            "parameter_types": list(range(len(self.types))),
        }  # fmt: skip
        ops = [{"kind": "PureCall", "owner": 0}]
        program = {"span": {"source": 1, "start": 0, "end": 2}, "ops": ops}
        provenance = {"span": {"source": 1, "start": 0, "end": 1}}
        call = {"operation": {"kind": "call", "function": 0}, "provenance": provenance,
                "variability": "continuous", "binder_domain": None}  # fmt: skip
        rest = {"provenance": {}, "variability": "constant"}
        plain = [{**each, **rest} for each in self.expressions]
        ir: Any = SimpleNamespace(
            dae={"functions": [function], "expressions": [*plain, call], "domains": self.domains,
                 "value_types": self.types},
            solve={"continuous": [program], "initialization": {"residual": {"nodes": []}}},
            files={},
        )  # fmt: skip
        return Functions(ir)


def values(parts: Sequence[Expr]) -> list[float]:
    assert all(part.kind == "const" for part in parts)
    return [part.value for part in parts]


@pytest.mark.parametrize(
    ("operator", "result"),
    [
        ("add", 8.0), ("subtract", 4.0), ("multiply", 12.0), ("divide", 3.0), ("less", 0.0),
        ("less_equal", 0.0), ("greater", 1.0), ("greater_equal", 1.0), ("equal", 0.0),
        ("not_equal", 1.0), ("and", 1.0), ("or", 1.0), ("elementwise_add", 8.0),
        ("elementwise_divide", 3.0),
    ],
)  # fmt: skip
def test_operators(operator: str, result: float) -> None:
    made = Made()
    assert values(made.call([made.binary(operator, made.real(6.0), made.real(2.0))], P)) == [result]


def test_unary_operators_and_unknown_ones() -> None:
    made = Made()
    whole = made.argument()
    results = [made.add("unary", operator=name, operand=whole) for name in ("negate", "plus")]
    assert made.call(results, P) == [apply("Neg", P), P]
    made = Made()
    one = made.real(1.0)
    for number in (
        made.add("unary", operator="turn", operand=one),
        made.binary("turn", one, one),
        made.add("literal", value={"string": "x"}),
        made.builtin("inverse", one),
        made.add("coordinate", coordinate={"kind": "state"}),
        made.add("miracle"),
    ):
        with pytest.raises(UnsupportedError):
            made.call([number], P)


@pytest.mark.parametrize(
    ("name", "numbers", "result"),
    [
        ("sum", [1.0, 2.0, 4.0], 7.0), ("product", [1.5, 2.0, 4.0], 12.0),
        ("min", [3.0, -2.0, 4.0], -2.0), ("max", [3.0, -2.0, 4.0], 4.0), ("sum", [], 0.0),
        # 0 and 1 are no elements
        ("min", [3.0, 2.0, 4.0], 2.0), ("max", [-3.0, -2.0, -4.0], -2.0), ("min", [5.0], 5.0),
        ("product", [], 1.0), ("size", [1.0, 2.0], 2.0),
    ],
)  # fmt: skip
def test_functions_of_one_array(name: str, numbers: list[float], result: float) -> None:
    made = Made()
    array = made.add("array", elements=[made.real(each) for each in numbers])
    assert values(made.call([made.builtin(name, array)], P)) == [result]


@pytest.mark.parametrize(
    ("name", "arguments", "result"),
    [
        ("min", (3.0, 2.0), 2.0), ("max", (3.0, 2.0), 3.0), ("mod", (-7.5, 2.0), 0.5),
        ("abs", (-2.0,), 2.0), ("sign", (-2.0,), -1.0), ("floor", (-1.5,), -2.0),
        ("ceil", (-1.5,), -1.0), ("integer", (-1.5,), -2.0), ("no_event", (5.0,), 5.0),
        ("smooth", (0.0, 5.0), 5.0), ("homotopy", (5.0, 6.0), 5.0), ("scalar", (5.0,), 5.0),
        ("div", (-7.0, 2.0), -3.0), ("rem", (-7.0, 2.0), -1.0),
    ],
)  # fmt: skip
def test_functions_of_numbers(name: str, arguments: tuple[float, ...], result: float) -> None:
    made = Made()
    number = made.builtin(name, *(made.real(each) for each in arguments))
    assert values(made.call([number], P)) == [result]


def test_arguments_of_any_shape_come_one_after_the_other() -> None:
    """f(scalar, vector of 2, matrix 2 x 3): registers in that order."""
    made = Made([(), (2,), (2, 3)])
    registers = [const(float(n)) for n in range(1, 10)]
    vector, matrix = made.argument(1), made.argument(2)
    one = {"kind": "index", "expression": made.real(2.0)}
    results = [
        made.argument(0),
        made.add("index", base=vector, subscripts=[one]),
        made.add("index", base=matrix, subscripts=[one, {"kind": "colon"}]),
        made.binary("multiply", vector, matrix),
        made.binary("elementwise_multiply", vector, vector),
        made.builtin("size", matrix, made.real(2.0)),
        made.builtin("size", matrix),
    ]
    found = values(made.call(results, *registers))
    assert found == [1, 3, 7, 8, 9, 2 * 4 + 3 * 7, 2 * 5 + 3 * 8, 2 * 6 + 3 * 9, 4, 9, 3, 2, 3]
    with pytest.raises(UnsupportedError, match="with other arguments"):
        Functions.call(_functions(made), 0, {}, [0])
    power = Made([(2, 2)])
    with pytest.raises(UnsupportedError, match="power of a matrix"):
        power.call([power.binary("power", power.argument(), power.real(2.0))], *registers[:4])
    other = Made([(2,)])
    with pytest.raises(UnsupportedError, match="subscript of the kind"):
        other.call([other.add("index", base=other.argument(), subscripts=[{"kind": "end"}])], P, Q)


def _functions(made: Made) -> Functions:
    found: Any = Functions.__new__(Functions)
    found._functions = [{"name": "f", "parameter_types": [0, 1, 2]}]
    found._owners, found._types = {0: 0}, made.types
    return found  # type: ignore[no-any-return]


def test_a_choice_is_made_at_once_where_it_can_be() -> None:
    """The first condition that holds; what no condition can choose is not evaluated."""
    made = Made()
    hole = made.add("miracle")  # has no meaning: evaluating it is an error
    yes, no = (
        made.add("literal", value={"boolean": True}),
        made.add("literal", value={"boolean": False}),
    )
    moving = made.binary("less", made.argument(), made.real(3.0))
    one, two, three = (made.real(float(n)) for n in (1, 2, 3))
    found = made.call(
        [
            made.add("conditional", operands=[no, hole, yes, two, yes, hole, hole]),
            made.add("conditional", operands=[no, hole, three]),
            made.add("conditional", operands=[moving, one, yes, two, hole]),
            made.add("conditional", operands=[moving, one, moving, two, three]),
        ],
        P,
    )  # fmt: skip
    less = apply("Lt", P, const(3.0))
    assert found[:2] == [const(2.0), const(3.0)]
    assert found[2] is apply("Select", less, ONE, const(2.0))
    assert found[3] is apply("Select", less, ONE, apply("Select", less, const(2.0), const(3.0)))


@pytest.mark.parametrize(
    ("start", "stop", "step", "numbers"),
    [(1, 4, None, [1, 2, 3, 4]), (1, 0, None, []), (5, 1, -2, [5, 3, 1]), (1, 6, 2, [1, 3, 5]),
     (0.0, 0.3, 0.1, [0.0, 0.1, 0.2, 0.3]), (2, 2, None, [2])],
)  # fmt: skip
def test_a_range(start: float, stop: float, step: float | None, numbers: list[float]) -> None:
    made = Made()
    given = {
        "start": {"value": start}, "stop": {"value": stop},
        "explicit_step": None if step is None else {"value": step},
    }  # fmt: skip
    assert values(made.call([made.add("range", **given)], P)) == pytest.approx(numbers)


def domain(*binders: tuple[int, int, int]) -> dict[str, Any]:
    lengths = [len(range(a, b + (1 if s > 0 else -1), s)) for a, b, s in binders]
    made = [{"lower": a, "upper": b, "step": s} for a, b, s in binders]
    return {"domain": {"binders": made}, "extents": lengths}


@pytest.mark.parametrize(
    ("binders", "numbers"),
    [
        ([(1, 3, 1)], [10, 20, 30]),
        ([(3, 1, -1)], [30, 20, 10]),
        ([(1, 5, 2)], [10, 30, 50]),
        ([(1, 2, 1), (5, 6, 1)], [10, 10, 20, 20]),
    ],
)
def test_an_array_by_a_formula(binders: list[tuple[int, int, int]], numbers: list[float]) -> None:
    """{10*i for i in ...}: the last of several runs fastest."""
    made = Made()
    made.domains = [domain(*binders)]
    i = made.add("coordinate", 0, coordinate={"kind": "binder", "domain": 0, "ordinal": 0})
    body = made.binary("multiply", made.real(10.0), i, 0)
    array = made.add("comprehension", domain=0, body=body)
    assert values(made.call([array, made.builtin("size", array)], P)) == [
        *numbers, *made.domains[0]["extents"],
    ]  # fmt: skip


def test_a_loop_carries_its_variables() -> None:
    """s := 1; t := 0; for i in 1:4 loop t := t + s; s := s*i; end for: 24 and 1 + 1 + 2 + 6."""
    made = Made()
    made.domains = [domain((1, 4, 1))]
    made.statements = [{"kind": "for", "statements": [{"kind": "assignment"}]}]
    i = made.add("coordinate", 0, coordinate={"kind": "binder", "domain": 0, "ordinal": 0})
    s, t = (made.add("function_fold_parameter", 0, fold=0, carried=k) for k in (0, 1))
    initial = [made.define(made.real(1.0)), made.define(made.real(0.0))]
    updates = [
        made.define(made.binary("multiply", s, i, 0)),
        made.define(made.binary("add", t, s, 0)),
    ]
    made.folds = [{"ordinal": 0, "domain": 0, "initial_definitions": initial,
                   "update_definitions": updates, "parameter_definitions": []}]  # fmt: skip
    out = [made.add("function_fold_output", function=0, fold=0, carried=k) for k in (0, 1)]
    assert values(made.call(out, P)) == [24.0, 10.0]


def test_what_has_no_meaning_here_is_refused_with_its_name() -> None:
    for statements in ([{"kind": "while"}], [{"kind": "for", "statements": [{"kind": "return"}]}]):
        made = Made()
        made.statements = statements
        with pytest.raises(UnsupportedError, match="a statement in the function f"):
            made.call([made.argument()], P)
    made = Made()
    again = made.add("call", function=0, output=0, arguments=[made.argument()])
    with pytest.raises(UnsupportedError, match="calls itself"):
        made.call([again], P)
    made = Made()
    with pytest.raises(UnsupportedError, match="one element of an array"):
        made.call([made.add("array_update")], P)
    made = Made()
    with pytest.raises(UnsupportedError, match="outside its loop"):
        made.call([made.add("function_fold_parameter", fold=0, carried=0)], P)


def test_records_have_their_fields_in_order() -> None:
    made = Made()
    record = made.add("record", fields=[made.real(4.0), made.argument(), made.real(6.0)])
    fields = [made.add("field", base=record, field=n) for n in (1, 2, 0)]
    assert made.call(fields, P) == [P, const(6.0), const(4.0)]


# --- which function a call means


def pure_call(number: int) -> dict[str, Any]:
    return {"kind": "PureCall", "owner": number}


def owners(calls: Sequence[tuple[int, int, int]], programs: Any, text: str = "") -> dict[int, int]:
    """calls: start, end, function in the text. programs: span of an equation; numbers of calls,
    or operations.
    """
    named = [
        {"operation": {"kind": "call", "function": function}, "variability": "continuous",
         "provenance": {"span": {"source": 1, "start": start, "end": end}}}
        for start, end, function in calls
    ]  # fmt: skip
    made = [
        {"span": {"source": 1, "start": span[0], "end": span[1]},
         "ops": [pure_call(each) if isinstance(each, int) else each for each in ops]}
        for span, ops in programs
    ]  # fmt: skip
    ir: Any = SimpleNamespace(
        dae={"expressions": named},
        solve={"continuous": made, "initialization": {"residual": {"nodes": []}}},
        files={1: (Path("M.mo"), text)},
        error=lambda _span, message: BuildError("M", None, message),
    )
    return read_owners(ir)


def test_calls_of_one_equation_are_numbered_in_the_order_of_the_text() -> None:
    calls = [(20, 25, 7), (10, 15, 5), (40, 45, 9)]
    assert owners(calls, [((5, 30), [4, 3]), ((35, 50), [1])]) == {3: 5, 4: 7, 1: 9}
    # Both ends of a span are in it, and of one function every call is
    assert owners([(10, 15, 5), (20, 25, 5)], [((10, 25), [1, 2, 3])]) == {1: 5, 2: 5, 3: 5}
    with pytest.raises(BuildError, match="several functions in one equation"):
        owners(calls, [((5, 30), [1, 2, 3])])
    with pytest.raises(BuildError, match="several functions in one equation"):
        owners([(10, 15, 5), (10, 15, 6)], [((5, 30), [1])])


def test_calls_in_a_branch_are_those_of_its_condition_its_result_and_its_end() -> None:
    """y = if f() then g() else if g2() then h() else k(): every part calls another one."""
    calls = [(10 * number, 10 * number + 5, 30 + number) for number in range(1, 6)]
    programs = [{"ops": [pure_call(number)]} for number in range(1, 6)]
    branch = {
        "kind": "FunctionConditional",
        "arms": [
            {"condition": programs[0], "result": programs[1]},
            {"condition": programs[2], "result": programs[3]},
        ],
        "fallback": programs[4],
    }
    known = {number: 30 + number for number in range(1, 6)}
    assert owners(calls, [((0, 60), [branch])]) == known
    inside = {"kind": "FunctionConditional", "arms": [], "fallback": {"ops": [branch]}}
    calls.append((61, 65, 36))
    assert owners(calls, [((0, 70), [inside, 6])]) == known | {6: 36}


def test_a_name_alone_stands_for_the_statement_around_it() -> None:
    """The span of a when-clause is its variable: its call is before the semicolon."""
    text = "when c then a = f(1); b = g(2); for i in 1:2 loop v[i] = h(i); end for; end when;"
    place = {name: text.index(f"{name}(") for name in "fgh"}
    calls = [(at, at + 4, number) for number, at in enumerate(place.values(), 5)]
    spans = [(text.index(word), text.index(word) + 1) for word in ("a =", "b =", "v[")]
    programs = [(span, [number]) for number, span in enumerate(spans)]
    assert owners(calls, programs, text) == {0: 5, 1: 6, 2: 7}
