"""Which transition a controlword asks of a drive, and which it takes by itself.

Source: CiA 402-2, finite state automaton; a control has its own reading of the words, a test holds
both to the tables.
"""

from functools import cache
from typing import Final

from axisrig.kernel.profiles.cia402.ds402 import COMMANDS, TRANSITIONS, Command, State

_BY_COMMAND = {
    (row.source, row.event): row for row in TRANSITIONS if isinstance(row.event, Command)
}
_AUTOMATIC = {row.source: row for row in TRANSITIONS if row.event == "AUTOMATIC" and row.number}
_RELEVANT: Final = 0x8F  # the bits of the controlword that any command looks at
_RESET = COMMANDS[Command.FAULT_RESET].mask


def command_of(controlword: int, previous_controlword: int) -> Command | None:
    """Return the command of a controlword, None for bit 7 held high."""
    for command, pattern in COMMANDS.items():
        if controlword & pattern.mask == pattern.value and not (
            pattern.rising and previous_controlword & pattern.mask == pattern.value
        ):
            return command
    return None


@cache
def _step(state: State, controlword: int, previous_reset: int) -> tuple[State, int | None]:
    command = command_of(controlword, previous_reset)
    row = _BY_COMMAND.get((state, command)) if command else None
    return (row.target, row.number) if row else (state, None)


def transition(
    state: State, controlword: int, previous_controlword: int
) -> tuple[State, int | None]:
    """Return the state after a controlword and the number of the transition, None for none."""
    return _step(state, controlword & _RELEVANT, previous_controlword & _RESET)


def automatic(state: State) -> tuple[State, int | None]:
    """Return where a drive goes from `state` without a command (transitions 1, 12, 14)."""
    row = _AUTOMATIC.get(state)
    return (row.target, row.number) if row else (state, None)
