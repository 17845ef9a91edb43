"""Words of a drive that only takes a speed, and the tables of the images that carry them.

Of such a drive there is no manual: an enable, a reset and three states are what any has. What is
beside them in an image is of the family whose `image.csv` it is. Images are little-endian.
"""

import csv
from dataclasses import dataclass
from importlib import resources
from struct import Struct
from typing import Final

# DRIVE, to the drive
ENABLE: Final = 1 << 0
RESET: Final = 1 << 1
# DRIVE, from the drive
READY: Final = 1 << 0
"""It has power: its other bits count."""
OPERATES: Final = 1 << 1
FAULT: Final = 1 << 2
OUTPUT_MAX: Final = (1 << 15) - 1
"""SPEED at 10 V."""


@dataclass(frozen=True)
class Image:
    """One direction of an image. names: of its values in their order."""

    names: tuple[str, ...]
    codec: Struct

    def values_of(self, data: bytes) -> dict[str, int]:
        """Return the values of an image by their names."""
        return dict(zip(self.names, self.codec.unpack(data), strict=True))

    def packed(self, values: dict[str, int]) -> bytes:
        """Return the image of values; what is not named is 0."""
        return self.codec.pack(*(values.get(name, 0) for name in self.names))


def image_of(package: str, direction: str) -> Image:
    """Return the image of a family. package: has its `image.csv`. direction: out or in."""
    text = resources.files(package).joinpath("image.csv").read_text(encoding="utf-8")
    rows = [row for row in csv.DictReader(text.splitlines()) if row["direction"] == direction]
    return Image(
        tuple(row["name"] for row in rows), Struct("<" + "".join(row["format"] for row in rows))
    )


def signed(value: int, bits: int) -> int:
    """Return a difference of two counters of so many bits with the wrap taken out."""
    half = 1 << bits - 1
    return (value + half & (1 << bits) - 1) - half
