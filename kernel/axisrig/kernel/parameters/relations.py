"""Limits of one parameter that are another parameter, as the pages print them (`relations.csv`).

reaction: `corrected`, to the limit with warning 900522; `noted`, the value stays as it is. Pages
print the range and no reaction. What a list does not set is not judged, nor is a value whose limit
is only noted against the default of that limit, since the kernel does not count it either.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources

from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters.table import table
from axisrig.kernel.parameters.types import written
from axisrig.kernel.parameters.values import ParameterSet

CORRECTED = "corrected"
AT_MOST = "at most"


@dataclass(frozen=True)
class Relation:
    """One row of `relations.csv`."""

    path: str
    relation: str
    limit: str
    reaction: str
    source: str

    @property
    def is_corrected(self) -> bool:
        """Whether the control takes the limit in place of the value."""
        return self.reaction == CORRECTED

    def is_broken(self, parameters: ParameterSet) -> bool:
        """Return whether the parameters of an axis do not keep to it."""
        counts = self.is_corrected or parameters.is_set(self.limit)
        if not parameters.is_set(self.path) or not counts:
            return False
        value, limit = parameters.integer(self.path), parameters.integer(self.limit)
        return value > limit if self.relation == AT_MOST else value < limit

    def named(self, parameters: ParameterSet, path: str) -> str:
        """Write a parameter with its number, value and unit."""
        row, _ = table("axis").find(path)
        return f"{path} ({row.number}) = {written(parameters.integer(path))} {row.unit}"


@cache
def relations() -> tuple[Relation, ...]:
    """Read the table."""
    text = resources.files(__package__).joinpath("relations.csv").read_text(encoding="utf-8")
    return tuple(Relation(**row) for row in csv.DictReader(text.splitlines()))


def corrected(parameters: ParameterSet, axis: str) -> Iterator[Alarm]:
    """Correct what goes past its limit; yield Alarm 900522 for each."""
    for row in relations():
        if row.is_corrected and row.is_broken(parameters):
            setting, limit = row.named(parameters, row.path), row.named(parameters, row.limit)
            origin = parameters.origin(row.path)
            parameters.correct(row.path, parameters.integer(row.limit))
            place = None if origin is None else origin.short
            yield Alarm(
                900522, axis=axis, setting=setting, relation=row.relation, limit=limit, place=place
            )


def noted(parameters: ParameterSet) -> list[str]:
    """Return what goes past a limit and stays as it is, in words: one line for each limit."""
    found: dict[str, list[Relation]] = {}
    for row in relations() if parameters.kind == "axis" else ():
        if not row.is_corrected and row.is_broken(parameters):
            found.setdefault(row.limit, []).append(row)
    return [
        f"{', '.join(row.named(parameters, row.path) for row in rows)}: to be {rows[0].relation}"
        f" {rows[0].named(parameters, limit)}, and taken as it is"
        for limit, rows in found.items()
    ]
