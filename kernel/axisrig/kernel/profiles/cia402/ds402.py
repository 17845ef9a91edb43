"""CiA 402 as master and slave share it: states, commands, transitions, touch probe bits.

The tables are `ds402_states.csv`, `ds402_commands.csv` and `ds402_transitions.csv`; the
transition numbers are those of the standard. Source: CiA 402-2, finite state automaton and touch
probe function (objects 6040, 6041, 60B8 to 60BD).
"""

import csv
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntFlag, auto
from functools import cache
from importlib import resources
from typing import Final, Literal

# Probe inputs are 1 and 2, edges are the words of P-AXIS-00518
EDGES: Final = ("POS", "NEG")


class State(Enum):
    """State of the power drive system; statusword patterns in `STATES`."""

    __hash__ = object.__hash__  # tables are asked in every cycle; that of Enum is in Python

    NOT_READY_TO_SWITCH_ON = auto()
    SWITCH_ON_DISABLED = auto()
    READY_TO_SWITCH_ON = auto()
    SWITCHED_ON = auto()
    OPERATION_ENABLED = auto()
    QUICK_STOP_ACTIVE = auto()
    FAULT_REACTION_ACTIVE = auto()
    FAULT = auto()


class Command(Enum):
    """Command of the controlword; bit patterns in `COMMANDS`."""

    SHUTDOWN = auto()
    SWITCH_ON = auto()
    ENABLE_OPERATION = auto()
    DISABLE_VOLTAGE = auto()
    QUICK_STOP = auto()
    FAULT_RESET = auto()


class Status(IntFlag):
    """Bits of the statusword 6041 beside those that give the state; bit 12 as the mode says."""

    VOLTAGE_ENABLED = 1 << 4
    WARNING = 1 << 7
    REMOTE = 1 << 9
    TARGET_REACHED = 1 << 10
    INTERNAL_LIMIT = 1 << 11
    FOLLOWS_COMMAND = 1 << 12
    SET_POINT_ACKNOWLEDGE = 1 << 12
    SPEED_ZERO = 1 << 12
    HOMING_ATTAINED = 1 << 12
    FOLLOWING_ERROR = 1 << 13
    HOMING_ERROR = 1 << 13


class ProbeFunction(IntFlag):
    """Bits of the touch probe function 60B8; without a source bit the probe input is used."""

    ENABLE_1 = 1 << 0
    CONTINUOUS_1 = 1 << 1
    INDEX_1 = 1 << 2
    OBJECT_1 = 1 << 3
    POSITIVE_1 = 1 << 4
    NEGATIVE_1 = 1 << 5
    ENABLE_2 = 1 << 8
    CONTINUOUS_2 = 1 << 9
    INDEX_2 = 1 << 10
    OBJECT_2 = 1 << 11
    POSITIVE_2 = 1 << 12
    NEGATIVE_2 = 1 << 13


class ProbeStatus(IntFlag):
    """Bits of the touch probe status 60B9."""

    ENABLED_1 = 1 << 0
    POSITIVE_STORED_1 = 1 << 1
    NEGATIVE_STORED_1 = 1 << 2
    ENABLED_2 = 1 << 8
    POSITIVE_STORED_2 = 1 << 9
    NEGATIVE_STORED_2 = 1 << 10


@dataclass(frozen=True)
class StatePattern:
    """A state in the statusword (`word & mask == value`) and the controlword that keeps it.

    power: what it means for the control, by the names of `drives.power.Power`.
    """

    mask: int
    value: int
    hold: int
    power: str


@dataclass(frozen=True)
class CommandPattern:
    """A command in the controlword (`word & mask == value`); `rising`: only when it was not so."""

    mask: int
    value: int
    rising: bool


@dataclass(frozen=True)
class Transition:
    """A row of `ds402_transitions.csv`.

    source: None means power on ("" in the table) and for any state ("*", number 13).
    event: a command, or "AUTOMATIC" or "ERROR". on_path: whether a master takes it by choice.
    """

    number: int
    source: State | None
    target: State
    event: Command | Literal["AUTOMATIC", "ERROR"]
    on_path: bool


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def _event(word: str) -> Command | Literal["AUTOMATIC", "ERROR"]:
    if word == "AUTOMATIC":
        return "AUTOMATIC"
    return "ERROR" if word == "ERROR" else Command[word]


