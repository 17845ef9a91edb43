"""Error counts that differ between the ports of a bus run down to 0, each by the frames it sees."""

from axisrig.bench.bus.can.faults import ErrorAtBit, FrameFault
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.hits import Hits
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler


def test_a_receiver_counts_down_after_the_sender_has_none(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Who sees an error first has 9, the sender 8: the ninth good frame counts for it alone."""
    sender, first, other = (segment.port(name) for name in ("sender", "first", "other"))
    segment.add_fault(
        FrameFault(
            0x181,
            lambda _frame, _numbers: ErrorAtBit(20, frozenset({"first"})),
            Hits(count=1),
        )
    )
    counts = []
    for number in range(1, 11):
        sender.send_raw(0x181, b"")
        scheduler.run_until(number * MS)
        counts.append((sender.tec, first.rec, other.rec))
    expected = [(8 - min(n, 8), 9 - min(n, 9), 0) for n in range(1, 11)]
    assert counts == expected


def test_a_sender_counts_down_after_its_receivers_have_none(
    scheduler: Scheduler, segment: Segment
) -> None:
    """An error that all see costs it 8, and the frame itself takes one of them away."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.add_fault(FrameFault(0x181, lambda _frame, _numbers: ErrorAtBit(20), Hits(count=1)))
    counts = []
    for number in range(1, 10):
        sender.send_raw(0x181, b"")
        scheduler.run_until(number * MS)
        counts.append((sender.tec, receiver.rec))
    assert counts == [(8 - min(n, 8), 0) for n in range(1, 10)]


def test_a_repetition_uses_up_nothing_of_what_a_fault_may_hit(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Two of three frames are hit, each at its first attempt: 16 - 3 good frames of the sender."""
    sender = segment.port("sender")
    segment.port("receiver")
    hit = FrameFault(0x181, lambda _frame, _numbers: ErrorAtBit(20), Hits(count=2))
    asked: list[tuple[int, bool]] = []
    segment.add_fault(
        lambda frame, port, attempt: (
            asked.append((attempt, (found := hit(frame, port, attempt)) is not None)) or found
        )
    )
    for number in range(1, 4):
        sender.send_raw(0x181, bytes([number]))
        scheduler.run_until(number * MS)
    assert asked == [(0, True), (1, False), (0, True), (1, False), (0, False)]
    assert sender.tec == 2 * 8 - 3


def test_skipped_frames_are_frames_not_attempts(scheduler: Scheduler, segment: Segment) -> None:
    """Another fault destroys the first frame once; of the two that pass it is one all the same."""
    sender = segment.port("sender")
    segment.port("receiver")
    hit = FrameFault(0x181, lambda _frame, _numbers: ErrorAtBit(30), Hits(skip=2, count=1))
    asked: list[tuple[int, int]] = []

    def both(frame: object, port: object, attempt: int) -> ErrorAtBit | None:
        found = hit(frame, port, attempt)  # type: ignore[arg-type]
        if found is None and frame[1] == b"\1" and attempt == 0:  # type: ignore[index]
            found = ErrorAtBit(20)
        asked.append((attempt, 0 if found is None else found.bit))  # type: ignore[union-attr]
        return found  # type: ignore[return-value]

    segment.add_fault(both)
    for number in range(1, 4):
        sender.send_raw(0x181, bytes([number]))
        scheduler.run_until(number * MS)
    assert asked == [(0, 20), (1, 0), (0, 0), (0, 30), (1, 0)]


def test_a_fault_of_each_attempt_hits_the_repetitions_too(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Three attempts fail, the fourth gets through: 3 times 8 less 1; the next frame is whole."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.add_fault(
        FrameFault(
            0x181, lambda _frame, _numbers: ErrorAtBit(20), Hits(count=3), is_each_attempt=True
        )
    )
    sender.send_raw(0x181, b"\1")
    scheduler.run_until(MS)
    assert (sender.tec, receiver.rec) == (3 * 8 - 1, 3 - 1)
    sender.send_raw(0x181, b"\2")
    scheduler.run_until(2 * MS)
    assert (sender.tec, receiver.rec) == (3 * 8 - 2, 3 - 2)
    assert segment.load().error_frames == 3


def test_two_senders_of_the_same_frame_count_it_both(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Same bits at the same instant: nobody loses. An error costs each 8, each good frame gives
    1 back to each; a third port counts as a receiver."""
    one, two = segment.port("one"), segment.port("two")
    other = segment.port("other")
    segment.add_fault(FrameFault(0x181, lambda _frame, _numbers: ErrorAtBit(20), Hits(count=1)))
    counts = []
    for number in range(1, 11):
        for port in (one, two):
            port.send_raw(0x181, b"same")
        scheduler.run_until(number * MS)
        counts.append((one.tec, two.tec, other.rec))
    assert counts == [(8 - min(n, 8), 8 - min(n, 8), 0) for n in range(1, 11)]
    assert segment.load().frames == 10


def test_one_of_two_senders_goes_on_counting_when_the_other_sends_no_more(
    scheduler: Scheduler, segment: Segment
) -> None:
    """A receiver of the frames of the other: its transmit count stays."""
    one, two, _ = (segment.port(name) for name in ("one", "two", "other"))
    segment.add_fault(FrameFault(0x181, lambda _frame, _numbers: ErrorAtBit(20), Hits(count=1)))
    for port in (one, two):
        port.send_raw(0x181, b"same")
    scheduler.run_until(MS)
    for number in range(2, 6):
        two.send_raw(0x181, b"two")
        scheduler.run_until(number * MS)
    assert (one.tec, two.tec) == (7, 3)
    assert (one.rec, two.rec) == (0, 0)
