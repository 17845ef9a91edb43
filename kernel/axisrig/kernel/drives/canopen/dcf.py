"""What a DCF wants written: the key ParameterValue, which configuration managers write at start-up.

Source: CiA 306-1 (DCF), CiA 302-2 (configuration manager). What the control itself sets stays its
own: communication objects, commands, mode, interpolation time.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from canopen.objectdictionary import ObjectDictionary, ODVariable, datatypes

from axisrig.kernel.drives.canopen.dictionary import encode

FIRST: Final = 0x2000
OF_THE_CONTROL: Final = (
    0x6040, 0x6060, 0x607A, 0x60FF, 0x6071, 0x60B0, 0x60B1, 0x60B2, 0x60B8, 0x60C2,
)  # fmt: skip
_FLOATS: Final = {datatypes.REAL32: "<f", datatypes.REAL64: "<d"}


@dataclass(frozen=True)
class DcfValue:
    """A value of a DCF: object, its name, and the bytes to write."""

    index: int
    sub: int
    name: str
    value: int | float | str | bytes
    data: bytes


def dcf_values(od: ObjectDictionary) -> Iterator[DcfValue]:
    """Yield what is to be written, in the order of the objects.

    Raises UserError for a value that type or limits do not take, or an object that is not written.
    """
    for found in variables_of(od):
        value = getattr(found, "value", None)
        is_ours = found.index < FIRST or found.index in OF_THE_CONTROL
        if value is None or is_ours or (not found.writable and value == found.default):
            continue
        yield DcfValue(found.index, found.subindex, found.name, value, _data(od, found, value))


def dcf_value(od: ObjectDictionary, index: int, sub: int) -> int | None:
    """Return a whole number that the DCF wants written, None where it has none for the object."""
    for found in dcf_values(od):
        if (found.index, found.sub) == (index, sub) and isinstance(found.value, int):
            return found.value
    return None


def variables_of(od: ObjectDictionary) -> Iterator[ODVariable]:
    """Yield every variable of a dictionary by index and sub-index."""
    for index in sorted(od):
        whole = od[index]
        if isinstance(whole, ODVariable):
            yield whole
        else:
            yield from (whole[sub] for sub in whole)


def _data(od: ObjectDictionary, found: ODVariable, value: float | str | bytes) -> bytes:
    if isinstance(value, bytes):
        return value
    if isinstance(value, str):
        return value.encode()
    if found.data_type in _FLOATS:
        return struct.pack(_FLOATS[found.data_type], value)
    return encode(od, found.index, found.subindex, int(value))
