"""Drawings of samples: what they show, and that they stay small."""

import dataclasses
import math
import re
from statistics import NormalDist, stdev
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts

from axisrig.bench.judge.statistics.summary import describe
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import MS
from axisrig.reports.statistics.drawings import DOTS, HEIGHT, drawings
from axisrig.reports.statistics.section import statistics_views

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


@pytest.mark.parametrize("limits", [(0.0, 1.0), (-1.0, 0.0), (0.0, None)])
def test_a_limit_of_0_is_a_limit(limits: tuple[float | None, float | None]) -> None:
    order, bars, _ = drawn(VALUES, *limits)
    count = sum(limit is not None for limit in limits)
    assert (lines(order, "st-limit"), lines(bars, "st-limit")) == (count, count)


@pytest.mark.parametrize("scale", [1.0, 100.0])
def test_the_curve_is_as_high_as_the_bars_of_a_normal_sample(scale: float) -> None:
    """n w / (s sqrt(2 pi)) values are in a bin of width w in the middle, whatever the unit."""
    normal = NormalDist()
    values = tuple(scale * normal.inv_cdf((n + 0.5) / 400) for n in range(400))
    _, bars, _ = drawn(values)
    counts = [int(re.findall(r"\d+$", t.text or "")[0]) for t in bars.findall("rect/title")]
    heights = [float(b.get("height", "")) for b in bars.iter("rect") if b.get("class") == "st-bin"]
    (curve,) = bars.iter("polyline")
    ys = [float(point.split(",")[1]) for point in curve.get("points", "").split()]
    base = HEIGHT - 16.0
    assert (base - min(ys)) / max(heights) == pytest.approx(
        400 * _width(bars) / (stdev(values) * math.sqrt(2 * math.pi)) / max(counts),
        rel=0.02,
    )


def _width(bars: ElementTree.Element) -> float:
    """Width of a bin in the unit of the values, from what its title says."""
    low, high = re.match(r"(\S+) to (\S+):", bars.findall("rect/title")[0].text or "").groups()  # type: ignore[union-attr]
    return float(high) - float(low)


def test_samples_of_all_touches_and_of_the_last_ones_are_two() -> None:
    """Two runs of the same case: 1, 2 and 3, 4 were measured; the last ones are 2 and 4."""

    def run(name: str, values: tuple[float, ...]) -> Any:
        runs = tuple(
            MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=MS, latched_mm={"Z": v}) for v in values
        )
        axes = {"Z": AxisRecord("can1", 1, 1.0)}
        columns = {"time_ns": np.arange(3) * MS, "Z.truth_mm": np.zeros(3)}
        case = {"plan": "p", "case": "c", "frame_log_sha256": name}
        return SimpleNamespace(
            run=name, case=case, checks=[], is_statistic=False,
            judged_facts=facts(axes=axes, runs=runs), trace=pa.table(columns),
        )  # fmt: skip

    asked = [
        SimpleNamespace(metric=metric, asked="<= 9", reference="here", lower="", upper="")
        for metric in ("mean(latch_mm:Z)", "mean(latch_mm:Z; last)", "count(latch_mm:Z)")
    ]
    row = SimpleNamespace(
        run="p-c", case={"plan": "p", "case": "c"}, checks=asked, is_statistic=True
    )
    members = [run("a", (1.0, 2.0)), run("b", (3.0, 4.0))]
    views = list(statistics_views(SimpleNamespace(planned=[*members, row])))  # type: ignore[arg-type]
    found = [([value for _, value in view.found.values], len(view.checks)) for view in views]
    assert found == [([1.0, 2.0, 3.0, 4.0], 2), ([2.0, 4.0], 1)]


@pytest.mark.parametrize(
    ("of_runs", "drawn"),
    [
        ([("1", "3"), ("1", "3")], (1.0, 3.0)),
        ([("", "3"), ("", "3")], (3.0,)),
        ([("1", "3"), ("1", "4")], ()),  # another one in a run: none is that of the sample
        ([], ()),
    ],
)
def test_limits_of_a_sample_are_those_of_its_runs_and_none_of_its_statistics(
    of_runs: list[tuple[str, str]], drawn: tuple[float, ...]
) -> None:
    """The row of the case asks for a mean of at most 9; its runs check the metric itself."""

    def row(metric: str, lower: str, upper: str) -> Any:
        return SimpleNamespace(
            metric=metric, asked="<= 9", reference="here", lower=lower, upper=upper
        )

    def run(name: str, checks: list[Any], *, is_statistic: bool) -> Any:
        runs = (MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=MS, latched_mm={"Z": 2.0}),)
        trace = pa.table({"time_ns": np.arange(3) * MS, "Z.truth_mm": np.zeros(3)})
        case = {"plan": "p", "case": "c", "frame_log_sha256": name}
        return SimpleNamespace(
            run=name, case=case, checks=checks, is_statistic=is_statistic, trace=trace,
            judged_facts=facts(axes={"Z": AxisRecord("can1", 1, 1.0)}, runs=runs),
        )  # fmt: skip

    limits = [[row("latch_mm:Z", *ends)] for ends in of_runs] or [[], []]
    members = [run(f"r{n}", checks, is_statistic=False) for n, checks in enumerate(limits)]
    whole = run("p-c", [row("mean(latch_mm:Z)", "", "9"), row("latch_mm:Z", "7", "8")],
                is_statistic=True)  # fmt: skip
    (view,) = statistics_views(SimpleNamespace(planned=[*members, whole]))  # type: ignore[arg-type]
    assert tuple(view.found.limits) == drawn


