"""The EEPROM interface of a slave controller. Source: docs/ethercat.md.

A command is done within the frame that asks for it: a master never sees it busy.
"""

from typing import Final

from axisrig.kernel.profiles.ethercat.layouts import SII_ALIAS

READ, WRITE, RELOAD = 1, 2, 4
WRITE_ENABLE: Final = 1 << 0
READS_8_BYTES: Final = 1 << 6
BAD_CHECKSUM: Final = 1 << 11
REFUSED: Final = 1 << 13
WRITE_REFUSED: Final = 1 << 14
_COMMAND: Final = 0x0700
_WORDS_OF_CHECKSUM: Final = 7


def check_sum(content: bytes | bytearray) -> int:
    """Return the check sum of the first words: CRC of polynomial 07 hex, start value FF hex."""
    crc = 0xFF
    for byte in content[: 2 * _WORDS_OF_CHECKSUM]:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x07 if crc & 0x80 else crc << 1) & 0xFF
    return crc


class Eeprom:
    """content: its bytes, which a master may change. alias: as it was loaded last."""

    def __init__(self, content: bytes) -> None:
        self.content = bytearray(content)
        self.alias = 0
        self.status = READS_8_BYTES

    def load(self) -> None:
        """Take the alias over, where the check sum is right."""
        is_right = self.content[14] == check_sum(self.content)
        self.status = READS_8_BYTES | (0 if is_right else BAD_CHECKSUM)
        alias = int.from_bytes(self.content[2 * SII_ALIAS : 2 * SII_ALIAS + 2], "little")
        self.alias = alias if is_right else 0

    def command(self, control: int, word: int, data: bytes) -> bytes:
        """Carry out what a master asks for; return the 8 bytes of the data register."""
        kind = (control & _COMMAND) >> 8
        kept = self.status & BAD_CHECKSUM
        self.status = READS_8_BYTES | kept
        at = 2 * word
        if kind == READ:
            if at >= len(self.content):
                return b"\xff" * 8
            return bytes(self.content[at : at + 8]).ljust(8, b"\xff")
        if kind == WRITE:
            if not control & WRITE_ENABLE:
                self.status |= WRITE_REFUSED
            elif at + 2 > len(self.content):
                self.status |= REFUSED
            else:
                self.content[at : at + 2] = data[:2]
        elif kind == RELOAD:
            self.load()
        elif kind:
            self.status |= REFUSED
        return data
