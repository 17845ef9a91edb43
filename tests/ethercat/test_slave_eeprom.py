"""The EEPROM of a slave: read as a master reads it, word by word and category by category."""

import struct
from collections.abc import Iterator
from dataclasses import replace
from xml.etree.ElementTree import fromstring

import pytest
from tests.ethercat.esi_rules import eeprom_of
from tests.ethercat.line import Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import (
    MAILBOX_BYTES,
    Description,
    Entry,
    Manager,
    Pdo,
    describe,
)
from axisrig.bench.drive.ethercat.eeprom import Eeprom
from axisrig.bench.drive.ethercat.esi import esi_text
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.sii import sii_content
from axisrig.bench.drive.sercos.description import describe as describe_sercos
from axisrig.bench.drive.sercos.profiles import NAMES, make_profile


def categories(content: bytes) -> Iterator[tuple[int, bytes]]:
    at = 2 * 0x40
    while True:
        (kind,) = struct.unpack_from("<H", content, at)
        if kind == 0xFFFF:
            assert set(content[at:]) == {0xFF}
            return
        (words,) = struct.unpack_from("<H", content, at + 2)
        yield kind, content[at + 4 : at + 4 + 2 * words]
        at += 4 + 2 * words


def test_the_fixed_words() -> None:
    content = sii_content(describe(DriveProfile(), serial=77, mailbox_bytes=64))
    assert len(content) == 2048
    # CRC-8 of the first seven words by polynomial division, start value FF
    remainder = int.from_bytes(bytes([content[0] ^ 0xFF]) + content[1:14] + b"\x00", "big")
    for bit in reversed(range(8, 15 * 8)):
        if remainder >> bit & 1:
            remainder ^= 0x107 << bit - 8
    assert content[14] == remainder
    assert struct.unpack_from("<4I", content, 0x10) == (0, 402, 0x10000, 77)
    assert struct.unpack_from("<5H", content, 0x30) == (0x1000, 64, 0x1040, 64, 4)
    assert struct.unpack_from("<2H", content, 0x7C) == (15, 1)


def test_the_categories() -> None:
    content = sii_content(describe(DriveProfile()))
    found = list(categories(content))
    assert [kind for kind, _ in found] == [10, 30, 40, 41, 50, 50, 51, 51, 60]
    by_kind = dict(found)
    texts, at = [""], 1
    for _ in range(by_kind[10][0]):
        size = by_kind[10][at]
        texts.append(by_kind[10][at + 1 : at + 1 + size].decode())
        at += 1 + size
    general = by_kind[30]
    assert len(general) == 32
    assert texts[1] == texts[general[3]] == "axisrig DS402 drive"
    assert (texts[general[0]], texts[general[2]]) == ("axisrig drives", "DS402")
    # CoE with all it may have; no FoE, EoE, SoE; one axis of DS402; LRW is there
    assert list(general[5:12]) == [0x3F, 0, 0, 0, 1, 0, 0]
    assert by_kind[40] == bytes((1, 2, 3, 0xFF))
    managers = list(struct.iter_unpack("<HHBBBB", by_kind[41]))
    assert managers == [
        (0x1000, 128, 0x26, 0, 1, 1),
        (0x1080, 128, 0x22, 0, 1, 2),
        (0x1800, 8, 0x64, 0, 1, 3),
        (0x1C00, 16, 0x20, 0, 1, 4),
    ]
    pdos = [(kind, data) for kind, data in found if kind in (50, 51)]
    seen = {}
    for kind, data in pdos:
        index, number, manager, _, name, _ = struct.unpack_from("<HBBBBH", data)
        entries = [struct.unpack_from("<HBBBBH", data, 8 + 8 * n) for n in range(number)]
        seen[index] = (kind, manager, texts[name], [(i, s, b) for i, s, _, _, b, _ in entries])
        assert all(texts[entry[2]] for entry in entries)
    assert seen[0x1600] == (51, 2, "RxPDO 1", [(0x6040, 0, 16), (0x607A, 0, 32), (0x60B8, 0, 16)])
    assert seen[0x1A00][:3] == (50, 3, "TxPDO 1")
    assert seen[0x1601][1] == seen[0x1A01][1] == 0xFF
    clocks = list(struct.iter_unpack("<IIIhHhBB4x", by_kind[60]))
    assert [(assign, texts[name]) for _, _, _, _, assign, _, name, _ in clocks] == [
        (0x0300, "DC-Synchron"),
        (0, "SM-Synchron"),
    ]


