"""NMT states and commands of a slave (CiA 301, network management)."""

from collections.abc import Mapping
from enum import IntEnum
from types import MappingProxyType
from typing import Final

from axisrig.kernel.profiles.canopen import nmt


class NmtState(IntEnum):
    """State of a slave; the number is what its heartbeat says."""

    INITIALISING = nmt.BOOT_UP
    STOPPED = nmt.STOPPED
    OPERATIONAL = nmt.OPERATIONAL
    PRE_OPERATIONAL = nmt.PRE_OPERATIONAL


EVERY_NODE: Final = 0
COMMANDS: Final[Mapping[int, NmtState]] = MappingProxyType(
    {
        nmt.START: NmtState.OPERATIONAL,
        nmt.STOP: NmtState.STOPPED,
        nmt.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
    }
)
ERROR_BEHAVIOUR: Final = (0x1029, 1)


def after_communication_error(state: NmtState, behaviour: int) -> NmtState:
    """Return the state that 1029:1 asks for: 0 pre-operational, 1 as it was, 2 stopped.

    Only a node in operational goes to pre-operational.
    """
    if behaviour == 2:
        return NmtState.STOPPED
    if behaviour == 0 and state is NmtState.OPERATIONAL:
        return NmtState.PRE_OPERATIONAL
    return state
