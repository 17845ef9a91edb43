"""Both ends of a drive of CiA 402 on an EtherCAT line."""

from functools import partial

from axisrig.bench.machine.ethercat.ends import Connected, Plugged, SlaveEnds
from axisrig.bench.machine.ethercat.slaves import drive_slave
from axisrig.bench.rig.canopen.loop import loop_settings
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.canopen.startup import start_up_settings
from axisrig.bench.rig.ethercat.members import position_of, segment_of
from axisrig.bench.rig.ethercat.on_line import axis_pdos
from axisrig.bench.rig.ethercat.startup import axis_steps
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, drive_input, jump_mm
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.ethercat.coe_start import CoeSteps
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.link import EthercatLink, make_data
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.settings import SlaveSettings, station_of
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.drives.ethercat.watch import EthercatWatch
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import Clock, S


class Cia402Ends(SlaveEnds):
    """Both ends of one drive."""

    data: ImageData

    def __init__(self, plugged: Plugged) -> None:
        settings, axis, scheduler, beside, seed, entered = plugged
        self._settings = settings
        serial = position_of(settings, axis)
        self.node = drive_slave(settings, axis, scheduler, beside, serial, seed, entered)
        self.settings = slave_settings(settings, axis)
        self.data = make_data(self.settings)

    def connect(self, transactions: Transactions, clock: Clock) -> Connected:
        """Make the control's end."""
        settings, axis = self._settings, self.settings.axis
        declared = start_up_settings(drive_of(settings, axis))
        mailbox = Mailbox(
            transactions,
            clock,
            station_of(self.settings),
            declared.sdo_timeout_ns,
            declared.sdo_attempts,
        )
        drive = drive_of(settings, axis)
        link = EthercatLink(
            self.settings,
            self.data,
            mailbox,
            proves_latches=drive.latch_check,
            proves_places=drive.position_check,
        )
        objects = _objects(settings, axis, link, clock)
        steps = CoeSteps(self.settings, mailbox, objects)
        return Connected(mailbox.port, link, steps, partial(EthercatWatch, link))


def _objects(settings: Settings, axis: str, link: EthercatLink, clock: Clock) -> StartUp:
    """Make the part of the start-up that is about objects."""
    declared = start_up_settings(drive_of(settings, axis))
    address = DriveAddress(axis, link.node_id)
    steps = axis_steps(settings, axis)
    return StartUp(address, None, clock, link.mailbox, steps, declared, keep=link.set_object)


@once
def slave_settings(settings: Settings, name: str) -> SlaveSettings:
    """Return what the control knows of the drive of an axis."""
    axis, parameters = settings.rig.axis[name], settings.axis[name]
    drive = drive_of(settings, name)
    made, declared = drive.make(), start_up_settings(drive)
    outputs, inputs = axis_pdos(settings, name)
    return SlaveSettings(
        axis=name,
        node_id=position_of(settings, name),
        increments_per_mm=float(made.units_per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        missing_cycles=drive.missing_cycles,
        homing_limit_ns=round(drive.homing_limit_s * S),
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        jump_mm=jump_mm(parameters, drive.jump_factor, settings.rig.cycle.period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
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
