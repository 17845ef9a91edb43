"""Words of the profiles on their own: emergencies, images, EtherCAT frames and states, SERCOS."""

import struct

import pytest

from axisrig.kernel.profiles.canopen.emergency import Emergency, codes, row_of
from axisrig.kernel.profiles.canopen.identifiers import service_of, services
from axisrig.kernel.profiles.ethercat.layouts import received_after_ns
from axisrig.kernel.profiles.ethercat.tables import al_status_codes, al_status_text, state_name
from axisrig.kernel.profiles.sercos.service import (
    Element,
    Header,
    Operation,
    pack_list,
    pack_text,
    read_list,
    read_text,
)
from axisrig.kernel.profiles.speed_drive.words import image_of, signed

FAMILIES = ("conventional", "lightbus", "encoder_terminal")


# Emergencies


@pytest.mark.parametrize(
    ("data", "code", "register", "vendor"),
    [
        (b"\x10\x23\x05abcde", 0x2310, 5, b"abcde"), (b"\x10\x23", 0x2310, 0, bytes(5)),
        (b"\x10\x23\x05ab", 0x2310, 5, b"ab\0\0\0"), (b"", 0, 0, bytes(5)),
        (b"\x10\x23\x05abcdefgh", 0x2310, 5, b"abcde"), (b"\x10", 0x10, 0, bytes(5)),
    ],
)  # fmt: skip
def test_a_short_emergency_is_filled_with_zeros(
    data: bytes, code: int, register: int, vendor: bytes
) -> None:
    """CiA 301, 7.2.7: code, little-endian, error register, five bytes of the maker."""
    for kind in (bytes, bytearray):
        found = Emergency.read(kind(data))
        assert (found.code, found.register, found.vendor) == (code, register, vendor)


def test_the_row_of_a_code_is_that_of_the_code_else_of_its_class() -> None:
    for row in codes():
        assert row_of(row.code) == row
        free = ~row.mask & 0xFFFF
        inside = row.code | free
        found = row_of(inside)
        assert found is not None
        assert found.mask >= row.mask
        assert Emergency(inside, 0, bytes(5)).reaction == found.reaction
    assert {row.reaction for row in codes()} <= {"stop", "warn", "none"}


def test_a_code_that_is_in_no_table_stops_the_machine() -> None:
    unknown = next(code for code in range(1, 0x10000) if row_of(code) is None)
    found = Emergency(unknown, 0x0A, bytes(5))
    assert (found.row, found.reaction) == (None, "stop")
    assert str(found) == (f"0x{unknown:04X}, a code that is not in the table, error register 0x0A")


@pytest.mark.parametrize("register", [0, 1, 0x81])
def test_an_emergency_in_words_has_code_meaning_and_register(register: int) -> None:
    for row in codes():
        shown = str(Emergency(row.code, register, bytes(5)))
        assert shown == f"0x{row.code:04X}, {row.meaning}, error register 0x{register:02X}"


def test_an_identifier_is_of_the_service_whose_first_and_last_it_is_between() -> None:
    for service in services():
        assert service_of(service.first) == service_of(service.last) == service
    used = {i for service in services() for i in range(service.first, service.last + 1)}
    for can_id in set(range(0x800)) - used:
        assert service_of(can_id) is None


# Images of drives that take a speed


@pytest.mark.parametrize("direction", ["in", "out"])
@pytest.mark.parametrize("family", FAMILIES)
def test_each_value_of_an_image_has_its_place(family: str, direction: str) -> None:
    image = image_of(f"axisrig.kernel.profiles.{family}", direction)
    assert image.packed({}) == bytes(image.codec.size)
    values = {name: number for number, name in enumerate(image.names, 1)}
    assert image.values_of(image.packed(values)) == values
    backwards = dict(reversed(values.items()))
    assert image.packed(backwards) == image.packed(values)
    for name in image.names:
        alone = image.values_of(image.packed({name: 3}))
        assert alone == {other: 3 if other == name else 0 for other in image.names}


