"""Programs as text: what is accepted, and where each error is found."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.nc.text.parser import parse_program, read_program
from axisrig.kernel.nc.text.words import variables, words

XYZ = ("X", "Y", "Z")


def refused(text, axes=XYZ):
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=axes)
    return caught.value


# (text, line, column, part of the message, found value)
ERRORS = [
    # words
    ("N10 G777 X1", 1, 5, "unknown G function", "G777"),
    ("G1.5", 1, 1, "whole number", "G1.5"),
    ("G-1", 1, 1, "whole number", "G-1"),
    ("G=3", 1, 1, "whole number", "G"),
    ("G1\nG1 Q10 F1", 2, 4, "no such axis", "Q"),
    ("X2=0", 1, 1, "no such axis", "X2"),
    ("G1 F1\n  X", 2, 3, "axis X has no value", "X"),
    ("X1 X2", 1, 4, "axis twice", "X"),
    ("F1 F2", 1, 4, "second feed", "F"),
    ("F0", 1, 1, "feed", "F0"),
    ("G1 F-3", 1, 4, "feed", "F-3"),
    ("X10 N20", 1, 5, "block number", "N20"),
    ("G100 F3", 1, 1, "G100 needs an axis", "G100"),
    ("G92", 1, 1, "G92 needs an axis", "G92"),
    ("G101", 1, 1, "G101 needs an axis", "G101"),
    ("G0 X1\n%late", 2, 1, "first block", "%"),
    # words of one group
    ("G0 G1 X1", 1, 4, "exclude each other", "G1"),
    ("G90 X1 G91", 1, 8, "exclude each other", "G91"),
    ("G92 G100 X1", 1, 5, "exclude each other", "G100"),
    ("M2 M30", 1, 4, "exclude each other", "M30"),
    ("G1 G1", 1, 4, "exclude each other", "G1"),
    # commands
    ("N10 #MES MODE[1]", 1, 5, "unknown # command", "#MES MODE"),
    ("#CS OFF X10", 1, 1, "does not belong after #CS OFF", "X10"),
    ("#SLOPE TRAPEZ", 1, 1, "does not belong after #SLOPE", "TRAPEZ"),
    ("N10 #SLOPE", 1, 5, "#SLOPE needs its keywords in one bracket", None),
    ("N10 #SLOPE []", 1, 5, "#SLOPE needs its keywords in one bracket", None),
    ("N10 #SLOPE [NO_OPT=1]", 1, 5, "#SLOPE lacks TYPE", None),
    ("#MEAS MODE[0]", 1, 1, "no such measuring type", "0"),
    ("#MEAS MODE[8]", 1, 1, "no such measuring type", "8"),
    ("#MEAS MODE[5/2]", 1, 1, "no such measuring type", "2.5"),
    ("#MEAS MODE[1,2]", 1, 1, "wrong values", None),
    ("#MEAS MODE[1][2]", 1, 1, "wrong values", None),
    ("#SLOPE [TYPE=STEP][NO_OPT=1]", 1, 1, "wrong values", None),
    ("#DRIVE RD [AX=X KEY=A][P=P1]", 1, 1, "wrong values", None),
    ("#CS ON[1,2,3,4,5,6,7]", 1, 1, "wrong values", None),
    ('#CS ON[1,"a"]', 1, 1, "wrong values", None),
    ("#CS OFF[1]", 1, 1, "wrong values", None),
    # a letter where a number belongs would count as 0
    ("#CS ON[0,0,0,0,0,x]", 1, 18, "takes a number", "x"),
    ("#CS ON[a,0,0,0,0,45]", 1, 8, "takes a number", "a"),
    ("#CS ON[1][0,0,O]", 1, 15, "takes a number", "O"),
    ("#CS DEF[0,0,y]", 1, 13, "takes a number", "y"),
    ("#CS DEF[O][1,2,3]", 1, 9, "takes one ID", "O"),
    ("#CS ADD[WP][a,5,0]", 1, 13, "takes a number", "a"),
    ("#CS SET[WP][0,b]", 1, 15, "takes a number", "b"),
    ("#CS ADD[WP,3][1,5,0]", 1, 12, "takes one name", "3"),
    ("#CS ON[0,0,1 2]", 1, 14, "separated by a comma", "2"),
    ('#MSG ["%f", O]', 1, 13, "takes a number", "O"),
    ("#MSG", 1, 1, "wrong values", None),
    ("#MSG [1]", 1, 1, "wrong values", None),
    ('#MSG ["a",]', 1, 1, "wrong values", None),
    ('#MSG ["x %q"]', 1, 10, "unknown format", "%q"),
    ('#MSG ["x %"]', 1, 10, "unknown format", "%"),
    ('#MSG ["x %5", 1]', 1, 10, "unknown format", "%5"),
    ('#MSG ["%f"]', 1, 8, "number of format elements", "0 values"),
    ('#MSG ["a", 1]', 1, 8, "number of format elements", "1 values"),
    ('#MSG ["%s", 1]', 1, 8, "value 1 does not fit", "%s"),
    ('#MSG ["%f", "a"]', 1, 8, "value 1 does not fit", "%f"),
    ('#MSG ["%f" V.A.ABS.X]', 1, 12, "separated by a comma", "V.A.ABS.X"),
    # brackets, texts, line breaks
    ("N10 #CS ON[0,0,33\nN20 G1 X1", 1, 11, "not closed", "["),
    ("G1 F1\n#MEAS MODE[1", 2, 11, "not closed", "["),
    ("N10 #CS ON[0,0,33\nN20 G1 X1\nN30 ]", 1, 11, "not closed", "["),
    ("X10 ]", 1, 5, "no bracket is open", "]"),
    ("X10 )", 1, 5, "does not belong", ")"),
    ('#MSG ["a\nb"]', 1, 7, "not closed", '"a'),
    ("N10 \\", 1, 5, "line break", "\\"),
    ("X1 \\ Y2", 1, 4, "line break", "\\"),
    ("X=" + "[" * 21 + "1" + "]" * 21, 1, 23, "too deep", None),
    # expressions
    ("X==3", 1, 1, "has no value", "X"),
    ("X=", 1, 3, "not complete", None),
    ("X=2*(3+4)", 1, 5, "not complete", None),
    ("X=(3+4)*2", 1, 8, "does not belong", "*"),
    ("X=1+*2", 1, 5, "does not belong", "*"),
    ("X=SIN 3", 1, 3, "does not belong", "SIN"),
    ("X=SINE[3]", 1, 3, "unknown function", "SINE"),
    ("X=1/0", 1, 3, "division by zero", None),
    ("X=1+SQRT[-4]", 1, 3, "square root", None),
    ("X=TAN[90]", 1, 3, "tangent", None),
    ('X="abc"', 1, 1, "takes a number", "abc"),
    ('F="a"+"b"', 1, 1, "takes a number", "ab"),
    ('X="a"*2', 1, 3, "a text is no number", None),
    ("X=V.A.MES.Z", 1, 3, "unknown variable", "V.A.MES.Z"),
    ("X=V.A.MESS", 1, 3, "unknown variable", "V.A.MESS"),
    ("X=V.A.MESS.C", 1, 3, "no such axis", "C"),
    ("X" + "9" * 400, 1, 1, "too large", "999999999999.."),
    # signs that are no language
    ("G1 é", 1, 4, "does not belong", "é"),
    ("; MEAS\n\n ?", 3, 2, "does not belong", "?"),
]


@pytest.mark.parametrize(("text", "line", "column", "message", "value"), ERRORS)
def test_error_has_its_place_and_says_what_it_found(text, line, column, message, value):
    error = refused(text)
    assert (error.file, error.line, error.column) == ("p.nc", line, column)
    assert message in error.message
    assert error.value == value


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("X=V.A.MES.Z", "V.A.MESS.Z"),
        ("X=V.A.MEAS.ACS.Z", "V.A.MEAS.ACS.VALUE.Z"),
        ("#MES MODE[1]", "#MEAS MODE"),
        ("#CS OF", "#CS OFF"),
        ("X=SINE[3]", "SIN"),
        ("G1 X", "X10"),
        ("G1 Q1", "X, Y, Z"),
        ("X=2*(3+4)", "[ ] group"),
        ("G777", "G100"),
        ("#CS ON[0,0,O]", "0 meant?"),
        ('#MSG ["a",\nG1 = X10\n]', "#MSG"),
    ],
)
def test_error_tells_what_may_stand_there(text, found):
    assert found in str(refused(text))


def test_coordinate_system_needs_three_axes():
    assert "three main axes" in refused("#CS ON[0,0,1]", axes=("X", "Z")).message


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("N10 G0 X1 ; N20 G777\nN30 M30", [10, 30]),
        ("N10 (N20 G777) G0 X1", [10]),
        ("N10 (outer (inner) G777) G0 X1", [10]),
        ("N10 G0 X1 (open to the end\nN20 M30", [10, 20]),
        ("N10 G0 \\\nX1\nN20 M30", [10, 20]),
        ("N10 G0 \\ ; comment\nN15 X1\nN20 M30", [10, 20]),
        ('N10 #MSG ["%f",\n   1]\nN20 M30', [10, 20]),
        ('N10 #MSG ["a" ; comment ]\n]\nN20 M30', [10, 20]),
        ("N10G0X1Y2\r\nN20M30\r\n", [10, 20]),
        ("n10 g0 x1\n\n\tN 20 m30", [10, 20]),
        ("N10", [10]),
        ("% p (comment)\nN10 M30", [10]),
    ],
)
def test_comments_continuations_and_spellings(text, numbers):
    program = parse_program(text, axes=XYZ)
    assert [part.block.number for part in program.blocks] == numbers


def test_program_name_and_lines():
    program = parse_program("\n; head\n% PART 7 ; comment\n\nN5 G0 \\\n X1\nM30", axes=XYZ)
    assert program.name == "PART 7"
    assert [part.block.line for part in program.blocks] == [5, 7]


def test_coordinate_system_with_gaps_and_short_lists(run):
    """Gaps and missing values are zero: the manual's two spellings of one system are the same."""

    def target_mm(system):
        (move,) = [c for c in run(f"{system}\nG1 F100 X1 Y2 Z3") if isinstance(c, LinearMove)]
        return move.target_mm

    assert target_mm("#CS ON[,,10,,,45]") == target_mm("#CS ON[0,0,10,0,0,45]")
    assert target_mm("#CS ON[0,0,10]") == target_mm("#CS ON [0,0,10,0,0,0]")


