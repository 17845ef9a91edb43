"""Words of an AX2000 on Lightbus, and its image (`image.csv`).

Bit 20 of DRVSTAT and the variables are those of its ASCII object reference; that they are in the
image, and how one is read there, is inferred (docs/lightbus.md).
"""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.profiles.speed_drive.words import image_of

LATCHED: Final[Mapping[str, int]] = {"POS": 1 << 20, "NEG": 1 << 21}
"""DRVSTAT: a position is latched and not read."""
READ: Final[Mapping[str, int]] = {"POS": 1 << 0, "NEG": 1 << 1}
"""READ and SHOWN."""
VALUE: Final[Mapping[str, str]] = {"POS": "LATCH_P", "NEG": "LATCH_N"}
TURN_BITS: Final = 20
LATCH16_BITS: Final = 16
UM_PER_MM: Final = 1000
"""LATCH32 counts micrometres."""
IN2MODE_LATCH: Final = 26
"""IN2MODE: input 2 latches (FCT-C4 6.2)."""
TO_DRIVE: Final = image_of(__package__ or "", "out")
FROM_DRIVE: Final = image_of(__package__ or "", "in")
