"""Which frames and which controllers a fault of the wire hits, and whose counts it leaves alone."""

from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import Alter, Drop, ErrorAtBit, FaultAction, FrameFault
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS

Hook = Callable[[Frame, Controller, int], FaultAction | None]


def _send(segment: Segment, port: can.BusABC, can_id: int, *, extended: bool = False) -> None:
    port.send(can.Message(arbitration_id=can_id, is_extended_id=extended, data=b"\x01\x02"))
    segment.scheduler.run_until(segment.now_ns + MS)


def test_who_misses_a_frame_counts_it_neither_as_received_nor_as_an_error(
    segment: Segment,
) -> None:
    """Six errors, then frames that one of two receivers does not get: it keeps its count."""
    sender, near, far = (segment.port(name) for name in ("sender", "near", "far"))
    for port in (near, far):
        port.attach_data(lambda _id, _data, _time: None)
    errors = [6]

    def hook(frame: Frame, port: Controller, attempt: int) -> FaultAction | None:
        if errors[0]:
            errors[0] -= 1
            return ErrorAtBit(20)
        return Drop(frozenset({"far"})) if frame.arbitration_id == 0x200 else None

    segment.add_fault(hook)
    _send(segment, sender, 0x100)
    assert (sender.tec, near.rec, far.rec) == (47, 5, 5)  # 6 errors, and the frame got through
    for number in range(1, 4):
        _send(segment, sender, 0x200)
        assert (sender.tec, near.rec, far.rec) == (47 - number, 5 - number, 5)
    _send(segment, sender, 0x100)
    assert (near.rec, far.rec) == (1, 4)


@pytest.mark.parametrize("of_it", ["drop", "alter"])
def test_a_fault_of_an_identifier_is_of_its_11_bits(segment: Segment, of_it: str) -> None:
    """The extended frame with the same number is another one."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    heard: list[tuple[int, bool, bytes]] = []
    receiver.attach(lambda m: heard.append((m.arbitration_id, m.is_extended_id, bytes(m.data))))
    if of_it == "drop":
        segment.add_fault(FrameFault(0x183))
    else:
        segment.add_fault(FrameFault(0x183, lambda frame, _: Alter(frame.data[::-1])))
    for can_id, extended in ((0x183, False), (0x183, True), (0x184, False)):
        _send(segment, sender, can_id, extended=extended)
    hit = [] if of_it == "drop" else [(0x183, False, b"\x02\x01")]
    assert heard == [*hit, (0x183, True, b"\x01\x02"), (0x184, False, b"\x01\x02")]


def test_a_frame_that_is_dropped_for_all_reaches_nobody_and_is_sent_once(segment: Segment) -> None:
    ports = [segment.port(name) for name in ("sender", "one", "two")]
    heard: list[int] = []
    for port in ports[1:]:
        port.attach_data(lambda can_id, _data, _time: heard.append(can_id))
    segment.add_fault(FrameFault(0x183))
    for can_id in (0x183, 0x184):
        _send(segment, ports[0], can_id)
    assert heard == [0x184, 0x184]
    assert [port.tec + port.rec for port in ports] == [0, 0, 0]
    assert segment.load().frames == 2
