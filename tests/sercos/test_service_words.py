"""Words of the service channel, bytes by hand; tshark reads them as another program."""

import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.kernel.drives.ethercat.frames import Datagram, at_station, frame_of
from axisrig.kernel.profiles.ethercat.layouts import MAILBOX, MailboxType
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.profiles.sercos.service import (
    Attribute,
    Element,
    Header,
    Kind,
    Operation,
    command_states,
    ident_name,
    ident_number,
    pack_list,
    pack_text,
    parts_of,
    read_list,
    read_text,
    soe_error_text,
    soe_errors,
)

TSHARK = shutil.which("tshark")
FLAGS = st.booleans()
ATTRIBUTES = st.builds(
    Attribute,
    st.sampled_from(Kind), st.sampled_from([1, 2, 4, 8]), FLAGS, FLAGS, st.integers(0, 15),
    st.integers(0, 0xFFFF), st.tuples(FLAGS, FLAGS, FLAGS),
)  # fmt: skip


@pytest.mark.parametrize(
    ("name", "number"),
    [("S-0-0130", 130), ("S-0-0405", 405), ("P-0-0251", 32768 + 251), ("S-7-4095", 0x7FFF)],
)
def test_an_ident_is_a_word(name: str, number: int) -> None:
    """Bit 15: P; 12 to 14: set; 0 to 11: number."""
    assert (ident_number(name), ident_name(number)) == (number, name)


@pytest.mark.parametrize("text", ["S-0-130", "S-8-0001", "X-0-0001", "S-0-4096", "0130", ""])
def test_a_text_that_is_no_ident(text: str) -> None:
    with pytest.raises(ValueError, match="is no ident"):
        ident_number(text)


def test_heads_byte_by_byte() -> None:
    """Operation in bits 0 to 2, incomplete 3, error 4, drive 5 to 7; elements; ident."""
    asked = Header(Operation.READ, 1, Element.VALUE, ident_number("S-0-0130"))
    assert asked.pack() == bytes.fromhex("21408200")
    refused = Header(Operation.WRITE_ANSWER, 0, Element.VALUE, 0x81A9, is_error=True)
    assert refused.pack() == bytes.fromhex("1440a981")
    part = Header(Operation.READ_ANSWER, 7, Element.NAME | Element.UNIT, 0, fragments=3)
    assert part.pack() == bytes.fromhex("ea0a0300")
    both = Header(Operation.READ_ANSWER, 1, Element.VALUE, 0, is_error=True, fragments=2)
    assert both.pack() == bytes.fromhex("3a400200")  # 2, bit 3 and bit 4, drive 1 in bits 5 to 7
    for head in (asked, refused, part, both):
        assert Header.read(head.pack() + b"data") == head
    with pytest.raises(ValueError, match="no head"):
        Header.read(b"\x01\x40\x82")
    with pytest.raises(ValueError, match="Operation"):
        Header.read(bytes(4))


def test_attributes_bit_by_bit() -> None:
    """S-0-0130: 4 bytes, signed, four decimals; a command of 2 bytes; a list of idents."""
    value = Attribute(Kind.SIGNED, 4, decimals=4, protected=(True, True, True))
    assert value.pack() == struct.pack("<I", 1 | 2 << 16 | 2 << 20 | 4 << 24 | 7 << 28)
    command = Attribute(Kind.BINARY, 2, is_command=True)
    assert command.pack() == struct.pack("<I", 1 | 1 << 16 | 1 << 19)
    listed = Attribute(Kind.IDENT, 2, is_list=True)
    assert listed.pack() == struct.pack("<I", 1 | 1 << 16 | 1 << 18 | 5 << 20)


@pytest.mark.long
@given(ATTRIBUTES)
def test_an_attribute_comes_back(attribute: Attribute) -> None:
    assert Attribute.read(attribute.pack()) == attribute


@pytest.mark.long
@given(st.lists(st.integers(0, 0xFFFF), max_size=20), st.integers(0, 5))
def test_a_list_comes_back_with_its_capacity(items: list[int], more: int) -> None:
    data = pack_list(items, 2, len(items) + more)
    assert struct.unpack_from("<HH", data) == (2 * len(items), 2 * (len(items) + more))
    assert read_list(data, 2) == items


def test_lists_and_texts_whose_lengths_cannot_be() -> None:
    assert read_list(pack_list([-1, 5], 4, 8, signed=True), 4, signed=True) == [-1, 5]
    assert read_text(pack_text("Probe 1")) == "Probe 1"
    for data in (b"\x02", b"\x04\x00\x02\x00abcd", b"\x02\x00\x08\x00abc", b"\x03\x00\x08\x00abc"):
        with pytest.raises(ValueError, match="bytes"):
            read_list(data, 2)


@pytest.mark.parametrize("text", ["", "abc", "Störung", "µm", "ÿ"])
def test_a_text_has_one_byte_for_each_of_its_signs(text: str) -> None:
    """ISO 8859-1; present and largest length before it, in bytes."""
    length = len(text)
    data = bytes(map(ord, text))
    assert pack_text(text) == struct.pack("<HH", length, length) + data
    assert pack_text(text, 20) == struct.pack("<HH", length, 20) + data
    assert read_text(pack_text(text, 20)) == text


