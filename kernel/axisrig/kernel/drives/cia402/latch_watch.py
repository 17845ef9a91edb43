"""When a latched position is believed: the kernel's watch over the touch probe of one drive.

60BA keeps the position of the run before, and frames can be lost, late, doubled or swapped. So a
value counts only with a proof that it belongs to the latch that 60B9 reports:

- by the counter (60D5 to 60D8 in one telegram with the position): it is exactly one more than
  while the probe was off. A frame from before the latch has another count.
- by repetition, where the counter has no room on the bus or the drive has none: the position is
  reported by SYNCs in a row, two when it was never reported before, else `SAME_VALUE_CYCLES`.

Either way the position must be where the axis was. What contradicts itself is an alarm, never a
value. Source: docs/touch-probe.md.
"""

from collections import deque
from itertools import pairwise
from math import ceil, copysign, floor, sqrt
from typing import Final

from axisrig.kernel.errors import Alarm

REPEATED_CYCLES: Final = 2
SAME_VALUE_CYCLES: Final = 8
# A counter that goes back has been cleared when it is reported so often in a row; else it was late
CLEARED_CYCLES: Final = 4
OLD_VALUES: Final = 8
# A counter may be ahead of 60B9 for as long as drives are known to be late with it
UNSHOWN_CYCLES_MAX: Final = 4
# The latch is within the travel of the last cycles: delays and filters look back so far
TRAVEL_CYCLES: Final = 32
# Motor encoder and load may differ by backlash and wind-up
TOLERANCE_MM: Final = 0.1
_COUNTER_MASK: Final = 0xFFFF
_COUNTER_HALF: Final = 0x8000


