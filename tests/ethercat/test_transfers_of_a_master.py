"""One SDO transfer over a mailbox, message by message, and a drive's values in the image; by hand.

The commands are those of CiA 301 section 7.2.4.3: 40 upload, 2x download, 6x and 0x segments, 80.
"""

import struct
from typing import Any

import pytest

from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.drives.ethercat.coe import Transfer
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.mapped import MappedObject

REQUEST = "0020"  # service 2 in bits 12 to 15
NAME = bytes(range(1, 41))  # 40 bytes
ROOM = 26  # of a message: 16 bytes of data in the first one, 23 in a segment


def read() -> Transfer:
    made = Transfer(0x1008, 2, None, ROOM)
    assert made.first() == bytes.fromhex(f"{REQUEST} 40 0810 02 00000000")
    return made


def asks(text: str) -> bytes:
    return bytes.fromhex(f"{REQUEST} {text}")


def error(made: Transfer) -> tuple[int, int, int | None, bool]:
    assert isinstance(made.result, SdoError)
    return made.result.index, made.result.sub, made.result.code, made.result.by_server


@pytest.mark.parametrize(
    ("command", "size"),
    [("4f", 1), ("4b", 2), ("47", 3), ("43", 4), *((f"4{n:x}", 4) for n in (0x2, 0x6, 0xA, 0xE))],
)
def test_a_short_value_comes_with_the_answer(command: str, size: int) -> None:
    """Without bit 0 the number of unused bytes does not count."""
    made = read()
    assert made.take(bytes.fromhex(f"{command} 0810 02 11223344")) is None
    assert made.result == bytes.fromhex("11223344")[:size]


@pytest.mark.parametrize("size", [1, 5, 15, 16])
@pytest.mark.parametrize("more", [0, 1, 7])
def test_what_fills_up_the_first_message_is_no_data(size: int, more: int) -> None:
    """The complete size says how much of it counts: a slave may send even lengths only."""
    made = read()
    head = bytes.fromhex("41 0810 02") + size.to_bytes(4, "little")
    assert made.take(head + NAME[:size] + b"\xee" * more) is None
    assert made.result == NAME[:size]


@pytest.mark.parametrize("unused", [0, 3, 7])
def test_unused_bytes_count_in_a_segment_of_seven_alone(unused: int) -> None:
    """Bits 1 to 3 of its command; a longer one is as long as its message."""
    made = read()
    made.take(bytes.fromhex("41 0810 02") + (40).to_bytes(4, "little") + NAME[:16])
    assert made.take(bytes((unused << 1 | 1,)) + NAME[16:]) is None
    assert made.result == NAME
    short = read()
    short.take(bytes.fromhex("41 0810 02") + (16 + 7 - unused).to_bytes(4, "little") + NAME[:16])
    assert short.take(bytes((unused << 1 | 1,)) + NAME[16:23]) is None
    assert short.result == NAME[: 16 + 7 - unused]


def test_a_long_value_comes_in_segments_whose_toggle_alternates() -> None:
    """16 bytes with the answer, 20 in a segment, and 4 of 7 in the last one."""
    made = read()
    for _ in range(2):  # begun anew it is read from its begin on
        made.first()
        body = bytes.fromhex("41 0810 02") + (40).to_bytes(4, "little")
        assert made.take(body + NAME[:16]) == asks("60 00000000000000")
        assert made.is_answer(b"\x00" + NAME[16:36])
        assert made.take(b"\x00" + NAME[16:36]) == asks("70 00000000000000")
        assert made.result is None
    assert made.take(bytes((0x10 | 3 << 1 | 1,)) + NAME[36:] + bytes(3)) is None
    assert made.result == NAME


def test_what_fills_a_long_segment_up_is_no_part_of_the_value() -> None:
    """A segment of more than 7 bytes counts no unused ones: the size of the value ends it."""
    made = read()
    body = bytes.fromhex("41 0810 02") + (30).to_bytes(4, "little")
    assert made.take(body + NAME[:16]) == asks("60 00000000000000")
    assert made.take(b"\x01" + NAME[16:30] + b"more") is None
    assert made.result == NAME[:30]


