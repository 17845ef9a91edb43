"""SDO information: lists of objects, descriptions of objects and of their entries.

Source: docs/ethercat.md. Lists go in fragments of what the mailbox holds.
"""

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.objects import VARIABLE, ObjectRow
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.storage import is_stored
from axisrig.bench.drive.ethercat.objects import Described, type_of
from axisrig.kernel.profiles.ethercat.layouts import COE, MAILBOX, SDO_INFORMATION, CoeService

_LIST, _OBJECT, _ENTRY, _ERROR = 1, 3, 5, 7
_OPERATION: Final = 0x7F
_MORE: Final = 0x80
_ALL, _RX, _TX, _STORED, _STARTUP = 1, 2, 3, 4, 5
_READ: Final = 0x07
_WRITE: Final = 0x38
_RX_BIT: Final = 1 << 6
_TX_BIT: Final = 1 << 7
_STORED_BIT: Final = 1 << 8
_HEAD: Final = struct.Struct("<HHBB")
_ENTRY_HEAD: Final = struct.Struct("<HBBHHH")
_ARRAY: Final = 8


class ObjectInformation:
    """Answers requests for information. size(): bytes of the mailbox to the master."""

    def __init__(
        self,
        known: Mapping[int, Described],
        profile: DriveProfile,
        text_bytes: Callable[[int], int],
        size: Callable[[], int],
    ) -> None:
        self._known, self._profile = known, profile
        self._text_bytes, self._size = text_bytes, size

    def request(self, body: bytes) -> list[bytes]:
        """Return the answers to a request, all with their CoE heads."""
        data = body[COE.size :]
        try:
            if len(data) < SDO_INFORMATION.size + 2:
                abort(AbortCode.LENGTH)
            operation = data[0] & _OPERATION
            rest = data[SDO_INFORMATION.size :]
            (word,) = struct.unpack_from("<H", rest)
            if operation == _LIST:
                return self._list(word)
            if operation == _OBJECT:
                return [_answer(_OBJECT + 1, self._object(word))]
            if operation == _ENTRY and len(rest) >= 4:
                return [_answer(_ENTRY + 1, self._entry(word, rest[2], rest[3]))]
            abort(AbortCode.COMMAND)
        except SdoAbortedError as error:
            return [_answer(_ERROR, struct.pack("<I", error.code))]

    def _list(self, kind: int) -> list[bytes]:
        if kind == 0:
            lengths = [len(self._indices(each)) for each in range(_ALL, _STARTUP + 1)]
            content = struct.pack("<H5H", 0, *lengths)
        elif kind <= _STARTUP:
            found = self._indices(kind)
            content = struct.pack(f"<H{len(found)}H", kind, *found)
        else:
            abort(AbortCode.UNSUPPORTED_ACCESS)
        most = (self._size() - MAILBOX.size - COE.size - SDO_INFORMATION.size) // 2 * 2
        parts = [content[at : at + most] for at in range(0, len(content), most)]
        last = len(parts) - 1
        return [_answer(_LIST + 1, part, left=last - number) for number, part in enumerate(parts)]

    def _indices(self, kind: int) -> Sequence[int]:
        def fits(row: ObjectRow) -> bool:
            if kind == _RX:
                return "rx" in row.pdo
            if kind == _TX:
                return "tx" in row.pdo
            return kind == _ALL or is_stored(row)

        return [i for i, known in self._known.items() if any(map(fits, known.rows.values()))]

    def _described(self, index: int) -> Described:
        known = self._known.get(index)
        if known is None:
            abort(AbortCode.NO_OBJECT)
        return known

    def _object(self, index: int) -> bytes:
        known = self._described(index)
        last = max(known.rows)
        head = _HEAD.pack(index, self._type(known), last, known.code)
        return head + known.name.encode("ascii")

    def _type(self, known: Described) -> int:
        """Return the data type of a variable or of the members of an array, 0 of a record."""
        if known.code == VARIABLE:
            return type_of(known.rows[0], self._profile).code
        members = [row for sub, row in known.rows.items() if sub]  # the drive may lack some
        if known.code != _ARRAY or not members:
            return 0
        return type_of(members[0], self._profile).code

    def _entry(self, index: int, sub: int, values: int) -> bytes:
        known = self._described(index)
        row = known.rows.get(sub)
        if row is None:
            if sub > max(known.rows):
                abort(AbortCode.NO_SUB_INDEX)
            return _ENTRY_HEAD.pack(index, sub, values & 0x80, 0, 0, 0)  # a gap
        kind = type_of(row, self._profile)
        bits = kind.bits or 8 * self._text_bytes(index)
        # Nothing of what `values` may ask for (unit, default, limits) is given
        head = _ENTRY_HEAD.pack(index, sub, values & 0x80, kind.code, bits, _access(row))
        return head + row.name.encode("ascii")


def _access(row: ObjectRow) -> int:
    access = _READ | (_WRITE if row.access == "rw" else 0)
    access |= (_RX_BIT if "rx" in row.pdo else 0) | (_TX_BIT if "tx" in row.pdo else 0)
    return access | (_STORED_BIT if is_stored(row) else 0)


def _answer(operation: int, data: bytes, left: int = 0) -> bytes:
    head = SDO_INFORMATION.pack(operation | (_MORE if left else 0), 0, left)
    return COE.pack(CoeService.SDO_INFORMATION << 12) + head + data
