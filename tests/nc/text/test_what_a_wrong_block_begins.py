"""A block with an error still begins, ends and names what it says: that is no second error."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.check import check_program

XYZ = ("X", "Y", "Z")
ENDS = {
    "$IF": "$ENDIF", "$FOR": "$ENDFOR", "$WHILE": "$ENDWHILE", "$SWITCH": "$ENDSWITCH",
    "$DO": "$ENDDO 1", "$REPEAT": "$UNTIL 1",
}  # fmt: skip
BEGINS = {"$DO": "$DO", "$REPEAT": "$REPEAT", "$FOR": "$FOR P1=1,2,1"}
WRONG = ("P1 = 2", "[P1+1] = 2", " [P1] 2", "P1 ? 2", "V.X.NONE == 1", "[1, 2]")


def errors(*lines: str) -> list[UserError]:
    return list(check_program("\n".join([*lines, "M30"]), "p.nc", XYZ).errors)


def only(*lines: str) -> UserError:
    (error,) = errors(*lines)
    return error


@pytest.mark.parametrize("head", ["", "N10 ", "N 10", "/N10 ", "/3 "])
@pytest.mark.parametrize("begin", ENDS)
def test_a_wrong_condition_begins_its_structure(begin: str, head: str) -> None:
    for wrong in WRONG:
        block = f"{head}{begin} {wrong}"
        for spelled in (block, block.lower()):
            error = only("G0 X1", spelled, "X2", ENDS[begin])
            assert error.line == 2, spelled


@pytest.mark.parametrize("begin", ENDS)
def test_what_a_wrong_block_begins_has_to_be_closed(begin: str) -> None:
    opened, wrong = errors(f"{begin} P1 ? 2", "X2")
    assert (opened.line, opened.column, wrong.line) == (1, 1, 1)
    assert opened.message == f"{begin} is not closed"
    assert wrong.column > 1


@pytest.mark.parametrize("word", ["IF", "WHILE", "SWITCH", "for", "Repeat"])
def test_a_control_word_without_its_sign_begins_its_structure(word: str) -> None:
    error = only(f"{word} P1 == 2", "X2", ENDS[f"${word.upper()}"])
    assert (error.line, error.hint) == (1, f"${word.upper()} meant?")


@pytest.mark.parametrize("block", ["DO = 5", "IF[1] = 5", "FOR=P1"])
def test_a_word_with_a_value_is_an_address_and_begins_nothing(block: str) -> None:
    assert only(block, "X2").line == 1


@pytest.mark.parametrize("begin", ENDS)
def test_a_wrong_end_ends_its_structure(begin: str) -> None:
    end = ENDS[begin].split()[0]
    opened = BEGINS.get(begin, f"{begin} 1")
    for wrong in ("P1 ? 2", "[P1] = 2", "= 5"):
        error = only(opened, f"N5 {end} {wrong}", "X2")
        assert error.line == 2


def test_a_wrong_end_ends_no_other_structure() -> None:
    """Neither the one around its own nor one of another word."""
    assert only("$IF 1", "$FOR P1=1,2,1", "$ENDIF ?", "$ENDFOR", "$ENDIF").line == 3
    assert only("$WHILE 1", "$IF 1", "$ENDIF ?", "$ENDWHILE").line == 3
    assert only("$ENDIF ?").line == 1


@pytest.mark.parametrize("condition", ["P1 = 2", "[P1] = 2"])
def test_a_wrong_condition_of_a_jump_begins_nothing(condition: str) -> None:
    for word in ("$GOTO", "$goto"):
        assert only("[A] X1", f"$IF {condition} {word} [A]", "X2").line == 2


@pytest.mark.parametrize(
    ("block", "target"),
    [
        ("N10: G777", "N10"), ("N 10 : G777", "N10"), ("N010: G777", "N10"), ("[A] G777", "[A]"),
        ("[ A ] G777", "[A]"), ("/2 N10: G777", "N10"),
    ],
)  # fmt: skip
def test_a_wrong_block_has_its_label(block: str, target: str) -> None:
    error = only("X1", block, f"$GOTO {target}")
    assert (error.line, error.value) == (2, "G777")


def test_a_wrong_block_without_a_label_has_none() -> None:
    found = errors("N10 G777", "$GOTO N10")
    assert [error.value for error in found] == ["G777", "N10"]


def test_a_branch_of_a_wrong_block_is_one_of_its_structure() -> None:
    assert only("$IF P1 = 2", "$ELSEIF 1", "$ELSE", "$ENDIF").line == 1
    assert only("$SWITCH [P1] = 2", "$CASE 1", "$BREAK", "$DEFAULT", "$ENDSWITCH").line == 1
    assert only("$WHILE [P1] = 2", "$CONTINUE", "$BREAK", "$ENDWHILE").line == 1
