"""The bodies of functions of a C source do what their equations say, in the order that is needed.

Assignments of C are those of Python too: a body is run with y, p and t.
"""

import re
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations.actions import Action
from axisrig.fmus.equations.clocks import Schedule
from axisrig.fmus.equations.sorting import Block
from axisrig.fmus.equations.system import Assignment
from axisrig.fmus.reading.expressions import ONE, Expr, apply, const, parameter, variable
from axisrig.fmus.reading.ir import Source
from axisrig.fmus.writing.source import _row, _Source
from axisrig.fmus.writing.variables import Variable

GUARD = ["if (!with_whens) {", "return 0;", "}"]


def source(**given: Any) -> _Source:
    empty = {name: [] for name in (
        "derivatives", "algebraics", "initial", "runtime", "updates", "whens", "conditions",
        "previous", "relations", "actions", "reinits", "schedules", "blocks",
    )}  # fmt: skip
    ir: Any = SimpleNamespace(solve={"layout": {"bindings": {}}})
    system: Any = SimpleNamespace(**(empty | {"state_count": 0} | given))
    return _Source(ir, system)


def lines_of(body: str) -> list[str]:
    return [re.sub(r"/\*.*?\*/", "", line).strip() for line in body.splitlines()]


def run(body: str, p: Sequence[float], y: Sequence[float] = (), **known: Any) -> list[float]:
    """p after a body; with_whens: as the C function is called."""
    with_whens = known.pop("with_whens", True)
    held: dict[str, Any] = {"p": list(p), "y": list(y), "t": 2.0, **known}
    lines = lines_of(body)
    at = next((n for n, line in enumerate(lines) if line == GUARD[0]), None)
    if at is not None:
        assert lines[at : at + 3] == GUARD
        lines = lines[:at] + (lines[at + 3 :] if with_whens else [])
    for line in lines:
        if line not in ("{", "}"):
            exec(line.removeprefix("const double ").rstrip(";"), {}, held)
    return list(held["p"])


def row(index: int, value: Expr, vector: str = "p", place: Source | None = None) -> Assignment:
    return Assignment(vector, index, value, place)


def plus(slot: int, number: float) -> Expr:
    return apply("Add", parameter(slot), const(number))


# Discrete equations


@pytest.mark.parametrize("updates", [0, 1, 2, 3])
@pytest.mark.parametrize("whens", [0, 1, 2, 3])
@pytest.mark.parametrize("with_whens", [True, False])
def test_equations_of_when_clauses_are_stored_where_these_act_and_all_others_always(
    updates: int, whens: int, with_whens: bool
) -> None:
    """However many there are of both: v := v + 10 in slot v, when-clauses come last."""
    count = updates + whens
    rows = [row(slot, plus(slot, 10.0)) for slot in range(count)]
    body = source(updates=rows[:updates], whens=rows[updates:]).updates()
    stored = count if with_whens else updates
    found = run(body, [float(slot) for slot in range(count)], with_whens=with_whens)
    assert found == [slot + (10.0 if slot < stored else 0.0) for slot in range(count)]
    assert (GUARD[0] in body) is (whens > 0)


def test_all_values_are_of_before_the_first_store() -> None:
    """Two that take over from each other, and a when-clause that reads both."""
    updates = [row(0, parameter(1)), row(1, parameter(0))]
    whens = [row(2, apply("Sub", parameter(0), parameter(1)))]
    assert run(source(updates=updates, whens=whens).updates(), [3.0, 5.0, 0.0]) == [5.0, 3.0, -2.0]


def test_conditions_and_new_values_of_states_are_of_one_instant_too() -> None:
    swapped = [row(0, parameter(1)), row(1, parameter(0))]
    assert run(source(conditions=swapped).conditions(), [3.0, 5.0]) == [5.0, 3.0]
    states = [row(0, variable(1), "y"), row(1, variable(0), "y")]
    y = [3.0, 5.0]
    body = source(reinits=states).reinit()
    held: dict[str, Any] = {"y": y, "p": []}
    for line in lines_of(body):
        exec(line.removeprefix("const double ").rstrip(";"), {}, held)
    assert y == [5.0, 3.0]


