"""Messages, expressions and variables from the PLC side."""

import pytest
from tests.nc.conftest import texts

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.canon import EndOfProgram, LinearMove, Message, Wait
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def test_synchronous_message_waits_and_plain_message_does_not(run):
    commands = run('#MSG ["a"]\n#MSG SYN ["b"]\n#MSG SYN["c"]')
    assert [type(c) for c in commands] == [Message, Wait, Message, Wait, Message, EndOfProgram]
    assert [c.synchronous for c in commands if isinstance(c, Message)] == [False, True, True]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('"plain"', "plain"),
        ('"%f", 1/3', "0.333333"),
        ('"%F", 2', "2.000000"),
        ('"%8.2f|", 3.14159', "    3.14|"),
        ('"%-6d|%i|%D", 5, 7, 9', "5     |7|9"),
        ('"%e", 12345', "1.234500e+04"),
        ('"%g", 0.5', "0.5"),
        ('"%s and %S", "x;y", "(z)"', "x;y and (z)"),
        ('"100 %%"', "100 %"),
        ('"a;b(c)"', "a;b(c)"),
    ],
)
def test_message_texts(run, text, expected):
    assert texts(run(f"#MSG [{text}]")) == [expected]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("1+2*3", 7),
        ("[1+2]*3", 9),
        ("10-4-3", 3),
        ("24/4/3", 2),
        ("2*-3", -6),
        ("--2", 2),
        ("-[2+3]", -5),
        (".5+1.", 1.5),
        ("ABS[-4]", 4),
        ("SQRT[2*8]", 4),
        ("SIN[30]", 0.5),
        ("COS[60]", 0.5),
        ("TAN[45]", 1),
        ("sin[ 30 ] * 2", 1),
        ("SIN[30]+COS[SIN[0]]", 1.5),
        ("V.A.ABS.X*2+1", 9),
        ("v.a.abs.x", 4),
        ("-V.A.ABS.X", -4),
        ("V.E.SURFACE.HEIGHT/2", 1.25),
    ],
)
def test_expressions(run, expression, expected):
    external = {"Surface.Height": 2.5}
    (text,) = texts(run(f'G0 X4\n#MSG ["%.9f", {expression}]', external=external))
    assert float(text) == pytest.approx(expected)


def test_expressions_in_axis_words_and_feed(run):
    commands = run("G1 X=2*[3+4] Y=V.E.A F=60*5", external={"A": 1.5})
    (move,) = [c for c in commands if isinstance(c, LinearMove)]
    assert dict(move.target_mm) == {"X": 14.0, "Y": 1.5}
    assert move.feed_mm_min == 300.0


def test_unknown_external_variable_is_refused_before_anything_runs(plane_machine):
    program = parse_program('G0 X1\n#MSG ["%f", V.E.HIGHT]', file="p.nc", axes=XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    with pytest.raises(UserError) as caught:
        Interpreter(program, XYZ, machine, external={"HEIGHT": 1.0, "TIME": 2.0})
    error = caught.value
    assert (error.file, error.line, error.column) == ("p.nc", 2, 13)
    assert error.hint == "did you mean V.E.HEIGHT"


def test_external_value_is_read_when_the_block_uses_it(plane_machine):
    live = {"A": 1.0}
    program = parse_program('#MSG ["%g", V.E.A]\n#MSG ["%g", V.E.A]', axes=XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    seen = []
    for command in Interpreter(program, XYZ, machine, external=live).commands():
        if isinstance(command, Message):
            seen.append(command.text)
            live["A"] = 2.0
    assert seen == ["1", "2"]
