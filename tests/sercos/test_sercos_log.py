"""`axisrig bus` on a line with SERCOS drives: telegrams and service channel in words."""

import struct

import pytest

from axisrig.bench.tools.bus_log.ethercat.idents import carried_words, message_words
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.sercos.service import (
    Element,
    Header,
    Operation,
    ident_number,
    soe_error_text,
)

PER_MM = 2**20 / 10


@pytest.mark.parametrize(
    ("ident", "number", "said"),
    [
        ("S-0-0134", 0xE440, "S-0-0134 0xE440 on, enable, run, real-time 1"),
        ("S-0-0134", 0, "S-0-0134 0x0000"),
        ("S-0-0135", 0xC0E8,
         "S-0-0135 0xC0E8 operates, real-time 1, real-time 2, command changed, follows"),
        ("S-0-0135", 0x2000, "S-0-0135 0x2000 not ready, class 1 error"),
        ("S-0-0130", 1_294_530, "S-0-0130 1294530 (12.345600 mm)"),
        ("S-0-0084", -17, "S-0-0084 -17"),
    ],
)  # fmt: skip
def test_values_of_telegrams(ident: str, number: int, said: str) -> None:
    assert carried_words(MappedObject(ident_number(ident), 0, 32, True, ""), number, PER_MM) == said


def message(
    operation: Operation,
    ident: str,
    elements: Element,
    data: bytes = b"",
    *,
    is_error: bool = False,
) -> str:
    return message_words(
        Header(operation, 0, elements, ident_number(ident), is_error).pack() + data
    )[0]


def test_messages_of_the_service_channel() -> None:
    value, number = Element.VALUE, struct.Struct("<H").pack
    assert message(Operation.READ, "S-0-0130", value) == "SoE read S-0-0130"
    found = struct.pack("<i", -5)
    assert message(Operation.READ_ANSWER, "S-0-0130", value, found) == "SoE answer S-0-0130 = -5"
    sent = message(Operation.WRITE, "S-0-0301", value, number(ident_number("S-0-0405")))
    assert sent == "SoE write S-0-0301 = S-0-0405"
    refused = message(Operation.WRITE_ANSWER, "S-0-0307", value, number(0x7008), is_error=True)
    assert refused.startswith("SoE written S-0-0307: SoE error 0x7008")
    state = Element.DATA_STATE
    assert message(Operation.READ_ANSWER, "S-0-0170", state, number(7)) == (
        "SoE answer S-0-0170 data state = 7"
    )
    part = Header(Operation.WRITE, 0, value, 0, fragments=2).pack() + bytes(6)
    assert message_words(part)[0] == "SoE write, 6 bytes, 2 more parts"


def test_tags_name_the_ident() -> None:
    head = Header(Operation.READ, 0, Element.VALUE, ident_number("S-0-0130")).pack()
    assert message_words(head)[1] == {"soe", "s-0-0130"}


@pytest.mark.parametrize("number", [47, 51, 53, 130, 131, 132, 133, 189])
def test_positions_of_telegrams_are_in_mm_too(number: int) -> None:
    """Command value, both encoders, four probe values, following distance; 2^20 units on 10 mm."""
    name = f"S-0-{number:04}"
    carried = MappedObject(ident_number(name), 0, 32, True, "")
    assert carried_words(carried, -(2**18), PER_MM) == f"{name} -262144 (-2.500000 mm)"


@pytest.mark.parametrize("number", [36, 40, 80, 84, 92, 179, 390])
def test_what_is_no_position_is_a_number_alone(number: int) -> None:
    """Speeds, torques, the status of the probes, the diagnosis."""
    name = f"S-0-{number:04}"
    carried = MappedObject(ident_number(name), 0, 32, True, "")
    assert carried_words(carried, 1000, PER_MM) == f"{name} 1000"


@pytest.mark.parametrize(
    ("bit", "of_control", "of_status"),
    [
        (15, "on", "power ready"),  # of the status word bits 15 and 14 are one number
        (14, "enable", "logic ready"),
        (13, "run", "not ready, class 1 error"),
        (12, "", "not ready, class 2 changed"),
        (11, "", "not ready, class 3 changed"),
        (7, "real-time 2", "not ready, real-time 2"),
        (6, "real-time 1", "not ready, real-time 1"),
        (5, "", "not ready, command changed"),
        (3, "", "not ready, follows"),
    ],
)
def test_each_bit_of_control_and_status_word_has_its_words(
    bit: int, of_control: str, of_status: str
) -> None:
    """S-0-0134 and S-0-0135 of the AX5000 descriptions."""
    for ident, words in (("S-0-0134", of_control), ("S-0-0135", of_status)):
        carried = MappedObject(ident_number(ident), 0, 16, False, "")
        text = f"{ident} 0x{1 << bit:04X} {words}".rstrip()
        assert carried_words(carried, 1 << bit, PER_MM) == text


