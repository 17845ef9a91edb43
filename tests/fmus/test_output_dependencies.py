"""What an output depends on at the same instant, by the kind of rows that it is computed by."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_variables_of_models import shown

from axisrig.fmus.reading.expressions import TIME, apply, parameter
from axisrig.fmus.writing.structure import output_dependencies


@pytest.mark.parametrize(
    "kind", ["algebraics", "runtime", "updates", "whens", "conditions", "relations", "previous"]
)
def test_an_output_depends_on_what_it_is_computed_from_by_any_kind_of_row(kind: str) -> None:
    """An output from p[1], and p[1] from an input and another output; what is kept is memory."""

    def row(index: int, value: Any) -> Any:
        return SimpleNamespace(vector="p", index=index, value=value)

    rows: dict[str, Any] = dict.fromkeys(
        ("algebraics", "updates", "whens", "conditions", "relations", "schedules", "previous"), ()
    )
    system: Any = SimpleNamespace(state_count=1, **rows, runtime=[row(2, parameter(1))])
    made = [
        *(shown(name=f"u{n}", causality="input", vector="p", index=3 + n, reference=2 + n)
          for n in range(2)),
        shown(name="y", vector="p", index=2, reference=10),
        shown(name="z", vector="p", index=9, reference=11),
    ]  # fmt: skip
    assert output_dependencies(system, made) == {10: (), 11: ()}
    value = apply("Add", apply("Mul", parameter(3), TIME), parameter(9))
    if kind == "relations":
        system.relations = [SimpleNamespace(memory=1, function=value)]
    elif kind == "previous":
        system.previous, system.runtime = [(1, "p", 7)], [*system.runtime, row(7, value)]
    else:
        setattr(system, kind, [*getattr(system, kind), row(1, value)])
    kept = kind == "previous"
    assert output_dependencies(system, made) == {10: () if kept else (1, 2), 11: ()}
    system.runtime = [*system.runtime, row(9, parameter(4))]
    assert output_dependencies(system, made) == {10: () if kept else (1, 2, 3), 11: (3,)}


def test_a_slot_that_several_rows_compute_depends_on_what_each_of_them_reads() -> None:
    """As a discrete variable of two when-clauses: either of them may have given its value."""

    def row(value: Any) -> Any:
        return SimpleNamespace(vector="p", index=1, value=value)

    rows: dict[str, Any] = dict.fromkeys(
        ("algebraics", "runtime", "conditions", "relations", "schedules", "previous"), ()
    )
    system: Any = SimpleNamespace(
        state_count=0, **rows, updates=[row(parameter(3))], whens=[row(parameter(4)), row(TIME)]
    )
    made = [
        *(shown(name=f"u{n}", causality="input", vector="p", index=3 + n, reference=2 + n)
          for n in range(3)),
        shown(name="y", vector="p", index=1, reference=10),
    ]  # fmt: skip
    assert output_dependencies(system, made) == {10: (1, 2, 3)}


@pytest.mark.parametrize(("vector", "index"), [("y", 2), ("p", 2)])
def test_what_was_before_an_event_is_memory_whatever_it_is_of(vector: str, index: int) -> None:
    """pre() of a continuous variable and of a discrete one."""
    rows: dict[str, Any] = dict.fromkeys(
        ("updates", "whens", "conditions", "relations", "schedules"), ()
    )
    system: Any = SimpleNamespace(
        state_count=1, **rows, previous=[(7, vector, index)],
        algebraics=[SimpleNamespace(vector="y", index=5, value=parameter(7))],
        runtime=[SimpleNamespace(vector="p", index=7, value=parameter(3))],
    )  # fmt: skip
    made = [
        shown(name="u", causality="input", vector="p", index=3, reference=2),
        shown(name="y", vector="y", index=5, reference=10),
    ]
    assert output_dependencies(system, made) == {10: ()}
    system.previous = [(8, vector, index)]
    assert output_dependencies(system, made) == {10: (2,)}


@pytest.mark.parametrize("states", [0, 1, 4])
def test_only_slots_of_y_are_states(states: int) -> None:
    """p[0] is computed from an input, however many states y has; what y[0] follows is memory."""

    def row(vector: str, index: int, value: Any) -> Any:
        return SimpleNamespace(vector=vector, index=index, value=value)

    rows: dict[str, Any] = dict.fromkeys(
        ("updates", "whens", "conditions", "relations", "schedules", "previous"), ()
    )
    runtime = [row("p", 0, apply("Mul", parameter(3), TIME))]
    algebraics = [row("y", 0, parameter(3))] if states == 0 else []
    system: Any = SimpleNamespace(
        state_count=states, **rows, runtime=runtime, algebraics=algebraics
    )
    made = [
        shown(name="u", causality="input", vector="p", index=3, reference=2),
        shown(name="d", vector="p", index=0, reference=10),
        shown(name="x", vector="y", index=0, reference=11),
    ]
    assert output_dependencies(system, made) == {10: (1, 2), 11: () if states else (2,)}


@pytest.mark.parametrize("references", [(9, 17, 2), (40, 8, 33), (2, 9, 17)])
def test_inputs_of_an_output_are_in_the_order_of_their_references(
    references: tuple[int, ...],
) -> None:
    """FMI 3.0.2, 2.4.8: in ascending order, wherever the variables are; the time is 1."""
    value = TIME
    for slot in (3, 4, 5):
        value = apply("Add", value, parameter(slot))
    rows: dict[str, Any] = dict.fromkeys(
        ("algebraics", "updates", "whens", "conditions", "relations", "schedules", "previous"), ()
    )
    runtime = [SimpleNamespace(vector="p", index=0, value=value)]
    system: Any = SimpleNamespace(state_count=0, **rows, runtime=runtime)
    made = [
        *(shown(name=f"u{n}", causality="input", vector="p", index=3 + n, reference=reference)
          for n, reference in enumerate(references)),
        shown(name="y", vector="p", index=0, reference=50),
    ]  # fmt: skip
    assert output_dependencies(system, made) == {50: (1, *sorted(references))}
