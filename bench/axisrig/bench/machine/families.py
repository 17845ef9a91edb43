"""What a machine asks of what its segments carry: the registry says where it is.

`rig/reading/families.csv` names the modules.
"""

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import pyarrow as pa

from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.machine.plc.terminal import AnyTerminal
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.record.axes import DriveState, Telegram
from axisrig.bench.record.bus import BusFigures
from axisrig.bench.record.series import Times
from axisrig.bench.rig.reading.families import FAMILIES, loaded
from axisrig.bench.rig.reading.faults import Fault
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.drives.canopen.drive_functions import DriveAccess
from axisrig.kernel.drives.carrier import Carrier, Presence
from axisrig.kernel.drives.interface import Drive, DriveAccesses, DriveStart, DriveWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import TimeNs
from axisrig.kernel.time.scheduler import Scheduler


@dataclass(frozen=True)
class Bench:
    """What the drives of a machine are put into.

    beside: the plant as drives and terminals see it. bus_logs: files to write, their suffixes say
    the kind. opened: frees what is opened. seed: of everything random. hardware: None where all is
    simulated.
    """

    settings: Settings
    scheduler: Scheduler
    plant: Plant
    beside: Beside
    opened: ExitStack
    bus_logs: Sequence[Path] = ()
    seed: int = 0
    hardware: Hardware | None = None


class Installed:
    """The segments of one carrier in one machine, drives on them, and the control's ends of these.

    drives: virtual ones by axis, links: the control's ends by axis, in the order of the rig.
    carriers: by segment. states: of each virtual drive, since it was built. This base
    has nothing on its segments.
    """

    def __init__(self) -> None:
        self.drives: Mapping[str, VirtualDrive] = {}
        self.links: Mapping[str, Drive] = {}
        self.carriers: Mapping[str, Carrier] = {}
        self.states: Mapping[str, Sequence[DriveState]] = {}

    # The control's side

    def watch(self, axis: str) -> DriveWatch:
        """Make the watch over one drive."""
        raise NotImplementedError

    def start_up(self, axis: str) -> DriveStart:
        """Make the start-up of one drive."""
        raise NotImplementedError

    def presence(self) -> Presence | None:
        """Make what the control shows of itself on the segments."""
        return None

    def functions(self) -> DriveAccesses | None:
        """Return what #DRIVE acts on, None where no drive has a function."""
        return None

    @property
    def accesses(self) -> Mapping[str, DriveAccess]:
        """The ways to parameters of drives, by axis."""
        return {}

    @property
    def warnings(self) -> Sequence[Alarm]:
        """What was corrected when the ways to the drives were made."""
        return ()

    # The machine's side

    def terminal(self, advance: Callable[[int], None]) -> AnyTerminal | None:
        """Make the inputs of the PLC, where its terminal is on a segment of this carrier.

        advance: steps the plants to an instant.
        """
        return None

    def listen(self, into: Received) -> None:
        """Note from now on what comes to the control, as far as telegrams show it."""

    def build_fault(self, fault: Fault, numbers: random.Random, record: Injected) -> Act | None:
        """Build in a fault of frames on its segments, or of a drive there; None for others.

        numbers: of this fault alone. record: gets which frames are hit.
        """
        return None

    def sampled_ns(self, axis: str, sync_ns: TimeNs) -> TimeNs:
        """Return when the actual position of this cycle is sampled, as the control knows it.

        sync_ns: when the SYNC of this cycle was to be sent. One that the drive has not heard brings
        no position, and none of an earlier instant either.
        """
        drive = self.drives.get(axis)
        return sync_ns if drive is None else max(sync_ns, drive.sync_ns)

    def clock_limit_ns(self, axis: str) -> TimeNs | None:
        """Return how far the clocks that `sampled_ns` rests on may be apart at a time stamp.

        None: nobody watches them.
        """
        return None

    def clocks_off_ns(self, axis: str) -> TimeNs:
        """Return how far they were apart at most since the actual position before."""
        return 0

    def look(self) -> Iterator[Alarm]:
        """Return what has gone wrong with segments outside since the last look."""
        return iter(())

    def is_off(self, axis: str) -> bool:
        """Whether the drive of an axis has left operation."""
        raise NotImplementedError

    def let_go(self, axes: Sequence[str]) -> None:
        """Say to real drives that nobody leads them any more; they are off, or silent."""

    # What a run leaves

    def hexdigest(self) -> str:
        """Return a hash of all that was sent on the segments."""
        raise NotImplementedError

    def take_columns(self, times_ns: Times, *, is_last: bool) -> Mapping[str, pa.Array]:
        """Return columns of the cyclic values up to each instant that no earlier call has returned.

        times_ns: of the rows, shape (n,). is_last: what came after them belongs to the last row.
        """
        return {}

    def figures(self) -> Sequence[BusFigures]:
        """Return what each segment has carried."""
        return ()

    def telegrams(self, axis: str) -> Sequence[Telegram]:
        """Return what the cyclic telegrams of an axis carry."""
        return ()

    def shown(self) -> Sequence[Mapping[str, Any]]:
        """Return the present state of each segment, as `live.states` shows it."""
        return ()


def build_fault(
    parts: Sequence[Installed], fault: Fault, numbers: random.Random, record: Injected
) -> Act:
    """Build in a fault of frames or of a drive where its segment is."""
    built = (part.build_fault(fault, numbers, record) for part in parts)
    return next(act for act in built if act is not None)


class Install(Protocol):
    """`install` of the module that `machine` of a row names."""

    def __call__(self, bench: Bench) -> Installed:
        """Install what the segments carry. Raises UserError where one cannot be opened."""
        ...


def install_all(bench: Bench) -> list[Installed]:
    """Install what the segments of a rig carry, in the order of the registry."""
    carriers = {table.carrier for table in bench.settings.segment.values()}
    modules = dict.fromkeys(row.machine for row in FAMILIES if row.carrier in carriers)
    return [_install(module)(bench) for module in modules]


def _install(module: str) -> Install:
    found: Install = loaded(module).install
    return found