@pytest.mark.parametrize("bits", [8, 16, 32])
def test_a_difference_of_counters_is_the_short_way_round(bits: int) -> None:
    turn = 1 << bits
    half = turn // 2
    for value, wanted in (
        (0, 0), (1, 1), (-1, -1), (half - 1, half - 1), (half, -half), (half + 1, 1 - half),
        (-half, -half), (-half - 1, half - 1), (turn - 1, -1), (1 - turn, 1), (turn, 0),
    ):  # fmt: skip
        assert signed(value, bits) == wanted


# EtherCAT


@pytest.mark.parametrize(
    ("frame_bytes", "wire_bytes"), [(0, 72), (59, 72), (60, 72), (61, 73), (100, 112), (1514, 1526)]
)
def test_a_frame_is_on_the_wire_with_its_preamble_and_check(
    frame_bytes: int, wire_bytes: int
) -> None:
    """IEEE 802.3 at 100 Mbit/s, 80 ns a byte: 8 of preamble, at least 60, 4 of check."""
    assert received_after_ns(frame_bytes) == wire_bytes * 80


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (1, "INIT"), (2, "PREOP"), (4, "SAFEOP"), (8, "OP"), (0x11, "INIT with error"),
        (0x12, "PREOP with error"), (0x14, "SAFEOP with error"), (0x18, "OP with error"),
        (0x28, "OP"), (0x38, "OP with error"), (5, "0x5"), (0x15, "0x5 with error"), (0, "0x0"),
        (0x24, "SAFEOP"),
    ],
)  # fmt: skip
def test_a_state_is_in_four_bits_and_an_error_beside_it(status: int, words: str) -> None:
    """ETG.1000.6: AL status, bits 0 to 3 and 4."""
    assert state_name(status) == words


def test_a_status_code_has_four_digits_and_its_meaning() -> None:
    for code in al_status_codes().values():
        assert al_status_text(code).startswith(f"0x{code:04X}, ")
        assert "manufacturer" not in al_status_text(code)
    assert al_status_text(0x8000) == "0x8000, a code of the manufacturer"
    assert al_status_text(0x11).startswith("0x0011, ")


# Service channel of SERCOS


@pytest.mark.parametrize("fragments", [0, 1, 7])
def test_a_part_of_a_message_has_the_number_of_those_that_follow(fragments: int) -> None:
    """In place of its ident, which only the last one has."""
    head = Header(Operation.WRITE, 0, Element.VALUE, 0x8010, fragments=fragments)
    assert struct.unpack_from("<H", head.pack(), 2) == (fragments or 0x8010,)
    found = Header.read(head.pack())
    assert (found.ident, found.fragments) == ((0, fragments) if fragments else (0x8010, 0))


@pytest.mark.parametrize(
    ("text", "capacity", "lengths"),
    [("abc", None, (3, 3)), ("abc", 10, (3, 10)), ("", 0, (0, 0)), ("", None, (0, 0)),
     ("", 4, (0, 4)), ("abc", 3, (3, 3)), ("\u00e4", None, (1, 1))],
)  # fmt: skip
def test_a_text_has_its_length_and_the_largest_one(
    text: str, capacity: int | None, lengths: tuple[int, int]
) -> None:
    data = pack_text(text, capacity)
    assert struct.unpack_from("<HH", data) == lengths
    assert read_text(data) == text


def test_a_text_for_which_there_is_no_room_is_no_text() -> None:
    """A capacity of 0 is one, not none."""
    with pytest.raises(ValueError, match="for a length of 3 of 0"):
        read_text(pack_text("abc", 0))


@pytest.mark.parametrize("width", [1, 2, 4, 8])
@pytest.mark.parametrize("signed", [True, False])
def test_a_list_may_be_full_and_counts_its_room_in_bytes(width: int, signed: bool) -> None:
    items = [-1, 5, -(1 << 8 * width - 1)] if signed else [1, 5, (1 << 8 * width) - 1]
    data = pack_list(items, width, 3, signed=signed)
    assert struct.unpack_from("<HH", data) == (3 * width, 3 * width)
    assert read_list(data, width, signed=signed) == items
