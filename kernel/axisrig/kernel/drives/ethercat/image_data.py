"""The cyclic values of one drive in the process image: its slice of the frame, in and out.

Inputs count only when the working counter is right; what a frame brings is taken once, and what no
frame of this cycle brings is missing. All values of one cycle are of one frame, so that a counter
(60D5 to 60D8) proves the latched position beside it.
"""

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Final

from axisrig.kernel.drives.canopen.mapping import (
    FROM_LATCH_TO_COUNTER,
    FROM_LATCH_TO_STAMP,
    MappedObject,
)
from axisrig.kernel.drives.cia402.cyclic_data import TAKEN, CyclicData, Values
from axisrig.kernel.drives.cia402.words import find_state
from axisrig.kernel.drives.ethercat.image import codec_of, objects_of
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.errors import Alarm

# Why inputs could not be used: alarm IDs
NO_FRAME, WRONG_COUNTER, NO_STATE = 900730, 900731, 900081
NAME: Final = "process image"
_NOTHING: Final[Sequence[int | None]] = (None,) * len(TAKEN)
_OF_LATCH: Final = ("latch", "latch_count", "stamp")


class ImageData(CyclicData):
    """Takes the inputs of one drive out of a frame, and packs its outputs for the next one.

    latch_object: that in use, 60BA to 60BD. outputs: the bytes that the next frame carries.
    """

    def __init__(self, settings: SlaveSettings, latch_object: int) -> None:
        super().__init__([NAME], NO_FRAME)
        self._inputs, self._outputs = objects_of(settings.inputs), objects_of(settings.outputs)
        self._in, self._out = codec_of(self._inputs), codec_of(self._outputs)
        self._values = [0] * len(self._outputs)
        self._places: dict[str, int | None] = {
            field: self._find(_of_field(field)) for field in TAKEN if field not in _OF_LATCH
        }
        self._latch, self._counter = latch_object, latch_object + FROM_LATCH_TO_COUNTER
        self._pick = self._picker()
        self._data: bytes | None = None
        self._cause, self._found, self._expected = NO_FRAME, 0, 0
        self._good_word: int | None = None
        self.outputs = self._out.pack(*self._values)

    def _find(self, wanted: Callable[[MappedObject], bool]) -> int | None:
        for place, mapped in enumerate(self._inputs):
            if wanted(mapped):
                return place
        return None

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

    # What the master says

    def forget(self) -> None:
        """Forget what is there: a new frame leaves."""
        self._data, self._cause = None, NO_FRAME

    def arrived(self, data: bytes) -> None:
        """Take the inputs of a frame whose working counter was right."""
        self._data = data

    def refused(self, found: int, expected: int) -> None:
        """Take note of a frame whose working counter was wrong: its inputs count for nothing."""
        self._data, self._cause = None, WRONG_COUNTER
        self._found, self._expected = found, expected

    # A cycle

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        self.forget()
        self.missing[0], self.is_disturbed = 0, False

    def begin_cycle(self) -> None:
        """The frame decides what is new (`forget`), not the begin of a cycle."""

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
        self.missing[0] += 1
        self.causes[0], self.is_disturbed = cause, True
        return _NOTHING

    def missing_alarm(self, axis: str, slot: int) -> Alarm:
        """Return the alarm of inputs that could not be used for so many cycles."""
        cycles, cause = self.missing[slot], self.causes[slot]
        if cause == WRONG_COUNTER:
            return Alarm(
                cause, axis=axis, cycles=cycles, counter=self._found, expected=self._expected
            )
        if cause == NO_FRAME:
            return Alarm(cause, axis=axis, cycles=cycles)
        return super().missing_alarm(axis, slot)

    def choose_latch(self, latch_object: int, counter_object: int) -> bool:
        """Take the latched position and its counter from these objects from now on."""
        if self._find(_of_index(latch_object)) is None:
            return False
        self._latch, self._counter = latch_object, counter_object
        self._pick = self._picker()
        return True

    # Sent

    def sent_place(self, field: str) -> Values | None:
        """Return the values that are sent, and the position of a field in them."""
        return self._sent(_of_field(field))

    def sent_object(self, index: int, sub: int) -> Values | None:
        """Return the values that are sent, and the position of an object in them."""
        return self._sent(lambda mapped: (mapped.index, mapped.sub) == (index, sub))

    def _sent(self, wanted: Callable[[MappedObject], bool]) -> Values | None:
        for place, mapped in enumerate(self._outputs):
            if wanted(mapped):
                return self._values, place
        return None

    def send(self) -> None:
        """Let the next frame carry the present values."""
        self.outputs = self._out.pack(*self._values)


def _of_field(field: str) -> Callable[[MappedObject], bool]:
    return lambda mapped: mapped.field == field


def _of_index(index: int) -> Callable[[MappedObject], bool]:
    return lambda mapped: mapped.index == index
