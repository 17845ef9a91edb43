"""Latches of an AX2000 with IN2MODE = 26: always on, read by a bit of the image (`read.csv`).

The first edge stores until the value is read; a read without an edge shows the value of an earlier
one. Reading clears bit 20 of DRVSTAT. Source: ASCII object reference of AX2000, LATCH16, LATCH32,
IN2MODE (docs/lightbus.md).
"""

import csv
from collections.abc import Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final

from axisrig.bench.drive.speed_drive.profile import SpeedProfile
from axisrig.kernel.profiles.lightbus import words

EDGES: Final = {True: "POS", False: "NEG"}


class ReadState(Enum):
    """State of one latch."""

    __hash__ = object.__hash__

    WAITING = auto()
    STORED = auto()  # nobody has read it
    SHOWN = auto()  # the image has the value, as it was asked


class ReadInput(Enum):
    """The bit to read of a cycle, or an edge."""

    __hash__ = object.__hash__

    LOW = auto()
    READ = auto()
    PULSE = auto()


def _read() -> Mapping[tuple[ReadState, ReadInput], ReadState]:
    text = resources.files(__package__ or "").joinpath("read.csv").read_text(encoding="utf-8")
    return {
        (ReadState[row["state"]], ReadInput[row["input"]]): ReadState[row["next"]]
        for row in csv.DictReader(text.splitlines())
    }


TABLE: Final = _read()


class LightbusUnit:
    """Both latches of one drive. in2mode: function of input 2. is_in_turn: they are LATCH16.

    states, values: by edge, True = rising; values are increments of the encoder.
    """

    def __init__(self, made: SpeedProfile, in2mode: int, *, is_in_turn: bool) -> None:
        self._lead_um = made.drive.lead_um
        self._latches, self._is_in_turn = in2mode == words.IN2MODE_LATCH, is_in_turn
        self.reset(0)

    def reset(self, position: int) -> None:
        """Be as after power on."""
        self.states = dict.fromkeys(EDGES, ReadState.WAITING)
        self.values = dict.fromkeys(EDGES, 0)

    @property
    def has_own_power(self) -> bool:
        """It has that of the drive."""
        return False

    def edges(self) -> tuple[bool, ...]:
        """Return the edges that it waits for."""
        if not self._latches:
            return ()
        return tuple(edge for edge, state in self.states.items() if state is ReadState.WAITING)

    def pulse(self, edge: bool, position: int) -> None:
        """Take an edge that it waited for."""
        self.values[edge] = position
        self.states[edge] = TABLE[self.states[edge], ReadInput.PULSE]

    def command(self, values: dict[str, int], position: int) -> None:
        """Take the bits to read."""
        asked = values.get("READ", 0)
        for edge, name in EDGES.items():
            given = ReadInput.READ if asked & words.READ[name] else ReadInput.LOW
            self.states[edge] = TABLE[self.states[edge], given]

    def inputs(self, position: int, *, level: bool) -> dict[str, int]:
        """Return position, status and values; no bit shows the level of the input."""
        status = shown = 0
        found = {"POSITION": position}
        for edge, name in EDGES.items():
            state = self.states[edge]
            status |= words.LATCHED[name] if state is ReadState.STORED else 0
            if state is ReadState.SHOWN:
                shown |= words.READ[name]
                found[words.VALUE[name]] = self._variable(self.values[edge])
        return {**found, "DRVSTAT": status, "SHOWN": shown}

    def _variable(self, position: int) -> int:
        if self._is_in_turn:
            bits = words.TURN_BITS - words.LATCH16_BITS
            return position >> bits & (1 << words.LATCH16_BITS) - 1
        half = 1 << words.TURN_BITS - 1
        return (position * self._lead_um + half) >> words.TURN_BITS
