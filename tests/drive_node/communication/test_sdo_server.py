"""The SDO server frame by frame, as CiA 301 writes the protocols down.

Byte 0 of a frame is the command, then index (low byte first), sub-index, four bytes of data.
"""

from binascii import crc_hqx
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.sdo_transfers import BlockUpload, SegmentOutlet
from axisrig.kernel.time.clock import US
from axisrig.kernel.time.scheduler import new_scheduler

Make = Callable[..., Any]

TOGGLE, TIMED_OUT, COMMAND = 0x05030000, 0x05040000, 0x05040001
BLOCK_SIZE, SEQUENCE, CRC = 0x05040002, 0x05040003, 0x05040004
NAME = b"axisrig DS402 drive"


def aborted(answer: str, code: int) -> bool:
    return answer[:2] == "80" and answer[8:] == code.to_bytes(4, "little").hex()


# Expedited


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        ("4000100000000000", "4300100092010200"),  # 1000: U32 0x00020192
        ("4001100000000000", "4f01100000000000"),  # 1001: U8
        ("4017100000000000", "4b17100000000000"),  # 1017: U16
        ("4014100000000000", "4314100083000000"),  # 1014: U32 0x80 + node
    ],
)
def test_expedited_upload(stranger: Make, request_: str, answer: str) -> None:
    assert stranger().sdo(request_) == answer


@pytest.mark.parametrize(
    "head",
    ["2b", "22", "23"],
    ids=["size 2", "size not said", "size 4"],
)
def test_expedited_download_of_16_bits(stranger: Make, head: str) -> None:
    """A client that does not say the size leaves it to the object; 4 bytes are too many."""
    drive = stranger()
    answer = drive.sdo(head + "171000" + "e8030000")
    if head == "23":
        assert aborted(answer, 0x06070012)
        assert drive.read(0x1017) == 0
    else:
        assert answer == "6017100000000000"
        assert drive.read(0x1017) == 1000


@pytest.mark.parametrize("head", ["22", "23"], ids=["size not said", "size 4"])
def test_expedited_download_of_32_bits(stranger: Make, head: str) -> None:
    """Four bytes are the most that fit, with or without their number."""
    drive = stranger()
    assert drive.sdo(head + "656000" + "c4090000") == "6065600000000000"
    assert drive.read(0x6065) == 2500


def test_an_object_longer_than_an_expedited_frame_is_not_written_by_one(stranger: Make) -> None:
    """1008, a name of more than four bytes, cannot be written at all; size not said."""
    assert stranger().sdo("22081000" + "41424344")[:2] == "80"


def test_one_byte_for_a_16_bit_object_is_too_short(stranger: Make) -> None:
    assert aborted(stranger().sdo("2f17100001000000"), 0x06070013)


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        ("4000200000000000", 0x06020000),  # 2000 does not exist
        ("4018100500000000", 0x06090011),  # 1018:5
        ("4000140400000000", 0x06090011),  # 1400:4 is reserved
        ("4006100100000000", 0x06090011),  # a variable has sub-index 0 only
        ("2300100001000000", 0x06010002),  # 1000 is constant
        ("2f01100001000000", 0x06010002),  # 1001 is read-only
        ("2300120100060000", 0x06010002),  # 1200: the default SDO channel stays
        ("2321100000000000", 0x06010002),  # 1021, the EDS
        ("2f18100501000000", 0x06090011),
        ("2f00200001000000", 0x06020000),
        ("4012100000000000", 0x06020000),  # 1012, TIME: what the page calls missing
        ("4001120000000000", 0x06020000),  # 1201, a second server
        ("4080120000000000", 0x06020000),  # 1280, a client
        ("40501f0000000000", 0x06020000),  # 1F50, program download
        ("4029100200000000", 0x06090011),  # 1029:2
        ("4000140300000000", 0x06090011),  # 1400:3, inhibit time of an RPDO
        ("4004140000000000", 0x06020000),  # a fifth RPDO
        ("e000100000000000", COMMAND),  # command specifier 7
        ("0000000000000000", COMMAND),  # a segment without a transfer
        ("6000000000000000", COMMAND),
        ("a300000000000000", COMMAND),  # start of a block upload that nobody has initiated
        ("c100000000000000", COMMAND),  # end of a block download
    ],
)
def test_refusals(stranger: Make, request_: str, code: int) -> None:
    answer = stranger().sdo(request_)
    assert aborted(answer, code)
    if code != COMMAND:
        assert answer[2:8] == request_[2:8]


