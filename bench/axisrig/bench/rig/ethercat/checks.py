"""Checks of EtherCAT lines: keys, what drives have, whether the cycle fits."""

from collections.abc import Mapping

from axisrig.bench.rig.ethercat.keys import EACH
from axisrig.bench.rig.ethercat.members import (
    axes_on,
    ec_axes,
    ec_segments,
    segment_of,
    slaves_on,
    terminal_on,
)
from axisrig.bench.rig.ethercat.on_line import on_line
from axisrig.bench.rig.ethercat.schedule import schedule_of
from axisrig.bench.rig.ethercat.timing import phases_of
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import US


def check_lines(settings: Settings) -> None:
    """Check all lines. Raises UserError with file, line and key of the rig."""
    for name in ec_segments(settings):
        _check_keys(settings, name)
        _check_terminal(settings, name)
    for name in ec_axes(settings):
        on_line(settings, name).check(settings, name, phases_of(settings, name).late_cycles)
    for name in ec_segments(settings):
        _check_cycle(settings, name)


def _check_keys(settings: Settings, segment: str) -> None:
    """Refuse axes that a key names and the line has not, and instants outside of the cycle."""
    table, axes = segment_of(settings, segment), axes_on(settings, segment)
    if not axes:
        raise rig_error(
            settings.files,
            ("segment", segment),
            f"no axis is on segment {segment}: a line needs one",
        )
    for key in EACH:
        value = getattr(table, key)
        names = slaves_on(settings, segment)
        unknown = (
            [name for name in value if name not in names] if isinstance(value, Mapping) else []
        )
        if unknown:
            raise rig_error(
                settings.files,
                ("segment", segment, key),
                f"segment {segment}: {key} names no axis of it",
                value=unknown[0],
                allowed=names,
            )
    cycle = settings.rig.cycle
    for key, at_us in (("frame_us", table.frame_us), ("shift_us", table.shift_us)):
        if at_us >= cycle.period_us:
            raise rig_error(
                settings.files,
                ("segment", segment, key),
                f"segment {segment}: {key} is after the end of the cycle",
                value=at_us,
                allowed=f"0 .. {cycle.period_us - 1} us",
            )
    if cycle.sync_counter or cycle.heartbeat_ms:
        key = "sync_counter" if cycle.sync_counter else "heartbeat_ms"
        if len(ec_segments(settings)) == len(settings.segment):
            raise rig_error(
                settings.files,
                ("cycle", key),
                f"{key} is about CAN and no segment of this rig is a CAN bus",
                value=getattr(cycle, key),
            )


def _check_terminal(settings: Settings, segment: str) -> None:
    """Refuse another clock than that of the line for a terminal on it."""
    task = settings.rig.plc_task
    if task is None or terminal_on(settings, segment) is None:
        return
    for key, own in (("clock_offset_ns", "clock_start_us"), ("clock_drift_ppm", "drift_ppm")):
        if getattr(task, key):
            raise rig_error(
                settings.files,
                ("plc", key),
                f"the terminal is on segment {segment}: its clock is that of its slave controller",
                value=getattr(task, key),
                hint=f"[segment.{segment}] {own} = {{ terminal = ... }}",
            )
    if not segment_of(settings, segment).dc:
        raise rig_error(
            settings.files,
            ("segment", segment, "dc"),
            "the terminal stamps in the distributed clock, and the line has none",
            value=False,
        )


def _check_cycle(settings: Settings, segment: str) -> None:
    """Refuse a cycle that does not fit, with the arithmetic."""
    schedule, table = schedule_of(settings, segment), segment_of(settings, segment)
    if not schedule.fits_frame:
        raise rig_error(
            settings.files,
            ("segment", segment),
            f"the process image does not fit into one frame on segment {segment}:\n"
            f"{schedule.table()}\n",
            hint="use another segment for some of its axes",
        )
    if not schedule.fits and table.overload == "refuse":
        raise rig_error(
            settings.files,
            ("segment", segment),
            f"the cycle does not fit on segment {segment}:\n{schedule.table()}\n",
            hint="use a longer period_us, another cycle_offset_us or frame_us;"
            " --force runs it all the same and reports the overload",
        )
    if schedule.frame_ns == schedule.offset_ns:
        raise rig_error(
            settings.files,
            ("segment", segment, "frame_us"),
            f"segment {segment}: the frame leaves at the instant of the NC cycle",
            value=schedule.frame_ns / US,
            allowed="an instant before or after cycle_offset_us",
        )