def test_file_that_cannot_be_read(tmp_path):
    with pytest.raises(UserError, match=r"missing\.nc"):
        read_program(tmp_path / "missing.nc", XYZ)


def notes(text):
    program = parse_program(text, axes=XYZ)
    return [note.word for part in program.blocks for note in part.not_acting]


@pytest.mark.parametrize("kind", ["G", "M", "function"])
def test_every_word_of_the_table_is_read(kind):
    """What acts is read without a note; what does not act is noted by its name."""
    for word in words(kind).values():
        assert word.meaning
        assert word.source
        operands = ",".join(["1"] * int(word.group.partition("-")[0])) if kind == "function" else ""
        text = {"G": "{} X1", "M": "{}", "function": "X={}[" + operands + "]"}[kind]
        valued = kind == "G" and word.word in words("address") and word.word != "G4"
        written = f"{word.word}=1" if valued else word.word
        assert notes(text.format(written)) == ([] if word.acts else [word.word])


@pytest.mark.parametrize("function", ["SIZEOF[P1]", "EXIST[1]"])
def test_a_function_that_does_not_act_is_read_wherever_it_stands_in_an_expression(function):
    """What is constant about it is not computed: only a run that gets there ends."""
    word = function.partition("[")[0]
    for form in ("-{}", "NOT[{}]", "1+{}", "{}*2", "[2*{}]+1", "ABS[1-{}]", "MAX[1,{}]", "2*3-{}"):
        assert notes(f"X={form.format(function)}") == [word]


