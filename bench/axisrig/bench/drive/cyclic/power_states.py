"""States of a drive with one image a cycle, by those of the servo behind it."""

from enum import Enum, auto
from typing import Final

from axisrig.kernel.profiles.cia402.ds402 import State


class PowerState(Enum):
    """State of the drive: S1 to S5 of PROFIdrive, and a fault."""

    __hash__ = object.__hash__

    INHIBITED = auto()
    READY = auto()
    ON = auto()
    OPERATION = auto()
    STOPPING = auto()
    FAULT = auto()


STATE_OF: Final = {
    State.NOT_READY_TO_SWITCH_ON: PowerState.INHIBITED,
    State.SWITCH_ON_DISABLED: PowerState.INHIBITED,
    State.READY_TO_SWITCH_ON: PowerState.READY,
    State.SWITCHED_ON: PowerState.ON,
    State.OPERATION_ENABLED: PowerState.OPERATION,
    State.QUICK_STOP_ACTIVE: PowerState.STOPPING,
    State.FAULT_REACTION_ACTIVE: PowerState.FAULT,
    State.FAULT: PowerState.FAULT,
}
