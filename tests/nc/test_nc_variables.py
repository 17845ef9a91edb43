"""Variables that a program makes, and those of the PLC side."""

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import ExternalWrite, LinearMove, Message, Wait
from axisrig.kernel.nc.decoder import Interpreter, interpreter
from axisrig.kernel.nc.decoder.base.context import ChannelControl
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def value_of(run, expression, before="", **options):
    """Let a message print an expression with nine digits."""
    commands = run(f'{before}\n#MSG ["%.9f", {expression}]', **options)
    (text,) = (c.text for c in commands if isinstance(c, Message))
    return float(text)


def alarm_of(run, text, **options):
    with pytest.raises(Alarm) as caught:
        run(text, **options)
    return caught.value


def declared(text):
    return f"#VAR\n{text}\n#ENDVAR"


# ---- values


@pytest.mark.parametrize("name", ["P1", "P[0+1]", "V.P.A", "v.p.a", "V.L.A", "V.S.A"])
def test_a_variable_keeps_what_is_assigned_to_it(run, name):
    assert value_of(run, f"{name}*2", f"{name}=1.25") == 2.5


def test_decimals_are_kept_over_the_whole_travel(run):
    """0.1 um over 10 m."""
    assert value_of(run, "P1-9999", "P1=9999.9999") == pytest.approx(0.9999, abs=1e-9)


def test_several_assignments_in_one_block_count_from_left_to_right(run):
    assert value_of(run, "P2", "P1=2 P2=P1+1") == 3


@pytest.mark.parametrize(
    ("declaration", "expression", "expected"),
    [
        ("V.P.A", "V.P.A", 0),
        ("V.P.A = 3", "V.P.A", 3),
        ("V.P.A : UNS32 = 200", "V.P.A", 200),
        ("V.P.A : BOOLEAN", "V.P.A", 0),
        ("V.P.A[3]", "V.P.A[2]", 0),
        ("V.P.A[5] = [5,10,10,15,20]", "V.P.A[4]", 20),
        ("V.P.A[2][3] = [1,2,3,4,5,6]", "V.P.A[1][0]", 4),
        ("V.P.A[3] = [1,2]", "V.P.A[2]", 0),
        ("V.S.A[2] = [1,2]", "V.S.A[1]", 2),
    ],
)
def test_declarations_give_types_sizes_and_first_values(run, declaration, expression, expected):
    """Programming manual 207981323: 0 where none is given; the first index is 0."""
    assert value_of(run, expression, declared(declaration)) == expected


def test_indices_are_expressions(run):
    before = f"{declared('V.P.A[3] = [7,8,9]')}\nP1=1"
    assert value_of(run, "V.P.A[P1+1]", before) == 9
    assert value_of(run, "V.P.A[0]", f"{before}\nV.P.A[P1-1]=5") == 5


def test_a_whole_number_type_drops_the_fraction(run):
    before = f"{declared('V.P.A : SGN32')}\nV.P.A=-2.7"
    assert value_of(run, "V.P.A", before) == -2


def test_texts_compare_and_print(run):
    before = f'{declared("V.P.T : STRING[20]")}\nV.P.T="part"\nP1=0'
    commands = run(f'{before}\n$IF V.P.T == "part"\nP1=1\n$ENDIF\n#MSG ["%s %d", V.P.T, P1]')
    assert [c.text for c in commands if isinstance(c, Message)] == ["part 1"]


def test_variables_of_the_session_outlive_the_program(plane_machine):
    kept = {}
    seen = []
    for text in ("V.S.COUNT=41", '#MSG ["%d", V.S.COUNT+1]'):
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
        program = parse_program(text, axes=XYZ)
        commands = Interpreter(program, XYZ, machine, external={}, kept=kept).commands()
        seen += [c.text for c in commands if isinstance(c, Message)]
    assert seen == ["42"]


def test_a_variable_of_the_session_that_is_declared_again_keeps_its_value(run):
    again = f"{declared('V.S.A = 1')}\nV.S.A=2\n{declared('V.S.A = 1')}"
    assert value_of(run, "V.S.A", again) == 2


def test_an_array_of_the_session_with_other_sizes_is_a_new_one(run):
    """Its first values count; one element more, one dimension more, or none any more."""
    for first, then, name, expected in (
        ("V.S.A[2] = [1,2]", "V.S.A[3] = [4,5,6]", "V.S.A[2]", 6),
        ("V.S.A[3] = [1,2,3]", "V.S.A[2] = [4,5]", "V.S.A[1]", 5),
        ("V.S.A[2] = [1,2]", "V.S.A[2] = [4,5]", "V.S.A[1]", 2),
        ("V.S.A[2] = [1,2]", "V.S.A[2]", "V.S.A[0]", 1),
    ):
        assert value_of(run, name, f"{declared(first)}\n{declared(then)}") == expected


# ---- what cannot be


@pytest.mark.parametrize(
    ("text", "line", "near"),
    [
        ("V.P.SPEED=1\nX=V.P.SPEDE", 2, "V.P.SPEED"),
        ("V.L.SPEED=1\nX=V.P.SPEED", 2, "V.L.SPEED"),
        (f"{declared('V.P.A[2]')}\nX=V.P.A", 4, "ID 21216"),
        (f"{declared('V.P.A[2]')}\nX=V.P.A[0][1]", 4, "ID 21216"),
        ("V.P.A[1]=2", 1, "not declared"),
    ],
)
def test_names_that_nothing_makes_are_refused_before_anything_runs(run, text, line, near):
    with pytest.raises(UserError) as caught:
        run(text)
    assert caught.value.line == line
    assert near in str(caught.value)


