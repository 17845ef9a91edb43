"""The mode of a PROFIdrive drive: a set speed, and the position loop where KPC is not 0 (DSC).

n = NSOLL_B + KPC (XERR - (x - x0)): x is the position now, x0 that of the telegram from which the
control has reckoned XERR. So the loop has no dead time of the bus, and acts in each tick of the
drive. Source: SIMODRIVE 611 universal p. 224 (docs/profidrive.md).
"""

from typing import ClassVar

from axisrig.bench.drive.axis.motion import VELOCITY
from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import TimeNs

SPEED_MODE = 9
"""Number of the mode in the servo: a speed of each cycle."""


class SpeedMode(Mode):
    """speed_m_s, deviation_m, kpc_per_s: of the telegram. reference_m: x0."""

    number: ClassVar[int] = SPEED_MODE
    needs: ClassVar[ControlKind] = VELOCITY

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.speed_m_s = self.deviation_m = self.kpc_per_s = self.reference_m = 0.0

    def begin(self, now_ns: TimeNs) -> None:
        """Go on with the present speed."""
        speed = self.parts.motion.velocity_m_s(now_ns)
        self.parts.motion.speed(now_ns, speed, speed, now_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Take the values of the telegram."""
        self.needs_ticks = self.kpc_per_s > 0.0
        self._demand(now_ns)

    def tick(self, now_ns: TimeNs) -> None:
        """Close the loop between two telegrams."""
        if self.needs_ticks:
            self._demand(now_ns)

    def _demand(self, now_ns: TimeNs) -> None:
        parts = self.parts
        wanted = self.speed_m_s
        if self.kpc_per_s > 0.0:
            moved_m = parts.motion.axis.motor_position_m() - self.reference_m
            wanted += self.kpc_per_s * (self.deviation_m - moved_m)
        speed = parts.limits.velocity_m_s(wanted)
        self.is_limited = speed != wanted
        parts.motion.speed(now_ns, speed, speed, now_ns)
