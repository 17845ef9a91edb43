"""Control and status byte of an incremental encoder terminal, and its image (`image.csv`).

Bits are those of siblings of KL5101: IP/IE5109 (control), EL5101 (status); docs/encoder-terminal.md
has what is inferred.
"""

from typing import Final

from axisrig.kernel.profiles.speed_drive.words import image_of

# Control byte
EN_LAT_EXT: Final = 1 << 1
CNT_SET: Final = 1 << 2
# Status byte
LATC_VAL: Final = 1 << 0
"""Valid bit of the latch at the zero pulse, which is not used here."""
LAT_EXT_VAL: Final = 1 << 1
CNTSET_ACC: Final = 1 << 2
LEVEL: Final = 1 << 5
BITS: Final = 16
"""Of counter and latch."""
COUNTS: Final = 1 << BITS
TO_TERMINAL: Final = image_of(__package__ or "", "out")
FROM_TERMINAL: Final = image_of(__package__ or "", "in")
