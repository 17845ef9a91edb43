"""Random traffic with random errors: what must hold whatever happens on the wire.

The reference is a model of its own: it follows the wire as an observer sees it, counts errors by
the rules of ISO 11898-1, and knows nothing of how the segment works.
"""

import random
from dataclasses import dataclass, field
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import new_scheduler

PORTS = 4
REQUESTS = st.lists(
    st.tuples(
        st.integers(0, PORTS - 1),  # port
        st.integers(0, 3000),  # us
        st.integers(0, 0x3FF),  # identifier, the same one from several ports as well
        st.integers(0, 8),  # bytes
    ),
    max_size=60,
)


@dataclass
class Model:
    """tec, rec per port name, as an observer of the wire counts them."""

    names: list[str]
    tec: dict[str, int] = field(default_factory=dict)
    rec: dict[str, int] = field(default_factory=dict)
    before: int = 0

    def __post_init__(self) -> None:
        self.tec, self.rec = dict.fromkeys(self.names, 0), dict.fromkeys(self.names, 0)

    def failed(self, sender: str) -> None:
        for name in self.names:
            if name == sender:
                self.tec[name] += 8
            else:
                self.rec[name] += 1

    def failed_late(self, sender: str) -> None:
        """Take back that the sender had got it through; the receivers have it."""
        self.tec[sender] = self.before + 8

    def passed(self, sender: str) -> None:
        self.before = self.tec[sender]
        for name in self.names:
            if name == sender:
                self.tec[name] = max(0, self.tec[name] - 1)
            elif self.rec[name] > 127:
                self.rec[name] = 127
            else:
                self.rec[name] = max(0, self.rec[name] - 1)


@dataclass
class Play:
    """One random scenario: what was asked for, what passed, who started when."""

    requests: list[tuple[int, int, Frame]]
    share: float
    seed: int
    queues: str
    passed: list[tuple[int, int, Frame]] = field(default_factory=list)
    heard: list[tuple[int, Frame]] = field(default_factory=list)

    def run(self) -> None:
        """Play it with unique data, so that every frame can be told from every other."""
        scheduler, numbers = new_scheduler(), random.Random(self.seed)
        with Segment("random", 1_000_000, scheduler) as segment:
            kinds = ["fifo" if kind == "f" else "mailbox" for kind in self.queues]
            ports = [segment.port(f"p{n}", kinds[n]) for n in range(PORTS)]  # type: ignore[arg-type]
            model = Model([port.port_name for port in ports])
            attempts: list[tuple[Controller, Frame, int]] = []
            got: list[list[Frame]] = [[] for _ in ports]
            found = [0]  # attempts made when a frame got through

            def hook(frame: Frame, port: Controller, attempt: int) -> ErrorAtBit | None:
                check_arbitration(frame, port, ports)
                attempts.append((port, frame, attempt))
                hit = attempt < 3 and numbers.random() < self.share
                return ErrorAtBit(numbers.randint(1, 140)) if hit else None

            def watch(time_ns: int, _name: str, frame: Frame, is_error: bool) -> None:
                port, wanted, _ = attempts[-1]
                assert frame.arbitration_id == wanted.arbitration_id
                name, index = port.port_name, int(port.port_name[1:])
                if is_error and found[-1] == len(attempts):
                    self.passed.pop()  # an error in its last bit: it will come once more
                    model.failed_late(name)
                elif is_error:
                    model.failed(name)
                else:
                    assert frame == wanted
                    model.passed(name)
                    found.append(len(attempts))
                    self.passed.append((time_ns, index, frame))
                    self.heard.append((index, frame))

            segment.add_fault(hook)
            segment.observe(watch)
            for port, heard in zip(ports, got, strict=True):
                port.attach_data(lambda i, d, _, heard=heard: heard.append(data_frame(i, d)))
            for index, time_ns, frame in self.requests:
                scheduler.call_at(
                    time_ns,
                    Phase.APPLICATION,
                    lambda port=ports[index], frame=frame: port.send_raw(
                        frame.arbitration_id, frame.data
                    ),
                )
            scheduler.run_until(60 * MS)
            counts = {port.port_name: (port.tec, port.rec) for port in ports}
            assert counts == {name: (model.tec[name], model.rec[name]) for name in model.names}
            for index, heard in enumerate(got):
                assert heard == [frame for sender, frame in self.heard if sender != index]


def check_arbitration(frame: Frame, winner: Controller, ports: list[SimBus]) -> None:
    """No other port has a smaller identifier at the head of its queue, unless it is suspended."""
    for port in ports:
        if port.pending and port is not winner and port.error_state is ErrorState.ACTIVE:
            assert frame.arbitration_id < port.pending[0][4].arbitration_id


def frames_of(requests: list[tuple[int, int, int, int]]) -> list[tuple[int, int, Frame]]:
    """Make them unique: the identifier says the port, the first bytes say which request it is."""
    made = []
    for number, (port, at_us, can_id, size) in enumerate(requests):
        data = number.to_bytes(2, "big") + bytes(max(size - 2, 0))
        made.append((port, at_us * 1000, data_frame(can_id // PORTS * PORTS + port, data)))
    return made


@pytest.mark.long
@settings(deadline=None)
@given(
    REQUESTS,
    st.sampled_from([0.0, 0.05, 0.3]),
    st.integers(0, 99),
    st.sampled_from(["ffff", "mmmm", "fmfm"]),
)
def test_nothing_is_lost_doubled_or_out_of_order(
    requests: list[tuple[int, int, int, int]], share: float, seed: int, queues: str
) -> None:
    """Every request passes once; a FIFO keeps its order, a mailbox that of equal identifiers."""
    play = Play(frames_of(requests), share, seed, queues)
    play.run()
    assert sorted(frame for *_, frame in play.passed) == sorted(f for *_, f in play.requests)
    for index in range(PORTS):
        asked = sorted(
            ((t, n, f) for n, (p, t, f) in enumerate(play.requests) if p == index),
            key=lambda item: item[:2],
        )
        sent = [frame for _, port, frame in play.passed if port == index]
        if queues[index] == "f":
            assert sent == [frame for *_, frame in asked]
        for can_id in {frame.arbitration_id for frame in sent}:
            assert [f for f in sent if f.arbitration_id == can_id] == [
                f for *_, f in asked if f.arbitration_id == can_id
            ]
    assert all(later - earlier >= 44_000 for (earlier, *_), (later, *_) in pairwise(play.passed))
