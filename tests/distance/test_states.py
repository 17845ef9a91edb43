"""Every state and command, from the program and from the PLC."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, Source, changes
from axisrig.kernel.errors import Alarm

State, Command = DistanceState, DistanceCommand
PAIRS = [(state, command) for state in State for command in Command]

# What FCT-M3 8.1 and the pages about it say, written once more: the state behind a command, or the
# IDs with which a program's command is refused; a PLC's is refused with 310014
STAYS = 0
EXPECTED: dict[State, tuple[object, object, object, object]] = {
    # OFF, ON, FREEZE, ON_CONST_DIST
    State.INACTIVE: (STAYS, State.ACTIVE, (900310, 900310), State.ACTIVE_CONST_DIST),
    State.ACTIVE: (State.TURNING_OFF, STAYS, State.FREEZE, (70440, 310025)),
    State.FREEZE: (State.TURNING_OFF, State.ACTIVE, STAYS, State.ACTIVE_CONST_DIST),
    State.TURNING_OFF: (STAYS, (70334, 70334), (900310, 900310), (70334, 70334)),
    State.ACTIVE_CONST_DIST: (State.TURNING_OFF, (70440, 310025), State.FREEZE, STAYS),
    State.ERROR: (State.TURNING_OFF, (900310, 900310), (900310, 900310), (900310, 900310)),
}


def test_the_table_has_a_row_for_each_pair() -> None:
    assert sorted(changes()) == sorted(PAIRS)


def test_numbers_are_those_of_the_interface() -> None:
    assert [state.name for state in State] == [
        "INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "ACTIVE_CONST_DIST", "ERROR",
    ]  # fmt: skip
    assert [int(state) for state in State] == [0, 1, 2, 3, 4, 5]
    assert [(c.name, int(c)) for c in Command] == [
        ("OFF", 0), ("ON", 1), ("FREEZE", 2), ("ON_CONST_DIST", 3),
    ]  # fmt: skip


@pytest.mark.parametrize("is_newer", [False, True], ids=["older IDs", "newer IDs"])
@pytest.mark.parametrize("source", Source)
@pytest.mark.parametrize(("state", "command"), PAIRS)
def test_every_command_in_every_state(
    make_loop: Callable[..., Any],
    state: State,
    command: Command,
    source: Source,
    is_newer: bool,
) -> None:
    control = make_loop(lambda _k: 0.001, is_newer=is_newer).lead_to(state).control
    expected = EXPECTED[state][command]
    before_mm = control.offset_mm
    if isinstance(expected, tuple):
        alarm_id = 310014 if source is Source.PLC else expected[is_newer]
        with pytest.raises(Alarm) as caught:
            control.command(command, source)
        assert (caught.value.id, caught.value.entry.reaction_class) == (alarm_id, 7)
        assert control.state is state
        assert control.source is Source.NC
    else:
        control.command(command, source)
        assert control.state is (state if expected == STAYS else expected)
        assert control.source is source
    assert control.offset_mm == before_mm


@pytest.mark.provokes(310014, 7, owner="axis Z", current="ERROR", wanted="ON")
def test_the_plc_is_refused_with_310014(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="310014"):
        make_loop().lead_to(State.ERROR).say(Command.ON, source=Source.PLC)


@pytest.mark.provokes(900310, 7, owner="axis Z", current="INACTIVE", wanted="FREEZE")
def test_the_program_is_refused_what_does_not_exist(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="900310"):
        make_loop().say(Command.FREEZE)


@pytest.mark.provokes(70440, 7, owner="axis Z", current="ACTIVE", programmed="ON_CONST_DIST")
def test_the_mode_does_not_change_while_on(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="70440"):
        make_loop().lead_to(State.ACTIVE).say(Command.ON_CONST_DIST)


@pytest.mark.provokes(310025, 7, owner="axis Z", current="ACTIVE_CONST_DIST", programmed="ON")
def test_the_newer_family_has_its_own_id_for_it(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="310025"):
        make_loop(is_newer=True).lead_to(State.ACTIVE_CONST_DIST).say(Command.ON)


@pytest.mark.provokes(70334, 7, owner="axis Z")
@pytest.mark.parametrize("command", [Command.ON, Command.ON_CONST_DIST])
def test_no_second_selection_before_the_offset_is_out(
    make_loop: Callable[..., Any], command: Command
) -> None:
    with pytest.raises(Alarm, match="70334"):
        make_loop(is_newer=True).lead_to(State.TURNING_OFF).say(command)


@pytest.mark.provokes(70335, 7, owner="axis Z")
def test_a_surface_needs_its_position(make_loop: Callable[..., Any]) -> None:
    loop = make_loop()
    loop.control.set_distance(1.0)
    with pytest.raises(Alarm, match="70335"):
        loop.say(Command.ON)
    assert loop.control.state is State.INACTIVE


@pytest.mark.provokes(310024, 7, owner="axis Z")
def test_a_surface_needs_its_position_in_the_newer_family(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="310024"):
        make_loop(is_newer=True).say(Command.ON, source=Source.PLC)


@pytest.mark.provokes(900311, 7, owner="axis Z")
def test_a_constant_distance_needs_one(make_loop: Callable[..., Any]) -> None:
    loop = make_loop()
    loop.control.set_surface(1.0)
    with pytest.raises(Alarm, match="900311"):
        loop.say(Command.ON_CONST_DIST)
