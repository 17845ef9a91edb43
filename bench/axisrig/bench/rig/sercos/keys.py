"""Keys of `[drive.D]` of a SERCOS drive."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, PrivateAttr, create_model

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import Habit, habits, make_profile
from axisrig.bench.drive.sercos import profiles
from axisrig.bench.drive.sercos.profiles import SercosProfile, units_per_turn
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.reading.families import FAMILIES, read_drive
from axisrig.bench.rig.reading.tables import DriveFacts, DriveKeys, Table
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.sercos.service import ident_number
from axisrig.kernel.profiles.sercos.words import telegram_idents
from axisrig.kernel.time.clock import US

POSITION_RANGE = 1 << 31
HABITS = (
    "encoder_increments", "lead_mm", "tick_us", "rated_torque_mnm", "rated_current_ma",
    "input_delay_us", "input_jitter_us", "input_filter_us", "min_pulse_us",
    "delay_compensation_us", "latch", "sample_us", "second_delay_cycles", "sdo_answer_us",
    "sync_loss_periods",
)  # fmt: skip
"""Habits of any drive at its axis and inputs that are keys here too."""
OF_ANY = (
    "missing_cycles", "jump_factor", "lag_limit_mm", "fault_reset", "latch_check", "position_check",
)  # fmt: skip


def _ident(text: str) -> str:
    ident_number(text)
    return text


def _start_up(entry: list[str | int]) -> list[str | int]:
    if len(entry) != 2 or not isinstance(entry[0], str):
        raise ValueError('each entry is an ident and its value, ["S-0-0301", "S-0-0405"]')
    _ident(entry[0])
    if isinstance(entry[1], str):
        _ident(entry[1])
    return entry


def _habit_field(habit: Habit) -> Any:
    kind: Any = {"whole": int, "number": float}.get(habit.type) or Literal[habit.words]
    if habit.low is not None:
        kind = Annotated[kind, Field(ge=kind(habit.low), le=kind(habit.high))]
    return kind, habit.values["generic"]


_FIELDS: dict[str, Any] = {key: _habit_field(habits()[key]) for key in HABITS}
_HabitTable: Any = create_model("_HabitTable", __base__=Table, **_FIELDS)
Ident = Annotated[str, AfterValidator(_ident)]
Entry = Annotated[list[str | int], AfterValidator(_start_up)]


class DriveTable(_HabitTable, DriveKeys):  # type: ignore[misc]
    """`[drive.NAME]` of a SERCOS drive.

    profile: which of the two drives. at, mdt: idents of its telegrams, behind the words. scaling,
    resolution: of positions in the drive at power on: rotary with so many increments per turn, or
    linear with 0.1 um. idents: start-up list, each an ident and its value, which may be an ident.
    probing: start = the control begins the probing cycle S-0-0170; none = nobody does.
    missing_cycles: how often in a row its telegram may stay out. latch_check: a latch counts only
    when the service channel gives the value too; position_check: so with the position from which
    the drive is led. soe_timeout_ms: for each answer. as_canopen: a run
    may set it (`--as-canopen`), and has the usual drive with the same axis then.
    """

    family: Literal["sercos"]
    profile: Literal[profiles.NAMES] = profiles.NAMES[0]  # type: ignore[valid-type]
    at: list[Ident] = Field(default_factory=lambda: ["S-0-0051", "S-0-0130"])
    mdt: list[Ident] = Field(default_factory=lambda: ["S-0-0047"])
    scaling: Literal["rotary", "linear"] = "rotary"
    resolution: Annotated[int, Field(ge=1, le=1 << 30)] = 1 << 20
    idents: list[Entry] = Field(default_factory=list)
    probing: Literal["start", "none"] = "start"
    missing_cycles: Annotated[int, Field(ge=0, le=1000)] = 3
    jump_factor: Annotated[float, Field(ge=0, le=1000)] = 2.0
    lag_limit_mm: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    fault_reset: bool = False
    latch_check: bool = True
    position_check: bool = True
    soe_timeout_ms: Annotated[int, Field(ge=1, le=60_000)] = 1000
    as_canopen: Literal[False] = False
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @property
    def family_name(self) -> str:
        """Its family."""
        return "sercos"

    @property
    def has_idents(self) -> bool:
        """It has them."""
        return True

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        unit = f"2^{self.resolution.bit_length() - 1}" if self._is_power else f"{self.resolution}"
        how = f"{unit} increments a turn" if self.scaling == "rotary" else "0.1 um"
        return f"SERCOS, profile {self.profile}, positions in {how}"

    @property
    def _is_power(self) -> bool:
        return self.resolution & self.resolution - 1 == 0

    @classmethod
    def value_of(cls, key: str, text: str) -> Any:
        """Read the cell of a plan for one of its keys; a text that fits nothing stays one.

        Lists are words with blanks between them; entries of idents are `S-0-0169=1`.
        """
        if key in ("at", "mdt"):
            return text.split()
        if key == "idents":
            parts = (part.partition("=") for part in text.split())
            return [[ident, _number(value)] for ident, _, value in parts]
        return _number(text)

    def changed(self, key: str, value: Any) -> Any:
        """Return the drive with one key changed. Raises ValidationError.

        A value for `idents` replaces those of the same idents and adds the others.
        """
        given = self.model_dump(exclude_unset=True)
        if key == "as_canopen" and value is True:
            kept = {name: given[name] for name in (*HABITS, *OF_ANY) if name in given}
            return read_drive({"family": FAMILIES[0].family, key: True, **kept})
        if key == "idents" and isinstance(value, list):
            own = {entry[0]: entry for entry in value}
            value = [*(own.pop(entry[0], entry) for entry in self.idents), *own.values()]
        table: DriveTable = DriveTable.model_validate({**given, key: value})
        return table

    @property
    def start_list(self) -> list[tuple[int, int]]:
        """The start-up list as words and numbers."""
        return [
            (ident_number(str(ident)), value if isinstance(value, int) else ident_number(value))
            for ident, value in self.idents
        ]

    def _units(self) -> Fraction:
        """Return position units per turn when the start-up list has been written."""
        made = self.make()
        values = dict(self.start_list)
        places = [
            values.get(ident_number(f"S-0-00{number}"), default)
            for number, default in (
                (76, made.scaling),
                (77, made.linear_factor),
                (78, made.linear_exponent),
                (79, made.resolution),
            )
        ]
        kind, factor, exponent, resolution = places
        units = units_per_turn(kind, factor, exponent, resolution, made.drive.lead_um)
        if units is None or units.denominator != 1:
            raise UserError(
                "scaling: positions have no unit, or a turn is no whole number of them"
                " (S-0-0076 to S-0-0079)",
                value=f"S-0-0076 = 0x{kind:02X}",
                allowed="0x09 linear, 0x0A rotary",
            )
        return units

    def make(self) -> SercosProfile:
        """Make the drive. Raises UserError for a value that cannot be."""
        return self._made

    @cached_property
    def _made(self) -> SercosProfile:
        drive = make_profile({key: getattr(self, key) for key in HABITS})
        gap_ns = int(profiles.value_of(self.profile, "edge_gap_us")) * US
        drive = replace(drive, dead_time_ns=gap_ns, latch_encoder="function_bit")
        made = profiles.make_profile(self.profile, drive, self.scaling, self.resolution)
        units = units_per_turn(
            made.scaling, made.linear_factor, made.linear_exponent, made.resolution, drive.lead_um
        )
        assert units is not None, "both kinds have one"
        factor = units / drive.encoder_increments
        return replace(made, drive=_scaled(drive, factor))

    def facts(self) -> DriveFacts:
        """Return what is asked of any drive. Raises UserError for a value that cannot be."""
        drive, units = self.make().drive, self._units()
        before_ns, after_ns = drive.latch_window_ns
        per_mm = units * 1000 / drive.lead_um
        return DriveFacts(
            units_per_mm=per_mm,
            reach_mm=float(POSITION_RANGE / per_mm),
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


def _scaled(drive: DriveProfile, factor: Fraction) -> DriveProfile:
    return replace(drive, position_factor=factor)


def _number(text: str) -> Any:
    kinds: tuple[Callable[[str], Any], ...] = (lambda word: int(word, 0), float)
    for kind in kinds:
        try:
            return kind(text)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(text.lower(), text)


def carried(text: str, telegram: str) -> bool:
    """Whether a telegram can carry an ident."""
    row = telegram_idents().get(ident_number(text))
    return row is not None and row.telegram == telegram
