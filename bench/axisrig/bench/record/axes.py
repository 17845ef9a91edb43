"""What a run leaves of axes and their drives, plants and probes."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs

Value = bool | int | float | str
"""A parameter as a list writes it; its numbers are finite."""


@dataclass(frozen=True)
class Telegram(Frozen):
    """A PDO of an axis. transmission: its CANopen type; fields: of the kernel, in their order."""

    name: str
    transmission: int
    fields: tuple[str, ...]


@dataclass(frozen=True)
class PlantValue(Frozen):
    """A parameter of an FMU in SI units. exponents: of kg, m, s, A, K, mol, cd, rad; None: none."""

    value: float
    exponents: tuple[int, int, int, int, int, int, int, int] | None = None


@dataclass(frozen=True)
class PlantRecord(Frozen):
    """The FMU of an axis. values: its parameters by the names of `plant_values.csv`.

    kv_per_s: gain of its position loop, None where it has none.
    """

    values: Mapping[str, PlantValue] = field(default_factory=dict)
    kv_per_s: float | None = None


@dataclass(frozen=True)
class Latch(Frozen):
    """An instant whose position a drive has stored. probe: number of the touch probe."""

    time_ns: TimeNs
    probe: int


@dataclass(frozen=True)
class TorqueLimit(Frozen):
    """Torque limits of a drive from an instant on, per mille of its rated torque.

    most: 6072, negative: 60E1, positive: 60E0.
    """

    since_ns: TimeNs
    most: int
    negative: int
    positive: int


@dataclass(frozen=True)
class DriveState(Frozen):
    """A change of the state machine of a drive. is_trouble: quick stop, fault, reaction to one."""

    time_ns: TimeNs
    state: str
    is_trouble: bool = False


@dataclass(frozen=True)
class AxisRecord(Frozen):
    """One axis of the rig with its drive.

    plant: what moves it, simulated only where the drive is (`is_outside`). signals: plant at each
    input of the drive (`probe_1`). sensor: plant that its second encoder reads. is_rotary:
    positions are degrees. arm_m: travel per radian where the plant turns; torque_arm_m: what makes
    torques of its forces. written: its parameters, list and plan. origin_mm: place of the plant
    that the drive counts from at the end; homed_ns: when that was set anew (G74). doubt_mm: how far
    a measured value may be wrong that no SDO has proved; None: proved. unproved_latches: how many
    rest on telegrams alone. second_delay_cycles: age of 60E4 beside 6064.
    late_cycles: by how many more than 2 the control sees what its set values do in 6064.
    fresh_late_cycles: the same in what the PLC reads at the last SYNC of the drive.
    rated_torque_mnm, lead_um: of motor and screw. latch_per_mm: increments in which a latched value
    comes; None: those of the position.
    """

    segment: str
    node: int
    increments_per_mm: float
    is_outside: bool = False
    is_rotary: bool = False
    arm_m: float | None = None
    torque_arm_m: float | None = None
    plant: str = ""
    signals: Mapping[str, str] = field(default_factory=dict)
    sensor: str = ""
    telegrams: tuple[Telegram, ...] = ()
    written: Mapping[str, Value] = field(default_factory=dict)
    origin_mm: float = 0.0
    homed_ns: tuple[TimeNs, ...] = ()
    doubt_mm: float | None = None
    unproved_latches: int = 0
    second_delay_cycles: int = 0
    late_cycles: int = 0
    fresh_late_cycles: int = 0
    rated_torque_mnm: int = 0
    lead_um: float = 0.0
    latches: tuple[Latch, ...] = ()
    torque_limits: tuple[TorqueLimit, ...] = ()
    states: tuple[DriveState, ...] = ()
    latch_per_mm: float | None = None

    @property
    def later_cycles(self) -> int:
        """Cycles by which 6064 is older than the last SYNC of the drive."""
        return self.late_cycles - self.fresh_late_cycles


@dataclass(frozen=True)
class Contact(Frozen):
    """The plant's own truth of a touch. position_mm: of each axis of the probe, by its plant."""

    time_ns: TimeNs
    position_mm: Mapping[str, float]


@dataclass(frozen=True)
class Edge(Frozen):
    """A change of the signal of a probe."""

    time_ns: TimeNs
    level: bool


@dataclass(frozen=True)
class Deflection(Frozen):
    """How far a contact deflected a probe. doubt_mm: more between two cycles; beyond_ns: the cycle
    that saw it above the stroke, None when it stayed within. words: what was above the stroke.
    """

    mm: float
    doubt_mm: float
    beyond_ns: TimeNs | None = None
    words: str = ""


@dataclass(frozen=True)
class ProbeRecord(Frozen):
    """A probe of the plant. has_contacts: its FMU gives contacts.

    edge_uncertainty_ns: how well the instants of its edges and contacts are known. edges: of the
    plant. passed: what came of them where a fault bends its wire; None: the same.
    """

    has_contacts: bool
    edge_uncertainty_ns: float
    contacts: tuple[Contact, ...] = ()
    edges: tuple[Edge, ...] = ()
    deflections: tuple[Deflection, ...] = ()
    passed: tuple[Edge, ...] | None = None
