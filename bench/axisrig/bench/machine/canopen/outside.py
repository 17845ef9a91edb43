"""Real CAN buses: their segments, and how the drives on them are left."""

from collections.abc import Iterable
from functools import partial

from axisrig.bench.bus.can.hardware import open_bus
from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.journal import Journal
from axisrig.bench.bus.paced import PacedScheduler
from axisrig.bench.rig.canopen.members import segment_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.carrier import Carrier
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import NMT_ID
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import TimeNs
from axisrig.kernel.time.scheduler import Scheduler

POWER_DOWN_CYCLES_MAX = 500
NMT_PRE_OPERATIONAL = 0x80
_OFF = (State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.FAULT)


def open_segment(
    settings: Settings, name: str, scheduler: Scheduler, journal: Journal
) -> OutsideSegment:
    """Open the interface of a segment. Raises UserError when that fails."""
    table = segment_of(settings, name)
    assert isinstance(scheduler, PacedScheduler)  # made together, by `is_paced`
    opener = partial(open_bus, table.interface, table.channel, table.bitrate, table.options)
    return OutsideSegment(name, table.bitrate, scheduler, opener, journal)


def power_down(
    scheduler: Scheduler,
    links: Iterable[AxisLink],
    carriers: Iterable[Carrier],
    period_ns: TimeNs,
    offset_ns: TimeNs,
) -> None:
    """Lead the drives out of operation where they are, then to NMT pre-operational.

    The exchange goes on until each has left operation, or says nothing any more.
    """
    links, carriers = list(links), list(carriers)
    for link in links:
        link.order(PowerOrder.SWITCH_OFF)
        link.disarm()
    silent: set[str] = set()
    for _ in range(POWER_DOWN_CYCLES_MAX):
        start_ns = scheduler.now_ns
        for link in links:
            link.begin_cycle()
        for carrier in carriers:
            carrier.begin_cycle()
        scheduler.run_until(start_ns + offset_ns)
        for link in links:
            try:
                link.take()
            except Alarm:
                silent.add(link.name)
            link.send(link.set_mm)
        scheduler.run_until(start_ns + period_ns)
        if all(link.state in _OFF or link.name in silent for link in links):
            break
    for link in links:
        link.network.send_message(NMT_ID, bytes([NMT_PRE_OPERATIONAL, link.node_id]))
    scheduler.run_until(scheduler.now_ns + period_ns)
