"""Frames that get lost or destroyed, at 1 Mbit/s: one bit is 1000 ns."""

import random
from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FrameFault,
    Swap,
)
from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.hits import Hits
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]


def test_dropped_frame_takes_its_time_and_reaches_nobody(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.add_fault(lambda frame, port, attempt: Drop() if frame.dlc == 0 else None)
    sender.send_raw(0x080, b"")
    sender.send_raw(0x081, b"\x00")
    scheduler.run_until(MS)
    received = receiver.recv(0)
    assert received is not None
    assert received.arbitration_id == 0x081
    assert receiver.recv(0) is None
    assert seen[0] == (48_000, 0x080, "data")
    assert [can_id for _, can_id, _ in seen] == [0x080, 0x081]


def test_error_frame_and_automatic_retransmission(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """20 bits of the frame, 6 of flag, 8 of delimiter, 3 of intermission, then 48 bits of SYNC."""
    seen = watch(segment)
    attempts: list[tuple[str, int]] = []

    def hook(frame: Frame, port: SimBus, attempt: int) -> ErrorAtBit | None:
        attempts.append((port.port_name, attempt))
        return ErrorAtBit(20) if attempt == 0 else None

    segment.add_fault(hook)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert seen == [(34_000, 0x080, "error"), (37_000 + 48_000, 0x080, "data")]
    assert attempts == [("sender", 0), ("sender", 1)]
    received = receiver.recv(0)
    assert received is not None
    assert not received.is_error_frame
    load = segment.load()
    assert (load.frames, load.error_frames, load.busy_bits) == (1, 1, 20 + 14 + 3 + 51)
    assert load.worst_delay_ns == {0x080: 37_000}


def test_retransmission_competes_again(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    segment.add_fault(
        lambda frame, port, attempt: (
            ErrorAtBit(40) if (frame.arbitration_id, attempt) == (0x300, 0) else None
        )
    )
    low, high = segment.port("low"), segment.port("high")
    low.send_raw(0x300, b"")
    low.send_raw(0x100, b"")
    scheduler.call_at(10_000, Phase.APPLICATION, lambda: high.send_raw(0x200, b""))
    scheduler.run_until(MS)
    kinds = [(can_id, kind) for _, can_id, kind in seen]
    assert kinds == [(0x300, "error"), (0x200, "data"), (0x300, "data"), (0x100, "data")]


def test_bit_of_an_error_counts_from_one() -> None:
    with pytest.raises(ValueError, match="first bit"):
        ErrorAtBit(0)


def first_time(can_id: int, action: FaultAction) -> Callable[..., FaultAction | None]:
    """A hook that does `action` to the first attempt of every frame with this identifier."""
    return lambda frame, port, attempt: (
        action if (frame.arbitration_id, attempt) == (can_id, 0) else None
    )


def test_a_frame_can_be_lost_for_one_receiver_only(scheduler: Scheduler, segment: Segment) -> None:
    sender, deaf, other = (segment.port(name) for name in ("sender", "deaf", "other"))
    segment.add_fault(first_time(0x080, Drop(frozenset({"deaf"}))))
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert deaf.recv(0) is None
    assert other.recv(0) is not None


def test_altered_data_travels_with_a_check_sum_that_fits(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """No error frame: the length on the wire is that of the altered data, stuff bits and all."""
    seen = watch(segment)
    segment.add_fault(first_time(0x181, Alter(b"\x55\x02")))
    sender, receiver = segment.port("sender"), segment.port("receiver")
    sender.send_raw(0x181, b"\x01\x02")
    scheduler.run_until(MS)
    received = receiver.recv(0)
    assert received is not None
    assert bytes(received.data) == b"\x55\x02"
    assert [kind for *_, kind in seen] == ["data"]
    bits = frame_bits(Frame(0x181, b"\x55\x02", False, False, 2))
    assert seen[0][0] == (bits - 3) * 1000


def test_a_delayed_frame_leaves_the_bus_to_others(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Put back after 300 us; the next of its queue goes meanwhile, and it comes only once."""
    seen = watch(segment)
    segment.add_fault(first_time(0x181, Delay(300_000)))
    sender = segment.port("sender")
    segment.port("receiver")
    sender.send_raw(0x181, b"")
    sender.send_raw(0x281, b"")
    scheduler.run_until(MS)
    assert [can_id for _, can_id, _ in seen] == [0x281, 0x181]
    bits = frame_bits(Frame(0x181, b"", False, False, 0))
    assert seen[1][0] == 300_000 + (bits - 3) * 1000


def test_a_duplicate_follows_its_original(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    segment.add_fault(first_time(0x080, Duplicate(after_ns=100_000)))
    sender = segment.port("sender")
    segment.port("receiver")
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert seen == [(48_000, 0x080, "data"), (48_000 + 100_000 + 48_000, 0x080, "data")]


def test_swapped_frames_change_places(scheduler: Scheduler, segment: Segment, watch: Watch) -> None:
    """The first waits for the second of its port; frames of other ports do not release it."""
    seen = watch(segment)
    segment.add_fault(first_time(0x181, Swap()))
    drive, other = segment.port("drive"), segment.port("other")
    drive.send_raw(0x181, b"")
    other.send_raw(0x182, b"")
    scheduler.run_until(MS)
    drive.send_raw(0x281, b"")
    scheduler.run_until(2 * MS)
    assert [can_id for _, can_id, _ in seen] == [0x182, 0x281, 0x181]


def test_frames_of_several_ports_that_are_held_back_wait_each_for_its_own_port(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Of one port one frame waits at most: a second one is sent, and lets the first one go."""
    on_bus = watch(segment)
    held = {0x181, 0x182, 0x281}
    segment.add_fault(
        lambda frame, _, attempt: Swap() if frame[0] in held and not attempt else None
    )
    x, y = segment.port("x"), segment.port("y")
    x.send_raw(0x181, b"")
    y.send_raw(0x182, b"")
    scheduler.run_until(MS)
    assert on_bus == []
    y.send_raw(0x282, b"")
    scheduler.run_until(2 * MS)
    x.send_raw(0x281, b"")
    scheduler.run_until(3 * MS)
    assert [can_id for _, can_id, _ in on_bus] == [0x282, 0x182, 0x281, 0x181]


def test_a_port_without_power_takes_along_what_is_held_back_of_it_alone(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    on_bus = watch(segment)
    segment.add_fault(
        lambda frame, _, attempt: Swap() if frame[0] in (0x181, 0x182) and not attempt else None
    )
    x, y = segment.port("x"), segment.port("y")
    segment.port("listener")
    x.send_raw(0x181, b"")
    y.send_raw(0x182, b"")
    scheduler.run_until(MS)
    x.power_off()
    x.power_on()
    for port, can_id in ((x, 0x281), (y, 0x282)):
        port.send_raw(can_id, b"")
    scheduler.run_until(2 * MS)
    assert [can_id for _, can_id, _ in on_bus] == [0x281, 0x282, 0x182]


@pytest.mark.parametrize("is_each_attempt", [False, True])
def test_a_fault_counts_frames_or_each_attempt_to_send_them(
    scheduler: Scheduler, segment: Segment, watch: Watch, is_each_attempt: bool
) -> None:
    """Two hits destroy two frames once each, or the first one twice; others count for none."""
    on_bus = watch(segment)
    fault = FrameFault(0x181, lambda *_: ErrorAtBit(20), Hits(count=2), is_each_attempt)
    segment.add_fault(fault)
    segment.port("listener")
    sender = segment.port("sender")
    for value in range(3):
        sender.send_raw(0x281, b"")
        sender.send_raw(0x181, bytes([value]))
    sender.send(can.Message(arbitration_id=0x181, is_extended_id=True))
    scheduler.run_until(3 * MS)
    per_frame = [2, 0, 0] if is_each_attempt else [1, 1, 0]
    expected = [
        (can_id, kind)
        for errors in per_frame
        for can_id, kind in [(0x281, "data"), *[(0x181, "error")] * errors, (0x181, "data")]
    ]
    assert [(can_id, kind) for _, can_id, kind in on_bus] == [*expected, (0x181, "data")]


def test_which_frames_are_hit_is_seeded(scheduler: Scheduler, segment: Segment) -> None:
    """The i-th frame of the identifier meets the i-th number of random.Random(seed)."""
    segment.add_fault(
        FrameFault(0x281, hits=Hits(numbers=random.Random(9), share=0.5, skip=3, count=4))
    )
    sender, receiver = segment.port("sender"), segment.port("receiver")
    for value in range(40):
        sender.send_raw(0x281, bytes([value]))
        sender.send_raw(0x181, bytes([value]))
    scheduler.run_until(20 * MS)
    numbers = random.Random(9)
    hit = [index for index in range(40) if numbers.random() < 0.5 and index >= 3][:4]
    got: dict[int, list[int]] = {0x181: [], 0x281: []}
    while (msg := receiver.recv(0)) is not None:
        got[msg.arbitration_id].append(msg.data[0])
    assert got[0x181] == list(range(40))
    assert got[0x281] == [index for index in range(40) if index not in hit]


def test_two_frames_that_wait_for_the_next_one_of_their_port_are_both_sent(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """The first waits for a frame of its port; the second, which may not, is that one."""
    seen = watch(segment)
    sender = segment.port("sender")
    segment.port("receiver")
    segment.add_fault(lambda frame, port, attempt: Swap() if attempt == 0 else None)
    sender.send_raw(0x081, b"1")
    sender.send_raw(0x082, b"2")
    scheduler.run_until(MS)
    assert [can_id for _, can_id, _ in seen] == [0x082, 0x081]


def test_what_waits_in_a_controller_without_power_is_lost_and_counted(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """A node that comes back sends what it has been asked for since, and nothing older."""
    seen = watch(segment)
    sender = segment.port("sender")
    segment.port("receiver")
    for can_id in (0x081, 0x082, 0x083):
        sender.send_raw(can_id, b"")
    sender.power_off()
    sender.send_raw(0x084, b"")
    scheduler.run_until(MS)
    sender.power_on()
    sender.send_raw(0x085, b"")
    scheduler.run_until(2 * MS)
    assert [can_id for _, can_id, _ in seen] == [0x085]
    assert sender.discarded == 4


@pytest.mark.parametrize("share", [1.0, 0.4])
def test_skip_lets_frames_pass_whether_they_would_be_hit_or_not(share: float) -> None:
    """5 frames pass; of the next ones the first two that the numbers name are hit."""
    hits = Hits(numbers=random.Random(7), share=share, skip=5, count=2)
    numbers = random.Random(7)
    named = [numbers.random() < share for _ in range(40)]
    expected = [is_named and k >= 5 and sum(named[5:k]) < 2 for k, is_named in enumerate(named)]
    assert [hits.falls() for _ in range(40)] == expected
    assert sum(expected) == 2


def test_the_first_fault_that_answers_decides_in_the_order_in_which_they_were_added(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Those behind it are not asked about that attempt; where it is silent the next one is."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    asked: list[tuple[str, int]] = []

    def hook(name: str, numbers: set[int]) -> Callable[..., FaultAction | None]:
        def decide(frame: Frame, _port: object, _attempt: int) -> FaultAction | None:
            asked.append((name, frame.data[0]))
            return Alter(name.encode()) if frame.data[0] in numbers else None

        return decide

    for name, numbers in (("a", {1, 4}), ("b", {1, 2, 4}), ("c", {2, 3})):
        segment.add_fault(hook(name, numbers))
    for number in range(1, 6):
        sender.send_raw(0x181, bytes([number]))
    scheduler.run_until(2 * MS)
    got = [receiver.recv(0) for _ in range(5)]
    assert [bytes(msg.data) for msg in got if msg] == [b"a", b"b", b"c", b"a", b"\x05"]
    assert asked == [
        ("a", 1), ("a", 2), ("b", 2), ("a", 3), ("b", 3), ("c", 3), ("a", 4),
        ("a", 5), ("b", 5), ("c", 5),
    ]  # fmt: skip
