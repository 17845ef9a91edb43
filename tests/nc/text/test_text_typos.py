"""Slips of the fingers: what was meant is told, and what stands behind them is still read."""

import pytest

from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.parser import read_program

XYZ = ("X", "Y", "Z")


def errors(text):
    return check_program(text, "p.nc", XYZ).errors


@pytest.mark.parametrize(
    ("text", "words"),
    [
        # the letter O for a zero
        ("G1 Z15O F100", "Z150 meant?"),
        ("M3O", "M30 meant?"),
        ("N1O G0 X1", "N10 meant?"),
        ("GO X10", "G0 meant?"),
        ("G1 X1O.5", "X10.5 meant?"),
        ("X=1O+3", "10 meant?"),
        ("#MEAS MODE[O]", "0 meant?"),
        # a decimal comma
        ("X10,5", "the decimal sign is a point"),
        ("G04 0,5", "the decimal sign is a point"),
        ("X=10,5", "the decimal sign is a point"),
        # comparisons and control words of other languages
        ("$IF P1=1\n$ENDIF", "equal is written =="),
        ("$WHILE P1=1\n$ENDWHILE", "equal is written =="),
        ("$IF P1 => 5\n$ENDIF", "at least is written >="),
        ("$IF P1 =< 5\n$ENDIF", "at most is written <="),
        ("$IF P1 <> 5\n$ENDIF", "not equal is written !="),
        ("$FOR P1=1,5\n$ENDFOR", "$FOR P1 = first, last, step"),
        ("IF P1 == 5\n$ENDIF", "$IF meant?"),
        ("$IF P1 == 5\nENDIF", "$ENDIF meant?"),
        ("P1=1\nGOTO [A]\n[A] M30", "$GOTO meant?"),
    ],
)
def test_what_was_meant_is_told_once(text, words):
    (error,) = errors(text)
    assert words in str(error)


CONDITIONS = {
    "$IF": "$IF {}\n$ENDIF",
    "$IF with a jump": "$IF {} $GOTO [A]\n[A] X1",
    "$ELSEIF": "$IF 1\n$ELSEIF {}\n$ENDIF",
    "$WHILE": "$WHILE {}\n$ENDWHILE",
    "$ENDDO": "$DO\n$ENDDO {}",
    "$UNTIL": "$REPEAT\n$UNTIL {}",
}


COMPARISONS = {
    "=": "equal is written ==",
    "=>": "at least is written >=",
    "=<": "at most is written <=",
    "<>": "not equal is written !=",
}


@pytest.mark.parametrize("head", ["", "N10 ", "/3 N10 ", "/ "])
@pytest.mark.parametrize("word", CONDITIONS)
def test_every_condition_knows_the_comparisons_of_other_languages(word, head):
    """Wherever it is in its block, with and without blanks, also in small letters."""
    lines = CONDITIONS[word].split("\n")
    at = next(place for place, line in enumerate(lines) if "{}" in line)
    for written, right in COMPARISONS.items():
        for condition in (f"P1 {written} 2", f"P1{written}2", f"[P1+1] {written} [2]"):
            block = head + lines[at].format(condition)
            for spelled in (block, block.lower()):
                found = errors("\n".join([*lines[:at], spelled, *lines[at + 1 :]]))
                assert [(error.line, error.hint) for error in found] == [(at + 1, right)], spelled


@pytest.mark.parametrize("word", ["$SWITCH {}\n$CASE 1", "$SWITCH 1\n$CASE {}"])
def test_what_chooses_by_a_value_compares_nothing(word):
    for condition in ("P1 = 2", "P1 => 2", "P1 <> 2"):
        (error,) = errors(f"{word.format(condition)}\n$ENDSWITCH")
        assert error.hint is None


