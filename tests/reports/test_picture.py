"""The drawing beside a failure: signal and limit lie where the numbers say."""

import re
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.plan.checks import parse_check, plot_limits
from axisrig.reports.parts.picture import HEIGHT, WIDTH, picture
from axisrig.reports.signals import chart

MS = 1_000_000


def ramp(rows: int = 2000) -> pa.Table:
    """Z goes from 0 to 10 mm, its lag is a triangle of 1 mm in the middle."""
    row = np.arange(rows)
    return pa.table(
        {
            "time_ns": row.astype(np.int64) * MS,
            "Z.actual_mm": 10.0 * row / (rows - 1),
            "Z.cnc_lag_mm": 1.0 - np.abs(row - rows / 2) / (rows / 2),
        }
    )


def drawn(metric: str, condition: str, *events: Event) -> str:
    limits = plot_limits(parse_check(metric, condition, "a.csv:2"))
    table = ramp()
    description, _ = chart(table, RunFindings(events=events), limits=limits)
    return picture(table, description, metric)


def points(svg: str) -> np.ndarray:
    (text,) = re.findall(r'<polyline class="pic-signal" points="([^"]*)"', svg)
    return np.array([[float(part) for part in pair.split(",")] for pair in text.split()])


def limit_places(svg: str) -> list[float]:
    return [float(y) for y in re.findall(r'class="pic-limit" [^>]*y1="([\d.]+)"', svg)]


def test_the_peak_is_above_the_limit_that_it_breaks() -> None:
    """The lag of 1 mm peaks in the middle; the limits of a magnitude are 0.5 and -0.5 mm."""
    svg = drawn("lag_mm_max:Z", "<= 0.5")
    found = points(svg)
    peak_x, peak_y = found[found[:, 1].argmin()]
    low, high = sorted(limit_places(svg))  # y grows downwards
    assert peak_y < low
    assert peak_x == pytest.approx(WIDTH / 2, abs=4)
    zero = found[0, 1]
    assert (low + high) / 2 == pytest.approx(zero, abs=0.2)
    assert (zero - low) / (zero - peak_y) == pytest.approx(0.5, abs=0.02)
    assert "limit -0.5 and 0.5" in svg
    assert found[:, 0].max() <= WIDTH
    assert 0 <= found[:, 1].min() <= found[:, 1].max() <= HEIGHT


def test_without_a_limit_in_a_plot_the_position_is_drawn_around_what_happened() -> None:
    """An edge at 500 ms; the stretch with a button ends long before 2 s."""
    event = Event(500 * MS, "edge", "edge")
    svg = drawn("latch_error_um:Z", "-0.2 .. 0.2", event)
    assert "Z actual, mm" in svg
    assert 'class="pic-mark k-edge"' in svg
    assert limit_places(svg) == []
    (end,) = re.findall(r'text-anchor="end">([\d.]+) ms<', svg)
    assert float(end) < 600


def test_what_is_not_there_is_not_drawn() -> None:
    table = ramp()
    assert picture(table, {}, "lag_mm_max:Z") == ""
    description, _ = chart(table, RunFindings())
    assert picture(table, description, "lag_mm_max:X") == ""
    nothing = table.set_column(1, "Z.actual_mm", pa.array(np.full(2000, np.nan)))
    assert picture(nothing, chart(nothing, RunFindings())[0], "latch_error_um:Z") == ""


def test_hostile_names_stay_text() -> None:
    table = ramp().rename_columns(["time_ns", "<b>.actual_mm", "<b>.cnc_lag_mm"])
    svg = picture(table, chart(table, RunFindings())[0], "alarms")
    assert "<b>" not in svg
    assert "&lt;b&gt;" in svg


