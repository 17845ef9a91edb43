"""CAN segments and drive nodes of a rig, with or without a kernel."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.logs import open_log
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.canopen.node import Document, DriveNode
from axisrig.bench.machine.canopen.outside import open_segment
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.canopen.members import can_axes, can_segments, drive_of, segment_of
from axisrig.bench.rig.canopen.startup import drive_dictionary
from axisrig.bench.rig.real_axes import is_real, outside_axes
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.scheduler import Scheduler

DRIVE_SEED_STRIDE = 1_000_003


def build_segments(
    settings: Settings,
    scheduler: Scheduler,
    journal: Journal,
    bus_logs: Sequence[Path],
    opened: ExitStack,
) -> dict[str, Segment]:
    """Open every segment, simulated or real, with its records; `opened` closes them.

    journal: gets every frame. bus_logs: files to write, their suffixes say the kind.

    Raises UserError when an interface cannot be opened.
    """
    segments: dict[str, Segment] = {}
    for path in bus_logs:
        log = open_log(path, can_segments(settings))
        opened.callback(log.stop)
        journal.add(log.take)
    opened.callback(journal.drain)  # before the logs stop, also where an exception ends the run
    for name in can_segments(settings):
        table = segment_of(settings, name)
        if is_real(settings, name):
            segment: Segment = open_segment(settings, name, scheduler, journal)
        else:
            recovers = table.bus_off == "recover"
            segment = Segment(
                name, table.bitrate, scheduler, automatic_recovery=recovers, journal=journal
            )
        opened.enter_context(segment)
        segments[name] = segment
    return segments


def build_nodes(
    settings: Settings,
    scheduler: Scheduler,
    segments: dict[str, Segment],
    beside: Beside,
    seed: int,
    entered: Callable[[str, State], None] | None = None,
) -> dict[str, DriveNode]:
    """Make the node of every axis whose drive is simulated here.

    beside: the plant as they see it. seed: of what they draw. entered: called with the axis and
    each new state of its drive.
    """
    nodes: dict[str, DriveNode] = {}
    outside = outside_axes(settings)
    for name in can_axes(settings):
        if name in outside:
            continue
        axis = settings.rig.axis[name]
        queue = segment_of(settings, axis.segment).drive_queue
        network = SimNetwork(segments[axis.segment].port(name, queue))
        network.connect()
        nodes[name] = DriveNode(
            name,
            axis.node_id,
            network,
            scheduler,
            beside.axis(name),
            beside.probes(name),
            drive_of(settings, name).make(),
            seed + DRIVE_SEED_STRIDE * len(nodes),
            switches=beside.switches(name),
            entered=None if entered is None else partial(entered, name),
            document=_document(settings, name),
        )
    return nodes


def _document(settings: Settings, name: str) -> Document | None:
    """Return the EDS of the drive of an axis, None where the rig names none."""
    drive = drive_of(settings, name)
    if drive.eds is None:
        return None
    od = drive_dictionary(drive, settings.rig.axis[name].node_id, drive.make())
    return Document(od, Path(drive.eds).read_bytes())
