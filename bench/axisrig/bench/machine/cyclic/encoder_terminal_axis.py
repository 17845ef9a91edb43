"""Both ends of an axis with a speed drive and an encoder terminal."""

from axisrig.bench.drive.encoder_terminal.unit import EncoderTerminal
from axisrig.bench.drive.speed_drive.node import Unit
from axisrig.bench.machine.cyclic.speed_drive import SpeedDriveEnds, speed_drive_settings
from axisrig.kernel.drives.encoder_terminal.link import IMAGES, EncoderTerminalDrive
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.profiles.speed_drive.words import Image


class EncoderTerminalEnds(SpeedDriveEnds):
    """Both ends of one axis."""

    def _images(self) -> tuple[Image, Image]:
        return IMAGES

    def _make_unit(self) -> Unit:
        return EncoderTerminal()

    def _make_link(self) -> SpeedDrive:
        settings, node = speed_drive_settings(self._settings, self._axis), self.node
        # Where it stood when the control was switched off, which nothing has moved since
        return EncoderTerminalDrive(settings, self.port, lambda: node.image.position_actual)