def read_all(line: Line) -> bytes:
    """As masters do: address and command, then control and data."""
    content = b""
    while len(content) < 2048:
        line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, len(content) // 2))
        data = line.one(1, 0, 0x0502, 14).data
        assert int.from_bytes(data[:2], "little") == 0x0040
        content += data[6:]
    return content


def test_a_master_reads_all_of_it_by_the_registers() -> None:
    line = Line(settings=[SlaveSettings(serial=9)])
    assert read_all(line) == sii_content(describe(DriveProfile(), serial=9))
    line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, 4000))
    assert line.one(1, 0, 0x0508, 8).data == b"\xff" * 8


@pytest.mark.parametrize(
    ("control", "status", "is_written"),
    [(0x0201, 0x0040, True), (0x0200, 0x4040, False), (0x0700, 0x2040, False)],
)
def test_a_word_is_written_where_that_is_allowed(
    control: int, status: int, is_written: bool
) -> None:
    line = Line()
    line.one(2, 0, 0x0502, struct.pack("<HIH", control, 0x100, 0x1234))
    assert line.read(0x0502, 2) == status
    line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, 0x100))
    assert (line.read(0x0508, 2) == 0x1234) is is_written


def test_the_slave_may_have_the_eeprom() -> None:
    line = Line()
    line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, 8))
    line.write(0x0500, 1, 1)
    line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, 0x0A))
    assert line.read(0x0508, 4) == 0
    line.write(0x0500, 2, 1)
    line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, 0x0A))
    assert line.read(0x0508, 4) == 402


def test_a_check_sum_that_is_wrong_is_said_and_gives_no_alias() -> None:
    line = Line()
    line.one(2, 0, 0x0502, struct.pack("<HIH", 0x0201, 4, 0x2002))
    line.one(2, 0, 0x0502, struct.pack("<H", 0x0400))
    assert (line.read(0x0502, 2), line.read(0x0012, 2)) == (0x0840, 0)


@pytest.mark.parametrize(
    "profile",
    [
        DriveProfile(),
        DriveProfile(lacks="60B8 60B9 60BA 60D1"),
        DriveProfile(lacks="60FD"),
        DriveProfile(fixed_pdos=True),
    ],
)
def test_the_eeprom_made_from_the_esi_file_is_ours(profile: DriveProfile) -> None:
    description = describe(profile, serial=3)
    assert eeprom_of(esi_text(description), serial=3) == sii_content(description)


@pytest.mark.parametrize("name", NAMES)
def test_the_eeprom_of_a_sercos_drive_is_that_of_its_esi_file(name: str) -> None:
    """SoE in place of CoE, one channel; no profile of CiA 402."""
    drive = make_profile(name, DriveProfile(), "rotary", 1 << 20)
    description = describe_sercos(drive, 3, MAILBOX_BYTES)
    text = esi_text(description)
    assert eeprom_of(text, serial=3) == sii_content(description)
    assert ("<CoE" in text, "ProfileNo" in text, text.count("<SoE")) == (False, False, 1)


def test_eeprom_and_esi_of_fixed_pdos_say_so() -> None:
    fixed = describe(DriveProfile(fixed_pdos=True))
    details = [
        next(body for kind, body in categories(sii_content(each)) if kind == 30)[5]
        for each in (describe(DriveProfile()), fixed)
    ]
    assert details == [0x3F, 0x33]
    text = esi_text(fixed)
    assert text.count('Fixed="1"') == len(fixed.rxpdos + fixed.txpdos)
    assert "PdoAssign" not in text
    assert "Fixed" not in esi_text(describe(DriveProfile()))


def test_the_esi_file_lets_both_mailboxes_be_32_to_1024_bytes() -> None:
    managers = fromstring(esi_text(describe(DriveProfile())).partition("\n")[2]).iter("Sm")
    limits = {one.text: (one.get("MinSize"), one.get("MaxSize")) for one in managers}
    box, none = ("32", "1024"), (None, None)
    assert limits == {"MBoxOut": box, "MBoxIn": box, "Outputs": none, "Inputs": none}


@pytest.mark.parametrize("alias", [0, 1, 0x1234, 0xFFFF])
def test_an_alias_of_a_description_is_in_its_word_and_in_the_check_sum(alias: int) -> None:
    """Word 4; a slave takes it at power on where the check sum is right."""
    content = sii_content(replace(describe(DriveProfile()), alias=alias))
    assert content[8:10] == alias.to_bytes(2, "little")
    eeprom = Eeprom(content)
    eeprom.load()
    assert (eeprom.alias, eeprom.status) == (alias, 1 << 6)
    eeprom.content[8] ^= 1
    eeprom.load()
    assert (eeprom.alias, eeprom.status) == (0, 1 << 6 | 1 << 11)


