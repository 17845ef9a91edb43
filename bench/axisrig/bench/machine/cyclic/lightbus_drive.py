"""Both ends of a drive on Lightbus."""

from typing import Any

from axisrig.bench.drive.lightbus.unit import LightbusUnit
from axisrig.bench.drive.speed_drive.node import Unit
from axisrig.bench.machine.cyclic.speed_drive import SpeedDriveEnds, speed_drive_settings
from axisrig.bench.rig.speed_drive.members import drive_of
from axisrig.kernel.drives.lightbus.link import IMAGES, LightbusDrive
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.profiles.speed_drive.words import Image


class LightbusEnds(SpeedDriveEnds):
    """Both ends of one drive."""

    def _images(self) -> tuple[Image, Image]:
        return IMAGES

    @property
    def _table(self) -> Any:
        return drive_of(self._settings, self._axis)

    def _make_unit(self) -> Unit:
        table = self._table
        return LightbusUnit(table.make(), table.in2mode, is_in_turn=table.is_in_turn)

    def _make_link(self) -> SpeedDrive:
        settings = speed_drive_settings(self._settings, self._axis)
        return LightbusDrive(settings, self.port, is_in_turn=self._table.is_in_turn)
