"""Stretches of a run with a button, the order of its plots, and the axis that is shown first."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.event import Event
from axisrig.reports.parts.topic import Plots
from axisrig.reports.signals import _first_axis, _measurements, _plots, _series, _windows, windows

MS = 1_000_000
END_MS = 5000


def event(ms: float, kind: str, axis: str | None = None, is_warning: bool = False) -> Event:
    return Event(round(ms * MS), kind, kind, axis, is_warning)


def found(*events: Event) -> dict[str, tuple[float, float]]:
    """Windows in ms by their label; the run is from 0 to 5000 ms."""
    return {
        each["label"]: (each["start_ns"] / MS, each["end_ns"] / MS)
        for each in windows(events, 0, END_MS * MS)
    }


def test_a_measurement_is_shown_with_margins_of_its_length() -> None:
    """From the contact at 1000 to the standstill at 1100 ms: 60 ms before it, 40 ms after."""
    shown = found(event(1000, "contact"), event(1001, "edge"), event(1002, "latch"),
                  event(1100, "standstill"))  # fmt: skip
    assert shown["measurement"] == (940, 1140)
    # Until the latch, without the standstill: 2 ms, 1.2 before and 0.8 after
    assert shown["edge"] == pytest.approx((998.8, 1002.8))


def test_short_ones_have_a_least_margin() -> None:
    """A measurement of less than 10 ms has those of 10 ms, an edge those of 0.1 ms."""
    shown = found(event(1000, "latch"))
    assert shown["measurement"] == (994, 1004)
    assert shown["edge"] == pytest.approx((999.94, 1000.04))


@pytest.mark.parametrize(
    ("length_ms", "measurement", "edge"),
    [
        (0.03, (994.0, 1004.03), (999.94, 1000.07)),
        (2.0, (994.0, 1006.0), (998.8, 1002.8)),
        (10.0, (994.0, 1014.0), (994.0, 1014.0)),
        (20.0, (988.0, 1028.0), (988.0, 1028.0)),
    ],
)
def test_one_that_has_a_length_below_the_least_has_the_least_margins_around_it(
    length_ms: float, measurement: tuple[float, float], edge: tuple[float, float]
) -> None:
    """0.6 of 10 ms (of 0.1 ms) before its first event, 0.4 after its last one."""
    shown = found(event(1000, "contact"), event(1000 + length_ms, "latch"))
    assert shown["measurement"] == pytest.approx(measurement)
    assert shown["edge"] == pytest.approx(edge)


@pytest.mark.parametrize(
    ("kinds", "labels"),
    [
        (("contact",), ["edge"]),
        (("contact", "latch"), ["measurement", "edge"]),
        (("brake",), ["measurement"]),
        (("pdo", "standstill"), ["measurement"]),
        (("edge",), ["edge"]),  # alone, where there is nothing else
        (("fault", "mark"), []),
    ],
)
def test_a_measurement_has_what_it_needs(kinds: Sequence[str], labels: list[str]) -> None:
    events = [event(1000 + n, kind) for n, kind in enumerate(kinds)]
    assert list(found(*events)) == labels


def test_measurements_end_with_a_standstill_or_half_a_second_of_nothing() -> None:
    one = [event(100, "contact"), event(110, "standstill"), event(120, "contact"),
           event(620, "latch"), event(1121, "brake")]  # fmt: skip
    groups = _measurements([*one, event(300, "fault")])
    assert [[each.time_ns // MS for each in group] for group in groups] == [
        [100, 110], [120, 620], [1121],
    ]  # fmt: skip
    assert [[e.time_ns // MS for e in g] for g in _measurements(one[::-1])] == [
        [100, 110], [120, 620], [1121],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("at_ms", "groups"),
    [
        ((0, 400, 800, 1200), 1),  # a slow one: longer than half a second, without such a pause
        ((0, 500, 1000, 1500), 1),
        ((0, 501, 900, 1200), 2),
        ((0, 400, 901, 1402), 3),
    ],
)
def test_a_pause_of_half_a_second_counts_from_the_event_before(
    at_ms: Sequence[int], groups: int
) -> None:
    """A measurement may take as long as it likes from its contact to its standstill."""
    kinds = ("contact", "edge", "latch", "standstill")
    events = [event(1000 + ms, kind) for ms, kind in zip(at_ms, kinds, strict=True)]
    assert len(_measurements(events)) == groups
    if groups == 1:
        span_ms = at_ms[-1]
        begin_ms, end_ms = found(*events)["measurement"]
        assert (begin_ms, end_ms) == (1000 - 0.6 * span_ms, 1000 + 1.4 * span_ms)


def test_the_edge_that_a_probe_leaves_with_is_no_measurement() -> None:
    lone = [
        event(100, "contact"),
        event(101, "latch"),
        event(102, "standstill"),
        event(700, "edge"),
    ]
    assert len(_measurements(lone)) == 1
    assert len(_measurements([event(100, "edge"), event(800, "edge")])) == 2


def test_two_measurements_have_numbers() -> None:
    shown = found(event(100, "latch"), event(1000, "latch"))
    assert list(shown) == ["measurement 1", "edge 1", "measurement 2", "edge 2"]
    assert shown["measurement 2"] == (994, 1004)


@pytest.mark.parametrize(
    ("events", "window"),
    [
        ([event(1000, "alarm")], (950, 1150)),
        ([event(2000, "alarm"), event(1000, "alarm")], (950, 1150)),  # the first
        ([event(500, "alarm", is_warning=True), event(1000, "alarm")], (950, 1150)),
        ([event(500, "alarm", is_warning=True)], None),
        ([event(10, "alarm")], (0, 160)),  # inside the run
        ([event(4990, "alarm")], (4940, 5000)),
        ([event(5060, "alarm")], None),
    ],
)
def test_the_first_alarm_that_ended_the_program_has_a_window(
    events: list[Event], window: tuple[float, float] | None
) -> None:
    assert found(*events).get("alarm") == window


def test_the_alarm_comes_before_the_measurements() -> None:
    assert next(iter(found(event(100, "latch"), event(110, "alarm")))) == "alarm"


def test_windows_of_topics_come_first_and_stay_in_the_run() -> None:
    """An event within a stretch of a topic has none beside it."""
    added = [
        Plots(windows=[{"label": "stop", "start_ns": -5, "end_ns": 900 * MS, "zero": "x"}],
              spans=[(100 * MS, 200 * MS)]),
        Plots(windows=[{"label": "on", "start_ns": 50 * MS, "end_ns": 9999 * MS}],
              spans=[(400 * MS, 500 * MS)]),
    ]  # fmt: skip
    events = [event(100, "latch"), event(200, "alarm"), event(450, "latch"), event(700, "latch")]
    shown = _windows(events, added, 0, END_MS * MS)
    assert [each["label"] for each in shown] == ["stop", "on", "measurement", "edge"]
    assert (shown[0]["start_ns"], shown[0]["zero"]) == (0, "x")
    assert shown[1]["end_ns"] == END_MS * MS
    assert shown[2]["start_ns"] == 694 * MS


# Plots and the axis that is shown first


def content(**columns: Sequence[float]) -> pa.Table:
    table = {name.replace("__", "."): list(values) for name, values in columns.items()}
    return pa.table({"time_ns": np.arange(3), **table})


@pytest.mark.parametrize(
    ("of_topics", "of_events", "first"),
    [
        (["Q", "Y"], ["X"], "Y"),  # of the first topic that has one
        ([], [None, "X", "Y"], "X"),
        ([], [], "Z"),  # that travels farthest, 9 mm
        (["Q"], ["Q"], "Z"),
    ],
)
def test_the_axis_that_is_shown_first(
    of_topics: list[str], of_events: list[str | None], first: str
) -> None:
    table = content(X__actual_mm=(0, 5, 0), Y__actual_deg=(0, -8, 0), Z__actual_mm=(1, 10, 1),
                    X__set_mm=(0, 99, 0))  # fmt: skip
    events = [event(1, "mark", axis) for axis in of_events]
    assert _first_axis(table, ["X", "Y", "Z"], events, [Plots(axes=of_topics)]) == first


@pytest.mark.parametrize(
    ("columns", "first"),
    [
        # One that stands far from 0, on either side, does not travel
        ({"X__actual_mm": (500, 500, 500), "Y__actual_mm": (1, 2, 1)}, "Y"),
        ({"X__actual_mm": (-500, -500, -500), "Y__actual_mm": (1, 2, 1)}, "Y"),
        ({"X__actual_mm": (500, 501, 500), "Y__actual_mm": (-3, 3, 0)}, "Y"),
        ({"X__actual_mm": (0, 1, 2), "Y__actual_mm": (9, 7, 6)}, "Y"),  # downwards
        ({"X__actual_mm": (0, 9, 0), "Y__actual_mm": (0, 2, 4)}, "X"),  # and back
        ({"X__actual_deg": (-170, 0, 170), "Y__actual_mm": (300, 100, 200)}, "X"),
        ({"X__actual_mm": (0, 1, 0), "Y__truth_mm": (0, 99, 0)}, "X"),
        ({"X__actual_mm": (3, 4, 3), "Y__actual_mm": (7, 8, 7)}, "X"),  # of equal ones the first
    ],
)
def test_without_events_the_axis_that_travels_farthest_is_shown_first(
    columns: dict[str, Sequence[float]], first: str
) -> None:
    assert _first_axis(content(**columns), ["X", "Y"], [], []) == first


def test_without_a_position_the_first_axis_is_shown_and_without_axes_none() -> None:
    assert _first_axis(content(Z__lag_mm=(0, 1, 2)), ["X", "Z"], [], []) == "X"
    assert _first_axis(content(), [], [], []) is None


def test_plots_are_in_the_order_of_the_table_and_unknown_ones_last() -> None:
    series = _series(["time_ns", "Z.velocity_mm_s", "Z.own_thing", "Z.actual_mm", "X.actual_mm"])
    assert [each["column"] for each in series["position"]["Z"]] == ["Z.actual_mm"]
    assert list(series["position"]) == ["Z", "X"]
    shown = [each["plot"] for each in _plots(series)]
    assert shown[0] == "position"
    assert shown[-1] == "own_thing"
    assert "velocity" in shown
    long = _plots({"a" * 40: {}})
    assert long[0]["height"] == 360
    assert _plots({"a": {}})[0]["height"] == 120


@pytest.mark.parametrize(
    ("at_ms", "shown"),
    [
        (500, []),  # ended before the run that is shown begins
        (996, []),
        (997, [(1000, 1001)]),
        (1003, [(1000, 1007)]),
        (1500, [(1494, 1504)]),
        (1999, [(1993, 2000)]),
        (2005, [(1999, 2000)]),
        (2006, []),
    ],
)
def test_a_stretch_is_cut_at_the_ends_of_the_run(at_ms: int, shown: list[tuple[int, int]]) -> None:
    """A standstill has 6 ms before it and 4 after; of 1000 to 2000 ms. Outside there is none."""
    found = windows([event(at_ms, "standstill")], 1000 * MS, 2000 * MS)
    assert [(each["start_ns"] / MS, each["end_ns"] / MS) for each in found] == shown
