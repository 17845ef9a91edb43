"""Frames that get lost or destroyed, at 1 Mbit/s: one bit is 1000 ns."""

import random
from collections.abc import Callable

import pytest

from bench.bus.faults import Drop, DropById, ErrorAtBit
from bench.bus.frame import Frame
from bench.bus.segment import Segment
from bench.bus.simbus import SimBus
from kernel.clock import MS, Phase
from kernel.cosim.scheduler import Scheduler
from kernel.errors import UserError

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
            ErrorAtBit(999) if (frame.arbitration_id, attempt) == (0x300, 0) else None
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


def test_drop_by_id_is_seeded_and_takes_its_settings_from_data(
    scheduler: Scheduler, segment: Segment
) -> None:
    """The i-th frame of the identifier meets the i-th number of random.Random(seed)."""
    hook = DropById.from_data(
        {"cob_id": "0x281", "share": "0.5", "skip": 3, "count": "4", "seed": 9}
    )
    segment.add_fault(hook)
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
    segment.remove_fault(hook)
    sender.send_raw(0x281, b"")
    assert receiver.recv(1.0) is not None


def test_drop_of_an_extended_identifier_spares_the_standard_one(
    scheduler: Scheduler, segment: Segment
) -> None:
    segment.add_fault(DropById(0x1234567))
    sender, receiver = segment.port("sender"), segment.port("receiver")
    sender.send_raw(0x1234567, b"")
    sender.send_raw(0x567, b"")
    scheduler.run_until(MS)
    received = receiver.recv(0)
    assert received is not None
    assert received.arbitration_id == 0x567


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"cob_id": "TPDO1"},
        {"cob_id": 0x20000000},
        {"cob_id": 1, "share": 1.5},
        {"cob_id": 1, "chance": 1},
    ],
)
def test_drop_settings_are_checked(data: dict[str, object]) -> None:
    with pytest.raises(UserError):
        DropById.from_data(data)
