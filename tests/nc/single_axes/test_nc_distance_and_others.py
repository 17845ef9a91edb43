"""What stands in a program while the distance control of an axis is on: what it forbids."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

Run = Callable[..., Any]
STATES = ("INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "ACTIVE_CONST_DIST", "ERROR")
ACTIONS = {"on": "ACTIVE", "on_const": "ACTIVE_CONST_DIST", "off": "INACTIVE", "freeze": "FREEZE"}


@pytest.fixture
def machine(plane_machine: Any) -> Any:
    """Z and A have a control, which does what it is told when the machine gets there."""

    class Machine(plane_machine):
        states: dict[str, str]

        def distance_state(self, axis: str) -> str | None:
            return self.states.get(axis)

        def execute(self) -> None:
            for command in self.queue:
                if isinstance(command, canon.DistanceCommand) and command.action:
                    self.states[command.axis] = ACTIONS[command.action]
            super().execute()

    made = Machine(dict.fromkeys(("X", "Y", "Z", "A"), 0.0), None)
    made.states = {"Z": "INACTIVE", "A": "INACTIVE"}
    return made


def names(run: Run, machine: Any, *blocks: str) -> list[str]:
    found = run("%t\n" + "\n".join((*blocks, "M30\n")), machine, axes=("X", "Y", "Z", "A"))
    return [type(command).__name__ for command in found]


@pytest.mark.provokes(70333, 7, axis="Z")
@pytest.mark.parametrize("block", ["#PUT AX[Z]", "#PUT AX[X, Z]", "#PUT AX ALL"])
def test_70333_for_an_axis_that_is_given_away_while_its_control_is_on(
    run: Run, machine: Any, block: str
) -> None:
    with pytest.raises(Alarm) as caught:
        names(run, machine, "Z[DIST_CTRL ON SET_POS=3]", f"N20 {block}")
    assert (caught.value.id, caught.value.values) == (70333, {"axis": "Z"})
    assert str(caught.value.place).endswith("block N20")


@pytest.mark.parametrize("state", STATES[1:])
def test_every_state_but_inactive_keeps_the_axis(run: Run, machine: Any, state: str) -> None:
    """The PLC side may have switched it on: the program asks the machine."""
    machine.states["Z"] = state
    with pytest.raises(Alarm, match="70333"):
        names(run, machine, "#PUT AX[Z]")


def test_after_off_it_may_go(run: Run, machine: Any) -> None:
    found = names(run, machine, "Z[DIST_CTRL ON]", "Z[DIST_CTRL WAIT OFF]", "#PUT AX[Z]")
    assert found[-3:] == ["Wait", "AxisExchange", "EndOfProgram"]


@pytest.mark.parametrize("block", ["#PUT AX[X]", "G74 X1", "#CHANNEL INIT[ACTPOS AX=X]"])
def test_axes_without_a_control_go_as_ever(run: Run, machine: Any, block: str) -> None:
    machine.states["Z"] = "ACTIVE"
    assert "Wait" not in names(run, machine, block)[:1]


@pytest.mark.parametrize("state", ["ACTIVE", "ACTIVE_CONST_DIST", "TURNING_OFF", "ERROR"])
@pytest.mark.parametrize(
    ("block", "word"),
    [("G74 X1 Z2", "G74"), ("#CHANNEL INIT[ACTPOS]", "#CHANNEL INIT[ACTPOS]")],
)
@pytest.mark.provokes(51062, 7, plane="ACS")
def test_51062_where_a_position_begins_anew_under_a_changing_offset(
    run: Run, machine: Any, block: str, word: str, state: str
) -> None:
    machine.states["Z"] = state
    with pytest.raises(Alarm) as caught:
        names(run, machine, block)
    assert (caught.value.id, caught.value.values) == (51062, {"word": word, "plane": "ACS"})


@pytest.mark.parametrize("state", ["INACTIVE", "FREEZE"])
@pytest.mark.parametrize("block", ["G74 X1 Z2", "#CHANNEL INIT[ACTPOS]"])
def test_a_frozen_offset_forbids_no_new_position(
    run: Run, machine: Any, block: str, state: str
) -> None:
    machine.states["Z"] = state
    names(run, machine, block)


@pytest.mark.parametrize(
    "block", ["#CHANNEL INIT[CMDPOS]", "#CS ON[0,0,5,0,0,0]", "G92 Z5", "G54", "G18"]
)
def test_what_moves_no_axis_is_allowed_at_any_time(run: Run, machine: Any, block: str) -> None:
    """The offset is one of the axis: systems and shifts of the program do not change it."""
    machine.states["Z"] = "ACTIVE"
    assert names(run, machine, block)[-1] == "EndOfProgram"


# ---- axes that are away or led by others


@pytest.mark.parametrize("words", ["ON SET_POS=3", "OFF", "SET_DIST=1"])
@pytest.mark.provokes(900195, 2, axis="Z")
def test_900195_for_the_control_of_an_axis_that_is_away(run: Run, machine: Any, words: str) -> None:
    with pytest.raises(Alarm, match="900195"):
        names(run, machine, "#PUT AX[Z]", f"Z[DIST_CTRL {words}]")


COUPLED = ("#SET AX LINK[1, A=Z]", "#ENABLE AX LINK[1]")


@pytest.mark.provokes(900196, 2, axis="A", master="Z", group=1)
@pytest.mark.parametrize(
    "word", ["ON", "DRYRUN", "ON CONST_DIST", "ON CONST_DIST SET_DIST=1", "DRYRUN CONST_DIST"]
)
def test_900196_for_a_slave_that_is_to_have_an_offset_of_its_own(
    run: Run, machine: Any, word: str
) -> None:
    with pytest.raises(Alarm, match="900196"):
        names(run, machine, *COUPLED, f"A[DIST_CTRL {word}]")


@pytest.mark.parametrize("word", ["FREEZE", "OFF", "SET_DIST=1", "KP=0.5"])
def test_a_slave_may_get_all_words_that_switch_nothing_on(
    run: Run, machine: Any, word: str
) -> None:
    found = names(run, machine, *COUPLED, f"A[DIST_CTRL {word}]")
    assert found[-2:] == ["DistanceCommand", "EndOfProgram"]


def test_the_master_of_a_coupling_may_and_a_slave_may_switch_off(run: Run, machine: Any) -> None:
    found = names(run, machine, *COUPLED, "Z[DIST_CTRL ON]", "A[DIST_CTRL OFF]")
    assert found[-3:] == ["DistanceCommand", "DistanceCommand", "EndOfProgram"]


def test_a_slave_may_hold_a_constant_distance_once_it_follows_no_more(
    run: Run, machine: Any
) -> None:
    """And the master while it has one."""
    switched = "A[DIST_CTRL ON CONST_DIST]"
    found = names(run, machine, *COUPLED, "#DISABLE AX LINK[1]", switched)
    assert found[-2:] == ["DistanceCommand", "EndOfProgram"]
    found = names(run, machine, *COUPLED, "Z[DIST_CTRL ON CONST_DIST]")
    assert found[-2:] == ["DistanceCommand", "EndOfProgram"]
