"""The PID law of distance control, in increments: what it gives is added to the offset.

delta = kp (e + (T/Tn) sum of e + (Tv/T) (y - y before)), from the meaning of P-AXIS-00764 and
00765: after Tn a constant error has given as much by the I part as by the P part; in a constant
ramp the D part is that which the P part is after Tv. y is the filtered feedback with the sign of
the error, or the error itself, and Tv/T is Tv where the time counts per cycle (`law`).
"""

from axisrig.kernel.distance.law import Derivative, DerivativeOf
from axisrig.kernel.distance.settings import DistanceSettings
from axisrig.kernel.time.clock import TimeNs, ns_to_seconds


class Controller:
    """PID controller with a period; all values in mm."""

    def __init__(self, period_ns: TimeNs) -> None:
        self._period_s = ns_to_seconds(period_ns)
        self._before_mm: float | None = None
        self._integral_mm = 0.0
        self._next_integral_mm = 0.0

    def restart(self) -> None:
        """Begin anew: nothing was there before, nothing is in the sum."""
        self._before_mm = None
        self._integral_mm = 0.0

    def delta_mm(self, error_mm: float, towards_mm: float, settings: DistanceSettings) -> float:
        """Return what is to be added to the offset; `settle` has to follow.

        towards_mm: filtered feedback with the sign of the error: it grows as the error does when
        neither set value nor offset changes.
        """
        law = settings.law
        looked_at_mm = error_mm if law.derivative_of is DerivativeOf.ERROR else towards_mm
        before_mm = looked_at_mm if self._before_mm is None else self._before_mm
        self._before_mm = looked_at_mm
        self._next_integral_mm = 0.0
        if settings.tn_s > 0:
            share_mm = error_mm * self._period_s / settings.tn_s
            self._next_integral_mm = self._integral_mm + share_mm
        rise_mm = (looked_at_mm - before_mm) * settings.tv_s
        if law.derivative is Derivative.PER_SECOND:
            rise_mm /= self._period_s
        return settings.kp * (error_mm + self._next_integral_mm + rise_mm)

    def settle(self, *, is_limited: bool) -> None:
        """Keep the sum with the error of this cycle, or as it was while a limit acts."""
        if not is_limited:
            self._integral_mm = self._next_integral_mm
