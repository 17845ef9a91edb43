"""The dead time of a probe (P-AXIS-00487): a measured value is led back by it, within the block.

The axis has the speed v of the latch only once it has run up to it: a touch in the block is led
back to at most v T - s before its begin, where T and s are time and way of the run-up (v^2 / 2a
with a constant acceleration a), and by as much more as the axis lags behind its set position. What
lies further back was never touched in this block: its dead time is longer than the axis has moved.
An axis that swings back as it settles has its speed since it turned: it is led back by at most the
same way from where it is.
Source: TF5200 axis parameters 117371403 for the way back; its limit is a decision of ours
(docs/ambiguities.md).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.course import AnySlope

_SAME_SPEED: Final = 1.0 - 1e-6
_STANDS_MM_S: Final = 1e-6
_HALVINGS: Final = 60


@dataclass
class DeadTime:
    """How late the probe of one axis signals, and how far its value may be led back.

    cycles: of the NC. begin_mm: where the axis is when the block begins, ACS. window_mm: how far
    from there it may stand (P-AXIS-00236). behind_mm: gives how far a motion at a speed, in mm per
    cycle, is behind one that has had it from the begin on. lag_mm: gives the present position lag.
    """

    axis: str
    cycles: float
    begin_mm: float
    window_mm: float
    behind_mm: Callable[[float], float]
    lag_mm: Callable[[], float]
    _lag_mm: float = 0.0

    def note_signal(self) -> None:
        """Take note of the lag with which the signal comes."""
        self._lag_mm = abs(self.lag_mm())

    def led_back_mm(self, value_mm: float, speed_mm: float) -> float:
        """Return where the axis was a dead time before its latch.

        speed_mm: travel in one cycle at the latch. Raises Alarm 900520 for a place that the axis
        cannot have been at in this block.
        """
        way_mm = self.cycles * speed_mm
        back_mm = value_mm - way_mm
        room_mm = self.window_mm + self._lag_mm
        moved_mm = value_mm - self.begin_mm if speed_mm > 0.0 else self.begin_mm - value_mm
        if moved_mm < -room_mm:  # swings back as it settles: since its turn, not since the begin
            moved_mm = 0.0
        before_mm = abs(way_mm) - moved_mm
        if before_mm > room_mm + self.behind_mm(abs(speed_mm)):
            raise Alarm(
                900520,
                axis=self.axis,
                value_mm=f"{back_mm:.9g}",
                before_mm=f"{before_mm:.6g}",
                begin_mm=f"{self.begin_mm:.9g}",
            )
        return back_mm


def run_up(
    acceleration: AnySlope, deceleration: AnySlope, speed_mm_s: float
) -> tuple[float, float]:
    """Return time, s, and way, mm, of a run-up from standstill to a speed."""
    if speed_mm_s < _STANDS_MM_S:
        return 0.0, 0.0
    far_mm = 100.0 * (acceleration.distance_mm(speed_mm_s) + deceleration.distance_mm(speed_mm_s))
    course = acceleration.plan(far_mm, speed_mm_s, deceleration)
    low_s, high_s = 0.0, 0.5 * course.duration_s
    for _ in range(_HALVINGS):
        middle_s = 0.5 * (low_s + high_s)
        if course.at(middle_s)[1] < _SAME_SPEED * speed_mm_s:
            low_s = middle_s
        else:
            high_s = middle_s
    return high_s, course.at(high_s)[0]
