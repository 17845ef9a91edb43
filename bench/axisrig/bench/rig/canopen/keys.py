"""Tables of a rig that CANopen drives have: `[segment.S]` of a CAN bus, `[drive.D]`."""

from collections.abc import Callable
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    PrivateAttr,
    create_model,
    model_validator,
)

from axisrig.bench.bus.can.hardware import (
    SIMULATED,
    Option,
    interface_names,
    parse_options,
    wait_ns,
)
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import (
    DEFAULT_PROFILE,
    Habit,
    habits,
    in_lengths,
    make_profile,
    profile_keys,
    profile_names,
    value_of,
)
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.canopen.startup import StartUpKeys
from axisrig.bench.rig.reading.tables import DriveFacts, DriveKeys, SegmentKeys
from axisrig.kernel.errors import nearest
from axisrig.kernel.time.clock import TimeNs

ENCODER_RANGE = 1 << 31  # INTEGER32 of 6064, increments


def _whole_um(value_mm: float) -> float:
    if round(value_mm * 1000) != round(value_mm * 1000, 6):
        raise ValueError("a whole number of micrometres is needed")
    return value_mm


def _known_interface(name: str) -> str:
    names = interface_names()
    if name not in names:
        near = nearest(name, names) or names
        raise ValueError(f"there is no such CAN interface; allowed: {', '.join(near)}")
    return name


def _options(value: object) -> object:
    return parse_options(value) if isinstance(value, str) else value


class SegmentTable(SegmentKeys):
    """`[segment.NAME]`: one CAN bus.

    interface: simulated, or the python-can interface of a real one; channel and options: for it.
    queue, drive_queue: transmit queue of the kernel's port and of the drives' ports. bus_off: what
    a controller does that has become bus-off. overload: what becomes of a cycle that does not fit.
    """

    carrier: Literal["can"] = "can"
    interface: Annotated[str, AfterValidator(_known_interface)] = SIMULATED
    channel: str | int | None = None
    options: Annotated[dict[str, Option], BeforeValidator(_options)] = Field(default_factory=dict)
    bitrate: Literal[125_000, 250_000, 500_000, 800_000, 1_000_000] = 1_000_000
    queue: Literal["fifo", "mailbox"] = "fifo"
    drive_queue: Literal["fifo", "mailbox"] = "fifo"
    bus_off: Literal["recover", "stay"] = "recover"
    overload: Literal["refuse", "run"] = "refuse"

    @property
    def is_real(self) -> bool:
        """Whether it is outside this process."""
        return self.interface != SIMULATED

    @property
    def answer_wait_ns(self) -> TimeNs:
        """How long a cycle waits for answers, where it is outside this process."""
        return wait_ns(self.interface) if self.is_real else 0

    @property
    def has_nodes(self) -> bool:
        """Each drive has a node id."""
        return True


def _habit_field(habit: Habit) -> Any:
    kind: Any = {"whole": int, "number": float, "flag": bool, "text": str}.get(habit.type)
    if kind is None:
        kind = Literal[habit.words]
    elif habit.low is not None:
        kind = Annotated[kind, Field(ge=kind(habit.low), le=kind(habit.high))]
    if habit.field.endswith("_um"):
        kind = Annotated[kind, AfterValidator(_whole_um)]
    return kind, habit.values[DEFAULT_PROFILE]


_FIELDS: dict[str, Any] = {
    "profile": (Literal[profile_names()], DEFAULT_PROFILE),
    **{key: _habit_field(habit) for key, habit in habits().items()},
}
_HabitTable: Any = create_model("_HabitTable", __base__=StartUpKeys, **_FIELDS)


class DriveTable(_HabitTable, DriveKeys):  # type: ignore[misc]
    """`[drive.NAME]`: what kind of drive moves an axis.

    profile: name of a set of habits; every key of `profiles.csv` that the rig does not
    give has the profile's value. position_unit_um: length of a position unit on the bus, for drives
    whose unit is a length; not said = an encoder increment. as_canopen: it replaces the drive of
    another type that a list names (P-AXIS-00020). How it is started: `StartUpKeys`.
    """

    family: Literal["canopen"] | None = None
    position_unit_um: Annotated[float, Field(gt=0, le=1e6)] | None = None
    as_canopen: bool = False
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="wrap")
    @classmethod
    def _with_profile(cls, values: Any, handler: Callable[[Any], "DriveTable"]) -> "DriveTable":
        name = values.get("profile", DEFAULT_PROFILE) if isinstance(values, dict) else None
        if not isinstance(name, str) or name not in profile_names():
            return handler(values)
        table = handler({**profile_keys(name), **values})
        table._given = dict(values)
        return table

    @property
    def family_name(self) -> str:
        """Its family, also where the rig leaves it out."""
        return "canopen"

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return f"EDS {self.eds}" if self.eds else f"profile {self.profile}"

    @property
    def replaces_others(self) -> bool:
        """Whether it may stand for a drive of another type that a list names (P-AXIS-00020)."""
        return self.as_canopen

    @property
    def shows_life(self) -> bool:
        """Whether it sends heartbeats, or is guarded."""
        is_written = any(str(write[0]).lower().startswith("0x1017:") for write in self.sdo)
        return bool(self.heartbeat_ms or self.guard_time_ms or is_written)

    @classmethod
    def value_of(cls, key: str, text: str) -> Any:
        """Read the cell of a plan for one of its keys; a text that fits nothing stays one."""
        return value_of(key, text)

    def changed(self, key: str, value: Any) -> "DriveTable":
        """Return the drive with one key changed; a new profile keeps what the rig has given.

        Raises ValidationError.
        """
        table: DriveTable = DriveTable.model_validate({**self._given, key: value})
        return table

    def make(self) -> DriveProfile:
        """Make the drive node's profile. Raises UserError for a value that cannot be."""
        return self._made

    @cached_property  # asked for some thirty times at every start
    def _made(self) -> DriveProfile:
        made = make_profile({key: getattr(self, key) for key in habits()})
        return made if self.position_unit_um is None else in_lengths(made, self.position_unit_um)

    def facts(self) -> DriveFacts:
        """Return what is asked of any drive. Raises UserError for a value that cannot be."""
        made = self.make()
        before_ns, after_ns = made.latch_window_ns
        return DriveFacts(
            units_per_mm=made.units_per_mm,
            reach_mm=ENCODER_RANGE / self.encoder_increments * self.lead_mm,
            lead_mm=float(self.lead_mm),
            rated_torque_mnm=made.rated_torque_mnm,
            look_back_ns=before_ns,
            look_ahead_ns=after_ns,
            second_delay_cycles=int(self.second_delay_cycles),
            latch=LatchTimes(
                delay_ns=made.input_delay_ns + made.input_filter_ns,
                compensation_ns=made.delay_compensation_ns,
                sample_ns=made.grid_ns if made.latch_mode == "sampled" else 0,
                jitter_ns=made.input_jitter_ns,
            ),
        )
