"""What a variable of the program is made of: a type, sizes, values."""

from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass, field

from axisrig.kernel.nc.expressions import Value, whole_number

REAL = "REAL64"
STRING = "STRING"
# Type: smallest and largest value. A text and a floating-point number have none.
RANGES: Mapping[str, tuple[int, int]] = {
    "BOOLEAN": (0, 1),
    "SGN08": (-(2**7), 2**7 - 1),
    "UNS08": (0, 2**8 - 1),
    "SGN16": (-(2**15), 2**15 - 1),
    "UNS16": (0, 2**16 - 1),
    "SGN32": (-(2**31), 2**31 - 1),
    "UNS32": (0, 2**32 - 1),
}
KINDS = (*RANGES, "REAL32", REAL, STRING)


@dataclass
class Cell:
    """One variable, by index its values; a single value has the index ().

    kind: its type, None for what was assigned without #VAR and takes every value. sizes: of its
    dimensions, None without #VAR.
    """

    kind: str | None = None
    sizes: tuple[int, ...] | None = None
    values: dict[tuple[int, ...], Value] = field(default_factory=dict)


Store = MutableMapping[str, Cell]


def whole_index(value: float) -> int | None:
    """Return the index or size that a computed value means; None for what is no whole number."""
    index = whole_number(value)
    return None if index is None or index < 0 else index
