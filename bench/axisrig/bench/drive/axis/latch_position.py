"""Which position a drive stores for a latch instant: exact, on a line between samples, sampled."""

from collections.abc import Callable
from typing import Final

from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.kernel.time.clock import TimeNs

PositionAt = Callable[[TimeNs], int]
_FRACTION_BITS: Final = 16


def wrapped(value: int, bits: int = 32) -> int:
    """Return a number as a signed register of so many bits holds it."""
    half = 1 << bits - 1
    return (value + half & (1 << bits) - 1) - half


class LatchPosition:
    """The position of one encoder at a latch instant, in position units of the bus."""

    def __init__(self, habits: AxisHabits, units_at: PositionAt) -> None:
        self._mode, self._grid_ns = habits.latch_mode, habits.grid_ns
        self._compensation_ns = habits.delay_compensation_ns
        self._product_bits = habits.latch_bits
        self._units_at = units_at

    def instant_ns(self, latch_ns: TimeNs) -> TimeNs:
        """Return the instant that the stored position belongs to."""
        wanted_ns = max(0, latch_ns - self._compensation_ns)
        return wanted_ns - wanted_ns % self._grid_ns if self._mode == "sampled" else wanted_ns

    def units(self, latch_ns: TimeNs) -> int:
        """Return the position that an edge with this latch instant stores."""
        wanted_ns = self.instant_ns(latch_ns)
        if self._mode == "linear":
            return self._on_line(wanted_ns)
        return self._units_at(wanted_ns)

    def exact_units(self, time_ns: TimeNs) -> int:
        """Return the position at an instant, whatever the mode; as the index pulse latches it."""
        return self._units_at(time_ns)

    def _on_line(self, time_ns: TimeNs) -> int:
        """Interpolate between the samples around an instant, in whole units.

        Source: Lenze i700 manual, touch probe: linear interpolation on the sample grid. A product
        of 32 bits overflows when an encoder moves 32768 increments or more between two samples:
        the fault that this drive had with 22 bits per revolution and more
        (https://www.lenze.com/de-de/application-knowledge-base/artikel/298497/1).
        """
        since_ns = time_ns % self._grid_ns
        first = self._units_at(time_ns - since_ns)
        if not since_ns:
            return first
        way = wrapped(self._units_at(time_ns - since_ns + self._grid_ns) - first)
        if self._product_bits >= 64:
            return wrapped(first + (2 * way * since_ns + self._grid_ns) // (2 * self._grid_ns))
        product = way * ((since_ns << _FRACTION_BITS) // self._grid_ns)
        return wrapped(first + (wrapped(product, self._product_bits) >> _FRACTION_BITS))
