"""What the plots of distance control show: surfaces, limits, lanes and buttons, of two controls."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.distance.control_findings import (
    DEGREE,
    MM,
    ControlFindings,
    DeadCycles,
    DistanceStretch,
    UsedLimit,
)
from axisrig.reports.distance.path import WIDTH, drawing
from axisrig.reports.distance.signals import (
    STATES,
    lanes,
    limits,
    name_of,
    windows,
    with_surfaces,
)

MS = 1_000_000
ON, CONST = "ACTIVE", "ACTIVE_CONST_DIST"


def part(begin_ms: int, end_ms: int, state: str, is_dry_run: bool = False) -> DistanceStretch:
    return DistanceStretch(begin_ms * MS, end_ms * MS, state, "NC", is_dry_run, None, None, None)


def control(
    *stretches: DistanceStretch, axis: str = "Z", unit: str = MM, **more: Any
) -> ControlFindings:
    given = {"zero_mm": 0.0, "period_ms": 1.0, "late_cycles": 0, "laws": (), **more}
    return ControlFindings(axis, unit, "gap", stretches=stretches, dead=DeadCycles(1), **given)


def used(key: str, value: float) -> UsedLimit:
    return UsedLimit(key, "P", value, "mm", None, "clamps")


LIMITS = (used("max_deviation", 5.0), used("max_pos", 8.0), used("min_pos", -7.0),
          used("v_max", 100.0), used("a_max", 9.0))  # fmt: skip


def lines(*controls: ControlFindings) -> list[tuple[str, str, float]]:
    return [(each["plot"], each["axis"], each["value"]) for each in limits(controls)]


def test_limits_of_an_axis_are_in_the_plots_of_its_modes() -> None:
    """The step in a cycle of 2 ms is 0.2 mm; a distance is minus the sensor value."""
    ends = [("offset", "Z", 5.0), ("offset", "Z", -5.0)]
    step = [("step", "Z", 0.2), ("step", "Z", -0.2)]
    surface = control(part(0, 9, ON), part(9, 20, CONST), limits=LIMITS, period_ms=2.0)
    assert lines(surface) == [*ends, ("sensor", "Z", 8.0), ("sensor", "Z", -7.0), *step]
    distance = control(part(0, 9, CONST), limits=LIMITS, period_ms=2.0)
    assert lines(distance) == [*ends, ("distance", "Z", -8.0), ("distance", "Z", 7.0), *step]


def test_limits_of_an_axis_that_turns_and_of_the_channel() -> None:
    turned = control(part(0, 9, ON), axis="C", unit=DEGREE, limits=LIMITS[:2])
    assert lines(turned) == [("offset_angle", "C", 5.0), ("offset_angle", "C", -5.0),
                             ("sensor_angle", "C", 8.0)]  # fmt: skip
    channel = control(part(0, 9, CONST), axis="channel", limits=LIMITS[1:3])
    assert lines(channel) == [
        ("distance", "channel", 8.0), ("sensor", "channel", 8.0),
        ("distance", "channel", -7.0), ("sensor", "channel", -7.0),
    ]  # fmt: skip


def test_lanes_are_of_every_stretch_of_every_control() -> None:
    two = [
        control(part(0, 5, "INACTIVE"), part(5, 9, ON, is_dry_run=True)),
        control(part(1, 2, CONST), axis="X"),
    ]
    assert [(each["axis"], each["start_ns"] // MS, each["end_ns"] // MS, each["label"])
            for each in lanes(two)] == [
        ("Z", 0, 5, "INACTIVE"), ("Z", 5, 9, "ACTIVE (dry run)"), ("X", 1, 2, CONST),
    ]  # fmt: skip


def labels(*controls: ControlFindings) -> list[str]:
    return [each["label"] for each in windows(controls)]


def test_buttons_are_of_all_and_of_each_part_while_they_are_few() -> None:
    """One part is the whole; up to six have a button, those of one name a number."""
    off = part(0, 10, "INACTIVE")
    assert labels(control(off)) == []
    assert labels(control(off, part(10, 20, ON))) == ["distance control"]
    several = control(off, part(10, 20, ON), part(20, 30, "TURNING_OFF"), part(40, 50, ON))
    assert labels(several) == ["distance control", "active 1", "turning off", "active 2"]
    for count, shown in ((6, 7), (7, 1)):
        many = [part(10 * n, 10 * n + 10, ON) for n in range(count)]
        assert len(labels(control(*many))) == shown
    two = labels(control(part(0, 9, ON)), control(part(0, 9, ON), axis="X"))
    assert two == ["distance control Z", "distance control X"]


def test_a_window_has_a_margin_of_6_per_cent_and_5_ms_at_least() -> None:
    for end_ms, begin, end in ((1100, 40.0, 1160.0), (120, 95.0, 125.0)):
        (found,) = windows([control(part(0, 50, "INACTIVE"), part(100, end_ms, ON))])
        assert (found["start_ns"] / MS, found["end_ns"] / MS) == (begin, end)


# Signals


def trace(**columns: Sequence[float]) -> pa.Table:
    rows = len(next(iter(columns.values())))
    return pa.table(
        {"time_ns": np.arange(rows, dtype=np.int64) * MS}
        | {name.replace("__", "."): np.array(each, np.float64) for name, each in columns.items()}
    )


STATE = [STATES.index(name) for name in ("INACTIVE", ON, CONST)]


def shown(found: pa.Table, name: str) -> list[float]:
    return [float(value) for value in found.column(name).to_numpy()]


def test_what_is_filtered_is_a_surface_or_a_distance_by_its_state() -> None:
    """Filtered 1, 2, 3 over SET_POS 40: the surface is at 42 in row 1, the distance 3 in row 2."""
    table = trace(Z__distance_state=STATE, Z__filtered_mm=[1, 2, 3], Z__set_pos_mm=[40] * 3,
                  Z__truth_mm=[50] * 3, gap__distance_true_mm=[8, 9, 10])  # fmt: skip
    found = with_surfaces(table, [control(part(0, 9, ON), part(9, 20, CONST), zero_mm=3.0)])
    assert shown(found, "Z.filtered_surface_mm") == pytest.approx([np.nan, 42, np.nan], nan_ok=True)
    assert shown(found, "Z.filtered_distance_mm") == pytest.approx([np.nan, np.nan, 3], nan_ok=True)
    # The control counts from the zero of its sensor, 3 mm
    assert shown(found, "Z.gap_true_mm") == [5, 6, 7]
    assert shown(found, "Z.surface_truth_mm") == [45, 44, 43]
    assert not {"Z.filtered_mm", "gap.distance_true_mm"} & set(found.column_names)


@pytest.mark.parametrize(
    ("states", "axis", "left"),
    [
        ((ON,), "Z", {"set_pos_mm", "surface_cnc_mm", "sensor_mm"}),
        ((CONST,), "Z", {"set_dist_mm", "distance_cnc_mm"}),
        ((ON, CONST), "Z",
         {"set_pos_mm", "surface_cnc_mm", "sensor_mm", "set_dist_mm", "distance_cnc_mm"}),
        (("FREEZE",), "Z", {"sensor_mm"}),
        ((ON,), "channel",
         {"set_pos_mm", "surface_cnc_mm", "sensor_mm", "set_dist_mm", "distance_cnc_mm"}),
    ],
)  # fmt: skip
def test_what_no_mode_needs_is_left_out(states: tuple[str, ...], axis: str, left: set[str]) -> None:
    names = ("set_pos_mm", "surface_cnc_mm", "sensor_mm", "set_dist_mm", "distance_cnc_mm",
             "distance_held", "distance_override_pct")  # fmt: skip
    table = trace(**{f"{axis}__{name}": [1.0] for name in names}, X__sensor_mm=[2.0])
    found = with_surfaces(table, [control(*(part(0, 9, each) for each in states), axis=axis)])
    kept = {name.partition(".")[2] for name in found.column_names if name.startswith(axis)}
    assert kept == left
    assert "X.sensor_mm" in found.column_names


def test_signals_of_an_axis_that_turns_end_in_degrees_where_the_trace_has_them_so() -> None:
    turned, straight = control(axis="C", unit=DEGREE), control(axis="C")
    assert name_of(["C.offset_deg"], turned, "offset_mm") == "C.offset_deg"
    assert name_of(["C.offset_mm"], turned, "offset_mm") == "C.offset_mm"
    assert name_of(["C.offset_deg", "C.offset_mm"], straight, "offset_mm") == "C.offset_mm"
    assert name_of(["C.distance_state"], turned, "distance_state") == "C.distance_state"
    table = trace(C__distance_state=STATE, C__filtered_deg=[1, 2, 3])
    found = with_surfaces(table, [control(part(0, 9, CONST), axis="C", unit=DEGREE)])
    assert "C.filtered_distance_deg" in found.column_names


# The picture of the path


def path(way_mm: float = 10.0, late: int = 0, **more: Any) -> str:
    """X goes evenly over 11 rows while Z follows: tool at 5, gap 2, set 6, offset 0 to 1."""
    columns = {
        "Z__distance_state": [STATES.index(ON)] * 11, "Z__truth_mm": [5.0] * 11,
        "gap__distance_true_mm": [2.0] * 11, "Z__set_mm": [6.0] * 11,
        "Z__offset_mm": np.linspace(0.0, 1.0, 11), "X__truth_mm": np.linspace(0.0, way_mm, 11),
        "Y__truth_mm": np.linspace(0.0, way_mm / 2, 11), **more,
    }  # fmt: skip
    known = {name: values for name, values in columns.items() if values is not None}
    return drawing(trace(**known), control(part(0, 11, ON), late_cycles=late))


def heights(svg: str, kind: str) -> list[float]:
    points = re.findall(rf'<polyline class="{kind}" points="([^"]*)"', svg)
    return [float(pair.split(",")[1]) for pair in points[0].split()] if points else []


def test_surface_tool_and_programmed_path_are_over_the_axis_that_moves_most() -> None:
    """Surface 3, tool 5, programmed 6 falling to 5; large values are at the top."""
    svg = path()
    assert "X in mm" in svg
    surface, tool = heights(svg, "dp-surface"), heights(svg, "dp-tool")
    per_mm = (surface[0] - tool[0]) / 2
    assert per_mm > 0
    kinds = set(re.findall(r'polyline class="([\w-]+)"', svg))
    (kind,) = kinds - {"dp-surface", "dp-tool"}
    programmed = heights(svg, kind)
    assert tool[0] - programmed[0] == pytest.approx(per_mm, abs=0.2)
    assert programmed[-1] == pytest.approx(tool[0], abs=0.2)
    # An offset that is sent two cycles later: 0.8 of it at the end
    late = heights(path(late=2), kind)
    assert heights(path(late=2), "dp-tool")[0] - late[-1] == pytest.approx(0.2 * per_mm, abs=0.3)


@pytest.mark.parametrize(
    "changes",
    [{"way_mm": 0.9}, {"X__truth_mm": None, "Y__truth_mm": None}, {"gap__distance_true_mm": None},
     {"Z__truth_mm": None}, {"Z__distance_state": [STATES.index("FREEZE")] * 11}],
)  # fmt: skip
def test_without_a_way_or_a_truth_there_is_no_picture(changes: dict[str, Any]) -> None:
    assert path(**changes) == ""
    assert drawing(None, control(part(0, 11, ON))) == ""
    assert path(way_mm=1.0) != ""


def along(svg: str) -> tuple[str, ...]:
    """The axis that a picture is over."""
    return tuple(re.findall(r'class="dp-end"[^>]*>(\w+) in mm<', svg))


@pytest.mark.parametrize("state", sorted(STATES))
def test_a_path_is_over_the_axis_that_moves_most_while_the_control_follows(state: str) -> None:
    """X goes 90 mm before and after, Y 8 mm meanwhile: in the first and last 3 of 11 rows."""
    states = [STATES.index("INACTIVE")] * 3 + [STATES.index(state)] * 5
    states += [STATES.index("INACTIVE")] * 3
    x = [0.0, 20.0, 40.0, *[45.0] * 5, 50.0, 70.0, 90.0]
    y = [0.0, 0.0, 0.0, 0.0, 2.0, 4.0, 6.0, 8.0, 8.0, 8.0, 8.0]
    svg = path(Z__distance_state=states, X__truth_mm=x, Y__truth_mm=y)
    assert along(svg) == (("Y",) if state in (ON, CONST) else ())
    assert path(Z__distance_state=states, X__truth_mm=x, Y__truth_mm=[0.0] * 11) == ""


@pytest.mark.parametrize(
    ("x", "y", "name"),
    [((0.0, 5.0), (0.0, 4.0), "X"), ((0.0, -5.0), (0.0, 4.0), "X"), ((5.0, 0.0), (0.0, 6.0), "Y"),
     ((300.0, 302.0), (-1.5, 1.5), "Y")],
)  # fmt: skip
def test_how_far_an_axis_goes_counts_and_not_where_it_is(
    x: tuple[float, float], y: tuple[float, float], name: str
) -> None:
    assert along(path(X__truth_mm=np.linspace(*x, 11), Y__truth_mm=np.linspace(*y, 11))) == (name,)


def test_the_axis_of_the_control_itself_is_no_way() -> None:
    svg = path(Z__truth_mm=np.linspace(0.0, 50.0, 11))
    assert along(svg) == ("X",)


@pytest.mark.parametrize(
    ("x", "shares"),
    [
        ((0.0, 10.0), (0.0, 1.0)), ((10.0, 0.0), (1.0, 0.0)), ((-3.0, -8.0), (1.0, 0.0)),
        ((0.0, 10.0, 0.0), (0.0, 1.0, 0.0)), ((5.0, 10.0, 0.0, 5.0), (0.5, 1.0, 0.0, 0.5)),
    ],
)  # fmt: skip
def test_a_path_is_as_wide_as_its_picture_whichever_way_it_goes(
    x: Sequence[float], shares: Sequence[float]
) -> None:
    """The smallest place is at the left, the largest one at the right."""
    at = np.linspace(0.0, len(x) - 1.0, 13)
    still = {"Z__distance_state": 1.0, "gap__distance_true_mm": 2.0, "Z__truth_mm": 5.0,
             "Z__set_mm": 5.0, "Z__offset_mm": 0.0, "Y__truth_mm": 0.0}  # fmt: skip
    rows = {name: [value] * 13 for name, value in still.items()}
    svg = path(X__truth_mm=np.interp(at, range(len(x)), x), **rows)
    (points,) = re.findall(r'class="dp-surface" points="([^"]*)"', svg)
    places = [float(point.split(",")[0]) for point in points.split()]
    left, right = 54.0, WIDTH - 10.0
    assert (min(places), max(places)) == (left, right)
    ends = [places[round(number * 12 / (len(x) - 1))] for number in range(len(x))]
    assert [(place - left) / (right - left) for place in ends] == pytest.approx(shares, abs=1e-3)
