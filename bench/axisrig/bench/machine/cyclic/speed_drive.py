"""Both ends of a drive on a cyclic segment that only takes a speed; a family derives its own."""

from axisrig.bench.drive.speed_drive.node import SpeedDriveNode, Unit
from axisrig.bench.machine.cyclic.ends import Ask, ImageEnds, Plugged
from axisrig.bench.record.axes import Telegram
from axisrig.bench.rig.cyclic.members import phases_of
from axisrig.bench.rig.loop import feed_forward, kv_per_s
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, drive_input, jump_mm
from axisrig.bench.rig.settings import Settings, once
from axisrig.bench.rig.speed_drive.members import drive_of
from axisrig.kernel.drives.cyclic.carrier import CyclicStart, ImagePort
from axisrig.kernel.drives.interface import DriveStart, DriveWatch
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.drives.speed_drive.watch import SpeedDriveWatch
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.profiles.speed_drive.words import OUTPUT_MAX, Image
from axisrig.kernel.time.clock import US, S


class SpeedDriveEnds(ImageEnds):
    """Both ends of one drive. Raises UserError for a plant that takes no speed."""

    link: SpeedDrive
    node: SpeedDriveNode

    def __init__(self, plugged: Plugged) -> None:
        self._settings, self._axis = plugged.bench.settings, plugged.axis
        images = self._images()
        self.node = self._make_node(plugged, images)
        self.drive = self.node.servo
        self.port = ImagePort()
        self.link = self._make_link()
        self.telegrams = [
            Telegram("outputs", 1, images[0].names),
            Telegram("inputs", 1, images[1].names),
        ]

    def _images(self) -> tuple[Image, Image]:
        """Return the images of the family, to the drive and from it."""
        raise NotImplementedError

    def _make_unit(self) -> Unit:
        """Make what counts and latches in the drive."""
        raise NotImplementedError

    def _make_link(self) -> SpeedDrive:
        """Make the control's end."""
        raise NotImplementedError

    def _make_node(self, plugged: Plugged, images: tuple[Image, Image]) -> SpeedDriveNode:
        bench, axis, seed, entered = plugged
        beside, settings = bench.beside, self._settings
        port = beside.axis(axis)
        if ControlKind.VELOCITY not in port.kinds:
            raise rig_error(
                settings.files,
                ("axis", axis, "plant"),
                f"axis {axis}: its drive only takes speeds, and its plant takes none",
                value=settings.rig.axis[axis].plant,
                hint="a plant whose FMU takes a speed, such as AxisRig.Drives.ServoAxis",
            )
        return SpeedDriveNode(
            axis,
            bench.scheduler,
            port,
            beside.probes(axis),
            drive_of(settings, axis).make(),
            images,
            self._make_unit(),
            seed,
            switches=beside.switches(axis),
            entered=entered,
        )

    def watch(self) -> DriveWatch:
        """Make the watch over the drive."""
        return SpeedDriveWatch(self.link)

    def start_up(self, ask: Ask) -> DriveStart:
        """Make the start-up of the drive, which has nothing to be asked for."""
        return CyclicStart()


@once
def speed_drive_settings(settings: Settings, name: str) -> SpeedDriveSettings:
    """Return what the control knows of the drive of an axis."""
    parameters, drive = settings.axis[name], drive_of(settings, name)
    period_us = settings.rig.cycle.period_us
    loop = LoopSettings(
        kv_per_s=kv_per_s(settings, name),
        period_s=period_us * US / S,
        feed_forward=feed_forward(settings, name),
    )
    return SpeedDriveSettings(
        axis=name,
        increments_per_mm=float(drive.per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        jump_mm=jump_mm(parameters, drive.jump_factor, period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        sensor_age_limit_ms=settings.rig.axis[name].sensor_age_limit_ms,
        loop=loop,
        speed_counts=float(OUTPUT_MAX / drive.full_mm_s),
        period_s=period_us * US / S,
        echo_cycles=phases_of(settings, name).way,
        missing_cycles=drive.missing_cycles,
    )
