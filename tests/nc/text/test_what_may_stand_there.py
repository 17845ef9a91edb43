"""What a syntax error lists as allowed can stand at its place, and what can is listed."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.check import check_program

XYZ = ("X", "Y", "Z")
OPERAND = ("number", "variable", "function", 'text in "', "+", "-", "[")
OPERATORS = ("+", "-", "operator such as * or ==")
END = "end of the block"
BEHIND_WORDS = ("word such as G1 or X10", "$GOTO", END)
TYPES = "BOOLEAN, SGN08, SGN16, SGN32, UNS08, UNS16, UNS32, REAL64, STRING"
SAMPLES = {
    "block number": "N5", "label in [ ]": "[A]", "# command": "#CS OFF",
    "word such as G1 or X10": "Y10", "number": "7", "variable": "P7", "function": "SIN[1]",
    'text in "': '"a"', "control structure ($)": "$IF 1", "$GOTO": "$GOTO [A]", "+": "+", "-": "-",
    "operator such as * or ==": "*", "comma": ",", "[": "[", "]": "]", "=": "=", ":": ":",
    TYPES: "REAL64", END: "",
}  # fmt: skip
WRONG = "this does not belong here"

# (text, column, what is wrong there, all that is allowed there)
PLACES = [
    ("$ELSE 1", 7, "1", (END,)),
    ("$ENDIF G0", 8, "G0", (END,)),
    ("$IF P1 :\n$ENDIF", 8, ":", ("$GOTO", *OPERATORS, END)),
    ("$IF 1 $IF\n$ENDIF", 7, "$", ("$GOTO", *OPERATORS, END)),
    ("$WHILE 1 :\n$ENDWHILE", 10, ":", (*OPERATORS, END)),
    ("$CASE P1 :", 10, ":", (*OPERATORS, END)),
    ("$UNTIL 1 :", 10, ":", (*OPERATORS, END)),
    ("$GOTO 5", 7, "5", ("block number", "label in [ ]")),
    ("$GOTO G1", 7, "G1", ("block number", "label in [ ]")),
    ("$GOTO", 6, "", ("block number", "label in [ ]")),
    ("$FOR P1 $IF\n$ENDFOR", 9, "$", ("=",)),
    ("$FOR P1 = 1,2,1 7\n$ENDFOR", 17, "7", (END,)),
    ("G1 , 5", 4, ",", BEHIND_WORDS),
    ("G1 X1 $IF 1", 7, "$", BEHIND_WORDS),
    ("X=1+*2", 5, "*", OPERAND),
    ("X=SIN 3", 3, "SIN", OPERAND),
    ("X=", 3, "", OPERAND),
    ("P1 = = 3", 6, "=", OPERAND),
    ("$WHILE $IF\n$ENDWHILE", 8, "$", (*OPERAND, END)),
    ("$CASE $IF", 7, "$", OPERAND),
    ("$DO 5\n$ENDDO 1", 5, "5", (END,)),
    ("L A B", 5, "B", (END,)),
]


def error_of(text: str) -> UserError | None:
    """The first error of a program; None where there is none."""
    return next(iter(check_program(text, "p.nc", XYZ).errors), None)


def refused(text: str) -> UserError:
    error = error_of(text)
    assert error is not None
    return error


def names(error: UserError) -> list[str]:
    """What is listed as allowed; the types of a variable are one name."""
    listed = str(error.allowed).replace(TYPES, "<types>").split(", ")
    return [name.replace("<types>", TYPES) for name in listed]


# More places: what is listed there need not be all
MORE = [
    "é", "N10 é", "/ é", "/3 N5 é", "N10 : :", "[A] ,", "[A] [B] G0 X1", "G1 X1 é", "P1 $IF",
    "V.P.A $IF", "SIN[1] :", "#CS OFF 1 :", "#CS OFF [1] *", "$CASE $IF", "$UNTIL 1 :", "L A B",
    "$IF P1 :\n$ENDIF", "$FOR P1 = 1,2,1 7\n$ENDFOR", "$SWITCH 1 2\n$ENDSWITCH", "LL", "X=1 +",
    "#VAR\nV.P.A : FOO\n#ENDVAR", "#VAR\nV.P.A = [1 3]\n#ENDVAR", "#VAR\nG1\n#ENDVAR",
    "#VAR\nV.P.A 7\n#ENDVAR", "$DO 5\n$ENDDO 1", "X=[1+]", "P1=1 P2=", "X=MAX[1,2 3]", "X=2*(3)",
]  # fmt: skip


@pytest.mark.parametrize(("text", "column", "value", "allowed"), PLACES)
def test_all_that_may_stand_there_is_listed_and_nothing_else(
    text: str, column: int, value: str, allowed: tuple[str, ...]
) -> None:
    error = refused(text)
    assert (error.line, error.column, error.value) == (1, column, value or None)
    assert error.message == (WRONG if value else "the block is not complete")
    assert sorted(names(error)) == sorted(allowed)


@pytest.mark.parametrize("text", [*(row[0] for row in PLACES), *MORE])
def test_what_is_listed_can_stand_there(text: str) -> None:
    """With each of them in its place the block may be wrong further on, but no more there."""
    error = refused(text)
    assert error.line is not None
    assert error.column is not None
    *before, line = text.split("\n")[: error.line]
    head = line[: error.column - 1]
    for name in names(error):
        written = head.rstrip() if name == END else f"{head}{SAMPLES[name]}"
        found = error_of("\n".join([*before, written]))
        if found is None:
            continue
        at_place = (found.line, found.column) == (error.line, error.column)
        is_refused = found.message == WRONG or "label is a block number" in found.message
        assert not (at_place and is_refused), (name, str(found))
        assert name != END or "not complete" not in found.message, str(found)


@pytest.mark.parametrize(
    "text", ["$GOTO", "$CASE", "N5 $UNTIL", "$ GOTO", "/2 $SWITCH\n$ENDSWITCH", "$GOTO 5"]
)
def test_a_word_that_has_its_dollar_is_not_asked_for_it(text: str) -> None:
    assert "meant?" not in str(refused(text))


@pytest.mark.parametrize(
    ("text", "word"), [("GOTO [A]", "$GOTO"), ("G0 X1 GOTO [A]", "$GOTO"), ("N5 ENDIF", "$ENDIF")]
)
def test_a_word_without_its_dollar_is(text: str, word: str) -> None:
    assert f"{word} meant?" in str(refused(text))
