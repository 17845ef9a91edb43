"""The drawing of a value between its limits: stretch, bands of the guard, value, arrow."""

import re

import pytest
from tests.reports.swept import numbers

from axisrig.reports.parts.bar import HEIGHT, WIDTH, bar, scale

LIMIT = r'<line class="bar-limit" x1="([\d.]+)" x2="([\d.]+)"'
VALUE = r'<rect class="bar-value v-\w+" x="([\d.]+)" y="[\d.]+" width="([\d.]+)"'
ARROW = r'<path class="bar-value v-\w+" d="M([\d.]+) 3 L([\d.]+) 9 L([\d.]+) 15 Z"'
SPREAD = r'<line class="bar-spread" x1="([\d.]+)" x2="([\d.]+)"'
EDGE = 5.0
PLACE_PX = 0.051
"""Half of 0.1 px: places are drawn with one digit."""
END_PX = 0.101
"""Twice that: the end of a band is its begin and its width, with one digit each."""
Limit = float | None


def band(name: str, text: str) -> list[tuple[float, ...]]:
    """Begin and end of each band of a kind."""
    found = numbers(rf'<rect class="bar-{name}" x="([\d.]+)" y="5" width="([\d.]+)"', text)
    return [(x, pytest.approx(x + width, abs=END_PX)) for x, width in found]


def drawn(value: float, u: float, lower: Limit, upper: Limit, verdict: str = "pass") -> str:
    return bar(value, u, lower, upper, verdict, "label")


def places(text: str) -> list[float]:
    return [x for x, _ in numbers(LIMIT, text)]


@pytest.mark.parametrize(
    ("value", "u", "limits", "ends"),
    [
        # Two limits with 0.35 of what is between them on either side, wherever the value is
        (0.0, 0.1, (-1.0, 1.0), (-1.7, 1.7)),
        (99.0, 0.1, (-1.0, 1.0), (-1.7, 1.7)),
        (5.0, 0.1, (0.0, 10.0), (-3.5, 13.5)),
        # An amount begins at 0: to the upper limit and 0.35 of it more, to twice the lower one
        (0.3, 0.1, (None, 2.0), (0.0, 2.7)),
        (3.0, 0.1, (2.0, None), (0.0, 4.7)),
        (0.0, 0.1, (None, 2.0), (0.0, 2.7)),
        # Else around the limit: 1.5 times as far as the value, four times its uncertainty at least
        (-3.0, 0.1, (None, 1.0), (-5.0, 7.0)),
        (-3.0, 0.1, (-1.0, None), (-4.0, 2.0)),
        (1.0, 0.1, (None, -1.0), (-4.0, 2.0)),
        (1.0, 0.1, (-1.0, None), (-4.0, 2.0)),
        (-1.1, 2.0, (None, -1.0), (-9.0, 7.0)),
        (0.5, 0.0, (None, 0.0), (-0.75, 0.75)),
        (-0.5, 0.0, (0.0, None), (-0.75, 0.75)),
        (-100.0, 0.0, (None, -100.0), (-100.0001, -99.9999)),
        (0.0, 0.0, (0.0, None), (-1e-9, 1e-9)),
    ],
)
def test_the_stretch_has_the_limits_and_the_value_where_it_is_near(
    value: float, u: float, limits: tuple[Limit, Limit], ends: tuple[float, float]
) -> None:
    found = scale(value, u, *limits)
    assert (found.low, found.high) == pytest.approx(ends, rel=1e-12)
    assert (found.first, found.last) == (EDGE, WIDTH - EDGE)


@pytest.mark.parametrize(
    ("limits", "inside"),
    [
        ((-1.0, 1.0), (-1.0, 1.0)), ((None, 2.0), (0.0, 2.0)), ((2.0, None), (2.0, 4.7)),
        ((0.0, None), (0.0, 1.5)), ((None, 0.0), (-1.5, 0.0)), ((0.0, 2.0), (0.0, 2.0)),
    ],
)  # fmt: skip
def test_what_is_allowed_goes_from_limit_to_limit_or_to_the_end(
    limits: tuple[Limit, Limit], inside: tuple[float, float]
) -> None:
    """A limit of 0 counts too. Each limit has a line."""
    text = drawn(1.0 if limits != (None, 0.0) else -1.0, 0.0, *limits)
    area = scale(1.0 if limits != (None, 0.0) else -1.0, 0.0, *limits)
    ((begin, end),) = band("in", text)
    assert begin == pytest.approx(area.at(inside[0]), abs=PLACE_PX)
    assert end == pytest.approx(area.at(inside[1]), abs=END_PX)
    wanted = [area.at(limit) for limit in limits if limit is not None]
    assert places(text) == pytest.approx(wanted, abs=PLACE_PX)
    assert band("all", text) == [(EDGE, WIDTH - EDGE)]