@pytest.mark.parametrize("rows", [400, 2000])
def test_a_line_of_many_rows_goes_the_way_of_its_signal(rows: int) -> None:
    """Up, down, and up to the middle and down again; below 420 rows each has its point."""
    row = np.arange(rows, dtype=np.float64)
    up = row / (rows - 1)
    chart_of_z = {
        "plots": [{"plot": "position", "unit": "mm", "series": {"Z": [
            {"column": "Z.actual_mm", "style": "actual", "label": "actual"}]}}],
    }  # fmt: skip
    for values, turns in ((up, 0), (1.0 - up, 0), (1.0 - np.abs(2.0 * up - 1.0), 1)):
        table = pa.table({"time_ns": row.astype(np.int64) * MS, "Z.actual_mm": values})
        found = points(picture(table, chart_of_z, "latch_mm:Z"))
        steps = np.sign(-np.diff(found[:, 1]))  # y grows downwards
        steps = steps[steps != 0.0]
        assert steps[0] == np.sign(values[1] - values[0])
        assert np.count_nonzero(np.diff(steps)) == turns
        assert np.all(np.diff(found[:, 0]) >= 0.0)
        assert len(found) == rows if rows < 420 else len(found) <= 420


def one(column: str, style: str, label: str = "") -> dict[str, str]:
    return {"column": column, "style": style, "label": label or style}


def by_hand(**chart_has: Any) -> tuple[pa.Table, dict[str, Any]]:
    """Z, C and a channel over 1 s; each column has its own height."""
    rows = np.arange(0, 1001, 10)
    heights = {"Z.set_mm": 1.0, "Z.actual_mm": 2.0, "Z.truth_mm": 3.0, "C.actual_deg": 4.0,
               "channel.feed": 5.0, "Z.lag_mm": 6.0}  # fmt: skip
    table = pa.table({"time_ns": rows.astype(np.int64) * MS}
                     | {name: np.full(len(rows), at) for name, at in heights.items()})  # fmt: skip
    plots = [
        {"plot": "position", "unit": "mm", "series": {"Z": [
            one("Z.set_mm", "set"), one("Z.truth_mm", "truth"), one("Z.actual_mm", "actual")]}},
        {"plot": "angle", "unit": "°", "series": {"C": [one("C.actual_deg", "actual")]}},
        {"plot": "lag", "unit": "mm", "series": {"Z": [one("Z.lag_mm", "actual")]}},
        {"plot": "feed", "unit": "mm/min", "series": {"*": [one("channel.feed", "feed")]}},
    ]  # fmt: skip
    return table, {"plots": plots, "axis": "Z", **chart_has}


def height_of(svg: str) -> float:
    """The lower end of the scale: the only value, where all limits are above it."""
    (low,) = re.findall(r": ([\d.]+) to [\d.]+<", svg)
    return float(low)


def test_the_signal_of_a_picture_is_that_of_the_limits_or_the_position_of_the_axis() -> None:
    """What was measured before the truth, that before what was sent; an angle has a plot too."""
    lag = [{"plot": "lag", "label": "lag_mm_max:Z", "value": 6.5}]
    feed = [{"plot": "feed", "label": "feed_max", "value": 9.0}]
    for metric, chart_has, height, title in (
        ("latch_mm:Z", {}, 2.0, "Z actual, mm"), ("latch_mm", {}, 2.0, "Z actual, mm"),
        ("lag_mm_max:Z", {"limits": lag}, 6.0, "Z actual, mm"),
        ("latch_mm:Z", {"limits": lag}, 2.0, "Z actual, mm"),
        ("feed_max", {"limits": feed}, 5.0, "Z feed, mm/min"),
    ):  # fmt: skip
        table, description = by_hand(**chart_has)
        svg = picture(table, description, metric)
        assert height_of(svg) == height, metric
        assert f">{title}: " in svg
    table, description = by_hand()
    assert picture(table, description, "latch_mm:Q") == ""
    description["plots"] = description["plots"][1:]
    assert height_of(picture(table, description, "latch_deg:C")) == 4.0


def test_a_limit_is_named_with_all_its_digits() -> None:
    limit = [{"plot": "lag", "label": "lag_mm_max:Z", "value": 1234.567}]
    table, description = by_hand(limits=limit)
    assert ">limit 1234.567</text>" in picture(table, description, "lag_mm_max:Z")


