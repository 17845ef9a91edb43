"""What can go wrong with a frame on the wire, decided by hooks that a segment asks.

A hook sees every attempt to send: `hook(frame, port, attempt)` with `attempt` counting from 0 for
the same request. It answers None (nothing wrong) or an action. The first hook that answers
decides.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass, field

from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.hits import Hits
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Drop:
    """The frame passes over the wire and is logged, but receivers do not get it.

    at: names of the ports that miss it, None = nobody gets it. The sender takes it for sent.
    """

    at: frozenset[str] | None = None


@dataclass(frozen=True)
class ErrorAtBit:
    """The frame is destroyed: `bit` bits of it are sent (1 = SOF, stuff bits count), then the flag.

    seen_by: names of the ports that see it, None = every node at the same bit. What follows, error
    frame, counters and retransmission, is in `bench.bus.segment`. A `bit` after the end of frame is
    its last one: the receivers have the frame by then, and the sender repeats it. Source: Bosch CAN
    2.0 part A, 3.1.3, 5 and 6.1.
    """

    bit: int
    seen_by: frozenset[str] | None = None

    def __post_init__(self) -> None:
        if self.bit < 1:
            raise ValueError(f"bit {self.bit}: the first bit of a frame is 1")


@dataclass(frozen=True)
class Alter:
    """The frame is sent with other data and a check sum that fits it.

    What a defect between application and controller does: no check of the bus can see it.
    """

    data: bytes


@dataclass(frozen=True)
class Delay:
    """The request is taken out of the transmit queue and put back in front `time_ns` later."""

    time_ns: TimeNs


@dataclass(frozen=True)
class Duplicate:
    """The frame is sent, and once more: requested again `after_ns` after its end."""

    after_ns: TimeNs = 0


@dataclass(frozen=True)
class Swap:
    """The frame is held back until the next frame of the same port has been sent."""


FaultAction = Drop | ErrorAtBit | Alter | Delay | Duplicate | Swap
FaultHook = Callable[[Frame, Controller, int], FaultAction | None]


@dataclass
class FrameFault:
    """Fault hook for the frames of one standard identifier; by itself it drops them all.

    act: makes the action for a frame that is hit. hits: which ones are. is_each_attempt: also asked
    about the repetitions of a frame.
    """

    cob_id: int
    act: Callable[[Frame, random.Random], FaultAction] = lambda _frame, _numbers: Drop()
    hits: Hits = field(default_factory=Hits)
    is_each_attempt: bool = False

    def __call__(self, frame: Frame, port: Controller, attempt: int) -> FaultAction | None:
        """Decide about one attempt."""
        if frame.arbitration_id != self.cob_id or frame.is_extended_id:
            return None
        if (attempt and not self.is_each_attempt) or not self.hits.falls():
            return None
        return self.act(frame, self.hits.numbers)
