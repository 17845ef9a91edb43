"""A bus log in words: logs written out by hand, and what an engineer reads of them."""

import struct
from collections.abc import Callable
from pathlib import Path

import can
import pytest

Call = Callable[..., tuple[int, str, str]]
Tell = Callable[..., list[str]]


@pytest.fixture
def tell(place: Path, axisrig: Call) -> Tell:
    """Write frames `ms id#data` of can1 as a candump log and have them told."""

    def found(frames: str, *options: str) -> list[str]:
        lines = [
            f"({float(ms) / 1e3:.6f}) can1 {frame} R"
            for ms, frame in (line.split() for line in frames.split("\n") if line.strip())
        ]
        (place / "some.log").write_text("\n".join(lines) + "\n", encoding="utf-8")
        code, out, err = axisrig("bus", "some.log", *options)
        assert (code, err) == (0, "")
        return out.splitlines()

    return found


def test_every_boot_up_and_every_new_nmt_state_is_told(tell: Tell) -> None:
    """The second boot-up is a reset in the middle; a toggle bit of node guarding is no news."""
    lines = tell("""
        0.1 703#00
        5 703#05
        6 703#85
        7 703#05
        8 703#7F
        9 703#00
        10 703#00
        11 704#00
    """)
    assert [line.split(maxsplit=4)[-1] for line in lines] == [
        "boot-up", "operational", "pre-operational", "boot-up", "boot-up", "boot-up",
    ]  # fmt: skip


def test_values_are_told_with_what_they_mean(tell: Tell) -> None:
    """Positions: 1048576 increments on 10 mm, so 10485760 units are 100 mm; -1 is below zero."""
    lines = tell(
        """
        0.1234 203#0F010000A0001100
        0.2 183#37020000A0000300
        0.3 603#2340600000000000
        0.4 583#4F61600008000000
        0.5 603#23001A0110004160
        0.6 583#43646000FFFFFFFF
        0.7 583#8060600030000906
        0.8 583#4B3F600011860000
        0.9 383#0500010000000000
        1.0 603#2BB8600012100000
        """,
        "--rig", "rig.toml",
    )  # fmt: skip
    found = [line.split(maxsplit=3)[-1] for line in lines]
    assert lines[0].split()[0] == "0.123"
    assert "Controlword 0x010F (enable operation, halt)" in found[0]
    assert "Target position 10485760 (100.000000 mm)" in found[0]
    assert "Touch probe function 0x0011 (probe 1 on, 1 positive edge)" in found[0]
    assert "Statusword 0x0237 (operation enabled)" in found[1]
    assert "Touch probe status 0x0003 (probe 1 on, 1 positive stored)" in found[1]
    assert found[3].endswith("8 (0x08; cyclic synchronous position)")
    assert found[4].endswith("= 0x60410010 (6041:0, 16 bit)")
    assert found[5].endswith("= -1 (0xFFFFFFFF; -0.000010 mm)")
    assert found[6].endswith("abort 0x6060:0 Modes of operation: 0x06090030, value is not allowed")
    assert found[7].endswith("0x8611 (following error)")
    assert found[9].endswith("0x1012 (probes off, 1 every event, 1 positive edge, 2 positive edge)")


def test_a_frame_of_nobody_is_told_so(tell: Tell) -> None:
    frames = "1 183#00\n2 705#00\n3 001#11\n4 080#\n5 000#0103\n6 000#0105\n7 000#0100"
    found = tell(frames, "--rig", "rig.toml")
    assert ["of no node of this rig" in line for line in found] == [
        False, True, True, False, False, True, False,
    ]  # fmt: skip
    assert not any("of no node" in line for line in tell(frames))


ALL_KINDS = """
    1 000#8203
    2 703#00
    3 603#4041600000000000
    4 583#4B41600037020000
    5 603#4000100000000000
    6 083#1186210000000000
    7 183#37020000A0000000
    8 704#00
"""


@pytest.mark.parametrize(
    ("only", "times"),
    [
        ("sdo", [3, 4, 5]),
        ("SDO answer,nmt", [1, 4]),
        ("z", [1, 2, 3, 4, 5, 6, 7]),
        ("Z.", [1, 2, 3, 4, 5, 6, 7]),
        ("z.tpdo1", [7]),
        ("0x6041", [3, 4, 7]),
        ("6041:0,Emcy", [3, 4, 6, 7]),
        ("boot-up", [2, 8]),
        ("4", [8]),
        ("1000", [5]),
    ],
)
def test_only_asks_for_services_axes_telegrams_and_objects(
    tell: Tell, only: str, times: list[int]
) -> None:
    lines = tell(ALL_KINDS, "--rig", "rig.toml", "--only", only)
    assert [round(float(line.split()[0])) for line in lines] == times


