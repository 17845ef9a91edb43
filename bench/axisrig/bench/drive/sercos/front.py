"""What the words S-0-0134 and S-0-0135 mean for the servo, and what it reports in class 1.

Sources: AX5000 ident descriptions 994816011 and 969164683; SERCOS: drive off stops the axis before
the torque goes, enable off takes it at once, halt keeps it.
"""

import csv
from functools import cache
from importlib import resources
from typing import Final, NamedTuple

from axisrig.bench.drive.cia402.functions.axis_states import AxisState
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.sercos import words

DISABLE, QUICK_STOP, SHUTDOWN, SWITCH_ON, OPERATE = 0x0000, 0x0002, 0x0006, 0x0007, 0x000F
HALT: Final = 1 << 8
RESET: Final = 1 << 7
_UP: Final = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY_TO_SWITCH_ON: SWITCH_ON,
    State.SWITCHED_ON: OPERATE,
    State.OPERATION_ENABLED: OPERATE,
    State.QUICK_STOP_ACTIVE: QUICK_STOP,
}
_MOVES: Final = (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
_READY: Final = {
    State.SWITCH_ON_DISABLED: words.LOGIC_READY,
    State.READY_TO_SWITCH_ON: words.LOGIC_READY,
    State.SWITCHED_ON: words.POWER_READY,
    State.OPERATION_ENABLED: words.OPERATES,
    State.QUICK_STOP_ACTIVE: words.OPERATES,
}
_OTHER_ERROR: Final = 15
_NUMBER_BASE: Final = 0xF0000


class Diagnosis(NamedTuple):
    """A row of `diagnoses.csv`. bit: of S-0-0011. number: S-0-0390. text: S-0-0095."""

    bit: int
    number: int
    text: str


NO_ERROR: Final = Diagnosis(0, 0xD0012, "")


@cache
def diagnoses() -> dict[int, Diagnosis]:
    """Read the table, by emergency code."""
    text = resources.files(__package__).joinpath("diagnoses.csv").read_text(encoding="utf-8")
    return {
        int(row["emergency"], 16): Diagnosis(int(row["bit"]), int(row["number"], 16), row["text"])
        for row in csv.DictReader(text.splitlines())
    }


class Front:
    """Both words of a drive. is_resetting: S-0-0099 wants the error away. control: S-0-0134."""

    def __init__(self, servo: Servo) -> None:
        self._servo = servo
        self.control = 0
        self.is_resetting = False
        self.error: Diagnosis | None = None

    def reset(self) -> None:
        """Be as after power on."""
        self.control, self.is_resetting, self.error = 0, False, None

    def report(self, code: int) -> None:
        """Take an emergency of the servo; 0: the error has gone."""
        if code:
            other = Diagnosis(_OTHER_ERROR, _NUMBER_BASE | code, f"error 0x{code:04X}")
            self.error = diagnoses().get(code, other)
        elif not self.has_error:  # else it was another one that has gone
            self.error = None

    def controlword(self) -> int:
        """Return what the present word asks of the servo, as 6040 says it."""
        state, control = self._servo.state, self.control
        if state in (State.FAULT, State.FAULT_REACTION_ACTIVE, State.NOT_READY_TO_SWITCH_ON):
            return RESET if self.is_resetting and state is State.FAULT else DISABLE
        if not control & words.ENABLE:
            return DISABLE
        if not control & words.ON:
            return QUICK_STOP if state in _MOVES else SHUTDOWN
        word = _UP[state]
        is_halted = state is State.OPERATION_ENABLED and not control & words.RUN
        return word | HALT if is_halted else word

    @property
    def has_error(self) -> bool:
        """Whether class 1 has an error, as the servo has one."""
        return self._servo.state in (State.FAULT, State.FAULT_REACTION_ACTIVE)

    def class_1(self) -> int:
        """Return S-0-0011."""
        return 1 << self.error.bit if self.error is not None and self.has_error else 0

    def status(self, *, command_changed: bool) -> int:
        """Return S-0-0135 without its real-time bits."""
        servo = self._servo
        word = _READY.get(servo.state, words.NOT_READY) << words.READY_SHIFT
        if self.has_error:
            word |= words.C1D
        if command_changed:
            word |= words.COMMAND_CHANGED
        if servo.state is State.OPERATION_ENABLED and servo.axis_state is AxisState.OPERATING:
            word |= words.FOLLOWS
        return word
