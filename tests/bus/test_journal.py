"""Records that see frames by block are those that see them one by one."""

import random
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

import can
import pytest
from tests.ethercat.line import frame, physical

from axisrig.bench.bus.can.faults import ErrorAtBit, FaultAction
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.load import LoadFigures
from axisrig.bench.bus.can.logs import LOG_SUFFIXES, BusLog, open_log
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.ethercat.segment import EthercatSegment, Passage
from axisrig.bench.bus.journal import BLOCK_FRAMES, Entry, Journal
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

SEGMENTS = ("can1", "second")  # records of different lengths


def play(
    journal: Journal,
    opened: ExitStack,
    *,
    frames: int = 1500,
    observers: Sequence[BusLog | FrameHash] = (),
) -> list[Segment]:
    """Send standard, extended, remote and destroyed frames on both segments, mixed in time."""
    scheduler, numbers = new_scheduler(), random.Random(11)

    def destroy(frame: Frame, _port: object, _attempt: int) -> FaultAction | None:
        return ErrorAtBit(20) if numbers.random() < 0.02 else None

    segments = []
    for name in SEGMENTS:
        segment = opened.enter_context(Segment(name, 1_000_000, scheduler, journal=journal))
        segment.add_fault(destroy)
        for observer in observers:
            segment.observe(observer)
        segment.port("listener")
        segments.append(segment)
    senders = [segment.port("sender") for segment in segments]
    for index in range(frames):
        for sender in senders:
            sender.send_raw(numbers.randrange(0x800), numbers.randbytes(index % 9))
            if index % 5 == 0:
                sender.send_raw(numbers.randrange(0x800, 0x2000_0000), numbers.randbytes(8))
            if index % 7 == 0:
                remote = can.Message(
                    arbitration_id=index % 0x800, is_extended_id=False, is_remote_frame=True, dlc=3
                )
                sender.send(remote)
        scheduler.run_until(scheduler.now_ns + numbers.randrange(200_000, 900_000))
    return segments


