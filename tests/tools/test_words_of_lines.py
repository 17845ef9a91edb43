"""Frames of an EtherCAT line in words: each axis of an image its own place, each slave its name.

Frames are built by hand: datagram (command, index, ADP, ADO, length, events), data, counter.
"""

import struct
from pathlib import Path

import pytest

from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.bus_log.ethercat.words import LineNames

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
APRD, FPRD, FPWR, BRD, LRW, FRMW = 1, 4, 5, 7, 12, 14
PER_5_MM = 2**19  # 20 bit on a lead of 10 mm


def names_of(rig: str) -> LineNames:
    return LineNames(settings_of(RIGS / f"{rig}.toml", []))


@pytest.fixture(scope="module")
def three() -> LineNames:
    """Of X, Y and Z on one line."""
    return names_of("probe-xyz-ethercat")


def frame(*datagrams: tuple[int, int, int, bytes, int]) -> bytes:
    """Of command, ADP, ADO, data, counter."""
    parts = b""
    for place, (command, position, offset, data, counter) in enumerate(datagrams):
        more = 0x8000 if place + 1 < len(datagrams) else 0
        head = struct.pack("<BBHHHH", command, 0, position, offset, len(data) | more, 0)
        parts += head + data + struct.pack("<H", counter)
    whole = bytes(12) + b"\x88\xa4" + struct.pack("<H", len(parts) | 1 << 12) + parts
    return whole.ljust(60, b"\0")


def lines(names: LineNames, *datagrams: tuple[int, int, int, bytes, int]) -> list[tuple[str, str]]:
    return [(one.name, one.text) for one in names.describe("ec1", frame(*datagrams))]


