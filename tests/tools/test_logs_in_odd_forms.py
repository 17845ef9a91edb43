"""`axisrig bus` with logs that are empty, of an older or a newer tool, or broken off in a block."""

from itertools import pairwise
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.tools.bus_log.bus_log import tell_log
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers, Value
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import messages_of
from axisrig.kernel.errors import UserError

OLD_HEAD = ";   some head\n;\n"
TRC_2 = ";$FILEVERSION=2.1\n;$STARTTIME=43008.9\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n"


@pytest.mark.parametrize(
    ("text", "gaps_ms", "frames"),
    [
        # PCAN-Explorer 2: neither direction nor bus
        (f"{OLD_HEAD}     1)      10.5  0703  1  00\n     2)      12.5  00000703  2  0A FF\n",
         [2.0], [("0", 0x703, False, "00"), ("0", 0x703, True, "0aff")]),
        (f"{OLD_HEAD}     1)      10.5  FFFFFFFF  4  00 00 00 08 -- bus\n"
         "     2)      12.5  0705  1  05\n", [], [("0", 0x705, False, "05")]),
        # The bus is a number from 1 on
        (";$FILEVERSION=1.3\n;$STARTTIME=43008.9\n"
         "     1)      1.5 1  Rx        0703 -  1    00\n"
         "     2)      2.5 3  Tx        0603 -  2    40 00\n",
         [1.0], [("0", 0x703, False, "00"), ("2", 0x603, False, "4000")]),
        (f"{TRC_2}      1      10.500 DT 1      0703 Rx -  1    00\n"
         "      2      11.500 DT 2  0001F703 Rx -  1    7F\n",
         [1.0], [("0", 0x703, False, "00"), ("1", 0x1F703, True, "7f")]),
    ],
)  # fmt: skip
def test_trc_of_each_version_has_its_buses_from_0_on(
    tmp_path: Path, text: str, gaps_ms: list[float], frames: list[tuple[str, int, bool, str]]
) -> None:
    """Forms: PEAK-System, PEAK CAN TRC File Format."""
    path = tmp_path / "some.trc"
    path.write_text(text, encoding="utf-8")
    found = list(messages_of([path]))
    assert [
        (str(one.channel), one.arbitration_id, one.is_extended_id, bytes(one.data).hex())
        for one in found
    ] == frames
    times_s = [one.timestamp for one in found]
    gaps_s = [late_s - early_s for early_s, late_s in pairwise(times_s)]
    # A float of the seconds since 1970 has steps of 0.24 us
    assert gaps_s == pytest.approx([gap_ms * 1e-3 for gap_ms in gaps_ms], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("empty.log", ""), ("empty.asc", ""), ("empty.trc", ""), ("old.trc", OLD_HEAD),
        ("new.trc", TRC_2), ("new.trc", f"{TRC_2};\n\n"),
    ],
)  # fmt: skip
@pytest.mark.parametrize(("only", "words"), [((), "no frame"), (("sdo",), "no frame for sdo")])
def test_a_log_without_a_frame_says_so(
    tmp_path: Path, name: str, text: str, only: tuple[str, ...], words: str
) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    (line,) = tell_log([path], None, Selection(only=only))
    assert line == f"{words} among those of {path} that are shown (see --all)"


def test_lines_without_a_sign_are_no_frames_of_a_trc(tmp_path: Path) -> None:
    """Behind the head, between frames and at the end; a damaged line has its own number."""
    path = tmp_path / "some.trc"
    lines = ["", "     1)      10.5  0703  1  00", "  ", "     2)      12.5  0703  1  05", "", ""]
    path.write_text(OLD_HEAD + "\n".join(lines), encoding="utf-8")
    assert [bytes(one.data).hex() for one in messages_of([path])] == ["00", "05"]
    path.write_text(OLD_HEAD + "\n".join([*lines, "     3)      13", ""]), encoding="utf-8")
    with pytest.raises(UserError, match="the log is damaged") as caught:
        list(messages_of([path]))
    assert (caught.value.line, caught.value.value) == (9, "3)      13")


def written_blf(path: Path, version: int) -> Path:
    """Write one frame without compression, its object with another version of its header."""
    with can.BLFWriter(path, compression_level=0) as writer:
        writer.on_message_received(can.Message(timestamp=1.0, arbitration_id=0x703, data=b"\0"))
    data = bytearray(path.read_bytes())
    at = data.rindex(b"LOBJ")  # in the container; signature, then size and version of the header
    data[at + 6 : at + 8] = version.to_bytes(2, "little")
    path.write_bytes(data)
    return path


