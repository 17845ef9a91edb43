"""Control word, status word and diagnosis of a SERCOS drive in each state, by hand.

Drive off stops the axis before the torque goes, enable off takes it at once, halt keeps it
(docs/sercos.md).
"""

from functools import partial
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest
from tests.sercos.test_sercos_faults_by_hand import Hand

from axisrig.bench.drive.cia402.functions.axis_states import AxisState
from axisrig.bench.drive.sercos.commands import Commands
from axisrig.bench.drive.sercos.front import Front, diagnoses
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import command_states, ident_number, pack_list

ON, ENABLE, RUN = 1 << 15, 1 << 14, 1 << 13
FAULTS = (State.FAULT, State.FAULT_REACTION_ACTIVE)
UP = {
    State.SWITCH_ON_DISABLED: 0x06,
    State.READY_TO_SWITCH_ON: 0x07,
    State.SWITCHED_ON: 0x0F,
    State.OPERATION_ENABLED: 0x0F,
    State.QUICK_STOP_ACTIVE: 0x02,
}
READY = {
    State.SWITCH_ON_DISABLED: 0b01,
    State.READY_TO_SWITCH_ON: 0b01,
    State.SWITCHED_ON: 0b10,
    State.OPERATION_ENABLED: 0b11,
    State.QUICK_STOP_ACTIVE: 0b11,
}


def _front(state: State, axis_state: AxisState = AxisState.OPERATING) -> Front:
    servo: Any = SimpleNamespace(state=state, axis_state=axis_state)
    return Front(servo)


def _wanted(state: State, word: int) -> int:
    if not word & ENABLE or state in FAULTS or state is State.NOT_READY_TO_SWITCH_ON:
        return 0x00
    if not word & ON:
        is_moving = state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
        return 0x02 if is_moving else 0x06
    is_halted = state is State.OPERATION_ENABLED and not word & RUN
    return UP[state] | (0x100 if is_halted else 0)


@pytest.mark.parametrize("state", State)
def test_each_control_word_in_each_state(state: State) -> None:
    front = _front(state)
    for on, enable, run in product((0, ON), (0, ENABLE), (0, RUN)):
        front.control = on | enable | run
        assert front.controlword() == _wanted(state, front.control)
        front.is_resetting = True
        reset = 0x80 if state is State.FAULT else _wanted(state, front.control)
        assert front.controlword() == reset
        front.is_resetting = False


@pytest.mark.parametrize("axis_state", [AxisState.OPERATING, AxisState.HALTED])
@pytest.mark.parametrize("state", State)
def test_each_state_in_the_status_word(state: State, axis_state: AxisState) -> None:
    """Bits 14 and 15 ready, 13 class 1, 5 a command has changed, 3 the drive follows."""
    front = _front(state, axis_state)
    word = READY.get(state, 0) << 14
    word |= 1 << 13 if state in FAULTS else 0
    follows = state is State.OPERATION_ENABLED and axis_state is AxisState.OPERATING
    word |= 1 << 3 if follows else 0
    assert front.status(command_changed=False) == word
    assert front.status(command_changed=True) == word | 1 << 5


@pytest.mark.parametrize("code", [*sorted(diagnoses()), 0x2310, 0xFF01])
def test_an_error_has_its_bit_while_the_servo_has_one(code: int) -> None:
    """What the table does not have is bit 15 and its own code; code 0 takes it away."""
    servo: Any = SimpleNamespace(state=State.FAULT, axis_state=AxisState.OFF)
    front = Front(servo)
    front.report(code)
    assert front.error is not None
    if code in diagnoses():
        assert front.error == diagnoses()[code]
    else:
        assert (front.error.bit, front.error.number) == (15, 0xF0000 | code)
    assert front.class_1() == 1 << front.error.bit
    front.report(0)  # another one has gone: the servo is in its fault still
    assert front.error is not None
    servo.state = State.SWITCH_ON_DISABLED
    assert front.class_1() == 0
    front.report(0)
    assert front.error is None
    front.control, front.is_resetting = 0xFFFF, True
    front.report(code)
    front.reset()
    assert (front.control, front.is_resetting, front.error) == (0, False, None)