@pytest.mark.provokes(20403, 2, name="V.P.A[2]", value=2, lower=0, upper=1)
def test_20403_for_an_index_beyond_the_array(run):
    alarm = alarm_of(run, f"{declared('V.P.A[2]')}\nP1=2\nX=V.P.A[P1]")
    assert alarm.id == 20403


@pytest.mark.parametrize("index", ["-1", "0.5"])
def test_20403_for_what_is_no_index(run, index):
    assert alarm_of(run, f"{declared('V.P.A[2]')}\nP1={index}\nX=V.P.A[P1]").id == 20403


@pytest.mark.provokes(20847, 2, name="V.P.A", value="256", lower=0, upper=255)
def test_20847_for_a_value_that_the_type_cannot_hold(run):
    assert alarm_of(run, f"{declared('V.P.A : UNS08')}\nV.P.A=256").id == 20847


@pytest.mark.provokes(900121, 2, name="V.A.ABS.X")
def test_900121_for_a_variable_that_can_be_read_only(run):
    assert alarm_of(run, "V.A.ABS.X=1").id == 900121


@pytest.mark.provokes(900122, 2, name="V.P.A", kind="UNS08", value="one")
def test_900122_for_a_text_where_a_number_is_declared(run):
    assert alarm_of(run, f'{declared("V.P.A : UNS08")}\nV.P.A="one"').id == 900122


@pytest.mark.provokes(900123, 2, name="V.P.A[2000][2000]", maximum=1_000_000)
def test_900123_for_an_array_without_a_reasonable_size(run):
    assert alarm_of(run, declared("V.P.A[2000][2000]")).id == 900123


@pytest.mark.provokes(900124, 2, name="V.P.A[2]", places=2, given=3)
def test_900124_for_more_values_than_elements(run):
    assert alarm_of(run, declared("V.P.A[2] = [1,2,3]")).id == 900124


@pytest.mark.provokes(900113, 2, name="P71", near="the nearest with one: P70")
def test_900113_names_what_has_a_value(run):
    assert alarm_of(run, "P70=1\nX=P71").id == 900113


# ---- the PLC side


def test_a_value_of_the_plc_side_is_that_of_the_moment(plane_machine):
    live = {"A": 1.0}
    program = parse_program('#MSG ["%g", V.E.A]\nG0 X1\n#MSG ["%g", V.E.A]', axes=XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    seen = []
    for command in Interpreter(program, XYZ, machine, external=live).commands():
        if isinstance(command, Message):
            seen.append(command.text)
        if isinstance(command, Wait) and seen:
            live["A"] = 2.0  # the PLC side changes it while the machine moves
    assert seen == ["1", "2"]


def test_a_value_for_the_plc_side_is_given_out_in_the_order_of_the_program(run):
    commands = run("G0 X1\nV.E.Done=P1+1\nX2".replace("P1", "1"), external={"Done": 0.0})
    assert [type(c) for c in commands[:3]] == [LinearMove, ExternalWrite, LinearMove]
    assert (commands[1].name, commands[1].value) == ("Done", 2.0)


def test_a_variable_that_the_plc_side_does_not_have_is_refused(run):
    with pytest.raises(UserError) as caught:
        run("V.E.DOEN=1", external={"DONE": 0.0})
    assert caught.value.hint == "did you mean V.E.DONE"


def test_a_loop_that_asks_the_plc_side_takes_cycles(monkeypatch):
    """Each turn waits for a cycle of the machine, so it is no endless loop of the decoder."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 50)
    waits = 0

    class Ready(dict):
        def __getitem__(self, name):
            return float(waits > 200)

    machine_view = Ready(READY=0.0)
    program = parse_program("$WHILE V.E.READY==0\n$ENDWHILE", axes=XYZ)
    for command in Interpreter(program, XYZ, _Still(), external=machine_view).commands():
        waits += isinstance(command, Wait) and command.for_cycle
    assert waits == 201


class _Still:
    def position_acs_mm(self, axis):
        return 0.0


def test_the_feed_in_force_is_a_variable(run):
    assert value_of(run, "V.G.FEEDRATE") == 0
    assert value_of(run, "V.G.FEEDRATE", "F250") == 250
    assert value_of(run, "V.G.FEEDRATE", "G70 F10") == 10  # in the unit of the program


@pytest.mark.parametrize("name", ["TOOL_TILT", "TOOL_LENGTH"])
def test_what_the_channel_shows_of_the_tool_is_written_by_it_alone(run, plane_machine, name):
    """Under 3D distance control; without one it is a variable as any other."""
    text, external = f"V.E.{name} = 5", {name: 0.0, "OTHER": 0.0}
    (write,) = [c for c in run(text, external=external) if isinstance(c, ExternalWrite)]
    assert (write.name, write.value) == (name, 5.0)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    machine.channel_distance = ChannelControl
    with pytest.raises(Alarm) as caught:
        run(text, machine, external=external)
    assert (caught.value.id, caught.value.values) == (900121, {"name": f"V.E.{name}"})
    assert next(type(c) for c in run("V.E.OTHER = 5", machine, external=external)) is ExternalWrite
