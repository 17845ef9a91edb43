"""Where the parts of a picture of fitted lines are: points, bars, names, signs."""

import re
from itertools import pairwise

import pytest
from tests.reports.swept import numbers

from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.lines.drawing import Fitted, Point, drawing


def fitted(
    name: str,
    slope: float,
    intercept: float,
    places: dict[float, float],
    spread: float | None = None,
    word: str = "pass",
) -> Fitted:
    verdict = Verdict.of(word)
    points = tuple(Point(f"{name}{x:g}", x, y, spread, verdict) for x, y in places.items())
    return Fitted(name, slope, intercept, points, verdict)


LINE = r'class="ln-line" d="M([\d.]+),([\d.]+)L([\d.]+),([\d.]+)"'
SIGN = r'<title>[^<]*</title><path class="ln-sign" d="M([\d.]+),([\d.]+)m'
BAR = r'class="ln-bar" d="M([\d.]+),([\d.]+)V([\d.]+)"'
NAME = r'class="ln-name" x="[\d.]+" y="([\d.]+)">([^<]*)<'
LEAD = r'class="ln-lead" d="M([\d.]+),([\d.]+)L([\d.]+),([\d.]+)"'


def test_a_point_is_on_its_line_with_its_spread_up_and_down() -> None:
    """y = 10 - 2 x at 1, 2 and 4; 0 is in the picture, the line begins there at 10."""
    text = drawing([fitted("a", -2.0, 10.0, {x: 10 - 2 * x for x in (1, 2, 4)}, 0.5)], "t", "", "")
    ((x0, y0, x1, y1),) = numbers(LINE, text)
    signs, bars = numbers(SIGN, text), numbers(BAR, text)
    assert [x for x, _ in signs] == pytest.approx(
        [x0 + (x1 - x0) * share for share in (0.25, 0.5, 1.0)], abs=0.11
    )
    assert [y for _, y in signs] == pytest.approx(
        [y0 + (y1 - y0) * share for share in (0.25, 0.5, 1.0)], abs=0.11
    )
    per_unit = (y1 - y0) / 8
    for (x, y), (at, low, high) in zip(signs, bars, strict=True):
        assert at == x
        assert (low, high) == pytest.approx((y + per_unit / 2, y - per_unit / 2), abs=0.15)
    assert "standard deviation 0.5" in text


@pytest.mark.parametrize(
    ("places", "has_zero"),
    [((5.0, 10.0), True), ((5.1, 10.0), False), ((-5.0, -10.0), True), ((-5.1, -10.0), False),
     ((-1.0, 10.0), True)],
)  # fmt: skip
def test_0_is_in_the_picture_no_farther_off_than_the_points_are_apart(
    places: tuple[float, float], has_zero: bool
) -> None:
    """Lines that end in 0 have it at an end; large amounts are on the right."""
    text = drawing([fitted("a", 1.0, 0.0, {x: x for x in places})], "t", "", "")
    ((x0, _, x1, _),) = numbers(LINE, text)
    signs = [x for x, _ in numbers(SIGN, text)]
    assert x0 <= min(signs) <= max(signs) <= x1
    assert signs == sorted(signs)
    assert (min(signs) > x0 + 1.0) is (has_zero and min(places) != -1.0)


def test_points_of_several_lines_are_side_by_side() -> None:
    """6 px from one to the next, the middle one at its value."""
    lines = [fitted(name, 0.0, 1.0, {2.0: 1.0, 4.0: 1.0}) for name in "abc"]
    text = drawing(lines, "t", "", "")
    alone = numbers(SIGN, drawing(lines[:1], "t", "", ""))
    signs = numbers(SIGN, text)
    assert [x for x, _ in signs[::2]] == pytest.approx([alone[0][0] + d for d in (-6, 0, 6)])
    two = numbers(SIGN, drawing(lines[:2], "t", "", ""))
    assert [x for x, _ in two[::2]] == pytest.approx([alone[0][0] + d for d in (-3, 3)])


@pytest.mark.parametrize("word", ["pass", "marginal", "inconclusive", "fail", "error"])
def test_what_did_not_pass_has_a_cross_and_a_word(word: str) -> None:
    text = drawing([fitted("a", 0.0, 1.0, {1.0: 1.0, 2.0: 1.0}, word=word)], "t", "", "")
    is_good = word in ("pass", "marginal")
    assert text.count('class="ln-bad"') == (0 if is_good else 2)
    ((_, name),) = re.findall(NAME, text)
    assert name == ("a" if is_good else f"a {Verdict.of(word).glyph} {word}")


def test_a_name_is_at_the_end_of_its_line_and_a_lead_goes_there() -> None:
    """The upper line has the upper name; two that end together are 14 px apart."""
    text = drawing([fitted("low", 0.0, 1.0, {0.0: 1.0, 1.0: 1.0}),
                    fitted("high", 0.0, 9.0, {0.0: 9.0, 1.0: 9.0}),
                    fitted("same", 0.0, 9.0, {0.0: 9.0, 1.0: 9.0})], "t", "", "")  # fmt: skip
    heights = {name: float(y) - 4 for y, name in re.findall(NAME, text)}
    leads = numbers(LEAD, text)
    ends = [line[3] for line in numbers(LINE, text)]
    assert [lead[1] for lead in leads] == ends
    assert [lead[3] for lead in leads] == pytest.approx(list(heights.values()))
    assert heights["high"] == pytest.approx(ends[1])
    assert heights["same"] - heights["high"] == pytest.approx(14.0, abs=0.11)
    # The lowest name ends above the foot: what comes after it gives way upwards
    many = [fitted(str(n), 0.0, 0.0, {0.0: 0.0, 1.0: 0.0}) for n in range(12)]
    places = [float(y) for y, _ in re.findall(NAME, drawing(many, "t", "", ""))]
    assert places == sorted(places)
    assert min(b - a for a, b in pairwise(places)) >= 13.9


