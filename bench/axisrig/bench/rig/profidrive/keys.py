"""Keys of `[drive.D]` of a PROFIdrive drive."""

from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import Field

from axisrig.bench.drive.cia402.dictionary.profiles import make_profile
from axisrig.bench.drive.profidrive.profile import ProfidriveProfile
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.habit_keys import OF_ANY, habit_table, number
from axisrig.bench.rig.reading.families import FAMILIES, read_drive
from axisrig.bench.rig.reading.tables import DriveFacts, DriveKeys
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


class DriveTable(_HabitTable, DriveKeys):  # type: ignore[misc]
    """`[drive.NAME]` of a PROFIdrive drive.

    telegram: its number. lines: of the encoder per turn; p1042, p1043: fine bits of a line in
    G1_XIST1 with measured values, and of the absolute position. p0660: function of the fast input.
    p0880: speed in rpm that NSOLL_B is a share of. p0925: wrong signs of life that the drive
    tolerates. p1230: torque limit in 0.1 % of the rated torque; p0881: its reduction in 1 % at
    MOMRED = 16384. speed_loop_us: time of its speed loop. missing_cycles: how often in a row its
    telegram may stay out. position_check: it is led only from a position that its absolute position
    gives too. as_canopen: a run may set it (`--as-canopen`), and has the usual drive with the same
    axis then.
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
    speed_loop_us: Annotated[float, Field(ge=0, le=1_000_000)] = 0.0
    missing_cycles: Annotated[int, Field(ge=0, le=1000)] = 3
    jump_factor: Annotated[float, Field(ge=0, le=1000)] = 2.0
    lag_limit_mm: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    fault_reset: bool = False
    position_check: bool = True
    as_canopen: Literal[False] = False

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
    def value_of(cls, key: str, text: str) -> Any:
        """Read the cell of a plan for one of its keys; a text that fits nothing stays one."""
        return number(text)

    def changed(self, key: str, value: Any) -> Any:
        """Return the drive with one key changed. Raises ValidationError."""
        given = self.model_dump(exclude_unset=True)
        if key == "as_canopen" and value is True:
            kept = {name: given[name] for name in (*HABITS, *OF_ANY) if name in given}
            return read_drive({"family": FAMILIES[0].family, key: True, **kept})
        return DriveTable.model_validate({**given, key: value})

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
