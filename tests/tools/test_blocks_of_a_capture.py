"""Packets of pcapng files: sections, interfaces with their names and clocks, blocks of others."""

import gzip
import struct
from pathlib import Path

import pytest
from tests.tools.captures import NAME, RESOLUTION, block, interface, packet, section

from axisrig.bench.tools.bus_log.reading.pcapng import read_packets
from axisrig.bench.tools.bus_log.reading.progress import Progress, opened, suffix_of
from axisrig.kernel.errors import UserError


def read(place: Path, *blocks: bytes) -> list[tuple[int, str, int, bytes]]:
    path = place / "some.pcapng"
    path.write_bytes(b"".join(blocks))
    return [tuple(one) for one in read_packets(path)]  # type: ignore[misc]


def test_a_packet_has_the_name_the_link_and_the_clock_of_its_interface(tmp_path: Path) -> None:
    """Name and resolution in either order; blocks that are none of these are passed over."""
    ms, two = bytes([3]), bytes([0x80 | 1])
    found = read(
        tmp_path, section(), interface(1, {NAME: b"eth0", RESOLUTION: ms}),
        interface(227, {RESOLUTION: two, 12: b"Linux", NAME: b"can1\0"}), block(5, bytes(12)),
        packet(7, b"abc", 1), packet(7, b"defg", 0), interface(195), packet(7, b"", 2),
        packet((1 << 32) + 5, b"x", 0),
    )  # fmt: skip
    assert found == [
        (3_500_000_000, "can1", 227, b"abc"), (7_000_000, "eth0", 1, b"defg"),
        (7_000, "", 195, b""), (((1 << 32) + 5) * 1_000_000, "eth0", 1, b"x"),
    ]  # fmt: skip


@pytest.mark.parametrize("orders", ["<<", "<>", "><", ">>"])
def test_each_section_counts_its_own_interfaces_in_its_own_order_of_bytes(
    orders: str, tmp_path: Path
) -> None:
    """Two files one behind the other are a file."""
    parts = [
        section(order) + interface(1, {NAME: name}, order) + packet(1, name, 0, order)
        for order, name in zip(orders, (b"first", b"second"), strict=True)
    ]
    assert [one[1:] for one in read(tmp_path, *parts)] == [
        ("first", 1, b"first"), ("second", 1, b"second"),
    ]  # fmt: skip
    with pytest.raises(UserError, match="no interface 1"):
        read(tmp_path, *parts, packet(1, b"", 1, orders[1]))


def test_a_file_that_is_cut_off_is_damaged_where_it_ends(tmp_path: Path) -> None:
    whole = section() + interface(1) + packet(1, b"abcd")
    assert len(read(tmp_path, whole)) == 1
    begin = len(section() + interface(1))
    for end in (begin + 1, begin + 8, len(whole) - 1):
        with pytest.raises(UserError, match=f"cut off at byte {begin}"):
            read(tmp_path, whole[:end])
    with pytest.raises(UserError, match="cut off at byte 28"):
        read(tmp_path, section(), struct.pack("<III", 1, 8, 8))  # shorter than any block
    with pytest.raises(UserError, match="no interface 0"):
        read(tmp_path, section(), packet(1, b""))
    with pytest.raises(UserError, match="no pcapng file"):
        read(tmp_path, interface(1))


@pytest.mark.parametrize("ending", [".gz", ".GZ", ".Gz"])
def test_what_is_packed_is_opened_whatever_the_case_of_its_ending(
    ending: str, tmp_path: Path
) -> None:
    path = tmp_path / f"some.PcapNG{ending}"
    path.write_bytes(gzip.compress(section() + interface(1) + packet(1, b"abcd")))
    progress = Progress(frames=2)
    assert (suffix_of(path), progress.place) == (".pcapng", (2, 0))
    assert [one.data for one in read_packets(path, progress)] == [b"abcd"]
    assert progress.place == (2, 0)  # closed
    with opened(path, progress) as file:
        file.read(5)
        assert progress.place == (2, 5)
