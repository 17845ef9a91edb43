"""Hash and log files of the traffic."""

import hashlib
import random
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.logs import blf_writer
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

Seen = list[tuple[int, str, Frame, bool]]


def play(segment: Segment, start_ns: int, seconds: int = 1) -> Seen:
    """Send standard, extended, remote and destroyed frames; return what an observer saw."""
    seen: Seen = []
    numbers = random.Random(4)
    segment.observe(lambda *args: seen.append(args))
    segment.add_fault(
        lambda frame, port, attempt: ErrorAtBit(30) if numbers.random() < 0.1 else None
    )
    port = segment.port("sender")
    segment.port("listener")
    segment.scheduler.run_until(start_ns)
    for index in range(100):
        port.send_raw(numbers.randrange(0x800), numbers.randbytes(index % 9))
        port.send_raw(numbers.randrange(0x800, 0x20000000), numbers.randbytes(8))
        port.send(
            can.Message(arbitration_id=index, is_extended_id=False, is_remote_frame=True, dlc=3)
        )
        segment.scheduler.run_until(start_ns + index * seconds * 10 * MS + 333_333)
    return seen


def test_hash_equals_the_documented_layout_put_together_by_hand(segment: Segment) -> None:
    frame_hash = FrameHash()
    segment.observe(frame_hash)
    text = b""
    for time_ns, name, frame, is_error in play(segment, 0):
        text += time_ns.to_bytes(8, "little", signed=True)
        text += len(name).to_bytes(1, "little") + name.encode()
        text += frame.arbitration_id.to_bytes(4, "little")
        text += bytes([frame.is_extended_id + 2 * frame.is_remote_frame + 4 * is_error, frame.dlc])
        text += frame.data.ljust(8, b"\0")
    assert frame_hash.hexdigest() == hashlib.sha256(text).hexdigest()
    assert frame_hash.frames > 300


def test_one_hash_over_two_segments_tells_who_carried_what() -> None:
    digests = set()
    for x_id, y_id in ((0x80, 0x81), (0x81, 0x80)):
        scheduler, frame_hash = new_scheduler(), FrameHash()
        with Segment("x", 1_000_000, scheduler) as x, Segment("y", 1_000_000, scheduler) as y:
            for segment, can_id in ((x, x_id), (y, y_id)):
                segment.observe(frame_hash)
                segment.port("listener")
                segment.port("sender").send_raw(can_id, b"")
            scheduler.run_until(MS)
        assert frame_hash.frames == 2
        digests.add(frame_hash.hexdigest())
    assert len(digests) == 2


@pytest.mark.parametrize("start_ns", [0, 5_123_456_789])
def test_blf_reads_back_what_was_sent(segment: Segment, tmp_path: Path, start_ns: int) -> None:
    """Times to 1 ns, also when the first frame comes late in the run."""
    writer = blf_writer(tmp_path / "bus.blf")
    segment.tap(writer)
    seen = play(segment, start_ns)
    writer.stop()
    with can.BLFReader(tmp_path / "bus.blf") as reader:
        read = list(reader)
    assert len(read) == len(seen)
    for msg, (time_ns, _, frame, is_error) in zip(read, seen, strict=True):
        assert 0 <= time_ns - round(msg.timestamp * 1e9) <= 1
        assert msg.arbitration_id == frame.arbitration_id
        assert msg.is_extended_id == frame.is_extended_id
        assert msg.is_error_frame == is_error
        assert (msg.is_remote_frame, msg.dlc) == (frame.is_remote_frame, frame.dlc)
        if not frame.is_remote_frame:
            assert bytes(msg.data) == frame.data


@pytest.mark.parametrize("suffix", ["blf", "log", "csv"])
def test_loggers_of_python_can_work_as_taps(segment: Segment, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"bus.{suffix}"
    logger = can.Logger(path)
    segment.tap(logger)
    seen = play(segment, 0)
    logger.stop()
    with can.LogReader(path) as reader:
        read = [(round(msg.timestamp * 1e9), msg.arbitration_id) for msg in reader]
    assert len(read) == len(seen)
    if suffix == "blf":
        expected = [(time_ns, frame.arbitration_id) for time_ns, _, frame, _ in seen]
        assert [can_id for _, can_id in read] == [can_id for _, can_id in expected]
        assert max(abs(a - b) for (a, _), (b, _) in zip(read, expected, strict=True)) <= 1
