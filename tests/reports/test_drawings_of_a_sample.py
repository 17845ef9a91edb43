"""Words, edges and curve of the drawings of a sample."""

import math
from itertools import pairwise
from statistics import fmean, stdev
from xml.etree import ElementTree

import pytest
from tests.reports.test_statistics_section import VALUES, circles, drawn

from axisrig.bench.statistics.distribution import normal_plot
from axisrig.reports.statistics.drawings import DOTS

SIGN_PX = 6.0
"""So wide a sign of a word at an axis is reckoned."""


def head(svg: ElementTree.Element) -> str:
    return next(svg.iter("text")).text or ""


def edges(svg: ElementTree.Element) -> tuple[float, float, float, float]:
    """Left, right, top and foot of the field."""
    (frame,) = [box for box in svg.iter("rect") if box.get("class") == "ax-field"]
    x, y, width, height = (float(frame.get(name, "")) for name in ("x", "y", "width", "height"))
    return x, x + width, y, y + height


def test_heads_say_mean_count_and_what_the_values_are() -> None:
    """(1000.25 + 1000.5 + 1001.25 + 1003) / 4 = 1001.25, in six digits."""
    values = (1000.25, 1000.5, 1001.25, 1003.0)
    order, bars, normal = drawn(values)
    assert head(order) == "in their order, mean 1001.25"
    assert head(bars) == "histogram, n 4"
    assert head(normal).startswith("normal plot")
    for svg in (order, bars, normal):
        assert svg.get("aria-label") == f'{head(svg)}: metric & "unit"'


def test_the_pointer_shows_seven_digits_of_a_value() -> None:
    """Beside its run in their order; in the normal plot they are sorted."""
    values = (12.345678, -0.1234567, 3000.1234, 5.0)
    order, _, normal = drawn(values)
    titles = [[title.text for title in svg.findall("circle/title")] for svg in (order, normal)]
    words = ["12.34568", "-0.1234567", "3000.123", "5"]
    assert titles[0] == [f"run <{number}>: {word}" for number, word in enumerate(words)]
    assert titles[1] == [words[place] for place in (1, 3, 0, 2)]


@pytest.mark.parametrize("values", [VALUES, (1.0, 2.0, 4.0), tuple(range(50))])
def test_values_in_their_order_begin_at_1_with_equal_room_on_both_sides(
    values: tuple[float, ...],
) -> None:
    """6 % of what is between the first and the last are free on either side."""
    order, *_ = drawn(values)
    left, right, _, _ = edges(order)
    across = [x for x, _ in circles(order)]
    room = 0.06 / 1.12 * (right - left)
    assert across[0] - left == pytest.approx(room, abs=0.06)
    assert right - across[-1] == pytest.approx(room, abs=0.06)
    step = (right - left - 2 * room) / (len(values) - 1)
    steps = [b - a for a, b in pairwise(across)]
    assert steps == pytest.approx([step] * len(steps), abs=0.11)


@pytest.mark.parametrize(
    "values",
    [VALUES, (1e6, 1e6 + 0.125, 1e6 + 0.25, 1e6 + 0.5), (1e-6, 3e-6, 2e-6), (-5e7, 5e7, 1e7)],
)
def test_words_at_the_left_have_room_whatever_their_length(values: tuple[float, ...]) -> None:
    for svg in drawn(values):
        words = [word for word in svg.iter("text") if word.get("text-anchor") == "end"]
        assert words
        ends = [(float(word.get("x", "")), len(word.text or "")) for word in words]
        assert all(x - SIGN_PX * signs >= 0.0 for x, signs in ends)
        left, right, top, foot = edges(svg)
        assert all(x < left for x, _ in ends)
        assert (right, top, foot) == (292.0, 18.0, 134.0)  # of 300 x 150


def test_of_many_values_the_ends_of_each_stretch_stay() -> None:
    """Of 800 values each stretch of 4 has its largest at its second and its smallest after it."""
    count = DOTS // 2
    order, *_ = drawn((0.0, 2.0, -1.0, 0.0) * count)
    titles = [title.text for title in order.findall("circle/title")]
    assert titles == [
        f"run <{4 * n + place}>: {value}"
        for n in range(count)
        for place, value in ((1, 2), (2, -1))
    ]


@pytest.mark.parametrize("values", [VALUES, (1.0, 3.0, 4.0, 4.5, 5.0, 5.5, 6.0, 9.0)])
def test_the_normal_curve_is_that_of_mean_and_spread(values: tuple[float, ...]) -> None:
    """n w / (s sqrt(2 pi)) exp(-(x - mean)^2 / (2 s^2)), on the scale that the bins show."""
    _, bars, _ = drawn(values)
    boxes = [box for box in bars.iter("rect") if box.get("class") == "st-bin"]
    titles = [title.text or "" for title in bars.findall("rect/title")]
    lows = [float(text.split(" to ")[0]) for text in titles]
    counts = [int(text.rpartition(" ")[2]) for text in titles]
    high = float(titles[-1].split(" to ")[1].partition(":")[0])
    begin, end = (
        float(boxes[0].get("x", "")),
        float(boxes[-1].get("x", "")) + float(boxes[-1].get("width", "")),
    )
    px_x = (end - begin) / (high - lows[0])
    highest = max(range(len(counts)), key=counts.__getitem__)
    px_y = float(boxes[highest].get("height", "")) / counts[highest]
    foot = edges(bars)[3]
    mean, s, width = fmean(values), stdev(values), lows[1] - lows[0]
    (curve,) = bars.iter("polyline")
    places = [tuple(map(float, at.split(","))) for at in curve.get("points", "").split()]
    assert (places[0][0], places[-1][0]) == pytest.approx((begin, end), abs=0.11)
    for x, y in places:
        value = lows[0] + (x - begin) / px_x
        count = len(values) * width / (s * math.sqrt(2 * math.pi))
        count *= math.exp(-((value - mean) ** 2) / (2 * s**2))
        # Places and heights are written with a tenth of a pixel
        assert foot - y == pytest.approx(count * px_y, abs=0.6)


def test_one_bin_alone_has_no_curve() -> None:
    """Of two heaps the rule of Freedman and Diaconis makes one bin: 5 / (10 / 4^(1/3)) < 1."""
    _, bars, _ = drawn((0.0, 0.0, 5.0, 5.0))
    titles = [title.text for title in bars.findall("rect/title")]
    assert titles == ["0 to 5: 4"]
    assert list(bars.iter("polyline")) == []


@pytest.mark.parametrize("values", [(2.0, 2.0, 2.0), (0.0, 0.0, 0.0)])
def test_equal_values_have_a_bin_and_no_curve(values: tuple[float, ...]) -> None:
    _, bars, _ = drawn(values)
    (title,) = [title.text for title in bars.findall("rect/title")]
    assert title == f"{values[0]:g} to {values[0]:g}: 3"
    assert list(bars.iter("polyline")) == []


def test_quantiles_of_a_normal_plot_are_across() -> None:
    """Equal distances of quantiles are equal distances on the drawing, as they are in a table."""
    _, _, normal = drawn(VALUES)
    quantiles = normal_plot(VALUES).quantiles
    across = [x for x, _ in circles(normal)]
    per_unit = (across[-1] - across[0]) / (quantiles[-1] - quantiles[0])
    assert across == pytest.approx(
        [across[0] + per_unit * (q - quantiles[0]) for q in quantiles], abs=0.11
    )
    left, right, _, _ = edges(normal)
    assert across[0] - left == pytest.approx(right - across[-1], abs=0.11)
