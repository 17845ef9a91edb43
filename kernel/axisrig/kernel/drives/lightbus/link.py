"""The control's end of a drive on Lightbus (AX2000): its position is absolute.

LATCH32 is a position in um. LATCH16 counts within a turn: the control takes the turn in which it is
nearest to the position of the telegram that brought it, half a turn away at most.
"""

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.lightbus.latch import ReadLatch
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.profiles.lightbus import words
from axisrig.kernel.profiles.speed_drive.words import signed

IMAGES = words.TO_DRIVE, words.FROM_DRIVE


class LightbusDrive(SpeedDrive):
    """One drive. is_in_turn: its latch is LATCH16."""

    def __init__(
        self, settings: SpeedDriveSettings, port: ImagePort, *, is_in_turn: bool = False
    ) -> None:
        self._read = ReadLatch(settings.echo_cycles)
        super().__init__(settings, port, IMAGES, self._read)
        self._is_in_turn = is_in_turn

    def _place_of(self, values: dict[str, int]) -> int:
        return values["POSITION"]

    def _take_latch(self, values: dict[str, int], place: int, travel: int) -> None:
        edge = self.edge
        is_shown = bool(values["SHOWN"] & words.READ[edge])
        shown = values[words.VALUE[edge]] if is_shown else None
        self._read.take(bool(values["DRVSTAT"] & words.LATCHED[edge]), shown, place, travel)

    def _latched_mm(self, value: int, place: int) -> float:
        if not self._is_in_turn:
            return value / words.UM_PER_MM
        in_turn = value << words.TURN_BITS - words.LATCH16_BITS
        return (place + signed(in_turn - place, words.TURN_BITS)) / self._per_mm

    def _own_outputs(self) -> dict[str, int]:
        return {"READ": words.READ[self.edge] if self._read.reads else 0}
