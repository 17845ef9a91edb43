"""Log files of the traffic read back: by python-can where it can, pcap by its description."""

import random
import struct
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.logs import LOG_SUFFIXES, log_kinds, open_log
from axisrig.bench.bus.can.pcap import socketcan_message
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

Seen = list[tuple[int, Frame, bool]]


def play(segment: Segment, *paths: Path) -> Seen:
    """Send frames, standard, extended, remote and destroyed, into logs; return what passed."""
    seen: Seen = []
    logs = [open_log(path, [segment.name]) for path in paths]
    for log in logs:
        segment.observe(log)
    segment.observe(lambda time_ns, name, frame, is_error: seen.append((time_ns, frame, is_error)))
    numbers = random.Random(5)
    segment.add_fault(
        lambda frame, port, attempt: ErrorAtBit(30) if numbers.random() < 0.1 else None
    )
    port = segment.port("sender")
    segment.port("listener")
    segment.scheduler.run_until(3_600_000 * MS)  # an hour: seconds and rest are both used
    for index in range(50):
        port.send_raw(numbers.randrange(0x800), numbers.randbytes(index % 9))
        port.send_raw(numbers.randrange(0x800, 0x20000000), numbers.randbytes(8))
        port.send(
            can.Message(
                arbitration_id=0x0ABCDE00 + index if index % 4 == 3 else index,
                is_extended_id=index % 4 == 3,
                is_remote_frame=True,
                dlc=3,
            )
        )
        segment.scheduler.run_until(segment.now_ns + MS + 333_333)
    for log in logs:
        log.stop()
    return seen


@pytest.mark.long
@pytest.mark.parametrize(("kind", "step_ns"), [("blf", 1), ("candump", 500), ("asc", 500)])
def test_python_can_reads_its_logs_back(
    segment: Segment, tmp_path: Path, kind: str, step_ns: int
) -> None:
    """ASC and candump round to 1 us; what an error frame destroyed is told by BLF alone."""
    path = tmp_path / f"bus{LOG_SUFFIXES[kind]}"
    seen = play(segment, path)
    with can.LogReader(path) as reader:
        read = list(reader)
    assert len(read) == len(seen)
    for msg, (time_ns, frame, is_error) in zip(read, seen, strict=True):
        assert abs(round(msg.timestamp * 1e9) - time_ns) <= step_ns + 500  # a float of an hour
        assert msg.is_error_frame == is_error
        if not is_error:
            assert msg.arbitration_id == frame.arbitration_id
            assert msg.is_extended_id == frame.is_extended_id
            assert msg.is_remote_frame == frame.is_remote_frame
            assert msg.dlc == frame.dlc
            assert frame.is_remote_frame or bytes(msg.data) == frame.data


@pytest.mark.long
def test_candump_names_the_segment(segment: Segment, tmp_path: Path) -> None:
    play(segment, tmp_path / "bus.log")
    first = (tmp_path / "bus.log").read_text().splitlines()[0]
    assert first.split()[1] == segment.name


def test_candump_has_the_length_of_a_remote_frame_where_it_is_not_0(tmp_path: Path) -> None:
    """`703#R1`, and `080#R` for a length of 0, in the order of the log format of can-utils."""
    log = open_log(tmp_path / "bus.log", ["can0", "1"])
    for number, (can_id, extended, dlc) in enumerate(
        [(0x703, False, 1), (0x080, False, 0), (0x1ABCDE, True, 8), (0x7, True, 0)]
    ):
        log(number * MS, "can0", Frame(can_id, b"", extended, True, dlc), False)
    log(4 * MS, "1", Frame(0x181, b"\x01\x02", False, False, 2), False)
    log.stop()
    lines = [line.split()[2] for line in (tmp_path / "bus.log").read_text().splitlines()]
    assert lines == ["703#R1", "080#R", "001ABCDE#R8", "00000007#R", "181#0102"]


def test_pcap_holds_what_its_description_says(segment: Segment, tmp_path: Path) -> None:
    """Global header of 24 bytes, then 16 bytes of record head and 16 of a SocketCAN frame each."""
    path = tmp_path / "bus.pcap"
    seen = play(segment, path)
    content = path.read_bytes()
    words = [int.from_bytes(content[at : at + 4], "little") for at in range(0, 24, 4)]
    assert words == [0xA1B23C4D, 2 | 4 << 16, 0, 0, 16, 227]
    assert len(content) == 24 + 32 * len(seen)
    for index, (time_ns, frame, is_error) in enumerate(seen):
        record = content[24 + 32 * index :][:32]
        seconds, rest_ns, kept, whole = (
            int.from_bytes(record[at : at + 4], "little") for at in range(0, 16, 4)
        )
        assert seconds * 10**9 + rest_ns == time_ns
        assert (kept, whole) == (16, 16)
        can_id = int.from_bytes(record[16:20], "big")
        assert record[21:24] == bytes(3)
        if is_error:
            assert (can_id, record[20]) == (1 << 29 | 8, 8)
            continue
        flags = frame.is_extended_id << 31 | frame.is_remote_frame << 30
        assert can_id == frame.arbitration_id | flags
        assert record[20] == frame.dlc
        assert record[24:] == frame.data.ljust(8, b"\0")


def test_unknown_kinds_are_refused(tmp_path: Path) -> None:
    assert log_kinds("blf, pcap") == ["blf", "pcap"]
    assert log_kinds("") == []
    with pytest.raises(UserError, match="kind of bus log"):
        log_kinds("blf,mf4")
    with pytest.raises(UserError, match="kind of bus log"):
        open_log(tmp_path / "bus.mf4", ["can1"])


@pytest.mark.parametrize("extended", [0, 0x8000_0000])
@pytest.mark.parametrize(
    ("flags", "length", "size"),
    [(0, 3, 8), (0, 8, 8), (0x4000_0000, 4, 0), (0x4000_0000, 4, 8), (0x2000_0000, 8, 8)],
)
def test_a_frame_of_socketcan_is_read_by_its_flags(
    extended: int, flags: int, length: int, size: int
) -> None:
    """Linux can.h: bits 31 extended, 30 remote, 29 error; a remote frame has a length and no data.

    Behind the length are three bytes of padding.
    """
    data = bytes(range(1, 1 + size))
    packet = struct.pack(">IB3x", 0x123 | extended | flags, length) + data
    found = socketcan_message(packet, 1.5, "can0")
    assert found.arbitration_id == 0x123
    kind = (found.is_extended_id, found.is_remote_frame, found.is_error_frame)
    assert kind == (bool(extended), flags == 0x4000_0000, flags == 0x2000_0000)
    assert (found.timestamp, found.channel, found.dlc) == (1.5, "can0", length)
    assert bytes(found.data) == (b"" if found.is_remote_frame else data[:length])
