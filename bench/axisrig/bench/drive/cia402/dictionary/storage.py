"""Parameters that outlive a reset: store 1010, restore 1011, verification 1020.

Source: CiA 301. Stored values live as long as the node object, over resets and power cycles.
Process data, that is everything an RPDO can carry, is not stored.
"""

from collections.abc import Mapping
from typing import ClassVar, Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.objects import Key, ObjectRow
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner

STORE, RESTORE, VERIFY = 0x1010, 0x1011, 0x1020
SAVE: Final = int.from_bytes(b"save", "little")
LOAD: Final = int.from_bytes(b"load", "little")
SAVES_ON_COMMAND: Final = 1
GROUPS: Final = {1: (0x1000, 0xFFFF), 2: (0x1000, 0x1FFF), 3: (0x6000, 0x9FFF)}
"""Sub-index of 1010 and 1011: all, communication, application."""
_NEVER_STORED = (0x1003, STORE, RESTORE)


class ParameterStorage(Owner):
    """Keeps what 1010 has stored; `apply` gives it back at a reset.

    A value that is the default is kept as the default: an identifier that follows the node number
    goes on doing so.
    """

    objects: ClassVar[tuple[int, ...]] = (STORE, RESTORE)

    def __init__(self, store: ObjectStore) -> None:
        self._store = store
        self._stored: dict[Key, int] = {}
        self._node_id = 0

    @property
    def stored(self) -> Mapping[Key, int]:
        """What 1010 has stored, by index and sub-index; a new mapping after each store."""
        return self._stored

    def load(self, stored: Mapping[Key, int]) -> None:
        """Take what was stored in an earlier life of the drive; it counts from the next reset on.

        Objects that this drive does not store are left out.
        """
        known = {row.key for row in self._store.rows if is_stored(row)}
        self._stored = {key: value for key, value in stored.items() if key in known}

    def apply(self, node_id: int, first: int, last: int) -> None:
        """Give the objects `first` to `last` what they have at power on with this node number."""
        self._node_id = node_id
        self._store.restore(node_id, first, last)
        for (index, sub), value in self._stored.items():
            if first <= index <= last:
                self._store.set_value(index, sub, value)

    def note_change(self, row: ObjectRow) -> None:
        """Take note of a write: the configuration is no longer the verified one."""
        if is_stored(row) and row.index != VERIFY and self._store.holds(VERIFY):
            for sub in (1, 2):
                self._store.set_value(VERIFY, sub, 0)

    # The objects

    def read(self, index: int, sub: int) -> int | None:
        """Say that parameters are stored on command, or can be restored."""
        return SAVES_ON_COMMAND if sub else None

    def check(self, index: int, sub: int, value: int) -> None:
        """Only the signature stores or restores."""
        if value != (SAVE if index == STORE else LOAD):
            abort(AbortCode.NOT_STORED)

    def written(self, index: int, sub: int, value: int) -> None:
        """Store the group now, or forget it: the defaults come with the next reset."""
        first, last = GROUPS[sub]
        self._stored = {
            key: kept for key, kept in self._stored.items() if not first <= key[0] <= last
        }
        if index == RESTORE:
            return
        for row in self._store.rows:
            if first <= row.index <= last and is_stored(row):
                present = self._store.value(*row.key)
                if present != self._store.default(row, self._node_id):
                    self._stored[row.key] = present


def is_stored(row: ObjectRow) -> bool:
    """Whether 1010 stores an object."""
    is_number = bool(row.data_type.bits)
    return row.access == "rw" and is_number and row.pdo != "rx" and row.index not in _NEVER_STORED
