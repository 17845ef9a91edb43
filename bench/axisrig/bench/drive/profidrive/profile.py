"""What differs from drive to drive."""

from dataclasses import dataclass
from fractions import Fraction

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.profidrive.words import SPEED_BASE, Telegram


@dataclass(frozen=True)
class ProfidriveProfile:
    """One drive. drive: its axis, inputs and encoder, whose increments are those of G1_XIST1.

    p0660: function of the fast input. p0880_rpm: what speeds are shares of. p0925: wrong signs of
    life that are tolerated. p1042: fine bits of G1_XIST1. p1230: torque limit in 0.1 % of the rated
    torque. p0881: torque reduction in 1 % at MOMRED = 16384. absolute_shift: P1043 less P1042, of
    the absolute position.
    """

    drive: DriveProfile
    telegram: Telegram
    p0660: int
    p0880_rpm: int
    p0925: int
    p1042: int = 11
    p1230: int = 1000
    p0881: int = 100
    absolute_shift: int = 0

    @property
    def speed_m_s(self) -> Fraction:
        """Speed of the axis for one count of NSOLL_B, exact."""
        return Fraction(self.p0880_rpm * self.drive.lead_um, 60 * 10**6 * SPEED_BASE)
