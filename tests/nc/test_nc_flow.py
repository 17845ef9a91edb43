"""Control structures: which blocks are decoded how often, and what is refused before that."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.nc.decoder import interpreter


def path(run, text, **options):
    """The X positions that a program goes to, in order."""
    commands = run(f"G0\n{text}", **options)
    return [c.target_mm["X"] for c in commands if isinstance(c, LinearMove)]


def refused(run, text):
    with pytest.raises(UserError) as caught:
        run(text)
    return caught.value


# ---- branches


@pytest.mark.parametrize(
    ("value", "expected"),
    [("1", [1]), ("2", [2]), ("3", [3]), ("-1", [3])],
)
def test_the_first_branch_whose_condition_holds_is_taken(run, value, expected):
    text = f"P1={value}\n$IF P1==1\nX1\n$ELSEIF P1==2\nX2\n$ELSE\nX3\n$ENDIF"
    assert path(run, text) == expected


@pytest.mark.parametrize(
    ("value", "holds"),
    [("0.5", True), ("-0.5", True), ("0.49", False), ("TRUE", True), ("FALSE", False)],
)
def test_a_condition_holds_from_a_magnitude_of_a_half_on(run, value, holds):
    """Programming manual, $IF: decimal values decide as well."""
    assert path(run, f"P1={value}\n$IF P1\nX1\n$ENDIF") == ([1] if holds else [])


def test_without_else_nothing_happens(run):
    assert path(run, "$IF 0\nX1\n$ELSEIF 0\nX2\n$ENDIF\nX3") == [3]


@pytest.mark.parametrize(
    ("value", "expected"),
    [("1", [1]), ("2", [2, 3]), ("3", [3]), ("2.0009", [2, 3]), ("2.0011", [9]), ("-1", [9])],
)
def test_a_case_is_equal_below_a_thousandth_and_falls_through_without_break(run, value, expected):
    text = (
        f"P1={value}\n$SWITCH P1\n$CASE 1\nX1\n$BREAK\n$CASE 2\nX2\n$CASE 3\nX3\n$BREAK\n"
        "$DEFAULT\nX9\n$ENDSWITCH"
    )
    assert path(run, text) == expected


@pytest.mark.parametrize(
    ("value", "case", "is_same"),
    [
        ("0.001", "0", False), ("-0.001", "0", False),
        ("0", "0.001", False), ("0", "-0.001", False),
        ("0.000999", "0", True), ("-0.000999", "0", True), ("0", "0.000999", True),
    ],
)  # fmt: skip
def test_a_thousandth_apart_is_another_case(run, value, case, is_same):
    """Equal below it, on either side. Programming manual 206908427."""
    text = f"$SWITCH {value}\n$CASE {case}\nX1\n$BREAK\n$DEFAULT\nX9\n$ENDSWITCH"
    assert path(run, text) == ([1] if is_same else [9])


def test_a_switch_without_a_fitting_case_does_nothing(run):
    assert path(run, "$SWITCH 7\n$CASE 1\nX1\n$BREAK\n$ENDSWITCH\nX2") == [2]


# ---- loops


@pytest.mark.parametrize(
    ("bounds", "expected"),
    [
        ("1,3,1", [1, 2, 3]),
        ("1,4,2", [1, 3]),
        ("3,1,-1", [3, 2, 1]),
        ("2,1,1", []),
        ("1,2,-1", []),
        ("5,5,1", [5]),
    ],
)
def test_a_counting_loop_goes_on_until_its_last_value_is_passed(run, bounds, expected):
    assert path(run, f"$FOR P1={bounds}\nX=P1\n$ENDFOR") == expected


@pytest.mark.parametrize("last", ["9", "1", "-9"])
def test_a_counting_loop_with_a_step_of_0_never_gets_there(run, last):
    """Its value stays, whichever side of the last one it is on: a jump alone ends it."""
    text = f"P2=0 P3=0\n$FOR P1=1,{last},P3\nP2=P2+1\nX=P1+P2\n"
    text += "$IF P2==3 $GOTO [OUT]\n$ENDFOR\n[OUT] X0"
    assert path(run, text) == [2, 3, 4, 0]


def test_the_bounds_of_a_counting_loop_count_as_they_were_at_its_beginning(run):
    text = "P2=2 P3=1\n$FOR P1=1,P2,P3\nX=P1\nP2=9 P3=5\n$ENDFOR\nX=P1*10"
    assert path(run, text) == [1, 2, 30]


def test_a_loop_with_its_condition_in_front_may_not_run_at_all(run):
    assert path(run, "P1=5\n$WHILE P1<5\nX1\n$ENDWHILE\nX2") == [2]


@pytest.mark.parametrize(("begin", "end"), [("$DO", "$ENDDO P1<3"), ("$REPEAT", "$UNTIL P1>=3")])
def test_a_loop_with_its_condition_at_the_end_runs_once_at_least(run, begin, end):
    assert path(run, f"P1=0\n{begin}\nP1=P1+1\nX=P1\n{end}") == [1, 2, 3]
    assert path(run, f"P1=7\n{begin}\nP1=P1+1\nX=P1\n{end}") == [8]


def test_break_leaves_the_innermost_loop_and_continue_begins_its_next_turn(run):
    text = (
        "$FOR P1=1,2,1\n$FOR P2=1,5,1\n$IF P2==2\n$CONTINUE\n$ENDIF\n$IF P2==4\n$BREAK\n$ENDIF\n"
        "X=P1*10+P2\n$ENDFOR\n$ENDFOR"
    )
    assert path(run, text) == [11, 13, 21, 23]


def test_continue_in_a_loop_with_its_condition_at_the_end_asks_the_condition(run):
    text = "P1=0\n$DO\nP1=P1+1\n$IF P1==2\n$CONTINUE\n$ENDIF\nX=P1\n$ENDDO P1<3"
    assert path(run, text) == [1, 3]


def test_break_in_a_switch_inside_a_loop_leaves_the_switch_only(run):
    text = "$FOR P1=1,2,1\n$SWITCH P1\n$CASE 1\nX1\n$BREAK\n$CASE 2\nX2\n$ENDSWITCH\nX0\n$ENDFOR"
    assert path(run, text) == [1, 0, 2, 0]


def test_the_plc_side_counts_no_loops(run):
    with pytest.raises(UserError) as caught:
        run("X0\n$FOR V.E.A=1,3,1\n$ENDFOR", external={"A": 0.0})
    assert (caught.value.line, caught.value.column) == (2, 6)


# ---- jumps


def test_jumps_go_forwards_and_backwards_by_number_and_by_name(run):
    text = "P1=0\n$GOTO N40\nX9\nN40: X1\n[BACK] P1=P1+1\nX=P1*10\n$IF P1<2 $GOTO [BACK]\nX2"
    assert path(run, text) == [1, 10, 20, 2]


def test_a_jump_may_lead_into_and_out_of_branches(run):
    """Programming manual 206915851: what lies between goes on as if the branch were taken."""
    assert path(run, "$GOTO [IN]\n$IF 0\nX1\n[IN] X2\n$ELSE\nX3\n$ENDIF\nX4") == [2, 4]
    assert path(run, "$IF 1\nX1\n$GOTO [OUT]\nX2\n$ENDIF\nX3\n[OUT] X4") == [1, 4]


def test_a_jump_may_leave_loops(run):
    text = "$WHILE 1\n$FOR P1=1,9,1\nX=P1\n$IF P1==2 $GOTO [OUT]\n$ENDFOR\n$ENDWHILE\n[OUT] X0"
    assert path(run, text) == [1, 2, 0]


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("$GOTO [A]\n$WHILE 1\n[A] X1\n$ENDWHILE", 1, 1, "leads into $WHILE of line 2"),
        ("$GOTO [A]\n$DO\n$IF 1\n[A] X1\n$ENDIF\n$ENDDO 0", 1, 1, "leads into $DO of line 2"),
        (
            "$GOTO [A]\n$REPEAT\n$SWITCH 1\n$CASE 1\n[A] X1\n$ENDSWITCH\n$UNTIL 1",
            1,
            1,
            "leads into $REPEAT of line 2",
        ),
        ("$GOTO [A]\n$IF 1\n$DO\n[A] X1\n$ENDDO 0\n$ENDIF", 1, 1, "leads into $DO of line 3"),
        (
            "$GOTO [A]\n$SWITCH 1\n$CASE 1\n$WHILE 1\n[A] X1\n$ENDWHILE\n$ENDSWITCH",
            1,
            1,
            "leads into $WHILE of line 4; a jump may only leave a loop (ID 21480)",
        ),
        ("$FOR P1=1,2,1\n  $GOTO [A]\n[A] X1\n$ENDFOR", 2, 3, "leads into $FOR of line 1"),
        ("$GOTO [A]\n$SWITCH 1\n$CASE 1\n[A] X1\n$ENDSWITCH", 1, 1, "$SWITCH of line 2"),
    ],
)
def test_a_jump_into_a_loop_is_refused(run, text, line, column, message):
    """Diagnosis 254849675: a loop can be left, nothing else."""
    error = refused(run, text)
    assert (error.line, message in error.message) == (line, True)
    assert (error.column or 0) >= column


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("X0\n  $IF 1\nX2", 2),
        ("X0\n  $ENDIF", 2),
        ("$IF 1\n$ELSE\n$ELSE\n$ENDIF", 3),
        ("$CASE 1", 1),
        ("X0\n$BREAK", 2),
        ("$IF 1\n$CONTINUE\n$ENDIF", 2),
        ("[A] X1\n[A] X2", 2),
        ("$GOTO [NOWHERE]", 1),
        ("%L SUB\n[A] X1\n%MAIN\n$GOTO [A]", 4),
    ],
)
def test_what_does_not_belong_together_is_refused_before_anything_runs(run, text, line):
    assert refused(run, text).line == line


def test_an_unknown_label_names_the_nearest_ones(run):
    assert "[FINISH]" in str(refused(run, "[FINISH] X1\n$GOTO [FINISHED]"))


def test_structures_too_deep_are_refused(run):
    depth = 200
    text = "$IF 1\n" * depth + "$ENDIF\n" * depth
    assert "deep" in refused(run, text).message


def test_long_loops_that_end_are_no_endless_ones(run, monkeypatch):
    """900 blocks in 300 turns; they are counted for one loop, not for the program."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 1000)
    assert path(run, "P2=0\n$FOR P1=1,300,1\nP2=P2+P1\n$ENDFOR\nX=P2/300") == [150.5]
