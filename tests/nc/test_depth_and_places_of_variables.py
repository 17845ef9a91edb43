"""How deep calls go, whose @P a call of a cycle sees, which index and which names an alarm says."""

import pytest
from tests.nc.conftest import PlaneMachine, texts

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import read_program

XYZ = ("X", "Y", "Z")


def refused(run, text, **more):
    with pytest.raises(Alarm) as caught:
        run(text, **more)
    return caught.value


def deep(calls):
    """A subprogram that calls itself until so many calls are open."""
    body = f"P1=P1+1\n$IF P1 < {calls}\nLL SUB\n$ENDIF\nM17"
    return f"%L SUB\n{body}\n%MAIN\nP1=0\nLL SUB\n" + '#MSG ["%d", P1]\nM30'


@pytest.mark.parametrize("calls", [1, 49, 50])
def test_fifty_calls_may_be_open(run, calls):
    assert texts(run(deep(calls))) == [str(calls)]


def test_20360_for_the_call_after_the_fiftieth(run):
    alarm = refused(run, deep(51))
    assert (alarm.id, alarm.values) == (20360, {"limit": 50, "name": "SUB"})
    assert alarm.place == "test.nc line 4"


def test_a_call_of_a_cycle_sees_its_own_parameters_alone(tmp_path):
    """The inner call of the same cycle is without @P2, which the outer one has."""
    cycle = '#MSG ["%d", @P1]\n$IF @P1 > 1\nL CYCLE [NAME=own.cyc @P1=@P1-1]\n$ENDIF\n'
    (tmp_path / "main.nc").write_text("L CYCLE [NAME=own.cyc @P1=2 @P2=7]\nM30")
    shown = []

    def play(text):
        (tmp_path / "own.cyc").write_text(text)
        machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), None)
        program = read_program(tmp_path / "main.nc", XYZ)
        for command in Interpreter(program, XYZ, machine, external={}).commands():
            shown.extend([command.text] if isinstance(command, Message) else [])

    play(f"{cycle}M17")
    assert shown == ["2", "1"]
    play(f'{cycle}#MSG ["%d", @P1]\nM17')
    assert shown[2:] == ["2", "1", "1", "2"]  # each has its own when the inner call has ended
    with pytest.raises(Alarm) as caught:
        play(f"P1=@P2\n{cycle}M17")
    assert (caught.value.id, caught.value.values["name"]) == (900113, "@P2")


@pytest.mark.parametrize(
    ("place", "index", "last"),
    [("[2][0]", 2, 1), ("[1][3]", 3, 2), ("[0][7]", 7, 2), ("[5][9]", 5, 1)],
)
@pytest.mark.parametrize("block", ["P1=V.P.A{}", "V.P.A{}=1"])
def test_20403_names_the_index_that_is_too_large(run, block, place, index, last):
    alarm = refused(run, f"#VAR\nV.P.A[2][3]\n#ENDVAR\n{block.format(place)}")
    wanted = {"name": f"V.P.A{place}", "value": index, "lower": 0, "upper": last}
    assert (alarm.id, alarm.values) == (20403, wanted)


def test_every_place_with_a_value_may_be_the_nearest_one(run):
    alarm = refused(run, "P1=1\nP31=1\nP45=1\nX=P46")
    near = str(alarm.values["near"])
    assert (alarm.id, alarm.values["name"]) == (900113, "P46")
    assert "P45" in near
    assert near.startswith("the nearest with one: P")


@pytest.mark.parametrize("written", ["V.E.READY", "v.e.ready", "V.E.Ready"])
def test_a_variable_of_the_plc_side_is_named_as_that_spells_it(written):
    from tests.nc.test_nc_waiting import decode  # noqa: PLC0415

    with pytest.raises(Alarm) as caught:
        decode(f"G1 X1 F100\nN20 #WAIT FOR {written} == 1", {"Ready": 0.0})
    assert caught.value.values == {
        "names": "V.E.Ready",
        "loop": f"line 2 (N20 #WAIT FOR {written} == 1)",
    }


@pytest.mark.parametrize("factor", [1.0, 0.5, -1.0, -0.25])
def test_a_measured_offset_counts_with_the_sign_of_its_factor(run, factor):
    """G101: a contact at 8 of a way to 10 is 2 before it; a share of that is taken."""
    machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), ("X", 8.0))
    text = f"G100 X10 F100\nG101 X={factor}\n" + '#MSG ["%f", V.A.MEIN.X]'
    (shown,) = texts(run(text, machine))
    assert float(shown) == pytest.approx(factor * (8.0 - 10.0), abs=1e-6)
