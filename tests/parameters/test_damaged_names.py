"""Names of parameters as scans leave them: what they mean, and what is none of them."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import table
from axisrig.kernel.parameters.errata import damaged_name, damaged_value, errata, meant


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("kenngr.dist ctrl[0].kp 1.5", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist\\_ctrl[0].kp 1.5", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist<sup>_</sup>ctrl[0].kp 1.5", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist<SUP>_</SUP>ctrl[0].kp 1.5", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist_ctrl[ 3 ].kp 1.5", "kenngr.dist_ctrl[3].kp 1.5"),
        ("KENNGR.DIST_CTRL[3].KP 1.5", "kenngr.dist_ctrl[3].kp 1.5"),
        ("kenngr.dist ctrl[12].kp1.5", "kenngr.dist_ctrl[12].kp 1.5"),
        ("  kenngr.dist ctrl[0].kp 1.5 # weight", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist ctrl[0].kp 1.5 ; weight", "kenngr.dist_ctrl[0].kp 1.5"),
        ("kenngr.dist ctrl[0].kp", "kenngr.dist_ctrl[0].kp"),
    ],
)
def test_a_name_is_known_again(line: str, hint: str) -> None:
    assert damaged_name(line, "axis") == f"it means {hint}"


@pytest.mark.parametrize("written", ["[ 3 ]", "[3 ]", "[ 3]", "[\t3]"])
def test_a_list_with_blanks_in_a_bracket_is_refused_with_what_is_meant(
    refused: Callable[..., UserError], written: str
) -> None:
    error = refused(f"kopf.achs_nr 1\nkenngr.dist_ctrl{written}.kp 1.5\n")
    assert (error.message, error.line) == ("damaged parameter name", 2)
    assert error.hint == "it means kenngr.dist_ctrl[3].kp 1.5"


@pytest.mark.parametrize("comment", ["", " ; in 0.1 um"])
def test_a_name_in_two_words_is_shown_with_both(
    refused: Callable[..., UserError], comment: str
) -> None:
    error = refused(f"kenngr.messachse 1\nkenngr.hub messtaster{comment}\n")
    assert (error.message, error.line, error.column) == ("damaged parameter name", 2, 1)
    assert error.value == "kenngr.hub messtaster"
    assert error.hint == "it means kenngr.hub_messtaster"


@pytest.mark.parametrize(
    "before", ["x ", "x", "1 ", "old ", "-", "# ", "; ", "antr.", "is kenngr ", "[0] "]
)
def test_a_name_behind_other_text_is_not_what_the_line_means(before: str) -> None:
    """A sentence about a parameter, a longer name or a comment."""
    assert damaged_name(f"{before}kenngr.dist ctrl[0].kp 1.5", "axis") is None


@pytest.mark.parametrize("line", ["", "# only", "nothing of it", "kenngr.dst ctrl[0].kp 1"])
def test_what_looks_like_no_name_has_no_hint(line: str) -> None:
    assert damaged_name(line, "axis") is None


def test_two_names_of_one_line_are_both_meant() -> None:
    line = "kenngr.dist ctrl[0].kp 1.5 kenngr.messachse 1"
    assert damaged_name(line, "axis") == (
        "it means kenngr.dist_ctrl[0].kp 1.5 and kenngr.messachse 1"
    )


def test_a_name_is_one_of_its_own_kind() -> None:
    """The channel has distance control too, by other names."""
    assert damaged_name("dist ctrl[0].kp 1", "channel") == "it means dist_ctrl[0].kp 1"
    assert damaged_name("dist ctrl[0].kp 1", "axis") is None
    assert damaged_name("kenngr.dist ctrl[0].kp 1", "channel") is None


def test_each_index_keeps_its_own_bracket() -> None:
    assert damaged_name("antr.function[ 4 ].wr ident[1] 6065 00", "axis") == (
        "it means antr.function[4].wr_ident[1] 6065_00"
    )


def test_blanks_in_a_value_are_underscores_of_words_only() -> None:
    """`commu` is a word, `kp` a number."""
    assert damaged_name("antr.function[0].i d MON WINDOW", "axis") is None
    assert damaged_name("antr.function [0].id MON WINDOW", "axis") is None
    assert damaged_name("antr.function[0].wr ident[0] 6065 00", "axis") == (
        "it means antr.function[0].wr_ident[0] 6065_00"
    )
    assert damaged_name("kenngr.dist ctrl[0].kp 1 5", "axis") == (
        "it means kenngr.dist_ctrl[0].kp 1 5"
    )


@pytest.mark.parametrize(
    ("path", "value", "hint"),
    [
        ("antr.function[0].id", "MON WINDOW", "MON_WINDOW, or the text in quotes"),
        ("antr.function[0].id", "MON\\_WINDOW 2", "MON_WINDOW_2, or the text in quotes"),
        ("kenngr.measure.signal", "PLC TIMESTAMP", "it means PLC_TIMESTAMP"),
        ("kenngr.measure.signal", "PLC CLOCK", None), ("kenngr.messachse", "1 0", None),
    ],
)  # fmt: skip
def test_a_word_in_several_parts(path: str, value: str, hint: str | None) -> None:
    assert damaged_value(value, table("axis").row(path)) == hint


def test_a_value_of_no_parameter_has_no_hint() -> None:
    assert damaged_value("A B", None) is None


def test_misprints_of_the_manuals_are_whole_lines() -> None:
    """Each is mended where it stands by itself, and left alone inside another line."""
    for printed, right, _ in errata():
        line = printed.rstrip("\n")
        if "\n" in line:
            continue
        whole = meant(f"kopf.achs_nr 1\n{line}\nkenngr.messachse 1\n")
        assert right.rstrip("\n") in whole, line
        assert whole.startswith("kopf.achs_nr 1\n")
        assert whole.rstrip("\n").endswith("kenngr.messachse 1")
        longer = f"# of {line}\n"
        assert meant(longer).split() == longer.split()
