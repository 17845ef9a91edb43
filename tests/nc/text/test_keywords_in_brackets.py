"""Keywords and values in the brackets of commands: how they are separated, and what is no value.

Between a keyword and its value is `=` or a blank, or nothing before a number (208612235).
"""

from typing import Any

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Command, Name, Number, Option, Text, Variable
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def statement(text: str) -> Any:
    return parse_program(text, file="p.nc", axes=XYZ).blocks[-1].statement


def options(text: str) -> list[tuple[str, Option]]:
    found = statement(text)
    if not isinstance(found, Command) and getattr(found, "axis_commands", ()):
        (found,) = found.axis_commands
    return list(getattr(found, "options", None) or found.arguments)


def refused(text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    assert (caught.value.file, caught.value.line) == ("p.nc", 1)
    return caught.value


# A keyword and its value


@pytest.mark.parametrize("written", ["POS=10", "POS 10", "POS10", "POS = 10", "pos10", "Pos=10"])
def test_a_value_follows_its_keyword_in_three_ways(written: str) -> None:
    for text in (f"X[INDP_SYN G0 {written}]", f"X[INDP_SYN {written} G0]"):
        assert ("POS", Number(10.0)) in options(text)


@pytest.mark.parametrize(
    ("written", "value"), [("POS10.5", 10.5), ("POS=-3", -3.0), ("POS -3", -3.0)]
)
def test_a_number_may_have_a_point_and_a_sign(written: str, value: float) -> None:
    assert ("POS", Number(value)) in options(f"X[INDP_SYN G0 {written}]")


def test_the_next_keyword_is_no_value() -> None:
    """Whatever follows: `=` and a value, a joined number, or nothing at all."""
    for before, word, behind in (
        ("#SLOPE [", "TYPE", " NO_OPT=1]"),
        ("#SLOPE [NO_OPT=1 ", "TYPE", "]"),
        ("#MEAS [", "AX", " INPUT=1]"),
        ("#MEAS [AX=X ", "INPUT", " EDGE=POS]"),
        ("#MEAS [AX=X ", "EDGE", "]"),
        ("#DRIVE WR SYN [", "AX", " KEY=A VAL=1]"),
        ("#DRIVE WR SYN [AX=X ", "KEY", " VAL=1]"),
        ("#DRIVE WR SYN [AX=X KEY=A ", "VAL", "]"),
        ("#IDENT RD [AX=X ID S-0-0092 ", "P", " TYP=2 DEC=0 SERC]"),
        ("#IDENT RD [AX=X ID S-0-0092 P=P1 ", "TYP", " DEC=0 SERC]"),
        ("#ERROR [", "ID", " RC=2]"),
        ("#ERROR [ID=1 ", "PV1", " PM1=2]"),
        ("X[INDP_SYN G0 ", "POS", " ACC_WEIGHT=50]"),
        ("X[INDP_SYN G1 POS=1 ", "FEED", " SLOPE_TYPE=STEP]"),
        ("L CYCLE [", "NAME", " @P1=2]"),
        ("N5 #SLOPE [", "TYPE", " NO_OPT=1]"),
    ):
        error = refused(f"{before}{word}{behind}")
        assert error.message == f"{word} has no value", before
        assert (error.column, error.value) == (len(before) + 1, word)
        assert error.allowed


@pytest.mark.parametrize("word", ["G1", "G91", "INCL_OFFSETS", "M8"])
def test_a_flag_has_no_value(word: str) -> None:
    error = refused(f"X[INDP_SYN G0 POS=1 {word}=3]")
    assert error.message == f"{word} takes no value"
    assert (error.column, error.value) == (21, word)


def test_what_follows_a_flag_is_a_keyword_of_its_own() -> None:
    found = options("#DRIVE WR SYN [WAIT AX=X KEY=A VAL=1]")
    assert found == [("WAIT", None), ("AX", Name("X")), ("KEY", Name("A")), ("VAL", Number(1.0))]


@pytest.mark.parametrize(("written", "word"), [("G00", "G0"), ("g001", "G1"), ("M08", "M8")])
def test_a_function_may_have_zeros_before_its_number(written: str, word: str) -> None:
    speed = " FEED=5" if word == "G1" else ""
    other = "" if word[0] == "G" else " G0"
    assert (word, None) in options(f"X[INDP_SYN {written} POS=1{speed}{other}]")


def test_only_what_may_be_many_may_be_there_twice() -> None:
    found = options("X[INDP_SYN G0 POS=1 H=3 H=5]")
    assert [value for word, value in found if word == "H"] == [Number(3.0), Number(5.0)]
    for text, column, word in (
        ("X[INDP_SYN G0 POS=1 POS=2]", 21, "POS"),
        ("X[INDP_SYN G0 POS1 POS2]", 20, "POS"),
        ("#ERROR [ID=1 RC=2 ID 3]", 19, "ID"),
        ("#SLOPE [TYPE STEP TYPE=STEP]", 19, "TYPE"),
    ):
        error = refused(text)
        assert error.message == "keyword twice in one command"
        assert (error.column, error.value) == (column, word)


# Ranges


RANGES = [
    # (before the value, after it, allowed, refused, range)
    ("#IDENT WR SYN [AX=X ID S-0-0092 VAL=1 DEC=0 SERC TYP=", "]", "2 4", "1 3 5 0", "2 4"),
    ("#IDENT WR SYN [AX=X ID S-0-0092 VAL=1 TYP=2 SERC DEC=", "]", "0 9", "10 9.5 -1", "0..9"),
    ("#SLOPE [TYPE=STEP NO_OPT=", "]", "0 1", "2 0.5 -1", "0 1"),
    ("#MEAS [ERR_NO_SIGNAL=", "]", "0 1", "2 0.5 -1", "0 1"),
    ("#MEAS [TYPE=", "]", "1 7", "0 8 1.5", "1 2 3 4 5 6 7"),
    ("#DIST CTRL ON [KP=", "]", "0 2 1.5", "2.001 -0.001", "0..2"),
    ("#DIST CTRL ON [D_TV=", "]", "0 2", "2.001 -0.001", "0..2"),
]


@pytest.mark.parametrize(("head", "tail", "taken", "out", "allowed"), RANGES)
def test_a_value_may_be_the_first_and_the_last_of_its_range(
    head: str, tail: str, taken: str, out: str, allowed: str
) -> None:
    keyword = head[:-1].rsplit(maxsplit=1)[-1].strip("[")
    for value in taken.split():
        assert (keyword, Number(float(value))) in options(f"{head}{value}{tail}")
    for value in out.split():
        error = refused(f"{head}{value}{tail}")
        assert error.message == f"{keyword} out of range"
        assert (error.column, error.value) == (len(head) + 1, value)
        assert str(error.allowed) == allowed


# Kinds


@pytest.mark.parametrize(
    ("text", "column", "message", "allowed"),
    [
        ("#MEAS [AX=1 INPUT=1]", 11, "AX takes an axis of the rig", "AX=axis"),
        ("#MEAS [AXNR=X INPUT=1]", 13, "AXNR takes a number or an expression", "AXNR=number"),
        ('#DRIVE WR SYN [AX=X KEY=A VAL="1"]', 31, "VAL takes a number or an expression",
         "VAL=number"),
        ("#DRIVE WR SYN [AX=X KEY=7 VAL=1]", 25, "KEY takes a name", "KEY=name"),
        ("#IDENT RD [AX=X ID S-0-0092 P=3 TYP=2 DEC=0 SERC]", 31, "P takes a variable",
         "P=variable"),
        ("#MEAS [AX=X EDGE=1]", 18, "EDGE takes a name", "POS, NEG"),
        ("#MEAS [AX=X EDGE=UP]", 18, "EDGE takes a name", "POS, NEG"),
        ("#SLOPE [TYPE=3]", 14, "TYPE takes a name", "TYPE=name"),
    ],
)  # fmt: skip
def test_a_value_of_another_kind_names_what_is_taken(
    text: str, column: int, message: str, allowed: str
) -> None:
    error = refused(text)
    assert (error.message, error.column) == (message, column)
    assert str(error.allowed) == allowed


def test_values_of_each_kind() -> None:
    """Axes as the rig spells them, names in capitals, idents as they are written."""
    assert options("#MEAS [ax=y edge=neg input=Probe1]") == [
        ("AX", Name("Y")), ("EDGE", Name("NEG")), ("INPUT", Name("PROBE1")),
    ]  # fmt: skip
    assert options("#DRIVE WR SYN [AX=x KEY=Mon_Window VAL=1]")[1] == ("KEY", Name("Mon_Window"))
    found = options('#ERROR [ID=1 PM1="low" PM2=P3]')
    assert [value for _, value in found[1:]] == [Text("low"), Variable("P[]", (Number(3.0),))]


def test_an_axis_that_the_rig_does_not_have_names_those_it_has() -> None:
    error = refused("#MEAS [AX=W INPUT=1]")
    assert error.message == "the rig has no such axis"
    assert (error.column, error.value, error.allowed) == (11, "W", "X, Y, Z")


@pytest.mark.parametrize(
    ("text", "column", "hint"),
    [
        ("#MEAS [AX=X EGDE=POS]", 13, "nearest: EDGE"),
        ("#MEAS [AX=X EDGE=PSO]", 18, "nearest: POS"),
        ("#MEAS [AX=X EGDE POS]", 13, "nearest: EDGE"),
        ("#DRIVE WR SYN [AX=X KEY=A VLA=1]", 27, "nearest: VAL"),
        ("#MEAS [AX=X TORQUE=1]", 13, None),
        ("#SLOPE [TPYE=STEP]", 9, "nearest: TYPE"),
        ("#DRIVE WR SYN [AX=X KEY=LAG WINDOW VAL=1]", 29, "names have no blanks: LAG_WINDOW?"),
        ("#SLOPE [TYPE=STEP XXX=1]", 19, "names have no blanks: STEP_XXX?"),
    ],
)
def test_a_slip_in_a_keyword_or_a_name_has_a_hint(text: str, column: int, hint: str | None) -> None:
    error = refused(text)
    assert (error.column, error.hint) == (column, hint)


# What is lacking


@pytest.mark.parametrize(
    ("text", "lacking"),
    [
        ("#DRIVE WR SYN [AX=X KEY=A]", "VAL"),
        ("#DRIVE WR SYN [AX=X VAL=1]", "KEY"),
        ("#DRIVE WR SYN [KEY=A VAL=1]", "AX or AXNR"),
        ("#DRIVE WR SYN [VAL=1]", "AX or AXNR and KEY"),
        ("#DRIVE WAIT SYN [SWITCH_OK]", "AX or AXNR"),
        ("#SLOPE [NO_OPT=0]", "TYPE"),
        ("#COMMAND WR [AX=X]", "ID"),
        ("L CYCLE [@P1=2]", "NAME"),
    ],
)
def test_all_keywords_that_are_lacking_are_named(text: str, lacking: str) -> None:
    error = refused(text)
    assert error.message.endswith(f" lacks {lacking}")
    assert error.column == 1


@pytest.mark.parametrize("axis", ["AX=X", "AXNR=1", "AXNR 1"])
def test_either_name_or_number_of_an_axis_will_do(axis: str) -> None:
    assert len(options(f"#DRIVE WR SYN [{axis} KEY=A VAL=1]")) == 3