@pytest.mark.long
@pytest.mark.parametrize("block_frames", [1, 7, BLOCK_FRAMES, 100_000])
@pytest.mark.parametrize("kind", LOG_SUFFIXES)
def test_a_log_by_block_has_the_bytes_of_a_log_by_frame(
    tmp_path: Path, kind: str, block_frames: int
) -> None:
    """Frame by frame BLF is python-can's own writer; here it fills more than one container."""
    names = [f"by-block{LOG_SUFFIXES[kind]}", f"by-frame{LOG_SUFFIXES[kind]}"]
    by_block, by_frame = (open_log(tmp_path / name, SEGMENTS) for name in names)
    journal = Journal(block_frames)
    journal.add(by_block.take)
    with ExitStack() as opened:
        play(journal, opened, observers=[by_frame])
    journal.drain()
    by_block.stop()
    by_frame.stop()
    files = sorted(tmp_path.iterdir())
    assert len(files) == (4 if kind == "pcap" else 2)
    for one, other in zip(files[: len(files) // 2], files[len(files) // 2 :], strict=True):
        # The head of ASC has the date of its writing
        skip = 2 if kind == "asc" else 0
        lines = [path.read_bytes().split(b"\n")[skip:] for path in (one, other)]
        assert lines[0] == lines[1]
        assert one.stat().st_size > 30_000
    if kind == "blf":
        with can.BLFReader(files[0]) as reader:
            assert reader.uncompressed_size > 3 * can.BLFWriter.max_container_size / 2


@pytest.mark.parametrize("block_frames", [1, 7, BLOCK_FRAMES])
def test_the_hash_by_block_is_the_hash_by_frame(block_frames: int) -> None:
    journal, by_frame = Journal(block_frames), FrameHash()
    by_block = FrameHash(journal)
    with ExitStack() as opened:
        play(journal, opened, frames=400, observers=[by_frame])
    assert by_block.hexdigest() == by_frame.hexdigest()
    assert by_block.frames == by_frame.frames > 900


def test_the_load_may_be_asked_for_at_any_instant() -> None:
    """A question in the middle of a block changes nothing of what is told at the end."""

    def found(block_frames: int, questions: bool) -> list[tuple[LoadFigures, list[int]]]:
        with ExitStack() as opened:
            journal = Journal(block_frames)
            segments = play(journal, opened, frames=300)
            for segment in segments:
                late = segment.port("late")
                for _ in range(5):
                    late.send_raw(0x123, b"\x00\xff")
                    segment.scheduler.run_until(segment.now_ns + 99_000)
                    if questions:
                        assert segment.load() == segment.load()
                        assert sum(segment.busy_bits(MS)) > 0
            return [(segment.load(), segment.busy_bits(MS)) for segment in segments]

    assert found(BLOCK_FRAMES, True) == found(BLOCK_FRAMES, False) == found(1, False)


def test_readers_get_every_frame_once_and_in_order() -> None:
    first: list[Entry] = []
    second: list[Entry] = []
    sizes: list[int] = []

    def take(block: Sequence[Entry]) -> None:
        sizes.append(len(block))
        first.extend(block)

    journal = Journal(4)
    journal.add(take)
    entries = [(n, "can1", data_frame(n, b""), False) for n in range(10)]
    for entry in entries[:9]:
        journal.entries.append(entry)
        if len(journal.entries) >= journal.block_frames:
            journal.drain()
    journal.add(second.extend)  # who comes later sees what comes later
    journal.entries.append(entries[9])
    journal.drain()
    journal.drain()
    assert (first, second, sizes) == (entries, entries[9:], [4, 4, 1, 1])


def test_a_reader_that_fails_stops_the_run_once() -> None:
    """The block is gone for the readers after it; closing does not try it again."""
    blocks: list[int] = []

    def fail(_block: Sequence[Entry]) -> None:
        raise OSError(28, "no space left")

    journal = Journal(3)
    journal.add(lambda block: blocks.append(len(block)))
    journal.add(fail)
    with Segment("can1", 1_000_000, new_scheduler(), journal=journal) as segment:
        segment.port("listener")
        sender = segment.port("sender")
        for _ in range(3):
            sender.send_raw(0x80, b"")
        with pytest.raises(OSError, match="no space"):
            segment.scheduler.run_until(MS)
    journal.drain()
    assert blocks == [3]


def test_a_run_that_ends_by_an_exception_leaves_every_frame(tmp_path: Path) -> None:
    """The order in which a machine closes: the journal is drained, then the log stops."""
    frames = 50
    with suppress(ZeroDivisionError), ExitStack() as opened:
        journal = Journal()
        log = open_log(tmp_path / "bus.blf", ["can1"])
        opened.callback(log.stop)
        journal.add(log.take)
        opened.callback(journal.drain)
        segment = opened.enter_context(Segment("can1", 1_000_000, new_scheduler(), journal=journal))
        came: list[int] = []
        listener = segment.port("listener")

        def stumble(can_id: int, _data: bytes, _time_s: float) -> None:
            came.append(can_id)
            assert len(came) <= frames
            if len(came) == frames:
                raise ZeroDivisionError

        listener.attach_data(stumble)
        sender = segment.port("sender")
        for index in range(2 * frames):
            sender.send_raw(index, b"")
        segment.scheduler.run_until(100 * MS)
    with can.BLFReader(tmp_path / "bus.blf") as reader:
        assert [msg.arbitration_id for msg in reader] == list(range(frames))


def test_nothing_that_is_kept_grows_with_the_run() -> None:
    """A run that is killed loses a block and what its writer holds, at most."""
    with Segment("can1", 1_000_000, new_scheduler(), journal=Journal(100)) as segment:
        segment.port("listener")
        sender = segment.port("sender")
        for index in range(1000):
            sender.send_raw(index, b"")
            segment.scheduler.run_until(segment.now_ns + MS)
            assert len(segment.journal.entries) < 100
            assert len(segment.passed) < 100


def test_a_hash_counts_what_waits_in_its_journal() -> None:
    """The journal gives blocks; whoever asks for number or hash gets all until now."""
    journal = Journal(100)
    by_block, by_frame = FrameHash(journal), FrameHash()
    for number in range(1, 4):
        entry = (number * MS, "can0", data_frame(0x180 + number, bytes(number)), number == 2)
        journal.entries.append(entry)
        by_frame(*entry)
        assert by_block.frames == number
        assert by_block.hexdigest() == by_frame.hexdigest()
    assert by_frame.frames == 3


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_block_of_a_line_goes_out_with_its_last_frame(size: int) -> None:
    """A reader of whole blocks has them at the end of the frame that fills them."""

    class Slave:
        is_on = True

        def process(self, frame: bytearray, passage: Passage) -> None: ...

        def broken(self, *, is_here: bool) -> None: ...

    clock, journal, blocks = new_scheduler(), Journal(size), list[int]()
    journal.add(lambda block: blocks.append(len(block)))
    segment = EthercatSegment(clock, [Slave()], journal=journal)
    for number in range(1, 8):
        segment.send(frame(physical(7, 0, 0, 1)))
        clock.run_until(clock.now_ns + 100 * US)
        assert blocks == [size] * (number // size)
        assert len(journal.entries) == number % size
