"""Limit and home switches of a drive, after the circuits of its digital inputs."""

from collections.abc import Mapping
from typing import Final

from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.kernel.time.clock import TimeNs

NEGATIVE, POSITIVE, HOME = "negative", "positive", "home"
SWITCHES: Final = (NEGATIVE, POSITIVE, HOME)
"""In the order of bits 0 to 2 of the digital inputs 60FD (CiA 402-2)."""
SEED: Final = 16  # apart from the seeds of the probe inputs


class Switches:
    """The switches as the drive sees them now: on where they are wired and their level is high.

    signals: by the names in SWITCHES. word: bits 0 to 2 of 60FD.
    """

    def __init__(
        self, signals: Mapping[str, SignalPort], habits: AxisHabits, seed: int = 0
    ) -> None:
        self._circuits = [
            (bit, name, InputCircuit(signals[name], habits, seed + SEED + bit))
            for bit, name in enumerate(SWITCHES)
            if name in signals
        ]
        self.wired = frozenset(signals)
        self.has_limits = bool(self.wired & {NEGATIVE, POSITIVE})
        self.word = 0

    def take_edges(self, now_ns: TimeNs) -> None:
        """Follow the edges that came through up to `now_ns`."""
        for bit, _, circuit in self._circuits:
            circuit.passed(now_ns)
            if circuit.level:
                self.word |= 1 << bit
            else:
                self.word &= ~(1 << bit)

    def is_on(self, name: str) -> bool:
        """Return whether a switch is on."""
        return bool(self.word >> SWITCHES.index(name) & 1)

    @property
    def limits(self) -> int:
        """The limit switches that are on: bits 0 and 1 of 60FD."""
        return self.word & 0b11

    def limit(self, direction: float) -> bool:
        """Return whether the limit switch of a direction is on; False for no direction."""
        if direction > 0:
            return bool(self.word & 0b10)
        return direction < 0 and bool(self.word & 0b01)
