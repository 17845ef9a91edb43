"""An unknown # command: all that begin with its word, else those that look like it."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.words import commands

XYZ = ("X", "Y", "Z")


def refused(text: str) -> UserError:
    (error,) = check_program(f"{text}\nM30", "p.nc", XYZ).errors
    assert error.message == "unknown # command"
    assert (error.line, error.column) == (1, 1 + len(text) - len(text.lstrip()))
    return error


@pytest.mark.parametrize(
    ("typed", "nearest"),
    [
        ("#TIM", "#TIME"), ("#SLOP", "#SLOPE"), ("#MEA", "#MEAS"), ("#WAI", "#WAIT"),
        ("#FLUS", "#FLUSH"), ("#MS", "#MSG"), ("#TRAF", "#TRAFO"), ("#ERRO", "#ERROR"),
        ("#ENDVA", "#ENDVAR"), ("#SIGNA", "#SIGNAL"), ("#DELET", "#DELETE"),
    ],
)  # fmt: skip
def test_a_shortened_command_has_the_whole_one_as_nearest(typed: str, nearest: str) -> None:
    """What only begins like it is no choice: #MEA is none of #MEAS MODE, #MEAS DEFAULT, .."""
    error = refused(typed)
    assert error.hint is not None
    assert error.hint.startswith(f"nearest: {nearest}")
    assert (error.value, error.allowed) == (typed, None)


FIRST_WORDS = sorted(
    {name.split()[0] for name in commands() if " " in name and "<" not in name}
    - set(commands())
    - {"L"}
)


@pytest.mark.parametrize("word", FIRST_WORDS)
def test_the_first_word_of_commands_has_them_all_and_no_others(word: str) -> None:
    """In the order of the table; no hint beside them."""
    error = refused(f"#{word.lower()}")
    names = [f"#{name}" for name in commands() if name.split()[0] == word]
    assert (error.value, error.allowed, error.hint) == (f"#{word}", ", ".join(names), None)


@pytest.mark.parametrize(
    ("typed", "allowed"),
    [
        ("#KIN", "#KIN ID"),
        ("#SET", "#SET AX LINK, #SET AX"),
        ("#COMMENT", "#COMMENT BEGIN, #COMMENT END"),
        ("#DRIVE", "#DRIVE WR SYN, #DRIVE WR, #DRIVE RD, #DRIVE WAIT SYN"),
        ("#AX", "#AX LINK, #AX LINK ON, #AX LINK OFF"),
    ],
)
def test_commands_of_one_first_word(typed: str, allowed: str) -> None:
    assert refused(typed).allowed == allowed


@pytest.mark.parametrize("typed", ["#C", "#I", "#A", "#L", "#XYZ", "#QUIT NOW"])
def test_what_looks_like_nothing_names_the_list_of_all(typed: str) -> None:
    error = refused(typed)
    assert (error.allowed, error.hint) == (None, "`axisrig language` lists them all")


@pytest.mark.parametrize("typed", ["#L CYCLE", "  #L CYCLE[NAME=x.nc]", "#l cycle [NAME=x.nc]"])
def test_a_call_of_a_cycle_has_no_sharp(typed: str) -> None:
    error = refused(typed)
    assert (error.value, error.hint) == (
        "#L CYCLE", "a call of a cycle has no #: L CYCLE [NAME=..]",
    )  # fmt: skip


@pytest.mark.parametrize("typed", ["#CYCLE", "#L CYCL", "#INDP_SYN", "#DIST_CTRL"])
def test_neither_calls_nor_commands_of_an_axis_are_near(typed: str) -> None:
    hint = refused(typed).hint or ""
    assert "#L " not in hint
    assert "<axis>" not in hint
