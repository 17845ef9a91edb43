"""Real CAN buses: their segments."""

from functools import partial

from axisrig.bench.bus.can.hardware import open_bus
from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.journal import Journal
from axisrig.bench.bus.paced import PacedScheduler
from axisrig.bench.rig.canopen.members import segment_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.scheduler import Scheduler


def open_segment(
    settings: Settings, name: str, scheduler: Scheduler, journal: Journal
) -> OutsideSegment:
    """Open the interface of a segment. Raises UserError when that fails."""
    table = segment_of(settings, name)
    assert isinstance(scheduler, PacedScheduler)  # made together, by `is_paced`
    opener = partial(open_bus, table.interface, table.channel, table.bitrate, table.options)
    return OutsideSegment(name, table.bitrate, scheduler, opener, journal)
