"""Which families of drives there are and what carries their words (`families.csv`): one registry.

A row joins a family and a carrier, and names four modules: of the tables `[drive.D]` and
`[segment.S]`, and of what knows both on paper (`rig`) and in operation (`machine`). The tables of
a family, and those of a carrier, are the same in all their rows; so are `rig` and `machine` of a
carrier, which look at all that is on their segments. The modules are loaded when a rig asks.
"""

import csv
from collections.abc import Sequence
from importlib import import_module, resources
from typing import Any, NamedTuple

from pydantic_core import InitErrorDetails, PydanticCustomError, ValidationError

from axisrig.bench.rig.reading.tables import DriveKeys, SegmentKeys
from axisrig.kernel.errors import nearest


class Joined(NamedTuple):
    """A row of the table: family and carrier, and the names of the modules that know them."""

    family: str
    carrier: str
    drive: str
    segment: str
    rig: str
    machine: str


def _read() -> list[Joined]:
    text = resources.files(__package__).joinpath("families.csv").read_text(encoding="utf-8")
    return [Joined(**row) for row in csv.DictReader(text.splitlines())]


FAMILIES = _read()
"""All rows; the first one is what a rig means that names neither family nor carrier."""


def loaded(module: str) -> Any:
    """Load a module that a row names."""
    return import_module(module)


def joined(family: str, carrier: str) -> Joined | None:
    """Return the row of a family on a carrier, None where it has none."""
    return next((row for row in FAMILIES if (row.family, row.carrier) == (family, carrier)), None)


def carriers_of(family: str) -> list[str]:
    """Return what carries a family."""
    return [row.carrier for row in FAMILIES if row.family == family]


def drive_table(values: Any) -> type[DriveKeys]:
    """Return the keys that `[drive.D]` has by its family. Raises pydantic's ValidationError."""
    row = _row(values, "family", [row.family for row in FAMILIES])
    found: type[DriveKeys] = loaded(row.drive).DriveTable
    return found


def segment_table(values: Any) -> type[SegmentKeys]:
    """Return the keys that `[segment.S]` has by its carrier. Raises pydantic's ValidationError."""
    row = _row(values, "carrier", [row.carrier for row in FAMILIES])
    found: type[SegmentKeys] = loaded(row.segment).SegmentTable
    return found


def read_drive(values: Any) -> DriveKeys:
    """Read `[drive.D]` as its family has it. Raises pydantic's ValidationError."""
    return drive_table(values).model_validate(values)


def read_segment(values: Any) -> SegmentKeys:
    """Read `[segment.S]` as its carrier has it. Raises pydantic's ValidationError."""
    return segment_table(values).model_validate(values)


def _row(values: Any, key: str, known: Sequence[str]) -> Joined:
    """Return the first row with the word that a table has for `key`, which may be left out.

    known: that word in each row.
    """
    word = values.get(key) if isinstance(values, dict) else None
    if word is None:
        return FAMILIES[0]
    if word not in known:
        near = ", ".join(nearest(str(word), known) or dict.fromkeys(known))
        kind = PydanticCustomError("value_error", f"there is no such {key}; allowed: {near}")
        found = InitErrorDetails(type=kind, loc=(key,), input=word)
        raise ValidationError.from_exception_data(key, [found])
    return FAMILIES[known.index(word)]
