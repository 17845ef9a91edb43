"""Which kinematics there are, which of them act, and what their offsets mean: two tables."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class KinematicType:
    """One row of `kinematics.csv`.

    axes: names of the axes in their order, empty where lists choose them. acts: whether it can be
    switched on; if not, reason says why.
    """

    id: int
    name: str
    axes: tuple[str, ...]
    acts: bool
    reason: str
    source: str


@dataclass(frozen=True)
class Offset:
    """One row of `offsets.csv`: HD number hd of kinematic id, `param[hd - 1]`."""

    id: int
    hd: int
    unit: str
    meaning: str


@cache
def kinematic_types() -> Mapping[int, KinematicType]:
    """Read `kinematics.csv`, keyed by ID."""
    return {
        int(row["id"]): KinematicType(
            int(row["id"]),
            row["name"],
            tuple(row["axes"].split()),
            row["acts"] == "yes",
            row["reason"],
            row["source"],
        )
        for row in _rows("kinematics.csv")
    }


@cache
def offsets() -> tuple[Offset, ...]:
    """Read `offsets.csv`."""
    return tuple(
        Offset(int(row["id"]), int(row["hd"]), row["unit"], row["meaning"])
        for row in _rows("offsets.csv")
    )


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))
