"""Which axes and segments of a rig are EtherCAT's, with their tables and telegrams."""

from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.canopen.schedule import (
    has_inputs,
    has_second,
    has_touch_probe,
    knows_counter,
    latch_object_of,
)
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.canopen.startup_steps import CSV

TERMINAL = "terminal"
"""Name of the terminal of the PLC in tables by axis, where it is on a line."""
TERMINAL_BYTES = 34
"""Of its registers in the process image: 09AE to 09CF."""


def ec_segments(settings: Settings) -> list[str]:
    """Return the segments that are EtherCAT lines, in the order of the rig."""
    return [name for name, table in settings.segment.items() if isinstance(table, SegmentTable)]


def segment_of(settings: Settings, name: str) -> SegmentTable:
    """Return `[segment.S]` of an EtherCAT line."""
    table = settings.segment[name]
    assert isinstance(table, SegmentTable), name
    return table


def axes_on(settings: Settings, segment: str) -> list[str]:
    """Return the axes of a line, in the order of their slaves."""
    return [name for name, axis in settings.rig.axis.items() if axis.segment == segment]


def ec_axes(settings: Settings) -> list[str]:
    """Return the axes on EtherCAT lines, in the order of the rig."""
    lines = ec_segments(settings)
    return [name for name, axis in settings.rig.axis.items() if axis.segment in lines]


def position_of(settings: Settings, name: str) -> int:
    """Return the position of the slave of an axis on its line, from 1 on."""
    return axes_on(settings, settings.rig.axis[name].segment).index(name) + 1


def terminal_on(settings: Settings, segment: str) -> TerminalTable | None:
    """Return the table of the terminal of the PLC where it is the last slave of a line."""
    task = settings.rig.plc_task
    table = None if task is None else task.terminal
    return table if table is not None and table.line == segment else None


def watches_clocks(settings: Settings) -> bool:
    """Whether the clocks of lines are watched: where time stamps may be compared with theirs."""
    task = settings.rig.plc_task
    return task is not None and task.terminal is not None and task.terminal.node is None


def terminal_position(settings: Settings, segment: str) -> int:
    """Return the position of the terminal on its line, behind all drives."""
    return len(axes_on(settings, segment)) + 1


def slaves_on(settings: Settings, segment: str) -> list[str]:
    """Return the names of the slaves of a line in their order: axes, then the terminal."""
    has_terminal = terminal_on(settings, segment) is not None
    return [*axes_on(settings, segment), *([TERMINAL] if has_terminal else [])]


@once
def axis_telegrams(settings: Settings, name: str) -> dict[str, Telegram]:
    """Return what is mapped, as the mapping table of CANopen has it."""
    return telegrams(
        latch_object_of(settings, name),
        drive_of(settings, name).pdo_map,
        counter=knows_counter(settings, name),
        inputs=has_inputs(settings, name),
        second=has_second(settings, name),
        speed=drive_of(settings, name).mode == CSV,
        probe=has_touch_probe(settings, name),
    )
