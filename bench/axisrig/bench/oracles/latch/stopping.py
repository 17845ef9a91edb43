"""How far an axis goes on after its probe has switched, and how fast it may measure.

Source: SINUMERIK 840C, measuring cycles (deceleration path v t + v^2/2b + v/Kv, example of 12.6
mm), and Siemens 6FC5398-4BP40-6BA1, 2.8; the share of a ramp of the deceleration is that of
constant jerk (docs/measuring.md, "How fast a probe may measure").
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np


@dataclass(frozen=True)
class Braking:
    """What stops an axis.

    deceleration_mm_s2: above 0. kv_per_s: gain of the position loop, above 0. reaction_s: from the
    switching of the probe to the set value that brakes. ramp_s: in which the deceleration rises and
    falls, 0 = at once. feed_forward: share of the velocity, 0 to 1.
    """

    deceleration_mm_s2: float
    kv_per_s: float
    reaction_s: float
    ramp_s: float = 0.0
    feed_forward: float = 0.0

    @property
    def late_s(self) -> float:
        """Time that the axis goes on with its speed: reaction, and (1 - f)/Kv of its lag."""
        return self.reaction_s + (1 - self.feed_forward) / self.kv_per_s


@dataclass(frozen=True)
class StoppingPath:
    """Shares of the way from the switching point to standstill, mm."""

    reaction_mm: float
    braking_mm: float
    ramp_mm: float
    lag_mm: float

    @property
    def whole_mm(self) -> float:
        """Sum of the shares."""
        return self.reaction_mm + self.braking_mm + self.ramp_mm + self.lag_mm


def stopping_path(braking: Braking, speed_mm_s: float) -> StoppingPath:
    """Return v t + v^2/2b + v t_r/2 + (1 - f) v/Kv for a speed v >= 0.

    Below b t_r the deceleration does not reach b: it rises and falls with the jerk b/t_r, which
    takes 2 sqrt(v t_r/b) and the way v sqrt(v t_r/b); what this is more than v^2/2b is the ramp.
    """
    v, b, t_r = speed_mm_s, braking.deceleration_mm_s2, braking.ramp_s
    braking_mm = v * v / (2 * b)
    ramp_mm = v * t_r / 2 if v >= b * t_r else v * sqrt(v * t_r / b) - braking_mm
    lag_mm = (1 - braking.feed_forward) * v / braking.kv_per_s
    return StoppingPath(v * braking.reaction_s, braking_mm, ramp_mm, lag_mm)


def largest_speed_mm_s(braking: Braking, stroke_mm: float) -> float:
    """Return the speed whose stopping path is the stroke H >= 0, mm/s.

    v = b (-B + sqrt(B^2 + 2 H/b)), B = t + t_r/2 + (1 - f)/Kv, where that is at least b t_r; else
    the root of sqrt(t_r/b) u^3 + (t + (1 - f)/Kv) u^2 = H, v = u^2.
    """
    b, t_r = braking.deceleration_mm_s2, braking.ramp_s
    whole_s = braking.late_s + t_r / 2
    v = b * (sqrt(whole_s**2 + 2 * stroke_mm / b) - whole_s)
    if v >= b * t_r:
        return v
    roots = np.roots([sqrt(t_r / b), braking.late_s, 0.0, -stroke_mm])
    return max(float(root.real) for root in roots if abs(root.imag) < 1e-9) ** 2
