"""What DRIVE means for the servo, and what comes back (`power.csv`).

A drive that is enabled goes into operation step by step; without the enable it stops by its ramp
and goes off.
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final

from axisrig.bench.drive.cia402.servo import Servo
from axisrig.bench.drive.cyclic.power_states import STATE_OF, PowerState
from axisrig.kernel.profiles.speed_drive import words


class PowerInput(Enum):
    """What DRIVE asks for; the first one that holds counts, OFF where none does."""

    __hash__ = object.__hash__

    RESET = auto()
    ENABLE = auto()
    OFF = auto()


def _read() -> Mapping[tuple[PowerState, PowerInput], str]:
    text = resources.files(__package__ or "").joinpath("power.csv").read_text(encoding="utf-8")
    return {
        (PowerState[row["state"]], PowerInput[row["input"]]): row["command"]
        for row in csv.DictReader(text.splitlines())
    }


COMMANDS: Final = _read()
"""Command to the servo by state and input."""
CONTROLWORD: Final = {
    "DISABLE": 0x0000,
    "SHUTDOWN": 0x0006,
    "SWITCH_ON": 0x0007,
    "OPERATE": 0x000F,
    "RESET": 0x0080,
}
_STATUS: Final = {PowerState.OPERATION: words.OPERATES, PowerState.FAULT: words.FAULT}


def asked(control: int) -> PowerInput:
    """Return what DRIVE asks for."""
    if control & words.RESET:
        return PowerInput.RESET
    return PowerInput.ENABLE if control & words.ENABLE else PowerInput.OFF


def controlword(servo: Servo, control: int) -> int:
    """Return what DRIVE asks of the servo in its state, as 6040 says it."""
    return CONTROLWORD[COMMANDS[STATE_OF[servo.state], asked(control)]]


def status(servo: Servo) -> int:
    """Return DRIVE for the control."""
    return words.READY | _STATUS.get(STATE_OF[servo.state], 0)
