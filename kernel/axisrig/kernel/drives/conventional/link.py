"""The control's end of a conventional drive: output, counter and latches are on a card of it."""

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.speed_drive.latch import LatchControl
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.profiles.conventional import words

IMAGES = words.TO_CARD, words.FROM_CARD


class ConventionalDrive(SpeedDrive):
    """One drive. Its counter keeps the place while the drive is off: the card has its own power."""

    def __init__(self, settings: SpeedDriveSettings, port: ImagePort) -> None:
        self._enabled = LatchControl(settings.echo_cycles)
        super().__init__(settings, port, IMAGES, self._enabled)

    def _place_of(self, values: dict[str, int]) -> int:
        return values["COUNTER"]

    def _take_latch(self, values: dict[str, int], place: int, travel: int) -> None:
        status, edge = values["STATUS"], self.edge
        self._level = bool(status & words.LEVEL)
        raw = values[words.VALUE[edge]] if status & words.ENABLE[edge] else None
        self._enabled.take(raw, place, travel)

    def _latched_mm(self, value: int, place: int) -> float:
        return value / self._per_mm

    def _own_outputs(self) -> dict[str, int]:
        return {"ENABLE": words.ENABLE[self.edge] if self._enabled.is_ordered else 0}
