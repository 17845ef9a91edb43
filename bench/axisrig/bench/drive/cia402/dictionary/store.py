"""The object values of one device as SDO sees them: access rights, sizes, limits, owners.

What changes while the device runs is in the process image, the rest here. Source: CiA 301,
object dictionary and abort codes.
"""

from collections.abc import Callable, Collection, Iterable
from typing import Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.objects import Key, ObjectRow, ObjectTable

COMMUNICATION_LAST: Final = 0x1FFF
BYTES_MAX: Final = 1 << 16
"""A DOMAIN or text takes so many bytes."""


class Owner:
    """The part of a node that some objects belong to. The methods do nothing by themselves."""

    def check(self, index: int, sub: int, value: int) -> None:
        """Refuse a write that type and table allow; raises SdoAbortedError."""

    def written(self, index: int, sub: int, value: int) -> None:
        """Act on a value that SDO has written."""

    def read(self, index: int, sub: int) -> int | bytes | None:
        """Return the value of now; None = the one that is stored. Raises SdoAbortedError."""
        return None


class ObjectStore:
    """Values of a device with the objects of `table`. The node number may change: see `restore`.

    note_change: called with the row of every number that SDO has written.
    """

    def __init__(
        self,
        table: ObjectTable,
        image: DeviceImage,
        note_change: Callable[[ObjectRow], None],
    ) -> None:
        self._table, self._image = table, image
        self._rows, self._signed_values, self._indices = table.rows, table.signed, table.indices
        self._values: dict[Key, int | bytes] = {}
        self._owners: dict[int, Owner] = {}
        self._default_owner = Owner()
        self._note_change = note_change

    @property
    def rows(self) -> Iterable[ObjectRow]:
        """Every object of the device that has a value."""
        return [row for key, row in self._rows.items() if self._table.has(*key)]

    @property
    def indices(self) -> frozenset[int]:
        """The index of every object that has a value, or sub-indices."""
        return self._indices

    def own(self, owner: Owner, indices: Collection[int]) -> None:
        """Let `owner` answer for those of these objects that the device has."""
        few, many = sorted((self._indices, indices), key=len)
        for index in few:
            if index in many:
                self._owners[index] = owner

    def restore(self, node_id: int, first: int, last: int) -> None:
        """Give the objects `first` to `last` their defaults for node number `node_id`.

        What the application keeps in the process image it resets itself, and it alone decides what
        is read only there.
        """
        values = self._table.defaults(node_id)
        for key, row in self._rows.items():
            is_in_image = row.value and (row.index > COMMUNICATION_LAST or row.access == "ro")
            if first <= row.index <= last and not is_in_image:
                self._set(key, row, values[key])

    # For the node itself: no checks

    def holds(self, index: int, sub: int = 0) -> bool:
        """Return whether the table has such an object, for SDO to find or not."""
        return (index, sub) in self._rows

    def default(self, row: ObjectRow, node_id: int) -> int | bytes:
        """Return what an object has at power on with this node number."""
        return self._table.defaults(node_id)[row.key]

    def value(self, index: int, sub: int = 0) -> int:
        """Return a number; 0 where the table has no such object."""
        row = self._rows.get((index, sub))
        if row is None:
            return 0
        value = getattr(self._image, row.value) if row.value else self._values[index, sub]
        assert isinstance(value, int)
        return value

    def set_value(self, index: int, sub: int, value: int) -> None:
        """Change a value without a call of its owner."""
        self._set((index, sub), self._rows[index, sub], value)

    def _set(self, key: Key, row: ObjectRow, value: int | bytes) -> None:
        if row.value:
            setattr(self._image, row.value, value)
        else:
            self._values[key] = value

    # For the SDO server

    def upload(self, index: int, sub: int) -> bytes:
        """Return the bytes of an object; raises SdoAbortedError."""
        row = self.row(index, sub)
        if row.access == "wo":
            abort(AbortCode.WRITE_ONLY)
        value = self._owners.get(index, self._default_owner).read(index, sub)
        if value is None:
            value = getattr(self._image, row.value) if row.value else self._values[index, sub]
        if isinstance(value, bytes):
            return value
        return int(value).to_bytes(
            row.data_type.bits // 8, "little", signed=self._signed_values[index, sub]
        )

    def writable_size(self, index: int, sub: int) -> int | None:
        """Return how many bytes a write of this object has, None for any number of them.

        Raises SdoAbortedError.
        """
        row = self.row(index, sub)
        if row.access not in ("rw", "wo"):
            abort(AbortCode.READ_ONLY)
        return row.data_type.bits // 8 or None

    def download(self, index: int, sub: int, data: bytes) -> None:
        """Check bytes that a client writes, store them, let their owner act.

        Raises SdoAbortedError, with nothing changed.
        """
        size = self.writable_size(index, sub)
        row = self._rows[index, sub]
        if size is None:
            if len(data) > BYTES_MAX:
                abort(AbortCode.TOO_LONG)
            self._set((index, sub), row, data)
            return
        if len(data) != size:
            abort(AbortCode.TOO_LONG if len(data) > size else AbortCode.TOO_SHORT)
        value = int.from_bytes(data, "little", signed=self._signed_values[index, sub])
        self._check(row, value)
        owner = self._owners.get(index, self._default_owner)
        owner.check(index, sub, value)
        self._set((index, sub), row, value)
        owner.written(index, sub, value)
        self._note_change(row)

    def row(self, index: int, sub: int) -> ObjectRow:
        """Return the row of an object; raises SdoAbortedError where there is none."""
        row = self._rows.get((index, sub))
        if row is None or not self._table.has(index, sub):
            abort(AbortCode.NO_SUB_INDEX if index in self._indices else AbortCode.NO_OBJECT)
        return row

    def _check(self, row: ObjectRow, value: int) -> None:
        if row.low is not None and value < row.low:
            abort(AbortCode.TOO_LOW)
        if row.high is not None and value > row.high:
            abort(AbortCode.TOO_HIGH)
        if value not in row.allowed:
            abort(AbortCode.INVALID_VALUE)
