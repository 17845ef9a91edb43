"""What STW1 means for the servo, and ZSW1 (`power.csv`). Source: SINAMICS G120C p. 235."""

from typing import Final

from axisrig.bench.drive.cia402.servo import Servo
from axisrig.bench.drive.cyclic.power_states import STATE_OF, PowerState
from axisrig.bench.drive.profidrive.tables import COMMANDS, PowerInput
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.profidrive import words

CONTROLWORD: Final = {
    "DISABLE": 0x0000,
    "QUICK_STOP": 0x0002,
    "SHUTDOWN": 0x0006,
    "SWITCH_ON": 0x0007,
    "OPERATE": 0x000F,
    "HALT": 0x010F,
}
RESET: Final = 0x0080
_STATUS: Final = {
    PowerState.INHIBITED: words.INHIBITED,
    PowerState.READY: 1 << 0,
    PowerState.ON: words.READY,
    PowerState.OPERATION: words.READY | words.OPERATES,
    PowerState.STOPPING: words.READY,
    PowerState.FAULT: words.FAULT,
}
_OFF_SHIFT: Final = 3
"""From no OFF2 and no OFF3 in STW1 to the same in ZSW1."""


def asked(control: int) -> PowerInput:
    """Return what STW1 asks for."""
    if not control & words.NO_OFF2:
        return PowerInput.OFF2
    if not control & words.NO_OFF3:
        return PowerInput.OFF3
    if not control & words.ON:
        return PowerInput.OFF
    if not control & words.ENABLE:
        return PowerInput.INHIBIT
    if control & words.SETPOINT != words.SETPOINT:
        return PowerInput.HALT
    return PowerInput.OPERATE


def power_state(servo: Servo) -> PowerState:
    """Return the state of the drive."""
    return STATE_OF[servo.state]


def controlword(servo: Servo, control: int) -> int:
    """Return what STW1 asks of the servo in its state, as 6040 says it."""
    if servo.state is State.FAULT and control & words.ACKNOWLEDGE:
        return RESET
    return CONTROLWORD[COMMANDS[power_state(servo), asked(control)]]


def status(servo: Servo, control: int) -> int:
    """Return ZSW1."""
    shown = (control & (words.NO_OFF2 | words.NO_OFF3)) << _OFF_SHIFT
    return _STATUS[power_state(servo)] | shown | words.CONTROL_REQUESTED