STATES: Final[Mapping[State, StatePattern]] = {
    State[row["state"]]: StatePattern(
        int(row["mask"], 0), int(row["value"], 0), int(row["hold"], 0), row["power"]
    )
    for row in _rows("ds402_states.csv")
}
COMMANDS: Final[Mapping[Command, CommandPattern]] = {
    Command[row["command"]]: CommandPattern(
        int(row["mask"], 0), int(row["value"], 0), row["rising"] == "1"
    )
    for row in _rows("ds402_commands.csv")
}
TRANSITIONS: Final[tuple[Transition, ...]] = tuple(
    Transition(
        int(row["number"]),
        State[row["from"]] if row["from"] not in ("", "*") else None,
        State[row["to"]],
        _event(row["event"]),
        row["on_path"] == "1",
    )
    for row in _rows("ds402_transitions.csv")
)
_BY_COMMAND = {
    (row.source, row.event): row for row in TRANSITIONS if isinstance(row.event, Command)
}
_AUTOMATIC = {row.source: row for row in TRANSITIONS if row.event == "AUTOMATIC" and row.number}
_RELEVANT = 0x8F  # the bits of the controlword that any command looks at
_RESET = COMMANDS[Command.FAULT_RESET].mask


def state_of(statusword: int) -> State:
    """Return the state that a statusword reports.

    Raises ValueError when its bits fit no state.
    """
    state = find_state(statusword)
    if state is None:
        raise ValueError(f"statusword 0x{statusword:04X} fits no state")
    return state


@cache
def find_state(statusword: int) -> State | None:
    """Return the state that a statusword reports, None when its bits fit no state."""
    for state, pattern in STATES.items():
        if statusword & pattern.mask == pattern.value:
            return state
    return None


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


@cache
def controlword_towards(state: State, target: State) -> int:
    """Return the controlword of the next step on the shortest way from `state` to `target`.

    At the target, and in a state that takes no command, it is the word that changes nothing.
    The way out of FAULT is the reset bit; it acts only when the word sent before had it at 0.
    Raises ValueError for a target that no command leads to.
    """
    if state is target or not any(source is state for source, _ in _BY_COMMAND):
        return STATES[state].hold
    first: dict[State, int] = {}
    queue = deque([state])
    while queue:
        here = queue.popleft()
        for row in TRANSITIONS:
            if not row.on_path or row.source is not here or row.target in (state, *first):
                continue
            assert isinstance(row.event, Command)  # held by the table test
            first[row.target] = first.get(here, COMMANDS[row.event].value)
            queue.append(row.target)
    if target not in first:
        raise ValueError(f"no command leads from {state.name} to {target.name}")
    return first[target]


def probe_function(probe: int, edge: str, continuous: bool = False, source: str = "input") -> int:
    """Return the word for 60B8 that enables one edge ("POS", "NEG") of probe 1 or 2.

    source: "input" (that of the probe), "index" (pulse of the encoder), "object" (what 60D0 names).
    """
    bits = ProbeFunction.ENABLE_1 | _EDGE_BIT[edge] | _SOURCE_BIT[source]
    if continuous:
        bits |= ProbeFunction.CONTINUOUS_1
    return int(bits) << _SHIFT[probe]


def latch_object(probe: int, edge: str) -> int:
    """Return the index of the object that holds the latched position (60BA to 60BD)."""
    return _LATCH_OBJECT[probe, edge]


def counter_object(probe: int, edge: str) -> int:
    """Return the index of the object that counts the latches (60D5 to 60D8)."""
    return _COUNTER_OBJECT[probe, edge]


def enabled_bit(probe: int) -> int:
    """Return the bit of 60B9 that acknowledges the enabled probe."""
    return int(ProbeStatus.ENABLED_1) << _SHIFT[probe]


def stored_bit(probe: int, edge: str) -> int:
    """Return the bit of 60B9 that reports that the edge's position is stored."""
    return int(_STORED_BIT[edge]) << _SHIFT[probe]


def input_bit(probe: int) -> int:
    """Return the bit of 60FD that shows the probe's input.

    The standard leaves bits 16 to 31 to the manufacturer; ours are 16 and 17.
    """
    return {1: 1 << 16, 2: 1 << 17}[probe]


_SHIFT = {1: 0, 2: 8}
_EDGE_BIT = {"POS": ProbeFunction.POSITIVE_1, "NEG": ProbeFunction.NEGATIVE_1}
_STORED_BIT = {"POS": ProbeStatus.POSITIVE_STORED_1, "NEG": ProbeStatus.NEGATIVE_STORED_1}
_SOURCE_BIT = {
    "input": ProbeFunction(0), "index": ProbeFunction.INDEX_1, "object": ProbeFunction.OBJECT_1
}  # fmt: skip
_LATCH_OBJECT = {(1, "POS"): 0x60BA, (1, "NEG"): 0x60BB, (2, "POS"): 0x60BC, (2, "NEG"): 0x60BD}
_COUNTER_OBJECT = {(1, "POS"): 0x60D5, (1, "NEG"): 0x60D6, (2, "POS"): 0x60D7, (2, "NEG"): 0x60D8}