def test_variables_without_memory_come_one_after_the_other() -> None:
    """The second one reads what the first one has become."""
    rows = [row(0, plus(0, 1.0)), row(1, plus(0, 1.0)), row(2, plus(1, 1.0))]
    assert run(source(runtime=rows).runtime(), [1.0, 0.0, 0.0]) == [2.0, 3.0, 4.0]
    twice = apply("Sin", plus(0, 1.0))
    shared = [row(n, apply("Mul", twice, twice)) for n in (0, 1)]
    body = source(runtime=shared).runtime()
    # Constants of two rows have a scope each: the second one is of the new value
    assert body.count("{") == body.count("}") == 2


def test_initial_equations_read_those_before_them() -> None:
    rows = [
        row(0, const(4.0)),
        row(1, plus(0, 1.0)),
        row(2, apply("Mul", parameter(1), const(2.0))),
    ]
    assert run(source(initial=rows).initial(), [0.0, 0.0, 0.0]) == [4.0, 5.0, 10.0]


def test_what_was_before_is_kept_of_discrete_and_continuous_variables() -> None:
    """pre(v) of p[1] in slot 0, of y[1] in slot 2; an entry into events needs the continuous."""
    both = source(previous=[(0, "p", 1), (2, "y", 1)])
    assert run(both.previous(), [0.0, 7.0, 0.0], [1.0, 9.0]) == [7.0, 7.0, 9.0]
    entry = lines_of(both.entry())
    assert entry[:4] == [
        "const int bad = model_algebraics(t, y, p);", "if (bad) {", "return bad;", "}",
    ]  # fmt: skip
    assert entry[4:] == ["p[2] = y[1];"]
    assert source(previous=[(0, "p", 1)]).entry() == ""


# Functions of the states


def states(body: str, x: Sequence[float], p: Sequence[float] = ()) -> dict[str, list[float]]:
    """What a function of the states puts into dx or z."""
    held: dict[str, Any] = {"x": list(x), "p": list(p), "dx": [None] * 3, "z": [None] * 3}
    for line in lines_of(body):
        exec(line.removeprefix("const double ").rstrip(";"), {}, held)
    return held


def test_derivatives_and_relations_read_what_follows_from_the_states_in_its_order() -> None:
    """y2 = 2 x0, y3 = y2 + x1, y4 = y3 - y2; what nothing needs is not computed."""
    y2, y3, y4 = (variable(n) for n in (2, 3, 4))
    made = source(
        state_count=2,
        algebraics=[
            row(2, apply("Mul", const(2.0), variable(0)), "y"),
            row(5, apply("Div", y2, const(0.0)), "y"),
            row(3, apply("Add", y2, variable(1)), "y"),
            row(4, apply("Sub", y3, y2), "y"),
        ],
        derivatives=[row(0, y4, "y"), row(1, apply("Add", y2, parameter(0)), "y")],
        relations=[SimpleNamespace(function=apply("Sub", variable(1), parameter(1))),
                   SimpleNamespace(function=y3)],
    )  # fmt: skip
    assert states(made.derivatives(), [3.0, 5.0], [10.0, 4.0])["dx"] == [5.0, 16.0, None]
    assert states(made.relation_functions(), [3.0, 5.0], [10.0, 4.0])["z"] == [1.0, 11.0, None]
    assert "/ 0" not in made.derivatives()
    assert "y4" in made.derivatives()
    assert "y4" not in made.relation_functions()


# Messages and ends


