"""A latch that is enabled by a bit and shows by another that it has a value.

The first edge after the enable bit stores, later ones change nothing, and the unit takes its valid
bit away after the enable bit has gone. Enabled while that bit is still there, it keeps the old
value: so a run begins only after a telegram in which both bits are low, made after the enable bit
went low. A value counts when two telegrams after the enable bit have the same. States and inputs
are `latch.csv`.
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final

from axisrig.kernel.drives.speed_drive.probe_latch import ProbeLatch


class LatchState(Enum):
    """What the control knows of the latch."""

    __hash__ = object.__hash__

    IDLE = auto()  # not enabled, and perhaps a value is there
    CLEAR = auto()  # not enabled, and the valid bit is low
    ARMING = auto()  # enabled, and no telegram was made after that
    ARMED = auto()
    STORED = auto()  # a value, once
    VALUE = auto()  # the same twice
    LOST = auto()  # a value that went away or changed is none


class LatchInput(Enum):
    """An order of the control, or what a telegram shows."""

    __hash__ = object.__hash__

    ARM = auto()
    DISARM = auto()
    OLD = auto()  # made before the enable bit changed
    LOW = auto()  # no value
    NEW = auto()  # a value, another one than in the telegram before
    SAME = auto()  # a value, as in the telegram before


def _read() -> Mapping[tuple[LatchState, LatchInput], LatchState]:
    text = resources.files(__package__ or "").joinpath("latch.csv").read_text(encoding="utf-8")
    return {
        (LatchState[row["state"]], LatchInput[row["input"]]): LatchState[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


TABLE: Final = _read()
_ORDERED: Final = (
    LatchState.ARMING, LatchState.ARMED, LatchState.STORED, LatchState.VALUE, LatchState.LOST,
)  # fmt: skip
_STORED: Final = (LatchState.STORED, LatchState.VALUE)


class LatchControl(ProbeLatch):
    """One latch; as `ProbeLatch`."""

    def __init__(self, echo_cycles: int) -> None:
        super().__init__(echo_cycles)
        self.state = LatchState.IDLE

    def _change(self, event: LatchInput) -> None:
        before, self.state = self.state, TABLE[self.state, event]
        if (before in _ORDERED) is not (self.state in _ORDERED):
            self._begin_anew()

    def take(self, raw: int | None, place: int, travel: int) -> None:
        """Take what a telegram shows. raw: the value, None while the valid bit is low."""
        before, self._raw = self._raw, raw
        if self._is_old():
            self._raw = None
            self._change(LatchInput.OLD)
        elif raw is None:
            self._change(LatchInput.LOW)
        else:
            had = self.has_latched
            self._change(LatchInput.SAME if raw == before else LatchInput.NEW)
            if self.has_latched and not had:
                self.place, self.travel = place, travel

    def arm(self) -> None:
        """Enable it with the next image; nothing happens before it has been seen clear."""
        self._change(LatchInput.ARM)

    def disarm(self) -> None:
        """Switch it off with the next image."""
        self._change(LatchInput.DISARM)

    @property
    def is_ordered(self) -> bool:
        """Whether it has been ordered on and not off again: the enable bit."""
        return self.state in _ORDERED

    @property
    def is_clear(self) -> bool:
        """Whether both bits have been seen low."""
        return self.state is LatchState.CLEAR

    @property
    def is_armed(self) -> bool:
        """Whether it waits for an edge, or has its value."""
        return self.state is LatchState.ARMED or self.has_latched

    @property
    def has_latched(self) -> bool:
        """Whether a value is there."""
        return self.state in _STORED

    @property
    def value(self) -> int | None:
        """The value, as it is in the image; None until two telegrams have the same."""
        return self._raw if self.state is LatchState.VALUE else None
