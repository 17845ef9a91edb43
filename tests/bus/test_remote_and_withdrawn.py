"""Remote frames, identifiers that only look alike, and requests that are taken back."""

from itertools import count

import can
import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.controller import QueueKind
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase


def test_remote_frames_reach_those_who_subscribed_to_them(segment: Segment) -> None:
    """Data frames do not, nor do extended remote frames with the same number."""
    heard: list[int] = []
    network = SimNetwork(segment.port("drive")).connect()
    asked = lambda: heard.append(segment.now_ns)  # noqa: E731
    network.subscribe_remote(0x703, asked)
    master = segment.port("master")
    for remote, extended, can_id in (
        (True, False, 0x703),
        (False, False, 0x703),
        (True, True, 0x703),
        (True, False, 0x704),
    ):
        master.send(
            can.Message(arbitration_id=can_id, is_remote_frame=remote, is_extended_id=extended)
        )
    segment.scheduler.run_until(2 * MS)
    assert len(heard) == 1
    network.unsubscribe_remote(0x703, asked)
    master.send(can.Message(arbitration_id=0x703, is_remote_frame=True, is_extended_id=False))
    segment.scheduler.run_until(3 * MS)
    assert len(heard) == 1


def test_who_is_called_of_a_remote_frame_may_leave_in_the_call(segment: Segment) -> None:
    """The others of the same identifier are called all the same, in the order they came in."""
    heard: list[str] = []
    network = SimNetwork(segment.port("drive")).connect()

    def once() -> None:
        heard.append("once")
        network.unsubscribe_remote(0x703, once)

    network.subscribe_remote(0x703, once)
    network.subscribe_remote(0x703, lambda: heard.append("always"))
    network.subscribe_remote(0x704, lambda: heard.append("another"))
    master = segment.port("master")
    for _ in range(2):
        master.send(can.Message(arbitration_id=0x703, is_remote_frame=True, is_extended_id=False))
    segment.scheduler.run_until(2 * MS)
    assert heard == ["once", "always", "always"]
    with pytest.raises(ValueError, match="not in list"):
        network.unsubscribe_remote(0x703, once)


@pytest.mark.parametrize("can_id", [0x183, 0x18FF0183])
@pytest.mark.parametrize("length", [0, 1, 8])
def test_a_remote_frame_asks_for_the_length_that_is_meant(
    segment: Segment, can_id: int, length: int
) -> None:
    """And carries no data: CAN 2.0, remote frame."""
    seen: list[Frame] = []
    segment.observe(lambda _time_ns, _name, frame, _is_error: seen.append(frame))
    segment.port("drive")  # which acknowledges
    network = SimNetwork(segment.port("master")).connect()
    network.send_message(can_id, bytes(length), remote=True)
    segment.scheduler.run_until(1 * MS)
    assert seen == [Frame(can_id, b"", can_id > 0x7FF, True, length)]


def test_extended_identifier_does_not_pass_for_a_short_one(segment: Segment) -> None:
    """29-bit 0x80 is no SYNC; 29-bit 0x18FF0080 is what it is."""
    heard: list[int] = []
    segment.port("drive").attach_data(lambda can_id, _data, _time: heard.append(can_id))
    master = segment.port("master")
    for can_id, extended in ((0x80, True), (0x18FF0080, True), (0x80, False)):
        master.send(can.Message(arbitration_id=can_id, is_extended_id=extended))
    segment.scheduler.run_until(1 * MS)
    assert heard == [0x18FF0080, 0x80]


@pytest.mark.parametrize("queue", ["fifo", "mailbox"])
def test_withdrawn_requests_are_not_sent_and_the_others_keep_their_order(
    segment: Segment, queue: str
) -> None:
    """The first request is on the wire when two identifiers are withdrawn."""
    heard: list[int] = []
    segment.port("other").attach_data(lambda can_id, _data, _time: heard.append(can_id))
    sender = segment.port("sender", queue)  # type: ignore[arg-type]
    numbers = count()
    for can_id in (0x181, 0x181, 0x300, 0x281, 0x200, 0x181):
        sender.send_raw(can_id, bytes((next(numbers),)))
    segment.scheduler.run_until(10_000)
    sender.withdraw({0x181, 0x281})
    segment.scheduler.run_until(2 * MS)
    assert heard == [0x181, *([0x300, 0x200] if queue == "fifo" else [0x200, 0x300])]


@pytest.mark.parametrize("queue", ["fifo", "mailbox"])
@pytest.mark.parametrize("taken", [0x100, 0x150, 0x300])
def test_what_is_left_after_a_withdrawal_goes_in_the_order_of_its_queue(
    segment: Segment, queue: QueueKind, taken: int
) -> None:
    """Of mailboxes the lowest identifier first, whichever has been taken out of them."""
    sender, other = segment.port("sender", queue), segment.port("other")
    heard: list[int] = []
    other.attach_data(lambda can_id, _data, _time: heard.append(can_id))
    asked = [0x300, 0x100, 0x200, 0x150, 0x250, 0x120]

    def request() -> None:
        for can_id in asked:
            sender.send_raw(can_id, b"")
        sender.withdraw({taken, 0x7FF})

    segment.scheduler.call_at(MS, Phase.APPLICATION, request)
    segment.scheduler.run_until(3 * MS)
    left = [can_id for can_id in asked if can_id != taken]
    assert heard == (left if queue == "fifo" else sorted(left))
