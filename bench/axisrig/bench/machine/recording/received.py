"""What has come to the control over its segments, as its controllers took it from the wire.

It is beside the control: nothing of what the control makes of it is asked, and nothing is kept of a
run but in memory. `bench.tools.scenarios` judges values with it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from axisrig.kernel.time.clock import Clock, TimeNs

Telegram = tuple[TimeNs, bytes]
"""When it was there, and its data."""


@dataclass
class Received:
    """Telegrams in their order.

    positions: those with the actual position of an axis, and what takes it, in increments, out of
    their data. inputs: of the node with digital inputs that is the terminal of the PLC. first_ns:
    by axis, how long after the request of a SYNC one can answer it at the earliest; inputs_first_ns
    of the node.
    """

    positions: dict[str, list[Telegram]] = field(default_factory=dict)
    increments: dict[str, Callable[[bytes], int]] = field(default_factory=dict)
    inputs: list[Telegram] = field(default_factory=list)
    first_ns: dict[str, TimeNs] = field(default_factory=dict)
    inputs_first_ns: TimeNs = 0


def noted(into: list[Telegram], clock: Clock) -> Callable[[int, bytearray, float], None]:
    """Return what notes each telegram that it is called with."""

    def note(_can_id: int, data: bytearray, _timestamp: float) -> None:
        into.append((clock.now_ns, bytes(data)))

    return note