def test_the_window_that_opens_is_drawn_with_what_happened_in_it() -> None:
    """From 200 to 400 ms; with limits the whole run. Marks at one place are one."""
    windows = [{"start_ns": 0, "end_ns": 100 * MS}, {"start_ns": 200 * MS, "end_ns": 400 * MS}]
    events = [{"time_ns": at * MS, "kind": kind} for at, kind in (
        (199, "edge"), (200, "contact"), (300, "edge"), (300, "edge"), (300, "pdo"),
        (310, "latch"), (320, "brake"), (400, "alarm"), (401, "fault"))]  # fmt: skip
    limits = [{"plot": "position", "label": "latch_mm:Z", "value": value}
              for value in (2.5, 1.5, 2.5)]  # fmt: skip
    for chart_has, span, kinds in (
        ({"windows": windows, "opens": 1}, ("200", "400"), ["contact", "edge", "latch", "alarm"]),
        ({"windows": windows, "opens": None}, ("0", "100"), []),
        ({"windows": windows, "opens": 1, "limits": limits}, ("0", "1000"),
         ["edge", "contact", "edge", "latch", "alarm", "fault"]),
        ({}, ("0", "1000"), ["edge", "contact", "edge", "latch", "alarm", "fault"]),
    ):  # fmt: skip
        table, description = by_hand(events=events, **chart_has)
        svg = picture(table, description, "latch_mm:Z")
        assert f"from {span[0]} ms to {span[1]} ms" in svg
        assert re.findall(r'class="pic-mark k-(\w+)"', svg) == kinds
        assert ("limit 1.5 and 2.5" in svg) is ("limits" in chart_has)
        assert len(limit_places(svg)) == (2 if "limits" in chart_has else 0)


@pytest.mark.parametrize(
    ("plots", "height"),
    [
        (("lag", "position"), 6.0),  # the first that is there
        (("position", "lag"), 2.0),
        (("torque", "position"), 2.0),
        (("position", "torque"), 2.0),
        (("torque", "force"), None),
    ],
)
def test_a_check_with_limits_in_several_plots_is_drawn_in_the_first(
    plots: tuple[str, ...], height: float | None
) -> None:
    limits = [{"plot": plot, "label": "latch_mm:Z", "value": 9.0} for plot in plots]
    svg = picture(*by_hand(limits=limits), "latch_mm:Z")
    if height is None:
        assert svg == ""
    else:
        assert height_of(svg) == height


@pytest.mark.parametrize(("first", "last"), [(19.0, 0.0), (0.0, 19.0)])
def test_a_signal_that_falls_in_each_column_is_drawn_falling(first: float, last: float) -> None:
    """20 values in each of 210 columns of pixels, a saw: its two ends are in their order."""
    rows = 210 * 20
    saw = np.tile(np.linspace(first, last, 20), 210)
    table = pa.table({"time_ns": np.arange(rows, dtype=np.int64) * MS, "Z.actual_mm": saw})
    description, _ = chart(table, RunFindings())
    ends = points(picture(table, description, "m"))[:, 1]
    assert len(ends) == 2 * 210
    falls = ends[::2] < ends[1::2]  # a smaller y is higher up
    assert falls.all() if first > last else not falls.any()


def test_a_gap_moves_nothing_that_is_behind_it() -> None:
    """Ten rows over 428 px, 6 px from either side: row 9 is at the right end, five are missing."""
    row = np.arange(10)
    values = np.where((row >= 2) & (row <= 6), np.nan, row * 1.0)
    table = pa.table({"time_ns": row * MS, "Z.actual_mm": values})
    description, _ = chart(table, RunFindings())
    found = points(picture(table, description, "latch_mm:Z"))
    assert found[:, 0] == pytest.approx([6 + 428 * at / 9 for at in (0, 1, 7, 8, 9)], abs=0.06)
    assert WIDTH == 440
    heights = found[:, 1]
    assert (heights[0] - heights) / (heights[0] - heights[-1]) == pytest.approx(
        np.array([0, 1, 7, 8, 9]) / 9, abs=0.01
    )
