"""Access to objects over the mailbox: single values, and objects as a whole (complete access).

Source: docs/ethercat.md. As a whole, sub-index 0 takes two bytes, the second of which is 0; the
others follow in their order, byte by byte.
"""

from collections.abc import Mapping
from typing import Final

from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.bench.drive.ethercat.objects import Described

_COUNT_BYTES: Final = 2
_VARIABLE: Final = 7


class ObjectAccess:
    """The objects of one device: their values, and what they are."""

    def __init__(self, store: ObjectStore, known: Mapping[int, Described]) -> None:
        self._store, self._known = store, known

    def upload(self, index: int, sub: int, *, complete: bool) -> bytes:
        """Return the bytes of an object; raises SdoAbortedError."""
        if not complete:
            return self._store.upload(index, sub)
        described = self._whole(index, sub)
        parts = [self._store.upload(index, number) for number in self._members(described)]
        body = b"".join(parts)
        if sub == 0:
            return self._store.upload(index, 0).ljust(_COUNT_BYTES, b"\x00") + body
        return body

    def writable_size(self, index: int, sub: int) -> int:
        """Return how many bytes a write of this value has; raises SdoAbortedError."""
        return self._store.writable_size(index, sub) or 0

    def check_size(self, index: int, sub: int, size: int, *, complete: bool) -> None:
        """Refuse a write of this size at once; raises SdoAbortedError."""
        if complete:
            described = self._whole(index, sub)
            most = sum(row.data_type.bits // 8 for n, row in described.rows.items() if n)
            if size > most + (_COUNT_BYTES if sub == 0 else 0):
                abort(AbortCode.TOO_LONG)
            return
        right = self.writable_size(index, sub)
        if size != right:
            abort(AbortCode.TOO_LONG if size > right else AbortCode.TOO_SHORT)

    def download(self, index: int, sub: int, data: bytes, *, complete: bool) -> None:
        """Write an object; raises SdoAbortedError."""
        if not complete:
            self._store.download(index, sub, data)
            return
        described = self._whole(index, sub)
        self.check_size(index, sub, len(data), complete=True)
        count: int | None = None
        if sub == 0:
            if not data:
                abort(AbortCode.TOO_SHORT)
            count, data = data[0], data[_COUNT_BYTES:]
        if described.rows[0].access == "rw":
            self._write_list(described, count, data)
            return
        if count is not None and count != self._store.value(index, 0):
            abort(AbortCode.INVALID_VALUE)
        self._write_members(described, data)

    def _write_list(self, described: Described, count: int | None, data: bytes) -> None:
        """Write a list whose number of entries counts: none, the entries, then their number."""
        index, store = described.index, self._store
        before = {number: store.value(index, number) for number in described.rows}
        number = before[0] if count is None else count
        try:
            store.download(index, 0, b"\x00")
            self._write_members(described, data)
            store.download(index, 0, bytes((number,)))
        except SdoAbortedError:
            for place, value in before.items():
                store.set_value(index, place, value)
            raise

    def _write_members(self, described: Described, data: bytes) -> None:
        for number, row in described.rows.items():
            if not number or not data:
                continue
            size = row.data_type.bits // 8
            self._store.download(described.index, number, data[:size])
            data = data[size:]

    def _whole(self, index: int, sub: int) -> Described:
        described = self._known.get(index)
        if described is None:
            abort(AbortCode.NO_OBJECT)
        if sub > 1:
            abort(AbortCode.NO_SUB_INDEX)
        if described.code == _VARIABLE:
            abort(AbortCode.COMPLETE_ACCESS)
        return described

    @staticmethod
    def _members(described: Described) -> list[int]:
        return [number for number in described.rows if number]
