"""Scales of drawings: round ticks, words that keep them apart, values where they belong."""

import re

import pytest

from axisrig.reports.parts.axes import Field, Scale, margin, tick_words, ticks, with_room


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.0, 3000.0, [0, 1000, 2000, 3000]),
        (-2.1, -1.85, [-2.1, -2.05, -2.0, -1.95, -1.9, -1.85]),
        (39.99991, 39.99999, [39.99992, 39.99994, 39.99996, 39.99998]),
        (5.0, 5.0, []),
    ],
)
def test_ticks_are_round_and_inside(low: float, high: float, expected: list[float]) -> None:
    found = ticks(low, high)
    assert found == pytest.approx(expected, abs=1e-12)
    assert len({*tick_words(found)}) == len(found)


@pytest.mark.parametrize("size", [1e-7, 3e-3, 0.7, 42.0, 9e6])
def test_there_are_three_ticks_at_least(size: float) -> None:
    for share in (0.0, 0.13, 0.5):
        assert 3 <= len(ticks(size * share, size * (1 + share))) <= 8


def test_words_are_as_short_as_they_can_be() -> None:
    assert tick_words([0.0, 0.5, 1.0]) == ["0.0", "0.5", "1.0"]
    assert tick_words([-200.0, 0.0, 200.0]) == ["-200", "0", "200"]
    assert tick_words([0.0, 2e-6, 4e-6]) == ["0", "2e-06", "4e-06"]
    assert tick_words([7.0]) == ["7"]


def test_values_are_where_the_scale_says() -> None:
    field = Field(50.0, 150.0, 10.0, 110.0, (0.0, 10.0), (-1.0, 1.0))
    assert (field.x(0.0), field.x(5.0), field.x(10.0)) == (50.0, 100.0, 150.0)
    assert (field.y(1.0), field.y(0.0), field.y(-1.0)) == (10.0, 60.0, 110.0)
    assert Field(0.0, 10.0, 0.0, 10.0, (3.0, 3.0), (0.0, 1.0)).x(3.0) == 5.0


def test_a_field_may_be_mirrored_and_have_room_on_its_sides() -> None:
    field = Field(50.0, 150.0, 0.0, 9.0, (-10.0, 0.0), (0.0, 1.0), is_mirrored=True)
    assert (field.x(-10.0), field.x(0.0)) == (150.0, 50.0)
    wide = Field(50.0, 450.0, 0.0, 9.0, (-10.0, 0.0), (0.0, 1.0), is_mirrored=True)
    # The largest of 1, 2 and 5 that leaves three steps
    words = re.findall(r">(-?\d+)</text>", "".join(wide.across()))
    assert words == ["0", "-2", "-4", "-6", "-8", "-10"]
    free = Field(50.0, 150.0, 0.0, 9.0, (0.0, 10.0), (0.0, 1.0), inset=(10.0, 30.0))
    assert (free.x(0.0), free.x(10.0)) == (60.0, 120.0)


def test_a_scale_clips_only_where_it_is_asked_to() -> None:
    scale = Scale(0.0, 4.0, 100.0, 0.0)
    assert [scale.at(value) for value in (0.0, 1.0, 8.0)] == [100.0, 75.0, -100.0]
    assert [scale.clipped(value) for value in (-1.0, 1.0, 8.0)] == [100.0, 75.0, 0.0]
    assert scale.clipped(8.0, 0.1) == pytest.approx(10.0)
    assert (scale.holds(4.0), scale.holds(4.1)) == (True, False)
    assert Scale(3.0, 3.0, 0.0, 10.0).at(3.0) == 5.0


def test_room_is_left_around_values_that_are_equal() -> None:
    low, high = with_room([2.0, 2.0])
    assert low < 2.0 < high
    assert margin((0.0, 100000.0)) > margin((0.0, 1.0))


def test_words_that_would_cover_each_other_are_left_out() -> None:
    field = Field(40.0, 240.0, 10.0, 110.0, (0.0, 99.0), (0.0, 1.0))
    words = [part for part in field.named([(n, f"name-{n:02}") for n in range(100)])
             if part.startswith("<text")]  # fmt: skip
    assert 2 <= len(words) <= 5


@pytest.mark.parametrize(("apart_px", "shown"), [(35, "ac"), (36, "abc"), (37, "abc")])
def test_words_are_apart_by_the_width_of_a_sign(apart_px: int, shown: str) -> None:
    """Five signs of 6 px have 30 px; the next word begins 6 px behind them."""
    field = Field(0.0, 600.0, 10.0, 110.0, (0.0, 600.0), (0.0, 1.0))
    places = [(100.0 + apart_px * at, name * 5) for at, name in enumerate("abc")]
    drawn = "".join(field.named(places))
    assert [name for name in "abc" if name * 5 in drawn] == list(shown)
    assert drawn.count("ax-grid") == 3  # each has its line


def test_words_at_both_ends_stay_in_the_drawing() -> None:
    """20 signs of 6 px: half of a word is 60 px, from 0 px on and up to 6 px right of the field.

    Between them a word is above its value: 40 + 200 x 50/99 px.
    """
    field = Field(40.0, 240.0, 10.0, 110.0, (0.0, 99.0), (0.0, 1.0))
    word = "a-name-of-20-signs-x"
    for value, middle in ((0.0, 60.0), (50.0, 141.01), (99.0, 186.0)):
        (text,) = [part for part in field.named([(value, word)]) if part.startswith("<text")]
        x = float(text.split('x="')[1].split('"')[0])
        assert x == pytest.approx(middle, abs=0.1)


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        # 0.06 of what they span
        ([0.0, 100.0], (-6.0, 106.0)), ([-100.0, -50.0], (-103.0, -47.0)),
        ([3.0, -1.0, 2.0], (-1.24, 3.24)),
        # A thousandth of a value that is alone, on either side of 0; at 0 the least
        ([2000.0, 2000.0], (1998.0, 2002.0)), ([-2000.0], (-2002.0, -1998.0)),
        ([0.0], (-1e-9, 1e-9)), ([1e-9], (0.0, 2e-9)),
    ],
)  # fmt: skip
def test_room_is_a_share_of_what_values_span(
    values: list[float], ends: tuple[float, float]
) -> None:
    assert with_room(values) == pytest.approx(ends, rel=1e-12, abs=1e-15)


def test_the_least_room_and_the_share_may_be_others() -> None:
    assert with_room([0.0], 0.5) == (-0.5, 0.5)
    assert with_room([0.0, 10.0], share=0.1) == (-1.0, 11.0)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([-0.2, -0.1, -0.0], ["-0.2", "-0.1", "0.0"]),  # nothing has no sign
        ([-1e-17, 0.1, 0.2], ["0.0", "0.1", "0.2"]),
        ([-2e7, -1e7, 0.0], ["-2e+07", "-1e+07", "0"]),
        ([1e7, 2e7], ["1e+07", "2e+07"]),
        ([9_999_990.0, 10_000_000.0], ["9999990", "1e+07"]),
        ([-500.0, 0.0, 500.0], ["-500", "0", "500"]),
        ([-5e-5, 0.0, 5e-5], ["-5e-05", "0", "5e-05"]),
    ],
)
def test_words_of_ticks_on_both_sides_of_0(values: list[float], words: list[str]) -> None:
    assert tick_words(values) == words
