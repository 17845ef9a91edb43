"""The sign of life of the control as a drive judges it.

Source: Kollmorgen AKD2G help: 10 up for a wrong one, 1 down for a right one and not below 0, a
fault above 10 times P0925.
"""

from collections.abc import Callable

from axisrig.kernel.profiles.profidrive.words import LIFE_RIGHT, LIFE_WRONG, next_life


class SignOfLife:
    """Counts. limit: P0925, wrong ones in a row that are tolerated. is_lost: a fault is due."""

    def __init__(self, limit: Callable[[], int]) -> None:
        self._limit = limit
        self.counter = 0
        self._last = 0

    def reset(self) -> None:
        """Forget it; the first one that is not 0 counts as right."""
        self.counter = self._last = 0

    def take(self, value: int) -> None:
        """Take the value of a cycle; 0 before the first one: the control does not send it yet."""
        if not self._last:
            self._last = value
            return
        if value == next_life(self._last):
            self.counter = max(0, self.counter - LIFE_RIGHT)
        else:
            self.counter += LIFE_WRONG
        self._last = next_life(self._last)  # it goes on by itself: one lost telegram is one wrong

    @property
    def is_lost(self) -> bool:
        """Whether the counter is above 10 times P0925."""
        return self.counter > LIFE_WRONG * self._limit()
