"""The profile generator of a mode: a course as position demands from tick to tick."""

from axisrig.bench.drive.axis.motion import POSITION
from axisrig.bench.drive.axis.ramp import Course
from axisrig.bench.drive.cia402.modes.base import Parts
from axisrig.kernel.time.clock import S, TimeNs


class Generator:
    """Leads the position demand along a course; between two ticks the demand is straight."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self.course = Course(0.0, 0.0)
        self._begin_ns: TimeNs = 0

    def present(self, now_ns: TimeNs) -> tuple[float, float]:
        """Return position and velocity that a new course begins with.

        On a course that runs it is that of the course; else that of the demand.
        """
        motion = self._parts.motion
        velocity = motion.velocity_m_s(now_ns) if motion.kind is POSITION else 0.0
        return motion.position_m(), velocity

    def on_course(self, now_ns: TimeNs) -> tuple[float, float]:
        """Return position and velocity of the course now."""
        return self.course.at((now_ns - self._begin_ns) / S)

    def start(self, now_ns: TimeNs, course: Course) -> None:
        """Follow a course from now on."""
        self.course, self._begin_ns = course, now_ns

    def time_s(self, now_ns: TimeNs) -> float:
        """Return how long the course has run."""
        return (now_ns - self._begin_ns) / S

    def go_on(self, now_ns: TimeNs) -> None:
        """Command the axis until the next tick."""
        end_ns = now_ns + self._parts.tick_ns
        from_m, _ = self.course.at(self.time_s(now_ns))
        to_m, _ = self.course.at(self.time_s(end_ns))
        self._parts.motion.ramp(now_ns, from_m, to_m, end_ns)