@pytest.mark.parametrize(
    ("kind", "at_start", "head", "result"),
    [
        ("assert", False, "if ((p[0] > 3", "SOLVER_FAILED"),
        ("assert", True, "if (at_start && (p[0] > 3", "SOLVER_FAILED"),
        ("terminate", False, "if ((p[0] > 3", "SOLVER_TERMINATED"),
        ("terminate", True, "if (at_start && (p[0] > 3", "SOLVER_TERMINATED"),
    ],
)
def test_an_assertion_fails_and_an_end_ends_with_place_text_and_time(
    kind: str, at_start: bool, head: str, result: str
) -> None:
    condition = apply("Gt", parameter(0), const(3.0))
    values = [("Real", parameter(1)), ("Boolean", parameter(2)), ("Integer", parameter(3))]
    action = Action(
        kind, condition, 'too "far": %g %s %.0f', values, Source("a%b/M.mo", 7), at_start
    )
    lines = lines_of(source(actions=[action]).actions())
    assert lines[0].startswith(head)
    assert lines[1] == (
        r'snprintf(notes->text, sizeof notes->text, "a%%b/M.mo:7: too \"far\": %g %s %.0f'
        r' (t = %.12g s)", p[1], p[2] != 0.0 ? "true" : "false", p[3], t);'
    )
    assert lines[2:] == [f"return {result};", "}"]
    bare = lines_of(source(actions=[Action(kind, condition, "odd", [], None)]).actions())
    assert bare[1].endswith('"odd (t = %.12g s)", t);')


def test_a_warning_is_given_when_it_begins_to_hold() -> None:
    condition = apply("Gt", parameter(0), const(3.0))
    action = Action("warning", condition, "hot", [], None, memory=5)
    lines = [line for line in lines_of(source(actions=[action]).actions()) if line not in "{}"]
    assert lines[0].startswith("const double says = (p[0] > 3")
    assert lines[1] == "if (says > p[5] && notes->warnings++ < N_WARNINGS) {"
    assert lines[-1] == "p[5] = says;"


# Tables


def test_schedules_have_their_own_numbers_and_a_grid_where_it_is_one() -> None:
    made = source(schedules=[
        (4, Schedule(const(0.5), parameter(1), None, None)),
        (6, Schedule(const(0.0), const(1e-3), (0, 1, 1000), Source("M.mo", 3))),
    ])  # fmt: skip
    held: dict[str, Any] = {"offset": [None] * 2, "interval": [None] * 2, "p": [0.0, 0.25]}
    for line in lines_of(made.clock_times()):
        exec(line.rstrip(";"), {}, held)
    assert (held["offset"], held["interval"]) == ([0.5, 0.0], [0.25, 1e-3])
    first, second = made.clocks()
    assert (first["flag"], first["place"]) == (4, "")
    assert [float(part) for part in str(first["grid"]).split(",")] == [0.0, 0.0, 0.0]
    assert (second["flag"], second["place"]) == (6, "M.mo:3")
    assert [float(part) for part in str(second["grid"]).split(",")] == [0.0, 1.0, 1000.0]


def test_a_block_that_is_searched_for_reads_its_inputs_and_unknowns_alone() -> None:
    """y0 + y1 = p3 and y0 - y1 = 0: residuals 0 and 2, slopes 1, 1, 1, -1 at (3, 1), p3 = 4."""
    one, other, wanted = variable(0), variable(1), parameter(3)
    residuals = [apply("Sub", apply("Add", one, other), wanted), apply("Sub", one, other)]
    slopes = [ONE, ONE, ONE, const(-1.0)]
    block = Block(2, [one, other], [wanted], residuals, slopes, ["a", "b"], Source("M.mo", 9))
    linear = Block(1, [], [], [], [], ["c"], None)
    made = source(blocks=[linear, block])
    (found,) = made.block_functions()
    assert (found["number"], found["note"], made.largest_block) == (2, "a, b", 2)
    held: dict[str, Any] = {"u": [3.0, 1.0], "input": [4.0], "residual": [9.0] * 2,
                            "slope": [9.0] * 4}  # fmt: skip
    for line in lines_of(str(found["body"])):
        exec(line.removeprefix("const double ").rstrip(";"), {}, held)
    assert (held["residual"], held["slope"]) == ([0.0, 2.0], [1.0, 1.0, 1.0, -1.0])
    assert made.block_names() == [{"names": "c", "place": ""}, {"names": "a, b", "place": "M.mo:9"}]
    assert source().largest_block == 0


