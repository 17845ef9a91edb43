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


class Window:
    """Whether a fault acts now; `begin` and `end` are called by the code that has the moment."""

    def __init__(self, is_open: bool = True) -> None:
        self.is_open = is_open

    def begin(self) -> None:
        """Let the fault act from now on."""
        self.is_open = True

    def end(self) -> None:
        """Let it act no more."""
        self.is_open = False


@dataclass
class FrameFault:
    """Fault hook for the frames of one standard identifier; by itself it drops them all.

    act: makes the action for a frame that is hit. window: while it is open, and counting goes by
    it. share: probability 0..1 per frame. skip: so many frames pass first. count: at most so many
    are hit, None = no limit. is_each_attempt: also asked about the repetitions of a frame.
    numbers: the random numbers of this fault alone.
    """

    cob_id: int
    act: Callable[[Frame, random.Random], FaultAction] = lambda _frame, _numbers: Drop()
    window: Window = field(default_factory=Window)
    numbers: random.Random = field(default_factory=lambda: random.Random(0))
    share: float = 1.0
    skip: int = 0
    count: int | None = None
    is_each_attempt: bool = False

    def __call__(self, frame: Frame, port: Controller, attempt: int) -> FaultAction | None:
        """Decide about one attempt."""
        if frame.arbitration_id != self.cob_id or frame.is_extended_id or not self.window.is_open:
            return None
        if (attempt and not self.is_each_attempt) or self.count == 0:
            return None
        # Drawn even when not needed: the choice hangs on a frame's place in the sequence only
        is_hit = self.numbers.random() < self.share
        if self.skip:
            self.skip -= 1
            return None
        if not is_hit:
            return None
        if self.count is not None:
            self.count -= 1
        return self.act(frame, self.numbers)
