"""Control structures one inside the other: which one is open, and in which order errors come."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.structure import DEPTH_MAX, ERRORS_MAX

XYZ = ("X", "Y", "Z")
BEGINS = {
    "$IF": "$IF 1", "$FOR": "$FOR P1 = 1, 2, 1", "$WHILE": "$WHILE 1", "$DO": "$DO",
    "$REPEAT": "$REPEAT", "$SWITCH": "$SWITCH 1",
}  # fmt: skip
ENDS = {
    "$IF": "$ENDIF", "$FOR": "$ENDFOR", "$WHILE": "$ENDWHILE", "$DO": "$ENDDO 1",
    "$REPEAT": "$UNTIL 1", "$SWITCH": "$ENDSWITCH",
}  # fmt: skip
WORDS = {begin: end.split()[0] for begin, end in ENDS.items()}
LOOPS = ("$FOR", "$WHILE", "$DO", "$REPEAT")


def errors(*lines: str) -> tuple[UserError, ...]:
    return tuple(check_program("\n".join(lines), "p.nc", XYZ).errors)


def only(*lines: str) -> UserError:
    (error,) = errors(*lines)
    return error


def around(*outer: str, inside: str) -> list[str]:
    """Lines of nested structures with one line in the innermost."""
    return [*(BEGINS[each] for each in outer), inside, *(ENDS[each] for each in reversed(outer))]


@pytest.mark.parametrize("begin", BEGINS)
@pytest.mark.parametrize("wrong", BEGINS)
def test_each_structure_is_ended_by_its_own_word_alone(begin: str, wrong: str) -> None:
    if wrong == begin:
        assert errors(BEGINS[begin], ENDS[begin]) == ()
        return
    error = only("G0 X1", BEGINS[begin], f"N5 {ENDS[wrong]}", ENDS[begin])
    assert error.message == f"{WORDS[wrong]} without {wrong}"
    assert (error.line, error.column, error.value) == (3, 4, WORDS[wrong])
    assert error.hint == f"open is {begin} of line 2"


@pytest.mark.parametrize("inner", BEGINS)
def test_the_innermost_structure_is_the_one_that_is_open(inner: str) -> None:
    """Whatever is around it; once it is closed, the one around it is open."""
    outer = next(each for each in BEGINS if each != inner)
    other = next(each for each in BEGINS if each not in (inner, outer))
    error = only(BEGINS[outer], BEGINS[inner], ENDS[other], ENDS[inner], ENDS[outer])
    assert (error.line, error.hint) == (3, f"open is {inner} of line 2")
    error = only(BEGINS[outer], BEGINS[inner], ENDS[inner], ENDS[other], ENDS[outer])
    assert (error.line, error.hint) == (4, f"open is {outer} of line 1")
    error = only(BEGINS[outer], ENDS[outer], ENDS[inner])
    assert (error.line, error.hint) == (3, None)


def test_a_word_behind_three_structures_names_the_third() -> None:
    error = only("$FOR P1=1,2,1", "$WHILE 1", "$SWITCH 1", "$ELSE", "$ENDSWITCH", "$ENDWHILE",
                 "$ENDFOR")  # fmt: skip
    assert (error.message, error.hint) == ("$ELSE without $IF", "open is $SWITCH of line 3")


def test_each_part_of_a_program_has_structures_of_its_own() -> None:
    error = only("%L UP", "$IF 1", "$ENDIF", "M17", "%MAIN", "$ENDIF", "M30")
    assert (error.line, error.hint) == (6, None)
    first, second = errors("%L UP", "$WHILE 1", "M17", "%MAIN", "$ENDWHILE", "M30")
    assert (first.line, first.message) == (2, "$WHILE is not closed")
    assert (second.line, second.hint) == (5, None)


@pytest.mark.parametrize("begin", BEGINS)
@pytest.mark.parametrize(
    ("word", "line", "home"),
    [
        ("$ELSEIF", "$ELSEIF 1", "$IF"), ("$ELSE", "$ELSE", "$IF"),
        ("$CASE", "$CASE 1", "$SWITCH"), ("$DEFAULT", "$DEFAULT", "$SWITCH"),
    ],
)  # fmt: skip
def test_a_branch_belongs_to_its_own_structure(begin: str, word: str, line: str, home: str) -> None:
    """Directly: not through another one that is open inside."""
    assert errors(*around(home, inside=line)) == ()
    if begin == home:
        return
    error = only(*around(home, begin, inside=line))
    assert (error.line, error.message, error.value) == (3, f"{word} without {home}", word)
    assert error.hint == f"open is {begin} of line 2"


@pytest.mark.parametrize("begin", BEGINS)
def test_break_leaves_a_loop_or_a_switch_and_continue_a_loop(begin: str) -> None:
    """Also from inside an $IF; an $IF alone is neither."""
    for word, homes in (("$BREAK", (*LOOPS, "$SWITCH")), ("$CONTINUE", LOOPS)):
        for nested in ((begin,), (begin, "$IF"), ("$IF", begin)):
            found = errors(*around(*nested, inside=word))
            if begin in homes:
                assert found == ()
                continue
            (error,) = found
            assert (error.message, error.value) == (f"{word} is in no loop", word)
            assert error.line == len(nested) + 1
            assert error.allowed == f"inside {', '.join(homes)}"
    assert errors(*around("$WHILE", "$SWITCH", inside="$CONTINUE")) == ()


@pytest.mark.parametrize("begin", BEGINS)
def test_what_is_not_closed_names_the_word_that_closes_it(begin: str) -> None:
    error = only("G0 X1", f"N7 {BEGINS[begin]}", "G0 X2")
    assert (error.line, error.column) == (2, 4)
    assert (error.message, error.value) == (f"{begin} is not closed", begin)
    assert error.allowed == WORDS[begin]


def test_all_that_is_not_closed_is_listed_from_the_outermost_inwards() -> None:
    found = errors(*BEGINS.values())
    assert [(error.line, error.value) for error in found] == list(enumerate(BEGINS, start=1))


def test_a_second_last_branch_is_refused_in_its_own_structure_only() -> None:
    """Each $IF has an $ELSE of its own."""
    inner = ["$IF 1", "$ELSE", "$ENDIF"]
    assert errors("$IF 1", *inner, "$ELSE", *inner, "$ENDIF") == ()
    error = only("$IF 1", "$ELSE", *inner, "N9 $ELSEIF 2", "$ENDIF")
    assert error.message == "$ELSEIF after the last branch"
    assert (error.line, error.column, error.value) == (6, 4, "$ELSEIF")


def test_the_level_that_is_too_deep_is_the_one_that_is_named() -> None:
    lines = ["$IF 1"] * DEPTH_MAX + ["$WHILE 1"]
    found = errors(*lines, *["$ENDIF"] * DEPTH_MAX)
    assert (found[0].line, found[0].allowed) == (DEPTH_MAX + 1, f"{DEPTH_MAX} levels")
    assert errors(*["$IF 1"] * DEPTH_MAX, "$ENDIF", "$IF 1", *["$ENDIF"] * DEPTH_MAX) == ()


# A block with an error


@pytest.mark.parametrize("begin", BEGINS)
def test_a_wrong_begin_makes_no_second_error_of_its_end(begin: str) -> None:
    error = only(f"{BEGINS[begin]} 7", "G0 X1", ENDS[begin])
    assert error.line == 1


@pytest.mark.parametrize("begin", BEGINS)
def test_a_wrong_end_leaves_nothing_open(begin: str) -> None:
    error = only(BEGINS[begin], "G0 X1", f"{ENDS[begin]} 7")
    assert error.line == 3


def test_a_wrong_end_of_another_structure_closes_nothing() -> None:
    found = errors("$WHILE 1", "$ENDIF 7", "$ENDWHILE")
    assert [error.line for error in found] == [2]


@pytest.mark.parametrize(
    ("label", "target"),
    [("N010: G777", "N10"), ("[A] G777", "[A]"), ("[ A ] G777", "[A]"), ("/2 N10: G777", "N10")],
)
def test_a_label_before_a_wrong_block_is_there_all_the_same(label: str, target: str) -> None:
    error = only(label, f"$GOTO {target}")
    assert (error.line, error.value) == (1, "G777")


def test_a_conditional_jump_with_an_error_opens_nothing() -> None:
    error = only("$IF 1 $GOTO 7", "G0 X1")
    assert error.line == 1


# Labels and jumps


def test_a_label_is_there_twice_only_within_one_part() -> None:
    assert errors("%L UP", "[A] G0 X1", "M17", "%MAIN", "[A] G0 X2", "M30") == ()
    for first, second, name in (("N010: G0", "N10: G0 X2", "N10"), ("[A] G0", "[ A] X2", "[A]")):
        error = only("G0 X1", first, "G0 X3", second, "$GOTO N10" if name == "N10" else "$GOTO [A]")
        assert (error.line, error.value, error.hint) == (4, name, "also in line 2")


def test_a_jump_may_go_forwards_and_backwards_and_out_of_a_structure() -> None:
    assert errors("$GOTO [B]", "[A] G0 X1", "$IF 1", "$GOTO [A]", "$ENDIF", "[B] M30") == ()


def test_a_jump_without_its_label_names_the_labels_of_its_part() -> None:
    found = errors("%L UP", "[ONE] G0", "$GOTO [TWO]", "M17", "%MAIN", "[TWO] G0", "N5: G0",
                   "N7 $IF 1 $GOTO [ONE]", "$GOTO [TOW]")  # fmt: skip
    assert [(error.line, error.column, error.value) for error in found] == [
        (3, 1, "[TWO]"), (8, 10, "[ONE]"), (9, 1, "[TOW]"),
    ]  # fmt: skip
    assert [error.allowed for error in found] == ["[ONE]", "[TWO], N5", "[TWO], N5"]
    assert found[2].hint == "nearest: [TWO]"


# The order of errors


def test_errors_are_in_the_order_of_their_lines_whatever_finds_them() -> None:
    """Calls and jumps are known at the end only, what is not closed at the end of its part."""
    found = errors(
        "LL PU", "G777", "$IF 1", "$GOTO [A]", "LL PU", "G1 Q1", "#VAR", "V.P.A",
    )  # fmt: skip
    assert [error.line for error in found] == [1, 2, 3, 4, 5, 6, 7]
    with pytest.raises(UserError) as caught:
        parse_program("LL PU\nG777\n$IF 1", file="p.nc", axes=XYZ)
    assert (caught.value.line, caught.value.value) == (1, "PU")


def test_a_bracket_that_is_open_far_below_comes_at_its_line() -> None:
    """It is known before any block is read."""
    wrong = ["G777"] * (ERRORS_MAX - 1)
    found = errors(*wrong, "X=[1+2", *wrong)
    assert [error.line for error in found] == list(range(1, ERRORS_MAX + 1))
    assert (found[-1].column, found[-1].value) == (3, "[")


def test_of_too_many_errors_the_first_ones_are_listed() -> None:
    calls, wrong = 3, ERRORS_MAX - 1
    found = errors(*["LL PU"] * calls, *["G777"] * wrong)
    assert [error.line for error in found] == list(range(1, ERRORS_MAX + 1))
    assert [error.value for error in found[: calls + 1]] == ["PU"] * calls + ["G777"]


@pytest.mark.parametrize("block", ["LL PU", "$GOTO [A]", "G777"])
def test_there_is_an_end_of_errors_of_one_kind(block: str) -> None:
    found = errors(*[block] * (ERRORS_MAX + 20))
    assert [error.line for error in found] == list(range(1, ERRORS_MAX + 1))


# Subprograms


def test_a_call_of_a_subprogram_that_is_not_there_names_those_that_are() -> None:
    first, second = errors("%L ONE", "M17", "%L TWO", "LL OEN", "M17", "%MAIN", "N5 LL THREE")
    assert (first.line, first.value, first.hint) == (4, "OEN", "nearest: ONE")
    assert (first.allowed, second.allowed) == ("ONE, TWO", "ONE, TWO")
    assert (second.line, second.value, second.hint) == (7, "THREE", None)
    alone = only("LL UP")
    assert alone.allowed == "%L UP before the main program"


@pytest.mark.parametrize("called", ["part", "PART", "Part_", "Par", "Part2"])
def test_a_local_subprogram_is_called_by_its_very_name(called: str) -> None:
    """Capital and small letters differ, as in the names of files."""
    error = only("%L Part", "M17", "%MAIN", "N5 LL Part", f"N10 LL {called}")
    assert (error.line, error.value, error.allowed) == (5, called, "Part")
    assert error.message == "no such local subprogram"
