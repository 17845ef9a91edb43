"""Single axes under a coordinate system, which moves axes that a block does not name."""

import pytest
from axis_statements import Machine, alone, decode, kinds, path, single

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.syntax import Command, Group, Name, Number, Words

OFF = Command("CS OFF")


def turned(*angles_deg: float) -> Command:
    """Make #CS ON[0,0,0,..]."""
    values = (0.0, 0.0, 0.0, *angles_deg)
    return Command("CS ON", (Group(tuple(Number(value) for value in values), ()),))


def put(axis: str) -> Command:
    return Command("PUT AX", (Name(axis),))


def test_a_system_comes_and_goes_when_its_axes_have_arrived() -> None:
    x = alone("X", "G90", "G1", POS=50, FEED=3000, name="INDP_ASYN")
    on = turned(0, 0, 30)
    assert kinds(decode(single(x), on)) == ["IndependentMove", "WaitIndependent", "EndOfProgram"]
    further = alone("C", "G90", "G1", POS=50, FEED=3000, name="INDP_ASYN")
    assert kinds(decode(single(further), on, OFF)) == ["IndependentMove", "EndOfProgram"]


def test_what_an_axis_measures_beside_the_program_belongs_to_the_system_of_its_run() -> None:
    """Its latch at 60 mm is a value of the axes, although #CS ON is the next block."""
    machine = Machine()
    machine.measured["X"] = 60.0
    x = alone("X", "G100", "G90", POS=100, FEED=1200, name="INDP_ASYN")
    commands = decode(
        single(x),
        turned(0, 0, 30),
        OFF,
        Words(g=("G101",), axes=(("X", Number(1.0)),)),
        path(X=1.0),
        machine=machine,
    )
    assert commands[-2].target_mm == {"X": pytest.approx(1.0 - 40.0)}


@pytest.mark.provokes(900195, 2, axis="Z")
def test_an_axis_that_was_given_away_is_not_moved_by_a_turned_system() -> None:
    with pytest.raises(Alarm) as alarm:
        decode(put("Z"), turned(0, 15, 0), path(X=6.0))
    assert (alarm.value.id, alarm.value.values["axis"]) == (900195, "Z")


@pytest.mark.provokes(900195, 2, axis="Z")
def test_a_run_under_a_system_does_not_measure_with_an_axis_that_was_given_away() -> None:
    measure = Words(g=("G100",), axes=(("X", Number(6.0)),), addresses=(("F", Number(600.0)),))
    with pytest.raises(Alarm) as alarm:
        decode(put("Z"), turned(0, 0, 30), measure)
    assert alarm.value.id == 900195


def test_an_axis_that_was_given_away_hinders_no_motion_that_leaves_it_where_it_is() -> None:
    commands = decode(put("Z"), turned(0, 0, 30), path(X=6.0))
    assert kinds(commands) == ["AxisExchange", "LinearMove", "EndOfProgram"]
