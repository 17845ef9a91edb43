"""The distributed clock of one slave: local copy of the system time, and how it follows.

Source: docs/ethercat.md, which also lists what is inferred in the control loop. The local copy is
local time + offset + correction. Each time that the reference clock's frame brings is compared
with it, and the correction follows: half of the difference at once, and its rate by an eighth of
what that came to for each ns since the time before. A real controller counts 9, 10 or 11 for each
10 ns, so that the copy never moves by more than a tenth of the time that has passed.
"""

from typing import Final

from axisrig.bench.drive.ethercat.local_clock import MASK_64, LocalClock
from axisrig.kernel.time.clock import S, TimeNs

_MASK_32: Final = 0xFFFF_FFFF
AHEAD: Final = 1 << 31
"""Bit of the difference: the local copy is not behind."""
_AMOUNT_MAX: Final = AHEAD - 1
_STEP_DIVISOR: Final = 2
_RATE_DIVISOR: Final = 8
_SLEW: Final = 10
_SHORT: Final = 1 << 62
_SMALL: Final = 1 << 31
"""Below these numbers nothing wraps; short ones take a compiled build a tenth of the time."""


class DistributedClock:
    """Local copy of the system time of one slave.

    offset: register 0920. delay: register 0928. difference: register 092C, as of the last time
    that came; sign and amount. steps: how often the local copy was moved by a master or a time.
    """

    def __init__(self, local: LocalClock) -> None:
        self.local = local
        self.offset = self.delay = self.difference = 0
        self.steps = 0
        self._shift = 0  # the offset with a sign
        self._correction = 0
        self._rate = 0  # parts of 1e9
        self._since_ns: TimeNs = 0
        self._last_ns: TimeNs | None = None

    def reset(self) -> None:
        """Be as after power on; the oscillator goes on."""
        self.offset = self._shift = self.delay = self.difference = 0
        self.forget(0)
        self._correction = 0
        self.steps += 1

    def jump(self, by_ns: TimeNs) -> None:
        """Let the oscillator show something else from now on."""
        self.local.jump(by_ns)
        self.steps += 1

    def forget(self, now_ns: TimeNs) -> None:
        """Drop what was learned of the reference's rate, as a write of 0930 does."""
        self._settle(now_ns)
        self._rate = 0
        self._last_ns = None
        self.steps += 1

    def set_offset(self, offset: int, now_ns: TimeNs) -> None:
        """Take register 0920: the local copy is local time and this from now on."""
        if offset == self.offset:
            return
        self.offset, self._shift = offset, signed(offset, 64)
        self._correction, self._since_ns = 0, now_ns
        self.steps += 1

    def system_ns(self, time_ns: TimeNs) -> int:
        """Return the local copy of the system time at an instant, 64 bits."""
        moved = self._correction
        if self._rate:
            moved += (time_ns - self._since_ns) * self._rate // S
        system = self.local.at(time_ns) + self._shift + moved
        return system if 0 <= system < _SHORT else system & MASK_64

    def instant_ns(self, system: int, now_ns: TimeNs) -> TimeNs:
        """Return the first instant from now on at which the local copy shows at least `system`.

        As the clock runs now; now itself where the copy is past it. `system` is within 2^63.
        """
        left = signed(system - self.system_ns(now_ns), 64)
        if left <= 0:
            return now_ns
        if not self.local.parts and not self._rate:
            return now_ns + left
        time_ns = now_ns + left * S // (S + self.local.parts + self._rate)
        # Rounding of either may be off by one
        while signed(self.system_ns(time_ns) - system, 64) >= 0 and time_ns > now_ns:
            time_ns -= 1
        while signed(self.system_ns(time_ns) - system, 64) < 0:
            time_ns += 1
        return time_ns

    def follow(self, received: int, bits: int, time_ns: TimeNs) -> None:
        """Take a time of the reference clock whose frame came at `time_ns`. bits: 32 or 64."""
        copy = self.system_ns(time_ns) - self.delay
        ahead = signed(copy - received, bits)
        self.difference = _sign_and_amount(ahead)
        last_ns, self._last_ns = self._last_ns, time_ns
        passed_ns = 0 if last_ns is None else time_ns - last_ns
        if passed_ns <= 0:
            return
        self._settle(time_ns)
        most = passed_ns // _SLEW
        wanted = _toward_zero(ahead, _STEP_DIVISOR) or ahead
        # What is cut off says nothing of the rate
        rate = ahead * S // (passed_ns * _RATE_DIVISOR) if abs(wanted) <= most else 0
        self._rate = max(-S // _SLEW, min(self._rate - rate, S // _SLEW))
        most -= abs(self._rate) * passed_ns // S  # until the next time the rate moves it so far
        step = max(-most, min(wanted, most))
        if step:
            self._correction -= step
        if step or rate:
            self.steps += 1

    def _settle(self, now_ns: TimeNs) -> None:
        self._correction += (now_ns - self._since_ns) * self._rate // S
        self._since_ns = now_ns


def _toward_zero(value: int, divisor: int) -> int:
    return value // divisor if value >= 0 else -(-value // divisor)


def signed(value: int, bits: int) -> int:
    """Return the number with a sign that the lowest bits are; bits: 32 or more."""
    if -_SMALL <= value < _SMALL:
        return value
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> bits - 1 else value


def _sign_and_amount(ahead: int) -> int:
    amount = min(abs(ahead), _AMOUNT_MAX)
    return amount | (AHEAD if ahead >= 0 else 0)
