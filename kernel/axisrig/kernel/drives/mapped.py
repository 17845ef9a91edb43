"""What a cyclic telegram carries, value by value, whatever its words are; and its bytes."""

import struct
from dataclasses import dataclass


@dataclass(frozen=True)
class MappedObject:
    """One object of a PDO: index, sub-index, length in bits, field name of the link or ""."""

    index: int
    sub: int
    bits: int
    signed: bool
    field: str

    @property
    def entry(self) -> int:
        """The mapping entry as CiA 301 writes it: index << 16 | sub << 8 | bits."""
        return self.index << 16 | self.sub << 8 | self.bits


class BitCodec:
    """The codec of a PDO with lengths that no `struct` has: the first object has the lowest bits.

    Same calls as `struct.Struct`. Source: CiA 301 section 7.1, bit sequences are little endian.
    """

    def __init__(self, objects: tuple[MappedObject, ...]) -> None:
        starts = [sum(o.bits for o in objects[:n]) for n in range(len(objects))]
        self._fields = [(s, (1 << o.bits) - 1, o) for s, o in zip(starts, objects, strict=True)]
        self.size = -(-sum(o.bits for o in objects) // 8)

    def pack(self, *values: int) -> bytes:
        """Make the payload; raises struct.error for a value that does not fit."""
        whole = 0
        for (start, mask, mapped), value in zip(self._fields, values, strict=True):
            low = -(1 << mapped.bits - 1) if mapped.signed else 0
            if not low <= value <= low + mask:
                raise struct.error(f"{value} does not fit into {mapped.bits} bits")
            whole |= (value & mask) << start
        return whole.to_bytes(self.size, "little")

    def unpack(self, data: bytes | bytearray) -> tuple[int, ...]:
        """Take the payload apart; raises struct.error for another length."""
        if len(data) != self.size:
            raise struct.error(f"unpack requires a buffer of {self.size} bytes")
        whole, values = int.from_bytes(data, "little"), []
        for start, mask, mapped in self._fields:
            value = whole >> start & mask
            is_negative = mapped.signed and value >> mapped.bits - 1
            values.append(value - mask - 1 if is_negative else value)
        return tuple(values)
