"""Where the signal of a measurement run comes from (P-AXIS-00516, `signal_sources.csv`)."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Final, Literal, cast

Latched = Literal["drive", "signal", "stamp", "held", "none"]
"""What gives the position: the drive; the cycle that sees the signal of the PLC; the time stamp of
the PLC; external hardware or else the signal; a fixed stop latches nothing."""


@dataclass(frozen=True)
class SignalSource:
    """A row of the table.

    inputs: the highest probing input (P-AXIS-00517), None where it uses none. needs_plc: it needs a
    task of the PLC. Which drives have it: `drive_types.DriveType.offers`.
    """

    inputs: int | None
    latched: Latched
    needs_plc: bool


def _read() -> Mapping[str, SignalSource]:
    text = resources.files(__package__).joinpath("signal_sources.csv").read_text(encoding="utf-8")
    return {
        row["signal"]: SignalSource(
            int(row["inputs"]) if row["inputs"] else None,
            cast(Latched, row["latched"]),
            row["needs_plc"] == "yes",
        )
        for row in csv.DictReader(text.splitlines())
    }


SOURCES: Final = _read()


def latched(*kinds: Latched) -> tuple[str, ...]:
    """Return the sources whose position is latched in one of these ways."""
    return tuple(name for name, source in SOURCES.items() if source.latched in kinds)
