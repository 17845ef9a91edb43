"""The polylines of the picture of a path: which rows are points, and what they are called.

The field is 180 px high; above and below the values there are 8 % of them. 600 rows are drawn one
by one, of more the lowest and the highest of each of 300 bins, the first and the last one.
"""

import re
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.reports.test_signals_of_distance import MS, ON, STATES, control, part

from axisrig.bench.judge.distance.control_findings import DEGREE, ControlFindings
from axisrig.reports.distance.path import drawing

TOP, FOOT = 14.0, 194.0
LEFT, RIGHT = 54.0, 890.0
GAP_MM = 2.0


def picture(rows: int, of: ControlFindings | None = None, unit: str = "mm", **more: Any) -> str:
    """X goes 30 mm while the axis follows, 2 mm above a surface."""
    of = of or control(part(0, rows, ON))
    columns = {
        f"{of.axis}.distance_state": np.full(rows, float(STATES.index(ON))),
        f"{of.axis}.truth_{unit}": np.full(rows, 5.0),
        "gap.distance_true_mm": np.full(rows, GAP_MM),
        "X.truth_mm": np.linspace(0.0, 30.0, rows),
        **{name.replace("__", "."): values for name, values in more.items()},
    }
    return drawing(pa.table({"time_ns": np.arange(rows) * MS, **columns}), of)


def path(
    rows: int, of: ControlFindings | None = None, **more: Any
) -> dict[str, list[tuple[float, float]]]:
    """Points of each line, px."""
    svg = picture(rows, of, **more)
    assert "nan" not in svg
    return {
        kind: [(float(x), float(y)) for x, y in (pair.split(",") for pair in points.split())]
        for kind, points in re.findall(r'<polyline class="dp-(\w+)" points="([^"]*)"', svg)
    }


def height(value: float, low: float, high: float) -> float:
    room = 0.08 * (high - low)
    return FOOT - (value - low + room) / (high - low + 2 * room) * (FOOT - TOP)


@pytest.mark.parametrize(("rows", "points"), [(11, 11), (600, 600), (601, None), (5000, None)])
def test_few_rows_are_drawn_one_by_one_and_many_in_bins(rows: int, points: int | None) -> None:
    """In either case from the left end to the right one, in their order."""
    tool = path(rows)["tool"]
    assert len(tool) == points if points else 300 <= len(tool) <= 602
    assert [tool[0][0], tool[-1][0]] == [LEFT, RIGHT]
    assert tool == sorted(tool)


@pytest.mark.parametrize("rows", [500, 5000])
def test_a_peak_of_one_row_is_drawn_in_either_direction(rows: int) -> None:
    """The tool is at 9 in one row and at 1 in another one near it; the surface is 2 lower."""
    truth = np.full(rows, 5.0)
    truth[rows // 3], truth[rows // 3 + 3] = 9.0, 1.0
    found = path(rows, Z__truth_mm=truth)
    for kind, off in (("tool", 0.0), ("surface", -GAP_MM)):
        heights = [y for _, y in found[kind]]
        ends = [height(value + off, -1.0, 9.0) for value in (9.0, 1.0)]
        assert [min(heights), max(heights)] == pytest.approx(ends, abs=0.06)
        assert heights[0] == pytest.approx(height(5.0 + off, -1.0, 9.0), abs=0.06)


@pytest.mark.parametrize("rows", [500, 5000])
def test_where_the_sensor_sees_no_surface_the_tool_is_drawn_alone(rows: int) -> None:
    """In every second row and in the whole first half; a peak in the rows that are left stays."""
    gap = np.full(rows, GAP_MM)
    gap[::2], gap[: rows // 2] = np.nan, np.nan
    gap[rows // 2 + 51] = 3.0
    found = path(rows, gap__distance_true_mm=gap)
    assert found["surface"][0][0] >= (LEFT + RIGHT) / 2 - 0.1
    assert max(y for _, y in found["surface"]) == pytest.approx(height(2.0, 2.0, 5.0), abs=0.06)
    assert [found["tool"][0][0], found["tool"][-1][0]] == [LEFT, RIGHT]


@pytest.mark.parametrize("late", [0, 1, 3])
def test_an_offset_that_is_there_from_the_begin_is_none_of_the_programmed_path(late: int) -> None:
    """Set positions of 6 with an offset of 1: programmed is 5, as the tool is, in the first row
    too.
    """
    more = {"Z__set_mm": np.full(11, 6.0), "Z__offset_mm": np.full(11, 1.0)}
    found = path(11, control(part(0, 11, ON), late_cycles=late), **more)
    assert [y for _, y in found["program"]] == [y for _, y in found["tool"]]


@pytest.mark.parametrize("missing", ["Z__set_mm", "Z__offset_mm"])
def test_without_set_position_or_offset_no_path_is_programmed(missing: str) -> None:
    more = {"Z__set_mm": np.full(11, 6.0), "Z__offset_mm": np.full(11, 1.0)}
    assert set(path(11, **more)) == {"program", "surface", "tool"}
    del more[missing]
    assert set(path(11, **more)) == {"surface", "tool"}


def test_an_axis_that_turns_has_its_unit() -> None:
    """X is a length all the same."""
    svg = picture(11, control(part(0, 11, ON), axis="C", unit=DEGREE), "deg")
    assert re.findall(r"<text[^>]*>([CX] in [^<]*)</text>", svg) == ["C in °", "X in mm"]
    assert 'aria-label="C in ° of surface and tool over X in mm"' in svg
