"""Both ends of a SERCOS drive on an EtherCAT line."""

from functools import partial

from axisrig.bench.machine.ethercat.ends import Connected, Plugged, SlaveEnds
from axisrig.bench.machine.ethercat.slaves import drive_slave
from axisrig.bench.rig.ethercat.members import position_of
from axisrig.bench.rig.ethercat.on_line import axis_pdos
from axisrig.bench.rig.ethercat.timing import phases_of
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, jump_mm
from axisrig.bench.rig.sercos.checks import latch_of, measures
from axisrig.bench.rig.sercos.members import drive_of
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.ethercat.settings import station_of
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.drives.sercos.data import TelegramData
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.drives.sercos.mailbox import ServiceMailbox
from axisrig.kernel.drives.sercos.settings import RealTimeBits, SercosSettings, real_time_bits
from axisrig.kernel.drives.sercos.startup import SercosSteps
from axisrig.kernel.drives.sercos.watch import SercosWatch
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.profiles.sercos.words import PROBES
from axisrig.kernel.time.clock import MS, Clock

OF_PROBE = "antr.sercos.probe_{}_realtime_bits"
OF_COMMAND = "antr.sercos.probing_command_start"


class SercosEnds(SlaveEnds):
    """Both ends of one drive."""

    data: TelegramData
    settings: SercosSettings

    def __init__(self, plugged: Plugged) -> None:
        settings, axis, scheduler, beside, seed, entered = plugged
        self._table = drive_of(settings, axis)
        serial = position_of(settings, axis)
        self.node = drive_slave(settings, axis, scheduler, beside, serial, seed, entered)
        self.settings = sercos_settings(settings, axis)
        probe = PROBES[self.settings.probe_input, self.settings.edge]
        self.data = TelegramData(self.settings, probe.value)

    def connect(self, transactions: Transactions, clock: Clock) -> Connected:
        """Make the control's end."""
        timeout_ns = self._table.soe_timeout_ms * MS
        mailbox = ServiceMailbox(transactions, clock, station_of(self.settings), timeout_ns)
        link = SercosDrive(self.settings, self.data, mailbox.channel)
        steps = SercosSteps(self.settings, link)
        return Connected(mailbox.port, link, steps, partial(SercosWatch, link))


@once
def sercos_settings(settings: Settings, name: str) -> SercosSettings:
    """Return what the control knows of the drive of an axis."""
    axis, parameters, drive = settings.rig.axis[name], settings.axis[name], drive_of(settings, name)
    period_us = settings.rig.cycle.period_us
    outputs, inputs = axis_pdos(settings, name)
    probe_input, edge = latch_of(settings, name)
    return SercosSettings(
        axis=name,
        node_id=position_of(settings, name),
        increments_per_mm=float(drive.facts().units_per_mm),
        probe_input=probe_input,
        edge=edge,
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        missing_cycles=drive.missing_cycles,
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        jump_mm=jump_mm(parameters, drive.jump_factor, period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
        sensor_age_limit_ms=axis.sensor_age_limit_ms,
        outputs=(outputs,),
        inputs=(inputs,),
        lead_mm=drive.lead_mm,
        period_us=period_us,
        writes=drive.start_list,
        bits=_bits(parameters, probe_input),
        measures=measures(settings, name),
        starts_probing=drive.probing == "start",
        needs_following=parameters.flag("antr.sercos.evaluate_drive_follows_cmd"),
        proves_latches=drive.latch_check,
        proves_places=drive.position_check,
        echo_cycles=phases_of(settings, name).way,
    )


def _bits(parameters: ParameterSet, probe: int) -> RealTimeBits:
    """Return the real-time bits: P-AXIS-00675 to 00682 where they are set, else P-AXIS-00060."""
    usual = real_time_bits(
        parameters.integer("kenngr.echtzeit_bit_nr"), parameters.integer("lr_hw[0].mask_mess_1")
    )

    def mask(path: str, default: int) -> int:
        bit = parameters.integer(f"{path}.bit_nr")
        return default if bit < 0 else 1 << bit

    one, this = OF_PROBE.format(1), OF_PROBE.format(probe)
    return RealTimeBits(
        mask(f"{this}.start_probing", usual.enable),
        mask(f"{one}.value_latched", usual.latched),
        mask(f"{one}.probe_actuated", usual.actuated),
        mask(OF_COMMAND, 0),
    )
