"""Mode 1, profile position: set-points are driven to with ramps, one at a time or one after one.

Source: CiA 402-2, pp; handshake of bit 4 of the controlword with bit 12 of the statusword.
"""

from dataclasses import dataclass
from typing import ClassVar

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.ramp import Course, to_point, to_velocity
from axisrig.bench.drive.cia402.functions.units import U32_MAX
from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.bench.drive.cia402.modes.generator import Generator
from axisrig.kernel.profiles.cia402.ds402 import Status
from axisrig.kernel.time.clock import TimeNs

NEW_SET_POINT, AT_ONCE, RELATIVE = 1 << 4, 1 << 5, 1 << 6  # bits of the controlword


@dataclass(frozen=True, slots=True)
class SetPoint:
    """A target with the profile that was in the objects when it was given (SI units)."""

    end_m: float
    speed_m_s: float
    rates_m_s2: tuple[float, float]
    shape: int
    is_limited: bool


class ProfilePosition(Mode):
    """One set-point runs, one more may wait.

    Bit 10: the last set-point is reached, 6064 within 6067 of it for 6068. Bit 12: set-point
    taken; it falls with bit 4 of the controlword once another one can be taken.
    """

    number: ClassVar[int] = 1
    follows_position: ClassVar[bool] = True

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self._generator = Generator(parts)
        self._in_window = HoldTime()
        self._next: SetPoint | None = None
        self._active = SetPoint(0.0, 0.0, (1.0, 1.0), 0, False)
        self._bit = self._acknowledged = self._reached = False
        self._is_idle = True  # no set-point was given yet

    def begin(self, now_ns: TimeNs) -> None:
        """Come to rest with 6084; set-points given before are forgotten."""
        parts = self.parts
        rates, shape = parts.limits.rates_m_s2(), parts.image.profile_type
        course = to_velocity(self._generator.present(now_ns), 0.0, rates, shape)
        self._active = SetPoint(course.end_m, 0.0, rates, shape, False)
        self._next = None
        self._bit = bool(parts.image.controlword & NEW_SET_POINT)
        self._acknowledged, self._is_idle = False, True
        self._run(now_ns, course)

    def resume(self, now_ns: TimeNs) -> None:
        """Go on to the set-point."""
        self._run(now_ns, self._course(self._generator.present(now_ns)))

    def command(self, now_ns: TimeNs) -> None:
        """Take a set-point with the rising edge of bit 4."""
        word = self.parts.image.controlword
        bit = bool(word & NEW_SET_POINT)
        is_new, self._bit = bit and not self._bit, bit
        if is_new and not self._acknowledged:
            self._acknowledged = True
            set_point = self._set_point(bool(word & RELATIVE))
            if word & AT_ONCE or self._reached or self._is_idle:
                self._next, self._is_idle = None, False
                self._active = set_point
                self._run(now_ns, self._course(self._generator.on_course(now_ns)))
            else:
                self._next = set_point
        if not bit and self._next is None:
            self._acknowledged = False

    def _set_point(self, is_relative: bool) -> SetPoint:
        parts, image = self.parts, self.parts.image
        if is_relative:
            # Taken only while no other one waits, so the last target is that of the active one
            wanted_m = self._active.end_m + parts.units.metres(image.target_position)
        else:
            wanted_m = parts.units.position_m(image.target_position)
        end_m = parts.limits.position_m(wanted_m)
        wanted = parts.units.metres(image.profile_velocity)
        speed = min(wanted, parts.limits.profile_m_s)
        limited = end_m != wanted_m or speed != wanted
        return SetPoint(end_m, speed, parts.limits.rates_m_s2(), image.profile_type, limited)

    def _course(self, start: tuple[float, float]) -> Course:
        point = self._active
        if not point.speed_m_s:
            return to_velocity(start, 0.0, point.rates_m_s2, point.shape)
        return to_point(start, point.end_m, point.speed_m_s, point.rates_m_s2, point.shape)

    def _run(self, now_ns: TimeNs, course: Course) -> None:
        self._generator.start(now_ns, course)
        self._generator.go_on(now_ns)
        self._in_window = HoldTime()
        self.is_limited = self._active.is_limited
        self._look(now_ns)

    def tick(self, now_ns: TimeNs) -> None:
        """Lead the demand on; begin the set-point that waits once the present one is reached."""
        self._generator.go_on(now_ns)
        self._look(now_ns)
        if self._reached and self._next is not None:
            self._active, self._next = self._next, None
            self._run(now_ns, self._course(self._generator.on_course(now_ns)))
            self.command(now_ns)

    def _look(self, now_ns: TimeNs) -> None:
        parts, image = self.parts, self.parts.image
        is_near = self._generator.time_s(now_ns) >= self._generator.course.duration_s
        if is_near and image.position_window != U32_MAX:
            away_m = self._generator.course.end_m - parts.motion.axis.motor_position_m()
            is_near = abs(parts.units.deviation_units(away_m)) <= image.position_window
        self._reached = self._in_window.holds(now_ns, is_near, image.position_window_ms)
        self.needs_ticks = not self._reached

    def status(self) -> int:
        """Bits 10 and 12."""
        reached = int(Status.TARGET_REACHED) if self._reached and self._next is None else 0
        return reached | (int(Status.SET_POINT_ACKNOWLEDGE) if self._acknowledged else 0)
