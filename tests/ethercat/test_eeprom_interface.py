"""The EEPROM interface of a slave alone: its last word, its commands, its check sum."""

import pytest
from tests.ethercat.line import Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import describe
from axisrig.bench.drive.ethercat.eeprom import Eeprom, check_sum
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.sii import SIZE, sii_content

READ, WRITE, RELOAD, UNKNOWN, MAY = 0x0100, 0x0200, 0x0400, 0x0700, 0x0001
READS_8, BAD_SUM, REFUSED, NOT_ENABLED = 1 << 6, 1 << 11, 1 << 13, 1 << 14
LAST = SIZE // 2 - 1


@pytest.fixture
def eeprom() -> Eeprom:
    made = Eeprom(sii_content(describe(DriveProfile())))
    made.load()
    return made


def test_the_last_word_is_written_and_one_behind_it_refused(eeprom: Eeprom) -> None:
    given = b"\x34\x12" + bytes(6)
    assert eeprom.command(WRITE | MAY, LAST, given) == given
    assert (bytes(eeprom.content[-2:]), eeprom.status) == (b"\x34\x12", READS_8)
    assert eeprom.command(READ, LAST, bytes(8)) == b"\x34\x12" + b"\xff" * 6
    before = bytes(eeprom.content)
    for word in (LAST + 1, LAST + 2, 0xFFFF):
        eeprom.command(WRITE | MAY, word, given)
        assert eeprom.status == READS_8 | REFUSED
        assert eeprom.command(READ, word, bytes(8)) == b"\xff" * 8
        assert eeprom.status == READS_8
    assert bytes(eeprom.content) == before
    assert len(before) == SIZE


def test_a_write_needs_its_bit_and_a_command_its_number(eeprom: Eeprom) -> None:
    before = bytes(eeprom.content)
    eeprom.command(WRITE, 4, b"\x01\x00")
    assert eeprom.status == READS_8 | NOT_ENABLED
    eeprom.command(UNKNOWN, 4, b"\x01\x00")
    assert eeprom.status == READS_8 | REFUSED
    eeprom.command(0, 4, b"\x01\x00")
    assert (eeprom.status, bytes(eeprom.content)) == (READS_8, before)


def test_a_wrong_check_sum_is_reported_until_it_is_right_at_a_reload(eeprom: Eeprom) -> None:
    """The alias, word 4, counts with a right one only; the status of each command shows it."""
    eeprom.command(WRITE | MAY, 4, b"\x07\x00")
    assert (eeprom.status, eeprom.alias) == (READS_8, 0)  # not loaded yet
    for command in (RELOAD, READ, WRITE | MAY, 0):
        eeprom.command(command, 4, b"\x07\x00")
        assert (eeprom.status, eeprom.alias) == (READS_8 | BAD_SUM, 0)
    eeprom.command(UNKNOWN, 4, bytes(2))
    assert eeprom.status == READS_8 | BAD_SUM | REFUSED
    eeprom.command(WRITE | MAY, 7, bytes((check_sum(eeprom.content), 0)))
    assert eeprom.status == READS_8 | BAD_SUM
    eeprom.command(RELOAD, 0, bytes(8))
    assert (eeprom.status, eeprom.alias) == (READS_8, 7)
    eeprom.command(WRITE | MAY, 5, b"\x01\x00")
    eeprom.command(RELOAD, 0, bytes(8))
    assert (eeprom.status, eeprom.alias) == (READS_8 | BAD_SUM, 0)


@pytest.mark.parametrize("serial", [0, 7, 0xFFFF_FFFF])
def test_the_identity_has_the_serial_number_of_the_slave(serial: int) -> None:
    """1018:4 and word 14 of the EEPROM; it stays over power."""
    line = Line(settings=[SlaveSettings(serial=serial)])
    for _ in range(2):
        line.wait(1000)
        line.preop()
        assert int.from_bytes(line.sdo_read(0x1018, 4), "little") == serial
        assert int.from_bytes(line.drive.eeprom.content[28:32], "little") == serial
        line.drive.power_off()
        line.drive.power_on()
