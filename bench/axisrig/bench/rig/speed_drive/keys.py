"""Keys of `[drive.D]` that each drive has that only takes a speed; a family derives its own."""

from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any

from pydantic import Field

from axisrig.bench.drive.cia402.dictionary.profiles import make_profile
from axisrig.bench.drive.speed_drive.profile import SpeedProfile
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.habit_keys import habit_table
from axisrig.bench.rig.image_drive_keys import ImageDriveKeys
from axisrig.bench.rig.reading.tables import DriveFacts

POSITION_RANGE = 1 << 31
HABITS = (
    "lead_mm", "tick_us", "rated_torque_mnm", "rated_current_ma", "input_delay_us",
    "input_jitter_us", "input_filter_us", "min_pulse_us", "delay_compensation_us", "latch",
    "sample_us",
)  # fmt: skip
EDGES_PER_LINE = 4
_HabitTable: Any = habit_table(HABITS)


class SpeedDriveTable(_HabitTable, ImageDriveKeys):  # type: ignore[misc]
    """`[drive.NAME]` of a drive that only takes a speed.

    watchdog_cycles: images in a row that may stay out before the outputs are 0.
    """

    watchdog_cycles: Annotated[int, Field(ge=0, le=1000)] = 3

    @property
    def family_name(self) -> str:
        """Its family."""
        return str(self.family)

    @property
    def has_output(self) -> bool:
        """Whether it gets its speed from an output."""
        return True

    @property
    def full_rpm(self) -> float:
        """Its speed at the full output."""
        raise NotImplementedError

    @property
    def output(self) -> tuple[int, int]:
        """Bits of the output with its sign, and what it has at 0 in counts of 16 bits."""
        return 16, 0

    @property
    def increments_per_turn(self) -> int:
        """Increments of its counter for a turn."""
        raise NotImplementedError

    @classmethod
    def habits(cls) -> tuple[str, ...]:
        """Return the habits of the axis that the family has."""
        return HABITS

    @property
    def per_mm(self) -> Fraction:
        """Increments of the counter for 1 mm, exact."""
        return self.increments_per_turn / (Fraction(self.make().drive.lead_um) / 1000)

    @property
    def full_mm_s(self) -> Fraction:
        """Speed at the full output, exact."""
        return Fraction(self.full_rpm) / 60 * Fraction(self.make().drive.lead_um, 1000)

    @property
    def latch_per_mm(self) -> Fraction | None:
        """Increments of a latched value for 1 mm; None: those of the counter."""
        return None

    def make(self) -> SpeedProfile:
        """Make the drive. Raises UserError for a value that cannot be."""
        return self._made

    @cached_property
    def _made(self) -> SpeedProfile:
        drive = make_profile({key: getattr(self, key) for key in HABITS})
        return SpeedProfile(
            replace(drive, encoder_increments=self.increments_per_turn),
            self.full_rpm,
            *self.output,
            self.watchdog_cycles,
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
            second_delay_cycles=0,
            latch=LatchTimes(
                delay_ns=drive.input_delay_ns + drive.input_filter_ns,
                compensation_ns=drive.delay_compensation_ns,
                sample_ns=drive.grid_ns if drive.latch_mode == "sampled" else 0,
                jitter_ns=drive.input_jitter_ns,
            ),
            latch_per_mm=self.latch_per_mm,
        )


class AnalogueTable(SpeedDriveTable):
    """`[drive.NAME]` of a drive at an analogue output.

    rpm_at_10v: its speed at the full output. output_bits: resolution of the output.
    output_offset: what the output has at 0, counts of 16 bits. lines: of the encoder per turn, each
    counted four times.
    """

    rpm_at_10v: Annotated[float, Field(gt=0, le=100_000)] = 3000.0
    output_bits: Annotated[int, Field(ge=8, le=16)] = 16
    output_offset: Annotated[int, Field(ge=-3276, le=3276)] = 0
    lines: Annotated[int, Field(ge=1, le=1 << 20)] = 1024

    @property
    def full_rpm(self) -> float:
        """Its speed at 10 V."""
        return float(self.rpm_at_10v)

    @property
    def output(self) -> tuple[int, int]:
        """Bits of the output with its sign, and what it has at 0 in counts of 16 bits."""
        return int(self.output_bits), int(self.output_offset)

    @property
    def increments_per_turn(self) -> int:
        """Increments of its counter for a turn."""
        return int(self.lines) * EDGES_PER_LINE
