"""PDO assignment and mapping of a drive on EtherCAT, and what its SyncManagers carry.

Source: docs/ethercat.md; CiA 301 for mappings. They change in PREOP only: number to 0, entries,
number; those of a drive with `fixed_pdos` never. A write of the value that is there changes nothing
and is allowed always.
"""

import struct
from collections.abc import Callable
from typing import ClassVar, Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage, ProcessImage
from axisrig.bench.drive.cia402.dictionary.mapping import Layout, check_entry, read_layout
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.bench.drive.ethercat.objects import (
    MAPPINGS,
    RX_ASSIGNMENT,
    RXPDOS,
    TX_ASSIGNMENT,
)

BYTES_MAX: Final = 256
"""What fits between the SyncManagers with three buffers."""
ASSIGNMENTS: Final = (RX_ASSIGNMENT, TX_ASSIGNMENT)
_NOTHING: Final = Layout((), struct.Struct("<"))


class Exchanged(Owner):
    """Outputs and inputs of one drive. outputs, inputs: what they carry since `compile`."""

    objects: ClassVar[frozenset[int]] = frozenset()

    def __init__(self) -> None:
        self.outputs = self.inputs = _NOTHING

    def compile(self) -> frozenset[str]:
        """Read what they carry; return the values of the process image that the inputs have."""
        raise NotImplementedError

    def take(self, image: ProcessImage, data: bytes) -> None:
        """Take the outputs of a cycle."""
        raise NotImplementedError

    def message(self, image: ProcessImage) -> bytes:
        """Return the inputs as they are now."""
        raise NotImplementedError


class ProcessData(Exchanged):
    """Those of a drive of CiA 402, as PDOs.

    is_fixed: mapping and assignment are those of power on. may_change(): whether the state allows
    another one.
    """

    objects: ClassVar[frozenset[int]] = frozenset((*MAPPINGS, *ASSIGNMENTS))

    def __init__(
        self, store: ObjectStore, may_change: Callable[[], bool], *, is_fixed: bool = False
    ) -> None:
        super().__init__()
        self._store, self._may_change, self._is_fixed = store, may_change, is_fixed
        self._message: Callable[[DeviceImage], bytes] = _nothing

    def compile(self) -> frozenset[str]:
        """Read assignment and mapping; return the values that the inputs carry."""
        self.outputs = self._layout(RX_ASSIGNMENT)
        self.inputs = self._layout(TX_ASSIGNMENT)
        self._message = self.inputs.reader() if self.inputs.fields else _nothing
        return frozenset(self.inputs.fields)

    def take(self, image: ProcessImage, data: bytes) -> None:
        """Take the outputs of a cycle."""
        self.outputs.store(image, data)

    def message(self, image: ProcessImage) -> bytes:
        """Return the inputs as they are in the image now."""
        return self._message(image)

    def check(self, index: int, sub: int, value: int) -> None:
        """Keep the rules of the change of a mapping."""
        store = self._store
        if value == store.value(index, sub):
            return
        if self._is_fixed:
            abort(AbortCode.READ_ONLY)
        if not self._may_change():
            abort(AbortCode.DEVICE_STATE)
        if sub and store.value(index):
            abort(AbortCode.UNSUPPORTED_ACCESS)
        if sub:
            self._check_entry(index, value)
            return
        entries = [store.value(index, number) for number in range(1, value + 1)]
        for entry in entries:
            if not entry:
                abort(AbortCode.NOT_MAPPABLE)
            self._check_entry(index, entry)
        if index in ASSIGNMENTS and len(set(entries)) != len(entries):
            abort(AbortCode.INCOMPATIBLE)

    def _check_entry(self, index: int, entry: int) -> None:
        if entry and index in MAPPINGS:
            check_entry(entry, "rx" if index in RXPDOS else "tx", self._store)

    def _layout(self, assignment: int) -> Layout:
        store = self._store
        number = store.value(assignment)
        parts = [read_layout(store.value(assignment, sub), store) for sub in range(1, number + 1)]
        formats = "".join(part.codec.format.removeprefix("<") for part in parts)
        fields = tuple(field for part in parts for field in part.fields)
        return Layout(fields, struct.Struct(f"<{formats}"))


def _nothing(_image: DeviceImage) -> bytes:
    return b""