@pytest.mark.parametrize("data", ["", "40", "40001000", "40001000000000"])
def test_a_frame_that_has_not_8_bytes_is_no_sdo(stranger: Make, data: str) -> None:
    drive = stranger()
    assert drive.sdo(data) == ""
    assert drive.sdo("4000100000000000") == "4300100092010200"


def test_default_channel_is_told(stranger: Make) -> None:
    drive = stranger()
    assert (drive.read(0x1200, 1), drive.read(0x1200, 2)) == (0x603, 0x583)


# Segmented


def test_segmented_upload(stranger: Make) -> None:
    """19 characters: 7, 7 and 5; the toggle bit alternates, the last one says so."""
    drive = stranger()
    assert drive.sdo("4008100000000000") == "4108100013000000"
    assert drive.sdo("6000000000000000") == "00" + NAME[:7].hex()
    assert drive.sdo("7000000000000000") == "10" + NAME[7:14].hex()
    assert drive.sdo("6000000000000000") == "05" + NAME[14:].hex() + "0000"
    assert aborted(drive.sdo("7000000000000000"), COMMAND)


def test_segmented_download(stranger: Make) -> None:
    """Four bytes in two segments: the value is written with the last one."""
    drive = stranger()
    assert drive.sdo("2107100004000000") == "6007100000000000"
    assert drive.sdo("08" + "e8030000000000") == "2000000000000000"  # 3 bytes
    drive_value = drive.bench.node.slave.objects.value(0x1007)
    assert drive_value == 0
    assert drive.sdo("1d" + "01000000000000") == "3000000000000000"  # the last byte
    assert drive.read(0x1007) == 0x010003E8


def test_segmented_download_of_unsaid_size(stranger: Make) -> None:
    drive = stranger()
    assert drive.sdo("2017100000000000") == "6017100000000000"
    assert drive.sdo("0b" + "e8030000000000") == "2000000000000000"
    assert drive.read(0x1017) == 1000


@pytest.mark.parametrize(
    ("initiate", "code"),
    [
        ("2117100003000000", 0x06070012),
        ("2117100001000000", 0x06070013),
        ("2101100001000000", 0x06010002),
        ("2100200001000000", 0x06020000),
        ("2118100901000000", 0x06090011),
    ],
)
def test_segmented_download_is_refused_before_its_data(
    stranger: Make, initiate: str, code: int
) -> None:
    drive = stranger()
    assert aborted(drive.sdo(initiate), code)
    assert aborted(drive.sdo("0d" + "01000000000000"), COMMAND)


@pytest.mark.parametrize(
    ("segment", "code"),
    [
        ("1b" + "e8030000000000", TOGGLE),
        ("09" + "e8030000000000", 0x06070012),  # 3 bytes
        ("0d" + "e8000000000000", 0x06070010),  # 1 byte, and the end
        ("6000000000000000", COMMAND),  # segment of an upload
    ],
)
def test_wrong_segment_ends_the_download(stranger: Make, segment: str, code: int) -> None:
    drive = stranger()
    drive.sdo("2117100002000000")
    answer = drive.sdo(segment)
    assert aborted(answer, code)
    assert answer[2:8] == "171000"
    assert drive.read(0x1017) == 0


