"""The cyclic values of one SERCOS drive: its AT and its MDT in the process image."""

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Final

from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import SlaveData

_NOTHING: Final[Sequence[int | None]] = (None,) * len(TAKEN)


class TelegramData(SlaveData):
    """Takes the AT of one drive; latch: ident of the measured value in use, S-0-0130 to 133."""

    def __init__(self, settings: SlaveSettings, latch: int) -> None:
        super().__init__(settings)
        self._latch = latch
        self._pick = self._picker()

    def carries(self, ident: int) -> bool:
        """Whether the AT has an ident."""
        return self._find(lambda mapped: mapped.index == ident) is not None

    def _picker(self) -> Callable[[Sequence[int | None]], Sequence[int | None]]:
        """Make the function that picks the fields; a None comes after all values."""
        places = list[int]()
        for wanted in TAKEN:
            place = None
            for number, mapped in enumerate(self._inputs):
                is_it = mapped.index == self._latch if wanted == "latch" else mapped.field == wanted
                if is_it and place is None:
                    place = number
            places.append(len(self._inputs) if place is None else place)
        return itemgetter(*places)

    def take(self) -> Sequence[int | None]:
        """Take what the last frame delivered: the values of `TAKEN`, None for all if none did."""
        data, self._data = self._data, None
        if data is None:
            self._note_missing(self._cause)
            return _NOTHING
        self.missing[0], self.is_disturbed = 0, False
        return self._pick((*self._in.unpack(data), None))

    def choose_latch(self, latch_object: int, counter_object: int) -> bool:
        """Take the measured value from another ident; SERCOS counts no latches."""
        if not self.carries(latch_object):
            return False
        self._latch = latch_object
        self._pick = self._picker()
        return True
