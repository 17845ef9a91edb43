"""The state machine of a slave: `al_transitions.csv`. Source: docs/ethercat.md."""

import csv
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from typing import Final, Protocol

from axisrig.kernel.profiles.ethercat.tables import AL_ERROR, AlState, al_status_codes

_STATE_MASK: Final = 0x0F
WAITS: Final = "WAITS"
"""Result of `enter`: the state is reached later, by `arrive`."""


@cache
def transitions() -> Mapping[tuple[AlState, AlState], str]:
    """Return what becomes of a request in a state: a state, or the name of an AL status code."""
    text = resources.files(__package__).joinpath("al_transitions.csv").read_text(encoding="utf-8")
    return {
        (AlState[row["present"]], AlState[row["requested"]]): row["result"]
        for row in csv.DictReader(text.splitlines())
    }


class Behaviour(Protocol):
    """What a slave does in its states."""

    def enter(self, state: AlState) -> str | None:
        """Go up one state: None done, WAITS, or the name of the AL status code that refuses."""
        ...

    def leave(self, before: AlState, after: AlState, code: str) -> None:
        """Go down. code: name of the AL status code of a fall, "" where the master wants it."""
        ...


class AlStateMachine:
    """State, error and what is under way. show(status, code): of the registers.

    observers: called with state and AL status code whenever the slave shows them.
    """

    def __init__(self, behaviour: Behaviour, show: Callable[[int, int], None]) -> None:
        self._behaviour, self._show = behaviour, show
        self.observers: list[Callable[[AlState, int], None]] = []
        self.state = AlState.INIT
        self.code = 0
        self.is_waiting = False

    def reset(self) -> None:
        """Be as after power on."""
        self.state, self.code, self.is_waiting = AlState.INIT, 0, False

    def control(self, value: int) -> None:
        """Take AL control. An error that is not acknowledged lets INIT through, and no more."""
        requested = value & _STATE_MASK
        if self.code and not value & AL_ERROR and requested != AlState.INIT:
            return
        self.code = 0
        self.is_waiting = False
        if requested not in AlState.__members__.values():
            self._refuse("UNKNOWN_STATE")
            return
        state = AlState(requested)
        result = transitions()[self.state, state]
        if result not in AlState.__members__:
            self._refuse(result)
        elif state is self.state:
            self._tell()
        elif state < self.state:
            self._go_down(state, "")
        else:
            self._go_up(state)

    def fall(self, state: AlState, code: str) -> None:
        """Leave the present state because of an error."""
        if state < self.state:
            self._go_down(state, code)

    def refuse(self, code: str) -> None:
        """End the wait for a state with an error."""
        self.is_waiting = False
        self._refuse(code)

    def arrive(self) -> None:
        """Reach the state that was waited for."""
        self.is_waiting = False
        self.state = AlState.OP
        self._tell()

    def _go_up(self, state: AlState) -> None:
        result = self._behaviour.enter(state)
        if result is None:
            self.state = state
            self._tell()
        elif result == WAITS:
            self.is_waiting = True
            self._tell()
        else:
            self._refuse(result)

    def _go_down(self, state: AlState, code: str) -> None:
        before, self.state = self.state, state
        self.is_waiting = False
        self._behaviour.leave(before, state, code)
        if code:
            self._refuse(code)
        else:
            self._tell()

    def _refuse(self, code: str) -> None:
        self.code = al_status_codes()[code]
        self._tell()

    def _tell(self) -> None:
        self._show(self.state | (AL_ERROR if self.code else 0), self.code)
        for observer in self.observers:
            observer(self.state, self.code)
