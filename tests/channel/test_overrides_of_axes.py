"""A path that moves axes with overrides of their own: the smallest of them acts, times its own."""

from typing import Any

import pytest
from tests.channel.test_path_alone import Walk

FEED_MM_MIN, FEED_MM_S = 1200.0, 20.0


def top_mm_s(walk: Walk) -> float:
    """The largest speed along the path: axes that move by the same way, so sqrt(n) of one."""
    moved = [axis for axis in walk.names if walk.has_moved(axis)]
    return max(map(abs, walk.speeds_mm_s(moved[0]))) * len(moved) ** 0.5


def moved(words: Any, axes: str, permille: int, overrides: dict[str, int]) -> Walk:
    walk = Walk(words, "XYZ")
    walk.path.override(permille, overrides)
    start = dict(zip("XYZ", walk.places[0], strict=True))
    return walk.move(FEED_MM_MIN, **{axis: start[axis] + 4.0 for axis in axes})


CASES = [
    ("XY", {"X": 300, "Y": 700}, 300),
    ("XY", {"X": 700, "Y": 300}, 300),
    ("XYZ", {"X": 900, "Y": 800, "Z": 400}, 400),
    ("XYZ", {"Y": 600}, 600),
    ("X", {"X": 500, "Y": 100}, 500),  # one that the path does not move has no part in it
    ("YZ", {"X": 100}, 1000),
    ("YZ", {"X": 100, "Z": 250}, 250),
    ("Z", {}, 1000),
    ("XY", {"X": 500, "Y": 500}, 500),
]


@pytest.mark.parametrize("permille", [1000, 400, 1500])
@pytest.mark.parametrize(("axes", "overrides", "least"), CASES)
def test_the_smallest_override_of_the_axes_that_move_acts_times_that_of_the_path(
    words: Any, axes: str, overrides: dict[str, int], least: int, permille: int
) -> None:
    walk = moved(words, axes, permille, overrides).cycles()
    assert top_mm_s(walk) == pytest.approx(FEED_MM_S * permille * least / 1e6, rel=1e-6)
    assert [walk.has_moved(axis) for axis in "XYZ"] == pytest.approx(
        [4.0 if axis in axes else 0.0 for axis in "XYZ"]
    )


@pytest.mark.parametrize(
    ("first", "then", "least"),
    [
        ({"X": 500}, {}, 1000),
        ({"X": 500}, {"Y": 400}, 400),
        ({}, {"X": 800, "Y": 200}, 200),
        ({"X": 200, "Y": 300}, {"X": 900, "Y": 300}, 300),
        ({"X": 200, "Y": 300}, {"Y": 300}, 300),
        ({"X": 200}, {"Z": 100}, 1000),
    ],
)
def test_what_an_axis_had_before_does_not_count_any_more(
    words: Any, first: dict[str, int], then: dict[str, int], least: int
) -> None:
    """Changed on the way, after 150 ms; the speed is the new one from 60 ms later on."""
    walk = moved(words, "XY", 1000, first).cycles(150)
    walk.path.override(1000, then)
    walk.cycles(60)
    expected = FEED_MM_S * least / 1000.0
    walk.places = walk.places[-2:]
    assert top_mm_s(walk) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("permille", "acts"), [(2000, 2000), (2001, 2000), (5000, 2000)])
def test_what_is_above_the_largest_override_counts_as_that(
    words: Any, permille: int, acts: int
) -> None:
    """P-CHAN-00056 = 200 % bounds that of the path; an axis takes its share of what is left."""
    alone = moved(words, "X", permille, {}).cycles()
    assert top_mm_s(alone) == pytest.approx(FEED_MM_S * acts / 1000.0, rel=1e-6)
    slowed = moved(words, "X", permille, {"X": 250}).cycles()
    assert top_mm_s(slowed) == pytest.approx(FEED_MM_S * acts / 4000.0, rel=1e-6)


def test_the_next_path_begins_with_the_overrides_of_its_own_axes(words: Any) -> None:
    walk = moved(words, "X", 1000, {"X": 300, "Y": 600}).cycles()
    assert top_mm_s(walk) == pytest.approx(FEED_MM_S * 0.3, rel=1e-6)
    walk.places = walk.places[-1:]
    walk.move(FEED_MM_MIN, Y=4.0).cycles()
    assert top_mm_s(walk) == pytest.approx(FEED_MM_S * 0.6, rel=1e-6)
