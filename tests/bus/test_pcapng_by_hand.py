"""The pcapng file of a line, block by block as the format (draft-ietf-opsawg-pcapng) has them."""

import struct
from collections.abc import Iterator
from pathlib import Path

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.kernel.time.clock import S

SECTION, INTERFACE, PACKET = 0x0A0D0D0A, 1, 6


def blocks(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Type and body of each block; its length is before and behind it, and a multiple of 4."""
    while data:
        kind, length = struct.unpack_from("<II", data)
        assert length % 4 == 0
        assert struct.unpack_from("<I", data, length - 4) == (length,)
        yield kind, data[8 : length - 4]
        data = data[length:]


def options(data: bytes) -> dict[int, bytes]:
    found = {}
    while data:
        code, length = struct.unpack_from("<HH", data)
        found[code] = data[4 : 4 + length]
        data = data[4 + length + -length % 4 :]
    return found


def test_each_frame_is_a_packet_of_its_interface_at_its_nanosecond(tmp_path: Path) -> None:
    """Frames of every padding, at times of more than 31, 32 and 40 bits; other segments' none."""
    frames = [
        (0, "x", b"1234"), (1_234, "longer", b"12345"), (3 * S, "x", b"123456"),
        (4_294_967_296, "longer", b"1234567"), (7_200 * S + 999_999_999, "x", b""),
    ]  # fmt: skip
    path = tmp_path / "lines.pcapng"
    with PcapngFile(path, ["x", "longer"]) as file:
        file.take([(*frames[0], False), (5, "other", b"no", False)])
        file.take([(*frame, False) for frame in frames[1:]])
    (section, head), *rest = blocks(path.read_bytes())
    assert (section, struct.unpack("<IHHq", head)) == (SECTION, (0x1A2B3C4D, 1, 0, -1))
    for (kind, body), name in zip(rest[:2], ("x", "longer"), strict=True):
        assert (kind, struct.unpack_from("<HHI", body)) == (INTERFACE, (1, 0, 0))  # Ethernet
        assert options(body[8:]) == {2: name.encode(), 9: b"\x09", 0: b""}
    found = []
    for kind, body in rest[2:]:
        place, high, low, kept, size = struct.unpack_from("<5I", body)
        assert (kind, kept) == (PACKET, size)
        assert body[20 + size :] == bytes(-size % 4)
        found.append((high << 32 | low, ("x", "longer")[place], body[20 : 20 + size]))
    assert found == frames