@pytest.mark.parametrize("head", ["", "N10 ", "/3 N10 "])
@pytest.mark.parametrize("values", ["", " P1", " P1=1", " P1=1,5", " P1=1,5,1,2", " P1=0,5,1,5,1"])
def test_a_loop_with_too_few_or_too_many_values_shows_its_form(head, values):
    """A comma between two digits separates values here: it is no decimal comma."""
    (error,) = errors(f"{head}$FOR{values}\n$ENDFOR")
    assert (error.line, error.hint) == (1, "$FOR P1 = first, last, step")


@pytest.mark.parametrize(
    ("text", "column", "hint"),
    [
        ("v.p.x: REAL64", 6, "a variable gets its type between #VAR and #ENDVAR"),
        ("V.P.X : UNS32", 7, "a variable gets its type between #VAR and #ENDVAR"),
        ("G1 X1:Y2", 6, None), ("$IF P1 : 2\n$ENDIF", 8, None),
        ("$IF $ELSE\n$ENDIF", 5, None),
        ("G1 XO", 4, "X0 meant? It has a letter O"), ("xo5", 1, "x05 meant? It has a letter O"),
        ("G1 X1 YOO1", 7, "Y001 meant? It has a letter O"),
    ],
)  # fmt: skip
def test_a_slip_is_that_of_its_own_place(text, column, hint):
    error = errors(text)[0]
    assert (error.column, error.hint) == (column, hint)


@pytest.mark.parametrize(
    "text",
    [
        *("G1 Q1", "G777 X10", "G1 X ?", "X=SIN[3,5]", "$IF 1 2\n$ENDIF"),
        *("G1 X,5", "G1 X1,Y2", "G1 X1, 5"),
    ],
)
def test_no_slip_is_seen_where_none_is(text):
    words = str(errors(text)[0])
    assert "meant?" not in words
    assert "written" not in words
    assert "decimal" not in words


@pytest.mark.parametrize(
    "text", ["#MEAS MODE[O]", "#TIME[abc]", "#KIN ID[O]", "#ENABLE AX LINK[O]"]
)
def test_a_command_without_keywords_says_what_it_takes(text):
    (error,) = errors(text)
    assert "takes a number or an expression" in error.message
    assert "P1" in str(error)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("P4=[3+4\nG777\nG0 X1\nM30", [1, 2]),
        ("P4=[3+4\nP5=[3\nG777", [1, 2, 3]),
        ("X=[[1+2]\nG0 X1\nX=SINE[3]\nX[1]", [1, 3]),
        ("G0 X1\nX=[1", [2]),
    ],
)
def test_a_bracket_that_nothing_closes_hides_its_own_line_only(text, lines):
    found = errors(text)
    assert [error.line for error in found] == lines


def test_a_command_to_an_axis_is_told_with_both_brackets():
    (error,) = errors("X[INDP_SYN G0]")
    assert error.message == "X[INDP_SYN ..] lacks POS"


def test_comments_of_an_old_editor_do_not_hinder(tmp_path):
    file = tmp_path / "p.nc"
    file.write_bytes("G0 X1 ; zurück\n(Übergang)\nM30\n".encode("latin-1"))
    assert len(read_program(file, XYZ).blocks) == 2


def test_a_sign_beyond_ascii_in_code_has_its_place(tmp_path):
    file = tmp_path / "p.nc"
    file.write_bytes("G0 X1\nG0 Xü\n".encode("latin-1"))
    with pytest.raises(Exception, match=r"p\.nc:2:4") as caught:
        read_program(file, XYZ)
    assert "    2 | G0 Xü" in caught.value.excerpt


def test_what_is_no_text_is_told_with_its_line_and_what_to_do(tmp_path):
    file = tmp_path / "p.nc"
    file.write_bytes(b"\xff\nG0\0")
    with pytest.raises(Exception, match=r"p\.nc:2") as caught:
        read_program(file, XYZ)
    assert "save it as UTF-8" in str(caught.value)


def test_a_type_is_told_with_those_there_are():
    (error,) = errors("#VAR\nV.P.X : INT\n#ENDVAR\nM30")
    assert "UNS32, REAL64, STRING" in str(error)
    (error,) = errors("V.P.X : UNS32")
    assert "between #VAR and #ENDVAR" in str(error)