@pytest.mark.parametrize(
    ("operation", "word"),
    [
        (Operation.READ, "read"),
        (Operation.READ_ANSWER, "answer"),
        (Operation.WRITE, "write"),
        (Operation.WRITE_ANSWER, "written"),
        (Operation.NOTIFICATION, "notification"),
        (Operation.EMERGENCY, "emergency"),
    ],
)
def test_each_message_says_what_it_is(operation: Operation, word: str) -> None:
    assert message(operation, "P-0-0010", Element.VALUE) == f"SoE {word} P-0-0010"


@pytest.mark.parametrize(
    ("elements", "words"),
    [
        (Element.DATA_STATE, "data state"),
        (Element.NAME, "name"),
        (Element.ATTRIBUTE, "attribute"),
        (Element.UNIT, "unit"),
        (Element.MINIMUM, "minimum"),
        (Element.MAXIMUM, "maximum"),
        (Element.DEFAULT, "default"),
        (Element.ATTRIBUTE | Element.VALUE, "attribute+value"),
        (Element.MAXIMUM | Element.MINIMUM | Element.DATA_STATE, "data state+minimum+maximum"),
    ],
)
def test_elements_are_named_in_the_order_of_a_message(elements: Element, words: str) -> None:
    assert message(Operation.READ, "S-0-0036", elements) == f"SoE read S-0-0036 {words}"


@pytest.mark.parametrize(
    ("ident", "elements", "data", "words"),
    [
        ("S-0-0036", Element.VALUE, "fe ff ff ff", "-2"),
        ("S-0-0080", Element.VALUE, "fe ff", "-2"),
        ("S-0-0390", Element.VALUE, "fe ff ff ff", "4294967294"),
        ("S-0-0092", Element.VALUE, "fe ff", "65534"),
        ("P-0-0010", Element.VALUE, "fe ff", "65534"),  # of which nothing is known
        ("S-0-0170", Element.DATA_STATE, "07 00", "7"),
        ("S-0-0301", Element.VALUE, "00 00", "0"),  # a real-time bit that is nothing
        ("S-0-0303", Element.VALUE, "96 01", "S-0-0406"),
        ("S-0-0305", Element.VALUE, "99 01", "S-0-0409"),
        ("S-0-0307", Element.VALUE, "9a 01", "S-0-0410"),
        # Neither two bytes nor four, and other elements than the value, are bytes
        ("S-0-0036", Element.VALUE, "01", "01"),
        ("S-0-0036", Element.VALUE, "01 02 03", "01 02 03"),
        ("S-0-0016", Element.VALUE, "04 00 04 00 33 00 82 00", "04 00 04 00 33 00 82 00"),
        ("S-0-0036", Element.ATTRIBUTE, "01 00 22 00", "01 00 22 00"),
        ("S-0-0036", Element.UNIT, "6d 6d", "6d 6d"),
        ("S-0-0036", Element.ATTRIBUTE | Element.VALUE, "01 00", "01 00"),
    ],
)  # fmt: skip
def test_what_a_message_carries_is_a_number_or_its_bytes(
    ident: str, elements: Element, data: str, words: str
) -> None:
    found = message(Operation.READ_ANSWER, ident, elements, bytes.fromhex(data))
    assert found.startswith(f"SoE answer {ident}")
    assert found.partition(" = ")[2] == words


@pytest.mark.parametrize(
    ("data", "code"), [("08 70", 0x7008), ("08 70 01 10", 0x7008), ("", 0), ("08", 0)]
)
def test_a_refusal_has_its_error_in_place_of_a_value(data: str, code: int) -> None:
    """The code is the first word, 0 where there is none."""
    found = message(
        Operation.READ_ANSWER, "S-0-0036", Element.VALUE, bytes.fromhex(data), is_error=True
    )
    assert found == f"SoE answer S-0-0036: {soe_error_text(code)}"
    assert f"0x{code:04X}" in found


def test_a_message_of_another_drive_of_a_slave_says_its_number() -> None:
    for drive, words in ((0, ""), (1, " (drive 1)"), (7, " (drive 7)")):
        head = Header(Operation.READ, drive, Element.VALUE, ident_number("S-0-0036")).pack()
        text, tags = message_words(head)
        assert text == f"SoE read S-0-0036{words}"
        assert tags == {"soe", "s-0-0036"}


@pytest.mark.parametrize("more", [1, 2, 300])
def test_a_part_names_no_ident_as_it_has_none(more: int) -> None:
    """Its head has the number of the parts that follow where the ident is else; the last has 0."""
    part = Header(Operation.READ_ANSWER, 0, Element.VALUE, 36, fragments=more).pack() + bytes(9)
    assert message_words(part) == (f"SoE answer, 9 bytes, {more} more parts", {"soe"})


@pytest.mark.parametrize("body", [b"", b"\x01", b"\x01\x40\x24"])
def test_bytes_that_are_no_message_are_refused(body: bytes) -> None:
    with pytest.raises(ValueError, match=f"{len(body)} bytes are no head of SoE"):
        message_words(body)
