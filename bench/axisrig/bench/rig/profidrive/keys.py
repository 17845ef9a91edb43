"""Keys of `[drive.D]` of a PROFIdrive drive."""

from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import Field

from axisrig.bench.drive.cia402.dictionary.profiles import make_profile
from axisrig.bench.drive.profidrive.profile import ProfidriveProfile
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.habit_keys import habit_table
from axisrig.bench.rig.image_drive_keys import ImageDriveKeys
from axisrig.bench.rig.reading.tables import DriveFacts
from axisrig.kernel.profiles.profidrive.words import telegrams

POSITION_RANGE = 1 << 31
HABITS = (
    "lead_mm", "tick_us", "rated_torque_mnm", "rated_current_ma", "input_delay_us",
    "input_jitter_us", "input_filter_us", "min_pulse_us", "delay_compensation_us", "latch",
    "sample_us", "second_delay_cycles",
)  # fmt: skip
_HabitTable: Any = habit_table(HABITS)
NUMBERS = tuple(telegrams())
FineBits = Annotated[int, Field(ge=0, le=24)]


class DriveTable(_HabitTable, ImageDriveKeys):  # type: ignore[misc]
    """`[drive.NAME]` of a PROFIdrive drive.

    telegram: its number. lines: of the encoder per turn; p1042, p1043: fine bits of a line in
    G1_XIST1 with measured values, and of the absolute position. p0660: function of the fast input.
    p0880: speed in rpm that NSOLL_B is a share of. p0925: wrong signs of life that the drive
    tolerates. p1230: torque limit in 0.1 % of the rated torque; p0881: its reduction in 1 % at
    MOMRED = 16384. position_check: it is led only from a position that its absolute position gives
    too. parameter_check: it starts only with the parameters that the control counts with.
    """

    family: Literal["profidrive"]
    telegram: Literal[NUMBERS] = 5  # type: ignore[valid-type]
    lines: Annotated[int, Field(ge=1, le=1 << 20)] = 2048
    p1042: FineBits = 11
    p1043: FineBits = 11
    p0660: Annotated[int, Field(ge=0, le=255)] = 0
    p0880: Annotated[int, Field(ge=1, le=100_000)] = 16_384
    p0925: Annotated[int, Field(ge=0, le=65_535)] = 1
    p1230: Annotated[int, Field(ge=50, le=9000)] = 1000
    p0881: Annotated[int, Field(ge=0, le=1000)] = 100
    position_check: bool = True
    parameter_check: bool = False

    @property
    def family_name(self) -> str:
        """Its family."""
        return "profidrive"

    @property
    def has_interface(self) -> bool:
        """G1, and bits 12 to 15 of ZSW2."""
        return True

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return (
            f"PROFIdrive, telegram {self.telegram}, {self.lines} lines a turn with {self.p1042}"
            f" fine bits: {float(1_000_000 / self.per_mm):.4g} nm an increment"
        )

    @classmethod
    def habits(cls) -> tuple[str, ...]:
        """Return the habits of the axis that the family has."""
        return HABITS

    @property
    def per_mm(self) -> Fraction:
        """Increments of G1_XIST1 for 1 mm, exact."""
        return (self.lines << self.p1042) / (Fraction(self.make().drive.lead_um) / 1000)

    @property
    def proves_places(self) -> bool:
        """Whether the absolute position can be compared with G1_XIST1."""
        return self.position_check and self.p1043 == self.p1042

    def make(self) -> ProfidriveProfile:
        """Make the drive. Raises UserError for a value that cannot be."""
        return self._made

    @cached_property
    def _made(self) -> ProfidriveProfile:
        drive = make_profile({key: getattr(self, key) for key in HABITS})
        drive = replace(drive, encoder_increments=self.lines << self.p1042, velocity_demand="held")
        return ProfidriveProfile(
            drive,
            telegrams()[self.telegram],
            self.p0660,
            self.p0880,
            self.p0925,
            self.p1042,
            self.p1230,
            self.p0881,
            self.p1043 - self.p1042,
        )

    def facts(self) -> DriveFacts:
        """Return what is asked of any drive. Raises UserError for a value that cannot be."""
        drive = self.make().drive
        before_ns, after_ns = drive.latch_window_ns
        return DriveFacts(
            units_per_mm=self.per_mm,
            reach_mm=float(POSITION_RANGE / self.per_mm),
            lead_mm=float(self.lead_mm),
            rated_torque_mnm=drive.rated_torque_mnm,
            look_back_ns=before_ns,
            look_ahead_ns=after_ns,
            second_delay_cycles=int(self.second_delay_cycles),
            latch=LatchTimes(
                delay_ns=drive.input_delay_ns + drive.input_filter_ns,
                compensation_ns=drive.delay_compensation_ns,
                sample_ns=drive.grid_ns if drive.latch_mode == "sampled" else 0,
                jitter_ns=drive.input_jitter_ns,
            ),
        )
