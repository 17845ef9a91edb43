"""Network management: states as a heartbeat shows them, and commands of the master.

Source: CiA 301, network management.
"""

from typing import Final

BOOT_UP: Final = 0
STOPPED: Final = 4
OPERATIONAL: Final = 5
PRE_OPERATIONAL: Final = 127

# Commands
START: Final = 1
STOP: Final = 2
ENTER_PRE_OPERATIONAL: Final = 128
RESET_NODE: Final = 129
RESET_COMMUNICATION: Final = 130
