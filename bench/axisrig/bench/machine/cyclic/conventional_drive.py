"""Both ends of a conventional drive."""

from axisrig.bench.drive.conventional.unit import CounterCard
from axisrig.bench.drive.speed_drive.node import Unit
from axisrig.bench.machine.cyclic.speed_drive import SpeedDriveEnds, speed_drive_settings
from axisrig.kernel.drives.conventional.link import IMAGES, ConventionalDrive
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.profiles.speed_drive.words import Image


class ConventionalEnds(SpeedDriveEnds):
    """Both ends of one drive."""

    def _images(self) -> tuple[Image, Image]:
        return IMAGES

    def _make_unit(self) -> Unit:
        return CounterCard()

    def _make_link(self) -> SpeedDrive:
        return ConventionalDrive(speed_drive_settings(self._settings, self._axis), self.port)
