"""PDO communication and mapping parameters: what CiA 301 lets a master write, and when."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

Make = Callable[..., Any]

OFF, NO_REMOTE = 0x8000_0000, 0x4000_0000
UNSUPPORTED, NO_OBJECT, NO_SUB = 0x06010000, 0x06020000, 0x06090011
NOT_MAPPABLE, TOO_LONG, INVALID, TOO_HIGH = 0x06040041, 0x06040042, 0x06090030, 0x06090031


def remap(drive: Any, communication: int, cob_id: int, *entries: int, kind: int = 1) -> list[int]:
    """The procedure of the standard; return the abort codes of its steps."""
    mapping = communication + 0x200
    codes = [
        drive.write(communication, 1, OFF | cob_id, 4),
        drive.write(mapping, 0, 0, 1),
        *(drive.write(mapping, sub, entry, 4) for sub, entry in enumerate(entries, 1)),
        drive.write(mapping, 0, len(entries), 1),
        drive.write(communication, 2, kind, 1),
        drive.write(communication, 1, cob_id, 4),
    ]
    return [code for code in codes if code]


def test_predefined_connection_set(stranger: Make) -> None:
    """CiA 301: 4 PDOs each way at 180h, 200h ... 500h plus the node number 3."""
    drive = stranger()
    received = [drive.read(0x1400 + n, 1) & 0x7FF for n in range(4)]
    sent = [drive.read(0x1800 + n, 1) & 0x7FF for n in range(4)]
    assert (received, sent) == ([0x203, 0x303, 0x403, 0x503], [0x183, 0x283, 0x383, 0x483])
    assert drive.read_code(0x1404, 1) == drive.read_code(0x1804, 1) == NO_OBJECT
    assert (drive.read(0x1400), drive.read(0x1800)) == (5, 6)  # highest sub-indices


@pytest.mark.parametrize(
    ("index", "sub", "value", "size", "code"),
    [
        # a valid PDO (1400, 1800) keeps its identifier, mapping, inhibit time, start value
        (0x1400, 1, 0x204, 4, INVALID),
        (0x1400, 1, OFF | 0x204, 4, 0),
        (0x1600, 0, 0, 1, UNSUPPORTED),
        (0x1600, 1, 0x60400010, 4, UNSUPPORTED),
        (0x1800, 1, 0x4000_0184, 4, INVALID),
        (0x1800, 1, 0x0000_0183, 4, 0),  # remote requests allowed from now on
        (0x1800, 3, 10, 2, INVALID),
        (0x1800, 3, 0, 2, 0),  # what it has
        (0x1800, 6, 1, 1, INVALID),
        (0x1A00, 0, 0, 1, UNSUPPORTED),
        # event timer and transmission type may change
        (0x1800, 5, 10, 2, 0),
        (0x1800, 2, 255, 1, 0),
        (0x1400, 5, 10, 2, 0),
        # transmission types
        (0x1800, 2, 0, 1, 0),
        (0x1800, 2, 240, 1, 0),
        (0x1800, 2, 241, 1, INVALID),
        (0x1800, 2, 251, 1, INVALID),
        (0x1800, 2, 252, 1, 0),
        (0x1800, 2, 253, 1, 0),
        (0x1400, 2, 240, 1, 0),
        (0x1400, 2, 252, 1, INVALID),
        (0x1400, 2, 253, 1, INVALID),
        (0x1400, 2, 254, 1, 0),
        # identifiers
        (0x1803, 1, 0x2000_0483, 4, INVALID),  # 29 bits
        (0x1803, 1, 0x0000_0883, 4, INVALID),
        (0x1803, 1, 0x603, 4, INVALID),
        (0x1803, 1, 0x000, 4, INVALID),
        (0x1803, 1, 0x17F, 4, INVALID),
        (0x1803, 1, 0x6DF, 4, 0),
        (0x1403, 1, 0x6E0, 4, INVALID),
        # mapping of a PDO that is not valid
        (0x1A03, 0, 9, 1, TOO_HIGH),
        (0x1A03, 9, 0, 4, NO_SUB),
        (0x1A03, 1, 0, 4, 0),
        (0x1A03, 1, 0x60410010, 4, 0),
        (0x1A03, 1, 0x60410008, 4, NOT_MAPPABLE),  # half an object
        (0x1A03, 1, 0x60400010, 4, NOT_MAPPABLE),  # for RPDOs only
        (0x1A03, 1, 0x10170010, 4, NOT_MAPPABLE),
        (0x1A03, 1, 0x10010008, 4, 0),  # the error register
        (0x1A03, 1, 0x20000010, 4, NO_OBJECT),
        (0x1A03, 1, 0x60410110, 4, NO_SUB),
        (0x1601, 1, 0x60410010, 4, NOT_MAPPABLE),  # for TPDOs only
        (0x1601, 1, 0x10010008, 4, NOT_MAPPABLE),
        # dummies: RPDOs only, whole bytes only
        (0x1601, 1, 0x00050008, 4, 0),
        (0x1601, 1, 0x00070020, 4, 0),
        (0x1601, 1, 0x00070010, 4, NOT_MAPPABLE),
        (0x1601, 1, 0x00010001, 4, NOT_MAPPABLE),
        (0x1601, 1, 0x00050108, 4, NOT_MAPPABLE),  # a data type has no sub-index
        (0x1601, 1, 0x00080020, 4, NO_OBJECT),
        (0x1A03, 1, 0x00050008, 4, NOT_MAPPABLE),
    ],
)
def test_writes(stranger: Make, index: int, sub: int, value: int, size: int, code: int) -> None:
    assert stranger().write(index, sub, value, size) == code


def test_entries_need_a_count_of_0_and_the_count_fits_their_length(stranger: Make) -> None:
    drive = stranger()
    for sub in (1, 2, 3):
        assert drive.write(0x1A03, sub, 0x60640020, 4) == 0
    assert drive.write(0x1A03, 0, 3, 1) == TOO_LONG
    assert drive.write(0x1A03, 0, 2, 1) == 0
    assert drive.write(0x1A03, 3, 0, 4) == UNSUPPORTED
    assert drive.write(0x1A03, 0, 4, 1) == NO_OBJECT  # entry 4 is empty


def test_dummies_fill_places(stranger: Make) -> None:
    """RPDO2 = 16 bits for somebody else, controlword, 8 bits for somebody else."""
    drive = stranger()
    assert remap(drive, 0x1401, 0x303, 0x00060010, 0x60400010, 0x00020008, kind=255) == []
    drive.nmt(1)
    drive.after(0x303, "ffff" + "0600" + "ff")
    assert drive.node.image.controlword == 6
    assert drive.after(0x303, "ffff0600")[0] == (0x083, "1082110200000000")


def test_one_identifier_for_several_drives(stranger: Make) -> None:
    """RPDO2 on an identifier of another node: nothing says that it must be an own one."""
    drive = stranger()
    assert remap(drive, 0x1401, 0x190, 0x60400010, kind=255) == []
    drive.nmt(1)
    drive.after(0x190, "0600")
    assert drive.node.image.controlword == 6


def test_all_eight_pdos_at_one_sync(stranger: Make) -> None:
    """Four RPDOs take effect in the order of their numbers, four TPDOs answer in it."""
    drive = stranger()
    for n in range(1, 4):
        assert remap(drive, 0x1400 + n, 0x203 + 0x100 * n, 0x607A0020) == []
        assert remap(drive, 0x1800 + n, 0x183 + 0x100 * n, 0x60640020, 0x60FD0020) == []
    drive.nmt(1)
    for n in (3, 1, 2):
        drive.send(0x203 + 0x100 * n, f"0{n}000000")
    drive.run_ms(1)
    assert [can_id for can_id, _ in drive.after(0x80)] == [0x183, 0x283, 0x383, 0x483]
    assert drive.node.image.target_position == 3


def test_default_mapping_is_readable(stranger: Make) -> None:
    drive = stranger()
    assert drive.read(0x1600) == 3
    entries = [drive.read(0x1600, sub) for sub in (1, 2, 3, 4)]
    assert entries == [0x60400010, 0x607A0020, 0x60B80010, 0]


def test_fixed_mappings_take_what_is_there_and_nothing_else(stranger: Make) -> None:
    drive = stranger(profile=DriveProfile(fixed_pdos=True))
    assert drive.write(0x1600, 0, 3, 1) == 0
    assert drive.write(0x1600, 1, 0x60400010, 4) == 0
    assert drive.write(0x1600, 0, 0, 1) == 0x06010002
    assert drive.write(0x1A00, 1, 0x60640020, 4) == 0x06010002
    assert drive.write(0x1800, 2, 1, 1) == 0  # how it is sent may change


def test_a_drive_may_lack_objects_of_the_communication(stranger: Make) -> None:
    """They cannot be read or written; what they would switch on is off."""
    lacks = "1003 1006 1007 100C 1010 1014 1015 1016 1017 1019 1029 1400.5 1800.5 1802.3"
    drive = stranger(profile=DriveProfile(lacks=lacks))
    for index in (0x1003, 0x1006, 0x1014, 0x1016, 0x1017):
        assert drive.read_code(index) == NO_OBJECT
    assert drive.read_code(0x1800, 5) == NO_SUB
    drive.enable()
    assert [can_id for can_id, _ in drive.after(0x80)] == [0x183, 0x283]
