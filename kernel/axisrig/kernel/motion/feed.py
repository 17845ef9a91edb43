"""The feed of a move while it is under way: scaled by an override, or held.

A change of the override is a change of the target speed: from the state of the cycle the rest of
the path is planned anew, with the acceleration or deceleration of the move. So no limit of an axis
is exceeded, whatever course an override takes. Nothing is planned while nothing changes.
"""

from typing import Final

from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.interpolator import Interpolator

FULL: Final = 1000
"""Override that leaves the feed as it is, in 0.1 %."""


class Feed:
    """Feed of one move.

    full_mm_s: at an override of 100 %. share: override, 1 = 100 %; above it the speed stays within
    what `dynamics` allows.
    """

    __slots__ = ("dynamics", "full_mm_s", "share")

    def __init__(self, full_mm_s: float, dynamics: Dynamics, share: float = 1.0) -> None:
        self.full_mm_s, self.dynamics, self.share = full_mm_s, dynamics, share

    @property
    def speed_mm_s(self) -> float:
        """Target speed of the move."""
        return min(self.full_mm_s * self.share, self.dynamics.speed_max_mm_s)

    def lead(self, interpolator: Interpolator, share: float, *, is_held: bool) -> None:
        """Lead the move on with this override from the next cycle on, or stop it on its path.

        share: above 0; an override of 0 is a hold. Brakes for a hold with what P-CHAN-00097 says,
        never past the end of the path; goes on to the same end.
        """
        before_mm_s, dynamics = self.speed_mm_s, self.dynamics
        self.share = share
        if is_held:
            if not interpolator.is_held:
                interpolator.is_held = True
                braking = dynamics.feedhold or dynamics.deceleration
                interpolator.feedhold(braking, dynamics.deceleration)
        elif interpolator.is_held or self.speed_mm_s != before_mm_s:
            interpolator.is_held = False
            interpolator.go_on(self.speed_mm_s, dynamics.acceleration, dynamics.deceleration)
