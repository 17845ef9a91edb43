"""Which internal slots an equation may read, and whole numbers that are exact in every program."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_algebra import X, Y, ir
from tests.fmus.test_programs_of_a_system import P, model, plan, slots

from axisrig.fmus.equations import system as systems
from axisrig.fmus.equations.events import Memories, Row
from axisrig.fmus.equations.sorting import Equation, Solver
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import TIME, Expr, apply, const
from axisrig.fmus.reading.ir import Source

PLACE = Source("M.mo", 7)
ROWS = ("initial", "runtime", "updates", "whens", "conditions", "derivatives", "algebraics")


def checked(read: int, where: str = "whens", **parts: Any) -> None:
    """A model whose equation of a kind reads a slot. Clock: condition 1 of two."""
    made = model()
    made.dae["systems"]["conditions"]["conditions"] = [
        {"id": number, "operation": {"kind": kind}} for number, kind in enumerate(("time", "clock"))
    ]
    made.dae["variables"].clear()
    made.solve["events"]["root_relation_memory_targets"] = slots(P[15])
    empty: dict[str, Any] = dict.fromkeys((*ROWS, "relations", "previous", "schedules"), ())
    system: Any = SimpleNamespace(**(empty | {"initial_flag": None} | parts))
    one = Row("y", 0, apply("Add", P[read], TIME), PLACE)
    if where == "relations":
        system.relations = (
            *system.relations, SimpleNamespace(function=one.value, memory=28, place=PLACE)
        )  # fmt: skip
    else:
        setattr(system, where, (*getattr(system, where), one))
    systems._check(made, system)


@pytest.mark.parametrize(
    ("slot", "parts"),
    [
        (0, {}), (3, {}),  # named variables
        (6, {}),  # what a clock was before: after pre(m), p[4], the second condition
        (15, {}),  # memory of a mark of whole numbers
        (9, {"initial_flag": 9}), (0, {"initial_flag": 0}),
        (12, {"previous": [(11, "p", 1), (12, "p", 3)]}),
        (13, {"relations": [SimpleNamespace(memory=13, function=TIME, place=None)]}),
        (21, {"schedules": [(20, None), (21, None)]}),
        *((14, {kind: [Row("p", 14, TIME, None)]}) for kind in ROWS[:5]),
    ],
)  # fmt: skip
def test_a_slot_that_something_computes_may_be_read(slot: int, parts: Any) -> None:
    checked(slot, **parts)


@pytest.mark.parametrize("where", [*ROWS, "relations"])
def test_a_slot_that_nothing_computes_is_refused_at_its_equation(where: str) -> None:
    """p[5] is what a condition was before that is no clock; p[14] is y[14] in the other vector."""
    other: dict[str, Any] = {"conditions": [Row("y", 14, TIME, None)]}
    for slot, parts in ((5, {}), (7, {}), (14, other)):
        with pytest.raises(BuildError, match="an internal value of the compiler") as error:
            checked(slot, where, **parts)
        assert (error.value.file, error.value.line) == ("M.mo", 7)


@pytest.mark.parametrize("kind", ["runtime", "updates", "whens"])
def test_sums_of_whole_numbers_are_exact_in_every_program(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """n = n + k is not a number above 2^53, of whatever kind its equation is; Real m rounds."""
    for name in ("refuse_unsupported", "refuse_dropped_modifiers", "_check"):
        monkeypatch.setattr(systems, name, lambda *_: None)
    values = [apply("Add", P[0], const(2.0)), apply("Mul", P[0], const(3.0))]
    target = slots(P[1], P[3])
    given: dict[str, Any] = {
        "runtime": {"discrete__runtime_assignment_plan": plan(*values),
                    "discrete__runtime_assignment_targets": target},
        "updates": {"discrete__rhs_plan": plan(*values), "discrete__update_targets": target},
        "whens": {"discrete__guarded_assignment_plan": plan(*values),
                  "discrete__update_targets": target},
    }[kind]  # fmt: skip
    made = model(**given)
    made.dae["variables"] += [
        {"name": name, "scalar_names": [name], "scalar_count": 1, "role": "discrete_value",
         "value_type": {"scalar": scalar}, "attributes": {"binding": None}}
        for name, scalar in (("n", "integer"), ("m", "real"))
    ]  # fmt: skip
    made.dae["variables"][0] |= {"name": "x", "value_type": {"scalar": "real"}}
    found = {row.index: row.value for row in getattr(systems.read_system(made), kind)}
    assert found == {1: Expr("Whole", (values[0],)), 3: values[1]}


@pytest.mark.parametrize("value", [apply("Floor", X), apply("Sign", X), apply("Gt", TIME, P[0])])
def test_a_memory_has_the_place_of_its_equation(value: Expr) -> None:
    memories = Memories(ir(), 4)
    memories.in_rows([Row("p", 0, TIME, None), Row("p", 1, value, PLACE)])
    assert [one.place for one in memories.found] == [PLACE]
    with pytest.raises(BuildError, match="can only be compared") as error:
        memories.in_rows([Row("p", 1, apply("Eq", TIME, P[0]), Source("N.mo", 9))])
    assert (error.value.file, error.value.line) == ("N.mo", 9)


@pytest.mark.parametrize("kind", ["System", "Newton", "Whole"])
def test_a_loop_that_cannot_be_solved_is_refused_at_its_equation(kind: str) -> None:
    """A solution inside the loop, and a function without a slope."""
    inside = Expr(kind, (X,))
    part = inside if kind == "Whole" else Expr("Component", (inside,))
    equation = Equation(apply("Sub", apply("Mul", X, X), part), X, PLACE)
    other = Equation(apply("Sub", Y, P[0]), Y, Source("M.mo", 3))
    solver = Solver(ir(x={"Y": {"index": 0}}))
    with pytest.raises(BuildError) as error:
        solver.solve([other, equation])
    assert (error.value.file, error.value.line) == ("M.mo", 7)
    assert "x" in error.value.message