def test_elements_are_in_their_order() -> None:
    attribute = Attribute(Kind.SIGNED, 4)
    elements = Element.VALUE | Element.NAME | Element.DATA_STATE | Element.ATTRIBUTE
    data = bytes(2) + pack_text("abc") + attribute.pack() + struct.pack("<i", -7)
    found = parts_of(elements, data, attribute)
    assert list(found) == [Element.DATA_STATE, Element.NAME, Element.ATTRIBUTE, Element.VALUE]
    assert found[Element.VALUE] == struct.pack("<i", -7)
    for wrong in (data[:-1], data + b"x", data[:3]):
        with pytest.raises(ValueError, match=r"the data end|after the last"):
            parts_of(elements, wrong, attribute)


@pytest.mark.parametrize("kind", Kind)
def test_lists_and_texts_have_a_length_of_their_own_and_single_values_their_width(
    kind: Kind,
) -> None:
    """Two values in a row are cut where the first one ends.

    A text has a length of its own whether or not its attribute has the bit of lists.
    """
    for is_list in (False, True):
        for width in (1, 2, 4, 8):
            attribute = Attribute(kind, width, is_list=is_list)
            has_length = is_list or kind is Kind.TEXT
            assert attribute.is_variable is has_length
            body = bytes(range(1, 9))
            value = struct.pack("<HH", 8, 16) + body if has_length else body[:width]
            default = value[::-1] if not has_length else struct.pack("<HH", 0, 16)
            elements = Element.NAME | Element.VALUE | Element.DEFAULT
            found = parts_of(elements, pack_text("ab") + value + default, attribute)
            assert found[Element.NAME] == b"\x02\0\x02\0ab"
            assert (found[Element.VALUE], found[Element.DEFAULT]) == (value, default)
            with pytest.raises(ValueError, match=r"the data end in VALUE"):
                parts_of(Element.VALUE, value[:-1], attribute)
            with pytest.raises(ValueError, match=r"1 bytes after the last"):
                parts_of(Element.VALUE, value + b"x", attribute)


def test_codes_of_the_tables() -> None:
    assert soe_errors()["NO_IDENT"] == 0x1001
    assert {0x7002, 0x7008, 0x7010, 0x7013, 0x800A} <= set(soe_errors().values())
    assert "below the least" in soe_error_text(0x7006)
    assert "manufacturer" in soe_error_text(0x9000)
    states = {"IDLE": 0, "RUNNING": 7, "DONE": 3, "INTERRUPTED": 5, "FAILED": 15}
    assert command_states() == states


@pytest.mark.long
@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed (Debian package tshark)")
def test_tshark_reads_the_messages(tmp_path: Path) -> None:
    """tshark 4.0.17 shows the ident in its field of the error code, so that is not looked at."""
    ident = ident_number("S-0-0130")
    heads = [
        Header(Operation.READ, 1, Element.VALUE, ident),
        Header(Operation.READ_ANSWER, 1, Element.VALUE, ident),
        Header(Operation.WRITE, 0, Element.VALUE, ident_number("S-0-0169")),
        Header(Operation.WRITE_ANSWER, 0, Element.VALUE, ident_number("S-0-0169"), is_error=True),
        Header(Operation.READ, 7, Element.NAME | Element.UNIT | Element.ATTRIBUTE, 0x8FFF),
    ]
    bodies = [b"", struct.pack("<i", 5), b"\x01\x00", struct.pack("<H", 0x7008), b""]
    with PcapngFile(tmp_path / "a.pcapng", ["ec"]) as file:
        for n, (head, body) in enumerate(zip(heads, bodies, strict=True)):
            message = head.pack() + body
            mail = MAILBOX.pack(len(message), 0, 0, MailboxType.SOE | (n % 7 + 1) << 4) + message
            at = at_station(1001, 0x1000)
            frame = frame_of([Datagram(Command.FPWR, at, mail.ljust(128, b"\0"))], n)
            file.add(n * 1000, 0, bytes(frame))
    names = ["opcode", "idn", "header_incomplete", "header_error", "header_driveno"]
    names += [f"header_{each}" for each in ("datastate", "name", "attribute", "unit", "value")]
    assert TSHARK is not None
    command = [TSHARK, "-r", str(tmp_path / "a.pcapng"), "-T", "fields", "-e", "_ws.malformed"]
    for name in names:
        command += ["-e", f"ecat_mailbox.soe_{name}"]
    got = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(got) == len(heads)
    for line, head in zip(got, heads, strict=True):
        malformed, *fields = line.split("\t")
        assert malformed == ""
        elements = (
            Element.DATA_STATE,
            Element.NAME,
            Element.ATTRIBUTE,
            Element.UNIT,
            Element.VALUE,
        )
        flags = [int(each in head.elements) for each in elements]
        expected = [head.operation, head.ident, 0, int(head.is_error), head.drive, *flags]
        assert [int(field, 0) for field in fields] == expected
