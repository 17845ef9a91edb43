"""The phases of the axes on EtherCAT lines, as the rig has them."""

from axisrig.bench.oracles.phases import Phases
from axisrig.bench.rig.ethercat.members import segment_of
from axisrig.bench.rig.ethercat.schedule import schedule_of
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.time.clock import US


@once
def phases_of(settings: Settings, name: str) -> Phases:
    """Return the phases of an axis. Without clocks the outputs are SYNC0."""
    segment = settings.rig.axis[name].segment
    table, schedule = segment_of(settings, segment), schedule_of(settings, segment)
    period_ns = schedule.period_ns
    if not table.dc:
        sync_ns = (table.frame_ns + schedule.there_ns) % period_ns
        sample_ns = sync_ns
    else:
        sync_ns = table.shift_ns
        sample_ns = (sync_ns + round(table.of("sample_us", name) * US)) % period_ns
    return Phases(
        period_ns,
        schedule.offset_ns,
        table.frame_ns,
        sync_ns,
        sample_ns,
        schedule.there_ns,
        schedule.back_ns,
    )
