"""The measuring types 1 to 7 (P-CHAN-00057, #MEAS MODE) as a table."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class MeasuringType:
    """One row of `measuring_types.csv`.

    command: the G function that measures. axes_max: None = as many as there are. acts: whether it
    does something yet.
    """

    number: int
    command: str
    axes_max: int | None
    acts: bool


@cache
def measuring_types() -> Mapping[int, MeasuringType]:
    """Read the table, keyed by type."""
    text = resources.files(__package__).joinpath("measuring_types.csv").read_text("utf-8")
    return {
        int(row["type"]): MeasuringType(
            int(row["type"]),
            row["command"],
            int(row["axes_max"]) if row["axes_max"] else None,
            row["acts"] == "yes",
        )
        for row in csv.DictReader(text.splitlines())
    }
