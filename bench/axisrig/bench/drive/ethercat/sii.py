"""The content of a slave's EEPROM, made from its description. Source: docs/ethercat.md."""

import struct
from typing import Final

from axisrig.bench.drive.ethercat.description import ASSIGN_ACTIVATE, Description, Pdo
from axisrig.bench.drive.ethercat.eeprom import check_sum
from axisrig.kernel.profiles.ethercat.layouts import (
    SII_CHECKSUM,
    SII_END,
    SII_FIRST_CATEGORY,
    SII_MAILBOX,
    SII_PROTOCOLS,
    SII_SIZE,
    SII_VENDOR,
    SYNC_MANAGER,
)
from axisrig.kernel.profiles.ethercat.tables import sii_categories

SIZE: Final = 2048
"""Bytes of the EEPROM."""
CONFIGURATION: Final = bytes.fromhex("8000000064000000")
"""Words 0 to 3: interface to the processor, its settings, pulses of 1 us, further settings."""
_COE, _SOE = 0x04, 0x10
_COE_BITS: Final = ("", "SdoInfo", "PdoAssign", "PdoConfig", "PdoUpload", "CompleteAccess")
"""Bits of the CoE details, the first one: SDO at all."""
_PORTS_MII: Final = 0x0011
_NOT_ASSIGNED: Final = 0xFF
_PDO: Final = struct.Struct("<HBBBBH")
_ENTRY: Final = struct.Struct("<HBBBBH")
_GENERAL: Final = struct.Struct("<12BhBBHH12x")
_CLOCK: Final = struct.Struct("<IIIhHhBB4x")
_FREE: Final = b"\xff"


class _Texts:
    """The texts of a slave; the first one has number 1, none has 0."""

    def __init__(self) -> None:
        self.all: list[str] = []

    def number(self, text: str) -> int:
        if text not in self.all:
            self.all.append(text)
        return self.all.index(text) + 1

    def content(self) -> bytes:
        parts = [bytes((len(text),)) + text.encode("ascii") for text in self.all]
        return bytes((len(self.all),)) + b"".join(parts)


def sii_content(description: Description) -> bytes:
    """Return the EEPROM of a slave, SIZE bytes; the end word closes the categories."""
    texts = _Texts()
    categories = [
        ("GENERAL", _general(description, texts)),
        ("FMMU", bytes(description.fmmus)),
        ("SYNC_MANAGER", _managers(description)),
        *(("TXPDO", _pdo(pdo, texts)) for pdo in description.txpdos),
        *(("RXPDO", _pdo(pdo, texts)) for pdo in description.rxpdos),
        ("DC", _clock(texts)),
    ]
    content = bytearray(_fixed(description))
    for name, data in [("STRINGS", texts.content()), *categories]:
        padded = (
            data + _FREE * (len(data) % 2) if name != "STRINGS" else data + bytes(len(data) % 2)
        )
        content += struct.pack("<HH", sii_categories()[name], len(padded) // 2) + padded
    content += struct.pack("<H", SII_END)
    if len(content) > SIZE:
        raise ValueError(f"{len(content)} bytes of SII do not fit into {SIZE}")
    return bytes(content) + _FREE * (SIZE - len(content))


def _fixed(description: Description) -> bytes:
    content = bytearray(2 * SII_FIRST_CATEGORY)
    content[: len(CONFIGURATION)] = CONFIGURATION
    struct.pack_into("<H", content, 8, description.alias)
    content[2 * SII_CHECKSUM] = check_sum(content)
    struct.pack_into(
        "<4I",
        content,
        2 * SII_VENDOR,
        description.vendor,
        description.product,
        description.revision,
        description.serial,
    )
    if description.managers:
        out, back = description.managers[:2]
        protocol = _SOE if description.is_sercos else _COE
        words = (out.start, out.length, back.start, back.length, protocol)
        struct.pack_into("<5H", content, 2 * SII_MAILBOX, *words)
    assert 2 * SII_PROTOCOLS == 2 * SII_MAILBOX + 8
    struct.pack_into("<HH", content, 2 * SII_SIZE, SIZE * 8 // 1024 - 1, 1)
    return bytes(content)


def _general(description: Description, texts: _Texts) -> bytes:
    name = texts.number(description.name)  # first, for SOEM takes the first text for it
    group, order = texts.number(description.group), texts.number(description.order)
    can = ("", *description.coe) if description.coe else ()
    details = sum(1 << bit for bit, word in enumerate(_COE_BITS) if word in can)
    soe = int(description.is_sercos)
    head = (group, 0, order, name, 0, details, 0, 0, soe, 1 - soe, 0, 0)
    return _GENERAL.pack(*head, 0, 0, 0, _PORTS_MII, 0)


def _managers(description: Description) -> bytes:
    return b"".join(
        SYNC_MANAGER.pack(m.start, m.length, m.control, 0, 1, m.kind) for m in description.managers
    )


def _pdo(pdo: Pdo, texts: _Texts) -> bytes:
    manager = _NOT_ASSIGNED if pdo.manager is None else pdo.manager
    head = _PDO.pack(pdo.index, len(pdo.entries), manager, 0, texts.number(pdo.name), 0)
    return head + b"".join(
        _ENTRY.pack(e.index, e.sub, texts.number(e.name), e.kind, e.bits, 0) for e in pdo.entries
    )


def _clock(texts: _Texts) -> bytes:
    synchron = _CLOCK.pack(0, 0, 0, 0, ASSIGN_ACTIVATE, 1, texts.number("DC-Synchron"), 0)
    return synchron + _CLOCK.pack(0, 0, 0, 0, 0, 0, texts.number("SM-Synchron"), 0)
