"""What can go wrong with a frame on the wire, decided by hooks that a segment asks.

A hook sees every attempt to send: `hook(frame, port, attempt)` with `attempt` counting from 0 for
the same request. It answers None (nothing wrong) or an action. The first hook that answers
decides.
"""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

from bench.bus.frame import EXTENDED_ID_MAX, STANDARD_ID_MAX, Frame
from kernel.errors import UserError

if TYPE_CHECKING:
    from bench.bus.simbus import SimBus


@dataclass(frozen=True)
class Drop:
    """The frame passes over the wire and is logged, but no receiver gets it.

    The sender takes it for sent.
    """


@dataclass(frozen=True)
class ErrorAtBit:
    """The frame is destroyed: `bit` bits of it are sent (1 = SOF, stuff bits count), then the flag.

    Every node sees the error at the same bit, so the error frame is one active flag of 6 bits and
    the delimiter of 8. The sender tries again by itself after the intermission. A `bit` beyond
    the end of frame destroys the last bit. Source: Bosch CAN 2.0 part A, 3.1.3 and 6.1.
    """

    bit: int

    def __post_init__(self) -> None:
        if self.bit < 1:
            raise ValueError(f"bit {self.bit}: the first bit of a frame is 1")


FaultAction = Drop | ErrorAtBit
FaultHook = Callable[[Frame, "SimBus", int], FaultAction | None]


@dataclass
class DropById:
    """Fault hook that drops frames of one identifier.

    cob_id: identifier (above 0x7FF an extended one). share: probability 0..1 per frame.
    skip: so many frames pass first. count: at most so many are dropped, None = no limit.
    seed: of this hook's own random numbers; the same seed drops the same frames.
    """

    cob_id: int
    share: float = 1.0
    skip: int = 0
    count: int | None = None
    seed: int = 0
    _seen: int = field(default=0, init=False, repr=False)
    _dropped: int = field(default=0, init=False, repr=False)

    def __post_init__(self) -> None:
        if not 0 <= self.cob_id <= EXTENDED_ID_MAX:
            raise UserError("no CAN identifier", value=self.cob_id, allowed="0 .. 0x1FFFFFFF")
        if not 0.0 <= self.share <= 1.0:
            raise UserError("no probability", value=self.share, allowed="0 .. 1")
        self._random = random.Random(self.seed)

    @classmethod
    def from_data(cls, data: Mapping[str, object]) -> "DropById":
        """Build from names and values as a table holds them; numbers may be text ("0x281").

        Raises UserError for an unknown name or a value that is no number.
        """
        known = {item.name for item in fields(cls) if item.init}
        if unknown := sorted(set(data) - known):
            raise UserError("unknown setting of a drop", value=unknown[0], allowed=sorted(known))
        if "cob_id" not in data:
            raise UserError("a drop needs an identifier", allowed=sorted(known))
        try:
            share = float(str(data.get("share", 1.0)))
            count = None if data.get("count") is None else int(str(data["count"]), 0)
            numbers = {name: int(str(data.get(name, 0)), 0) for name in ("cob_id", "skip", "seed")}
        except ValueError as error:
            raise UserError("a setting of a drop is no number", value=dict(data)) from error
        return cls(share=share, count=count, **numbers)

    def __call__(self, frame: Frame, port: "SimBus", attempt: int) -> FaultAction | None:
        """Decide about one attempt."""
        same_format = frame.is_extended_id == (self.cob_id > STANDARD_ID_MAX)
        if frame.arbitration_id != self.cob_id or not same_format:
            return None
        self._seen += 1
        # One number per frame, drawn even when not needed: the choice for a frame must depend on
        # its place in the sequence only.
        hit = self._random.random() < self.share
        exhausted = self.count is not None and self._dropped >= self.count
        if self._seen <= self.skip or exhausted or not hit:
            return None
        self._dropped += 1
        return Drop()
