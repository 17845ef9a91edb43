"""Structures inside structures: a branch, a case or a loop that ends touches nothing around it."""

import pytest
from tests.nc.test_nc_flow import path, refused


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # an inner branch that is not taken leaves the outer one taken
        ("$IF 1\n$IF 0\nX1\n$ENDIF\nX2\n$ELSEIF 1\nX3\n$ELSE\nX4\n$ENDIF\nX5", [2, 5]),
        ("$IF 1\n$IF 0\nX1\n$ELSEIF 0\nX6\n$ENDIF\nX2\n$ELSE\nX4\n$ENDIF", [2]),
        ("$IF 0\nX1\n$ELSEIF 1\n$IF 0\nX2\n$ELSE\nX3\n$ENDIF\nX4\n$ELSE\nX5\n$ENDIF", [3, 4]),
        ("$IF 0\n$IF 1\nX1\n$ELSE\nX2\n$ENDIF\n$ELSE\nX3\n$ENDIF", [3]),
        # of two conditions that hold the first one counts
        ("$IF 0\nX1\n$ELSEIF 1\nX2\n$ELSEIF 1\nX3\n$ELSE\nX4\n$ENDIF", [2]),
    ],
)
def test_branches_in_branches(run, text: str, expected: list[int]) -> None:
    assert path(run, text) == expected


INNER = "$SWITCH {value}\n$CASE 7\nX7\n$BREAK\n{rest}$ENDSWITCH\n"


@pytest.mark.parametrize(
    ("value", "rest", "inside"),
    [(7, "", [7]), (8, "", []), (8, "$DEFAULT\nX9\n", [9]), (8, "$CASE 8\nX8\n", [8])],
)
def test_a_case_falls_through_whatever_became_of_a_switch_inside_it(
    run, value: int, rest: str, inside: list[int]
) -> None:
    """Without $BREAK the next cases follow, also behind one without a fitting case."""
    inner = INNER.format(value=value, rest=rest)
    text = f"$SWITCH 1\n$CASE 1\n{inner}X1\n$CASE 2\nX2\n$BREAK\n$CASE 3\nX3\n$ENDSWITCH\nX4"
    assert path(run, text) == [*inside, 1, 2, 4]


@pytest.mark.parametrize(
    ("value", "expected"), [(1, [1]), (2, [2, 9, 3]), (3, [3]), (4, [9, 3]), (0, [9, 3])]
)
def test_a_default_between_cases_is_the_last_choice_and_is_passed_through_in_its_place(
    run, value: int, expected: list[int]
) -> None:
    """Chosen where no case fits; without $BREAK the blocks below follow as they are written."""
    text = "$SWITCH {}\n$CASE 1\nX1\n$BREAK\n$CASE 2\nX2\n$DEFAULT\nX9\n$CASE 3\nX3\n$ENDSWITCH"
    assert path(run, text.format(value)) == expected


def test_what_no_case_fits_is_forgotten_behind_the_switch(run) -> None:
    """The next one asks its own value; a default is no case of anything that follows."""
    text = "$SWITCH 5\n$CASE 1\nX1\n{default}$ENDSWITCH\n$SWITCH 1\n$CASE 5\nX5\n$BREAK\n"
    text += "$CASE 1\nX2\n$ENDSWITCH"
    assert path(run, text.format(default="")) == [2]
    assert path(run, text.format(default="$DEFAULT\nX9\n")) == [9, 2]


@pytest.mark.parametrize(
    ("loop", "end"),
    [
        ("$FOR P1=1,4,1", "$ENDFOR"), ("P1=0\n$WHILE P1<4\nP1=P1+1", "$ENDWHILE"),
        ("P1=0\n$DO\nP1=P1+1", "$ENDDO P1<4"), ("P1=0\n$REPEAT\nP1=P1+1", "$UNTIL P1>=4"),
    ],
)  # fmt: skip
def test_continue_asks_the_condition_of_its_own_loop_and_break_leaves_it(
    run, loop: str, end: str
) -> None:
    """Of 1 to 4 the second is passed over, and nothing comes behind the third."""
    body = "$IF P1==2\n$CONTINUE\n$ENDIF\nX=P1\n$IF P1==3\n$BREAK\n$ENDIF\nX=P1*10"
    assert path(run, f"{loop}\n{body}\n{end}\nX99") == [1, 10, 3, 99]
    nested = f"$FOR P2=1,2,1\n{loop}\n{body}\n{end}\nX=P2*100\n$ENDFOR\nX99"
    assert path(run, nested) == [1, 10, 3, 100, 1, 10, 3, 200, 99]


def test_a_loop_in_a_case_is_left_by_its_own_break(run) -> None:
    loop = "$FOR P1=1,9,1\nX=P1\n$IF P1==2\n$BREAK\n$ENDIF\n$ENDFOR"
    text = f"$SWITCH 1\n$CASE 1\n{loop}\nX50\n$CASE 2\nX60\n$BREAK\n$CASE 3\nX70\n$ENDSWITCH"
    assert path(run, text) == [1, 2, 50, 60]


def test_the_bounds_of_a_counting_loop_are_those_of_its_begin(run) -> None:
    """Programming manual 206929163: last value and step are computed once, each time anew."""
    text = "P2=3\nP3=1\n$FOR P1=1,P2,P3\nX=P1\nP2=9\nP3=2\n$ENDFOR"
    assert path(run, f"{text}\n{text}") == [1, 2, 3, 1, 2, 3]


SWITCH = "$SWITCH 1\n$CASE 1\n[A] X1\n$BREAK\n$ENDSWITCH"


@pytest.mark.parametrize(
    "text",
    [
        f"$GOTO [A]\n{SWITCH}",
        f"$IF 1\n$GOTO [A]\n$ENDIF\n{SWITCH}",
        f"$SWITCH 2\n$CASE 2\n$GOTO [A]\n$ENDSWITCH\n{SWITCH}",
        f"$WHILE P1<1\n$GOTO [A]\n$ENDWHILE\n{SWITCH}",
        f"$IF 1\n{SWITCH}\n$GOTO [A]\n$ENDIF",
    ],
)
def test_a_jump_into_a_choice_comes_from_inside_it(run, text: str) -> None:
    """Whatever other structure it comes out of."""
    error = refused(run, f"P1=0\n{text}")
    begin = next(n for n, line in enumerate(text.split("\n"), 2) if line == "$SWITCH 1")
    assert error.message == f"$GOTO leads into $SWITCH of line {begin} from outside"
    assert error.value == "[A]"


@pytest.mark.parametrize("inner", ["{}", "$IF 1\n{}\n$ENDIF"])
def test_inside_a_choice_a_jump_may_lead_from_case_to_case(run, inner: str) -> None:
    jump = inner.format("$GOTO [A]")
    text = f"$SWITCH 2\n$CASE 1\n[A] X1\n$BREAK\n$CASE 2\nX2\n{jump}\nX3\n$ENDSWITCH\nX9"
    assert path(run, text) == [2, 1, 9]
