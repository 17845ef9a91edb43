"""State tables of the drive: `power.csv`, `functions.csv`, `interface.csv`."""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final

from axisrig.bench.drive.cyclic.power_states import PowerState


class PowerInput(Enum):
    """What STW1 asks for; the first one that holds counts."""

    __hash__ = object.__hash__

    OFF2 = auto()  # coast
    OFF3 = auto()  # quick stop
    OFF = auto()  # ramp, then off
    INHIBIT = auto()  # on, no torque
    HALT = auto()  # operation, and no set value
    OPERATE = auto()


class FunctionState(Enum):
    """State of one function of an encoder interface."""

    __hash__ = object.__hash__

    OFF = auto()
    ACTIVE = auto()  # waits for its edge
    VALUE = auto()  # has a value that nobody has read
    SHOWN = auto()  # G1_XIST2 shows it


class FunctionInput(Enum):
    """What happens to a function; WAIT: it is to be read, and another one has to end before."""

    __hash__ = object.__hash__

    NOTHING = auto()
    ACTIVATE = auto()
    READ = auto()
    WAIT = auto()
    ABORT = auto()
    EDGE = auto()


class InterfaceState(Enum):
    """State of an encoder interface."""

    __hash__ = object.__hash__

    READY = auto()
    ABSOLUTE = auto()  # G1_XIST2 shows the absolute position
    PARKED = auto()
    ERROR = auto()  # G1_XIST2 shows a code
    ACKNOWLEDGING = auto()


class InterfaceInput(Enum):
    """What is asked of an encoder interface as a whole."""

    __hash__ = object.__hash__

    NOTHING = auto()
    ABSOLUTE = auto()
    PARK = auto()
    WRONG = auto()  # what it cannot do, or not now
    ACKNOWLEDGE = auto()


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


COMMANDS: Final[Mapping[tuple[PowerState, PowerInput], str]] = {
    (PowerState[row["state"]], PowerInput[row["input"]]): row["command"]
    for row in _rows("power.csv")
}
"""Command to the servo by state and input."""
FUNCTION: Final[Mapping[tuple[FunctionState, FunctionInput], FunctionState]] = {
    (FunctionState[row["state"]], FunctionInput[row["input"]]): FunctionState[row["next"]]
    for row in _rows("functions.csv")
}
INTERFACE: Final[Mapping[tuple[InterfaceState, InterfaceInput], InterfaceState]] = {
    (InterfaceState[row["state"]], InterfaceInput[row["input"]]): InterfaceState[row["next"]]
    for row in _rows("interface.csv")
}
