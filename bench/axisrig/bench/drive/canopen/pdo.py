"""The PDOs of a drive node: read from the object dictionary, compiled to codecs (`mapping.py`).

Source: CiA 301, PDO communication parameters 1400h, 1800h and mapping parameters 1600h, 1A00h.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from axisrig.bench.drive.canopen.identifiers import check_cob_id
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.mapping import Layout, check_entry, read_layout
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.kernel.profiles.canopen.identifiers import BIT_30, ID_MASK, MAPPING_OF_PDO, NOT_VALID
from axisrig.kernel.time.clock import MS, US, TimeNs

PDOS: Final = 512  # RPDOs, and TPDOs, that a node can have
RPDO_COMMUNICATION, RPDO_MAPPING = 0x1400, 0x1600
TPDO_COMMUNICATION, TPDO_MAPPING = 0x1800, 0x1A00
PARAMETERS: Final = frozenset(
    base + number
    for base in (RPDO_COMMUNICATION, RPDO_MAPPING, TPDO_COMMUNICATION, TPDO_MAPPING)
    for number in range(PDOS)
)
# Sub-indices of a communication parameter
COB_ID, TRANSMISSION, INHIBIT, EVENT_TIMER, SYNC_START = 1, 2, 3, 5, 6
SYNC_LAST: Final = 240
REMOTE_AT_SYNC, REMOTE, EVENT_FIRST = 252, 253, 254
BITS_MAX: Final = 64
SYNC_COUNTER: Final = 0x1019
INHIBIT_UNIT_NS: Final = 100 * US


@dataclass(slots=True)
class Rpdo:
    """A received PDO.

    timeout_ns: 0 = none. data: what came and waits for its SYNC. has_error: the last message had
    a wrong length, or none came in time.
    """

    number: int
    cob_id: int
    at_once: bool
    layout: Layout
    size: int
    timeout_ns: TimeNs
    data: bytes | None = None
    has_error: bool = False


@dataclass(slots=True)
class Tpdo:
    """A sent PDO.

    type: transmission type. sync_count: 1 to 240 = every n-th SYNC, otherwise 0. event_ns: greatest
    time between two messages, 0 = none. awaits: value of the SYNC counter that the count begins
    with, 0 once it has. answers_remote: remote requests are allowed. sent: data sent or sampled
    last. free_ns: end of the inhibit time. waits: a call at its end is under way.
    """

    number: int
    cob_id: int
    type: int
    sync_count: int
    inhibit_ns: TimeNs
    event_ns: TimeNs
    awaits: int
    answers_remote: bool
    layout: Layout
    message: Callable[[DeviceImage], bytes]
    syncs: int = 0
    sent: bytes | None = None
    free_ns: TimeNs = 0
    waits: bool = False

    @property
    def is_event_driven(self) -> bool:
        """Types 254 and 255."""
        return self.type >= EVENT_FIRST

    def is_due(self, counter: int | None) -> bool:
        """Count a SYNC; return whether it asks for the message. counter: that of the SYNC."""
        if self.awaits:
            if counter != self.awaits:
                return False
            self.awaits = 0
        self.syncs = (self.syncs + 1) % self.sync_count
        return self.syncs == 0


def read_rpdo(number: int, store: ObjectStore) -> Rpdo | None:
    """Compile RPDO `number` (from 0) from the dictionary; None when it carries nothing."""
    communication = RPDO_COMMUNICATION + number
    cob_id = store.value(communication, COB_ID)
    layout = read_layout(RPDO_MAPPING + number, store)
    if cob_id & NOT_VALID or not layout.codec.size:
        return None
    return Rpdo(
        number,
        cob_id & ID_MASK,
        store.value(communication, TRANSMISSION) > SYNC_LAST,
        layout,
        layout.codec.size,
        store.value(communication, EVENT_TIMER) * MS,
    )


def read_tpdo(number: int, store: ObjectStore) -> Tpdo | None:
    """Compile TPDO `number` (from 0) from the dictionary; None when it carries nothing."""
    communication = TPDO_COMMUNICATION + number
    cob_id = store.value(communication, COB_ID)
    layout = read_layout(TPDO_MAPPING + number, store)
    if cob_id & NOT_VALID or not layout.fields:
        return None
    kind = store.value(communication, TRANSMISSION)
    by_event = kind >= EVENT_FIRST  # inhibit time and event timer are for these alone
    has_counter = store.value(SYNC_COUNTER) > 0
    return Tpdo(
        number,
        cob_id & ID_MASK,
        kind,
        kind if kind <= SYNC_LAST else 0,
        store.value(communication, INHIBIT) * INHIBIT_UNIT_NS if by_event else 0,
        store.value(communication, EVENT_TIMER) * MS if by_event else 0,
        store.value(communication, SYNC_START) if has_counter else 0,
        not cob_id & BIT_30,
        layout,
        layout.reader(),
    )


def pdo_numbers(store: ObjectStore) -> range:
    """Return the numbers, from 0, of the PDOs of a node: up to the last one that it has."""
    known = [
        index - base
        for base in (RPDO_COMMUNICATION, TPDO_COMMUNICATION)
        for index in store.indices
        if base <= index < base + PDOS and store.holds(index, COB_ID)
    ]
    return range(max(known, default=-1) + 1)


def check_write(index: int, sub: int, value: int, store: ObjectStore) -> None:
    """Refuse a write to a PDO parameter that the standard forbids.

    A mapping changes only while the PDO is not valid, its entries only while their number is 0;
    a valid PDO keeps its identifier, inhibit time and SYNC start value. Raises SdoAbortedError.
    """
    communication = index & ~MAPPING_OF_PDO
    is_valid = not store.value(communication, COB_ID) & NOT_VALID
    if index & MAPPING_OF_PDO:
        _check_mapping(index, sub, value, is_valid, store)
    elif sub == COB_ID:
        check_cob_id(value, store.value(index, COB_ID))
    elif sub == TRANSMISSION:
        first = EVENT_FIRST if index < TPDO_COMMUNICATION else REMOTE_AT_SYNC
        if SYNC_LAST < value < first:
            abort(AbortCode.INVALID_VALUE)
    elif sub in (INHIBIT, SYNC_START) and is_valid and value != store.value(index, sub):
        abort(AbortCode.INVALID_VALUE)


def _check_mapping(index: int, sub: int, value: int, is_valid: bool, store: ObjectStore) -> None:
    if is_valid or (sub and store.value(index)):
        abort(AbortCode.UNSUPPORTED_ACCESS)
    entries = [value]
    if sub == 0:
        entries = [store.value(index, number) for number in range(1, value + 1)]
    elif not value:
        return  # an unused entry may be emptied
    direction = "rx" if index < TPDO_COMMUNICATION else "tx"
    for entry in entries:
        check_entry(entry, direction, store)
    if sum(entry & 0xFF for entry in entries) > BITS_MAX:
        abort(AbortCode.PDO_TOO_LONG)
