"""R parameters as the text takes them, and words that do not act, noted once a block."""

import pytest
from tests.nc.conftest import run_text

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")


def noted(*blocks: str) -> list[str]:
    program = parse_program("\n".join(("%t", *blocks, "M30", "")), file="t.nc", axes=AXES)
    return [word.word for part in program.blocks for word in part.not_acting]


@pytest.mark.parametrize("block", ["R[2]=3", "R2=3", "R[1+1]=3"])
def test_an_r_parameter_is_written_like_a_p_parameter_and_does_not_act(block: str) -> None:
    """It is known, so that the text is right and the program ends where it is reached."""
    assert noted(block) == ["R[]"]
    assert noted(block.replace("R", "P")) == []
    with pytest.raises(Alarm) as refused:
        run_text(f"%t\n{block}\nM30\n")
    assert (refused.value.id, refused.value.values["word"]) == (900100, "R[]")


@pytest.mark.parametrize("block", ["X=R5", "X=R[5]", "P1=R5+1", "V.E.A=R5", "F=-r5"])
def test_an_r_parameter_may_be_a_value(block: str) -> None:
    assert noted(block) == ["R[]"]


@pytest.mark.parametrize("letter", "XFQ")
def test_a_value_in_brackets_and_behind_the_sign_is_one_too_many(letter: str) -> None:
    with pytest.raises(UserError, match="not in both"):
        noted(f"{letter}[2]=3")


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ("P1=1 P2=2 G41", ["G41"]), ("N10: P1=1 G41", ["G41"]), ("P1=1 G41 G95", ["G41", "G95"]),
        ("N10: G41", ["G41"]), ("G41", ["G41"]), ("P1=1 X1", []),
    ],
)  # fmt: skip
def test_a_word_that_does_not_act_is_noted_once(block: str, words: list[str]) -> None:
    """However many statements its block has."""
    assert noted(block) == words
