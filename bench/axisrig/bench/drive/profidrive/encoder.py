"""The encoder interface G1: flying measurement, absolute position, errors.

A function is activated, waits for its edge and then has a value; it is read by a command, and only
when no function waits any more. Where something cannot be done all functions end, and G1_XIST2 has
an error code until it is acknowledged. The tables are `functions.csv` and `interface.csv`.
Source: SINAMICS S120 4-113, SIMODRIVE 611 universal p. 248, MASTERDRIVES MC 8.2
(docs/profidrive.md).
"""

from collections.abc import Callable
from typing import Final, Protocol

from axisrig.bench.drive.profidrive.tables import (
    FUNCTION,
    INTERFACE,
    FunctionInput,
    FunctionState,
    InterfaceInput,
    InterfaceState,
)
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus
from axisrig.kernel.profiles.profidrive import words

SUPPORTED: Final = words.FUNCTION_OF[1, "POS"] | words.FUNCTION_OF[1, "NEG"]
"""One probe at each encoder, as SIMODRIVE 611 universal has it."""
_EDGES: Final = (int(ProbeFunction.POSITIVE_1), int(ProbeFunction.NEGATIVE_1))
_STORED: Final = (int(ProbeStatus.POSITIVE_STORED_1), int(ProbeStatus.NEGATIVE_STORED_1))
_ENABLE: Final = int(ProbeFunction.ENABLE_1)
_OFF, _ACTIVE = FunctionState.OFF, FunctionState.ACTIVE
_COMMANDS: Final = {
    words.ACTIVATE: FunctionInput.ACTIVATE,
    words.READ: FunctionInput.READ,
    words.ABORT: FunctionInput.ABORT,
}
_SHOWN_BITS: Final = {
    InterfaceState.ABSOLUTE: words.ABSOLUTE,
    InterfaceState.PARKED: words.PARK,
    InterfaceState.ERROR: words.ENCODER_ERROR,
    InterfaceState.ACKNOWLEDGING: words.ACKNOWLEDGING,
}


class ProbePort(Protocol):
    """The touch probe unit. status: as 60B9. inputs: levels, bit 0 of input 1."""

    @property
    def status(self) -> int: ...  # noqa: D102
    @property
    def inputs(self) -> int: ...  # noqa: D102


class EncoderInterface:
    """One interface. has_input: P0660 gives the fast input to the probe.

    holds_other: by a fault; functions that nobody asked for are active. states: of functions 1 and
    2. state: of the interface. values: latched at the edges of both.
    """

    def __init__(self, probe: ProbePort, *, has_input: Callable[[], bool]) -> None:
        self._probe, self._has_input = probe, has_input
        self.states = [_OFF, _OFF]
        self.state = InterfaceState.READY
        self.values = [0, 0]
        self._code = 0
        self._control = 0
        self.holds_other = False

    def reset(self) -> None:
        """Be as after power on."""
        self.states = [_OFF, _OFF]
        self.state = InterfaceState.READY
        self._code = self._control = 0

    def break_off(self, code: int) -> None:
        """End all functions with an error code, by a fault of the encoder."""
        self._code, self.state = code, InterfaceState.ERROR
        self.states = [_OFF, _OFF]

    def take_edges(self, latched: tuple[int, int]) -> None:
        """Take the edges until now. latched: positions of the last rising and falling one."""
        status = self._probe.status
        for number, stored in enumerate(_STORED):
            if self.states[number] is _ACTIVE and status & stored:
                self.values[number] = latched[number]
                self._change(number, FunctionInput.EDGE)

    def command(self, control: int) -> None:
        """Take G1_STW, after the edges until now."""
        asked = self._asked(control)
        self.state = INTERFACE[self.state, asked]
        self._control = control
        if self.state is InterfaceState.ERROR:
            self.states = [_OFF, _OFF]
        else:
            self._command_functions(control)

    def _asked(self, control: int) -> InterfaceInput:
        is_edge = not self._control & words.ENCODER_ACKNOWLEDGE
        if control & words.ENCODER_ACKNOWLEDGE and (
            is_edge or self.state is InterfaceState.ACKNOWLEDGING
        ):
            return InterfaceInput.ACKNOWLEDGE
        elsewhere = control & (words.ABSOLUTE | words.PARK)
        activates = control >> words.COMMAND_SHIFT & words.COMMAND_MASK == words.ACTIVATE
        errors = words.encoder_errors()
        if activates and control & words.FUNCTIONS and not control & words.FLYING:
            self._code = errors["REFERENCE"]
            return InterfaceInput.WRONG
        if activates and (elsewhere or control & words.FUNCTIONS & ~SUPPORTED):
            self._code = errors["MEASUREMENT"]
            return InterfaceInput.WRONG
        if elsewhere and _ACTIVE in self.states:
            self._code = errors["MEASUREMENT"]
            return InterfaceInput.WRONG
        if control & words.PARK:
            return InterfaceInput.PARK
        return InterfaceInput.ABSOLUTE if elsewhere else InterfaceInput.NOTHING

    def _command_functions(self, control: int) -> None:
        command = control >> words.COMMAND_SHIFT & words.COMMAND_MASK
        for number in range(len(self.states)):
            is_meant = bool(control & 1 << number)
            asked = _COMMANDS.get(command, FunctionInput.NOTHING)
            if not is_meant:
                asked = FunctionInput.NOTHING
            elif asked is FunctionInput.READ and not self._may_show(number):
                asked = FunctionInput.WAIT
            self._change(number, asked)

    def _may_show(self, number: int) -> bool:
        others = [state for other, state in enumerate(self.states) if other != number]
        is_waiting = self.holds_other or _ACTIVE in self.states
        return not is_waiting and FunctionState.SHOWN not in others

    def _change(self, number: int, asked: FunctionInput) -> None:
        self.states[number] = FUNCTION[self.states[number], asked]

    def function(self) -> int:
        """Return what the touch probe unit has to do, as 60B8 says it."""
        if not self._has_input():
            return 0
        word = sum(
            edge for state, edge in zip(self.states, _EDGES, strict=True) if state is _ACTIVE
        )
        return word | _ENABLE if word else 0

    def status(self) -> int:
        """Return G1_ZSW."""
        word = _SHOWN_BITS.get(self.state, 0)
        for number, state in enumerate(self.states):
            if state is _ACTIVE or (state is _OFF and self.holds_other):
                word |= 1 << number
            elif state is not _OFF:
                word |= 1 << number + words.VALUE_SHIFT
        if self._has_input() and self._probe.inputs & 1:
            word |= words.DEFLECTED[0]
        return word

    def value(self, absolute: int) -> int:
        """Return G1_XIST2. absolute: the absolute position."""
        if self.state is InterfaceState.ERROR:
            return self._code
        if self.state is InterfaceState.ABSOLUTE:
            return absolute
        for state, value in zip(self.states, self.values, strict=True):
            if state is FunctionState.SHOWN:
                return value
        return 0
