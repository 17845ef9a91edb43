"""The tables of CiA 402 against a matrix written by hand and against canopen's own tables."""

import pytest
from canopen.profiles.p402 import State402

from axisrig.bench.drive.cia402.functions import transitions
from axisrig.kernel.drives.cia402 import words
from axisrig.kernel.profiles.cia402.ds402 import COMMANDS, STATES, TRANSITIONS, Command, State

# Transition number by state (row) and command (column); "." = the state stays
COLUMNS = ("SHUTDOWN", "SWITCH_ON", "ENABLE_OPERATION", "DISABLE_VOLTAGE", "QUICK_STOP",
           "FAULT_RESET")  # fmt: skip
MATRIX = {
    "NOT_READY_TO_SWITCH_ON": ". . . . . .",
    "SWITCH_ON_DISABLED": "2 . . . . .",
    "READY_TO_SWITCH_ON": ". 3 3 7 7 .",
    "SWITCHED_ON": "6 . 4 10 10 .",
    "OPERATION_ENABLED": "8 5 . 9 11 .",
    "QUICK_STOP_ACTIVE": ". . 16 12 . .",
    "FAULT_REACTION_ACTIVE": ". . . . . .",
    "FAULT": ". . . . . 15",
}
TARGETS = {2: "READY_TO_SWITCH_ON", 3: "SWITCHED_ON", 4: "OPERATION_ENABLED", 5: "SWITCHED_ON",
           6: "READY_TO_SWITCH_ON", 7: "SWITCH_ON_DISABLED", 8: "READY_TO_SWITCH_ON",
           9: "SWITCH_ON_DISABLED", 10: "SWITCH_ON_DISABLED", 11: "QUICK_STOP_ACTIVE",
           12: "SWITCH_ON_DISABLED", 15: "SWITCH_ON_DISABLED", 16: "OPERATION_ENABLED"}  # fmt: skip
# Words with bits that the command does not look at set and not set; halt and mode bits included
WORDS = {
    "SHUTDOWN": (0x0006, 0x000E, 0x0176),
    "SWITCH_ON": (0x0007, 0x0017, 0xFF07),
    "ENABLE_OPERATION": (0x000F, 0x011F),
    "DISABLE_VOLTAGE": (0x0000, 0x0005, 0x000D, 0x0070),
    "QUICK_STOP": (0x0002, 0x0003, 0x000B, 0x0102),
    "FAULT_RESET": (0x0080, 0x0086, 0x008F),
}
CASES = [
    (state, command, word, number)
    for state, row in MATRIX.items()
    for command, number in zip(COLUMNS, row.split(), strict=True)
    for word in WORDS[command]
]


@pytest.mark.parametrize(("state", "command", "word", "number"), CASES)
def test_every_command_in_every_state(state: str, command: str, word: int, number: str) -> None:
    expected = (State[state], None) if number == "." else (State[TARGETS[int(number)]], int(number))
    assert transitions.command_of(word, 0) is Command[command]
    assert transitions.transition(State[state], word, 0) == expected


def test_every_low_byte_is_one_command_at_most() -> None:
    for word in range(256):
        hits = [p for p in COMMANDS.values() if word & p.mask == p.value]
        assert len(hits) == 1, f"0x{word:02X}"


def test_fault_reset_needs_the_rising_edge() -> None:
    assert transitions.transition(State.FAULT, 0x80, 0x80) == (State.FAULT, None)
    assert transitions.transition(State.FAULT, 0x8F, 0x86) == (State.FAULT, None)
    assert transitions.transition(State.FAULT, 0x80, 0x0F) == (State.SWITCH_ON_DISABLED, 15)


def test_bit_7_held_high_is_no_command_in_any_state() -> None:
    for state in State:
        assert transitions.transition(state, 0x8F, 0x80) == (state, None)


def test_automatic_transitions() -> None:
    assert transitions.automatic(State.NOT_READY_TO_SWITCH_ON) == (State.SWITCH_ON_DISABLED, 1)
    assert transitions.automatic(State.QUICK_STOP_ACTIVE) == (State.SWITCH_ON_DISABLED, 12)
    assert transitions.automatic(State.FAULT_REACTION_ACTIVE) == (State.FAULT, 14)
    for state in (State.SWITCH_ON_DISABLED, State.OPERATION_ENABLED, State.FAULT):
        assert transitions.automatic(state) == (state, None)


