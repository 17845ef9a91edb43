"""How a campaign goes on, and how much is printed of many runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, auto

FEW = 20
"""Of so many results at most each one is shown; of more what did not pass, equal ones once."""


class Talk(Enum):
    """How much is printed of the runs of a campaign."""

    NONE = auto()
    SHORT = auto()
    """Of few runs each one, of more what did not pass."""
    ALL = auto()

    def of(self, count: int) -> "Talk":
        """Return the same for so many runs: of few each one, unless none is shown."""
        return Talk.ALL if self is Talk.SHORT and count <= FEW else self


def _unsaid(_text: str) -> None:
    """Take what is being done where nobody looks on."""


def _untimed(_seconds: float) -> str:
    """Return no time of day: nothing below the command line reads a clock."""
    return ""


@dataclass(frozen=True)
class Manner:
    """How a campaign goes on and what it shows.

    talk: which runs are shown. ends_at_first: end at the first run that does not pass. say: takes
    what is being done. info: texts `key=value` of what is tested (`--info`).
    ago: gives the time of day so many seconds ago, ISO 8601; empty without a clock.
    """

    talk: Talk = Talk.SHORT
    ends_at_first: bool = False
    say: Callable[[str], None] = _unsaid
    info: Sequence[str] = ()
    ago: Callable[[float], str] = _untimed
