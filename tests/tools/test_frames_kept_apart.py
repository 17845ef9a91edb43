"""`axisrig bus`: PDOs with two digits, answers that come twice, blank lines, channels as numbers.

Frames are written by CiA 301, captures by the IETF draft of pcapng.
"""

import struct
from pathlib import Path

import pytest
from tests.tools.captures import NAME, interface, packet, section
from tests.tools.test_bus_log_in_words import RIGS, answer, rig  # noqa: F401 - rig is a fixture
from tests.tools.test_words_of_lines import FPRD, LRW, box, coe, frame, image_of_three, names_of

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.bus_log import tell_log
from axisrig.bench.tools.bus_log.canopen.bus_words import Names
from axisrig.bench.tools.bus_log.canopen.mapping import NOT_VALID, LoggedPdos
from axisrig.bench.tools.bus_log.canopen.object_words import value_words
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers, Value
from axisrig.bench.tools.bus_log.choice.channels import Channels
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import messages_of
from axisrig.bench.tools.bus_log.reading.pcapng import ETHERNET
from axisrig.bench.tools.bus_log.reading.progress import Progress

BOOT = struct.pack(">IB3x8s", 0x703, 1, b"\0")


# PDOs


@pytest.mark.parametrize("kind", ["RPDO", "TPDO"])
@pytest.mark.parametrize("number", [1, 4, 9, 10, 12, 64, 512])
def test_a_pdo_has_its_own_objects_whatever_its_number(kind: str, number: int) -> None:
    """Communication at 1400 or 1800, mapping 0x200 behind it, one for each number up to 512."""
    base = (0x1400 if kind == "RPDO" else 0x1800) + number - 1
    pdos = LoggedPdos({})
    pdos.note("can1", 5, base + 0x200, 1, 0x60410010)
    pdos.note("can1", 5, base + 0x200, 0, 1)
    pdos.note("can1", 5, base, 1, 0x2A5)
    found = pdos.find("can1", 0x2A5, False)
    assert found is not None
    assert (found.node, found.name) == (5, f"{kind}{number}")
    assert found.telegram is not None
    assert [(item.index, item.sub, item.bits) for item in found.telegram.objects] == [
        (0x6041, 0, 16)
    ]


@pytest.mark.parametrize(
    ("entry", "signed"),
    [
        (0x60640020, True), (0x607A0020, True), (0x60410010, False), (0x60600008, True),
        (0x60640010, False), (0x60600010, False),  # of another length than the object has
        (0x20010020, False),
    ],
)  # fmt: skip
def test_a_mapped_value_has_a_sign_where_it_is_the_whole_object(entry: int, signed: bool) -> None:
    pdos = LoggedPdos({})
    for sub, value in ((1, entry), (0, 1)):
        pdos.note("can1", 3, 0x1A00, sub, value)
    found = pdos.find("can1", 0x183, False)
    assert found is not None
    assert found.telegram is not None
    (item,) = found.telegram.objects
    assert (item.signed, item.bits) == (signed, entry & 0xFF)


