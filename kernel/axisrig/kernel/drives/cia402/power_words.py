"""Power of a drive of CiA 402 by its states, and the controlwords that a request for it takes."""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.drives.cia402.words import controlword_towards
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.profiles.cia402.ds402 import COMMANDS, STATES, Command, State

RESET = COMMANDS[Command.FAULT_RESET].value
POWER: Final[Mapping[State, Power]] = {state: Power[of.power] for state, of in STATES.items()}
BEFORE_OPERATION: Final = (State.SWITCHED_ON, State.QUICK_STOP_ACTIVE)
"""From here the next command lets the drive follow set positions."""


def _word(request: PowerRequest, state: State) -> int:
    """Return the controlword for a request in a state; faults are left by a reset only."""
    if state in (State.FAULT, State.FAULT_REACTION_ACTIVE):
        return STATES[State.FAULT].hold
    if request is PowerRequest.STOP and state is State.OPERATION_ENABLED:
        return COMMANDS[Command.QUICK_STOP].value
    moves = state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
    if request in (PowerRequest.KEEP, PowerRequest.STOP):
        return STATES[state].hold if moves else 0
    if request is PowerRequest.RELEASE and not moves:
        return 0
    is_on = request is PowerRequest.ON
    return controlword_towards(
        state, State.OPERATION_ENABLED if is_on else State.READY_TO_SWITCH_ON
    )


WORDS: Final = {
    (request, state): _word(request, state) for request in PowerRequest for state in State
}
