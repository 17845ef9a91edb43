"""Keys of `[drive.D]` of a drive on Lightbus."""

from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Field

from axisrig.bench.rig.speed_drive.keys import SpeedDriveTable
from axisrig.kernel.profiles.lightbus.words import LATCH16_BITS, TURN_BITS, UM_PER_MM


class DriveTable(SpeedDriveTable):
    """`[drive.NAME]` of an AX2000 on Lightbus; it gets its speed as a number.

    rpm_at_full: speed of 32767. in2mode: function of its digital input 2, to which the probe is
    wired; 26 latches. latch_variable: what the image carries of a latched position.
    """

    family: Literal["lightbus"]
    rpm_at_full: Annotated[float, Field(gt=0, le=100_000)] = 3000.0
    in2mode: Annotated[int, Field(ge=0, le=50)] = 0
    latch_variable: Literal["LATCH32", "LATCH16"] = "LATCH32"

    @property
    def full_rpm(self) -> float:
        """Its speed at the full number."""
        return float(self.rpm_at_full)

    @property
    def is_in_turn(self) -> bool:
        """Whether a latched position counts within a turn."""
        return bool(self.latch_variable == "LATCH16")

    @property
    def increments_per_turn(self) -> int:
        """Increments of its position for a turn."""
        return 1 << TURN_BITS

    @property
    def latch_per_mm(self) -> Fraction | None:
        """LATCH32 counts um, LATCH16 divides a turn, coarser than the position; exact."""
        if not self.is_in_turn:
            return Fraction(UM_PER_MM)
        return (1 << LATCH16_BITS) / (Fraction(self.make().drive.lead_um) / 1000)

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return (
            f"Lightbus, 2^20 increments a turn, 4096 turns, latched in {self.latch_variable},"
            f" IN2MODE {self.in2mode}"
        )
