"""Blocks that look alike are read once: the short way gives what the grammar gives."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text import shapes
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "z", "A")

NUMBERS = st.one_of(
    st.integers(0, 99999).map(str),
    st.floats(-1e5, 1e5, allow_nan=False).map(lambda value: f"{value:.4f}"),
    st.sampled_from(["0", "-0", "+1", ".5", "1.", "00012", "-.25", "123456789012345678", "0.1"]),
)
WORDS = st.builds(
    "{}{}{}".format, st.sampled_from("XYZAFIJKRTDSEHQxyzf"), st.sampled_from(["", " "]), NUMBERS
)
FUNCTIONS = st.sampled_from(
    ["G1", "G01", "g0", "G2", "G 1", "G100", "G90", "G777", "M3", "M30", "m5", "G-1", "G1.5"]
)
LINES = st.builds(
    lambda number, words: f"{number}{' '.join(words)}",
    st.sampled_from(["", "N10 ", "n 7 ", "N0020"]),
    st.lists(st.one_of(WORDS, WORDS, FUNCTIONS), min_size=1, max_size=6),
)


def outcome(text):
    try:
        program = parse_program(text, file="p.nc", axes=AXES)
    except UserError as error:
        return str(error)
    return program


@pytest.mark.long
@settings(max_examples=400, deadline=None)
@given(st.lists(LINES, min_size=1, max_size=6))
def test_the_short_way_gives_the_same_as_the_grammar(lines):
    # Every line twice: the second one goes the short way if there is one
    text = "\n".join([*lines, *lines])
    short = outcome(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shapes, "plain", lambda *_: None)
        assert outcome(text) == short


def test_a_block_of_a_known_shape_does_not_reach_the_grammar(monkeypatch):
    text = "\n".join(f"N{n} G1 X{n}.5 Y-{n} F100" for n in range(1, 50))
    whole = parse_program(text, axes=AXES)
    read = []
    learn = shapes.Shapes.learn
    monkeypatch.setattr(shapes.Shapes, "learn", lambda *a: (read.append(a[1]), learn(*a)))
    assert parse_program(text, axes=AXES) == whole
    assert len(read) == 1


def test_a_number_that_needs_a_check_is_checked_in_every_block():
    with pytest.raises(UserError, match="feed") as caught:
        parse_program("G1 X1 F100\nG1 X2 F200\nG1 X3 F0", axes=AXES)
    assert caught.value.line == 3
