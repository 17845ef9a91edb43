"""The data of a segment and of its drives that the master needs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from axisrig.kernel.drives.cia402.settings import Cia402Settings
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.time.clock import MS, TimeNs


@dataclass(frozen=True)
class Pdo:
    """One PDO as the rig expects it. index: 0x1600 and following, or 0x1A00."""

    index: int
    objects: tuple[MappedObject, ...]


@dataclass(frozen=True, kw_only=True)
class SlaveSettings(Cia402Settings):
    """The data of one drive on EtherCAT.

    node_id: its position on the line, from 1 on. outputs, inputs: its PDOs, in the order of 1C12
    and 1C13. identity: sub-index of 1018 -> value that the EEPROM must show.
    """

    outputs: Sequence[Pdo] = ()
    inputs: Sequence[Pdo] = ()
    identity: Mapping[int, int] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class RegisterInputs:
    """A slave without a drive: the process image takes some of its registers as they are.

    axis: its name in alarms. node_id: its position on the line, behind the drives. first, size: of
    the registers. writes: what is written to it in PREOP, by the names of the registers.
    """

    axis: str
    node_id: int
    first: int
    size: int
    writes: Sequence[tuple[str, bytes]] = ()
    identity: Mapping[int, int] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class LineSettings:
    """The data of one segment.

    frame_ns: when the cyclic frame leaves, after the begin of a cycle. shift_ns: SYNC0, after the
    same. has_clocks: distributed clocks are set up and SYNC0 runs. compensates_drift,
    compensates_delay: FRMW in each cycle, 0928 at the start. sample_ns: when the control assumes
    that positions were sampled, after SYNC0. state_timeout_ns: for each change of state.
    clock_limit_ns, clock_timeout_ns: how far a clock may be off before SYNC0 begins, and how long
    that is waited for. watches_clocks: each cycle shows how far clocks are apart.
    """

    name: str
    period_ns: TimeNs
    frame_ns: TimeNs = 0
    shift_ns: TimeNs = 0
    has_clocks: bool = True
    compensates_drift: bool = True
    compensates_delay: bool = True
    sample_ns: Mapping[str, TimeNs] = field(default_factory=dict)
    state_timeout_ns: TimeNs = 2000 * MS
    clock_limit_ns: TimeNs = 1000
    clock_timeout_ns: TimeNs = 5000 * MS
    watches_clocks: bool = False

    @property
    def reads_differences(self) -> bool:
        """Whether the cyclic frame reads how far clocks are from the time that they get."""
        return self.has_clocks and self.compensates_drift and self.watches_clocks


STATION_BASE = 1000
"""Station address of the slave at position 1 is one more."""


def station_of(settings: SlaveSettings | RegisterInputs) -> int:
    """Return the station address that the master gives to a slave."""
    return STATION_BASE + settings.node_id
