"""How late the status of a latch may arrive, and whether a time stamp gives its instant."""

from axisrig.bench.bus.can.arithmetic import SYNC
from axisrig.bench.bus.can.frame import IFS_BITS, data_frame, frame_bits
from axisrig.bench.drive.cia402.dictionary.profile import CLOCK_NS
from axisrig.bench.rig.canopen.io_node import node_table
from axisrig.bench.rig.canopen.members import can_axes, drive_of, segment_of
from axisrig.bench.rig.canopen.schedule import axis_telegrams, latch_object_of, segment_schedules
from axisrig.bench.rig.families import TerminalGrid
from axisrig.bench.rig.real_axes import is_real
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.mapping import FROM_LATCH_TO_STAMP
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import MS, US, S, TimeNs


def stamp_clock(settings: Settings, name: str) -> StampClock | None:
    """Return the clock of the drive of an axis; None on a real bus, where it is not known."""
    axis = settings.rig.axis[name]
    if is_real(settings, axis.segment):
        return None
    profile = drive_of(settings, name).make()
    return StampClock(
        CLOCK_NS[profile.timestamp_unit],
        profile.timestamp_start,
        _sync_end_ns(settings, axis.segment),
    )


def terminal_grid(settings: Settings) -> TerminalGrid | None:
    """Return the instants of the node that is the terminal of the PLC; None where it is none."""
    table = node_table(settings)
    if table is None or table.segment is None:
        return None
    offset_ns = _sync_end_ns(settings, table.segment)
    worst_ns = segment_schedules(settings)[table.segment].last_tpdo_ns
    return TerminalGrid(settings.rig.cycle.period_us * US, offset_ns, worst_ns - offset_ns)


def _sync_end_ns(settings: Settings, segment: str) -> TimeNs:
    """Return the end of a SYNC frame after its request."""
    data = b"\0" if settings.rig.cycle.sync_counter else b""
    bits = frame_bits(data_frame(SYNC.can_id, data))
    return (bits - IFS_BITS) * S // segment_of(settings, segment).bitrate


def describe_arrival(settings: Settings) -> list[str]:
    """Say for each axis that may measure how late the status of an edge at standstill may be.

    And when the levels of a node that is the terminal of the PLC are there.
    """
    cycle = settings.rig.cycle
    lines = []
    for name in can_axes(settings):
        if not settings.axis[name].flag("kenngr.messachse"):
            continue
        drive = drive_of(settings, name)
        delay, missing = drive.make().status_delay_cycles, drive.missing_cycles
        late_ns = (delay + missing) * cycle.period_us * US + cycle.cycle_offset_us * US
        lines += [
            f"axis {name}, edge at standstill: believed up to {late_ns / MS:g} ms after that SYNC",
            f"  update delay {delay} SYNCs, PDO {cycle.cycle_offset_us} us,"
            f" missing_cycles {missing}; {_stamp(settings, name)}",
        ]
    grid = terminal_grid(settings)
    if grid is not None:
        there_us = (grid.offset_ns + grid.late_ns) / US
        lines.append(
            f"terminal of the PLC: sampled {grid.offset_ns / US:g} us after the SYNC is requested,"
            f" its telegram is there after {there_us:g} us at most"
        )
    return lines


def _stamp(settings: Settings, name: str) -> str:
    wanted = latch_object_of(settings, name) + FROM_LATCH_TO_STAMP
    is_mapped = any(
        mapped.index == wanted
        for telegram in axis_telegrams(settings, name).values()
        if telegram.transmission == 1 and not telegram.is_received
        for mapped in telegram.objects
    )
    if not is_mapped:
        return "no time stamp mapped"
    if stamp_clock(settings, name) is None:
        return f"{wanted:X} not used: unknown clock"
    return f"time stamp {wanted:X} decides"
