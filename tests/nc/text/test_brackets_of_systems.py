"""The brackets of #CS commands: numbers without keywords, texts or brackets of their own."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Command, Group, Number
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")
# What stands before the shifts of each command
COMMANDS = ("#CS ON", "#CS ON[1]", "#CS DEF", "#CS DEF[1]", "#CS ADD[PART]", "#CS SET[PART]")


def statement(text: str) -> Command:
    found = parse_program(text, file="p.nc", axes=XYZ).blocks[-1].statement
    assert isinstance(found, Command)
    return found


def refused(text: str, axes: tuple[str, ...] = XYZ) -> UserError:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=axes)
    assert (caught.value.file, caught.value.line) == ("p.nc", 2)
    return caught.value


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    "bracket",
    ["[X=1]", "[0,0,10,C=45]", "[C=45,0,0]", "[0,0,10 C=45]", '[0,"a"]', "[0,[1,2],0]",
     "[1,2,3,4,5,6,7]", "[,,,,,,]"],
)  # fmt: skip
def test_shifts_and_angles_are_six_numbers_without_keywords(command: str, bracket: str) -> None:
    """What is not known would be lost: `C=45` is no angle."""
    error = refused(f"N10 G0 X1\nN20 {command}{bracket}")
    assert error.message == f"wrong values for {command.partition('[')[0]}"
    assert error.column == 5
    assert error.allowed == "three shifts and three angles"


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("count", [1, 3, 6])
def test_up_to_six_numbers_are_taken(command: str, count: int) -> None:
    found = statement(f"{command}[{','.join(map(str, range(count)))}]")
    group = found.arguments[-1]
    assert isinstance(group, Group)
    assert group.arguments == tuple(Number(float(value)) for value in range(count))
    assert group.options == ()


@pytest.mark.parametrize("command", ["#CS SELECT", "#CS DEF", "#CS ADD", "#CS SET", "#CS ON"])
def test_a_keyword_is_none_in_the_bracket_of_an_id_or_a_name(command: str) -> None:
    behind = "" if command == "#CS SELECT" else "[0,0,1]"
    error = refused(f"\nN20 {command}[ID=1]{behind}")
    assert error.message == f"wrong values for {command}"


@pytest.mark.parametrize(
    ("text", "column", "message", "value"),
    [
        ("#CS DEF[1 2][0,0,1]", 15, "the first bracket of #CS DEF takes one ID", "2"),
        ("#CS DEF[O][0,0,1]", 13, "the first bracket of #CS DEF takes one ID", "O"),
        ("#CS ON[1 2][0,0,1]", 14, "the first bracket of #CS ON takes one ID", "2"),
        ("#CS ADD[A B][0,0,1]", 15, "the first bracket of #CS ADD takes one name", "B"),
        ("#CS SELECT[A B]", 18, "the first bracket of #CS SELECT takes one name", "B"),
        ("#CS DEF[1][0,0,O]", 20, "#CS DEF takes a number or an expression here", "O"),
        ("#CS DEF[1][0 0]", 18, "two values are separated by a comma", "0"),
        ("#CS SET[A][B]", 16, "#CS SET takes a number or an expression here", "B"),
    ],
)
def test_each_bracket_refuses_what_is_not_its_own(
    text: str, column: int, message: str, value: str
) -> None:
    error = refused(f"\nN20 {text}")
    assert (error.column, error.message, error.value) == (column, message, value)


@pytest.mark.parametrize("letter", ["O", "o"])
@pytest.mark.parametrize("name", ["CS DEF", "CS ON"])
def test_a_letter_o_is_no_id_of_a_system(name: str, letter: str) -> None:
    """Capital or small: what was meant is 0, and an ID counts from 1."""
    error = refused(f"\nN20 #{name}[{letter}][0,0,1]")
    assert (error.column, error.value) == (len(f"N20 #{name}[") + 1, letter)
    assert error.message == f"the first bracket of #{name} takes one ID"
    assert (error.allowed, error.hint) == ("a number from 1, or a name", "0 meant?")
    for known in ("1", "OO", "P1", "A"):
        assert statement(f"#{name}[{known}][0,0,1]").arguments


@pytest.mark.parametrize("text", ["#CS ADD[O][0,0,1]", "#CS SELECT[O]", "#CS ON[O]"])
def test_a_letter_o_is_a_name_where_names_are_meant(text: str) -> None:
    assert statement(text).arguments


@pytest.mark.parametrize("text", ["#CS ON[0,0,1]", "#CS DEF[1][0,0,1]", "#CS SELECT[A]"])
@pytest.mark.parametrize("axes", [("X",), ("X", "Z")])
def test_a_system_needs_three_main_axes(text: str, axes: tuple[str, ...]) -> None:
    error = refused(f"\nN20 {text}", axes)
    assert error.message == "a coordinate system needs three main axes"
    assert (error.column, error.value) == (5, ", ".join(axes))


@pytest.mark.parametrize("text", ["#CS OFF", "#CS OFF ALL", "#CS ON"])
def test_a_command_without_brackets_needs_none(text: str) -> None:
    program = parse_program(text, file="p.nc", axes=("X", "Z"))
    assert program.blocks[-1].statement == Command(text[1:], ())
