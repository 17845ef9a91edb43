"""Names of axes: a letter, a letter with digits, or such a beginning and a word after `_`.

Source: TF5200 system parameters 877646603, 2.9: a string that begins with X, Y, Z, U, V, W, Q, A,
B or C. Without `_` such a string and an expression after a letter look alike: it is refused.
"""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import AxisCommand, Command, Name, Number, Variable, Words
from axisrig.kernel.nc.text.check import axes_of
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X2_Table", "X", "Y", "Q", "A_1")


def statement(text: str) -> object:
    (block,) = parse_program(text, axes=AXES).blocks
    return block.statement


def test_words_of_axes_with_long_names() -> None:
    found = statement("N10X2_Table=1.5 X3 Q4 a_1=[1+1] Y=5 F100")
    assert isinstance(found, Words)
    assert found.axes == (
        ("X2_Table", Number(1.5)),
        ("X", Number(3.0)),
        ("Q", Number(4.0)),
        ("A_1", Number(2.0)),
        ("Y", Number(5.0)),
    )


def test_commands_and_variables_of_axes_with_long_names() -> None:
    found = statement("X2_Table[INDP_SYN G90 G1 POS=100 FEED=500] Y5 G1 F1000")
    assert isinstance(found, Words)
    (command,) = found.axis_commands
    assert isinstance(command, AxisCommand)
    assert command.axis == "X2_Table"
    named = statement("#MEAS [AX=X2_Table INPUT=1]")
    assert isinstance(named, Command)
    assert named.option("AX") == Name("X2_Table")
    read = statement("X=V.A.MESS.X2_TABLE")
    assert isinstance(read, Words)
    assert read.axes == (("X", Variable("V.A.MESS.X2_TABLE")),)


@pytest.mark.parametrize(("text", "found"), [("X3_Table=1", "X3_TABLE"), ("X2_=1", "X2_")])
def test_a_name_that_the_rig_does_not_have_is_refused_whole(text: str, found: str) -> None:
    with pytest.raises(UserError, match="no such axis") as refused:
        statement(text)
    assert refused.value.value == found


def test_without_a_rig_a_program_names_its_axes() -> None:
    assert axes_of("X2_Table=1 Z1=3 A_B[INDP_SYN]")[-3:] == ("A_B", "X2_TABLE", "Z1")
