"""The words of CiA 402 as a control writes and reads them.

Source: CiA 402-2, finite state automaton and touch probe function (objects 6040, 6041, 60B8 to
60BD). A drive has its own reading of them; a test holds both to the tables.
"""

from collections import deque
from functools import cache

from axisrig.kernel.profiles.cia402.ds402 import (
    COMMANDS,
    PROBE_INPUT_BITS,
    STATES,
    TRANSITIONS,
    Command,
    ProbeFunction,
    ProbeStatus,
    State,
)

_COMMANDED = frozenset(row.source for row in TRANSITIONS if isinstance(row.event, Command))


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


@cache
def controlword_towards(state: State, target: State) -> int:
    """Return the controlword of the next step on the shortest way from `state` to `target`.

    At the target, and in a state that takes no command, it is the word that changes nothing.
    The way out of FAULT is the reset bit; it acts only when the word sent before had it at 0.
    Raises ValueError for a target that no command leads to.
    """
    if state is target or state not in _COMMANDED:
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
    """Return the bit of 60FD that shows the probe's input."""
    return 1 << PROBE_INPUT_BITS[probe]


_SHIFT = {1: 0, 2: 8}
_EDGE_BIT = {"POS": ProbeFunction.POSITIVE_1, "NEG": ProbeFunction.NEGATIVE_1}
_STORED_BIT = {"POS": ProbeStatus.POSITIVE_STORED_1, "NEG": ProbeStatus.NEGATIVE_STORED_1}
_SOURCE_BIT = {
    "input": ProbeFunction(0), "index": ProbeFunction.INDEX_1, "object": ProbeFunction.OBJECT_1
}  # fmt: skip
_LATCH_OBJECT = {(1, "POS"): 0x60BA, (1, "NEG"): 0x60BB, (2, "POS"): 0x60BC, (2, "NEG"): 0x60BD}
_COUNTER_OBJECT = {(1, "POS"): 0x60D5, (1, "NEG"): 0x60D6, (2, "POS"): 0x60D7, (2, "NEG"): 0x60D8}