def test_a_pdo_that_was_switched_off_is_that_of_the_rig_again_when_its_node_starts_anew() -> None:
    settings = settings_of(RIGS / "probe-z.toml", [])
    names = Names(settings)

    def text(can_id: int, data: str) -> str:
        one = data_frame(can_id, bytes.fromhex(data))
        return names.describe("can1", one, names.follow("can1", one, dissect(one))).text

    before = text(0x183, "3702")
    assert "are mapped" in before
    off = (0x183 | NOT_VALID).to_bytes(4, "little").hex()
    text(0x603, f"23001801{off}")
    text(0x583, "6000180100000000")
    assert text(0x183, "3702") == "37 02"
    text(0x703, "00")
    assert text(0x183, "3702") == before


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (0x20011220, "2001:12, 32 bit"), (0x2001FF08, "2001:FF, 8 bit"),
        (0x60640020, "6064:0, 32 bit"), (0, "nothing"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("index", [0x1600, 0x17FF, 0x1A00, 0x1BFF])
def test_an_entry_of_a_mapping_has_its_whole_subindex(index: int, entry: int, words: str) -> None:
    assert value_words(index, 1, 32, entry, None, hexadecimal=True) == f"0x{entry:08X} ({words})"
    assert "bit" not in value_words(index, 0, 8, 3, None, hexadecimal=True)


# Transfers


def taken(*frames: tuple[int, str]) -> tuple[list[object], list[Value]]:
    """The data of each frame as it is shown, and the values that came over."""
    transfers, data, values = Transfers(), list[object](), list[Value]()
    for can_id, text in frames:
        one = data_frame(can_id, bytes.fromhex(text))
        found, value = transfers.take("can1", one.data, dissect(one))
        data.append(found.fields.get("data"))
        values += [value] if value is not None else []
    return data, values


def test_a_segment_of_a_block_shows_what_is_behind_its_number() -> None:
    """9 bytes in two segments: 01 .. 07, then 08 and 09, the last one."""
    data, values = taken(
        (0x603, "C600200109000000"), (0x583, "A400200102000000"), (0x603, "0101020304050607"),
        (0x603, "8208090000000000"), (0x583, "A202020000000000"), (0x603, "D500000000000000"),
        (0x583, "A1"),
    )  # fmt: skip
    assert data[2:4] == [bytes(range(1, 8)), bytes([8, 9, 0, 0, 0, 0, 0])]
    assert values == [Value(0x2000, 1, bytes(range(1, 10)))]


@pytest.mark.parametrize(
    ("request_", "answer_"),
    [
        ("2B40600006000000", "6040600000000000"),  # a download
        ("4041600000000000", "4B41600037020000"),  # an upload
    ],
)
def test_an_answer_that_comes_twice_completes_nothing_again(request_: str, answer_: str) -> None:
    _, values = taken((0x603, request_), (0x583, answer_), (0x583, answer_))
    assert len(values) == 1
    _, none = taken((0x583, answer_))
    assert none == []
    _, both = taken((0x603, request_), (0x583, answer_), (0x603, request_), (0x583, answer_))
    assert len(both) == 2


# What is shown


def test_an_error_frame_has_no_identifier_and_keeps_its_column(
    tmp_path: Path,
    rig: Settings,  # noqa: F811
) -> None:
    lines = answer(tmp_path, [(1, "can1 703#05"), (2, "can1 20000080#0000000000000000")], rig)
    assert lines == [
        "     1.000  can1   703  Z.heartbeat      operational",
        "     2.000  can1        error frame",
    ]


@pytest.mark.parametrize("word", ["3", "z", "Z", "3.heartbeat", "Z.heartbeat", "heartbeat"])
def test_a_frame_is_asked_for_by_the_number_of_its_node_and_by_its_axis(
    word: str,
    tmp_path: Path,
    rig: Settings,  # noqa: F811
) -> None:
    frames = [(1.0, "can1 703#05"), (2.0, "can1 080#"), (3.0, "can1 183#370200000000")]
    lines = answer(tmp_path, frames, rig, only=(word,))
    assert [line.split()[0] for line in lines if "Z." in line][:1] == ["1.000"]
    assert not any("SYNC" in line for line in lines)


@pytest.mark.parametrize("is_all", [True, False])
def test_where_something_of_a_line_is_shown_nothing_says_that_nothing_is(
    is_all: bool, tmp_path: Path
) -> None:
    """The same datagram twice: the second one is shown only with all."""
    path = tmp_path / "some.pcapng"
    one = frame((FPRD, 1001, 0x0120, b"\x02\0", 1))
    path.write_bytes(section() + interface(ETHERNET) + packet(1000, one) + packet(2000, one))
    lines = [*tell_log([path], None, Selection(is_all=is_all))]
    assert [line.split()[0] for line in lines] == ["1.000", "2.000"][: 1 + is_all]


@pytest.mark.parametrize("more", [-1, 1, 4])
def test_an_image_that_is_longer_or_shorter_than_that_of_the_rig_is_bytes(more: int) -> None:
    command, position, offset, data, counter = image_of_three(9)
    other = data[:more] if more < 0 else data + bytes(more)
    (one,) = names_of("probe-xyz-ethercat").describe(
        "ec1", frame((LRW, position, offset, other, counter))
    )
    assert (one.name, one.text) == ("LRW", f"WKC 9  {other.hex(' ')}")
    assert command == LRW


# Files


@pytest.mark.parametrize("blank", [0, 1, 3])
@pytest.mark.parametrize(
    ("text", "channel"),
    [
        ("(1.000000) can0 703#00\n", "can0"),
        ("  can0  703   [1]  00\n", "can0"),
        ("date Mon Nov 30 10:00:00 2026\nbase hex  timestamps absolute\n"
         "   1.000000 1  703             Rx   d 1 00\n", 0),
    ],
)  # fmt: skip
def test_blank_lines_before_a_log_say_nothing_of_its_kind(
    blank: int, text: str, channel: object, tmp_path: Path
) -> None:
    path = tmp_path / "some.txt"
    path.write_text("\n" * blank + text, encoding="utf-8")
    (message,) = messages_of([path])
    assert (message.arbitration_id, message.channel) == (0x703, channel)


@pytest.mark.parametrize("channel", ["0", "1", "can1"])
def test_error_frames_of_candump_are_of_the_same_channel_as_others(
    channel: str, tmp_path: Path
) -> None:
    path = tmp_path / "some.log"
    path.write_text(
        f"(1.000000) {channel} 703#00\n(2.000000) {channel} 20000080#0000000000000000\n",
        encoding="utf-8",
    )
    plain, error = messages_of([path])
    assert (plain.is_error_frame, error.is_error_frame) == (False, True)
    assert plain.channel == error.channel
    assert type(plain.channel) is type(error.channel)


def test_frames_are_counted_as_they_are_read(tmp_path: Path) -> None:
    path = tmp_path / "some.log"
    path.write_text("".join(f"({n}.000000) can0 703#00\n" for n in range(7)), encoding="utf-8")
    progress = Progress()
    assert len([*messages_of([path], progress)]) == progress.frames == 7
    assert len([*messages_of([path], progress)]) == 7
    assert progress.frames == 14


@pytest.mark.parametrize("name", ["", "vcan0"])
def test_a_capture_without_names_is_of_the_only_segment_of_a_rig(name: str, tmp_path: Path) -> None:
    """An interface with another name has a note that it is taken for that segment."""
    path = tmp_path / "some.pcapng"
    options = {NAME: name.encode()} if name else {}
    path.write_bytes(section() + interface(227, options) + packet(1000, BOOT))
    lines = [*tell_log([path], settings_of(RIGS / "probe-z.toml", []), Selection())]
    notes = [line for line in lines if "is taken for" in line]
    assert notes == ([f"channel {name} of the log is taken for segment can1"] if name else [])
    assert lines[-1].split()[1:] == ["can1", "703", "Z.heartbeat", "boot-up"]


@pytest.mark.parametrize(("channel", "name"), [("can9", "can9"), (7, "7"), (None, "NAME")])
def test_the_user_may_say_which_segment_a_channel_is(channel: object, name: str) -> None:
    channels = Channels(["can1", "can2"], {}, lambda: {channel, "other"})
    assert channels.segment(channel) == ("" if channel is None else str(channel))
    whose = "without a name" if channel is None else name
    assert channels.notes() == [
        f"channel {whose} of the log is no segment of the rig (can1, can2);"
        f" --segment {name}=can1 says which one it is"
    ]
    assert channels.notes() == []
    assert channels.segment(channel) == ("" if channel is None else str(channel))
    assert channels.notes() == []


@pytest.mark.parametrize("more", [b"", bytes(10), b"\x99\x98"])
def test_a_mailbox_ends_with_its_own_length_whatever_is_behind_it(more: bytes) -> None:
    """The memory of a mailbox is longer than most messages, and keeps what was there before."""
    names = names_of("probe-xyz-ethercat")
    for content, words in (
        (box(5, struct.pack("<BBHi", 2, 0x40, 51, 70), more), "SoE answer S-0-0051 = 70"),
        (box(3, coe(3, b"\x10", b"12345678"), more), "SDO answer, a part of 8 bytes"),
        (box(3, coe(2, struct.pack("<BHBI", 0x21, 0x1010, 1, 4), b"save"), more),
         "SDO write 0x1010:1 Store all parameters, 4 bytes"),
    ):  # fmt: skip
        (one,) = names.describe("ec1", frame((FPRD, 1002, 0x1080, content, 1)))
        assert one.text == f"WKC 1  {words}"
