"""What a PDO carries: its mapping in the object dictionary, compiled to a codec.

Source: CiA 301, PDO mapping parameters 1600h and 1A00h; a mapping is the same on every carrier.
"""

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from operator import attrgetter

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.objects import DUMMIES, Key
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore


@dataclass(frozen=True)
class Layout:
    """What a PDO carries: fields of the process image and the codec of their values.

    memory: objects of the maker by their place among the fields, whose names are empty there; they
    are memory of `objects`.
    """

    fields: tuple[str, ...]
    codec: struct.Struct
    memory: Mapping[int, Key] = field(default_factory=dict)
    objects: ObjectStore | None = None

    def store(self, image: DeviceImage, data: bytes) -> None:
        """Write the values of a message into the image; data after the mapping is ignored."""
        if self.objects is not None and self.memory:
            self._store_all(self.objects, image, data)
            return
        for name, value in zip(self.fields, self.codec.unpack_from(data), strict=True):
            setattr(image, name, value)

    def _store_all(self, objects: ObjectStore, image: DeviceImage, data: bytes) -> None:
        for place, value in enumerate(self.codec.unpack_from(data)):
            if place in self.memory:
                objects.set_value(*self.memory[place], value)
            else:
                setattr(image, self.fields[place], value)

    def reader(self) -> Callable[[DeviceImage], bytes]:
        """Return the function that makes the message from the image."""
        pack, fields = self.codec.pack, self.fields
        if self.objects is not None and self.memory:
            return partial(self._with_memory, self.objects)
        if len(fields) == 1:
            value_of = attrgetter(*fields)
            return lambda image: pack(value_of(image))
        values_of = attrgetter(*fields)
        return lambda image: pack(*values_of(image))

    def _with_memory(self, objects: ObjectStore, image: DeviceImage) -> bytes:
        values = [
            objects.value(*self.memory[place]) if place in self.memory else getattr(image, name)
            for place, name in enumerate(self.fields)
        ]
        return self.codec.pack(*values)


def read_layout(mapping: int, store: ObjectStore) -> Layout:
    """Compile the mapping parameter `mapping`; its entries are valid (`check_entry`)."""
    formats, fields, memory = "<", list[str](), dict[int, Key]()
    for sub in range(1, store.value(mapping) + 1):
        index, sub_index, bits = parts_of(store.value(mapping, sub))
        if index in DUMMIES:
            formats += f"{bits // 8}x"
        else:
            row = store.row(index, sub_index)
            formats += row.data_type.format
            if not row.value:
                memory[len(fields)] = row.key
            fields.append(row.value)
    return Layout(tuple(fields), struct.Struct(formats), memory, store)


def check_entry(entry: int, direction: str, store: ObjectStore) -> None:
    """Refuse an entry that a PDO cannot carry. direction: rx or tx. Raises SdoAbortedError."""
    index, sub, bits = parts_of(entry)
    if 1 <= index <= 7:
        if direction != "rx" or sub or DUMMIES.get(index) != bits:
            abort(AbortCode.NOT_MAPPABLE)
        return
    row = store.row(index, sub)
    # Whole objects only, so every entry starts at a byte
    if direction not in row.pdo.split() or bits != row.data_type.bits:
        abort(AbortCode.NOT_MAPPABLE)


def parts_of(entry: int) -> tuple[int, int, int]:
    """Return index, sub-index and bits of an entry of a mapping."""
    return entry >> 16, entry >> 8 & 0xFF, entry & 0xFF