def test_a_word_that_asks_for_nothing_known_is_refused(
    place: Path, axisrig: Call, tell: Tell
) -> None:
    tell(ALL_KINDS)
    code, out, err = axisrig("bus", "some.log", "--rig", "rig.toml", "--only", "SDO,statusword")
    assert (code, out) == (2, "")
    for word in ("statusword", "EMCY", "6041", "Z"):
        assert word in err
    (line,) = tell(ALL_KINDS, "--only", "LSS")
    assert "no frame for LSS" in line


def write_pcap(path: Path, frames: list[tuple[int, int, bytes]], magic: int, order: str) -> None:
    """Frames: time in the ticks of the magic number, identifier with flags, data."""
    data = struct.pack(order + "IHHiIII", magic, 2, 4, 0, 0, 65535, 227)
    for ticks, can_id, payload in frames:
        body = struct.pack(">IB3x", can_id, len(payload)) + payload
        data += struct.pack(order + "IIII", 0, ticks, len(body), len(body)) + body
    path.write_bytes(data)


@pytest.mark.parametrize(("magic", "per_us"), [(0xA1B23C4D, 1000), (0xA1B2C3D4, 1)])
@pytest.mark.parametrize("order", ["<", ">"])
def test_pcap_of_either_order_and_resolution_is_told(
    place: Path, axisrig: Call, magic: int, per_us: int, order: str
) -> None:
    """Error frames in a row are one line, with how many and until when."""
    error = (1 << 29 | 8, bytes(8))
    frames = [
        (1000 * per_us, 0x703, b"\0"),
        *[((2000 + i) * per_us, *error) for i in range(71)],
        (5000 * per_us, 0x000, b"\x81\x03"),
        (6000 * per_us, *error),
    ]
    write_pcap(place / "x.pcap", frames, magic, order)
    code, out, err = axisrig("bus", "x.pcap")
    assert (code, err) == (0, "")
    assert [line.split() for line in out.splitlines()] == [
        ["1.000", "703", "3.heartbeat", "boot-up"],
        ["2.000", "error", "frame", "71", "times", "until", "2.070", "ms"],
        ["5.000", "000", "NMT", "reset", "node,", "node", "3"],
        ["6.000", "error", "frame"],
    ]


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"", "no pcap file"),
        (b"\x0a\x0d\x0d\x0a" + bytes(40), "no pcap file"),
        (struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 65535, 1), "link type"),
        (struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 99, 227) + bytes(9), "within a frame"),
        (
            struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 99, 227)
            + struct.pack("<IIII", 0, 0, 16, 16) + bytes(12),
            "within a frame",
        ),
    ],
)  # fmt: skip
def test_a_file_that_is_no_pcap_of_can_is_refused(
    place: Path, axisrig: Call, content: bytes, found: str
) -> None:
    (place / "bad.pcap").write_bytes(content)
    code, _, err = axisrig("bus", "bad.pcap")
    assert code == 2
    assert found in err


@pytest.mark.parametrize(
    ("name", "content"), [("bad.blf", b"nothing" * 99), ("bad.log", b"(0.1) can1 7#zz\n")]
)
def test_a_damaged_log_is_refused(place: Path, axisrig: Call, name: str, content: bytes) -> None:
    (place / name).write_bytes(content)
    code, _, err = axisrig("bus", name)
    assert code == 2
    assert "the log is damaged" in err


@pytest.mark.long
def test_pcap_may_be_the_only_log_of_a_run(place: Path, axisrig: Call) -> None:
    """It is told as the BLF of the same run is."""
    (place / "plan.csv").write_text("case,program,rig,plc:V.E.FEED\na,part.nc,rig.toml,600\n")
    found = []
    for kind in ("blf", "pcap"):
        assert axisrig("run", "plan.csv", "-o", kind, "--bus-log", kind)[0] == 0
        found.append(axisrig("bus", kind, "plan-a", "--to", "20"))
    assert found[0] == found[1]
    assert found[0][0] == 0
    assert "boot-up" in found[0][1]


def test_a_folder_of_drives_for_another_master_is_told(
    place: Path, axisrig: Call, tell: Tell
) -> None:
    tell("1 703#00")
    (place / "drives").mkdir()
    with can.LogReader(place / "some.log") as reader, can.BLFWriter(place / "drives/bus.blf") as to:
        for message in reader:
            to.on_message_received(message)
    assert "boot-up" in axisrig("bus", "drives")[1]
