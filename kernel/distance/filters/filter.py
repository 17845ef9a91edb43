"""What every filter of the sensor value can do."""

from typing import Protocol


class Filter(Protocol):
    """A filter that takes one value per NC cycle; all are linear with the gain 1 for a constant."""

    def restart(self, value_mm: float) -> None:
        """Behave as if the input had been `value_mm` for ever: the output is that value."""
        ...

    def step(self, value_mm: float) -> float:
        """Take the value of this cycle and return the filtered one, both in mm."""
        ...
