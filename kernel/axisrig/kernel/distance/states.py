"""States and commands of distance control, and which command leads where (`states.csv`).

Numbers: HLI_DIST_CTRL_STATE_* (TF5200 distance control 290206347) and HLI_DIST_CTRL_* (FCT-M3 10);
ERROR and ON_CONST_DIST take the next free ones.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib import resources


class DistanceState(IntEnum):
    """What distance control does; FREEZE and ERROR hold the offset, TURNING_OFF runs it out."""

    INACTIVE = 0
    ACTIVE = 1
    FREEZE = 2
    TURNING_OFF = 3
    ACTIVE_CONST_DIST = 4
    ERROR = 5


class DistanceCommand(IntEnum):
    """What the program or the PLC asks for; ON follows a surface."""

    OFF = 0
    ON = 1
    FREEZE = 2
    ON_CONST_DIST = 3


class Source(IntEnum):
    """Who commanded last."""

    NC = 0
    PLC = 1


# TF5200 diagnosis 1097815947
REFUSED_PLC = (310014,)

# States in which the offset follows the sensor
FOLLOWING = (DistanceState.ACTIVE, DistanceState.ACTIVE_CONST_DIST)


@dataclass(frozen=True)
class Change:
    """One row of `states.csv`.

    next: state after the command, None where it is refused. alarm_ids: with which a program's
    command is refused, newer and older ID; that of the PLC is refused with `REFUSED_PLC`.
    """

    next: DistanceState | None
    alarm_ids: tuple[int, ...]
    source: str


@cache
def changes() -> Mapping[tuple[DistanceState, DistanceCommand], Change]:
    """Read `states.csv`: a row for every state and command."""
    text = resources.files(__package__).joinpath("states.csv").read_text(encoding="utf-8")
    return {
        (DistanceState[row["state"]], DistanceCommand[row["command"]]): Change(
            next=DistanceState[row["next"]] if row["next"] else None,
            alarm_ids=tuple(map(int, row["alarm"].split())),
            source=row["source"],
        )
        for row in csv.DictReader(text.splitlines())
    }
