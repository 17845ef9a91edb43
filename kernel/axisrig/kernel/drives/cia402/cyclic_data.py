"""Cyclic values of one drive: what came with the last cycle, and what is sent with the next."""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.errors import Alarm

# The fields that `take` gives, in this order
TAKEN: Final = (
    "statusword", "actual", "probe_status", "latch", "latch_count", "inputs", "second", "stamp",
)  # fmt: skip

Values = tuple[list[int], int]
"""Values that are sent together, and the place of one among them."""


class CyclicData:
    """Takes apart what a drive sends in each cycle, and packs what it gets.

    missing: for each of `names` how many cycles in a row it has stayed out or could not be used.
    is_disturbed: whether the last cycle was such a one. causes: its alarm ID. wrong_length: name
    and lengths of what did not fit its mapping, None = all did.
    """

    def __init__(self, names: Sequence[str], cause: int) -> None:
        self.names = list(names)
        self.missing = [0] * len(self.names)
        self.causes = [cause] * len(self.names)
        self.is_disturbed = False
        self.wrong_length: tuple[str, int, int] | None = None

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        raise NotImplementedError

    def begin_cycle(self) -> None:
        """Forget what is there: a cycle counts with its own answers only."""
        raise NotImplementedError

    def take(self) -> Sequence[int | None]:
        """Take what the last cycle delivered: the values of `TAKEN`, None for what is missing."""
        raise NotImplementedError

    def missing_alarm(self, axis: str, slot: int) -> Alarm:
        """Return the alarm of what has stayed out too often, `slot`: which of `names`."""
        cause, name = self.causes[slot], self.names[slot]
        return Alarm(cause, axis=axis, pdo=name, cycles=self.missing[slot])

    def choose_latch(self, latch_object: int, counter_object: int) -> bool:
        """Take the latched position and its counter from these objects from now on.

        Returns False, and changes nothing, when no cycle delivers the position.
        """
        raise NotImplementedError

    def sent_place(self, field: str) -> Values | None:
        """Return the values that are sent with a field, and its position in them."""
        raise NotImplementedError

    def sent_object(self, index: int, sub: int) -> Values | None:
        """Return the values that are sent with an object, and its position in them."""
        raise NotImplementedError

    def send(self) -> None:
        """Send the present values."""
        raise NotImplementedError
