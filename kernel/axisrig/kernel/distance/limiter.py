"""Limits of speed and acceleration of the offset.

While distance control follows, a step towards the error is never larger than one that can still
stop there (slope), or it is only cut to them (clamp): a choice of the rig, `law`. When the offset
is run out, speed follows the same braking curve and ends at exactly 0. Sources: P-AXIS-00415,
00416, 00501 to 00505, 00533, 00534 (FCT-M3 7.2, 7.4).
"""

import math
from typing import Final, NamedTuple

from axisrig.kernel.distance.law import StepLimiter
from axisrig.kernel.distance.settings import DistanceSettings
from axisrig.kernel.time.clock import TimeNs, ns_to_seconds

PERMILLE: Final = 1000
# The braking curve leaves the acceleration room for the rounding of floats
OF_ACCELERATION: Final = 1 - 1e-9
NO_ERROR_MM: Final = 1e-9
"""An error below it is rounding: it has no direction in which a step would have to stop."""


class AxesAllow(NamedTuple):
    """Speed and acceleration of the offset that the axes which it moves allow, mm/s and mm/s2.

    Only 3D distance control has them: one mm of its offset may be several of an axis.
    """

    v_mm_s: float = math.inf
    a_mm_s2: float = math.inf


UNLIMITED = AxesAllow()


class Limiter:
    """Limiter of the step of the offset.

    step_mm: of the last cycle. The way to the workpiece is that of a smaller offset; speed and
    acceleration that build up a motion this way are weighted, braking it is not.
    """

    def __init__(self, period_ns: TimeNs) -> None:
        self._period_s = ns_to_seconds(period_ns)
        self.step_mm = 0.0

    def rest(self) -> None:
        """Come to rest: the next motion begins with speed 0."""
        self.step_mm = 0.0

    def limit(
        self,
        delta_mm: float,
        error_mm: float,
        settings: DistanceSettings,
        override: float = 1.0,
        axes: AxesAllow = UNLIMITED,
    ) -> float:
        """Return the step of this cycle towards what the controller asks for.

        error_mm: control error: the way to go of a slope, and it decides the acceleration when that
        is adaptive. override: share of v_max that acts. axes: what the axes that the offset moves
        allow it.
        """
        a_mm_s2 = min(acceleration_mm_s2(error_mm, settings), axes.a_mm_s2)
        if settings.law.limiter is StepLimiter.SLOPE:
            delta_mm = self._sloped(delta_mm, error_mm, a_mm_s2)
        return self._go(delta_mm, a_mm_s2, settings, override, axes.v_mm_s)

    def _sloped(self, delta_mm: float, error_mm: float, a_mm_s2: float) -> float:
        """Cut a step towards the error to the largest that can stop there, braking by a T^2.

        A step away from the error is left as it is: it has nothing to stop at.
        """
        if abs(error_mm) < NO_ERROR_MM:
            return delta_mm
        most_mm = fastest_step_mm(abs(error_mm), self._in_cycle(a_mm_s2) * OF_ACCELERATION)
        return min(delta_mm, most_mm) if error_mm > 0 else max(delta_mm, -most_mm)

    def run_out(
        self,
        offset_mm: float,
        settings: DistanceSettings,
        override: float = 1.0,
        axes: AxesAllow = UNLIMITED,
    ) -> float:
        """Return the step of this cycle on the way of an offset to 0.

        override, axes: as in `limit`. The last step is exactly -offset. From a speed that cannot be
        braked in time the offset goes past 0 and comes back.
        """
        a_mm_s2 = min(settings.a_mm_s2, axes.a_mm_s2)
        brake_mm = self._in_cycle(a_mm_s2) * OF_ACCELERATION
        step_mm = fastest_step_mm(abs(offset_mm), brake_mm)
        wanted_mm = math.copysign(step_mm, -offset_mm)
        return self._go(wanted_mm, a_mm_s2, settings, override, axes.v_mm_s)

    def _in_cycle(self, a_mm_s2: float) -> float:
        """Give an acceleration as the change of the step from cycle to cycle."""
        return a_mm_s2 * self._period_s * self._period_s

    def _go(
        self,
        wanted_mm: float,
        a_mm_s2: float,
        settings: DistanceSettings,
        override: float,
        v_axes_mm_s: float,
    ) -> float:
        up_mm = min(settings.v_max_mm_s, v_axes_mm_s) * self._period_s * override
        down_mm = up_mm * _weight(settings.v_weight_down_permille)
        change_mm = self._in_cycle(a_mm_s2)
        before_mm = self.step_mm
        lowest_mm = before_mm - change_mm
        if settings.a_weight_down_permille and lowest_mm < 0:
            # What is left of the cycle after a stop builds up the way down
            left = 1 - max(before_mm, 0.0) / change_mm
            build_up_mm = change_mm * _weight(settings.a_weight_down_permille) * left
            lowest_mm = min(before_mm, 0.0) - build_up_mm
        within_mm = min(max(wanted_mm, -down_mm), up_mm)
        self.step_mm = min(max(within_mm, lowest_mm), before_mm + change_mm)
        return self.step_mm


def acceleration_mm_s2(error_mm: float, settings: DistanceSettings) -> float:
    """Return the acceleration for a control error: a_min up to a first one, a_max from a second.

    Linear between them; never above a_max (P-AXIS-00501 to 00505).
    """
    a_max = settings.a_mm_s2
    if not settings.is_adaptive:
        return a_max
    a_min = min(settings.a_min_mm_s2, a_max)
    over_mm = abs(error_mm) - settings.error_a_min_mm
    span_mm = settings.error_a_max_mm - settings.error_a_min_mm
    if over_mm <= 0:
        return a_min
    return a_max if over_mm >= span_mm else a_min + (a_max - a_min) * over_mm / span_mm


def fastest_step_mm(distance_mm: float, brake_mm: float) -> float:
    """Return the largest step after which steps that shrink by `brake_mm` each end at a distance.

    n steps of s, s - b, .., s - (n - 1) b make n s - b n (n - 1)/2; n is the least with which the
    last one is no more than b.
    """
    count = max(math.ceil((math.sqrt(1 + 8 * distance_mm / brake_mm) - 1) / 2), 1)
    return distance_mm / count + brake_mm * (count - 1) / 2


def _weight(permille: int) -> float:
    return permille / PERMILLE if permille else 1.0
