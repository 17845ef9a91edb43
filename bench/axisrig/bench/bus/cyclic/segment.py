"""One segment whose images are swapped in each cycle at stated instants, whatever its frames are.

In cycle k, which begins at k T:

- drives have sampled their actual values at k T - T_I
- the images are swapped at k T + T_DX: what the control computed in cycle k - 1 is at the drives,
  what they have sampled is at the control
- drives take their set values at k T + T_O

T_I, T_DX and T_O are names of isochronous PROFIBUS (SIMODRIVE 611 universal); the instants are
whole nanoseconds.

Drives count cycles by their own clocks: when the control begins none any more, their cycles go on
half a period late, without an image, so that their watch over images acts.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from struct import Struct
from typing import Final, Protocol

from axisrig.kernel.time.clock import Clock, Phase, TimeNs

_HEAD: Final = Struct("<qHH")


@dataclass(frozen=True)
class Instants:
    """Of a cycle. input_ns: T_I, before its begin. bus_ns: T_DX, output_ns: T_O, after it.

    request_ns: from a request beside the cycle to its response.
    """

    period_ns: TimeNs
    input_ns: TimeNs = 0
    bus_ns: TimeNs = 0
    output_ns: TimeNs = 0
    request_ns: TimeNs = 0


class ImageNode(Protocol):
    """A drive on the segment. inputs: the image as it was sampled last, empty without power."""

    inputs: bytes

    def sample(self) -> None:
        """Sample the actual values."""
        ...

    def exchange(self, outputs: bytes | None) -> bytes:
        """Take an image and give the sampled one."""
        ...

    def cycle(self) -> None:
        """Take the set values of the image that came last."""
        ...


Received = Callable[[str, bytes], None]
Falls = Callable[[], bool]
"""Whether something falls on the image of this exchange."""
Answer = Callable[[bytes], bytes]
Losses = Callable[[str], bool]


class CyclicSegment:
    """Nodes by axis. received(axis, inputs): called at the exchange.

    exchanges: how many there were. loses: whether the image to a drive is lost in this cycle.
    lost, missed, late: faults by axis: the image to it is lost, that of it does not come, or that
    of the exchange before comes.
    """

    def __init__(
        self,
        clock: Clock,
        nodes: Mapping[str, ImageNode],
        instants: Instants,
        received: Received,
    ) -> None:
        self._clock, self._nodes, self._at, self._received = clock, nodes, instants, received
        self._hash = hashlib.sha256()
        self.exchanges = self._begun = 0
        self.loses: Losses = _never
        self.lost: dict[str, list[Falls]] = {axis: [] for axis in nodes}
        self.missed: dict[str, list[Falls]] = {axis: [] for axis in nodes}
        self.late: dict[str, list[Falls]] = {axis: [] for axis in nodes}
        self._before: dict[str, bytes] = {}

    def begin(self, outputs: Mapping[str, bytes | None]) -> None:
        """Begin a cycle. outputs: images to the drives, None where the control gives none."""
        clock, at = self._clock, self._at
        now_ns = clock.now_ns
        if at.input_ns:
            next_ns = now_ns + at.period_ns - at.input_ns
            clock.call_at(next_ns, Phase.APPLICATION, self._sample)
        else:
            self._sample()
        clock.call_at(now_ns + at.bus_ns, Phase.DELIVERY, lambda: self._exchange(outputs))
        clock.call_at(now_ns + at.output_ns, Phase.APPLICATION, self._cycle)
        self._begun += 1
        self._watch(self._begun, now_ns + at.period_ns + at.output_ns + at.period_ns // 2)

    def _watch(self, begun: int, at_ns: TimeNs) -> None:
        """Let the drives have a cycle then where no further one has begun, and so on."""

        def look() -> None:
            if self._begun == begun:
                self._cycle()
                self._watch(begun, at_ns + self._at.period_ns)

        self._clock.call_at(at_ns, Phase.APPLICATION, look)

    def _sample(self) -> None:
        for node in self._nodes.values():
            node.sample()

    def _exchange(self, outputs: Mapping[str, bytes | None]) -> None:
        self.exchanges += 1
        now_ns = self._clock.now_ns
        for axis, node in self._nodes.items():
            is_lost = _falls(self.lost[axis]) or self.loses(axis)
            sent = None if is_lost else outputs[axis]
            inputs = node.exchange(sent)
            self._hash.update(_HEAD.pack(now_ns, len(sent or b""), len(inputs)))
            self._hash.update((sent or b"") + inputs)
            came = self._before.get(axis, b"") if _falls(self.late[axis]) else inputs
            self._before[axis] = inputs
            self._received(axis, b"" if _falls(self.missed[axis]) else came)

    def _cycle(self) -> None:
        for node in self._nodes.values():
            node.cycle()

    def ask(self, answer: Answer, request: bytes, done: Callable[[bytes], None]) -> None:
        """Bring a request beside the cycle to a drive, and its response back.

        answer: of the drive, asked at half the time; an empty response is none.
        """
        clock, way_ns = self._clock, self._at.request_ns // 2
        back_ns = clock.now_ns + self._at.request_ns

        def at_drive() -> None:
            response = answer(request)
            self._hash.update(_HEAD.pack(clock.now_ns, len(request), len(response)))
            self._hash.update(request + response)
            clock.call_at(back_ns, Phase.DELIVERY, lambda: done(response))

        clock.call_at(clock.now_ns + way_ns, Phase.APPLICATION, at_drive)

    def hexdigest(self) -> str:
        """Return a hash of all images, as they were swapped: instant, lengths, contents."""
        return self._hash.hexdigest()


def _falls(faults: list[Falls]) -> bool:
    """Ask each fault, so that each counts its own images."""
    fallen = [falls() for falls in faults]
    return any(fallen)


def _never(_axis: str) -> bool:
    return False