def test_numbers_0_to_16_stand_in_the_table_without_gap() -> None:
    assert {row.number for row in TRANSITIONS} == set(range(17))


def test_masks_are_those_of_canopen() -> None:
    ours = {state.name.replace("_", " "): (p.mask, p.value) for state, p in STATES.items()}
    assert ours == State402.SW_MASK


def test_transitions_are_those_of_canopen() -> None:
    for (source, target), word in State402.TRANSITIONTABLE.items():
        if source in ("START", "NOT READY TO SWITCH ON", "FAULT REACTION ACTIVE"):
            continue
        state = State[source.replace(" ", "_")]
        assert transitions.transition(state, word, 0)[0].name == target.replace(" ", "_")


@pytest.mark.parametrize("upper", [0x0000, 0xB290, 0x1600])
def test_state_of_ignores_the_other_bits(upper: int) -> None:
    for state, pattern in STATES.items():
        assert words.state_of(pattern.value | upper & ~pattern.mask) is state


def test_no_two_states_share_a_statusword_and_misfits_raise() -> None:
    for word in range(128):
        hits = [s for s, p in STATES.items() if word & p.mask == p.value]
        assert len(hits) <= 1
        if not hits:
            with pytest.raises(ValueError, match="fits no state"):
                words.state_of(word)


def test_way_to_operation_enabled_from_everywhere() -> None:
    """The words 06, 07, 0F and for a fault 80 before them; a quick stop ends by 00."""
    ways = {
        State.SWITCH_ON_DISABLED: [0x06, 0x07, 0x0F],
        State.READY_TO_SWITCH_ON: [0x07, 0x0F],
        State.SWITCHED_ON: [0x0F],
        State.OPERATION_ENABLED: [],
        State.QUICK_STOP_ACTIVE: [0x00, 0x06, 0x07, 0x0F],
        State.FAULT: [0x80, 0x06, 0x07, 0x0F],
    }
    for start, wanted in ways.items():
        state, previous, sent = start, 0, []
        while state is not State.OPERATION_ENABLED:
            word = words.controlword_towards(state, State.OPERATION_ENABLED)
            state, _ = transitions.transition(state, word, previous)
            previous = word
            sent.append(word)
        assert sent == wanted


def test_controlword_at_the_target_keeps_the_state() -> None:
    for state in State:
        word = words.controlword_towards(state, state)
        assert transitions.transition(state, word, 0x80) == (state, None)


def test_states_without_commands_are_waited_for() -> None:
    for state in (State.NOT_READY_TO_SWITCH_ON, State.FAULT_REACTION_ACTIVE):
        assert words.controlword_towards(state, State.OPERATION_ENABLED) == 0


def test_a_fault_cannot_be_commanded() -> None:
    with pytest.raises(ValueError, match="no command leads from OPERATION_ENABLED to FAULT"):
        words.controlword_towards(State.OPERATION_ENABLED, State.FAULT)


def test_touch_probe_words_against_the_bit_table() -> None:
    """Words by hand: 0x11 is what a script of a real master writes for probe 1, positive edge."""
    assert words.probe_function(1, "POS") == 0x0011
    assert words.probe_function(1, "NEG") == 0x0021
    assert words.probe_function(2, "POS") == 0x1100
    assert words.probe_function(2, "NEG", continuous=True) == 0x2300
    assert words.probe_function(1, "POS", source="index") == 0x0015
    assert words.probe_function(2, "NEG", source="object") == 0x2900


def test_touch_probe_objects_and_status_bits() -> None:
    assert [words.latch_object(p, e) for p in (1, 2) for e in ("POS", "NEG")] == [
        0x60BA, 0x60BB, 0x60BC, 0x60BD]  # fmt: skip
    assert [words.counter_object(p, e) for p in (1, 2) for e in ("POS", "NEG")] == [
        0x60D5, 0x60D6, 0x60D7, 0x60D8]  # fmt: skip
    assert [words.stored_bit(p, e) for p in (1, 2) for e in ("POS", "NEG")] == [
        1 << 1, 1 << 2, 1 << 9, 1 << 10]  # fmt: skip
    assert [words.enabled_bit(p) for p in (1, 2)] == [1 << 0, 1 << 8]
    assert [words.input_bit(p) for p in (1, 2)] == [1 << 16, 1 << 17]
