"""What stands beside other words in its block means the same as alone: labels, times, functions."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Assign, Goto, Label, Number, Target, Variable, Words
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.words import words

XYZ = ("X", "Y", "Z")


def statements(text: str) -> list[object]:
    program = parse_program(text, file="p.nc", axes=XYZ)
    return [part.statement for part in program.blocks]


def only_words(text: str) -> Words:
    (found,) = statements(text)
    assert isinstance(found, Words)
    return found


def refused(text: str) -> UserError:
    (error,) = check_program(f"{text}\nM30", "p.nc", XYZ).errors
    assert error.line == 1
    return error


def test_a_block_may_have_a_number_and_a_name_to_jump_to() -> None:
    label, name, _, *jumps = statements("N10: [NAME] X1\n$GOTO N10\n$GOTO [NAME]")
    assert (label, name) == (Label("N10"), Label("[NAME]"))
    assert jumps == [Goto(Target("N10")), Goto(Target("[NAME]"))]


@pytest.mark.parametrize(("text", "name"), [("N0:", "N0"), ("N 0 :", "N0"), ("N007:", "N7")])
def test_a_label_is_the_number_of_its_block_and_0_is_one(text: str, name: str) -> None:
    assert statements(f"{text} X1\n$GOTO {name}") == [
        Label(name), Words(axes=(("X", Number(1.0)),)), Goto(Target(name))
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "g"),
    [
        ("G90 G4 5", ("G90", "G4")),
        ("G90 G17 G4 5", ("G90", "G17", "G4")),
        ("G4 5 G91", ("G4", "G91")),
        ("G004 5", ("G4",)),
        ("G90 G04[5]", ("G90", "G4")),
    ],
)
def test_a_time_belongs_to_the_g4_before_it(text: str, g: tuple[str, ...]) -> None:
    found = only_words(text)
    assert (found.g, found.addresses) == (g, (("G4", Number(5.0)),))


@pytest.mark.parametrize("text", ["G4 G90 5", "G90 G4 G91 5", "5 G4", "G90 5"])
def test_a_time_that_is_not_behind_g4_has_no_address(text: str) -> None:
    error = refused(text)
    assert error.message == "a value needs an address before it"
    assert (error.column, error.value) == (text.index("5") + 1, "5")


def test_a_time_is_beside_other_addresses() -> None:
    """Two times are refused, a time with a feed and a number for the PLC side is not."""
    time, feed, number = ("G4", Number(5.0)), ("F", Number(100.0)), ("H", Number(3.0))
    assert only_words("F100 G4 5 H3").addresses == (feed, time, number)
    assert only_words("H3 F100 G4 [5]").addresses == (number, feed, time)
    assert refused("F100 G4 5 6").message == "second time in one block"


def _groups() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for kind in ("G", "M"):
        for word in words(kind).values():
            found.setdefault(word.group, []).append(word.word)
    return {group: names for group, names in found.items() if group and len(names) > 1}


@pytest.mark.parametrize("group", _groups())
def test_two_of_a_group_exclude_each_other_whatever_is_between_them(group: str) -> None:
    between = next(w for w in ("G90", "G161") if words("G")[w].group != group)
    first, second = (each for each in _groups()[group][:2])
    written = {"G131": "G131=70", "G133": "G133=70", "G134": "G134=70", "G159": "G159=1"}
    a, b = written.get(first, first), written.get(second, second)
    for text in (f"{a} X1 {b}", f"{a} {between} Y1 {b}", f"{a} M77 {between} {b}"):
        error = refused(text)
        assert error.message == f"{first} and {second} exclude each other in one block"
        assert (error.value, error.column) == (second, text.rindex(b) + 1)
        assert error.allowed == f"one word of the group '{group}'"


@pytest.mark.parametrize("text", ["G25 G51", "G1 G025 G051 X5 F1", "G51 X1 G25"])
def test_each_function_that_does_not_act_is_noted_at_its_place(text: str) -> None:
    """A leading zero has no meaning."""
    notes = check_program(text, "p.nc", XYZ).notes
    found = {(note.column, note.text.partition(" ")[0]) for note in notes}
    assert found == {
        (text.replace("G0", "G").index(name) + 1 + (name == "G51" and "G051" in text), name)
        for name in ("G25", "G51")
    }


@pytest.mark.parametrize("name", ["P", "@P", "@S", "@X", "@", "@PX"])
def test_a_parameter_has_a_number(name: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_program(f"G0 X1\nY1 {name}=5", file="p.nc", axes=XYZ)
    assert (caught.value.line, caught.value.column) == (2, 4)


@pytest.mark.parametrize("name", ["P", "R", "@P", "@S"])
def test_a_parameter_is_the_same_with_its_number_behind_it_and_in_brackets(name: str) -> None:
    """R1 is the radius of an arc, and a parameter of a cycle has no brackets."""
    written = [f"{name}7=5", f"{name}07 = 5", *([] if "@" in name else [f"{name}[7]=5"])]
    for text in written:
        assert statements(text) == [Assign(Variable(f"{name}[]", (Number(7.0),)), Number(5.0))]
        program = check_program(f"X1\nF5 {text}\n{text}", "p.nc", XYZ)
        assert program.program.variables == ((f"{name}[]", 2, 4),)
        acts = name != "R"
        assert [(note.line, note.column) for note in program.notes] == (
            [] if acts else [(2, 4), (3, 1)]
        )


@pytest.mark.parametrize("radius", ["R5", "R=5", "R1=5", "R1 = 2+3", "r1=5"])
def test_a_radius_has_two_spellings(radius: str) -> None:
    """R1 with `=` is the radius too, and no parameter (15556764811); alone in a block it stays."""
    assert only_words(f"G2 X1 {radius}").addresses == (("R", Number(5.0)),)
    assert only_words(radius).addresses == (("R", Number(5.0)),)
    assert refused(f"G2 X1 {radius} R=6").message == "second R in one block"
    for text in ("R2=5", "R11=5"):
        assert isinstance(statements(text)[0], Assign)


@pytest.mark.parametrize("name", ["G81", "G081", "G0081"])
def test_a_cycle_of_others_is_read_with_words_that_nothing_has_here(name: str) -> None:
    """Its values mean nothing to the kernel: the program ends there, and not before."""
    found = only_words(f"{name} Z-10 Q5 P3")
    assert (found.g, found.axes, found.addresses) == (("G81",), (), ())
    assert refused("G1 Z-10 Q5").message == "the rig has no such axis"


@pytest.mark.parametrize("label", ["N10:", "[A]", "N10: [A]"])
@pytest.mark.parametrize(("block", "word"), [("G41 X1", "G41"), ("#TIMER [ID=1]", "#TIMER")])
def test_a_block_with_a_label_is_noted_and_jumped_to_as_one_without(
    label: str, block: str, word: str
) -> None:
    target = "N10" if "N10" in label else "[A]"
    found = check_program(f"{label} {block}\n$GOTO {target}", "p.nc", XYZ)
    assert found.errors == ()
    (note,) = found.notes
    assert (note.line, note.text.partition(" ")[0]) == (1, word)
    *labels, last = [part for part in found.program.blocks if part.block.line == 1]
    assert [type(part.statement) for part in labels] == [Label] * len(label.split())
    assert [[each.word for each in part.not_acting] for part in labels] == [[]] * len(labels)
    assert [each.word for each in last.not_acting] == [word]


@pytest.mark.parametrize(
    "head", ["%L UP", "%l UP", "%L   UP", "%L\tUP", "% L \t UP", "%L UP ; of the part", "%L UP\t"]
)
def test_a_subprogram_is_named_by_its_word_alone(head: str) -> None:
    """Blanks and tabs around it, and a comment behind it, are none of it."""
    program = parse_program(f"{head}\nX1\nM17\n%MAIN\nLL UP", file="p.nc", axes=XYZ)
    assert ([*program.subprograms], program.name) == (["UP"], "MAIN")


@pytest.mark.parametrize(("head", "name"), [("%L", "L"), ("%LUP", "LUP"), ("% LUP 2 ", "LUP 2")])
def test_a_program_whose_name_begins_with_l_is_a_main_program(head: str, name: str) -> None:
    program = parse_program(f"{head}\nX1\nM30", file="p.nc", axes=XYZ)
    assert (program.name, [*program.subprograms]) == (name, [])
