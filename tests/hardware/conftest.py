"""A clock of real time that only the test moves, and an interface whose frames it writes down."""

from collections import deque
from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import PacedScheduler, Pacing, RealTime

US, MS = 1_000, 1_000_000


class Wall:
    """Real time. Asking costs 1 us; `stall_ns` is lost, once, at the instant `stall_at_ns`."""

    def __init__(self) -> None:
        self.now_ns = 7_000_000_000
        self.stalls: dict[int, int] = {}

    def monotonic_ns(self) -> int:
        self.now_ns += US
        for at_ns in [at for at in self.stalls if at <= self.now_ns]:
            self.now_ns += self.stalls.pop(at_ns)
        return self.now_ns

    def pause(self, seconds: float) -> None:
        self.now_ns += round(seconds * 1e9)

    def stall(self, after_ns: int, for_ns: int) -> None:
        """Let the computer do something else, `after_ns` from now."""
        self.stalls[self.now_ns + after_ns] = for_ns


class Adapter(can.BusABC):
    """An interface: `coming` are frames with their instant of real time, `sent` what went out."""

    def __init__(self, wall: Wall) -> None:
        self.wall = wall
        self.coming: deque[tuple[int, can.Message]] = deque()
        self.sent: list[tuple[int, can.Message]] = []
        self.answer: Callable[[can.Message], list[tuple[int, can.Message]]] = lambda _msg: []
        self.broken: Exception | None = None
        super().__init__(channel="test")

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.broken:
            raise self.broken
        self.sent.append((self.wall.now_ns, msg))
        for delay_ns, answer in self.answer(msg):
            self.coming.append((self.wall.now_ns + delay_ns, answer))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        if self.broken:
            raise self.broken
        end_ns = self.wall.now_ns + round((timeout or 0.0) * 1e9)
        if self.coming and self.coming[0][0] <= end_ns:
            time_ns, msg = self.coming.popleft()
            self.wall.now_ns = max(self.wall.now_ns, time_ns)
            return msg
        self.wall.now_ns = max(self.wall.now_ns, end_ns)
        return None


def frame(can_id: int, *data: int) -> can.Message:
    return can.Message(arbitration_id=can_id, is_extended_id=False, data=bytes(data))


class Bench:
    """A paced scheduler with one segment on an `Adapter`."""

    def __init__(self, pacing: Pacing) -> None:
        self.wall = Wall()
        self.adapter = Adapter(self.wall)
        self.deadlines = Deadlines(late_ns=100 * US)
        real_time = RealTime(self.wall.monotonic_ns, self.wall.pause)
        self.scheduler = PacedScheduler(real_time, pacing, self.deadlines)
        self.openings = 0
        self.segment = OutsideSegment("out", 1_000_000, self.scheduler, self._open)

    def _open(self) -> can.BusABC:
        self.openings += 1
        return self.adapter

    def sent_ids(self) -> list[int]:
        return [msg.arbitration_id for _, msg in self.adapter.sent]


MakeBench = Callable[..., Bench]


@pytest.fixture
def make_bench(request: pytest.FixtureRequest) -> MakeBench:
    """Return `make(slip_ns=..., wait_ns=..., ...)`; what it makes is closed at the end."""

    def make(**pacing: object) -> Bench:
        made = Bench(Pacing(**{"slip_ns": 250 * US, **pacing}))  # type: ignore[arg-type]
        request.addfinalizer(made.segment.close)
        return made

    return make


@pytest.fixture
def make_frame() -> Callable[..., can.Message]:
    """Return `make(identifier, *bytes)`."""
    return frame
