"""Nodes that lose their power in a frame that would fail anyway, or that another sends too.

At 1 Mbit/s one bit is 1000 ns. A node that loses its power leaves a stuff error: 6 recessive bits
later come a flag of 6 and a delimiter of 8 bits (docs/can.md). SYNC has 48 bits, 38 of them up to
the end of its check sum.
"""

from collections.abc import Callable

import pytest
from tests.bus.conftest import fails

from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]


@pytest.mark.parametrize("bit", [48, 999])
@pytest.mark.parametrize("cut", [1, 2, 19, 33, 38])
def test_a_frame_that_lost_its_sender_is_not_delivered_at_its_last_bit(
    scheduler: Scheduler, segment: Segment, watch: Watch, cut: int, bit: int
) -> None:
    """Its receivers count an error, and the sender has none to count."""
    frames = watch(segment)
    sender, receiver, other = (segment.port(name) for name in ("sender", "receiver", "other"))
    segment.add_fault(fails(1, bit))
    sender.send_raw(0x080, b"")
    scheduler.call_at(cut * 1000 - 500, Phase.APPLICATION, sender.power_off)
    scheduler.run_until(MS)
    assert frames == [((cut + 20) * 1000, 0x080, "error")]
    assert (receiver.rec, other.rec, sender.tec) == (1, 1, 0)
    assert receiver.recv(0) is None
    assert segment.load().frames == 0


def test_a_frame_that_lost_its_sender_behind_the_check_sum_is_delivered_all_the_same(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    frames = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.port("other")
    segment.add_fault(fails(1, 48))
    sender.send_raw(0x080, b"")
    scheduler.call_at(38_500, Phase.APPLICATION, sender.power_off)
    scheduler.run_until(MS)
    assert frames[0] == (48_000, 0x080, "data")
    assert receiver.recv(0) is not None
    assert receiver.recv(0) is None


@pytest.mark.parametrize(
    ("cut", "bit", "found_by", "ends"),
    [
        (10, 30, None, 10 + 20),  # the missing bits come first
        (10, 17, None, 10 + 20),
        (10, 16, None, 16 + 14),  # in the same bit: the error that was due
        (12, 14, None, 14 + 14),
        (20, 14, None, 14 + 14),  # in the flag
        (10, 30, {"other"}, 10 + 20),
        (20, 14, {"other"}, 14 + 20),  # flags one behind the other
    ],
)
def test_the_first_of_two_errors_ends_a_frame(
    scheduler: Scheduler,
    segment: Segment,
    watch: Watch,
    cut: int,
    bit: int,
    found_by: set[str] | None,
    ends: int,
) -> None:
    frames = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.port("other")
    action = ErrorAtBit(bit, None if found_by is None else frozenset(found_by))
    segment.add_fault(lambda frame, port, attempt: action)
    sender.send_raw(0x080, b"")
    scheduler.call_at(cut * 1000 - 500, Phase.APPLICATION, sender.power_off)
    scheduler.run_until(MS)
    assert frames == [(ends * 1000, 0x080, "error")]
    assert receiver.recv(0) is None
    sender.power_on()
    scheduler.run_until(2 * MS)
    assert len(frames) == 1  # it is not sent again


@pytest.mark.parametrize("order", ["ab", "ba"])
@pytest.mark.parametrize("lost", ["a", "b"])
def test_a_frame_that_another_sends_too_goes_on(
    scheduler: Scheduler, segment: Segment, watch: Watch, order: str, lost: str
) -> None:
    """Both send the same bits: the line does not miss those of one."""
    frames = watch(segment)
    ports = {name: segment.port(name) for name in order}
    receiver = segment.port("receiver")
    for port in ports.values():
        port.send_raw(0x080, b"")
    scheduler.call_at(19_500, Phase.APPLICATION, ports[lost].power_off)
    scheduler.run_until(MS)
    assert frames == [(48_000, 0x080, "data")]
    assert receiver.recv(0) is not None
    assert (receiver.rec, segment.load().error_frames) == (0, 0)


@pytest.mark.parametrize("order", ["ab", "ba"])
def test_a_frame_of_two_ends_with_the_second_of_them(
    scheduler: Scheduler, segment: Segment, watch: Watch, order: str
) -> None:
    frames = watch(segment)
    ports = {name: segment.port(name) for name in "ab"}
    receiver, other = segment.port("receiver"), segment.port("other")
    for port in ports.values():
        port.send_raw(0x080, b"")
    for number, name in enumerate(order):
        at_ns = 9_500 + 10_000 * number
        scheduler.call_at(at_ns, Phase.APPLICATION, ports[name].power_off)
    scheduler.run_until(MS)
    assert frames == [(40_000, 0x080, "error")]
    assert (receiver.rec, other.rec) == (1, 1)
    assert receiver.recv(0) is None
