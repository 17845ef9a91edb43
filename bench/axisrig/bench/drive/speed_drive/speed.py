"""The mode of a drive that only takes a speed: it follows the set speed as it is."""

from typing import ClassVar

from axisrig.bench.drive.axis.motion import VELOCITY
from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import TimeNs

SPEED_MODE = 9
"""Number of the mode in the servo: a speed of each cycle."""


class SetSpeed(Mode):
    """speed_m_s: what the analogue input of the drive has now."""

    number: ClassVar[int] = SPEED_MODE
    needs: ClassVar[ControlKind] = VELOCITY

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.speed_m_s = 0.0

    def begin(self, now_ns: TimeNs) -> None:
        """Follow the input from now on."""
        self.cycle(now_ns)

    def cycle(self, now_ns: TimeNs) -> None:
        """Take the speed of the input."""
        parts = self.parts
        speed = parts.limits.velocity_m_s(self.speed_m_s)
        self.is_limited = speed != self.speed_m_s
        parts.motion.speed(now_ns, speed, speed, now_ns)
