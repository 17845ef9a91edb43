"""What the manuals leave open of the law of distance control: three choices of a rig.

FCT-M3 3, 4, 7 and the pages of P-AXIS-00765, 00415 and 00416 do not say what the derivative part
looks at, for how long a time it counts, and how speed and acceleration of the offset are limited.
What speaks for which: docs/distance-control.md and docs/ambiguities.md.
"""

from dataclasses import dataclass
from enum import StrEnum


class DerivativeOf(StrEnum):
    """What the derivative part takes the change of.

    FEEDBACK: the filtered deviation or distance. ERROR: the error, so that it also sees a change of
    SET_DIST and, in SET_POS, the offset that is put out.
    """

    FEEDBACK = "feedback"
    ERROR = "error"


class StepLimiter(StrEnum):
    """How v_max and a_max limit the step of the offset.

    SLOPE: a step towards the error is never so large that it could not stop there. CLAMP: the step
    and its change are cut, without a braking way.
    """

    SLOPE = "slope"
    CLAMP = "clamp"


class Derivative(StrEnum):
    """What a derivative time of 1 is worth: PER_SECOND Tv/T, PER_CYCLE Tv."""

    PER_SECOND = "per_second"
    PER_CYCLE = "per_cycle"


@dataclass(frozen=True)
class DistanceLaw:
    """The choices of a rig, `[distance]`."""

    derivative_of: DerivativeOf = DerivativeOf.FEEDBACK
    limiter: StepLimiter = StepLimiter.SLOPE
    derivative: Derivative = Derivative.PER_SECOND


USUAL_LAW = DistanceLaw()
"""Of a rig that chooses nothing."""