def test_wrong_toggle_ends_the_upload(stranger: Make) -> None:
    drive = stranger()
    drive.sdo("4008100000000000")
    assert aborted(drive.sdo("7000000000000000"), TOGGLE)
    assert aborted(drive.sdo("6000000000000000"), COMMAND)


def test_abort_of_the_client_gets_no_answer(stranger: Make) -> None:
    drive = stranger()
    drive.sdo("4008100000000000")
    assert drive.sdo("8008100000000008") == ""
    assert aborted(drive.sdo("6000000000000000"), COMMAND)


def test_a_new_request_takes_the_place_of_a_transfer(stranger: Make) -> None:
    """A client that gave up after its time-out begins again; of the old nothing is written."""
    drive = stranger()
    drive.sdo("2117100002000000")
    assert drive.sdo("4000100000000000") == "4300100092010200"
    assert aborted(drive.sdo("0b" + "e8030000000000"), COMMAND)
    assert drive.read(0x1017) == 0


def test_a_client_that_falls_silent_gets_an_abort_after_1_s(stranger: Make) -> None:
    drive = stranger()
    drive.sdo("2117100002000000")
    begin = len(drive.heard)
    drive.run_ms(998)
    assert drive.heard[begin:] == []
    drive.run_ms(2)
    ((can_id, answer),) = drive.heard[begin:]
    assert can_id == 0x583
    assert aborted(answer, TIMED_OUT)
    drive.run_ms(5000)
    assert len(drive.heard) == begin + 1


def test_the_time_of_a_client_begins_anew_with_every_segment(stranger: Make) -> None:
    drive = stranger()
    drive.sdo("4008100000000000")
    for first, part in (("00", NAME[:7]), ("10", NAME[7:14]), ("05", NAME[14:] + bytes(2))):
        drive.run_ms(700)
        assert drive.sdo(f"{0x60 | int(first, 16) & 0x10:02x}00000000000000") == first + part.hex()


# Block upload


def block(drive: Any, frame: str, wait_ms: float = 40) -> list[str]:
    return [data for can_id, data in drive.after(0x603, frame, wait_ms=wait_ms) if can_id == 0x583]


def test_block_upload(stranger: Make) -> None:
    """19 bytes in blocks of 2 segments: two blocks, CRC over all, 2 bytes of the last unused."""
    drive = stranger()
    assert block(drive, "a408100002000000") == ["c608100013000000"]
    assert block(drive, "a300000000000000") == ["01" + NAME[:7].hex(), "02" + NAME[7:14].hex()]
    assert block(drive, "a202020000000000") == ["81" + NAME[14:].hex() + "0000"]
    crc = crc_hqx(NAME, 0).to_bytes(2, "little").hex()
    assert block(drive, "a201020000000000") == ["c9" + crc + "0000000000"]
    assert block(drive, "a100000000000000") == []
    assert aborted(drive.sdo("a100000000000000"), COMMAND)


def test_crc_of_the_standard() -> None:
    """CiA 301: the check sum of "123456789" is 31C3 hex (CRC-16/XMODEM)."""
    assert crc_hqx(b"123456789", 0) == 0x31C3


def test_block_upload_repeats_from_the_acknowledged_segment(stranger: Make) -> None:
    drive = stranger()
    block(drive, "a008100003000000")
    assert len(block(drive, "a300000000000000")) == 3
    again = block(drive, "a201010000000000")  # only the first came; blocks of one from now on
    assert again == ["01" + NAME[7:14].hex()]
    assert block(drive, "a201010000000000") == ["81" + NAME[14:].hex() + "0000"]
    assert block(drive, "a201010000000000") == ["c900000000000000"]  # no CRC was asked for


