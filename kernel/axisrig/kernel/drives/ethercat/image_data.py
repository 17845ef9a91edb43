"""The cyclic values of one drive of CiA 402 in the process image.

All values of one cycle are of one frame, so that a counter (60D5 to 60D8) proves the latched
position beside it.
"""

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Final

from axisrig.kernel.drives.canopen.mapping import FROM_LATCH_TO_COUNTER, FROM_LATCH_TO_STAMP
from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.drives.cia402.words import find_state
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import SlaveData
from axisrig.kernel.drives.mapped import MappedObject

NO_STATE: Final = 900081
_NOTHING: Final[Sequence[int | None]] = (None,) * len(TAKEN)
_OF_LATCH: Final = ("latch", "latch_count", "stamp")


class ImageData(SlaveData):
    """Takes the inputs of one drive; latch_object: that in use, 60BA to 60BD."""

    def __init__(self, settings: SlaveSettings, latch_object: int) -> None:
        super().__init__(settings)
        self._places: dict[str, int | None] = {
            field: self._find(_of_field(field)) for field in TAKEN if field not in _OF_LATCH
        }
        self._latch, self._counter = latch_object, latch_object + FROM_LATCH_TO_COUNTER
        self._pick = self._picker()
        self._good_word: int | None = None

    def _picker(self) -> Callable[[Sequence[int | None]], Sequence[int | None]]:
        """Make the function that picks the fields; a None comes after all values."""
        indices = {
            "latch": self._latch,
            "latch_count": self._counter,
            "stamp": self._latch + FROM_LATCH_TO_STAMP,
        }
        for field, index in indices.items():
            self._places[field] = self._find(_of_index(index))
        found = [self._places[field] for field in TAKEN]
        return itemgetter(*(len(self._inputs) if place is None else place for place in found))

    def take(self) -> Sequence[int | None]:
        """Take what the last frame delivered: the values of `TAKEN`, None for all if none did."""
        data, self._data = self._data, None
        cause = self._cause
        if data is not None:
            picked = self._pick((*self._in.unpack(data), None))
            word = picked[0]
            if word == self._good_word or (word is not None and find_state(word) is not None):
                self._good_word = word
                self.missing[0], self.is_disturbed = 0, False
                return picked
            cause = NO_STATE
        self._note_missing(cause)
        return _NOTHING

    def choose_latch(self, latch_object: int, counter_object: int) -> bool:
        """Take the latched position and its counter from these objects from now on."""
        if self._find(_of_index(latch_object)) is None:
            return False
        self._latch, self._counter = latch_object, counter_object
        self._pick = self._picker()
        return True


def _of_field(field: str) -> Callable[[MappedObject], bool]:
    return lambda mapped: mapped.field == field


def _of_index(index: int) -> Callable[[MappedObject], bool]:
    return lambda mapped: mapped.index == index
