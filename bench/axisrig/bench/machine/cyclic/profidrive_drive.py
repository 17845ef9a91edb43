"""Both ends of a PROFIdrive drive on a cyclic segment."""

from functools import partial

from axisrig.bench.drive.profidrive.node import ProfidriveDrive as VirtualProfidrive
from axisrig.bench.machine.cyclic.ends import Ask, ImageEnds, Plugged
from axisrig.bench.record.axes import Telegram
from axisrig.bench.rig.cyclic.members import phases_of
from axisrig.bench.rig.loop import feed_forward
from axisrig.bench.rig.profidrive.expected import expected_parameters
from axisrig.bench.rig.profidrive.loop import gain_of, loop_settings, wrong_mode
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, drive_input, jump_mm
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.functions import read_functions
from axisrig.kernel.drives.interface import DriveAccesses, DriveStart, DriveWatch
from axisrig.kernel.drives.profidrive.link import ProfidriveDrive
from axisrig.kernel.drives.profidrive.parameter_channel import (
    NUMBERS,
    ParameterChannel,
    ParameterWay,
    ProfidriveAccesses,
)
from axisrig.kernel.drives.profidrive.settings import ProfidriveSettings
from axisrig.kernel.drives.profidrive.startup import ProfidriveStart
from axisrig.kernel.drives.profidrive.watch import ProfidriveWatch
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.profiles.profidrive.words import SPEED_BASE
from axisrig.kernel.time.clock import US, S

BASE = "antr.profibus.drive_velocity_base_value"


class ProfidriveEnds(ImageEnds):
    """Both ends of one drive. Raises UserError for a plant that takes no speed."""

    link: ProfidriveDrive
    node: VirtualProfidrive

    def __init__(self, plugged: Plugged) -> None:
        bench, axis, seed, entered = plugged
        settings = self._settings = bench.settings
        beside, seen = bench.beside, bench.beside.axis(axis)
        if ControlKind.VELOCITY not in seen.kinds:
            raise rig_error(
                settings.files,
                ("axis", axis, "plant"),
                f"axis {axis}: its drive gives speeds, and its plant takes none",
                value=settings.rig.axis[axis].plant,
                hint="a plant whose FMU takes a speed, such as AxisRig.Drives.ServoAxis",
            )
        made = drive_of(settings, axis).make()
        self.node = VirtualProfidrive(
            axis,
            bench.scheduler,
            seen,
            beside.probes(axis),
            made,
            seed,
            switches=beside.switches(axis),
            entered=entered,
        )
        self.drive = self.node.servo
        self.port = ImagePort()
        self.link = ProfidriveDrive(profidrive_settings(settings, axis), self.port)
        self.telegrams = [
            Telegram("outputs", 1, made.telegram.to_drive),
            Telegram("inputs", 1, made.telegram.from_drive),
        ]

        self._functions, self.warnings = read_functions(axis, settings.axis[axis], NUMBERS)

    def accesses(self, ask: Ask) -> DriveAccesses:
        """Return what #DRIVE acts on: parameters."""
        channel = ParameterChannel(partial(ask, self.node.answer))
        return ProfidriveAccesses({self.link.name: ParameterWay(channel, self._functions)})

    def watch(self) -> DriveWatch:
        """Make the watch over the drive."""
        return ProfidriveWatch(self.link)

    def start_up(self, ask: Ask) -> DriveStart:
        """Make the start-up of the drive: its telegram has to serve its mode."""
        settings, name = self._settings, self.link.name
        channel = ParameterChannel(partial(ask, self.node.answer))
        expected = expected_parameters(settings, name)
        return ProfidriveStart(name, channel, expected, wrong_mode(settings, name))


@once
def profidrive_settings(settings: Settings, name: str) -> ProfidriveSettings:
    """Return what the control knows of the drive of an axis."""
    axis, parameters, drive = settings.rig.axis[name], settings.axis[name], drive_of(settings, name)
    period_us = settings.rig.cycle.period_us
    lead_mm = float(drive.lead_mm)
    return ProfidriveSettings(
        axis=name,
        increments_per_mm=float(drive.per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        jump_mm=jump_mm(parameters, drive.jump_factor, period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        sensor_age_limit_ms=axis.sensor_age_limit_ms,
        loop=loop_settings(settings, name),
        telegram=drive.make().telegram,
        speed_counts=60 * SPEED_BASE / (parameters.integer(BASE) * lead_mm),
        period_s=period_us * US / S,
        gain=gain_of(settings, name),
        feed_forward=feed_forward(settings, name),
        proves_places=drive.proves_places,
        echo_cycles=phases_of(settings, name).way,
        missing_cycles=drive.missing_cycles,
    )