def test_each_line_has_a_sign_of_its_own_up_to_eight() -> None:
    lines = [fitted(str(n), float(n), 0.0, {1.0: float(n)}) for n in range(9)]
    text = drawing(lines, "t", "", "")
    assert re.findall(r'<g class="(ln-\d)">', text) == [f"ln-{n % 8}" for n in range(9)]
    signs = re.findall(r'class="ln-sign" d="M[\d.]+,[\d.]+(m[^"]*)"/><text', text)
    assert len(set(signs[:8])) == 8
    assert signs[8] == signs[0]


@pytest.mark.parametrize("is_mirrored", [False, True])
@pytest.mark.parametrize("turn", [1, -1])
def test_names_are_in_the_order_of_the_ends_that_they_are_at(is_mirrored: bool, turn: int) -> None:
    """Lines that cross: the one that is lower near 0 is the upper one at the far end.

    Large amounts are on the right, where the names are; where all are negative it is mirrored.
    """
    side = -1.0 if is_mirrored else 1.0
    rising = fitted("rising", side, -7.0, {side * x: x - 7.0 for x in (5.0, 10.0)})
    falling = fitted("falling", -side, 7.0, {side * x: 7.0 - x for x in (5.0, 10.0)})
    level = fitted("level", 0.0, 0.0, {side * x: 0.0 for x in (5.0, 10.0)})
    lines = [rising, falling, level][::turn]
    text = drawing(lines, "t", "", "")
    heights = {name: float(y) - 4 for y, name in re.findall(NAME, text)}
    assert sorted(heights, key=heights.__getitem__) == ["rising", "level", "falling"]
    ends = [line[3] for line in numbers(LINE, text)]
    assert list(heights.values()) == pytest.approx(ends, abs=0.11)
    leads = numbers(LEAD, text)
    assert [lead[1] for lead in leads] == ends
    assert [lead[3] for lead in leads] == pytest.approx(ends, abs=0.11)


@pytest.mark.parametrize("level", [3.0, -3.0])
def test_a_spread_is_in_the_picture_up_and_down(level: float) -> None:
    """5 up and down of points that are 1 apart: both ends are within the frame."""
    places = {1.0: level, 2.0: level + 1.0}
    text = drawing([fitted("a", 1.0, level - 1.0, places, 5.0)], "t", "", "")
    ((x, y, width, height),) = numbers(
        r'class="ax-field" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"', text
    )
    for at, low, high in numbers(BAR, text):
        assert x < at < x + width
        assert y < high < low < y + height


@pytest.mark.parametrize("x", [4.0, -4.0, 0.0, 1e-3])
def test_a_single_point_is_within_the_picture_on_its_line(x: float) -> None:
    """Its value may be far from 0 or at it: the line goes through it, to both sides."""
    text = drawing([fitted("a", 2.0, 1.0, {x: 2.0 * x + 1.0})], "t", "", "")
    ((x0, y0, x1, y1),) = numbers(LINE, text)
    ((at, height),) = numbers(SIGN, text)
    assert x0 <= at <= x1
    assert x1 - x0 > 100
    share = (at - x0) / (x1 - x0)
    # Both heights are drawn to 0.1 px
    assert height == pytest.approx(y0 + share * (y1 - y0), abs=0.11)


@pytest.mark.parametrize("x", [4.0, -4.0, 0.0])
def test_0_is_in_the_picture_of_a_single_point(x: float) -> None:
    """It is as wide as its value is far from 0."""
    text = drawing([fitted("a", 0.0, 1.0, {x: 1.0})], "t", "", "")
    ticks = [float(word) for word in re.findall(r'text-anchor="middle">(-?[\d.]+)</text>', text)]
    assert 0.0 in ticks
    assert min(ticks) <= x <= max(ticks)


def test_the_pointer_shows_what_a_line_and_a_point_are() -> None:
    """y = 10 - 2.5 x: intercept and slope; of a point y at x, its verdict and its spread."""
    one = fitted("a", -2.5, 10.0, {2.0: 5.0, 4.0: 0.25}, 0.125, "fail")
    titles = re.findall(r"<title>([^<]*)</title>", drawing([one], "t", "", ""))
    assert titles == [
        "a: 10 and -2.5 for each unit",
        "a2: 5 at 2, fail, standard deviation 0.125",
        "a4: 0.25 at 4, fail, standard deviation 0.125",
    ]


@pytest.mark.parametrize(("spread", "words"), [(0.0, ", standard deviation 0"), (None, "")])
def test_a_spread_of_0_is_known(spread: float | None, words: str) -> None:
    """One that is not known has neither bar nor words."""
    text = drawing([fitted("a", 1.0, 0.0, {1.0: 1.0}, spread)], "t", "", "")
    assert f"<title>a1: 1 at 1, pass{words}</title>" in text
    assert [low == high for _, low, high in numbers(BAR, text)] == [True] * (spread is not None)
