"""A card of the control: a counter, and a latch for each edge of the probing input."""

from typing import Final

from axisrig.bench.drive.speed_drive.latch import EnabledLatch
from axisrig.kernel.profiles.conventional import words

EDGES: Final = {True: "POS", False: "NEG"}


class CounterCard:
    """One axis of a card; it has its own power, so that the counter goes on without the drive."""

    def __init__(self) -> None:
        self.latches = {edge: EnabledLatch() for edge in EDGES}

    def reset(self, position: int) -> None:
        """Be as after power on of the drive: the card has never been off."""

    @property
    def has_own_power(self) -> bool:
        """The card has that of the control."""
        return True

    def edges(self) -> tuple[bool, ...]:
        """Return the edges that it waits for."""
        return tuple(edge for edge, latch in self.latches.items() if latch.is_armed)

    def pulse(self, edge: bool, position: int) -> None:
        """Take an edge that it waited for."""
        self.latches[edge].pulse(position)

    def command(self, values: dict[str, int], position: int) -> None:
        """Take the enable bits."""
        asked = values.get("ENABLE", 0)
        for edge, name in EDGES.items():
            self.latches[edge].enable(is_enabled=bool(asked & words.ENABLE[name]))

    def inputs(self, position: int, *, level: bool) -> dict[str, int]:
        """Return status, counter and latches. level: of the probing input."""
        status = words.LEVEL if level else 0
        found = {"COUNTER": position}
        for edge, name in EDGES.items():
            status |= words.ENABLE[name] if self.latches[edge].is_valid else 0
            found[words.VALUE[name]] = self.latches[edge].value
        return {**found, "STATUS": status}
