"""The PID law of distance control, in increments: what it gives is added to the offset.

delta = kp (e + (T/Tn) sum of e + (Tv/T) (e - e before)), from the meaning of P-AXIS-00764 and
00765: after Tn a constant error has given as much by the I part as by the P part; in a constant
ramp of the error the D part is that which the P part is after Tv.
"""

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
        """Begin anew: no error was there before, nothing is in the sum."""
        self._before_mm = None
        self._integral_mm = 0.0

    def delta_mm(self, error_mm: float, settings: DistanceSettings) -> float:
        """Return what is to be added to the offset; `settle` has to follow."""
        before_mm = error_mm if self._before_mm is None else self._before_mm
        self._before_mm = error_mm
        self._next_integral_mm = 0.0
        if settings.tn_s > 0:
            share_mm = error_mm * self._period_s / settings.tn_s
            self._next_integral_mm = self._integral_mm + share_mm
        slope_mm = (error_mm - before_mm) * settings.tv_s / self._period_s
        return settings.kp * (error_mm + self._next_integral_mm + slope_mm)

    def settle(self, *, is_limited: bool) -> None:
        """Keep the sum with the error of this cycle, or as it was while a limit acts."""
        if not is_limited:
            self._integral_mm = self._next_integral_mm
