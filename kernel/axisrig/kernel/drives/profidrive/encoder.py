"""The encoder interface G1 as the control uses it: flying measurement, absolute position, errors.

A run activates one function, waits until no function waits for an edge any more and a value is
there, and reads it. What G1_XIST2 has is a value only while G1_ZSW says neither error nor absolute
position, and it counts when two telegrams after the command to read have the same. A run begins
only after a telegram without function, value and error, so that a value is never one of an earlier
run. Source: SINAMICS S120 4-113, SIMODRIVE 611 universal p. 248 (docs/profidrive.md).
"""

from enum import Enum, auto
from typing import Final

from axisrig.kernel.drives.position_check import Answered
from axisrig.kernel.profiles.profidrive import words

_USED: Final = words.ACTIVE | words.VALUES
_SHOWS_OTHER: Final = words.ENCODER_ERROR | words.ABSOLUTE | words.PARK | words.ACKNOWLEDGING


class Goal(Enum):
    """What the control wants of the interface."""

    IDLE = auto()
    MEASURE = auto()
    ABSOLUTE = auto()


class EncoderControl:
    """One interface. increments: latched and read, None before that. has_latched: a value is there.

    echo_cycles: from a word to the telegram that the drive has made after it. error: code in
    G1_XIST2, None while G1_ZSW reports none.
    """

    def __init__(self, function: int, echo_cycles: int) -> None:
        self._function, self._echo = function, echo_cycles
        self._goal = Goal.IDLE
        self._word = 0
        self._age = echo_cycles  # telegrams since the word changed
        self._status = 0
        self._was_clear = False
        self.has_latched = False
        self._is_active = False
        self.increments: int | None = None
        self._read: int | None = None
        self.speed_increments = 0
        self._last_actual: int | None = None
        self.error: int | None = None
        self._answered: Answered | None = None

    def take(self, status: int, value: int, actual: int) -> None:
        """Take G1_ZSW, G1_XIST2 and G1_XIST1 of a cycle."""
        self._status = status
        self._age = min(self._age + 1, self._echo)
        moved = 0 if self._last_actual is None else words.signed(actual - self._last_actual)
        self._last_actual = actual
        self.error = value if status & words.ENCODER_ERROR else None
        if self._age < self._echo or self._wanted() != self._word:
            return
        if self._goal is Goal.MEASURE:
            self._measure(status, value, moved)
        elif self._goal is Goal.ABSOLUTE and self._answered is not None:
            self._take_absolute(status, value)
        elif not self._word and not status & (_USED | _SHOWS_OTHER):
            self._was_clear = True

    def _measure(self, status: int, value: int, moved: int) -> None:
        is_there = bool(status & self._function << words.VALUE_SHIFT)
        self._is_active = bool(status & self._function) or (is_there and self._was_clear)
        if status & (words.ACTIVE | _SHOWS_OTHER) or not is_there or not self._was_clear:
            self._read = None
        elif not self.has_latched:
            self.has_latched, self.speed_increments = True, moved
        elif self._read == value and self.increments is None:
            self.increments = value
        else:
            self._read = value

    def _take_absolute(self, status: int, value: int) -> None:
        answered, self._answered = self._answered, None
        self._goal = Goal.IDLE
        assert answered is not None, "asked for"
        if status & words.ABSOLUTE and self.error is None:
            answered(value)
        else:
            answered(f"G1_ZSW 0x{status:04X}, G1_XIST2 {value}")

    @property
    def control(self) -> int:
        """G1_STW for the next telegram."""
        word = self._wanted()
        if word != self._word:
            self._word, self._age = word, 0
        return word

    def _wanted(self) -> int:
        if self._goal is Goal.ABSOLUTE:
            return words.ABSOLUTE
        if self._goal is Goal.MEASURE:
            command = words.READ if self.has_latched else words.ACTIVATE
            return self._function | command << words.COMMAND_SHIFT | words.FLYING
        status = self._status
        if status & words.ENCODER_ERROR:
            return words.ENCODER_ACKNOWLEDGE
        used = (status | status >> words.VALUE_SHIFT) & words.FUNCTIONS
        return used | words.ABORT << words.COMMAND_SHIFT | words.FLYING if used else 0

    @property
    def is_ordered(self) -> bool:
        """Whether a latch has been ordered on and not off again."""
        return self._goal is Goal.MEASURE

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither function nor value, and nothing is asked of it."""
        return self._goal is Goal.IDLE and self._was_clear

    @property
    def is_armed(self) -> bool:
        """Whether the drive waits for the edge, or has its value; the watch names an error."""
        has_any = self._is_active or self.has_latched or self.error is not None
        return self.is_ordered and has_any

    def is_deflected(self, probe_input: int) -> bool:
        """Whether a probe is deflected."""
        return bool(self._status & words.DEFLECTED[probe_input - 1])

    def arm(self) -> None:
        """Activate the function with the next telegram."""
        self._goal = Goal.MEASURE
        self.has_latched = self._is_active = False
        self.increments = self._read = None

    def disarm(self) -> None:
        """End the function with the next telegram."""
        if self._goal is Goal.MEASURE:
            self._goal, self._was_clear = Goal.IDLE, False

    def ask_absolute(self, answered: Answered) -> bool:
        """Ask for the absolute position; return whether there is room for that now."""
        if not self.is_clear:
            return False
        self._goal, self._was_clear = Goal.ABSOLUTE, False
        self._answered = answered
        return True
