"""The EEPROM of a slave (SII) as a master reads it: identity, mailboxes, SyncManagers."""

from dataclasses import dataclass
from typing import Final

from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces
from axisrig.kernel.drives.ethercat.steps import (
    Pause,
    Steps,
    read_register,
    value_of,
    write_register,
)
from axisrig.kernel.profiles.ethercat.layouts import (
    SII_END,
    SII_FIRST_CATEGORY,
    SII_MAILBOX,
    SII_VENDOR,
)
from axisrig.kernel.profiles.ethercat.tables import sii_categories
from axisrig.kernel.time.clock import US, TimeNs

READ: Final = (0x0100).to_bytes(2, "little")
BUSY, FAILED = 0x8000, 0x2000
EIGHT_BYTES: Final = 1 << 6
WAIT_NS: Final[TimeNs] = 500 * US
POLLS_MAX: Final = 40  # 20 ms, as masters wait
ATTEMPTS: Final = 3
WORDS_MAX: Final = 4096
MANAGER_BYTES: Final = 8


@dataclass(frozen=True)
class Described:
    """What an EEPROM says. identity: vendor, product, revision, serial.

    managers: start address and control byte of each SyncManager.
    """

    identity: tuple[int, int, int, int]
    mailbox: MailboxPlaces
    managers: tuple[tuple[int, int], ...]


class EepromError(Exception):
    """The EEPROM cannot be read; the text says why."""


class _Reader:
    """Reads words of one EEPROM and keeps them."""

    def __init__(self, station: int) -> None:
        self._station = station
        self._words: dict[int, int] = {}

    def word(self, address: int) -> Steps:
        """Return a word. Raises EepromError."""
        if address not in self._words:
            yield from self._fetch(address)
        return self._words[address]

    def number(self, address: int) -> Steps:
        """Return a number of two words."""
        low = yield from self.word(address)
        high = yield from self.word(address + 1)
        return low | high << 16

    def _fetch(self, address: int) -> Steps:
        for _ in range(ATTEMPTS):
            yield write_register(self._station, "EEPROM_ADDRESS", address.to_bytes(4, "little"))
            yield write_register(self._station, "EEPROM_CONTROL", READ)
            for _ in range(POLLS_MAX):
                state = value_of((yield read_register(self._station, "EEPROM_CONTROL", 2)))
                if state is not None and not state & BUSY:
                    break
                yield Pause(WAIT_NS)
            else:
                raise EepromError("it stays busy")
            if not state & FAILED:
                size = 8 if state & EIGHT_BYTES else 4
                answers = yield read_register(self._station, "EEPROM_DATA", size)
                if answers and answers[0].counter == 1:
                    data = answers[0].data
                    for place in range(0, size, 2):
                        word = int.from_bytes(data[place : place + 2], "little")
                        self._words[address + place // 2] = word
                    return
        raise EepromError("it does not acknowledge")


def read_eeprom(station: int) -> Steps:
    """Return what the EEPROM of a slave says, `Described`. Raises EepromError."""
    reader = _Reader(station)
    yield write_register(station, "EEPROM_CONFIGURATION", bytes((2,)))
    yield write_register(station, "EEPROM_CONFIGURATION", bytes((0,)))
    identity = []
    for place in range(4):
        identity.append((yield from reader.number(SII_VENDOR + 2 * place)))
    words = []
    for place in range(4):
        words.append((yield from reader.word(SII_MAILBOX + place)))
    managers = yield from _managers(reader)
    vendor, product, revision, serial = identity
    return Described((vendor, product, revision, serial), MailboxPlaces(*words), managers)


def _managers(reader: _Reader) -> Steps:
    """Walk the categories to that of the SyncManagers."""
    wanted, at = sii_categories()["SYNC_MANAGER"], SII_FIRST_CATEGORY
    while at < WORDS_MAX:
        kind = yield from reader.word(at)
        if kind == SII_END:
            break
        length = yield from reader.word(at + 1)
        if kind == wanted:
            found = []
            for number in range(length * 2 // MANAGER_BYTES):
                place = at + 2 + number * MANAGER_BYTES // 2
                start = yield from reader.word(place)
                control = yield from reader.word(place + 2)
                found.append((start, control & 0xFF))
            return tuple(found)
        at += 2 + length
    return ()
