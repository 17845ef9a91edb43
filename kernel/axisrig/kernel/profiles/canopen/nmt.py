"""States of network management as a heartbeat shows them. Source: CiA 301, network management."""

from typing import Final

BOOT_UP: Final = 0
STOPPED: Final = 4
OPERATIONAL: Final = 5
PRE_OPERATIONAL: Final = 127
