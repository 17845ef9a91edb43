"""What differs from drive to drive that only takes a speed."""

from dataclasses import dataclass
from fractions import Fraction

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.speed_drive.words import OUTPUT_MAX


@dataclass(frozen=True)
class SpeedProfile:
    """One drive. drive: its axis, inputs and encoder, whose increments are those of the counter.

    rpm_at_full: its speed at 10 V. output_bits: resolution of the output, with its sign.
    output_offset: what the output has at 0, in its full counts. watchdog_cycles: images in a row
    that may stay out before the outputs are 0.
    """

    drive: DriveProfile
    rpm_at_full: float
    output_bits: int = 16
    output_offset: int = 0
    watchdog_cycles: int = 3

    @property
    def speed_m_s(self) -> Fraction:
        """Speed of the axis for one full count of the output, exact."""
        turns_s = Fraction(self.rpm_at_full) / 60
        return turns_s * Fraction(self.drive.lead_um, 10**6) / OUTPUT_MAX

    def given_out(self, counts: int) -> int:
        """Return what the output gives: lower bits are cut off, the offset comes on top."""
        cut = 16 - self.output_bits
        return (counts >> cut << cut) + self.output_offset
