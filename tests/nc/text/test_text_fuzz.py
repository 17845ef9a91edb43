"""Whatever a file holds: it is read, or refused at a place inside it; nothing else happens."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.words import commands, variables, words

XYZ = ("X", "Y", "Z")

SIGNS = [*'[](),"+-*/=;\\\n %$#\t.:!<>&|^@', "**", "==", "&&", "||", "1", ".5", "-2.25", "1e9", "é"]
WORDS = [
    *(
        "N10",
        "N20:",
        "Nxx",
        "/",
        "/3 N5",
        "%L UP",
        "%MAIN",
        "LL UP",
        "L gup.nc",
        "L CYCLE",
        "[LBL]",
    ),
    *("X10", "X=", "Y-1.5", "XP1", "ZV.P.A", "F100", "I5", "R-3", "T1", "D2", "P1=", "P[2]", "@P4"),
    *(
        "X[",
        "Z[DIST_CTRL ",
        "X[INDP_SYN ",
        "V.P.A[1]",
        "TRUE",
        "MOD",
        "AND",
        "S-0-0092",
        "0x6072_00",
    ),
    *("#COMMENT BEGIN", "#COMMENT END", "\\\n", '"%f"', '"%s'),
]
TABLES = [
    *(word for kind in ("G", "M", "function", "control") for word in words(kind)),
    *(f"#{name}" for name in commands()),
    *(f"{keyword}=" for table in commands().values() for keyword in table if keyword),
    *(row.name.replace("<axis>", "X").replace("<name>", "A") for row in variables()),
]
PIECES = st.one_of(st.sampled_from(SIGNS), st.sampled_from(WORDS), st.sampled_from(TABLES))


def check_any_text(text):
    """No exception, and every error lies inside the text so that an editor can jump to it."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    found = check_program(text, "p.nc", XYZ)
    for error in found.errors:
        assert 1 <= error.line <= len(lines)
        assert 1 <= error.column <= len(lines[error.line - 1]) + 1
        assert error.excerpt is not None
        assert str(error)
    for note in found.notes:
        assert 1 <= note.line <= len(lines)


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=80))
@example("X=" + "-" * 10_000 + "1")
@example("X=" + "+".join(["V.A.ABS.X"] * 3000))
@example("X=" + "2**" * 10_000 + "1")
@example("X=1" + "&&1||0 XOR 1 == 1 | 1 ^ 1 & 1 + 1 * 1" * 500)
@example("X=" + "[" * 20 + "1" + "]" * 20)
@example("[" * 10_000)
@example("(" * 10_000)
@example("#CS ON" + "[0," * 10_000)
@example("X=" + "SIN[" * 10_000)
@example("$IF 1\n" * 10_000)
@example("#COMMENT BEGIN\n" * 5000)
@example("%L A\n" * 1000)
@example("G1 " * 20_000)
@example("N" + "9" * 5000)
@example("G" + "9" * 5000)
@example("X" + "9" * 100_000)
@example("X=0x" + "F" * 5000)
@example("/" + "9" * 5000 + " G0")
@example("P" + "9" * 5000 + "=1")
@example("X=P" + "9" * 5000)
@example('#MSG ["%' + "9" * 30 + 'f", 1]')
@example("$GOTO N" + "9" * 5000)
@example("\x0b\x85 \u2028")
@example("X\u0661")
@example("N\u00b2 G0")
@example("V.P.\u0130=1")
@pytest.mark.long
def test_any_text_is_accepted_or_refused(text):
    check_any_text(text)


@pytest.mark.long
@settings(max_examples=1000, deadline=None)
@given(st.lists(PIECES, max_size=25).map("".join))
def test_any_mix_of_words_is_accepted_or_refused(text):
    check_any_text(text)


@settings(max_examples=500, deadline=None)
@given(st.lists(PIECES, max_size=25).map(" ".join))
@pytest.mark.long
def test_any_mix_of_words_with_blanks_is_accepted_or_refused(text):
    check_any_text(text)
