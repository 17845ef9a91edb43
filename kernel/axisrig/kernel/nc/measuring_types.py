"""The measuring types 1 to 7 (P-CHAN-00057, #MEAS MODE) as a table."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class MeasuringType:
    """One row of `measuring_types.csv`.

    command: the G function that measures. axes_max: None = as many as there are. main_axes_only:
    other axes may not be named. has_own_speed: P-AXIS-00215 instead of F. keeps_stroke: the speed
    is lowered for P-AXIS-00086. overtravel: the parameters that lengthen the path, the first that
    is not 0 counts. no_signal: what decides about an alarm when no signal comes, or `alarm`, or
    `goes on`. runs_to_stop: standstill at a fixed stop is the signal. needs_sercos: one axis of it
    has to have a SERCOS drive.
    """

    number: int
    command: str
    axes_max: int | None
    main_axes_only: bool
    has_own_speed: bool
    keeps_stroke: bool
    overtravel: tuple[str, ...]
    no_signal: str
    runs_to_stop: bool
    needs_sercos: bool
    meaning: str


@cache
def measuring_types() -> Mapping[int, MeasuringType]:
    """Read the table, keyed by type."""
    text = resources.files(__package__).joinpath("measuring_types.csv").read_text("utf-8")
    return {
        int(row["type"]): MeasuringType(
            int(row["type"]),
            row["command"],
            int(row["axes_max"]) if row["axes_max"] else None,
            row["axes"] == "main",
            row["speed"] == "P-AXIS-00215",
            row["stroke"] == "yes",
            tuple(row["overtravel"].split()),
            row["no_signal"],
            row["signal"] == "fixed stop",
            row["needs_sercos"] == "yes",
            row["meaning"],
        )
        for row in csv.DictReader(text.splitlines())
    }