@pytest.mark.parametrize("limits", [(-1.0, 1.0), (-1.0, None), (None, 1.0)])
def test_bands_of_the_guard_are_at_each_limit_on_its_inner_side(
    limits: tuple[Limit, Limit],
) -> None:
    """Inconclusive within u on both sides of a limit, marginal from u to 2 u inside of it."""
    u, value = 0.2, -0.1
    text, area = drawn(value, u, *limits), scale(value, u, *limits)
    marginal, unclear = [], []
    for limit, side in zip(limits, (1.0, -1.0), strict=True):
        if limit is not None:
            marginal.append(sorted(area.at(limit + side * share * u) for share in (1, 2)))
            unclear.append([area.at(limit - u), area.at(limit + u)])
    for name, ends in (("marginal", marginal), ("inconclusive", unclear)):
        found = numbers(rf'<rect class="bar-{name}" x="([\d.]+)" y="5" width="([\d.]+)"', text)
        assert [x for x, _ in found] == pytest.approx([low for low, _ in ends], abs=PLACE_PX)
        assert [x + wide for x, wide in found] == pytest.approx(
            [high for _, high in ends], abs=END_PX
        )


def test_without_an_uncertainty_there_are_no_bands() -> None:
    text = drawn(0.5, 0.0, -1.0, 1.0)
    assert "bar-marginal" not in text
    assert "bar-inconclusive" not in text
    assert "bar-spread" not in text


@pytest.mark.parametrize("value", [-1.2, -1.0, 0.0, 0.7, 1.7])
def test_a_value_is_at_its_place_with_its_uncertainty(value: float) -> None:
    """The mark is 3 px wide around it; the ends of the uncertainty stay in the drawing."""
    u = 0.25
    text, area = drawn(value, u, -1.0, 1.0, "fail"), scale(value, u, -1.0, 1.0)
    ((x, width),) = numbers(VALUE, text)
    assert x + width / 2 == pytest.approx(area.at(value), abs=PLACE_PX)
    assert 'class="bar-value v-fail"' in text
    ((low, high),) = numbers(SPREAD, text)
    assert (low, high) == pytest.approx(
        (max(area.at(value - u), EDGE), min(area.at(value + u), WIDTH - EDGE)), abs=PLACE_PX
    )


@pytest.mark.parametrize(("u", "is_drawn"), [(0.05, False), (0.055, False), (0.06, True)])
def test_a_short_uncertainty_is_hidden_by_the_mark(u: float, is_drawn: bool) -> None:
    """122 px are 3.4: 4 px are 0.1115, of both sides."""
    assert ("bar-spread" in drawn(0.0, u, -1.0, 1.0)) is is_drawn


@pytest.mark.parametrize(
    ("value", "limits", "side"),
    [(2.0, (-1.0, 1.0), 1), (-2.0, (-1.0, 1.0), -1), (9.0, (None, 2.0), 1), (99.0, (2.0, None), 1)],
)  # fmt: skip
def test_a_value_outside_of_the_drawing_is_an_arrow_at_its_end(
    value: float, limits: tuple[Limit, Limit], side: int
) -> None:
    """It points away, and stays in the picture."""
    text = drawn(value, 0.25, *limits, "error")
    ((base, tip, again),) = numbers(ARROW, text)
    assert base == again == (WIDTH - EDGE if side > 0 else EDGE)
    assert tip - base == side * EDGE
    assert 0.0 <= tip <= WIDTH
    assert re.findall(VALUE, text) == []
    assert "bar-spread" not in text
    assert 'class="bar-value v-error"' in text


def test_a_bar_has_its_label_for_screen_readers() -> None:
    text = bar(0.5, 0.1, None, 1.0, "pass", '<m> is "0.5"')
    assert f'width="{WIDTH}" height="{HEIGHT}"' in text
    assert 'aria-label="&lt;m&gt; is &quot;0.5&quot;"' in text


@pytest.mark.parametrize(
    ("value", "u", "low", "high"),
    [(7.0, 0.1, 2.0, 8.0), (5.0, 0.5, 3.0, 7.0), (4.0, 0.0, 3.5, 6.5)],
)
def test_one_value_that_is_allowed_is_in_the_middle(
    value: float, u: float, low: float, high: float
) -> None:
    """Both limits are 5: 1.5 times as far as the value is, four times its uncertainty at least."""
    area = scale(value, u, 5.0, 5.0)
    assert (area.low, area.high) == pytest.approx((low, high))
    text = drawn(value, u, 5.0, 5.0)
    assert places(text) == pytest.approx([WIDTH / 2] * 2)
    ((x, width),) = numbers(VALUE, text)
    expected = EDGE + (WIDTH - 2 * EDGE) * (value - low) / (high - low)
    assert x + width / 2 == pytest.approx(expected, abs=PLACE_PX)
