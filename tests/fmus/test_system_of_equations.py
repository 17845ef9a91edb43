"""Equations of a model as they are read, from rows that are written down: nothing is built."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations import system
from axisrig.fmus.equations.events import Row
from axisrig.fmus.equations.sorting import Equation
from axisrig.fmus.equations.system import _clock_conditions, _Reader, _slot, _with_needed
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import apply, choice, parameter, variable


def ir_of(states: int = 1, names: tuple[str, ...] = (), **solve: Any) -> Any:
    layout = {"state_scalar_count": states, "solver_maps": {"names": list(names)}}
    known = {"solve_layout": {**layout, **solve.pop("solve_layout", {})}, **solve}
    return SimpleNamespace(
        solve=known,
        error=lambda _span, message: BuildError(None, None, message),
        dae={"variables": [{"scalar_names": ["x", "v", "y"]}]},
    )


def reader(ir: Any, **parts: Any) -> Any:
    made: Any = object.__new__(_Reader)
    made._ir = ir
    for name, value in parts.items():
        setattr(made, name, value)
    return made


@pytest.fixture(autouse=True)
def place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system, "at", lambda _ir, _place, message: BuildError(None, 3, message))


def row(index: int, value: Any = None, vector: str = "y") -> Row:
    return Row(vector, index, parameter(0) if value is None else value, None)  # type: ignore[arg-type]


def test_a_target_is_a_vector_and_a_place() -> None:
    assert _slot({"P": {"index": 3}}) == ("p", 3)
    assert _slot({"Y": {"index": 0}}) == ("y", 0)


def test_reinit_is_of_a_state() -> None:
    ir = ir_of(2)
    for index in (0, 1):
        assert _Reader._gated(reader(ir), row(index)) == row(index)
    with pytest.raises(BuildError, match=r"reinit\(\) of a variable that is not a state"):
        _Reader._gated(reader(ir), row(2))


def test_every_state_has_one_derivative_in_its_order() -> None:
    ir = ir_of(2, continuous={"derivative_rhs": {"scalar_plan": None}})
    good = [row(0), row(1)]
    assert _Reader._derivatives(reader(ir, _rows=lambda _: good)) == good
    for rows in ([row(0)], [row(0), row(2)], [row(0), row(1), row(2)]):
        with pytest.raises(BuildError, match="not every state has a derivative"):
            _Reader._derivatives(reader(ir, _rows=lambda _, rows=rows: rows))


def algebraics(targets: list[Any], rows: list[Row], y_scalars: int = 4) -> Any:
    ir = ir_of(
        2, ("x", "v", "y", "z"), layout={"y_scalars": y_scalars},
        continuous={"implicit_row_targets": targets, "implicit_rhs": {"scalar_plan": None}},
    )  # fmt: skip
    memories = SimpleNamespace(in_rows=lambda rows: rows)
    return _Reader._algebraics(reader(ir, _rows=lambda _: rows, _memories=memories), 2)


def test_everything_that_is_no_state_has_an_equation() -> None:
    target = [{"Y": {"index": 3}}, {"Y": {"index": 2}}]
    found = algebraics(target, [row(0), row(1)])
    assert [one.unknown for one in found] == [variable(3), variable(2)]
    with pytest.raises(BuildError, match="no equation for z"):
        algebraics(target[1:], [row(0)])
    with pytest.raises(BuildError, match="no equation for y"):
        algebraics(target[:1], [row(0)])
    with pytest.raises(BuildError, match="an equation without an unknown"):
        algebraics([*target, None], [row(0), row(1), row(2)])


def test_a_state_of_the_compiler_begins_as_the_variable_that_it_is_equal_to() -> None:
    def equal(one: int, other: int, kind: str = "Sub") -> Equation:
        return Equation(apply(kind, variable(one), variable(other)), variable(other), None)  # type: ignore[arg-type]

    made = reader(ir_of(2, ("x", "own")))
    assert _Reader._twins(made, [equal(1, 2)], 2) == [(1, 2)]
    assert _Reader._twins(made, [equal(2, 1)], 2) == [(1, 2)]
    assert _Reader._twins(reader(ir_of(2, ("x", "v"))), [equal(1, 2)], 2) == []
    for equations in ([], [equal(2, 3)], [equal(1, 2, "Add")]):
        with pytest.raises(BuildError, match="the start of own is not known"):
            _Reader._twins(made, equations, 2)


def test_a_when_clause_holds_what_was_before_and_waits_for_its_clock() -> None:
    """Slot 7 has pre(v) of slot 4; slot 9 is the flag of its clock."""
    own, before = parameter(4), parameter(7)
    one = row(4, apply("Add", own, parameter(5)), "p")
    previous = [(7, "p", 4), (8, "p", 5), (6, "y", 4)]
    free = reader(ir_of(), _clocks=SimpleNamespace(of_slot={}))
    held = apply("Add", before, parameter(5))
    assert _Reader._held(free, one, previous).value == held
    clocked = reader(ir_of(), _clocks=SimpleNamespace(of_slot={4: 9}))
    assert _Reader._held(clocked, one, previous).value == choice(parameter(9), held, before)
    for others in ([(8, "p", 5)], [(7, "p", 4), (8, "p", 4)]):
        with pytest.raises(BuildError, match="a discrete variable without a previous value"):
            _Reader._held(free, one, others)


def test_what_holds_at_the_start_needs_comes_along_whatever_it_needs_too() -> None:
    def equation(unknown: int, *needs: int) -> Equation:
        residual = variable(unknown)
        for one in needs:
            residual = apply("Sub", residual, variable(one))
        return Equation(residual, variable(unknown), None)  # type: ignore[arg-type]

    first = equation(0, 1)
    own = equation(1, 9)
    others = [equation(1, 2), equation(2, 3), equation(3), equation(4, 0)]
    found = _with_needed([first], others)
    assert [one.unknown.index for one in found] == [0, 1, 2, 3]
    # What the start gives itself is not taken from what holds at any time
    found = _with_needed([first, own], others)
    assert [one.residual for one in found] == [first.residual, own.residual]


def test_what_a_clock_was_before_has_a_slot_after_all_others() -> None:
    conditions = [{"id": 0, "operation": {"kind": "relation"}},
                  {"id": 2, "operation": {"kind": "clock"}}]  # fmt: skip

    def found(bindings: list[int], layout: dict[str, Any]) -> set[int]:
        ir = ir_of(solve_layout={"pre_param_bindings": [{"dest_p_index": n} for n in bindings]},
                   layout={"bindings": layout})  # fmt: skip
        ir.dae = {"systems": {"conditions": {"conditions": conditions}}}
        return _clock_conditions(ir)

    assert found([], {}) == {2}
    assert found([4, 6], {"a": {"P": {"index": 5}}, "b": {"Y": {"index": 9}}}) == {9}
    assert found([4], {"a": {"P": {"index": 7}}}) == {10}


def test_a_message_of_a_relation_names_a_domain_that_is_not_known() -> None:
    events = {"root_relation_memory_targets": [{"P": {"index": 5}}], "root_plan": None,
              "root_conditions": {"program_spans": []}}  # fmt: skip

    def relations(domain: str, value: Any) -> Any:
        ir = ir_of(events={**events, "root_zero_domains": [domain]})
        ir.place = lambda span: span
        return _Reader._relations(reader(ir, _rows=lambda _: [row(0, value)]))

    domain = next(iter(system.AT_ZERO))
    (found,) = relations(domain, variable(2))
    assert (found.memory, found.function) == (5, variable(2))
    with pytest.raises(BuildError, match="zero domain odd of a relation is not known"):
        relations("odd", variable(2))
