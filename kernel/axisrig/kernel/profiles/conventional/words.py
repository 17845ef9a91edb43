"""Registers of a card in the control for a conventional drive (`image.csv`).

No manual describes one: an analogue output, a counter and a latch for each edge of the probing
input are what any has (docs/conventional.md).
"""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.profiles.speed_drive.words import image_of

ENABLE: Final[Mapping[str, int]] = {"POS": 1 << 0, "NEG": 1 << 1}
"""ENABLE, and the valid bits of STATUS."""
VALUE: Final[Mapping[str, str]] = {"POS": "LATCH_P", "NEG": "LATCH_N"}
LEVEL: Final = 1 << 2
TO_CARD: Final = image_of(__package__ or "", "out")
FROM_CARD: Final = image_of(__package__ or "", "in")
