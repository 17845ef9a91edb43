"""What a page gets to draw a run: rows, columns, plots, limits, windows, and what topics add."""

import base64
import gzip
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.series import SYNC_AFTER
from axisrig.reports.parts.envelope import BINS, KEPT_ROWS
from axisrig.reports.parts.topic import Plots, ReportTopic
from axisrig.reports.signals import chart

MS = 1_000_000
NOTHING = RunFindings()
LONG = 2 * BINS + KEPT_ROWS + 1
"""The least number of rows that is reduced."""


def trace(rows: int = 11, **columns: Any) -> pa.Table:
    """A row each ms; columns: their values, of `Z.actual_mm` a rising one where there is none."""
    names = columns or {"Z.actual_mm": np.arange(rows, dtype=np.float64)}
    return pa.table({"time_ns": np.arange(rows, dtype=np.int64) * MS, **names})


def described(content: pa.Table, *topics: ReportTopic, **more: Any) -> dict[str, Any]:
    return chart(content, more.pop("info", NOTHING), topics, **more)[0]


def topic(name: str = "own", plots: Plots = Plots(), **adds: Any) -> ReportTopic:  # noqa: B008
    """A topic that adds these columns to a trace, and these plots."""

    def with_signals(content: pa.Table, _info: RunFindings) -> pa.Table:
        for column, values in adds.items():
            content = content.append_column(column.replace("__", "."), pa.array(values))
        return content

    return ReportTopic(name, "x", lambda *_: [], with_signals, lambda *_: plots)


# Rows


@pytest.mark.parametrize(
    ("rows", "is_reduced", "is_less"),
    [(11, True, False), (LONG - 1, True, False), (LONG, True, True), (LONG, False, False),
     (5000, True, True), (5000, False, False)],
)  # fmt: skip
def test_a_page_says_how_many_of_the_recorded_rows_it_has(
    rows: int, is_reduced: bool, is_less: bool
) -> None:
    """So that it can name a signal that is reduced."""
    found, packed = chart(trace(rows), NOTHING, (), is_reduced=is_reduced)
    assert found["rows_recorded"] == rows
    assert (found["rows"] < rows) is is_less
    assert is_less or found["rows"] == rows
    octets = gzip.decompress(base64.b64decode(packed))
    assert len(octets) == found["rows"] * sum(column["planes"] for column in found["columns"])


def test_stretches_with_a_button_keep_all_their_rows() -> None:
    """A latch at 2500 ms opens 10 ms with all samples; the rest has the ends of bins."""
    info = RunFindings(events=[Event(2500 * MS, "latch", "latch", "Z")])
    bare, kept = (described(trace(5000), info=each, is_reduced=True) for each in (NOTHING, info))
    window = kept["windows"][0]
    assert (window["start_ns"], window["end_ns"]) == (2494 * MS, 2504 * MS)
    assert kept["rows"] > bare["rows"]
    assert bare["windows"] == []


def test_an_empty_trace_has_no_description() -> None:
    assert chart(trace().slice(0, 0), NOTHING, ()) == ({}, "")


# Columns and plots


def test_columns_are_those_of_the_trace_with_the_digits_of_their_signal() -> None:
    """The time is in whole ns, an unknown signal has 6 digits; instants of SYNCs are left out."""
    rows = np.arange(4.0)
    content = trace(4, **{"Z.actual_mm": rows, f"Z.{SYNC_AFTER}": rows, "Z.distance_state": rows,
                          "probe.signal": rows, "Z.own_thing": rows})  # fmt: skip
    found = described(content)
    digits = {column["name"]: column["digits"] for column in found["columns"]}
    assert list(digits) == [
        "time_ns", "Z.actual_mm", "Z.distance_state", "probe.signal", "Z.own_thing",
    ]  # fmt: skip
    assert (digits["time_ns"], digits["Z.actual_mm"], digits["Z.own_thing"]) == (0, 6, 6)
    assert digits["Z.distance_state"] == 0


