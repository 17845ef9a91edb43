"""The PDOs of a drive node: read from the object dictionary, compiled to `struct` codecs.

Source: CiA 301, PDO communication parameters 1400h, 1800h and mapping parameters 1600h, 1A00h.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Final

from canopen.sdo.exceptions import SdoAbortedError

from bench.drive.image import ProcessImage
from bench.drive.objects import object_rows, variables
from kernel.clock import US, TimeNs

COUNT: Final = 4  # RPDOs and TPDOs of a node
RPDO_COMMUNICATION, RPDO_MAPPING = 0x1400, 0x1600
TPDO_COMMUNICATION, TPDO_MAPPING = 0x1800, 0x1A00
COB_ID, TRANSMISSION, INHIBIT = 1, 2, 3  # sub-indices of a communication parameter
NOT_VALID, EXTENDED, ID_MASK = 1 << 31, 1 << 29, 0x7FF
SYNC_LAST, EVENT_FIRST = 240, 254  # transmission types 0 to 240 and 254, 255
BITS_MAX = 64
INHIBIT_UNIT_NS = 100 * US
# Identifiers between those of the predefined connection set that a PDO must not take
FREE_IDS = (range(0x181, 0x580), range(0x680, 0x6E0))

UNSUPPORTED_ACCESS = 0x06010000
NO_OBJECT = 0x06020000
NOT_MAPPABLE = 0x06040041
PDO_TOO_LONG = 0x06040042
NO_SUB_INDEX = 0x06090011
INVALID_VALUE = 0x06090030

ReadObject = Callable[[int, int], int]


@dataclass(frozen=True)
class Layout:
    """What a PDO carries: fields of the process image and the codec of their values."""

    fields: tuple[str, ...]
    codec: struct.Struct

    def store(self, image: ProcessImage, data: bytes) -> None:
        """Write the values of a message into the image; data beyond the mapping is ignored."""
        for name, value in zip(self.fields, self.codec.unpack_from(data), strict=True):
            setattr(image, name, value)

    def reader(self) -> Callable[[ProcessImage], bytes]:
        """Return the function that makes the message from the image."""
        pack, fields = self.codec.pack, self.fields
        if len(fields) == 1:
            value_of = attrgetter(*fields)
            return lambda image: pack(value_of(image))
        values_of = attrgetter(*fields)
        return lambda image: pack(*values_of(image))


@dataclass(slots=True)
class Rpdo:
    """A received PDO. data: what came and waits for its SYNC."""

    cob_id: int
    at_once: bool
    layout: Layout
    data: bytes | None = None


@dataclass(slots=True)
class Tpdo:
    """A sent PDO.

    sync_count: 1 to 240 = every n-th SYNC, 0 = on change. at_sync: a change goes with the SYNC
    only (type 0). sent: data sent last. free_ns: end of the inhibit time. waits: a call at its
    end is under way.
    """

    cob_id: int
    sync_count: int
    at_sync: bool
    inhibit_ns: TimeNs
    message: Callable[[ProcessImage], bytes]
    syncs: int = 0
    sent: bytes | None = None
    free_ns: TimeNs = 0
    waits: bool = False


def read_rpdo(number: int, read: ReadObject) -> Rpdo | None:
    """Compile RPDO `number` (0 to 3) from the dictionary; None when it carries nothing."""
    cob_id = read(RPDO_COMMUNICATION + number, COB_ID)
    layout = read_layout(RPDO_MAPPING + number, read)
    if cob_id & NOT_VALID or not layout.fields:
        return None
    transmission = read(RPDO_COMMUNICATION + number, TRANSMISSION)
    return Rpdo(cob_id & ID_MASK, transmission > SYNC_LAST, layout)


def read_tpdo(number: int, read: ReadObject) -> Tpdo | None:
    """Compile TPDO `number` (0 to 3) from the dictionary; None when it carries nothing."""
    communication = TPDO_COMMUNICATION + number
    cob_id = read(communication, COB_ID)
    layout = read_layout(TPDO_MAPPING + number, read)
    if cob_id & NOT_VALID or not layout.fields:
        return None
    transmission = read(communication, TRANSMISSION)
    return Tpdo(
        cob_id & ID_MASK,
        transmission if transmission <= SYNC_LAST else 0,
        transmission == 0,
        read(communication, INHIBIT) * INHIBIT_UNIT_NS,
        layout.reader(),
    )


def read_layout(mapping: int, read: ReadObject) -> Layout:
    """Compile the mapping parameter `mapping`; its entries are valid (`check_write`)."""
    keys = [_key(read(mapping, sub)) for sub in range(1, read(mapping, 0) + 1)]
    rows = [variables()[key] for key in keys]
    codec = struct.Struct("<" + "".join(row.data_type.format for row in rows))
    return Layout(tuple(row.value for row in rows), codec)


def is_parameter(index: int) -> bool:
    """Whether an object is a PDO parameter of this node."""
    return any(
        base <= index < base + COUNT
        for base in (RPDO_COMMUNICATION, RPDO_MAPPING, TPDO_COMMUNICATION, TPDO_MAPPING)
    )


def check_write(index: int, sub: int, value: int, read: ReadObject) -> None:
    """Refuse a write to a PDO parameter that the standard forbids.

    A mapping changes only while the PDO is not valid, its entries only while their number is 0;
    a valid PDO keeps its identifier and inhibit time. Raises SdoAbortedError.
    """
    is_mapping = index & 0x200
    is_valid = not read(index & ~0x200, COB_ID) & NOT_VALID
    direction = "rx" if index < TPDO_COMMUNICATION else "tx"
    if is_mapping:
        if is_valid or (sub and read(index, 0)):
            raise SdoAbortedError(UNSUPPORTED_ACCESS)
        entries = [read(index, number) for number in range(1, value + 1)] if sub == 0 else [value]
        if sub == 0 or value:  # an unused entry may be emptied
            for entry in entries:
                _check_entry(entry, direction)
        if sum(entry & 0xFF for entry in entries) > BITS_MAX:
            raise SdoAbortedError(PDO_TOO_LONG)
    elif sub == COB_ID:
        _check_cob_id(value, read(index, COB_ID))
    elif (sub == TRANSMISSION and SYNC_LAST < value < EVENT_FIRST) or (sub == INHIBIT and is_valid):
        raise SdoAbortedError(INVALID_VALUE)


def _check_cob_id(value: int, present: int) -> None:
    if value & NOT_VALID:
        return
    can_id = value & ID_MASK
    is_changed = not present & NOT_VALID and can_id != present & ID_MASK
    if is_changed or value & EXTENDED or not any(can_id in free for free in FREE_IDS):
        raise SdoAbortedError(INVALID_VALUE)


def _check_entry(entry: int, direction: str) -> None:
    index, sub = _key(entry)
    row = variables().get((index, sub))
    if row is None:
        is_known = any(known.index == index for known in object_rows())
        raise SdoAbortedError(NO_SUB_INDEX if is_known else NO_OBJECT)
    # Whole objects only, so every entry starts at a byte
    if row.pdo != direction or entry & 0xFF != row.data_type.bits:
        raise SdoAbortedError(NOT_MAPPABLE)


def _key(entry: int) -> tuple[int, int]:
    return entry >> 16, entry >> 8 & 0xFF
