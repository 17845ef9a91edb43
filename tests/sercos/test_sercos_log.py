"""`axisrig bus` on a line with SERCOS drives: telegrams and service channel in words."""

import struct

import pytest

from axisrig.bench.tools.bus_log.ethercat.idents import carried_words, message_words
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.sercos.service import Element, Header, Operation, ident_number

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
