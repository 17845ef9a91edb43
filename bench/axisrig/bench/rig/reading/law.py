"""The table of a rig for what the manuals leave open of distance control."""

from typing import Literal

from axisrig.bench.rig.reading.tables import Table
from axisrig.kernel.distance import Derivative, DerivativeOf, DistanceLaw, StepLimiter


class DistanceTable(Table):
    """`[distance]`: choices of the law of distance control, of every axis and in 3D.

    What each means: `axisrig.kernel.distance.law`; what speaks for which: docs/distance-control.md.
    """

    derivative_of: Literal["feedback", "error"] = "feedback"
    limiter: Literal["slope", "clamp"] = "slope"
    derivative: Literal["per_second", "per_cycle"] = "per_second"

    @property
    def law(self) -> DistanceLaw:
        """The same as the control takes it."""
        return DistanceLaw(
            DerivativeOf(self.derivative_of),
            StepLimiter(self.limiter),
            Derivative(self.derivative),
        )
