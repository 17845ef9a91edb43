"""Drawings of a sample: where its lines are, by the scale that its dots show."""

from collections.abc import Sequence
from statistics import fmean, stdev
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.reports.test_statistics_section import VALUES, circles, drawn

from axisrig.bench.statistics.distribution import normal_plot

HALF_PX = 0.06
"""Places are written with a tenth of a pixel."""


def ends_of(svg: ElementTree.Element, kind: str) -> list[tuple[float, ...]]:
    return [
        tuple(float(line.get(name, "")) for name in ("x1", "y1", "x2", "y2"))
        for line in svg.iter("line")
        if line.get("class") == kind
    ]


def place_of(values: Sequence[float], places: Sequence[float], value: float) -> float:
    """Where a value is on the scale on which some values have some places."""
    low, high = int(np.argmin(values)), int(np.argmax(values))
    share = (value - values[low]) / (values[high] - values[low])
    return places[low] + share * (places[high] - places[low])


SAMPLES = {
    "even": VALUES,
    "a long tail up": (0.0, 0.0, 0.0, 1.0, 10.0),  # mean - 1.1 s is below every value
    "a long tail down": (0.0, -1.0, -10.0, 0.0, 0.0),
    "two heaps": (0.0, 0.0, 5.0, 5.0),
    "far from 0": (1000.1, 1000.3, 1000.2, 1000.9, 1000.2),
    "normal": (-1.5, -0.7, -0.3, 0.0, 0.3, 0.7, 1.5),
    "small": (1e-6, 3e-6, 2e-6, 9e-6),
}


@pytest.mark.parametrize("name", SAMPLES)
def test_the_line_of_a_normal_plot_is_mean_and_spread(name: str) -> None:
    """At a quantile q it is at mean + s q, however far it goes; and it stays among the values."""
    values = SAMPLES[name]
    _, _, normal = drawn(values)
    plot, middle, s = normal_plot(values), fmean(values), stdev(values)
    dots = circles(normal)
    across, up = [x for x, _ in dots], [y for _, y in dots]
    ((x1, y1, x2, y2),) = ends_of(normal, "st-mean")
    for x, y, q_end in ((x1, y1, plot.quantiles[0]), (x2, y2, plot.quantiles[-1])):
        height = min(max(middle + q_end * s, min(values)), max(values))
        q = (height - middle) / s
        assert y == pytest.approx(place_of(plot.values, up, height), abs=2 * HALF_PX)
        assert x == pytest.approx(place_of(plot.quantiles, across, q), abs=2 * HALF_PX)
    assert x1 < x2
    assert y1 > y2


def test_equal_values_have_no_line_of_mean_and_spread() -> None:
    _, _, normal = drawn((2.0, 2.0, 2.0))
    assert ends_of(normal, "st-mean") == []


@pytest.mark.parametrize("limits", [(-1.0, 2.0), (None, 0.25), (-0.5, None), (-7.0, -6.0)])
@pytest.mark.parametrize("name", ["even", "normal"])
def test_limits_and_mean_are_at_their_values(
    name: str, limits: tuple[float | None, float | None]
) -> None:
    """Beside the dots in their order, and between the bins of the histogram."""
    values = SAMPLES[name]
    order, bars, _ = drawn(values, *limits)
    up = [y for _, y in circles(order)]
    known = [limit for limit in limits if limit is not None]
    for kind, wanted in (("st-limit", known), ("st-mean", [fmean(values)])):
        found = ends_of(order, kind)
        assert [y1 for _, y1, _, _ in found] == [y2 for _, _, _, y2 in found]
        assert [y for _, y, _, _ in found] == pytest.approx(
            [place_of(values, up, value) for value in wanted], abs=0.3
        )
    boxes = [box for box in bars.iter("rect") if box.get("class") == "st-bin"]
    titles = [title.text or "" for title in bars.findall("rect/title")]
    edges = [float(text.split(" to ")[0]) for text in titles]
    places = [float(box.get("x", "")) for box in boxes]
    found = ends_of(bars, "st-limit")
    slope = (places[-1] - places[0]) / (edges[-1] - edges[0])
    for (x1, _, x2, _), limit in zip(found, known, strict=True):
        assert x1 == x2
        far = abs(limit - edges[0]) / (edges[-1] - edges[0])
        assert x1 == pytest.approx(places[0] + slope * (limit - edges[0]), abs=0.1 + 0.2 * far)