def shown(**given: Any) -> Variable:
    values: dict[str, Any] = {
        "reference": 3, "name": "v", "type": "Float64", "causality": "output",
        "variability": "continuous", "initial": None, "dimensions": (), "elements": ("v",),
        "start": None, "unit": None, "minimum": None, "maximum": None, "nominal": None,
        "description": "", "vector": "y", "index": 4,
    }  # fmt: skip
    return Variable(**(values | given))


@pytest.mark.parametrize(
    ("given", "slave", "row_of"),
    [
        ({}, "fmi3.inc", {"type": "TYPE_FLOAT64", "class": "CLASS_OUTPUT", "vector": "IN_Y",
                          "index": "4", "count": "1"}),
        ({"causality": "input", "vector": "p", "start": (0.0,)}, "fmi3.inc",
         {"class": "CLASS_INPUT", "vector": "IN_P"}),
        ({"causality": "parameter", "variability": "tunable", "vector": "p", "start": (0.0,),
          "initial": "exact"},
         "fmi3.inc", {"class": "CLASS_PARAMETER"}),
        ({"elements": ("v[1]", "v[2]"), "dimensions": (2,)}, "fmi3.inc", {"count": "2"}),
        ({"type": "Enumeration"}, "fmi3.inc", {"type": "TYPE_ENUMERATION"}),
        ({"type": "Enumeration"}, "fmi2.inc", {"type": "TYPE_INT32"}),
        ({"type": "Boolean"}, "fmi2.inc", {"type": "TYPE_BOOLEAN"}),
    ],
)  # fmt: skip
def test_a_variable_is_a_row_of_the_table(
    given: dict[str, Any], slave: str, row_of: dict[str, str]
) -> None:
    """An enumeration is read as a whole number in FMI 2.0."""
    found = _row(shown(**given), slave)
    assert {name: found[name] for name in row_of} == row_of


@pytest.mark.parametrize(("low", "high"), [(None, None), (-2.0, None), (None, 3.5), (-1e-6, 0.0)])
def test_limits_of_a_variable_are_each_there_or_not(low: float | None, high: float | None) -> None:
    """What has no limit goes from one end of the numbers to the other, in the words of C."""
    found = _row(shown(minimum=low, maximum=high), "fmi3.inc")
    for number, text, none in ((low, found["min"], "-INF"), (high, found["max"], "INF")):
        if number is None:
            assert text.strip("()").upper().startswith(none)
        else:
            assert float(text.strip("()")) == number


@pytest.mark.parametrize("slave", ["fmi2.inc", "fmi3.inc"])
@pytest.mark.parametrize(
    ("given", "kind"),
    [
        ({"causality": "input", "initial": None}, "CLASS_INPUT"),
        ({"causality": "parameter", "initial": "exact"}, "CLASS_PARAMETER"),
        # The start of a state, whoever sees the state
        ({"causality": "output", "initial": "exact"}, "CLASS_PARAMETER"),
        ({"causality": "local", "initial": "exact"}, "CLASS_PARAMETER"),
        ({"causality": "output", "initial": "calculated"}, "CLASS_OUTPUT"),
        ({"causality": "local", "initial": "calculated"}, "CLASS_OUTPUT"),
        ({"causality": "calculatedParameter", "initial": "calculated"}, "CLASS_OUTPUT"),
        ({"causality": "local", "variability": "constant", "initial": "exact"}, "CLASS_OUTPUT"),
    ],
)
def test_what_can_be_set_is_an_input_or_a_parameter(given: Any, kind: str, slave: str) -> None:
    assert _row(shown(**given), slave)["class"] == kind
