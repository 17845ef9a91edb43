"""A latch with an enable bit and a valid bit (`latch.csv`).

The first edge after the enable bit stores, later ones change nothing. After the enable bit has
gone, the valid bit is there for one cycle more; enabled again in that cycle, the unit keeps the old
value.
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final


class LatchState(Enum):
    """State of the latch."""

    __hash__ = object.__hash__

    OFF = auto()
    ARMED = auto()  # waits for its edge
    STORED = auto()  # has a value, and its valid bit is set
    CLEARING = auto()  # not enabled any more, and the valid bit is still set


class LatchInput(Enum):
    """The enable bit of a cycle, or an edge."""

    __hash__ = object.__hash__

    LOW = auto()
    ENABLE = auto()
    PULSE = auto()


def _read() -> Mapping[tuple[LatchState, LatchInput], LatchState]:
    text = resources.files(__package__ or "").joinpath("latch.csv").read_text(encoding="utf-8")
    return {
        (LatchState[row["state"]], LatchInput[row["input"]]): LatchState[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


TABLE: Final = _read()


class EnabledLatch:
    """One latch. value: what it has stored last."""

    def __init__(self) -> None:
        self.state = LatchState.OFF
        self.value = 0

    def reset(self) -> None:
        """Be as after power on."""
        self.state, self.value = LatchState.OFF, 0

    def enable(self, *, is_enabled: bool) -> None:
        """Take the enable bit of a cycle."""
        self.state = TABLE[self.state, LatchInput.ENABLE if is_enabled else LatchInput.LOW]

    def pulse(self, value: int) -> None:
        """Take an edge of the input; value: of the counter there."""
        if self.state is LatchState.ARMED:
            self.value = value
        self.state = TABLE[self.state, LatchInput.PULSE]

    @property
    def is_armed(self) -> bool:
        """Whether it waits for an edge."""
        return self.state is LatchState.ARMED

    @property
    def is_valid(self) -> bool:
        """The valid bit."""
        return self.state in (LatchState.STORED, LatchState.CLEARING)
