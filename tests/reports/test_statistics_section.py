"""Drawings of samples: what they show, and that they stay small."""

import re
from xml.etree import ElementTree

import pytest

from axisrig.bench.judge.statistics.summary import describe
from axisrig.reports.statistics.drawings import DOTS, drawings

VALUES = (0.4, 0.1, -0.2, 0.3, 0.0, 0.2)


def drawn(values: tuple[float, ...], *limits: float | None) -> list[ElementTree.Element]:
    names = [f"run <{number}>" for number in range(len(values))]
    texts = drawings(describe(names, values, *(limits or (None, None))), 'metric & "unit"')
    return [ElementTree.fromstring(text) for text in texts]


def circles(svg: ElementTree.Element) -> list[tuple[float, float]]:
    return [(float(dot.get("cx", "")), float(dot.get("cy", ""))) for dot in svg.iter("circle")]


def lines(svg: ElementTree.Element, kind: str) -> int:
    return sum(line.get("class") == kind for line in svg.iter("line"))


def test_three_drawings_show_values_limits_and_mean() -> None:
    order, bars, normal = drawn(VALUES, -1.0, 1.0)
    assert [lines(svg, "st-limit") for svg in (order, bars, normal)] == [2, 2, 0]
    heights = [y for _, y in circles(order)]
    assert [VALUES[n] for n in sorted(range(6), key=lambda n: -heights[n])] == sorted(VALUES)
    assert order.find("circle/title").text == "run <0>: 0.4"  # type: ignore[union-attr]
    counts = [int(re.findall(r"\d+$", t.text or "")[0]) for t in bars.findall("rect/title")]
    assert sum(counts) == len(VALUES)
    across = [x for x, _ in circles(normal)]
    assert across == sorted(across)
    assert order.get("aria-label", "").endswith('metric & "unit"')


@pytest.mark.parametrize("values", [(1.0,), (1.0, 2.0)])
def test_below_three_values_nothing_is_drawn(values: tuple[float, ...]) -> None:
    assert drawn(values) == []


def test_equal_values_can_be_drawn() -> None:
    assert len(drawn((1.0, 1.0, 1.0), None, 2.0)) == 3


def test_many_values_are_thinned_and_the_farthest_stay() -> None:
    values = tuple((n * 37 % 101) / 100.0 for n in range(20_000))
    order, _, normal = drawn((*values, 9.0))
    for svg in (order, normal):
        assert DOTS // 2 < len(circles(svg)) <= DOTS
    titles = [title.text or "" for title in order.findall("circle/title")]
    assert any(text.endswith(": 9") for text in titles)
