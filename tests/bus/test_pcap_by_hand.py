"""Files of pcap with frames of SocketCAN, packed by hand and read back.

Source: tcpdump.org, pcap file format (head of 24 bytes, 16 before each packet, either order of
bytes, times in us or ns) and LINKTYPE_CAN_SOCKETCAN (identifier big-endian).
"""

import gzip
import struct
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.logs import CandumpWriter
from axisrig.bench.bus.can.pcap import read_pcap
from axisrig.kernel.errors import UserError

US_MAGIC, NS_MAGIC, SOCKETCAN = 0xA1B2C3D4, 0xA1B23C4D, 227


def head(order: str = "<", magic: int = NS_MAGIC, link: int = SOCKETCAN) -> bytes:
    return struct.pack(f"{order}IHHiIII", magic, 2, 4, 0, 0, 65535, link)


def packet(
    seconds: int, rest: int, can_id: int, data: bytes, order: str = "<", size: int = 16
) -> bytes:
    """size: bytes that are kept of the 16 of a packet."""
    frame = struct.pack(">IB3x", can_id, len(data)) + data.ljust(8, b"\0")
    return struct.pack(f"{order}IIII", seconds, rest, size, 16) + frame[:size]


def read(path: Path, content: bytes) -> list[can.Message]:
    path.write_bytes(content)
    return list(read_pcap(path))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("magic", "per_s"), [(US_MAGIC, 10**6), (NS_MAGIC, 10**9)])
def test_either_order_of_bytes_and_either_resolution(
    tmp_path: Path, order: str, magic: int, per_s: int
) -> None:
    packets = [(0, per_s // 4, 0x181, b"\1\2"), (3, per_s // 2, 0x18FF0183 | 1 << 31, bytes(8))]
    content = head(order, magic) + b"".join(packet(*each, order) for each in packets)
    first, second = read(tmp_path / "bus.pcap", content)
    assert [first.timestamp, second.timestamp] == [0.25, 3.5]
    assert (first.arbitration_id, first.is_extended_id, bytes(first.data)) == (
        0x181,
        False,
        b"\1\2",
    )
    assert (second.arbitration_id, second.is_extended_id) == (0x18FF0183, True)
    assert bytes(second.data) == bytes(8)


@pytest.mark.parametrize(
    ("name", "channel"),
    [("run.pcap", None), ("run@can1.pcap", "can1"), ("a.b@can1.pcap", "can1"), ("@x.pcap", "x")],
)
@pytest.mark.parametrize("packed", ["", ".gz", ".GZ"])
def test_the_segment_is_in_the_name_of_the_file_packed_or_not(
    tmp_path: Path, name: str, channel: str | None, packed: str
) -> None:
    content = head() + packet(1, 2, 0x80, b"")
    if packed:
        content = gzip.compress(content)
    (found,) = read(tmp_path / f"{name}{packed}", content)
    assert (found.channel, found.arbitration_id, found.dlc) == (channel, 0x80, 0)


@pytest.mark.parametrize("upper", [0, 0x1000_0000, 0x2400_0000])
def test_what_a_capture_says_beside_the_link_type_is_no_part_of_it(
    tmp_path: Path, upper: int
) -> None:
    """The upper 16 bits are the length of a check sum and reserved."""
    (found,) = read(tmp_path / "x.pcap", head(link=SOCKETCAN | upper) + packet(1, 2, 0x80, b""))
    assert found.arbitration_id == 0x80


@pytest.mark.parametrize("link", [0, 1, 190, 226])
def test_another_link_type_is_refused_with_its_number(tmp_path: Path, link: int) -> None:
    with pytest.raises(UserError, match="another link type") as error:
        read(tmp_path / "x.pcap", head(link=link))
    assert error.value.value == link
    assert "227" in str(error.value)
    assert "x.pcap" in str(error.value)


@pytest.mark.parametrize("content", [b"", b"\0" * 24, head()[:23], b"BLF" + bytes(60)])
def test_what_is_no_pcap_file_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(UserError, match="no pcap file") as error:
        read(tmp_path / "x.pcap", content)
    assert "x.pcap" in str(error.value)


def test_a_file_without_a_frame_is_empty(tmp_path: Path) -> None:
    assert read(tmp_path / "x.pcap", head()) == []


@pytest.mark.parametrize("left", [1, 8, 15, 16, 17, 23, 24, 31])
def test_a_file_that_ends_within_a_frame_gives_those_before_and_says_so(
    tmp_path: Path, left: int
) -> None:
    path = tmp_path / "x.pcap"
    whole = packet(1, 0, 0x181, b"\1")
    path.write_bytes(head() + whole + packet(2, 0, 0x182, b"\2")[:left])
    frames = read_pcap(path)
    assert next(frames).arbitration_id == 0x181
    with pytest.raises(UserError, match="ends within a frame"):
        next(frames)


@pytest.mark.parametrize(("size", "is_read"), [(7, False), (8, True), (9, True), (16, True)])
def test_a_packet_has_at_least_the_head_of_a_frame(
    tmp_path: Path, size: int, is_read: bool
) -> None:
    """Data that a capture has cut off are missing, and the next packet is where it begins."""
    data = bytes(range(1, 9))
    content = head() + packet(1, 0, 0x181, data, size=size) + packet(2, 0, 0x182, b"")
    if is_read:
        first, second = read(tmp_path / "x.pcap", content)
        assert (bytes(first.data), second.arbitration_id) == (data[: size - 8], 0x182)
    else:
        with pytest.raises(UserError, match="ends within a frame"):
            read(tmp_path / "x.pcap", content)


@pytest.mark.parametrize("is_rx", [True, False])
@pytest.mark.parametrize(
    ("can_id", "extended", "dlc", "text"),
    [(0x703, False, 1, "703#R1"), (0x7, True, 8, "00000007#R8"), (0x80, False, 0, "080#R")],
)
def test_candump_says_who_has_sent_a_remote_frame(
    tmp_path: Path, is_rx: bool, can_id: int, extended: bool, dlc: int, text: str
) -> None:
    """R of who received it, T of who sent it, as python-can has it for data frames."""
    path = tmp_path / "x.log"
    writer = CandumpWriter(path)
    for channel, remote in ((1, True), ("vcan0", True), (1, False)):
        message = can.Message(
            timestamp=1.5, arbitration_id=can_id, is_extended_id=extended, is_remote_frame=remote,
            dlc=dlc if remote else 0, channel=channel, is_rx=is_rx,
        )  # fmt: skip
        writer.on_message_received(message)
    writer.stop()
    lines = [line.split() for line in path.read_text().splitlines()]
    assert [line[1] for line in lines] == ["can1", "vcan0", "can1"]
    assert [line[2] for line in lines[:2]] == [text, text]
    assert {line[3] for line in lines} == {"R" if is_rx else "T"}
    assert {line[0] for line in lines} == {"(1.500000)"}
