"""What a call may hand to a cycle, and how a bracket that has one value too many is refused.

@P1, @S2: TF5200 programming manual 206859019; a bracket of #CS: 208480907.
"""

import pytest
from tests.nc.text.test_text_refusals import refused

from axisrig.kernel.nc.syntax import Command, Group, Number, SubprogramCall
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def statement(text):
    return parse_program(text, file="p.nc", axes=XYZ).blocks[0].statement


def test_parameters_are_kept_in_their_order_wherever_the_name_is():
    call = statement("L CYCLE [@P30=1 NAME=go.cyc @P2=2.5 @S1=3]")
    assert isinstance(call, SubprogramCall)
    assert (call.name, call.scope) == ("go.cyc", "cycle")
    assert call.parameters == (
        ("@P30", Number(1.0)),
        ("@P2", Number(2.5)),
        ("@S1", Number(3.0)),
    )


@pytest.mark.parametrize("sign", ["@P", "@S"])
def test_a_parameter_has_a_number(sign):
    error = refused(f"L CYCLE [NAME=go.cyc {sign}=1]")
    assert error.message == "unknown keyword of L CYCLE"
    assert (error.line, error.column, error.value) == (1, 22, sign)


@pytest.mark.parametrize(
    ("parameter", "value", "found"),
    [("@P1", "ABC", "ABC"), ("@P1", "[1,2]", "["), ("@S2", "UP", "UP"), ("@P7", "[]", "[")],
)
def test_a_parameter_takes_a_value_and_no_name(parameter, value, found):
    error = refused(f"L CYCLE [NAME=go.cyc {parameter}={value}]")
    assert error.message == f"{parameter} takes a number, a text or an expression"
    assert (error.line, error.column, error.value) == (1, 26, found)
    assert error.allowed == f'{parameter}=10, {parameter}=P1, {parameter}="text"'


@pytest.mark.parametrize("value", ["10", "P1", "[P1+1]", '"text"', "-SQRT[2]", "@P3"])
@pytest.mark.parametrize("parameter", ["@P1", "@S1"])
def test_every_value_that_a_parameter_takes(parameter, value):
    call = statement(f"L CYCLE [NAME=go.cyc {parameter}={value}]")
    assert [keyword for keyword, _ in call.parameters] == [parameter]


@pytest.mark.parametrize("again", ["@P1", "@P01", "@p001"])
def test_the_same_parameter_twice_is_refused_and_two_of_them_are_not(again):
    error = refused(f"L CYCLE [NAME=go.cyc @P1=1 @P2=2 {again}=3]")
    assert error.message == "keyword twice in one command"
    assert (error.column, error.value) == (34, "@P1")
    assert len(statement("L CYCLE [NAME=go.cyc @P1=1 @P11=2 @S1=3]").parameters) == 3
    assert [k for k, _ in statement("L CYCLE [NAME=go.cyc @P01=1]").parameters] == ["@P1"]


@pytest.mark.parametrize("word", ["M", "m"])
def test_an_m_function_of_an_axis_has_a_number(word):
    error = refused(f"X[INDP_SYN POS=1 G00 {word}]")
    assert error.message == "unknown keyword of X[INDP_SYN"
    assert (error.column, error.value) == (22, word)
    (command,) = statement("X[INDP_SYN POS=1 G00 M7 M8 H1 H2]").axis_commands
    assert [keyword for keyword, _ in command.options] == ["POS", "G0", "M7", "M8", "H", "H"]


# ---- brackets of coordinate systems


@pytest.mark.parametrize(
    ("text", "column", "value"),
    [
        ("#CS ON[1 2]", 10, "2"),
        ("#CS ON[1 2 3]", 10, "2"),
        ("#CS ON[10 P1]", 11, "P1"),
        ("#CS DEF[1 2]", 11, "2"),
        ("#CS ON[1][2 3]", 13, "3"),
        ("#CS ADD[A][2 3]", 14, "3"),
    ],
)
def test_two_shifts_have_a_comma_between_them(text, column, value):
    error = refused(text)
    assert error.message == "two values are separated by a comma"
    assert (error.column, error.value, error.allowed) == (column, value, "comma")


@pytest.mark.parametrize("text", ["#CS ON[3]", "#CS ON[P1+1]", "#CS ON[WP]"])
def test_one_value_may_be_the_id_of_a_system(text):
    command = statement(text)
    assert isinstance(command, Command)
    (group,) = command.arguments
    assert isinstance(group, Group)
    assert len(group.arguments) == 1


@pytest.mark.parametrize("text", ["#CS ADD[][1,2]", "#CS SET [ ][1,2]", "X1\n#CS SELECT[]"])
def test_a_system_that_is_linked_has_a_name(text):
    error = refused(text)
    command = text.splitlines()[-1].partition("[")[0].strip()
    assert error.message == f"the first bracket of {command} takes one name"
    assert (error.line, error.column) == (
        len(text.splitlines()),
        text.splitlines()[-1].index("[") + 1,
    )
    assert (error.value, error.allowed) == ("[", "a name")
