"""What an axis does at its drive, and what changes that (`axis_states.csv`).

The states of CiA 402 say what the drive may do with its axis; these say what it does: whether the
mode of operation has the axis, or a stop, and what follows the stop.
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final


class AxisState(Enum):
    """Who has the axis."""

    OFF = auto()
    """Nobody: there is no power."""
    OPERATING = auto()
    """The mode of operation."""
    STOPPING = auto()
    """A stop, until the state of the drive changes."""
    HALTED = auto()
    """A stop by bit 8 of the controlword."""
    BEGINNING = auto()
    """A stop, if one is under way; the mode begins as soon as it may have the axis."""
    RESUMING = auto()
    """The same after a halt: the mode resumes what it did."""


class AxisEvent(Enum):
    """What happens to it."""

    POWER_OFF = auto()
    """The torque goes off."""
    STOP = auto()
    """A ramp of 605A, 605B, 605C or 605E begins."""
    HALT = auto()
    """Bit 8 of the controlword is 1, in operation enabled."""
    HALT_ENDS = auto()
    """It is 0."""
    LIMIT_SWITCH = auto()
    """The axis has met a limit switch."""
    MODE = auto()
    """6060 asks for another mode."""
    ENABLE = auto()
    """Transition 4 or 16, or a stop is called off."""
    READY = auto()
    """The mode may have the axis: it is at standstill, or the mode takes it over as it moves."""


def _read() -> dict[tuple[AxisState, AxisEvent], AxisState]:
    text = resources.files(__package__).joinpath("axis_states.csv").read_text(encoding="utf-8")
    return {
        (AxisState[row["state"]], AxisEvent[row["event"]]): AxisState[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


NEXT: Final[Mapping[tuple[AxisState, AxisEvent], AxisState]] = _read()
"""The state after an event, for every pair."""
