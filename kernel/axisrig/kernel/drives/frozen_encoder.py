"""Whether the encoder of an axis counts nothing while the control sets a speed.

A control that closes the position loop sees a lag that does not change, and would drive the axis
on with Kv times that lag for ever. No manual has a limit for it: docs/ambiguities.md.
"""

from math import ceil
from typing import Final

STANDS_S: Final = 0.05
"""So long without a count is longer than the dead time of any loop that is stable here."""
LEAST_MM_S: Final = 0.2
"""Slower, friction may hold an axis: 10 um in STANDS_S."""
LEAST_INCREMENTS: Final = 4
"""That a healthy encoder would count in STANDS_S, at least."""


class FrozenEncoder:
    """One axis. speed_mm_s: the set speed that was noted last."""

    def __init__(self, increments_per_mm: float, period_s: float) -> None:
        self._least_mm_s = max(LEAST_MM_S, LEAST_INCREMENTS / STANDS_S / increments_per_mm)
        self._cycles_max = ceil(STANDS_S / period_s - 1e-9)
        self._cycles = 0
        self._actual: int | None = None
        self.speed_mm_s = 0.0

    @property
    def is_frozen(self) -> bool:
        """Whether the last STANDS_S had no count at set speeds that would have made some."""
        return self._cycles >= self._cycles_max

    def note(self, speed_mm_s: float, actual_increments: int) -> None:
        """Take the set speed of this cycle and the actual position that it was made of."""
        stands = actual_increments == self._actual and abs(speed_mm_s) >= self._least_mm_s
        self._cycles = self._cycles + 1 if stands else 0
        self._actual, self.speed_mm_s = actual_increments, speed_mm_s

    def forget(self) -> None:
        """Begin anew: the drive does not follow, or may stand by order."""
        self._cycles = 0