@pytest.mark.parametrize(
    ("answers", "code"),
    [
        (["60 0810 02 00000000"], 0x05040001),  # of a download
        (["41 0810 02 28000000", "10 01020304050607"], 0x05030000),
        (["41 0810 02 28000000", "00 01020304050607", "00 01020304050607"], 0x05030000),
        (["41 0810 02 28000000", "20 01020304050607"], 0x05040001),
        (["41 0810 02 28000000", "01 01020304050607"], 0x06070010),  # the last one: 7 of 40
    ],
)
def test_an_upload_that_goes_wrong_is_aborted_by_the_control(answers: list[str], code: int) -> None:
    made = read()
    following = [made.take(bytes.fromhex(answer)) for answer in answers]
    assert following[-1] == asks("80 0810 02") + code.to_bytes(4, "little")
    assert error(made) == (0x1008, 2, code, False)


@pytest.mark.parametrize("data", [None, b"\x01", bytes(40)])
def test_what_the_drive_aborts_is_its_own_error(data: bytes | None) -> None:
    made = Transfer(0x1008, 2, data, ROOM)
    made.first()
    assert made.take(bytes.fromhex("80 0810 02 02000106")) is None
    assert error(made) == (0x1008, 2, 0x06010002, True)


@pytest.mark.parametrize(
    ("data", "first"),
    [
        ("11", "2f 0810 02 11000000"),
        ("1122", "2b 0810 02 11220000"),
        ("112233", "27 0810 02 11223300"),
        ("11223344", "23 0810 02 11223344"),
        ("", "21 0810 02 00000000"),
        ("1122334455", "21 0810 02 05000000 1122334455"),
    ],
)
def test_what_fits_is_written_with_one_message(data: str, first: str) -> None:
    made = Transfer(0x1008, 2, bytes.fromhex(data), ROOM)
    assert made.first() == asks(first)
    assert made.take(bytes.fromhex("60 0810 02 00000000")) is None
    assert made.result == b""


def test_a_long_value_is_written_in_segments_whose_toggle_alternates() -> None:
    """16 of 42 bytes with the first message, 23 in a segment, and 3 of 7 in the last one."""
    data = NAME + b"\x77\x78"
    made = Transfer(0x1008, 2, data, ROOM)
    for _ in range(2):  # begun anew it is written from its begin on
        assert made.first() == asks("21 0810 02 2a000000") + data[:16]
        assert made.take(bytes.fromhex("60 0810 02 00000000")) == asks("00") + data[16:39]
        last = asks(f"{0x10 | 4 << 1 | 1:02x}") + data[39:] + bytes(4)
        assert made.take(bytes.fromhex("20 00000000000000")) == last
        assert made.result is None
    assert made.take(bytes.fromhex("30 00000000000000")) is None
    assert made.result == b""


@pytest.mark.parametrize("room", range(11, 27))
@pytest.mark.parametrize("length", [5, 20, 33, 40])
def test_only_a_segment_of_less_than_seven_bytes_has_unused_ones(room: int, length: int) -> None:
    """CiA 301: bits 1 to 3 of the command; over a mailbox a segment has room for more than 7."""
    made = Transfer(0x1008, 2, NAME[:length], room)
    written = made.first()[10:]
    assert len(written) == min(length, room - 10)  # service, command, object, size
    following = made.take(bytes.fromhex("60 0810 02 00000000"))
    toggle = 0
    while following is not None:
        command, body = following[2], following[3:]
        unused = command >> 1 & 7
        assert (command & 0x10, len(body)) == (toggle, max(7, min(length - len(written), room - 3)))
        assert unused == max(0, 7 - (length - len(written)))
        written += body[: len(body) - unused]
        assert command & 1 == (len(written) == length)
        following = made.take(bytes((0x20 | toggle,)) + bytes(7))
        toggle ^= 0x10
    assert (written, made.result) == (NAME[:length], b"")


@pytest.mark.parametrize(
    ("answers", "code"),
    [
        (["43 0810 02 00000000"], 0x05040001),  # of an upload
        (["60 0810 02 00000000", "30 00000000000000"], 0x05030000),
        (["60 0810 02 00000000", "20 00000000000000", "20 00000000000000"], 0x05030000),
        (["60 0810 02 00000000", "00 00000000000000"], 0x05040001),
    ],
)
def test_a_download_that_goes_wrong_is_aborted_by_the_control(
    answers: list[str], code: int
) -> None:
    made = Transfer(0x1008, 2, bytes(60), ROOM)
    made.first()
    following = [made.take(bytes.fromhex(answer)) for answer in answers]
    assert following[-1] == asks("80 0810 02") + code.to_bytes(4, "little")
    assert error(made) == (0x1008, 2, code, False)


