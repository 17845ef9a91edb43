"""What the outputs of a model depend on at the same instant, for the model structure."""

from collections.abc import Sequence

from axisrig.fmus.equations.system import System
from axisrig.fmus.reading.expressions import Expr
from axisrig.fmus.writing.variables import TIME_REFERENCE, Variable

Slot = tuple[str, int]
TIME: Slot = ("time", 0)


def output_dependencies(
    system: System, variables: Sequence[Variable]
) -> dict[int, tuple[int, ...] | None]:
    """For each output the value references of the inputs, and of the time, that it depends on.

    States and previous values are memory: what they depend on does not count. None: not known,
    which the standard reads as "on everything".
    """
    sources = _sources(system)
    inputs = {
        slot: variable.reference
        for variable in variables
        if variable.causality == "input"
        for slot in variable.slots
    }
    found: dict[int, tuple[int, ...] | None] = {}
    for variable in variables:
        if variable.causality == "output":
            reached = _reached(system, sources, variable.slots)
            found[variable.reference] = (
                None
                if reached is None
                else tuple(sorted({inputs[s] for s in reached if s in inputs} | _time(reached)))
            )
    return found


def _time(slots: set[Slot]) -> set[int]:
    return {TIME_REFERENCE} if TIME in slots else set()


def _leaves(value: Expr) -> set[Slot]:
    return {
        TIME if leaf.kind == "time" else (leaf.kind, leaf.index)
        for leaf in value.leaves()
        if leaf.kind in ("time", "y", "p")
    }


def _sources(system: System) -> dict[Slot, set[Slot]]:
    """What each computed slot is computed from."""
    rows = (
        *system.algebraics,
        *system.runtime,
        *system.updates,
        *system.whens,
        *system.conditions,
    )
    sources: dict[Slot, set[Slot]] = {("p", flag): {TIME} for flag, _ in system.schedules}
    for row in rows:
        sources.setdefault((row.vector, row.index), set()).update(_leaves(row.value))
    for relation in system.relations:
        sources.setdefault(("p", relation.memory), set()).update(_leaves(relation.function))
    return sources


def _reached(
    system: System, sources: dict[Slot, set[Slot]], begin: Sequence[Slot]
) -> set[Slot] | None:
    """Every slot that `begin` is computed from; None when an equation for one is missing."""
    memory = {("p", slot) for slot, _, _ in system.previous}
    reached: set[Slot] = set()
    waiting = list(begin)
    while waiting:
        slot = waiting.pop()
        if slot in reached:
            continue
        reached.add(slot)
        vector, index = slot
        is_state = vector == "y" and index < system.state_count
        if slot in memory or is_state:
            continue
        if vector == "y" and slot not in sources:
            return None
        waiting += sources.get(slot, ())
    return reached
