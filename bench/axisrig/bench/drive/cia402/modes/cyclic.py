"""Cyclic synchronous modes: the master gives a target with every SYNC.

Source: CiA 402-2, csp, csv, cst; the demand is interpolated linearly over one period, a torque
acts at once.
"""

from typing import ClassVar

from axisrig.bench.drive.axis.latch_position import wrapped
from axisrig.bench.drive.axis.motion import FORCE, POSITION, VELOCITY
from axisrig.bench.drive.cia402.functions.limits import PER_MILLE
from axisrig.bench.drive.cia402.modes.base import Mode
from axisrig.kernel.profiles.cia402.ds402 import Status
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import S, TimeNs

FOLLOWS_COMMAND = int(Status.FOLLOWS_COMMAND)


class CyclicPosition(Mode):
    """Mode 8, csp: 607A and 60B0, within the software limits and the speed limit."""

    number: ClassVar[int] = 8
    follows_position: ClassVar[bool] = True

    def begin(self, now_ns: TimeNs) -> None:
        """Start where the axis is, whatever the target says; a moving axis keeps its course.

        The target is set to where the demand is one period later.
        """
        parts, motion = self.parts, self.parts.motion
        start_m = motion.position_m()
        velocity = motion.velocity_m_s(now_ns) if motion.kind is POSITION else 0.0
        end_ns = now_ns + (parts.interpolation.period_ns() if velocity else 0)
        end_m = start_m + velocity * (end_ns - now_ns) / S
        image = parts.image
        # Both are numbers of 32 bits, and so is their sum: it wraps as a position does
        image.target_position = wrapped(parts.units.position_units(end_m) - image.position_offset)
        self.is_limited = False
        motion.glide(now_ns, start_m, velocity, end_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Lead the demand to the target over one period."""
        parts = self.parts
        image, limits, motion = parts.image, parts.limits, parts.motion
        demand_m = motion.axis.demand_position_m()
        period_ns = parts.interpolation.period_ns()
        target = wrapped(image.target_position + image.position_offset)
        target_m = parts.units.position_m(target)
        self.is_limited = False
        if not limits.low_m <= target_m <= limits.high_m:
            target_m = limits.position_m(target_m)
            self.is_limited = True
        velocity = (target_m - demand_m) * S / period_ns
        if abs(velocity) > limits.speed_m_s:
            velocity = limits.velocity_m_s(velocity)
            self.is_limited = True
        motion.glide(now_ns, demand_m, velocity, now_ns + period_ns)

    def status(self) -> int:
        """Bit 12: the drive follows the command."""
        return 0 if self.is_limited else FOLLOWS_COMMAND


class CyclicVelocity(Mode):
    """Mode 9, csv: 60FF and 60B1, within the speed limit."""

    number: ClassVar[int] = 9
    needs: ClassVar[ControlKind] = VELOCITY

    def begin(self, now_ns: TimeNs) -> None:
        """Go on with the present velocity."""
        velocity = self.parts.motion.velocity_m_s(now_ns)
        self.parts.motion.speed(now_ns, velocity, velocity, now_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Lead the velocity demand to the target over one period, or hold it from now on."""
        parts = self.parts
        image, motion = parts.image, parts.motion
        wanted = parts.units.metres(image.target_velocity + image.velocity_offset)
        target = parts.limits.velocity_m_s(wanted)
        self.is_limited = target != wanted
        end_ns = now_ns if parts.holds_velocity else now_ns + parts.interpolation.period_ns()
        motion.speed(now_ns, motion.velocity_m_s(now_ns), target, end_ns)

    def status(self) -> int:
        """Bit 12: the drive follows the command."""
        return 0 if self.is_limited else FOLLOWS_COMMAND


class CyclicForce(Mode):
    """Mode 10, cst: 6071 and 60B2, within the torque limits."""

    number: ClassVar[int] = 10
    needs: ClassVar[ControlKind] = FORCE
    limits_speed: ClassVar[bool] = True

    def begin(self, now_ns: TimeNs) -> None:
        """Go on with the present force; none out of power off."""
        motion = self.parts.motion
        force_n = motion.axis.force_n() if motion.kind is not None else None
        motion.force(now_ns, force_n or 0.0)

    def cycle(self, now_ns: TimeNs) -> None:
        """Demand the target."""
        parts = self.parts
        wanted = parts.image.target_torque + parts.image.torque_offset
        torque = parts.limits.torque(wanted)
        self.is_limited = torque != wanted
        parts.motion.force(now_ns, torque * parts.limits.rated_n / PER_MILLE)

    def status(self) -> int:
        """Bit 12: the drive follows the command."""
        return 0 if self.is_limited else FOLLOWS_COMMAND
