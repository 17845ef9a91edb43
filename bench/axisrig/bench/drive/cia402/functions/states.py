"""Finite state automaton of the drive: which transition a controlword asks for, what follows it.

Source: CiA 402-2, finite state automaton; the option codes are in `option_codes.csv`.
"""

import csv
from collections.abc import Callable, Mapping
from enum import Enum, auto
from importlib import resources
from typing import Final, NamedTuple

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.transitions import automatic, transition
from axisrig.kernel.profiles.cia402.ds402 import State


class Reaction(Enum):
    """How an axis comes to rest."""

    COAST = auto()
    SLOW_DOWN = auto()
    QUICK_STOP = auto()
    CURRENT_LIMIT = auto()
    VOLTAGE_LIMIT = auto()


class Option(NamedTuple):
    """A row of `option_codes.csv`. then: the state once the axis is at standstill."""

    reaction: Reaction
    then: State


def _read() -> dict[tuple[int, int], Option]:
    text = resources.files(__package__).joinpath("option_codes.csv").read_text(encoding="utf-8")
    return {
        (int(row["object"], 16), int(row["code"])): Option(
            Reaction[row["reaction"]], State[row["then"]]
        )
        for row in csv.DictReader(text.splitlines())
    }


OPTIONS: Final[Mapping[tuple[int, int], Option]] = _read()
POWERED: Final = frozenset(
    {
        State.SWITCHED_ON,
        State.OPERATION_ENABLED,
        State.QUICK_STOP_ACTIVE,
        State.FAULT_REACTION_ACTIVE,
    }
)
BY_LIMIT: Final = frozenset({Reaction.CURRENT_LIMIT, Reaction.VOLTAGE_LIMIT})
DISABLE_OPERATION, SHUTDOWN, QUICK_STOP, CONTINUE = 5, 8, 11, 16  # numbers of transitions
_BRAKED = {DISABLE_OPERATION, SHUTDOWN}


class StateMachine:
    """The state and the transitions that wait for standstill.

    waiting: transition 5 or 8 whose ramp runs, None = none; the state is still OPERATION_ENABLED.
    option: of the quick stop or fault reaction that runs. on_change: called with each new state
    after the first.
    """

    def __init__(
        self, image: ProcessImage, on_change: Callable[[State], None] | None = None
    ) -> None:
        self._image, self._on_change = image, on_change
        self.state = automatic(State.NOT_READY_TO_SWITCH_ON)[0]
        self._forget()

    def _enter(self, state: State) -> None:
        if state is self.state:
            return
        self.state = state
        if self._on_change is not None:
            self._on_change(state)

    def reset(self) -> None:
        """Power on: transitions 0 and 1, from any state."""
        self._enter(State.NOT_READY_TO_SWITCH_ON)
        self._enter(automatic(State.NOT_READY_TO_SWITCH_ON)[0])
        self._forget()

    def _forget(self) -> None:
        self.waiting: int | None = None
        self.option = OPTIONS[0x605E, 0]
        self._controlword = 0

    def command(self) -> int | None:
        """Take the controlword; return the number of the transition that begins now, if any.

        Of two that follow each other (3 and 4 by one word) the last one is returned.
        A transition that brakes first stays `waiting` and is carried out by `arrive`; a
        controlword that asks for operation again calls it off, which is reported as transition 4.
        """
        word = self._image.controlword
        target, number = transition(self.state, word, self._controlword)
        self._controlword = word
        if number == CONTINUE and self.option.then is not State.QUICK_STOP_ACTIVE:
            return None
        if number is None:
            if self.waiting is not None and word & 0x8F == 0x0F:
                self.waiting = None
                return 4
            return None
        if number in _BRAKED and self.braking(number).reaction is not Reaction.COAST:
            if self.waiting is not None:
                self.waiting = number
                return None
            self.waiting = number
            return number
        self.waiting = None
        if number == QUICK_STOP:
            self.option = OPTIONS[0x605A, self._image.quick_stop_option]
        self._enter(target)
        return self._enable_at_once(word) or number

    def _enable_at_once(self, word: int) -> int | None:
        """Take transition 4 after 3 where one word asks for both."""
        if self.state is not State.SWITCHED_ON:
            return None
        target, number = transition(self.state, word, word)
        self._enter(target)
        return number

    def braking(self, number: int) -> Option:
        """Return how transition 5 or 8 brakes."""
        image = self._image
        if number == SHUTDOWN:
            return OPTIONS[0x605B, image.shutdown_option]
        return OPTIONS[0x605C, image.disable_option]

    def fault(self) -> Option:
        """Take transition 13; return the fault reaction."""
        self.waiting = None
        self._enter(State.FAULT_REACTION_ACTIVE)
        self.option = OPTIONS[0x605E, self._image.fault_option]
        return self.option

    def arrive(self) -> bool:
        """Take the transition that waited for standstill; return whether the torque goes off."""
        if self.waiting is not None:
            self._enter(self.braking(self.waiting).then)
            self.waiting = None
            return True
        if self.state in (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE):
            self._enter(self.option.then)  # transition 12 or 14, or none
            return self.state is not State.QUICK_STOP_ACTIVE
        return False
