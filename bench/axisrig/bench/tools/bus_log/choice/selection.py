"""Which frames of a bus log are shown."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Selection:
    """Which frames are shown.

    only: services, axes, telegrams, objects, of which one must fit; every frame if empty.
    from_ms, to_ms: since the start of the log. is_all: also SYNCs, and PDOs with nothing new.
    segments: channel of the log -> segment of the rig, where the user says it.
    """

    only: tuple[str, ...] = ()
    from_ms: float = float("-inf")
    to_ms: float = float("inf")
    is_all: bool = False
    segments: Mapping[str, str] = field(default_factory=dict)