def test_each_drawing_has_ticks_on_both_axes() -> None:
    """Of 0.4 to -0.2: 0.0, 0.2 and 0.4 at least; of six values the first and the last."""
    order, bars, normal = drawn(VALUES, -1.0, 1.0)
    for svg in (order, bars, normal):
        words = [word for word in svg.iter("text") if word.get("class") == "ax-word"]
        sides = [word.get("text-anchor") for word in words]
        assert min(sides.count("end"), sides.count("middle")) >= 2
    numbers = [w.text for w in order.iter("text") if w.get("text-anchor") == "middle"]
    assert (numbers[0], numbers[-1]) == ("1", "6")


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


EVEN = tuple(n / 100 for n in range(100))


@pytest.mark.parametrize(
    ("values", "limits"),
    [
        (VALUES, (None, None)),
        (EVEN, (None, None)),
        (EVEN, (-30.0, 0.5)),
        ((*EVEN, 40.0), (None, 90.0)),
        (tuple(-v for v in EVEN), (-0.2, None)),
        ((0.0,) * 20 + (1.0,) * 20, (0.0, 1.0)),
    ],
)
def test_all_that_is_drawn_of_a_sample_is_in_its_field(
    values: tuple[float, ...], limits: tuple[float | None, float | None]
) -> None:
    """Of values that lie evenly the normal curve is higher than every bar."""
    for svg in drawn(values, *limits):
        (frame,) = [box for box in svg.iter("rect") if box.get("class") == "ax-field"]
        left, top = (float(frame.get(name, "")) for name in "xy")
        right, foot = left + float(frame.get("width", "")), top + float(frame.get("height", ""))
        places = circles(svg)
        for line in svg.iter("polyline"):
            places += [tuple(map(float, at.split(","))) for at in line.get("points", "").split()]  # type: ignore[misc]
        for line in svg.iter("line"):
            ends = [float(line.get(name, "")) for name in ("x1", "y1", "x2", "y2")]
            places += [(ends[0], ends[1]), (ends[2], ends[3])]
        for bar in svg.iter("rect"):
            x, y, width, height = (float(bar.get(n, "")) for n in ("x", "y", "width", "height"))
            places += [(x, y), (x + width, y + height)]
        assert all(left - 0.2 <= x <= right + 0.2 for x, _ in places)
        assert all(top - 0.2 <= y <= foot + 0.2 for _, y in places)


@pytest.mark.parametrize(
    ("count", "named"),
    [
        (3, [1, 2, 3]),
        (7, [1, 2, 3, 4, 5, 6, 7]),
        (10, [1, 2, 4, 6, 8, 10]),
        (11, [1, 2, 4, 6, 8, 10, 11]),
        (12, [1, 2, 4, 6, 8, 10, 12]),
        (101, [1, 20, 40, 60, 80, 101]),  # 100 would cover 101
        (109, [1, 22, 44, 66, 88, 109]),
        (111, [1, 22, 44, 66, 88, 111]),  # 110 is nearer to the last than half a step
    ],
)
def test_about_five_numbers_are_named_beside_the_first_and_the_last(
    count: int, named: list[int]
) -> None:
    """None nearer to the last one than half of what the others are apart."""
    order, *_ = drawn(tuple(float(n % 7) for n in range(count)))
    lines_of = [path for path in order.iter("path") if path.get("class") == "ax-grid"]
    upright = [path for path in lines_of if "V" in path.get("d", "")]
    assert len(upright) == len(named)
    words = [w.text for w in order.iter("text") if w.get("text-anchor") == "middle"]
    assert set(words) <= {str(number) for number in named}
    assert {"1", str(count)} <= set(words)


@pytest.mark.parametrize(("p_value", "words"), [(0.0, ", p 0"), (0.0312, ", p 0.031"), (None, "")])
def test_a_normal_plot_names_its_p_value(p_value: float | None, words: str) -> None:
    """A p value of 0 is shown too: no normal sample would look like this."""
    found = dataclasses.replace(describe(list("abcdef"), VALUES, None, None), normality_p=p_value)
    text = drawings(found, "m")[2]
    assert f">normal plot{words}</text>" in text


def test_a_statistic_of_each_run_has_no_sample_of_its_own() -> None:
    """`each` asks for the touches of one run: it is a value of the run, and none over runs."""
    runs = tuple(
        MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=MS, latched_mm={"Z": v}) for v in (1.0, 2.0)
    )
    columns = {"time_ns": np.arange(3) * MS, "Z.truth_mm": np.zeros(3)}

    def asked(metric: str) -> Any:
        return SimpleNamespace(metric=metric, asked="<= 9", reference="here", lower="", upper="")

    def views(*metrics: str) -> list[Any]:
        one: Any = SimpleNamespace(
            run="a", case={"plan": "p", "case": "c", "frame_log_sha256": "a"}, is_statistic=False,
            checks=[asked(metric) for metric in metrics], trace=pa.table(columns),
            judged_facts=facts(axes={"Z": AxisRecord("can1", 1, 1.0)}, runs=runs),
        )  # fmt: skip
        return list(statistics_views(SimpleNamespace(planned=[one])))  # type: ignore[arg-type]

    assert views("mean(latch_mm:Z; each)", "spread(latch_mm:Z; each)") == []
    (view,) = views("mean(latch_mm:Z; each)", "mean(latch_mm:Z)", "no_metric(x)")
    assert [row.metric for row in view.checks] == ["mean(latch_mm:Z)"]
    assert [value for _, value in view.found.values] == [1.0, 2.0]
