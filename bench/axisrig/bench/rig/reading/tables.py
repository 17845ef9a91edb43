"""What every table of a rig file has in common, and the tables of its time base."""

from abc import abstractmethod
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.kernel.time.clock import TimeNs

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]


class Table(BaseModel):
    """A table of the rig: unknown keys are refused, values are not converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


_LATCH_AT_EDGE = LatchTimes()


@dataclass(frozen=True)
class DriveFacts:
    """What is asked of a drive of any family.

    units_per_mm: position units of its actual value. reach_mm: the largest position that it can
    report, of either sign. lead_mm: travel of the axis in one revolution of its motor.
    rated_torque_mnm: what torques are shares of, 0 where there is none. look_back_ns,
    look_ahead_ns: how far from an edge its latch looks at the path. second_delay_cycles: age of its
    second encoder. latch: what the data sheet says of the instant of a latch. latch_per_mm:
    increments in which a latched value comes, None: those of its actual value.
    """

    units_per_mm: Fraction
    reach_mm: float
    lead_mm: float
    rated_torque_mnm: int
    look_back_ns: TimeNs
    look_ahead_ns: TimeNs
    second_delay_cycles: int
    latch: LatchTimes = _LATCH_AT_EDGE
    latch_per_mm: Fraction | None = None


class DriveKeys(Table):
    """`[drive.NAME]` of any family; each has a table of its own that derives from it.

    family: what its words mean; not said = as P-AXIS-00020 of the lists of its axes says.
    """

    family: str | None = None

    @property
    @abstractmethod
    def family_name(self) -> str:
        """Its family, also where the rig leaves it out."""

    @property
    @abstractmethod
    def in_words(self) -> str:
        """What it is, for who reads a rig."""

    @property
    def replaces_others(self) -> bool:
        """Whether it may stand for a drive of another type that a list names (P-AXIS-00020)."""
        return False

    @property
    def shows_life(self) -> bool:
        """Whether it sends heartbeats, or is asked for such by a guard."""
        return False

    @property
    def has_idents(self) -> bool:
        """Whether it has idents, read and written over a service channel, and real-time bits."""
        return False

    @property
    def has_output(self) -> bool:
        """Whether it gets its speed from an output whose scale its rig is checked for."""
        return False

    @property
    def has_interface(self) -> bool:
        """Whether it has an encoder interface and a sign of life."""
        return False

    @classmethod
    @abstractmethod
    def value_of(cls, key: str, text: str) -> Any:
        """Read the cell of a plan for one of its keys; a text that fits nothing stays one."""

    @abstractmethod
    def changed(self, key: str, value: Any) -> Self:
        """Return the drive with one key changed. Raises pydantic's ValidationError."""

    @abstractmethod
    def facts(self) -> DriveFacts:
        """Return what is asked of any drive. Raises UserError for a value that cannot be."""


class SegmentKeys(Table):
    """`[segment.NAME]` of any carrier; each has a table of its own that derives from it.

    carrier: how bytes get to the drives and back.
    """

    carrier: str

    @property
    def is_real(self) -> bool:
        """Whether it is outside this process."""
        return False

    @property
    def is_line(self) -> bool:
        """Whether its drives are slaves that one frame passes in each cycle."""
        return False

    @property
    def swaps_images(self) -> bool:
        """Whether it swaps one image in and out with each drive in a cycle."""
        return False

    @property
    def answer_wait_ns(self) -> TimeNs:
        """How long a cycle waits for answers, where it is outside this process."""
        return 0

    @property
    def has_nodes(self) -> bool:
        """Whether each of its drives has an address (`node` of the axis)."""
        return False


def _not_one(value: int) -> int:
    if value == 1:
        raise ValueError("a SYNC counter runs from 1 to 2 .. 240; 0 sends SYNC without one")
    return value


class CycleTable(Table):
    """`[cycle]`: the time base of the machine, all in microseconds or cycles."""

    period_us: Annotated[int, Field(ge=250, le=20_000)] = 1000
    cycle_offset_us: Annotated[int, Field(ge=0)] = 600
    exchange_us: Annotated[int, Field(ge=10, le=20_000)] = 20_000
    fine_us: Annotated[int, Field(ge=10, le=20_000)] = 50
    buffer_cycles: Annotated[int, Field(ge=0, le=100)] = 0
    sync_counter: Annotated[int, Field(ge=0, le=240), AfterValidator(_not_one)] = 0
    heartbeat_ms: Annotated[int, Field(ge=0, le=65_535)] = 0
    master_node: Annotated[int, Field(ge=1, le=127)] = 127


class RealtimeTable(Table):
    """`[realtime]`: for runs on a real bus; nothing here acts on simulated ones.

    late_us: from where on a SYNC counts as late. wait_ms: how long a cycle waits for answers of
    the drives that come later than cycle_offset_us; not said = by the interface.
    """

    late_us: Annotated[float, Field(ge=1, le=1e6)] = 100.0
    wait_ms: Annotated[float, Field(ge=0, le=1000)] | None = None


_WORDS = {
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "string_pattern_mismatch": "must be a letter, then letters, digits and _",
    "bool_type": "must be a number, true or false, or a text",
    "string_type": "must be a text",
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
}


def in_words(kind: str, message: str) -> str:
    """Say what is wrong with a value; pydantic's own words where they fit an engineer."""
    return _WORDS.get(kind) or message[:1].lower() + message[1:]
