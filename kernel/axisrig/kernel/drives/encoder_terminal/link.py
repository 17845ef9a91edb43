"""The control's end of an axis with a speed drive and an encoder terminal (KL5101).

Counter and latch have 16 bits and wrap: the control counts turns of the counter itself, and takes a
latched value for the nearest place to the counter that came with it, at most half a turn away.

The counter is no absolute position. At the start-up the control sets it to the place that it has
kept (CNT_SET), and the terminal acknowledges it; an acknowledgement that goes away is a terminal
that was without power, and no position counts any more.
"""

from collections.abc import Callable

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.speed_drive.latch import LatchControl
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.encoder_terminal import words
from axisrig.kernel.profiles.speed_drive.words import signed

IMAGES = words.TO_TERMINAL, words.FROM_TERMINAL


class EncoderTerminalDrive(SpeedDrive):
    """One axis. kept: returns the place that the control has kept, increments."""

    def __init__(
        self, settings: SpeedDriveSettings, port: ImagePort, kept: Callable[[], int]
    ) -> None:
        self._enabled = LatchControl(settings.echo_cycles)
        super().__init__(settings, port, IMAGES, self._enabled)
        self._kept = kept
        self._set_to: int | None = None
        self._age = 0  # telegrams since the first one, while the counter is not set
        self._is_set = self._is_lost = False

    def _place_of(self, values: dict[str, int]) -> int:
        is_set = bool(values["STATUS"] & words.CNTSET_ACC)
        if self._set_to is None:
            self.actual_increments = self._set_to = self._kept()
        elif self._is_set:
            self._is_lost = self._is_lost or not is_set
        else:
            self._age += 1
            if is_set and self._sends_set:
                self._is_set = True
        if not self._is_set or self._is_lost:
            return self.actual_increments
        return self.actual_increments + signed(
            values["COUNTER"] - self.actual_increments, words.BITS
        )

    def _take_latch(self, values: dict[str, int], place: int, travel: int) -> None:
        status = values["STATUS"]
        self._level = bool(status & words.LEVEL)
        is_clean = not status & words.LATC_VAL and not self._is_lost
        raw = values["LATCH"] if status & words.LAT_EXT_VAL and is_clean else None
        self._enabled.take(raw, place, travel)

    def _latched_mm(self, value: int, place: int) -> float:
        return (place + signed(value - place, words.BITS)) / self._per_mm

    def _own_outputs(self) -> dict[str, int]:
        if self._set_to is None:  # no image has come yet
            return {}
        control = words.CNT_SET if self._sends_set else 0
        control |= words.EN_LAT_EXT if self.latch.is_ordered else 0
        return {"CONTROL": control, "SET": self._set_to % words.COUNTS}

    @property
    def _sends_set(self) -> bool:
        """Whether CNT_SET is high: only an edge sets, so that it was seen low before."""
        return self._is_set or self._age >= self._of_drive.echo_cycles

    @property
    def is_placed(self) -> bool:
        """Whether the counter was set, and has not been lost since."""
        return self._is_set and not self._is_lost

    def wrong_reference(self) -> Alarm | None:
        """Return Alarm 900781 for a terminal that was without power."""
        return Alarm(900781, axis=self.name) if self._is_lost else None

    def find_place(self) -> None:
        """Raise Alarm 900781 where the reference is lost."""
        alarm = self.wrong_reference()
        if alarm is not None:
            raise alarm
