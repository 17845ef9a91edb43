"""Values in the brackets of commands: their commas and places, and notes on some of them."""

import re

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def refused(text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    assert (caught.value.file, caught.value.line) == ("p.nc", 1)
    return caught.value


@pytest.mark.parametrize(
    "text",
    [
        "#KIN ID[9 98]", "#TRAFO [9, 98 1]", "#PUT AX [X Y]", "#PUT AX [Z, X Y]",
        '#MSG ["%d %d", 1 2]', '#MSG ["%d" 1]', "#DELETE V.P.A V.P.B", "#WAIT INDP [X Y, Z]",
    ],
)  # fmt: skip
def test_two_values_in_a_row_lack_their_comma(text: str) -> None:
    """The second of them is shown: with a comma before it the command is right."""
    error = refused(text)
    assert error.message == "two values are separated by a comma"
    assert error.allowed == "comma"
    at = error.column - 1
    assert text[at - 1] == " "
    assert text[at:].startswith(str(error.value))
    parse_program(f"V.P.A=1 V.P.B=1\n{text[: at - 1]},{text[at:]}", file="p.nc", axes=XYZ)


@pytest.mark.parametrize(
    ("joined", "message", "value"),
    [
        ("TYP3", "TYP out of range", "3"),
        ("DEC12", "DEC out of range", "12"),
        (f"VAL{'9' * 400}", "number too large", "999999999999.."),
    ],
)
def test_a_number_that_is_joined_to_its_keyword_has_its_own_place(
    joined: str, message: str, value: str
) -> None:
    word = joined.rstrip("0123456789")
    text = "#IDENT WR [AX X ID S-0-0092 VAL5 TYP2 DEC0 SERC]"
    text = re.sub(rf"{word}[0-9]+", joined, text)
    error = refused(text)
    assert (error.message, error.value) == (message, value)
    assert error.column == text.index(joined) + len(word) + 1


@pytest.mark.parametrize(
    ("text", "word", "near"),
    [
        ("#DRIVE WR [AX1 KEY=A VAL=1]", "AX1", "AX"),
        ("#DRIVE WR [AX=X KEY5 VAL=1]", "KEY5", "KEY"),
        ("#MEAS [EDGE1 AX=X]", "EDGE1", "EDGE"),
    ],
)
def test_a_number_is_joined_to_no_keyword_that_takes_a_name(
    text: str, word: str, near: str
) -> None:
    error = refused(text)
    assert (error.column, error.value) == (text.index(word) + 1, word)
    assert error.message == f"unknown keyword of {text.partition(' [')[0]}"
    assert error.hint == f"nearest: {near}"


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("#ROTATION ON [ANGLE=5 CENTER1=1 CENTER2=2]", "#ROTATION ON"),
        ("#WAIT [ID=1 CH=2]", "#WAIT"),
        ("#SIGNAL [ID=1 CH=2]", "#SIGNAL"),
        ("X[MC_TOUCHPROBE CHANNEL=1]", "X[MC_TOUCHPROBE]"),
    ],
)
def test_a_command_that_does_not_act_is_noted_without_its_keywords(text: str, word: str) -> None:
    program = parse_program(f"X1\nN5 {text}", file="p.nc", axes=XYZ)
    (noted,) = program.blocks[-1].not_acting
    assert (noted.word, noted.line, noted.column) == (word, 2, 4)
