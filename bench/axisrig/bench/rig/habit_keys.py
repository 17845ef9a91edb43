"""Habits of any drive at its axis and inputs as keys of `[drive.D]` of a family."""

from collections.abc import Callable, Iterable
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from axisrig.bench.drive.cia402.dictionary.profiles import Habit, habits
from axisrig.bench.rig.reading.tables import Table

OF_ANY = ("missing_cycles", "jump_factor", "lag_limit_mm", "fault_reset", "position_check")
"""Keys that drives of each family have."""


def habit_table(keys: Iterable[str]) -> Any:
    """Make a table with the habits of these names; their defaults are those of `generic`."""
    fields: dict[str, Any] = {key: _field(habits()[key]) for key in keys}
    return create_model("_HabitTable", __base__=Table, **fields)


def _field(habit: Habit) -> Any:
    kind: Any = {"whole": int, "number": float}.get(habit.type) or Literal[habit.words]
    if habit.low is not None:
        kind = Annotated[kind, Field(ge=kind(habit.low), le=kind(habit.high))]
    return kind, habit.values["generic"]


def number(text: str) -> Any:
    """Read the cell of a plan: a number, true or false, else the text."""
    kinds: tuple[Callable[[str], Any], ...] = (lambda word: int(word, 0), float)
    for kind in kinds:
        try:
            return kind(text)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(text.lower(), text)