def test_block_upload_of_few_bytes_may_be_an_ordinary_one(stranger: Make) -> None:
    """Byte 5: up to so many bytes the server may switch the protocol."""
    drive = stranger()
    assert block(drive, "a40010007f040000") == ["4300100092010200"]
    assert block(drive, "a40010007f030000") == ["c600100004000000"]


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        (["a408100000000000"], BLOCK_SIZE),
        (["a408100080000000"], BLOCK_SIZE),
        (["a40810007f000000", "a203020000000000"], COMMAND),  # acknowledged before the start
        (["a408100002000000", "a300000000000000", "a203020000000000"], SEQUENCE),
        (["a408100002000000", "a300000000000000", "a202000000000000"], BLOCK_SIZE),
        (["a408100002000000", "a300000000000000", "a300000000000000"], COMMAND),
        (["a408100002000000", "a300000000000000", "6000000000000000"], COMMAND),
        (["a4ff1f007f000000"], 0x06020000),
    ],
)
def test_wrong_steps_of_a_block_upload(stranger: Make, frames: list[str], code: int) -> None:
    drive = stranger()
    *before, last = frames
    for frame in before:
        block(drive, frame)
    (answer,) = block(drive, last)
    assert aborted(answer, code)


# Block download


def test_block_download(stranger: Make) -> None:
    """Two bytes in one segment: 5 of 7 unused."""
    drive = stranger()
    crc = crc_hqx(bytes.fromhex("e803"), 0).to_bytes(2, "little").hex()
    assert drive.sdo("c617100002000000") == "a41710007f000000"
    assert drive.sdo("81" + "e8030000000000") == "a2017f0000000000"
    assert drive.sdo("d5" + crc + "0000000000") == "a100000000000000"
    assert drive.read(0x1017) == 1000


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        (["c217100003000000"], 0x06070012),
        (["c201100001000000"], 0x06010002),
        (["c617100002000000", "81e8030000000000", "d500000000000000"], CRC),
        (["c217100002000000", "81e8030000000000", "d100000000000000"], 0x06070010),
        (["c017100000000000", "01e8030000000000", "02e8030000000000"], 0x06070012),
    ],
    ids=["too long", "read-only", "check sum", "three bytes", "no end"],
)
def test_wrong_steps_of_a_block_download(stranger: Make, frames: list[str], code: int) -> None:
    drive = stranger()
    *before, last = frames
    for frame in before:
        drive.sdo(frame)
    assert aborted(drive.sdo(last), code)
    assert drive.read(0x1017) == 0


def test_lost_segment_of_a_block_is_reported_at_its_end(stranger: Make) -> None:
    """The last segment has number 2; number 1 never came: 0 are acknowledged."""
    drive = stranger()
    drive.sdo("c217100002000000")
    assert drive.sdo("82e8030000000000") == "a2007f0000000000"
    assert drive.sdo("81e8030000000000") == "a2017f0000000000"
    assert drive.sdo("d500000000000000") == "a100000000000000"
    assert drive.read(0x1017) == 1000


def test_abort_within_a_block(stranger: Make) -> None:
    drive = stranger()
    drive.sdo("c217100002000000")
    assert drive.sdo("8017100000000008") == ""
    assert aborted(drive.sdo("d500000000000000"), COMMAND)


def test_an_acknowledgement_within_a_block_begins_the_next_one_with_its_own_time() -> None:
    """Segments are 250 us apart; what the block before had planned comes no more."""
    clock, sent = new_scheduler(), list[tuple[int, int, bytes]]()
    outlet = SegmentOutlet(
        clock, 250 * US, lambda data: sent.append((clock.now_ns // US, data[0], data[1:])),
        lambda: True,
    )  # fmt: skip
    upload = BlockUpload(bytes(range(70)), 5, False, outlet)
    upload.on_frame(b"\xa3" + bytes(7))
    clock.run_until(300 * US)
    upload.on_frame(b"\xa2\x02\x04" + bytes(5))
    clock.run_until(5000 * US)
    places = [0, 250, 300, 550, 800, 1050]
    assert [at_us for at_us, *_ in sent] == places
    assert [number for _, number, _ in sent] == [1, 2, 1, 2, 3, 4]
    assert [data[0] for *_, data in sent] == [0, 7, 14, 21, 28, 35]