def test_a_text_that_is_there_twice_has_one_number() -> None:
    usual = describe(DriveProfile())
    content = sii_content(replace(usual, group=usual.name, order=usual.name))
    by_kind = dict(categories(content))
    general, texts = by_kind[30], by_kind[10]
    assert (general[0], general[2], general[3]) == (1, 1, 1)
    assert texts.count(usual.name.encode()) == 1
    assert texts[0] == dict(categories(sii_content(usual)))[10][0] - 2


@pytest.mark.parametrize(("more", "fits"), [(0, True), (4, True), (200, False)])
def test_a_description_that_does_not_fit_is_refused_with_its_size(more: int, fits: bool) -> None:
    """Each PDO has a head of 12 bytes and 8 for each entry; 2048 bytes are there."""
    usual = describe(DriveProfile())
    many = replace(usual, txpdos=usual.txpdos + (usual.txpdos[0],) * more)
    if fits:
        assert len(sii_content(many)) == 2048
        return
    with pytest.raises(ValueError, match="do not fit into 2048"):
        sii_content(many)


@pytest.mark.parametrize(("more", "fits"), [(0, True), (1, False)])
def test_the_end_word_is_the_last_that_fits(more: int, fits: bool) -> None:
    """One entry of 8 bytes more than what is left is too much."""
    usual = describe(DriveProfile())
    used = 2 * 0x40 + sum(4 + len(data) for _, data in categories(sii_content(usual))) + 2
    entry = usual.txpdos[0].entries[0]
    count = (2048 - used) // 8 + more
    pdo = replace(usual.txpdos[0], entries=usual.txpdos[0].entries + (entry,) * count)
    many = replace(usual, txpdos=(pdo, *usual.txpdos[1:]))
    if fits:
        assert len(sii_content(many)) == 2048
    else:
        with pytest.raises(ValueError, match="do not fit into 2048"):
            sii_content(many)


def test_the_esi_file_of_a_drive_of_cia_402_says_its_profile() -> None:
    """ETG.2000, Profile: number 402; CoE in its mailbox and no SoE."""
    text = esi_text(describe(DriveProfile()))
    root = fromstring(text.partition("\n")[2])
    assert [one.text for one in root.iter("ProfileNo")] == ["402"]
    assert (len(list(root.iter("CoE"))), len(list(root.iter("SoE")))) == (1, 0)


WRITTEN = Description(
    serial=5,
    managers=(Manager(0x1100, 48, 0x26, 1), Manager(0x1300, 96, 0x22, 2),
              Manager(0x1900, 7, 0x64, 3), Manager(0x1D00, 9, 0x20, 4)),
    rxpdos=(
        Pdo(0x1605, "first", 2, (Entry(0x6040, 1, 16, 6, "word"), Entry(0x607A, 2, 32, 4, "way"))),
        Pdo(0x1606, "second", None,
            (Entry(0x6060, 3, 8, 2, "mode"), Entry(0x6040, 4, 16, 3, "word"))),
    ),
    txpdos=(
        Pdo(0x1A05, "third", 3, (Entry(0x6064, 5, 32, 7, "way"), Entry(0x6061, 6, 8, 5, "mode"))),
        Pdo(0x1A06, "first", None, ()),
    ),
)  # fmt: skip
"""No two members alike, but for names that come again after others."""


def texts_of(content: bytes) -> list[str]:
    """By number; none has 0."""
    data = dict(categories(content))[10]
    texts, at = [""], 1
    for _ in range(data[0]):
        texts.append(data[at + 1 : at + 1 + data[at]].decode())
        at += 1 + data[at]
    return texts