def test_a_blf_of_a_newer_tool_is_refused_with_what_to_do(tmp_path: Path) -> None:
    path = written_blf(tmp_path / "new.blf", 1)
    assert [one.arbitration_id for one in messages_of([path])] == [0x703]
    with pytest.raises(UserError) as caught:
        list(messages_of([written_blf(path, 3)]))
    assert "header version 3" in caught.value.message
    assert (caught.value.file, caught.value.hint) == (str(path), "export the log as ASC")
    with pytest.raises(UserError, match=r"the log is damaged: .*version \(7\)"):
        list(messages_of([written_blf(path, 7)]))


# Block transfers that do not go on as they should (CiA 301, SDO block download)


def followed(*frames: tuple[int, str]) -> tuple[list[bool], list[Value]]:
    """Which frames were segments of a block, and the values that came over."""
    transfers, segments, values = Transfers(), list[bool](), list[Value]()
    for can_id, data in frames:
        frame = data_frame(can_id, bytes.fromhex(data))
        found, value = transfers.take("can1", frame.data, dissect(frame))
        segments.append("segment" in found.fields)
        values += [value] if value is not None else []
    return segments, values


BEGIN = (0x603, "C600200109000000"), (0x583, "A400200102000000")  # 9 bytes, blocks of 2 segments
FIRST, LAST = (0x603, "0101020304050607"), (0x603, "8208090000000000")
TAKEN, END, DONE = (0x583, "A202020000000000"), (0x603, "D500000000000000"), (0x583, "A1")


def test_a_block_ends_with_its_last_segment_or_when_it_is_full() -> None:
    """What comes then is no segment, until the other side says what it has taken."""
    value = Value(0x2000, 1, bytes(range(1, 10)))
    segments, values = followed(*BEGIN, FIRST, LAST, TAKEN, END, DONE)
    assert (segments, values) == ([False, False, True, True, False, False, False], [value])
    segments, values = followed(*BEGIN, FIRST, LAST, (0x603, "0300000000000000"), TAKEN, END, DONE)
    assert segments[2:5] == [True, True, False]
    full = (0x603, "0208090000000000")  # not the last one of all, but of a block of 2
    segments, _ = followed(*BEGIN, FIRST, full, (0x603, "0300000000000000"))
    assert segments[2:] == [True, True, False]


@pytest.mark.parametrize("sizes", [(2, 3), (3, 2), (1, 2, 3), (4, 1), (5,)])
def test_each_block_is_as_long_as_the_side_that_takes_it_has_said_last(
    sizes: tuple[int, ...],
) -> None:
    """CiA 301, SDO block download: `blksize` of each answer is that of the next block."""
    numbers = [number for size in sizes for number in range(1, size + 1)]
    data = bytes(range(1, 7 * len(numbers) + 1))
    frames: list[tuple[int, str]] = [
        (0x603, f"C6002001{len(data):02X}000000"), (0x583, f"A4002001{sizes[0]:02X}000000"),
    ]  # fmt: skip
    parts = [data[at : at + 7].hex() for at in range(0, len(data), 7)]
    for place, size in enumerate(sizes):
        own, parts = parts[:size], parts[size:]
        last = 0 if parts else 0x80
        frames += [
            (0x603, f"{number | (last if number == size else 0):02X}{part}")
            for number, part in enumerate(own, 1)
        ]
        following = sizes[place + 1] if parts else 9
        frames.append((0x583, f"A2{size:02X}{following:02X}0000000000"))
    segments, values = followed(*frames, (0x603, "C100000000000000"), DONE)
    assert values == [Value(0x2000, 1, data)]
    assert sum(segments) == len(numbers)


@pytest.mark.parametrize("number", [0, 2, 3, 127])
def test_a_segment_out_of_its_order_ends_the_block(number: int) -> None:
    """Neither it nor those after it are segments; the transfer gives no value."""
    odd = (0x603, f"{number:02X}11111111111111")
    segments, values = followed(*BEGIN, odd, FIRST, LAST)
    assert segments[2:] == [False, False, False]
    assert values == []


def test_an_abort_among_segments_ends_the_transfer() -> None:
    abort = (0x603, "8000200100000408")
    segments, values = followed(*BEGIN, FIRST, abort, LAST, TAKEN, END, DONE)
    assert segments[2:5] == [True, False, False]
    assert values == []


def test_segments_that_were_not_taken_come_again() -> None:
    """Of two segments the first came over: the second one is sent again as number 1."""
    one_taken, again = (0x583, "A201020000000000"), (0x603, "8108090000000000")
    _, values = followed(
        *BEGIN, FIRST, (0x603, "82AAAA0000000000"), one_taken, again, (0x583, "A201020000000000"),
        END, DONE,
    )  # fmt: skip
    assert values == [Value(0x2000, 1, bytes(range(1, 10)))]
