"""Mode 3, profile velocity: 60FF is reached over the ramps 6083 and 6084.

Source: CiA 402-2, pv; the drive leads its position demand, so that a steady lag v/Kv remains.
"""

import math
from typing import ClassVar

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.ramp import Course, to_point, to_velocity
from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.bench.drive.cia402.modes.generator import Generator
from axisrig.kernel.profiles.cia402.ds402 import Status
from axisrig.kernel.time.clock import TimeNs


class ProfileVelocity(Mode):
    """Bit 10: 606C within 606D of 60FF for 606E. Bit 12: below 606F for 6070 (speed is 0)."""

    number: ClassVar[int] = 3

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.needs_ticks = True
        self._generator = Generator(parts)
        self._planned: tuple[object, ...] = ()
        self._in_window = HoldTime()
        self._reached = self._stands = False

    def begin(self, now_ns: TimeNs) -> None:
        """Go on with the present velocity, towards the target."""
        self._plan(now_ns, self._generator.present(now_ns))
        self._generator.go_on(now_ns)
        self._in_window = HoldTime()
        self.parts.standstill.begin()
        self._look(now_ns)

    def tick(self, now_ns: TimeNs) -> None:
        """Plan anew when an object has changed; lead the demand on."""
        if self._planned != self._objects():
            self._plan(now_ns, self._generator.on_course(now_ns))
        self._generator.go_on(now_ns)
        self._look(now_ns)

    def _objects(self) -> tuple[object, ...]:
        image, limits = self.parts.image, self.parts.limits
        return (
            image.target_velocity,
            limits.rates_m_s2(),
            limits.profile_m_s,
            (limits.low_m, limits.high_m),
            image.profile_type,
        )

    def _plan(self, now_ns: TimeNs, start: tuple[float, float]) -> None:
        parts = self.parts
        self._planned = self._objects()
        wanted = parts.units.metres(parts.image.target_velocity)
        most = parts.limits.profile_m_s
        self._velocity = max(-most, min(wanted, most))
        self._is_too_fast = self._velocity != wanted
        self._generator.start(now_ns, self._course(start))

    def _course(self, start: tuple[float, float]) -> Course:
        limits, shape = self.parts.limits, self.parts.image.profile_type
        velocity, rates = self._velocity, limits.rates_m_s2()
        end_m = limits.high_m if velocity > 0.0 else limits.low_m
        if velocity and math.isfinite(end_m):
            return to_point(start, end_m, abs(velocity), rates, shape)
        return to_velocity(start, velocity, rates, shape)

    def _look(self, now_ns: TimeNs) -> None:
        parts, image = self.parts, self.parts.image
        at_limit = self._generator.time_s(now_ns) >= self._generator.course.braking_s
        self.is_limited = self._is_too_fast or at_limit
        actual = parts.units.velocity_units_s(parts.motion.axis.motor_velocity_m_s())
        is_near = abs(actual - image.target_velocity) <= image.velocity_window
        self._reached = self._in_window.holds(now_ns, is_near, image.velocity_window_ms)
        self._stands = parts.standstill.holds(now_ns)

    def status(self) -> int:
        """Bits 10 and 12."""
        reached = int(Status.TARGET_REACHED) if self._reached else 0
        return reached | (int(Status.SPEED_ZERO) if self._stands else 0)
