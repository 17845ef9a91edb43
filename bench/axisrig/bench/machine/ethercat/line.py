"""One EtherCAT line of a machine: its slaves, and the control as its master."""

from collections.abc import Callable, Mapping

from axisrig.bench.bus.ethercat.segment import EthercatSegment, Link
from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.machine.ethercat.line_faults import LineFaults
from axisrig.bench.machine.ethercat.line_terminal import LineTerminal, register_inputs
from axisrig.bench.machine.ethercat.slaves import Entered, drive_slave, terminal_slave
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.canopen.loop import loop_settings
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.canopen.startup import start_up_settings
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.ethercat.members import (
    TERMINAL,
    axes_on,
    axis_pdos,
    position_of,
    segment_of,
    terminal_on,
    terminal_position,
    watches_clocks,
)
from axisrig.bench.rig.ethercat.startup import axis_steps
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.line_start import LineStart, Starting
from axisrig.kernel.drives.ethercat.link import EthercatLink, make_data
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import LineSettings, SlaveSettings, station_of
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import US, Clock, TimeNs, ns_to_seconds
from axisrig.kernel.time.scheduler import Scheduler

DRIVE_SEED_STRIDE = 1_000_003


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
        self.nodes = {
            axis: drive_slave(
                settings,
                axis,
                scheduler,
                beside,
                position_of(settings, axis),
                seed + DRIVE_SEED_STRIDE * first.index(axis),
                entered,
            )
            for axis in self.axes
        }
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
        known = [slave_settings(settings, axis) for axis in self.axes]
        data = [make_data(each) for each in known]
        line = line_settings(settings, name)
        self.master = Master(self.segment, scheduler, line, known, data, others)
        if self.terminal is not None:
            self.master.others_taken.append(self.terminal.taken)
        self.segment.receivers.append(self.master.received)
        self.faults = LineFaults(self.segment, self.nodes)
        self.links: dict[str, EthercatLink] = {}
        starting = []
        for axis, slave, values in zip(self.axes, known, data, strict=True):
            link = _link_of(settings, axis, slave, values, self.master, scheduler)
            self.links[axis] = link
            objects = _objects(settings, axis, link, scheduler)
            starting.append(Starting(slave, link.mailbox, objects))
        starting += [Starting(other, None, None) for other in others]
        self.start = LineStart(self.master, scheduler, starting)
        self.carrier = EthercatCarrier(self.master, list(self.links.values()))


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


def _link_of(
    settings: Settings,
    axis: str,
    slave: SlaveSettings,
    values: ImageData,
    master: Master,
    clock: Clock,
) -> EthercatLink:
    """Make the control's end of a drive, with a mailbox that the master serves."""
    drive = drive_of(settings, axis)
    declared = start_up_settings(drive)
    mailbox = Mailbox(
        master.transactions,
        clock,
        station_of(slave),
        declared.sdo_timeout_ns,
        declared.sdo_attempts,
    )
    master.mailboxes.append(mailbox)
    return EthercatLink(
        slave,
        values,
        mailbox,
        proves_latches=drive.latch_check,
        proves_places=drive.position_check,
    )


def _objects(settings: Settings, axis: str, link: EthercatLink, clock: Clock) -> StartUp:
    """Make the part of the start-up that is about objects."""
    declared = start_up_settings(drive_of(settings, axis))
    address = DriveAddress(axis, link.node_id)
    steps = axis_steps(settings, axis)
    return StartUp(address, None, clock, link.mailbox, steps, declared, keep=link.set_object)


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


@once
def slave_settings(settings: Settings, name: str) -> SlaveSettings:
    """Return what the control knows of the drive of an axis."""
    axis, parameters = settings.rig.axis[name], settings.axis[name]
    drive = drive_of(settings, name)
    made, declared = drive.make(), start_up_settings(drive)
    speed_max_mm_s = parameters.mm_s("getriebe[0].dynamik.vb_max")
    period_s = ns_to_seconds(settings.rig.cycle.period_us * US)
    jump_mm = drive.jump_factor * speed_max_mm_s * period_s
    outputs, inputs = axis_pdos(settings, name)
    return SlaveSettings(
        axis=name,
        node_id=position_of(settings, name),
        increments_per_mm=float(made.units_per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        missing_cycles=drive.missing_cycles,
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        jump_mm=jump_mm or float("inf"),
        status_delay_cycles=made.status_delay_cycles,
        stamps=_stamps(settings, name),
        trigger_source=parameters.word("antr.canopen.probing_trigger_source"),
        sensor_age_limit_ms=axis.sensor_age_limit_ms,
        loop=loop_settings(settings, name),
        outputs=(outputs,),
        inputs=(inputs,),
        identity=declared.identity,
    )


def _stamps(settings: Settings, name: str) -> StampClock | None:
    """Return the clock of the stamps: system time, which the master hands out; none without it."""
    table = segment_of(settings, settings.rig.axis[name].segment)
    return StampClock(1, 0, table.shift_ns) if table.dc else None


def driven(lines: Mapping[str, Line]) -> dict[str, EthercatLink]:
    """Return the control's ends of all lines by axis."""
    return {axis: link for line in lines.values() for axis, link in line.links.items()}
