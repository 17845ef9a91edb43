"""One EtherCAT line of a machine: its slaves, and the control as its master."""

from collections.abc import Callable, Mapping

from axisrig.bench.bus.ethercat.segment import EthercatSegment, Link
from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.machine.ethercat.cia402_slave import Cia402Ends
from axisrig.bench.machine.ethercat.ends import Plugged, SlaveEnds
from axisrig.bench.machine.ethercat.line_faults import LineFaults
from axisrig.bench.machine.ethercat.line_terminal import LineTerminal, register_inputs
from axisrig.bench.machine.ethercat.sercos_slave import SercosEnds
from axisrig.bench.machine.ethercat.slaves import Entered, terminal_slave
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.ethercat.members import (
    TERMINAL,
    axes_on,
    segment_of,
    terminal_on,
    terminal_position,
    watches_clocks,
)
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.line_start import LineStart, Starting
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import LineSettings
from axisrig.kernel.drives.interface import Drive, DriveWatch
from axisrig.kernel.time.clock import US, TimeNs
from axisrig.kernel.time.scheduler import Scheduler

DRIVE_SEED_STRIDE = 1_000_003
ENDS: dict[str, Callable[[Plugged], SlaveEnds]] = {"canopen": Cia402Ends, "sercos": SercosEnds}
"""By the name of the family."""


class Line:
    """A line: segment, virtual drives and the control's ends by axis, carrier and start-up."""

    def __init__(
        self,
        settings: Settings,
        name: str,
        scheduler: Scheduler,
        journal: Journal,
        beside: Beside,
        advance: Callable[[TimeNs], None],
        seed: int,
        entered: Entered,
    ) -> None:
        table, self.axes = segment_of(settings, name), axes_on(settings, name)
        first = list(settings.rig.axis)
        ends = {
            axis: _ends(
                Plugged(
                    settings,
                    axis,
                    scheduler,
                    beside,
                    seed + DRIVE_SEED_STRIDE * first.index(axis),
                    entered,
                )
            )
            for axis in self.axes
        }
        self.nodes = {axis: each.node for axis, each in ends.items()}
        self.terminal = _terminal(settings, name, scheduler, beside, advance)
        self.slaves: dict[str, EthercatDrive | StampingTerminal] = {**self.nodes}
        others = []
        if self.terminal is not None:
            self.slaves[TERMINAL] = self.terminal.slave
            wanted = terminal_on(settings, name)
            assert wanted is not None
            others.append(register_inputs(settings, name, wanted))
        self.segment = EthercatSegment(
            scheduler,
            list(self.slaves.values()),
            [_link(table, slave) for slave in self.slaves],
            name=name,
            journal=journal,
        )
        known = [each.settings for each in ends.values()]
        data = [each.data for each in ends.values()]
        line = line_settings(settings, name)
        self.master = Master(self.segment, scheduler, line, known, data, others)
        if self.terminal is not None:
            self.master.others_taken.append(self.terminal.taken)
        self.segment.receivers.append(self.master.received)
        self.faults = LineFaults(self.segment, self.nodes)
        self.links: dict[str, Drive] = {}
        self.watches: dict[str, Callable[[EthercatCarrier], DriveWatch]] = {}
        starting = []
        for axis, each in ends.items():
            end = each.connect(self.master.transactions, scheduler)
            self.links[axis], self.watches[axis] = end.link, end.watch
            self.master.mailboxes.append(end.port)
            starting.append(Starting(each.settings, end.port, end.steps))
        starting += [Starting(other, None, None) for other in others]
        self.start = LineStart(self.master, scheduler, starting)
        self.carrier = EthercatCarrier(self.master)


def _ends(plugged: Plugged) -> SlaveEnds:
    """Make both ends of a drive, as its family has them."""
    rig = plugged.settings.rig
    return ENDS[rig.drive[rig.axis[plugged.axis].drive].family_name](plugged)


def _terminal(
    settings: Settings,
    name: str,
    scheduler: Scheduler,
    beside: Beside,
    advance: Callable[[TimeNs], None],
) -> LineTerminal | None:
    """Make the terminal of the PLC and its end of it, where the rig has it on the line."""
    serial, table = terminal_position(settings, name), terminal_on(settings, name)
    slave = terminal_slave(settings, name, scheduler, beside, advance, serial)
    if slave is None or table is None:
        return None
    return LineTerminal(slave, table, scheduler, settings.rig.cycle.period_us * US)


def _link(table: SegmentTable, axis: str) -> Link:
    slave_ns = round(table.of("slave_ns", axis))
    return Link(round(table.of("wire_ns", axis)), slave_ns, slave_ns)


@once
def line_settings(settings: Settings, name: str) -> LineSettings:
    """Return what the master knows of a line."""
    table = segment_of(settings, name)
    assumed = {
        axis: round(table.of("assumed_sample_us", axis) * US) for axis in axes_on(settings, name)
    }
    return LineSettings(
        name=name,
        period_ns=settings.rig.cycle.period_us * US,
        frame_ns=table.frame_ns,
        shift_ns=table.shift_ns,
        has_clocks=table.dc,
        compensates_drift=table.drift_compensation,
        compensates_delay=table.delay_compensation,
        sample_ns=assumed,
        clock_limit_ns=round(table.clock_limit_us * US),
        watches_clocks=watches_clocks(settings),
    )


def driven(lines: Mapping[str, Line]) -> dict[str, Drive]:
    """Return the control's ends of all lines by axis."""
    return {axis: link for line in lines.values() for axis, link in line.links.items()}