def test_each_pdo_and_entry_has_its_own_name_where_names_come_again() -> None:
    """TxPDOs are category 50, RxPDOs 51; FF is no SyncManager."""
    content = sii_content(WRITTEN)
    texts = texts_of(content)
    found = []
    for kind, data in categories(content):
        if kind in (50, 51):
            index, count, manager, clock, name, flags = struct.unpack_from("<HBBBBH", data)
            assert (len(data), clock, flags) == (8 + 8 * count, 0, 0)
            entries = [
                (entry, sub, texts[text], code, bits, rest)
                for entry, sub, text, code, bits, rest in struct.iter_unpack("<HBBBBH", data[8:])
            ]
            found.append((kind, index, manager, texts[name], entries))
    assert found == [
        (50, 0x1A05, 3, "third", [(0x6064, 5, "way", 7, 32, 0), (0x6061, 6, "mode", 5, 8, 0)]),
        (50, 0x1A06, 0xFF, "first", []),
        (51, 0x1605, 2, "first", [(0x6040, 1, "word", 6, 16, 0), (0x607A, 2, "way", 4, 32, 0)]),
        (51, 0x1606, 0xFF, "second", [(0x6060, 3, "mode", 2, 8, 0), (0x6040, 4, "word", 3, 16, 0)]),
    ]  # fmt: skip
    assert len(texts) == len(set(texts))


@pytest.mark.parametrize(("is_sercos", "protocol"), [(False, 0x04), (True, 0x10)])
def test_both_mailboxes_have_their_own_place_and_size(is_sercos: bool, protocol: int) -> None:
    """Words 18 to 1C; the category has all four, each enabled."""
    content = sii_content(replace(WRITTEN, is_sercos=is_sercos))
    assert struct.unpack_from("<5H", content, 0x30) == (0x1100, 48, 0x1300, 96, protocol)
    assert list(struct.iter_unpack("<HHBBBB", dict(categories(content))[41])) == [
        (0x1100, 48, 0x26, 0, 1, 1),
        (0x1300, 96, 0x22, 0, 1, 2),
        (0x1900, 7, 0x64, 0, 1, 3),
        (0x1D00, 9, 0x20, 0, 1, 4),
    ]


def test_a_description_without_mailbox_has_no_place_and_no_protocol_of_one() -> None:
    content = sii_content(replace(WRITTEN, managers=(), coe=()))
    assert content[0x30:0x3A] == bytes(10)
    assert dict(categories(content))[41] == b""


@pytest.mark.parametrize("left", [-2, 0, 2])
def test_an_eeprom_may_be_full_to_its_last_byte(left: int) -> None:
    """2048 bytes fit, one word more does not. Texts have 1 byte of length and are ASCII."""
    used = 2 * 0x40 + sum(4 + len(data) for _, data in categories(sii_content(WRITTEN))) + 2
    missing = 2048 - left - used
    entries = (Entry(0x6040, 0, 16, 6, "word"),) * (missing // 8)
    first = replace(WRITTEN.txpdos[1], entries=entries)
    full = replace(
        WRITTEN,
        name=WRITTEN.name + "x" * (missing % 8),
        txpdos=(WRITTEN.txpdos[0], first),
    )
    if left < 0:
        with pytest.raises(ValueError, match=r"^2050 bytes of SII do not fit into 2048$"):
            sii_content(full)
        return
    content = sii_content(full)
    assert len(content) == 2048
    assert [kind for kind, _ in categories(content[: 2048 - left])][-1] == 60
    assert content[2046 - left :] == b"\xff" * (2 + left)


def test_the_esi_file_has_each_member_in_its_own_width_and_type() -> None:
    """Data types by their numbers in CiA 301; places are words, control is a byte."""
    root = fromstring(esi_text(WRITTEN).partition("\n")[2])
    assert [
        (one.text, one.get("DefaultSize"), one.get("StartAddress"), one.get("ControlByte"))
        for one in root.iter("Sm")
    ] == [
        ("MBoxOut", "48", "#x1100", "#x26"),
        ("MBoxIn", "96", "#x1300", "#x22"),
        ("Outputs", "7", "#x1900", "#x64"),
        ("Inputs", "9", "#x1D00", "#x20"),
    ]
    pdos = [
        (kind, pdo.get("Sm"), pdo.findtext("Index"), pdo.findtext("Name"),
         [tuple(member.text for member in entry) for entry in pdo.findall("Entry")])
        for kind in ("RxPdo", "TxPdo") for pdo in root.iter(kind)
    ]  # fmt: skip
    assert pdos == [
        ("RxPdo", "2", "#x1605", "first",
         [("#x6040", "1", "16", "word", "UINT"), ("#x607A", "2", "32", "way", "DINT")]),
        ("RxPdo", None, "#x1606", "second",
         [("#x6060", "3", "8", "mode", "SINT"), ("#x6040", "4", "16", "word", "INT")]),
        ("TxPdo", "3", "#x1A05", "third",
         [("#x6064", "5", "32", "way", "UDINT"), ("#x6061", "6", "8", "mode", "USINT")]),
        ("TxPdo", None, "#x1A06", "first", []),
    ]  # fmt: skip
