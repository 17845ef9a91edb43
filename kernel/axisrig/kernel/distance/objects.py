"""CNC objects of a distance control, by name (`objects.csv`), and of 3D control
(`channel_objects.csv`, in the order of its loop).

Written values act from the next INACTIVE or FREEZE to ACTIVE on (FCT-M3 7.6); a read gives what was
written last. Addresses: index group 0x120300, `offset` after the axis number.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from axisrig.kernel.distance.control import DistanceControl
from axisrig.kernel.distance.filters.build import OF_AXIS, parameter_row
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.types import Value


@dataclass(frozen=True)
class CncObject:
    """One row of `objects.csv`.

    offset: of the index, hexadecimal as printed, empty where no source gives it. type, unit: of the
    value; factor: of it make one mm, mm/s or mm/s2, else 1. attributes: way to the value from a
    `DistanceControl`. parameter: the one after `kenngr.dist_ctrl[0].` whose range a written value
    has, empty where it cannot be written. column: of the trace of a run.
    """

    name: str
    offset: str
    type: str
    unit: str
    factor: int
    attributes: tuple[str, ...]
    parameter: str
    column: str
    meaning: str
    source: str

    @property
    def is_writable(self) -> bool:
        """Whether it can be written."""
        return bool(self.parameter)

    @property
    def setting(self) -> str:
        """Name of the value in `DistanceSettings` or `FilterSettings`."""
        return self.attributes[-1]


@cache
def objects() -> Mapping[str, CncObject]:
    """Read `objects.csv`, keyed by name."""
    text = resources.files(__package__).joinpath("objects.csv").read_text(encoding="utf-8")
    return {
        row["name"]: CncObject(
            row["name"],
            row["offset"],
            row["type"],
            row["unit"],
            int(row["factor"]),
            tuple(row["source_of"].split(".")),
            row["parameter"],
            row["column"],
            row["meaning"],
            row["source"],
        )
        for row in csv.DictReader(text.splitlines())
    }


@dataclass(frozen=True)
class ChannelObject:
    """One row of `channel_objects.csv`; can only be read.

    of_axis: every axis has one; attributes lead to the value from the positions of an axis, else
    from the 3D control. The others as in `CncObject`.
    """

    name: str
    offset: str
    type: str
    unit: str
    factor: int
    of_axis: bool
    attributes: tuple[str, ...]
    column: str
    meaning: str
    source: str

    def read(self, source: object) -> int:
        """Return its value in its unit. source: the 3D control, or positions of an axis."""
        value: Any = _value_of(source, self.attributes)
        return round(float(value or 0) * self.factor)


@cache
def channel_objects() -> Mapping[str, ChannelObject]:
    """Read `channel_objects.csv`, keyed by name, in the order of the control loop."""
    text = resources.files(__package__).joinpath("channel_objects.csv").read_text(encoding="utf-8")
    return {
        row["name"]: ChannelObject(
            row["name"],
            row["offset"],
            row["type"],
            row["unit"],
            int(row["factor"]),
            row["of_axis"] == "yes",
            tuple(row["source_of"].split(".")),
            row["column"],
            row["meaning"],
            row["source"],
        )
        for row in csv.DictReader(text.splitlines())
    }


def _value_of(source: object, attributes: tuple[str, ...]) -> Any:
    value: Any = source
    for attribute in attributes:
        value = getattr(value, attribute)
    return value


def read(control: DistanceControl, name: str) -> Value:
    """Return the value of an object in its unit; KeyError for a name that there is not."""
    item = objects()[name]
    value: Any = control.requested(item.setting) if item.is_writable else None
    if value is None:
        value = _value_of(control, item.attributes)
    if item.type == "STRING":
        return str(value)
    number = float(value or 0) * item.factor
    return number if item.type == "REAL64" else round(number)


def accept(name: str, text: str, origin: Origin) -> Value:
    """Read what is to be written into an object, in its unit.

    Raises UserError for an unknown object, one that can only be read, and a value that its
    parameter cannot have.
    """
    item = objects().get(name)
    if item is None:
        hint = f"nearest names: {', '.join(nearest(name, objects()))}"
        raise origin.error("no CNC object of distance control", value=name, hint=hint)
    if not item.is_writable:
        writable = ", ".join(o.name for o in objects().values() if o.is_writable)
        raise origin.error("this CNC object can only be read", value=name, allowed=writable)
    return parameter_row(OF_AXIS, item.parameter).accept(text, origin)


def write(control: DistanceControl, name: str, value: Value) -> None:
    """Write an object; value: in its unit, as `accept` has read it."""
    item = objects()[name]
    if not item.is_writable:
        raise UserError("this CNC object can only be read", value=name)
    if not isinstance(value, str) and item.factor != 1:
        value /= item.factor
    control.request(item.setting, value)