def test_signals_of_axes_are_by_axis_and_those_of_a_probe_belong_to_all() -> None:
    rows = np.arange(4.0)
    names = ("Z.set_mm", "X.actual_mm", "Z.actual_mm", "probe.signal", "second.signal",
             "Z.own_thing")  # fmt: skip
    content = trace(4, **dict.fromkeys(names, rows))
    found = described(content)
    plots = {plot["plot"]: plot for plot in found["plots"]}
    assert list(plots) == ["position", "probe", "own_thing"]
    position = plots["position"]["series"]
    assert [entry["column"] for entry in position["Z"]] == ["Z.set_mm", "Z.actual_mm"]
    assert [(entry["label"], entry["unit"]) for entry in position["X"]] == [("actual", "mm")]
    shared = plots["probe"]["series"]
    assert list(shared) == ["*"]
    assert [(entry["column"], entry["label"]) for entry in shared["*"]] == [
        ("probe.signal", "probe"), ("second.signal", "second"),
    ]  # fmt: skip
    (own,) = plots["own_thing"]["series"]["Z"]
    assert (own["label"], own["unit"]) == ("own_thing", "")
    assert found["axes"] == ["X", "Z"]
    assert "time_ns" not in str(found["plots"])


def test_a_lane_of_blocks_is_the_first_plot_and_no_column() -> None:
    lane = {"rows": [[0, 0, 0, 5, "motion", 0, "N1"]], "lanes": 1, "holds": []}
    found = described(trace(), lane=lane)
    assert [plot["plot"] for plot in found["plots"]] == ["block", "position"]
    assert found["blocks"] == lane
    assert [column["name"] for column in found["columns"]] == ["time_ns", "Z.actual_mm"]
    without = described(trace())
    assert "blocks" not in without
    assert [plot["plot"] for plot in without["plots"]] == ["position"]
    assert found["axes"] == without["axes"] == ["Z"]


# What is drawn over them


def limit(label: str, value: float) -> dict[str, Any]:
    return {"plot": "position", "axis": "Z", "value": value, "label": label}


def test_limits_of_checks_come_before_those_of_topics() -> None:
    one = topic("one", Plots(limits=[limit("b", 2.0), limit("c", 3.0)]))
    two = topic("two", Plots(limits=[limit("d", 4.0)]))
    found = described(trace(), one, two, limits=[limit("a", 1.0)])
    assert [each["label"] for each in found["limits"]] == ["a", "b", "c", "d"]
    assert described(trace())["limits"] == []


def test_a_topic_may_add_signals_axes_and_entries_of_its_own() -> None:
    """A later topic sees what an earlier one has added, and its entries win."""
    one = topic("one", Plots(axes=["X"], more={"opens": 1, "lanes": "a"}), X__force_n=np.ones(11))
    two = topic("two", Plots(more={"opens": 2}), X__lag_mm=np.ones(11))
    found = described(trace(), one, two)
    assert [column["name"] for column in found["columns"]] == [
        "time_ns", "Z.actual_mm", "X.force_n", "X.lag_mm",
    ]  # fmt: skip
    assert (found["axis"], found["opens"], found["lanes"]) == ("X", 2, "a")
    assert described(trace())["axis"] == "Z"


def test_windows_of_topics_come_first_and_hide_the_events_in_their_spans() -> None:
    window = {"label": "own", "start_ns": -5 * MS, "end_ns": 4 * MS}
    own = topic("own", Plots(windows=[window], spans=[(2 * MS, 6 * MS)]))
    events = [Event(6 * MS, "latch", "a", "Z"), Event(9 * MS, "latch", "b", "Z")]
    found = described(trace(), own, info=RunFindings(events=events))
    assert [each["label"] for each in found["windows"]] == ["own", "measurement", "edge"]
    assert (found["windows"][0]["start_ns"], found["windows"][0]["end_ns"]) == (0, 4 * MS)
    assert found["windows"][2]["start_ns"] > 8 * MS
    assert [each["label"] for each in found["events"]] == ["a", "b"]


def test_events_are_given_with_all_that_they_say() -> None:
    events = [Event(3 * MS, "alarm", "ID 7 (warning)", None, True), Event(MS, "edge", "e", "Z")]
    found = described(trace(), info=RunFindings(events=events))
    assert found["events"] == [
        {"time_ns": 3 * MS, "kind": "alarm", "label": "ID 7 (warning)", "axis": None,
         "is_warning": True},
        {"time_ns": MS, "kind": "edge", "label": "e", "axis": "Z", "is_warning": False},
    ]  # fmt: skip
