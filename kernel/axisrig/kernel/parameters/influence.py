"""What parameters that do not act would change on the machine: `influence.csv` by path.

Classes of `influence_groups.csv`: `without` has no influence here, for a reason; `must` would
change what a run shows, so that only its neutral value, the default of its row, may pass.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

from axisrig.kernel.parameters.table import Kind


@dataclass(frozen=True)
class Group:
    """Parameters with one reason. must_act: only neutral values of them may pass."""

    name: str
    must_act: bool
    reason: str


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def groups() -> Mapping[str, Group]:
    """Read the groups by name."""
    return {
        row["group"]: Group(row["group"], row["class"] == "must", row["reason"])
        for row in _rows("influence_groups.csv")
    }


@cache
def _by_path() -> Mapping[tuple[str, str], Group]:
    known = groups()
    return {(row["kind"], row["path"]): known[row["group"]] for row in _rows("influence.csv")}


def group_of(kind: Kind, path: str) -> Group | None:
    """Return the group of a row by its path, None for one that acts or has no class."""
    return _by_path().get((kind, path))


def grouped() -> list[tuple[str, str]]:
    """Return kind and path of every parameter that has a class."""
    return list(_by_path())
