"""The node with digital inputs that is the terminal of a PLC: where it is, what it sends."""

from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.bench.bus.can.arithmetic import PlannedFrame
from axisrig.bench.rig.canopen.answers import first_answer_ns
from axisrig.bench.rig.canopen.members import can_axes, can_segments
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.real_axes import is_real
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE, PDO_BASE
from axisrig.kernel.time.clock import US, TimeNs


@dataclass(frozen=True)
class NodeTelegrams:
    """The telegrams of the node with its inputs.

    first_ns, last_ns: how long after the request of a SYNC an answer to it may end; SYNCs are
    requested every period_ns.
    """

    segment: str
    cob_id: int
    period_ns: TimeNs
    first_ns: TimeNs
    last_ns: TimeNs


def node_table(settings: Settings) -> TerminalTable | None:
    """Return the table of the terminal where it is a node on a CAN bus."""
    task = settings.rig.plc_task
    table = None if task is None else task.terminal
    return table if table is not None and table.is_on_can else None


def terminal_telegrams(settings: Settings) -> NodeTelegrams | None:
    """Return the telegrams with its inputs, None where it is no node.

    An answer ends before the NC cycle of its SYNC (`axisrig check` reckons it to be in by then).
    """
    table = node_table(settings)
    if table is None or table.segment is None or table.node is None:
        return None
    cycle = settings.rig.cycle
    return NodeTelegrams(
        table.segment,
        PDO_BASE["TPDO1"] + table.node,
        cycle.period_us * US,
        first_answer_ns(settings, table.segment, 1),
        cycle.cycle_offset_us * US,
    )


def synced_segments(settings: Settings) -> set[str]:
    """Return the segments that carry the SYNC: those of axes, and that of the node."""
    used, table = (
        {settings.rig.axis[name].segment for name in can_axes(settings)},
        node_table(settings),
    )
    return used if table is None or table.segment is None else used | {table.segment}


def terminal_frames(
    settings: Settings, segment: str, rare: Sequence[tuple[str, int]]
) -> list[tuple[str, PlannedFrame]]:
    """Return the frames of the node, if it is on this segment: "TPDO" or "event", and the frame.

    rare: name and base identifier of what it may send, or be sent, besides.
    """
    table = node_table(settings)
    if table is None or table.node is None or table.segment != segment:
        return []
    node = table.node
    frames = [("TPDO", PlannedFrame("terminal.TPDO1", PDO_BASE["TPDO1"] + node, 1))]
    if table.heartbeat_ms:
        frames.append(("event", PlannedFrame("terminal.heartbeat", ERROR_CONTROL_BASE + node, 1)))
    events = [PlannedFrame(f"terminal.{what}", base + node, 8) for what, base in rare]
    return frames + [("event", frame) for frame in events]


def check_terminal(settings: Settings) -> None:
    """Check that the node is on a simulated segment, with a number of its own.

    Raises UserError with the key of the rig.
    """
    rig, files, table = settings.rig, settings.files, node_table(settings)
    if table is None:
        _check_line(settings)
        return
    simulated = [name for name in can_segments(settings) if not is_real(settings, name)]
    if table.segment not in simulated:
        raise rig_error(
            files,
            ("plc", "terminal", "segment"),
            "the node of the terminal needs a simulated segment of this rig",
            value=table.segment,
            allowed=simulated or "none in this rig",
        )
    taken = {
        axis.node: f"axis {n}" for n, axis in rig.axis.items() if axis.segment == table.segment
    }
    taken |= {rig.cycle.master_node: "the kernel"} if rig.cycle.heartbeat_ms else {}
    if table.node in taken:
        raise rig_error(
            files,
            ("plc", "terminal", "node"),
            f"the terminal has the node id of {taken[table.node]} on segment {table.segment}",
            value=table.node,
        )


def _check_line(settings: Settings) -> None:
    """Refuse a terminal without a node whose segment is no EtherCAT line."""
    task = settings.rig.plc_task
    line = "" if task is None or task.terminal is None else task.terminal.line
    lines = [name for name, table in settings.segment.items() if table.is_line]
    if line and line not in lines:
        raise rig_error(
            settings.files,
            ("plc", "terminal", "segment"),
            "a terminal on a CAN bus needs a node number; without one it is on an EtherCAT line",
            value=line,
            allowed=lines or "no line in this rig: give it a node",
        )
