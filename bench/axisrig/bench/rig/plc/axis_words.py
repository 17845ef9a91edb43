"""What the PLC side does to one axis: the columns `plc:<axis>.<column>` of `axis_columns.csv`."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

from axisrig.bench.plan.assignment import number
from axisrig.bench.rig.plc.override import OverrideCourse, read_override
from axisrig.bench.rig.plc.times import duration, lasting
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.distance.objects import accept
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.types import Value
from axisrig.kernel.time.clock import TimeNs

OBJECT = "object."
SET_VALUES = {"set_pos": "set_pos_mm", "set_dist": "set_dist_mm"}
PROBING = ("probing_signal", "probing_position")
HIGHEST_PCT = 100


@dataclass(frozen=True)
class AxisColumn:
    """One row of `axis_columns.csv`. keys: what may be after a value, as `at=M50`."""

    name: str
    cell: str
    keys: tuple[str, ...]
    meaning: str


@dataclass(frozen=True)
class UnitWrite:
    """Distance control of an axis is commanded; values in mm, None leaves them."""

    axis: str
    transition: DistanceCommand
    set_pos_mm: float | None = None
    set_dist_mm: float | None = None


@dataclass(frozen=True)
class SetCourse:
    """A set value of distance control (mm) changes, evenly over a time; 0 at once."""

    axis: str
    value: str
    to_mm: float
    over_ns: TimeNs = 0


@dataclass(frozen=True)
class AxisFeedhold:
    """An axis is held for a time; None until a moment that the rule names."""

    axis: str
    for_ns: TimeNs | None


@dataclass(frozen=True)
class ObjectChange:
    """A CNC object of distance control gets a value, in the unit of the object."""

    axis: str
    name: str
    value: Value


@dataclass(frozen=True)
class ProbingWrite:
    """The probing signal of an axis gets a level, or its probing position a value, mm."""

    axis: str
    level: bool | None = None
    position_mm: float | None = None


AxisAction = UnitWrite | SetCourse | AxisFeedhold | OverrideCourse | ObjectChange | ProbingWrite


@cache
def axis_columns() -> Mapping[str, AxisColumn]:
    """Read `axis_columns.csv`, by name; that of CNC objects is `object.<name>`."""
    text = resources.files(__package__).joinpath("axis_columns.csv").read_text(encoding="utf-8")
    return {
        row["column"]: AxisColumn(
            row["column"], row["cell"], tuple(row["keys"].split()), row["meaning"]
        )
        for row in csv.DictReader(text.splitlines())
    }


def find_column(name: str) -> AxisColumn | None:
    """Return the row of a column, by the text after the axis and its dot."""
    return axis_columns().get("object.<name>" if name.startswith(OBJECT) else name)


def read_action(
    axis: str, name: str, column: str, values: Sequence[str], keys: Mapping[str, str]
) -> AxisAction:
    """Read one action of a column; values: the words without `=`, keys: those with.

    Raises UserError for what cannot be.
    """
    if name == "feedhold":
        if values:
            raise UserError(
                "a feedhold has no value", value=values[0], allowed="at=400ms for=300ms"
            )
        return AxisFeedhold(axis, duration(keys))
    example = (find_column(name) or axis_columns()["dist_ctrl"]).cell
    if len(values) != 1:
        raise UserError(
            "one value and its keys", value=" ".join(values) or "nothing", allowed=example
        )
    (value,) = values
    if name.startswith(OBJECT):
        target = name.removeprefix(OBJECT)
        return ObjectChange(axis, target, accept(target, value, Origin(column)))
    if name == "override":
        return read_override(axis, column, value, keys, HIGHEST_PCT)
    if name in PROBING:
        return _probing(axis, name, column, value)
    if name in SET_VALUES:
        return SetCourse(axis, SET_VALUES[name], number(column, value), lasting("over", keys))
    return _command(axis, column, value, keys)


def _probing(axis: str, name: str, column: str, value: str) -> ProbingWrite:
    if name == "probing_position":
        return ProbingWrite(axis, position_mm=number(column, value))
    if value not in ("0", "1"):
        raise UserError("a signal has two levels", value=value, allowed="0, 1")
    return ProbingWrite(axis, level=value == "1")


def _command(axis: str, column: str, word: str, keys: Mapping[str, str]) -> UnitWrite:
    known = DistanceCommand.__members__
    if word not in known:
        raise UserError("distance control has no such command", value=word, allowed=known)

    def given(key: str) -> float | None:
        return number(f"{column} {key}", keys[key]) if key in keys else None

    return UnitWrite(axis, known[word], given("set_pos"), given("set_dist"))