def test_commands_change_when_they_have_ended_either_way_until_they_are_cancelled() -> None:
    """7 runs, 3 done, F failed; the end of one that does not run changes nothing."""
    states = command_states()
    table = {n: SimpleNamespace(state=states["IDLE"]) for n in (1, 2)}
    numbers, cancelled = {1: 3, 2: 3}, list[int]()
    idents: Any = SimpleNamespace(number=numbers.__getitem__, table=table)
    ends = {1: states["RUNNING"], 2: states["FAILED"]}
    runs = {ident: partial(ends.__getitem__, ident) for ident in ends}
    commands = Commands(idents, runs, cancelled.append)
    assert not commands.has_changed
    commands.end(1, states["DONE"])
    assert (table[1].state, commands.has_changed) == (states["IDLE"], False)
    commands.written(1)
    assert (table[1].state, commands.has_changed) == (states["RUNNING"], False)
    commands.written(2)
    assert (table[2].state, commands.has_changed) == (states["FAILED"], True)
    table[2].state = states["IDLE"]
    commands.end(1, states["DONE"])
    assert (table[1].state, commands.has_changed) == (states["DONE"], True)
    commands.end(1, states["FAILED"])
    assert table[1].state == states["DONE"]
    numbers[1] = 0
    commands.written(1)
    assert cancelled == [1]


@pytest.mark.parametrize("ident", ["S-0-0001", "S-0-0002"])
@pytest.mark.parametrize(
    ("us", "refused"),
    [(500, None), (1000, None), (2000, None), (4000, None), (1500, "INVALID"), (2500, "INVALID"),
     (750, "INVALID")],
)  # fmt: skip
def test_cycle_times_are_half_a_millisecond_or_whole_ones(
    ident: str, us: int, refused: str | None
) -> None:
    hand = Hand()
    hand.drive.states.state = AlState.PREOP  # phase 2
    assert hand.written(ident, us.to_bytes(2, "little")) == refused


def test_a_reset_that_is_done_clears_no_later_error() -> None:
    """S-0-0099 stays at 3 until the master cancels it; the next error needs another one."""
    hand = Hand()
    hand.cycle(ON | ENABLE | RUN, 8)
    hand.fault(0x2310)
    hand.cycle(0, 4)
    hand.written("S-0-0099", b"\x03\x00")
    hand.cycle(0, 4)
    assert (hand.state("S-0-0099"), hand.number("S-0-0011")) == ("DONE", 0)
    hand.cycle(ON | ENABLE | RUN, 8)
    assert hand.drive.state is State.OPERATION_ENABLED
    hand.fault(0x2310)
    assert hand.cycle(0, 8) & 1 << 13
    assert hand.drive.state.name == "FAULT"


@pytest.mark.parametrize("ident", ["S-0-0405", "S-0-0406"])
@pytest.mark.parametrize("allocation", ["S-0-0301", "S-0-0303"])
@pytest.mark.parametrize("profile", ["one_probe", "two_probes"])
def test_an_enable_that_a_real_time_bit_has_is_set_by_that_alone(
    profile: str, allocation: str, ident: str
) -> None:
    """Where the drive locks it: 1 is refused while either bit has it, 0 never is."""
    hand = Hand(profile=profile)
    one, zero = b"\x01\x00", b"\x00\x00"
    if ident == "S-0-0406" and profile == "one_probe":
        assert hand.written(ident, one) == "NO_IDENT"
        return
    assert hand.written(ident, one) is None
    hand.drive.idents.put(ident_number(allocation), ident_number(ident))
    assert hand.written(ident, one) == ("BY_OTHERS" if profile == "two_probes" else None)
    assert hand.written(ident, zero) is None
    hand.drive.idents.put(ident_number(allocation), 0)
    assert hand.written(ident, one) is None


