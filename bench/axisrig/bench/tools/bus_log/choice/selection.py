"""Which frames of a bus log are shown."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Selection:
    """Which frames are shown.

    only: services, axes, telegrams, objects, of which one must fit; every frame if empty.
    from_ms, to_ms: since the start of the log. is_all: also SYNCs, and PDOs with nothing new.
    """

    only: tuple[str, ...] = ()
    from_ms: float = 0.0
    to_ms: float = float("inf")
    is_all: bool = False
