"""CiA 402 as both ends take it: states, commands, transitions, touch probe bits.

The tables are `ds402_states.csv`, `ds402_commands.csv` and `ds402_transitions.csv`; the
transition numbers are those of the standard. Source: CiA 402-2, finite state automaton and touch
probe function (objects 6040, 6041, 60B8 to 60BD).
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntFlag, auto
from importlib import resources
from typing import Final, Literal

# Probe inputs are 1 and 2, edges are the words of P-AXIS-00518
EDGES: Final = ("POS", "NEG")


class State(Enum):
    """State of the power drive system; statusword patterns in `STATES`."""

    __hash__ = object.__hash__  # tables are asked in every cycle; that of Enum is in Python

    NOT_READY_TO_SWITCH_ON = auto()
    SWITCH_ON_DISABLED = auto()
    READY_TO_SWITCH_ON = auto()
    SWITCHED_ON = auto()
    OPERATION_ENABLED = auto()
    QUICK_STOP_ACTIVE = auto()
    FAULT_REACTION_ACTIVE = auto()
    FAULT = auto()


class Command(Enum):
    """Command of the controlword; bit patterns in `COMMANDS`."""

    SHUTDOWN = auto()
    SWITCH_ON = auto()
    ENABLE_OPERATION = auto()
    DISABLE_VOLTAGE = auto()
    QUICK_STOP = auto()
    FAULT_RESET = auto()


class Status(IntFlag):
    """Bits of the statusword 6041 beside those that give the state; bit 12 as the mode says."""

    VOLTAGE_ENABLED = 1 << 4
    WARNING = 1 << 7
    REMOTE = 1 << 9
    TARGET_REACHED = 1 << 10
    INTERNAL_LIMIT = 1 << 11
    FOLLOWS_COMMAND = 1 << 12
    SET_POINT_ACKNOWLEDGE = 1 << 12
    SPEED_ZERO = 1 << 12
    HOMING_ATTAINED = 1 << 12
    FOLLOWING_ERROR = 1 << 13
    HOMING_ERROR = 1 << 13


class ProbeFunction(IntFlag):
    """Bits of the touch probe function 60B8; without a source bit the probe input is used."""

    ENABLE_1 = 1 << 0
    CONTINUOUS_1 = 1 << 1
    INDEX_1 = 1 << 2
    OBJECT_1 = 1 << 3
    POSITIVE_1 = 1 << 4
    NEGATIVE_1 = 1 << 5
    ENABLE_2 = 1 << 8
    CONTINUOUS_2 = 1 << 9
    INDEX_2 = 1 << 10
    OBJECT_2 = 1 << 11
    POSITIVE_2 = 1 << 12
    NEGATIVE_2 = 1 << 13


class ProbeStatus(IntFlag):
    """Bits of the touch probe status 60B9."""

    ENABLED_1 = 1 << 0
    POSITIVE_STORED_1 = 1 << 1
    NEGATIVE_STORED_1 = 1 << 2
    ENABLED_2 = 1 << 8
    POSITIVE_STORED_2 = 1 << 9
    NEGATIVE_STORED_2 = 1 << 10


@dataclass(frozen=True)
class StatePattern:
    """A state in the statusword (`word & mask == value`) and the controlword that keeps it.

    power: what it means for the control, by the names of `drives.power.Power`.
    """

    mask: int
    value: int
    hold: int
    power: str


@dataclass(frozen=True)
class CommandPattern:
    """A command in the controlword (`word & mask == value`); `rising`: only when it was not so."""

    mask: int
    value: int
    rising: bool


@dataclass(frozen=True)
class Transition:
    """A row of `ds402_transitions.csv`.

    source: None means power on ("" in the table) and for any state ("*", number 13).
    event: a command, or "AUTOMATIC" or "ERROR". on_path: whether a master takes it by choice.
    """

    number: int
    source: State | None
    target: State
    event: Command | Literal["AUTOMATIC", "ERROR"]
    on_path: bool


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def _event(word: str) -> Command | Literal["AUTOMATIC", "ERROR"]:
    if word == "AUTOMATIC":
        return "AUTOMATIC"
    return "ERROR" if word == "ERROR" else Command[word]


STATES: Final[Mapping[State, StatePattern]] = {
    State[row["state"]]: StatePattern(
        int(row["mask"], 0), int(row["value"], 0), int(row["hold"], 0), row["power"]
    )
    for row in _rows("ds402_states.csv")
}
COMMANDS: Final[Mapping[Command, CommandPattern]] = {
    Command[row["command"]]: CommandPattern(
        int(row["mask"], 0), int(row["value"], 0), row["rising"] == "1"
    )
    for row in _rows("ds402_commands.csv")
}
TRANSITIONS: Final[tuple[Transition, ...]] = tuple(
    Transition(
        int(row["number"]),
        State[row["from"]] if row["from"] not in ("", "*") else None,
        State[row["to"]],
        _event(row["event"]),
        row["on_path"] == "1",
    )
    for row in _rows("ds402_transitions.csv")
)

PROBE_INPUT_BITS: Final[Mapping[int, int]] = {1: 16, 2: 17}
"""Bit of 60FD that shows the input of a probe.

The standard leaves bits 16 to 31 to the manufacturer; these are ours.
"""