@pytest.mark.parametrize(
    ("listed", "items", "wrong"),
    [
        ("S-0-0016", ["S-0-0051"], []),
        ("S-0-0016", [], []),
        ("S-0-0016", ["S-0-0051", "S-0-0051"], ["S-0-0016"]),
        ("S-0-0016", ["S-0-0047"], ["S-0-0047"]),  # of the MDT
        ("S-0-0016", ["S-0-0099"], ["S-0-0099"]),  # of none
        ("S-0-0024", ["S-0-0047", "S-0-0047"], ["S-0-0024"]),
        ("S-0-0024", ["S-0-0051", "S-0-0047"], ["S-0-0051"]),
        ("S-0-0024", ["S-0-0047", "S-0-0051", "S-0-0051"], ["S-0-0051", "S-0-0051", "S-0-0024"]),
    ],
)
def test_what_a_telegram_cannot_carry_is_named_in_s_0_0021(
    listed: str, items: list[str], wrong: list[str]
) -> None:
    """Each ident that is wrong, and the list that has one twice; phase 3 is refused then."""
    hand = Hand()
    hand.drive.states.state = AlState.PREOP
    numbers = [ident_number(item) for item in items]
    assert hand.written(listed, pack_list(numbers, 2, len(numbers))) is None
    hand.written("S-0-0127", b"\x03\x00")
    assert hand.state("S-0-0127") == ("FAILED" if wrong else "DONE")
    found = hand.drive.idents.items(ident_number("S-0-0021"))
    assert found == [ident_number(item) for item in wrong]
    if wrong:  # the AL status says which telegram it is
        side = "INPUT" if listed == "S-0-0016" else "OUTPUT"
        assert hand.drive._enter_safeop() == f"INVALID_{side}_MAPPING"


def test_another_type_of_telegram_is_a_matter_of_the_outputs() -> None:
    hand = Hand()
    hand.drive.idents.put(ident_number("S-0-0015"), 4)
    assert hand.drive.telegrams.wrong() == [ident_number("S-0-0015")]
    assert hand.drive._enter_safeop() == "INVALID_OUTPUT_MAPPING"


@pytest.mark.parametrize(("allocation", "mask"), [("S-0-0305", 1 << 6), ("S-0-0307", 1 << 7)])
def test_a_real_time_bit_of_the_status_is_bit_0_of_its_ident(allocation: str, mask: int) -> None:
    """Whatever the other bits of the ident are; without an ident it is 0."""
    hand, other = Hand(), 0xC0 & ~mask
    idents, ident = hand.drive.idents, ident_number("S-0-0092")
    assert not hand.cycle(0) & 0xC0
    idents.put(ident_number(allocation), ident)
    for value in (1, 2, 3, 0, 500, 501):
        hand.drive.servo.image.max_torque = value
        word = hand.cycle(0)
        assert (bool(word & mask), word & other) == (bool(value % 2), 0), value
    idents.put(ident_number(allocation), 0)
    assert not hand.cycle(0) & 0xC0


def test_a_reset_that_is_cancelled_leaves_the_error() -> None:
    """S-0-0099 is taken back while the axis brakes: the fault stands, and waits for another."""
    hand = Hand()
    hand.cycle(ON | ENABLE | RUN, 8)
    hand.fault(0x2310)
    assert hand.drive.state is State.FAULT_REACTION_ACTIVE
    hand.written("S-0-0099", b"\x03\x00")
    assert hand.state("S-0-0099") == "RUNNING"
    hand.written("S-0-0099", b"\x00\x00")
    hand.cycle(0, 20)
    assert hand.drive.state is State.FAULT
    hand.written("S-0-0099", b"\x03\x00")
    hand.cycle(0, 4)
    assert (hand.drive.state.name, hand.state("S-0-0099")) == ("SWITCH_ON_DISABLED", "DONE")
