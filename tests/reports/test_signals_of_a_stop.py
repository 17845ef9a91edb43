"""What the signals of a run to a fixed stop show, from signals and instants in round numbers."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from tests.reports.short_stops import LIMITS, added, at, during, fields_of, stop, trace
from tests.reports.stops import MS

from axisrig.bench.judge.fixed_stop.stop_findings import (
    Decision,
    Mark,
    StopFindings,
    StopLimits,
)
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.fixed_stop.signals import (
    Stop,
    bands,
    contact,
    largest,
    limits,
    mark,
    origin_ns,
    plots,
    ranges,
    shortfall,
    span,
    stops_of,
    value_at,
    windows,
    with_changes,
)

# Instants


def test_a_mark_is_the_first_of_its_key_that_was_measured() -> None:
    found = stop(
        at("beyond", None, "Z"), at("beyond", 130, "Z2"), at("beyond", 140, "Z"), at("end", 200)
    )
    assert mark(found, "beyond") == 130 * MS
    assert mark(found, "beyond", "Z") == 140 * MS
    assert mark(found, "end", "Z") == 200 * MS  # of no axis: of each
    assert mark(found, "armed") is None


@pytest.mark.parametrize(
    ("marks", "expected"),
    [
        ((at("contact", 150, "Z"),), ("Z", 150)),
        ((at("contact", 140, "Z2"), at("contact", 150, "Z")), ("Z", 150)),  # of the deciding axis
        ((at("contact", 150, "Z2"), at("contact", 140, "Z2")), ("Z2", 140)),  # else the first
        ((at("contact", 150, "Z"), at("detected", 150, "Z")), ("Z", 150)),
        ((at("contact", 151, "Z"), at("detected", 150, "Z")), None),
        ((at("contact", 151, "Z"), at("contact", 149, "Z2"), at("detected", 150)), ("Z2", 149)),
        ((at("contact", None, "Z"),), None),
        ((), None),
    ],
)  # fmt: skip
def test_the_contact_of_a_run_is_before_its_detection(
    marks: tuple[Mark, ...], expected: tuple[str, int] | None
) -> None:
    found = contact(stop(*marks))
    assert (found and (found.axis, found.time_ns / MS)) == expected


def test_times_count_from_the_contact_else_from_the_begin() -> None:
    begin, touched = at("begin", 105), at("contact", 150, "Z")
    assert origin_ns(stop(begin, touched)) == 150 * MS
    assert origin_ns(stop(begin)) == 105 * MS
    assert origin_ns(stop()) == 100 * MS


def test_a_timeline_has_all_instants_of_the_criteria_with_their_bands() -> None:
    """From the contact at 150 to the end at 200 ms; a band from 120 to 230 ms is in it too."""
    touched = at("contact", 150, "Z")
    shown = span(stop(touched, at("begin", 101)))
    assert (shown.holds(0.0), shown.holds(50.0), shown.holds(-49.0)) == (True, True, False)
    band = at("detected", 160, "Z", oracle_ns=170 * MS, low_ns=120 * MS, high_ns=230 * MS)
    wide = span(stop(touched, band))
    assert wide.holds(-30.0)
    assert wide.holds(80.0)
    free = span(stop(at("begin", 110)))  # without a contact the whole run
    assert (free.holds(-10.0), free.holds(90.0)) == (True, True)


# Signals


@pytest.mark.parametrize(
    ("lag", "largest_mm", "beyond_ms"),
    [
        (during(2.0, 0, 99), 0.0, 0.0),  # before the run
        (during(2.0, 201, 299), 0.0, 0.0),
        (during(0.9, 120, 130), 0.9, 0.0),
        (during(-1.5, 120, 130), 1.5, 10.0),
        (during(1.0, 120, 130), 1.0, 0.0),  # at its limit, not beyond
        (during(2.0, 90, 110), 2.0, 10.0),  # from the begin of the run on
        (added(during(1.2, 120, 125), during(1.1, 140, 160)), 1.2, 20.0),
    ],
)  # fmt: skip
def test_how_far_the_lag_came(lag: list[float], largest_mm: float, beyond_ms: float) -> None:
    found = shortfall(trace(Z__cnc_lag_mm=lag), stop(), "Z")
    assert (found.largest_lag_mm, found.beyond_ms, found.change_um) == (largest_mm, beyond_ms, None)


def test_criteria_count_from_when_they_are_armed() -> None:
    lag = added(during(3.0, 110, 140), during(2.0, 170, 180))
    found = shortfall(trace(Z__cnc_lag_mm=lag), stop(at("armed", 150)), "Z")
    assert (found.largest_lag_mm, found.beyond_ms) == (2.0, 10.0)


def test_without_a_lag_limit_no_time_is_beyond_it_and_without_a_trace_nothing_is() -> None:
    found = stop(limits={"Z": replace(LIMITS, lag_limit_mm=None)})
    lag = shortfall(trace(Z__cnc_lag_mm=during(2.0, 120, 130)), found, "Z")
    assert (lag.largest_lag_mm, lag.beyond_ms) == (2.0, None)
    assert shortfall(None, found, "Z").largest_lag_mm is None
    assert shortfall(trace(), found, "Z").largest_lag_mm is None


def test_the_smallest_way_counts_while_the_set_value_moves() -> None:
    """The set value stands from row 160 on: a way of 1 um does not count there, 30 um before do."""
    lead = [float(min(row, 160)) for row in range(300)]
    way = [1.0 if row > 160 or row < 100 else 30.0 if row == 150 else 70.0 for row in range(300)]
    found = shortfall(trace(Z__change_um=way, Z__set_mm=lead), stop(), "Z")
    assert found.change_um == 30.0
    still = shortfall(trace(Z__change_um=way, Z__set_mm=[5.0] * 300), stop(), "Z")
    assert still.change_um is None


def test_the_way_of_the_window_criterion_is_within_the_minimum_time_of_its_axis() -> None:
    """Z goes 10 mm/s, 200 um in 20 ms; Z2 backwards with 5 mm/s, 200 um in 40 ms; C in mdeg."""
    rows = np.arange(300)
    found = stop(
        limits={"Z": LIMITS, "Z2": replace(LIMITS, min_time_ms=40.0), "C": LIMITS,
                "X": replace(LIMITS, window_mm=None)},
        rotary={"C": True},
    )  # fmt: skip
    table = with_changes(
        trace(Z__actual_mm=rows * 0.01, Z2__actual_mm=rows * -0.005, C__actual_deg=rows * 0.002,
              X__actual_mm=rows * 1.0),
        [found],
    )  # fmt: skip
    for column, way in (("Z.change_um", 200.0), ("Z2.change_um", 200.0), ("C.change_mdeg", 40.0)):
        values = table.column(column).to_numpy()
        assert values[100:201] == pytest.approx(way)
        assert np.isnan(values[:100]).all()
        assert np.isnan(values[201:]).all()
    assert "X.change_um" not in table.column_names


def test_before_the_minimum_time_has_gone_by_there_is_no_way() -> None:
    early = stop(begin_ns=0, end_ns=50 * MS)
    values = with_changes(trace(Z__actual_mm=np.arange(300) * 0.01), [early]).column("Z.change_um")
    assert np.isnan(values.to_numpy()[:20]).all()
    assert values.to_numpy()[20:51] == pytest.approx(200.0)


def test_two_runs_share_a_column() -> None:
    second = stop(begin_ns=250 * MS, end_ns=280 * MS)
    table = with_changes(trace(Z__actual_mm=np.arange(300) * 0.01), [stop(), second])
    known = np.isfinite(table.column("Z.change_um").to_numpy())
    assert list(np.flatnonzero(known)) == [*range(100, 201), *range(250, 281)]


def test_a_value_at_an_instant_is_between_its_rows_and_none_outside() -> None:
    table = trace(Z__truth_mm=[float(row) for row in range(299)] + [np.nan])
    assert value_at(table, "Z.truth_mm", 150_500_000) == pytest.approx(150.5)
    for instant in (-1, 299 * MS, 299 * MS + 1, None):
        assert value_at(table, "Z.truth_mm", instant) is None
    assert value_at(table, "Z.truth_mm", 0) == 0.0
    for name in ("Z.other", None):
        assert value_at(table, name, 150 * MS) is None
    assert value_at(None, "Z.truth_mm", 150 * MS) is None


def test_the_largest_amount_is_within_the_run() -> None:
    values = added(during(-7.0, 150, 150), during(9.0, 201, 210))
    values[120] = np.nan
    assert largest(trace(Z__f=values), "Z.f", stop()) == 7.0
    assert largest(trace(Z__f=[np.nan] * 300), "Z.f", stop()) is None
    assert largest(trace(), "Z.f", stop()) is None


# What the plots show


def of(found: Stop, table: pa.Table) -> dict[tuple[str, str, str], float]:
    return {
        (row["plot"], row["axis"], row["label"]): row["value"] for row in limits(table, [found])
    }


def test_limits_of_a_linear_axis_and_of_one_that_turns() -> None:
    """The lag limit has the sign of the largest lag in the run."""
    lag = added(during(-0.8, 120, 130), during(5.0, 0, 50))
    linear = stop(limits={"Z": replace(LIMITS, force_limit_n=-500.06)})
    assert of(linear, trace(Z__cnc_lag_mm=lag)) == {
        ("lag", "Z", "L"): -1.0, ("change", "Z", "W"): 10.0, ("force", "Z", "torque limit"): -500.1,
    }  # fmt: skip
    turned = stop(
        limits={"C": StopLimits(2.0, 0.02, 20.0, 0.5, torque_limit_nm=12.3456)}, rotary={"C": True}
    )
    assert of(turned, trace()) == {
        ("angular_lag", "C", "L"): 2.0, ("turned", "C", "W"): 20.0,
        ("torque", "C", "torque limit"): 12.346,
    }  # fmt: skip
    neither = stop(limits={"Z": StopLimits(None, None, 20.0, None)})
    assert of(neither, trace(Z__cnc_lag_mm=lag)) == {}


def test_the_place_of_the_contact_is_a_line_unless_the_plant_gives_its_stop() -> None:
    table = trace(Z__truth_mm=[row * 0.1 for row in range(300)], Z__stop_mm=[15.0] * 300)
    touched = stop(at("contact", 150, "Z"), limits={"Z": StopLimits(None, None, 20.0, None)})
    assert of(touched, table) == {("position", "Z", "contact at"): 15.0}
    names = {"Z": {"truth_mm": "Z.truth_mm", "stop_mm": "Z.stop_mm"}}
    assert of(replace(touched, signals=names), table) == {}


def test_equal_limits_of_several_runs_are_one() -> None:
    table = trace()
    other = stop(limits={"Z": replace(LIMITS, window_mm=0.02)})
    rows = limits(table, [stop(limits={"Z": LIMITS}), stop(limits={"Z": LIMITS}), other])
    assert [(row["label"], row["value"]) for row in rows] == [("L", 1.0), ("W", 10.0), ("W", 20.0)]


def test_the_way_is_shown_up_to_five_windows() -> None:
    found = stop(limits={"Z": LIMITS, "C": replace(LIMITS, window_mm=0.002),
                         "X": replace(LIMITS, window_mm=None)}, rotary={"C": True})  # fmt: skip
    assert ranges([found]) == {"change": {"Z": [0.0, 50.0]}, "turned": {"C": [0.0, 10.0]}}


def test_bands_need_both_ends() -> None:
    both = at("detected", 160, "Z", low_ns=150 * MS, high_ns=0)
    one = at("beyond", 160, "Z", low_ns=150 * MS)
    assert bands([stop(both, one)]) == [{"axis": "Z", "start_ns": 150 * MS, "end_ns": 0}]


@pytest.mark.parametrize(
    ("count", "labels"),
    [
        (1, ["fixed stop", "detection"]),
        (2, ["fixed stop 1", "detection 1", "fixed stop 2", "detection 2"]),
    ],
)
def test_of_one_run_windows_have_no_number_and_of_two_they_have(
    count: int, labels: list[str]
) -> None:
    marks = (at("contact", 150, "Z"), at("detected", 170, "Z"))
    found = windows([stop(*marks, number=n) for n in range(1, count + 1)])
    assert [each["label"] for each in found] == labels
    zeros = ["contact"] * 2 if count == 1 else ["contact 1"] * 2 + ["contact 2"] * 2
    assert [each["zero"] for each in found] == zeros
    assert {each["origin_ns"] for each in found} == {150 * MS}
    free = windows([stop(at("begin", 110))])
    assert [(each["label"], each["zero"]) for each in free] == [("fixed stop", "begin")]


def test_the_detection_is_shown_from_its_minimum_time_until_the_set_value_rests() -> None:
    """20 ms before 170 ms, until 190 ms, with 10 ms on either side; a tenth of what is longer."""
    marks = (at("detected", 170, "Z"), at("stands", 190))
    (_, shown) = windows([stop(*marks)])
    assert (shown["start_ns"], shown["end_ns"]) == (140 * MS, 200 * MS)
    slave = stop(*marks, decided_by=Decision("Z2", "lag"))
    assert windows([slave])[1]["start_ns"] == 120 * MS
    long = stop(*marks, limits={"Z": replace(LIMITS, min_time_ms=180.0)})
    assert windows([long])[1]["start_ns"] == (170 - 180 - 20) * MS
    (_, alone) = windows([stop(at("detected", 170, "Z"))])
    assert alone["end_ns"] == 180 * MS


def test_the_plots_open_with_the_last_run() -> None:
    """Two windows of the first are before those of the second; its main axis comes first."""
    marks = (at("contact", 150, "Z"), at("detected", 170, "Z"))
    first = fields_of(stop(*marks))
    second = {**first, "number": 2, "main_axis": "Z2", "begin_ns": 210 * MS, "end_ns": 220 * MS}
    shown = plots(
        trace(), RunFindings(events=[], of_topics=[StopFindings(**first), StopFindings(**second)])
    )
    assert (shown.axes, shown.more["opens"]) == (["Z2"], 2)
    assert list(shown.spans) == [(100 * MS, 200 * MS), (210 * MS, 220 * MS)]
    none = plots(trace(), RunFindings(events=[], of_topics=[]))
    assert (list(none.axes), list(none.windows), dict(none.more)) == ([], [], {})


def test_columns_are_those_of_a_linear_axis_or_of_one_that_turns() -> None:
    fields = fields_of(stop())
    names = ["Z.cnc_lag_mm", "Z2.stop_force_n", "C.cnc_lag_deg", "C.stop_torque_nm", "C.stop_deg"]
    found = StopFindings(**{**fields, "axes": ["Z"], "watched": ["Z", "Z2", "C"]})
    (made,) = stops_of(RunFindings(events=[], of_topics=[found]), names)
    assert made.column("Z", "cnc_lag_mm") == "Z.cnc_lag_mm"
    assert made.column("Z2", "stop_force_n") == "Z2.stop_force_n"
    assert made.column("C", "stop_force_n") == "C.stop_torque_nm"
    assert made.column("C", "stop_mm") == "C.stop_deg"
    assert (made.column("Z", "truth_mm"), made.column(None, "truth_mm")) == (None, None)
    assert (made.min_time_ns("Z2"), made.min_time_ns("X")) == (40 * MS, 0)


def test_each_axis_has_the_place_of_its_own_contact() -> None:
    """Z touches at 150 ms, its slave at 160 ms; an axis that touches nothing has none."""
    table = trace(
        Z__truth_mm=[row * 0.1 for row in range(300)],
        Z2__truth_mm=[row * 0.2 for row in range(300)],
        X__truth_mm=[1.0] * 300,
    )
    none = StopLimits(None, None, 20.0, None)
    found = stop(
        at("contact", 150, "Z"),
        at("contact", 160, "Z2"),
        limits=dict.fromkeys(("Z", "Z2", "X"), none),
    )
    assert of(found, table) == {
        ("position", "Z", "contact at"): 15.0, ("position", "Z2", "contact at"): 32.0,
    }  # fmt: skip


@pytest.mark.parametrize(("stands", "end"), [(None, 180), (160, 180), (170, 180), (190, 200)])
def test_a_detection_is_never_shown_to_an_end_before_it(stands: float | None, end: int) -> None:
    """A set value that rested before: the window ends 10 ms after the detection at 170 ms."""
    (_, shown) = windows([stop(at("detected", 170, "Z"), at("stands", stands))])
    assert (shown["start_ns"], shown["end_ns"]) == (140 * MS, end * MS)
