"""A latch that is always on, and is read by a bit that the drive answers (`latch.csv`).

With IN2MODE = 26 each edge is latched, wanted or not: bit 20 of DRVSTAT stays until the value is
read. So a run first reads what there may be and throws it away; what comes after that is of its
edge. A value counts when it was read and two telegrams have the same.
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final

from axisrig.kernel.drives.speed_drive.probe_latch import ProbeLatch


class ReadState(Enum):
    """What the control knows of the latch."""

    __hash__ = object.__hash__

    IDLE = auto()  # not read, and perhaps a value is there
    CLEAR = auto()  # not read, and nothing is there
    CLEARING = auto()  # read, to throw it away
    ARMING = auto()  # ordered, and read to throw away what is there
    RELEASING = auto()  # ordered, and not read any more
    ARMED = auto()
    READING = auto()  # a value is there, and is read
    VALUE = auto()  # the same twice
    LOST = auto()  # a value that went away or changed is none


class ReadInput(Enum):
    """An order of the control, or what a telegram shows."""

    __hash__ = object.__hash__

    ARM = auto()
    DISARM = auto()
    OLD = auto()  # made before the bit to read has changed
    LOW = auto()  # nothing is there
    LATCHED = auto()  # a value that nobody has read
    NEW = auto()  # a value as it was read, another one than in the telegram before
    SAME = auto()  # as in the telegram before


def _read() -> Mapping[tuple[ReadState, ReadInput], ReadState]:
    text = resources.files(__package__ or "").joinpath("latch.csv").read_text(encoding="utf-8")
    return {
        (ReadState[row["state"]], ReadInput[row["input"]]): ReadState[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


TABLE: Final = _read()
_READS: Final = (ReadState.CLEARING, ReadState.ARMING, ReadState.READING, ReadState.VALUE)
_IDLE: Final = (ReadState.IDLE, ReadState.CLEAR, ReadState.CLEARING)
_LATCHED: Final = (ReadState.READING, ReadState.VALUE)


class ReadLatch(ProbeLatch):
    """One latch; as `ProbeLatch`."""

    def __init__(self, echo_cycles: int) -> None:
        super().__init__(echo_cycles)
        self.state = ReadState.IDLE

    def _change(self, event: ReadInput) -> None:
        did_read = self.reads
        self.state = TABLE[self.state, event]
        if self.reads is not did_read:
            self._begin_anew()

    def take(self, is_latched: bool, shown: int | None, place: int, travel: int) -> None:
        """Take what a telegram shows. shown: the value where it was read, else None."""
        before, self._raw = self._raw, shown
        if self._is_old():
            self._raw = None
            self._change(ReadInput.OLD)
        elif shown is not None:
            self._change(ReadInput.SAME if shown == before else ReadInput.NEW)
        else:
            had = self.has_latched
            self._change(ReadInput.LATCHED if is_latched else ReadInput.LOW)
            if self.has_latched and not had:
                self.place, self.travel = place, travel

    @property
    def reads(self) -> bool:
        """The bit to read."""
        return self.state in _READS

    def arm(self) -> None:
        """Throw away what is there, and wait for an edge from then on."""
        self._change(ReadInput.ARM)

    def disarm(self) -> None:
        """Wait no more, and drop what there is."""
        self._change(ReadInput.DISARM)

    @property
    def is_ordered(self) -> bool:
        """Whether it has been ordered on and not off again."""
        return self.state not in _IDLE

    @property
    def is_clear(self) -> bool:
        """Whether nothing is there, and nothing is read."""
        return self.state is ReadState.CLEAR

    @property
    def is_armed(self) -> bool:
        """Whether it waits for an edge, or has its value."""
        return self.state is ReadState.ARMED or self.has_latched

    @property
    def has_latched(self) -> bool:
        """Whether a value is there."""
        return self.state in _LATCHED

    @property
    def value(self) -> int | None:
        """The value, as it is in the image; None until two telegrams have the same."""
        return self._raw if self.state is ReadState.VALUE else None
