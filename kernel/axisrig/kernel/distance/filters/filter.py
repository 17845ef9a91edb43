"""What every filter of the sensor value can do."""

from typing import Final, Protocol

# Share of an old value that may be left for a filter to have forgotten it
FORGOTTEN: Final = 0.01
MEMORY_MAX: Final = 1000


class Filter(Protocol):
    """A filter that takes one value per NC cycle; all are linear with the gain 1 for a constant.

    character: numbers that two filters have in common where they give the same values.
    """

    character: tuple[float, ...]

    def restart(self, value_mm: float) -> None:
        """Behave as if the input had been `value_mm` for ever: the output is that value."""
        ...

    def step(self, value_mm: float) -> float:
        """Take the value of this cycle and return the filtered one, both in mm."""
        ...


def memory_cycles(smooth: Filter) -> int:
    """Return after how many values a filter has forgotten what was before, to `FORGOTTEN`.

    A mean of n values: n. At most `MEMORY_MAX`. The filter is not to be used any more.
    """
    smooth.restart(1.0)
    left = [abs(smooth.step(0.0)) for _ in range(MEMORY_MAX)]
    return next((n for n in range(MEMORY_MAX, 0, -1) if left[n - 1] > FORGOTTEN), 0) + 1