def image_of_three(counter: int) -> tuple[int, int, int, bytes, int]:
    """X, Y, Z: sent to 5, 10, 15 mm, are at 20, 25, 30 mm, have latched 35, 40, 45 mm."""
    outputs = [struct.pack("<HiH", 15, mm * PER_5_MM // 5, 0x11) for mm in (5, 10, 15)]
    inputs = [
        struct.pack("<HiHiHI", 0x1237, mm * PER_5_MM // 5, 3, (mm + 15) * PER_5_MM // 5, 2, 0)
        for mm in (20, 25, 30)
    ]
    return LRW, 0, 1, b"".join([*outputs, *inputs, bytes(3)]), counter


def test_each_axis_has_its_own_place_in_the_image(three: LineNames) -> None:
    assert three.axes == ["X", "Y", "Z"]
    found = dict(lines(three, image_of_three(9)))
    assert [*found] == ["X.outputs", "X.inputs", "Y.outputs", "Y.inputs", "Z.outputs", "Z.inputs"]
    for axis, *places in (("X", 5, 20, 35), ("Y", 10, 25, 40), ("Z", 15, 30, 45)):
        sent, read = found[f"{axis}.outputs"], found[f"{axis}.inputs"]
        assert sent.startswith("WKC 9  Controlword 0x000F"), sent
        assert f"({places[0]}.000000 mm)" in sent
        assert sent.count("mm)") == 1, sent
        assert [f"({mm}.000000 mm)" in read for mm in places[1:]] == [True, True], read
        assert read.count("mm)") == 2, read


def test_an_image_may_be_asked_for_by_axis_direction_and_object(three: LineNames) -> None:
    found = {one.name: one for one in three.describe("ec1", frame(image_of_three(9)))}
    assert found["Y.outputs"].tags == {"y.outputs", "y", "image", "6040", "607a", "60b8"}
    assert found["Z.inputs"].tags == {
        "z.inputs", "z", "image", "6041", "6064", "60b9", "60ba", "60d5", "60fd",
    }  # fmt: skip


def test_a_counter_that_is_not_that_of_all_slaves_is_wrong_on_every_line(three: LineNames) -> None:
    """3 for each drive (ETG.1000.4: 1 for a read, 2 for a write), 1 more for inputs alone."""
    for counter, is_wrong in ((9, False), (6, True), (10, True)):
        for _, text in lines(three, image_of_three(counter)):
            start = f"WKC {counter}  WRONG, 9 expected  " if is_wrong else f"WKC {counter}  "
            assert text.startswith(start), text
            assert ("WRONG" in text) is is_wrong


def test_an_image_of_another_size_or_line_is_bytes(three: LineNames) -> None:
    short = (LRW, 0, 1, b"\1\2\3", 2)
    assert lines(three, short) == [("LRW", "WKC 2  01 02 03")]
    for names, segment in ((three, "ec2"), (LineNames(None), "ec1")):
        (one,) = names.describe(segment, frame(image_of_three(9)))
        assert (one.name, one.tags) == ("LRW", {"image"})


def test_registers_of_a_terminal_are_behind_the_drives() -> None:
    """Line of Z and a terminal: 8 + 18 bytes of the drive, its mailbox byte, 34 from 0x09AE on."""
    names = names_of("plc-timestamp-line")
    shown = bytes(range(34))
    outputs = struct.pack("<HiH", 15, 0, 0)
    data = outputs + bytes(18) + b"\xff" + shown
    found = list(names.describe("ec1", frame((LRW, 0, 1, data, 4))))
    assert [one.name for one in found] == ["Z.outputs", "Z.inputs", "terminal.inputs"]
    assert found[2].text == f"WKC 4  from 09AE on {shown.hex(' ')}"
    assert found[2].tags == {"terminal.inputs", "terminal", "image"}
    (*_, last) = names.describe("ec1", frame((LRW, 0, 1, data, 3)))
    assert last.text.startswith("WKC 3  WRONG, 4 expected  from 09AE on 00 01")


def test_the_image_of_a_sercos_drive_has_the_names_of_idents() -> None:
    """MDT: S-0-0134, S-0-0047; AT: S-0-0135, S-0-0051, S-0-0130."""
    names = names_of("probe-z-sercos")
    sent = struct.pack("<Hi", 0xE000, PER_5_MM)
    read = struct.pack("<Hii", 0xC000, PER_5_MM // 2, -PER_5_MM)
    found = list(names.describe("ec1", frame((LRW, 0, 1, sent + read + b"\0", 3))))
    assert [one.name for one in found] == ["Z.outputs", "Z.inputs"]
    assert found[0].text == (
        "WKC 3  S-0-0134 0xE000 on, enable, run; S-0-0047 524288 (5.000000 mm)"
    )
    assert found[1].text.split("; ")[1:] == [
        "S-0-0051 262144 (2.500000 mm)", "S-0-0130 -524288 (-5.000000 mm)",
    ]  # fmt: skip
    assert found[1].tags == {"z.inputs", "z", "image", "s-0-0135", "s-0-0051", "s-0-0130"}


def test_a_register_belongs_to_the_slave_with_this_address(three: LineNames) -> None:
    for command, position, name in (
        (FPRD, 1001, "X.FPRD"), (FPWR, 1002, "Y.FPWR"), (FPRD, 1003, "Z.FPRD"),
        (FPRD, 1000, "1000.FPRD"), (FPRD, 1004, "1004.FPRD"), (FRMW, 1001, "X.FRMW"),
        (BRD, 3, "-.BRD"), (APRD, 0xFFFF, "-.APRD"),
    ):  # fmt: skip
        (one,) = three.describe("ec1", frame((command, position, 0x0120, b"\x02\0", 1)))
        assert (one.name, one.text) == (name, "WKC 1  AL_CONTROL PREOP")
        whose, _, word = name.partition(".")
        own = [whose.lower()] if whose != "-" else []
        assert one.tags == {word.lower(), "al_control", *own}, name
        assert one.is_usual is (command == BRD), name


def test_registers_and_states_have_their_names(three: LineNames) -> None:
    """ETG.1000.6: 0x0120, 0x0130 with its code at 0x0134; the system time is 0x0910."""
    for offset, data, text in (
        (0x0120, b"\x11\0", "AL_CONTROL INIT, acknowledges an error"),
        (0x0120, b"\x08\0", "AL_CONTROL OP"),
        (0x0130, b"\x04\0\0\0\0\0", "AL_STATUS SAFEOP"),
        (0x0130, b"\x14\0\0\0\x1b\0", "AL_STATUS SAFEOP"),
        (0x0910, b"\1\2", "SYSTEM_TIME 01 02"),
        (0x0FFE, b"\7", "0x0FFE 07"),
    ):
        (one,) = three.describe("ec1", frame((FPRD, 1002, offset, data, 1)))
        assert one.text.startswith(f"WKC 1  {text}"), one.text
        assert ("(" in one.text) is (data[4:5] == b"\x1b"), one.text
        assert one.is_usual is (offset == 0x0910)


def box(kind: int, body: bytes, more: bytes = b"") -> bytes:
    """A mailbox message (ETG.1000.4 5.6); more: what is behind it."""
    return struct.pack("<HHBB", len(body), 0, 0, kind | 0x30) + body + more


def coe(service: int, *content: bytes) -> bytes:
    return struct.pack("<H", service << 12) + b"".join(content)


MESSAGES = [
    (bytes(16), "nothing", {"mailbox"}),
    (b"\1\2\3", "nothing", {"mailbox"}),
    (box(2, b"\1\2", b"\x99"), "mailbox 02 00 00 00 00 32 01 02", {"mailbox"}),
    (box(3, coe(2, struct.pack("<BHB4x", 0x40, 0x6041, 0))),
     "SDO read 0x6041:0 Statusword", {"sdo", "6041", "6041:0"}),
    (box(3, coe(2, struct.pack("<BHBb3x", 0x2F, 0x6060, 0, 8))),
     "SDO write 0x6060:0 Modes of operation = 8 (0x08; cyclic synchronous position)",
     {"sdo", "6060", "6060:0"}),
    (box(3, coe(3, struct.pack("<BHB4x", 0x60, 0x6060, 0))),
     "SDO written 0x6060:0", {"sdo", "6060", "6060:0"}),
    (box(3, coe(3, struct.pack("<BHBi", 0x43, 0x6064, 0, -2))),
     "SDO answer 0x6064:0 Position actual value = -2 (0xFFFFFFFE)", {"sdo", "6064", "6064:0"}),
    (box(3, coe(3, struct.pack("<BHBI", 0x41, 0x1008, 0, 9), b"123456789")),
     "SDO answer 0x1008:0 Manufacturer device name, 9 bytes", {"sdo", "1008", "1008:0"}),
    (box(3, coe(2, struct.pack("<BHBI", 0x21, 0x1010, 1, 4), b"save")),
     "SDO write 0x1010:1 Store all parameters, 4 bytes", {"sdo", "1010", "1010:1"}),
    (box(3, coe(2, b"\x70", bytes(7))), "SDO read, the next part", {"sdo"}),
    (box(3, coe(3, b"\x10", b"12345678")), "SDO answer, a part of 8 bytes", {"sdo"}),
    (box(3, coe(3, b"\x09", b"123\0\0\0\0")),
     "SDO answer, a part of 3 bytes, the last one", {"sdo"}),
    (box(3, coe(2, b"\x1b", b"12\0\0\0\0\0")),
     "SDO write, a part of 2 bytes, the last one", {"sdo"}),
    (box(3, coe(3, b"\x30", bytes(7))), "SDO written, a part", {"sdo"}),
    (box(3, coe(8, struct.pack("<BBHH2x", 1, 0, 0, 1))),
     "CoE sdo information, 01 00 00 00 01 00 00 00", {"mailbox"}),
    (box(3, coe(2, struct.pack("<BHBI", 0x80, 0x6060, 0, 0x06090030))),
     "SDO abort 0x6060:0: ", {"sdo", "6060", "6060:0"}),
    (box(3, coe(1, struct.pack("<HB5x", 0x8611, 0x20))), "EMCY 0x8611, ", {"emcy"}),
    # S-0-0051, its value, of drive 2
    (box(5, struct.pack("<BBHi", 2 | 2 << 5, 0x40, 51, 70)),
     "SoE answer S-0-0051 = 70 (drive 2)", {"mailbox", "soe", "s-0-0051"}),
]  # fmt: skip


def test_a_message_in_the_memory_of_a_slave(three: LineNames) -> None:
    for data, text, tags in MESSAGES:
        (one,) = three.describe("ec1", frame((FPRD, 1002, 0x1080, data, 1)))
        assert one.name == "Y.FPRD"
        is_whole = not text.startswith(("SDO abort", "EMCY"))  # their words are of other tables
        assert one.text.startswith(f"WKC 1  {text}"), one.text
        assert is_whole is (one.text == f"WKC 1  {text}"), one.text
        assert one.tags == {"fprd", "y", *tags}, text
        assert not one.is_usual


def test_numbers_of_an_sdo_have_the_bytes_that_its_command_says(three: LineNames) -> None:
    """CiA 301: bit 0 says that bits 2 and 3 have how many of the 4 bytes are none."""
    for command, count in ((0x2F, 1), (0x2B, 2), (0x27, 3), (0x23, 4), (0x22, 4), (0x2E, 4)):
        data = box(3, coe(2, struct.pack("<BHBI", command, 0x3999, 1, 0xFFFFFFFF)))
        (one,) = three.describe("ec1", frame((FPWR, 1001, 0x1000, data, 1)))
        number = 256**count - 1
        shown = f"SDO write 0x3999:1 = {number} (0x{number:0{2 * count}X})"
        assert one.text == f"WKC 1  {shown}", (hex(command), one.text)


@pytest.mark.parametrize(("count", "unused"), [(7 - n, n) for n in range(7)])
@pytest.mark.parametrize("is_last", [False, True])
def test_a_short_part_of_an_sdo_has_the_bytes_that_its_command_leaves(
    count: int, unused: int, is_last: bool, three: LineNames
) -> None:
    """CiA 301: bits 1 to 3 have how many of 7 bytes are none, bit 0 marks the last part."""
    end = ", the last one" if is_last else ""
    for toggle in (0, 0x10):
        command = bytes([toggle | unused << 1 | is_last])
        for service, words in ((2, "SDO write"), (3, "SDO answer")):
            data = box(3, coe(service, command, bytes(7)))
            (one,) = three.describe("ec1", frame((FPRD, 1002, 0x1080, data, 1)))
            assert one.text == f"WKC 1  {words}, a part of {count} bytes{end}"


def test_a_long_part_of_an_sdo_has_all_its_bytes(three: LineNames) -> None:
    """ETG.1000: those bits are of a part that is filled up to 7 bytes."""
    for length in (8, 20, 100):
        data = box(3, coe(3, b"\x0f", bytes(length)))
        (one,) = three.describe("ec1", frame((FPRD, 1002, 0x1080, data, 1)))
        assert one.text == f"WKC 1  SDO answer, a part of {length} bytes, the last one"


@pytest.mark.parametrize(("sub", "shown"), [(0, "0"), (9, "9"), (10, "a"), (0x1F, "1f")])
def test_a_subindex_is_asked_for_as_it_is_shown(sub: int, shown: str, three: LineNames) -> None:
    data = box(3, coe(2, struct.pack("<BHB4x", 0x40, 0x3999, sub)))
    (one,) = three.describe("ec1", frame((FPWR, 1001, 0x1000, data, 1)))
    assert {"3999", f"3999:{shown}"} < one.tags
    assert one.text == f"WKC 1  SDO read 0x3999:{shown.upper()}"


def test_several_datagrams_of_a_frame_are_shown_in_their_order(three: LineNames) -> None:
    found = lines(
        three, (FPRD, 1003, 0x0130, b"\x08\0\0\0\0\0", 1), image_of_three(9),
        (FRMW, 1001, 0x0910, bytes(8), 3),
    )  # fmt: skip
    assert [name for name, _ in found] == [
        "Z.FPRD", "X.outputs", "X.inputs", "Y.outputs", "Y.inputs", "Z.outputs", "Z.inputs",
        "X.FRMW",
    ]  # fmt: skip
    assert found[0][1] == "WKC 1  AL_STATUS OP"
