"""The cyclic values of one drive in the process image: its slice of the frame, in and out.

Inputs count only when the working counter is right; what a frame brings is taken once, and what no
frame of this cycle brings is missing. What the values mean is of the family of the drive.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

from axisrig.kernel.drives.cia402.cyclic_data import CyclicData, Values
from axisrig.kernel.drives.ethercat.image import codec_of, objects_of
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import Alarm

# Why inputs could not be used: alarm IDs
NO_FRAME, WRONG_COUNTER, SILENT = 900730, 900731, 900733
NAME: Final = "process image"


class Silent(NamedTuple):
    """The first slave of a line that does not answer, and how many of all do."""

    axis: str
    position: int
    found: int
    expected: int


class SlaveData(CyclicData):
    """Takes the inputs of one drive out of a frame, and packs its outputs for the next one.

    outputs: the bytes that the next frame carries. silent: the slave that the counter is wrong for,
    None where all answer or nobody has asked.
    """

    def __init__(self, settings: SlaveSettings) -> None:
        super().__init__([NAME], NO_FRAME)
        self._inputs, self._outputs = objects_of(settings.inputs), objects_of(settings.outputs)
        self._in, self._out = codec_of(self._inputs), codec_of(self._outputs)
        self._values = [0] * len(self._outputs)
        self._data: bytes | None = None
        self.silent: Silent | None = None
        self._cause, self._found, self._expected = NO_FRAME, 0, 0
        self.outputs: bytes = self._out.pack(*self._values)

    def _find(self, wanted: Callable[[MappedObject], bool]) -> int | None:
        for place, mapped in enumerate(self._inputs):
            if wanted(mapped):
                return place
        return None

    # What the master says

    def forget(self) -> None:
        """Forget what is there: a new frame leaves."""
        self._data, self._cause = None, NO_FRAME

    def arrived(self, data: bytes) -> None:
        """Take the inputs of a frame whose working counter was right."""
        self._data, self.silent = data, None

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

    def _note_missing(self, cause: int) -> None:
        self.missing[0] += 1
        self.causes[0], self.is_disturbed = cause, True

    def missing_alarm(self, axis: str, slot: int) -> Alarm:
        """Return the alarm of inputs that could not be used for so many cycles.

        Where a slave of the line is silent it is that of this slave, whatever axis asks.
        """
        cycles, cause = self.missing[slot], self.causes[slot]
        if cause == WRONG_COUNTER and self.silent is not None:
            return Alarm(SILENT, cycles=cycles, **self.silent._asdict())
        if cause == WRONG_COUNTER:
            return Alarm(
                cause, axis=axis, cycles=cycles, counter=self._found, expected=self._expected
            )
        if cause == NO_FRAME:
            return Alarm(cause, axis=axis, cycles=cycles)
        return super().missing_alarm(axis, slot)

    # Sent

    def sent_place(self, field: str) -> Values | None:
        """Return the values that are sent, and the position of a field in them."""
        return self._sent(lambda mapped: mapped.field == field)

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
