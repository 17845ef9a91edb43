"""Damaged names of which one is the begin of another: the whole name is meant, and its value."""

from itertools import permutations

import pytest

from axisrig.kernel.parameters import table
from axisrig.kernel.parameters.errata import damaged_name, damaged_value
from axisrig.kernel.parameters.table import Kind

KINDS: tuple[Kind, ...] = ("axis", "channel", "external", "startup")
ALIKE = [
    (kind, short, long)
    for kind in KINDS
    for short, long in permutations(sorted(set(table(kind).paths())), 2)
    if long.startswith(short)
]
"""Both names are parameters: kind, the shorter and the longer one."""
SIGNS = {
    "blank": " ",
    "tab": "\t",
    "escaped": "\\_",
    "raised": "<sup>_</sup>",
    "empty": "<sup></sup>",
}
"""What a scan leaves of an underscore."""


def shown(path: str, value: str) -> str:
    return f"it means {path} {value}"


def test_there_are_names_that_begin_alike() -> None:
    """The value after each is none of the other's name."""
    assert len(ALIKE) >= 5
    assert ("axis", "kenngr.measure.input", "kenngr.measure.input_edge_banding") in ALIKE


@pytest.mark.parametrize("sign", SIGNS)
@pytest.mark.parametrize(("kind", "short", "long"), ALIKE)
def test_the_longer_name_is_meant_where_all_of_it_is_there(
    kind: Kind, short: str, long: str, sign: str
) -> None:
    damaged = long.replace("_", SIGNS[sign])
    assert damaged_name(f"{damaged} 1", kind) == shown(long, "1")
    assert damaged_name(f"{damaged.upper()} 1", kind) == shown(long, "1")


@pytest.mark.parametrize(("kind", "short", "long"), ALIKE)
def test_the_shorter_name_is_meant_where_no_more_is_there(
    kind: Kind, short: str, long: str
) -> None:
    damaged = short.replace("_", " ")
    for value in ("1", "0.5", "-3"):
        assert damaged_name(f"{damaged} {value}", kind) == shown(short, value)


@pytest.mark.parametrize(("kind", "short", "long"), ALIKE)
def test_both_names_in_one_line_are_each_themselves(kind: Kind, short: str, long: str) -> None:
    for one, other in ((short, long), (long, short)):
        line = f"{one.replace('_', ' ')} 1 {other.replace('_', ' ')} 3"
        assert damaged_name(line, kind) == f"{shown(one, '1')} and {other} 3"


@pytest.mark.parametrize("kind", KINDS)
def test_every_name_without_a_value_means_itself(kind: Kind) -> None:
    """A sample of each kind: every fifth name, with blanks for underscores, in capitals too."""
    for path in sorted(set(table(kind).paths()))[::5]:
        damaged = path.replace("_", " ")
        assert damaged_name(damaged, kind) == f"it means {path}"
        assert damaged_name(damaged.upper(), kind) == f"it means {path}"


@pytest.mark.parametrize("indices", [("0",), ("7",), ("12",), ("1234",)])
def test_an_index_of_up_to_four_digits_is_kept(indices: tuple[str]) -> None:
    """A longer one is no index."""
    (index,) = indices
    line = f"getriebe[ {index} ].vb max red zone 2 5"
    assert damaged_name(line, "axis") == shown(f"getriebe[{index}].vb_max_red_zone_2", "5")
    assert damaged_name("getriebe[12345].vb max red zone 5", "axis") is None


@pytest.mark.parametrize(
    ("value", "hint"),
    [
        ("NEG PORT", "NEG_PORT"), ("NEG  PORT", "NEG_PORT"), ("NEG\\_PORT", "NEG_PORT"),
        ("NEG_PORT", "NEG_PORT"), (" NEG PORT ", "NEG_PORT"),
    ],
)  # fmt: skip
def test_a_text_is_joined_whatever_is_between_its_words(value: str, hint: str) -> None:
    row = table("axis").row("antr.function[0].id")
    assert damaged_value(value, row) == f"{hint}, or the text in quotes"