def test_only_an_answer_about_its_object_belongs_to_a_transfer() -> None:
    made = read()
    for body, belongs in (
        ("43 0810 02 00000000", True),
        ("43 0810 01 00000000", False),
        ("43 0910 02 00000000", False),
        ("00 01020304050607", False),  # no segment has been asked for
    ):
        assert made.is_answer(bytes.fromhex(body)) is belongs


def test_in_segments_what_has_an_object_is_of_that_object() -> None:
    """Commands 0 and 1 are segments (bits 5 to 7); an abort and a first answer name an object."""
    made = read()
    made.take(bytes.fromhex("41 0810 02") + (40).to_bytes(4, "little") + NAME[:16])
    for body, belongs in (
        ("00 01020304050607", True), ("10 01020304050607", True), ("20 00000000000000", True),
        ("80 0810 02 02000106", True), ("80 0810 01 02000106", False),
        ("80 0910 02 02000106", False), ("43 0910 02 00000000", False),
        ("60 0910 02 00000000", False),
    ):  # fmt: skip
        assert made.is_answer(bytes.fromhex(body)) is belongs, body
    made.first()  # begun anew nothing comes in segments
    assert not made.is_answer(bytes.fromhex("00 01020304050607"))


# ---- values of CiA 402 in the process image

INPUTS = tuple(
    MappedObject(index, 0, bits, signed, field)
    for index, bits, signed, field in (
        (0x6041, 16, False, "statusword"), (0x6064, 32, True, "actual"),
        (0x60B9, 16, False, "probe_status"), (0x60BA, 32, True, ""), (0x60D5, 16, False, ""),
        (0x60BD, 32, True, ""), (0x60D8, 16, False, ""), (0x60D4, 32, False, ""),
    )
)  # fmt: skip
ENABLED, NO_STATE = 0x0237, 0x0004


def image() -> ImageData:
    settings = SlaveSettings("Z", 1000.0, node_id=1, inputs=[Pdo(0x1A00, INPUTS)])
    made = ImageData(settings, 0x60BA)
    made.begin()
    return made


def taken(made: ImageData, word: int = ENABLED) -> dict[str, Any]:
    made.forget()
    made.arrived(struct.pack("<HiHiHiHI", word, -5, 3, 1300, 7, -1310, 9, 4711))
    found = zip(TAKEN, made.take(), strict=True)
    return {name: value for name, value in found if value is not None}


def test_another_latch_has_its_own_counter_and_stamp() -> None:
    """60BA with 60D5 and no stamp, 60BD with 60D8 and 60D4; there and back, 60BB is refused."""
    made = image()
    whole = {"statusword": ENABLED, "actual": -5, "probe_status": 3}
    first = whole | {"latch": 1300, "latch_count": 7}
    other = whole | {"latch": -1310, "latch_count": 9, "stamp": 4711}
    assert taken(made) == first
    for objects, expected in (((0x60BD, 0x60D8), other), ((0x60BA, 0x60D5), first)):
        assert made.choose_latch(*objects)
        assert taken(made) == expected
        assert not made.choose_latch(0x60BB, 0x60D6)
        assert taken(made) == expected


def test_a_status_word_that_fits_no_state_counts_as_missing() -> None:
    """CiA 402: xxxx xxxx x0xx 0100 is none. Good, none, none, good, and none again."""
    made, shown = image(), []
    for word in (ENABLED, NO_STATE, NO_STATE, 0x0250, NO_STATE):
        found = taken(made, word)
        shown.append((found.get("statusword"), made.missing[0], made.is_disturbed))
    assert shown == [
        (ENABLED, 0, False), (None, 1, True), (None, 2, True), (0x0250, 0, False), (None, 1, True),
    ]  # fmt: skip
    assert made.missing_alarm("Z", 0).id == 900081
    made.forget()
    made.take()
    assert made.missing_alarm("Z", 0).id == 900730
