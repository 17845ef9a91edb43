"""How real drives are left: out of operation, whatever has happened before."""

from collections.abc import Iterable, Mapping, Sequence

from axisrig.bench.machine.families import Installed
from axisrig.kernel.channel import CycleTiming
from axisrig.kernel.drives.carrier import Carrier
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.scheduler import Scheduler

POWER_DOWN_CYCLES_MAX = 500


def power_down(
    scheduler: Scheduler,
    part_of: Mapping[str, Installed],
    carriers: Iterable[Carrier],
    timing: CycleTiming,
) -> None:
    """Lead drives out of operation where they are, all in the same cycles, and let them go.

    part_of: what each belongs to, by axis. carriers: of their segments. The exchange goes on until
    each has left operation, or says nothing any more.
    """
    links, carriers = [part.links[axis] for axis, part in part_of.items()], list(carriers)
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
        scheduler.run_until(start_ns + timing.offset_ns)
        for link in links:
            try:
                link.take()
            except Alarm:
                silent.add(link.name)
            link.send(link.set_mm)
        scheduler.run_until(start_ns + timing.period_ns)
        if all(part.is_off(axis) or axis in silent for axis, part in part_of.items()):
            break
    for part in dict.fromkeys(part_of.values()):
        part.let_go(_axes_of(part, part_of))
    scheduler.run_until(scheduler.now_ns + timing.period_ns)


def _axes_of(part: Installed, part_of: Mapping[str, Installed]) -> Sequence[str]:
    return [axis for axis, owner in part_of.items() if owner is part]