class LatchWatch:
    """One edge of one probe of a drive.

    enabled_bit, stored_bit: of 60B9. increments_per_mm: of 6064 and of the latch.
    plausible_increments: between these a latch would have been believed.
    """

    def __init__(
        self, axis: str, enabled_bit: int, stored_bit: int, increments_per_mm: float
    ) -> None:
        self._axis, self._per_mm = axis, increments_per_mm
        self._enabled_bit, self._stored_bit = enabled_bit, stored_bit
        self.restart()

    def restart(self) -> None:
        """Forget everything: the drive has restarted, its counter and positions are new."""
        self._status = 0
        self.is_ordered = False
        self._count_before: int | None = None
        self._cleared: tuple[int, int] = (0, 0)  # a count that goes back, and how often in a row
        self._old_values: deque[int] = deque(maxlen=OLD_VALUES)
        self._at_rest: tuple[int | None, int | None] | None = None
        self._forget()

    def _forget(self) -> None:
        self.increments: int | None = None
        self.plausible_increments = (0, 0)
        self.speed_increments = 0.0  # per cycle, at the latch
        self._was_stored = False
        self._repeated: int | None = None
        self._cycles = self._unshown_cycles = 0
        self._travel: deque[int] = deque(maxlen=TRAVEL_CYCLES)

    def arm(self) -> None:
        """Take note that the probe is switched on with the next telegram."""
        self._forget()
        self._at_rest = None
        self.is_ordered = True

    def disarm(self) -> None:
        """Take note that the probe is switched off; there is no value from now on."""
        self._forget()
        self.is_ordered = False

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled probe nor a stored edge."""
        return not self._status & (self._enabled_bit | self._stored_bit)

    @property
    def is_armed(self) -> bool:
        """Whether the drive has acknowledged the enabled probe."""
        return bool(self._status & self._enabled_bit)

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a stored edge."""
        return bool(self._status & self._stored_bit)

    def miss(self) -> None:
        """Take note that this cycle has no 60B9: what repeats is counted anew."""
        self._cycles = 0

    def take(self, status: int, value: int | None, count: int | None, actual: int) -> None:
        """Take what one SYNC delivered: 60B9, latch and counter (None: not there), and 6064.

        Raises Alarm 900060 to 900064 for what contradicts itself.
        """
        self._status = status
        if not self.is_ordered and (value, count) == self._at_rest:
            return  # nothing new
        is_stored = self.is_armed and self.has_latched
        if count is not None and not is_stored:
            self._rest(count)
        if not self.is_ordered:
            if value is not None and value not in self._old_values:
                self._old_values.append(value)
            is_known = count == self._count_before and not is_stored
            self._at_rest = (value, count) if is_known else None
            return
        self._travel.append(actual)
        self._check_kept(status)
        if count is not None and self._count_before is not None:
            self._by_counter(is_stored, value, count)
        elif is_stored:
            self._by_repetition(value)

    def _rest(self, count: int) -> None:
        """Learn the count before the latch; it goes on, unless the drive clears its counters."""
        before = self._count_before
        if before is None or (not self.is_ordered and _ahead(count, before) < _COUNTER_HALF):
            self._count_before, self._cleared = count, (0, 0)
        elif _ahead(count, before) >= _COUNTER_HALF:
            known, cycles = self._cleared
            self._cleared = count, cycles + 1 if count == known else 1
            if self._cleared[1] >= CLEARED_CYCLES:
                self._count_before, self._cleared = count, (0, 0)

    def _check_kept(self, status: int) -> None:
        """Refuse a latch that vanishes; a probe that is off altogether is for the run to report."""
        if self._was_stored and self.is_armed and not self.has_latched:
            raise Alarm(900062, axis=self._axis, status=f"0x{status:04X}")
        self._was_stored = self.has_latched

    def _by_counter(self, is_stored: bool, value: int | None, count: int) -> None:
        assert self._count_before is not None
        latches = _ahead(count, self._count_before)
        if 1 < latches < _COUNTER_HALF:
            raise Alarm(900060, axis=self._axis, count=latches)
        if latches == 1 and is_stored and value is not None:
            self._accept(value)
        self._unshown_cycles = self._unshown_cycles + 1 if latches == 1 and not is_stored else 0
        if self._unshown_cycles > UNSHOWN_CYCLES_MAX:
            raise Alarm(900063, axis=self._axis, cycles=self._unshown_cycles)

    def _by_repetition(self, value: int | None) -> None:
        if value is None:
            self._cycles = 0
            return
        self._cycles = self._cycles + 1 if value == self._repeated else 1
        self._repeated = value
        is_new = self._old_values and value not in self._old_values
        if self._cycles >= (REPEATED_CYCLES if is_new else SAME_VALUE_CYCLES):
            self._accept(value)

    def _accept(self, value: int) -> None:
        if self.increments is None:
            self._check_travel(value)
            self.increments = value
            self.speed_increments = _speed_at(value, list(self._travel))
        elif value != self.increments:
            raise Alarm(
                900064,
                axis=self._axis,
                first_mm=f"{self.increments / self._per_mm:.6f}",
                then_mm=f"{value / self._per_mm:.6f}",
            )

    def _check_travel(self, value: int) -> None:
        places = list(self._travel)
        steps = [abs(b - a) for a, b in pairwise(places)]
        margin = max(steps, default=0) + TOLERANCE_MM * self._per_mm
        low, high = min(places) - margin, max(places) + margin
        self.plausible_increments = (floor(low), ceil(high))
        if not low <= value <= high:
            raise Alarm(
                900061,
                axis=self._axis,
                value_mm=f"{value / self._per_mm:.6f}",
                low_mm=f"{low / self._per_mm:.6f}",
                high_mm=f"{high / self._per_mm:.6f}",
            )


def _ahead(count: int, before: int) -> int:
    """Return how far a 16 bit counter is ahead of another; more than half of it: it is late."""
    return count - before & _COUNTER_MASK


def _speed_at(value: int, places: list[int]) -> float:
    """Return the travel in one cycle at the speed that an axis had where it passed `value`.

    places: one per cycle, newest last. A parabola through the three places around it gives the
    speed of any uniformly accelerated motion: x = x1 + b u + c u^2 has the speed
    sqrt(b^2 + 4 c (x - x1)) at x. An axis that never was there had the speed of its last cycle.
    """
    for at in range(len(places) - 2, 0, -1):
        before, here, after = places[at - 1 : at + 2]
        if here != after and min(here, after) <= value <= max(here, after):
            b, c = (after - before) / 2.0, (after - 2 * here + before) / 2.0
            return copysign(sqrt(max(b * b + 4.0 * c * (value - here), 0.0)), after - here)
    return float(places[-1] - places[-2]) if len(places) > 1 else 0.0