def test_every_variable_of_the_table_is_read():
    for row in variables():
        assert row.meaning
        assert row.source
        name = row.name.replace("<axis>", "X").replace("<name>", "ANY").replace("[]", "[1]")
        shown = row.name.replace("<axis>", "X").replace("<name>", "ANY")
        assert notes(f"X={name}") == ([] if row.acts else [shown])


@pytest.mark.parametrize(
    ("text", "ends"),
    [
        ("#SLOPE TRAPEZ", "#SLOPE [TYPE=name (NO_OPT=number)], what is in ( ) may be left out"),
        ("#SLOPE", "#SLOPE [TYPE=name (NO_OPT=number)], what is in ( ) may be left out"),
        ("#CS OFF X10", "allowed: nothing after it"),
        ("#MEAS MODDE", "nearest: #MEAS MODE, #MEAS DEFAULT, #CS MODE ON"),
        ("#AX", "allowed: #AX LINK, #AX LINK ON, #AX LINK OFF"),
        ("#XYZ 1", "found '#XYZ'; `axisrig language` lists them all"),
    ],
)
def test_an_unknown_command_gets_a_form_or_names_near_it_and_no_list_of_all(text, ends):
    assert str(refused(text)).endswith(ends)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("X=[1+\n2 3]", "line 1, column 3"),
        ("X=[1+\n[2*\n3 4]]", "line 2, column 1"),
        ("X=[1+[2]*\n3 4]", "line 1, column 3"),
        ("X=[1+\n[2 3]]", None),  # the innermost one is open in the line of the error
        ("X=[1+2 3]", None),
    ],
)
def test_an_error_behind_a_line_break_names_which_bracket_is_open(text, place):
    hint = refused(text).hint
    assert hint == (None if place is None else f"[ is open since {place}")
