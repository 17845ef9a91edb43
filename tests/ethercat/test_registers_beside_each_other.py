"""What an access to some registers of a slave leaves of the others, and reads of any length."""

import struct

import pytest
from tests.ethercat.line import PREOP, Line
from tests.ethercat.sync_signals import start_sync
from tests.ethercat.test_latches_and_times_by_register import AL, Terminal

from axisrig.kernel.time.clock import MS, US

APRD, APWR = 1, 2


@pytest.mark.parametrize("begin", [0x09A4, 0x09A9, 0x09AC])
def test_a_longer_read_from_the_same_place_shows_what_it_reaches(begin: int) -> None:
    """One byte, then as many as reach the status and the times of the latch inputs."""
    line = Terminal((1000,), (1100,))
    for number in (0, 1):
        line.write(0x09A8 + number, 3, 1)
    line.wait(2 * MS)
    line.read(begin, 1)
    data = line.one(APRD, 0, begin, 0x09D0 - begin).data
    at = 0x09AE - begin
    assert data[at : at + 2] == bytes((0b101, 0b101))
    assert struct.unpack_from("<4Q", data, at + 2) == (1000 * US, 0, 1100 * US, 0)
    line.read(begin, 1)
    assert (line.status(0), line.status(1)) == (0b100, 0b100)  # the times have been read


def test_a_change_of_the_al_state_is_an_event_until_its_status_is_read() -> None:
    """Whatever else is read before (ETG.1000.4: 0210, bit 3; 0200 lets it through)."""
    line = Terminal((1000,))
    line.write(0x0200, AL, 2)
    line.read(0x0130, 2)
    assert line.events & AL == 0
    line.write(0x0120, PREOP, 2)
    line.wait(MS)
    for register, size in ((0x09B0, 8), (0x09B0, 32), (0x09AE, 2), (0x0110, 2), (0x0134, 2)):
        line.read(register, size)
        assert line.events & AL == AL, hex(register)
    assert line.read(0x0130, 2) == PREOP
    assert line.events & AL == 0


@pytest.mark.parametrize(
    ("register", "size"),
    [(0x0120, 2), (0x0410, 2), (0x0420, 2), (0x0600, 16), (0x0800, 8), (0x0300, 8), (0x0504, 4)],
)
def test_a_word_of_the_eeprom_stays_until_it_is_asked_for_anew(register: int, size: int) -> None:
    """0502: the command, 0504: the word, 0508: its data; another address alone reads nothing."""
    line = Line()
    line.write(0x0504, 8, 4)
    line.write(0x0502, 0x0100, 2)
    line.wait(MS)
    vendor_product = line.read(0x0508, 8)
    line.write(0x0504, 10, 4)
    line.write(register, 10 if register == 0x0504 else 0, size)
    line.wait(MS)
    assert line.read(0x0508, 8) == vendor_product
    line.write(0x0502, 0x0100, 2)
    line.wait(MS)
    assert line.read(0x0508, 8) & 0xFFFF_FFFF == vendor_product >> 32  # product: words 10 and 11


@pytest.mark.parametrize(("register", "size"), [(0x09A8, 1), (0x09A9, 1), (0x09A4, 4)])
def test_sync0_goes_on_its_grid_whatever_is_written_beside_it(register: int, size: int) -> None:
    """0990 shows the next one; how latches and SYNC1 work is written while it runs."""
    line = Line()
    line.one(APWR, 0, 0x0920, bytes(8))
    first = start_sync(line, MS)
    line.wait(20 * MS + 100 * US)
    before = line.read(0x0990, 8)
    assert (before - first) % MS == 0
    line.write(register, 0, size)
    line.wait(7 * MS)
    after = line.read(0x0990, 8)
    now = line.read(0x0910, 8)
    assert (after - first) % MS == 0
    assert now < after <= now + MS
