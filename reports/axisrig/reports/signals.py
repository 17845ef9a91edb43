"""From a trace to plots: which signal goes where, and which stretch of time is worth looking at."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.series import SYNC_AFTER, values_of
from axisrig.reports.parts.encode import encode_signal, pack
from axisrig.reports.parts.envelope import envelope
from axisrig.reports.parts.shipped import shipped_table
from axisrig.reports.parts.topic import Plots, ReportTopic
from axisrig.reports.topics import TOPICS

SHARED = "*"
"""Stands for the axis where a signal belongs to every axis, such as a probe."""
BLOCKS = "block"
"""The plot of NC blocks, a lane that has no signal."""

_UNKNOWN_DIGITS = 6
_APART_NS = 500_000_000
_MARGIN_BEFORE = 0.6
_MARGIN_AFTER = 0.4
_MARGIN_LEAST_NS = 10_000_000
_EDGE_LEAST_NS = 100_000
_BEFORE_ALARM_NS = 50_000_000
_AFTER_ALARM_NS = 150_000_000
_PLOT_HEIGHT, _LETTER = 120, 9
_OF_A_RUN = frozenset({"latch", "pdo", "brake", "standstill"})
_OF_AN_EDGE = frozenset({"contact", "edge", "latch"})
_OF_A_MEASUREMENT = frozenset({"contact", "edge", "latch", "pdo", "brake", "standstill"})


@dataclass(frozen=True)
class Signal:
    """One row of `signals.csv`: how a column of a trace is drawn."""

    suffix: str
    plot: str
    label: str
    unit: str
    digits: int
    style: str
    meaning: str


@cache
def signals() -> Mapping[str, Signal]:
    """Read `signals.csv`, keyed by the part of the column name after the first point."""
    return {
        row["suffix"]: Signal(**{**row, "digits": int(row["digits"])})
        for row in shipped_table("signals.csv")
    }


def chart(
    content: pa.Table,
    info: RunFindings,
    topics: Sequence[ReportTopic] = TOPICS,
    *,
    limits: Sequence[Mapping[str, Any]] = (),
    lane: Mapping[str, Any] | None = None,
    is_reduced: bool = False,
) -> tuple[dict[str, Any], str]:
    """Return what the page needs to draw a run: the description, and the packed signals.

    content: its trace. info: what is shown of it. limits: of its checks, to draw. lane: of its NC
    blocks.
    is_reduced: keep smallest and largest values only (`parts.envelope`); `rows` of the description
    is then below `rows_recorded`. The description is empty when the trace is.
    """
    if content.num_rows == 0:
        return {}, ""
    content = with_signals(content, info, topics)
    added = [topic.plots(content, info) for topic in topics]
    names = [name for name in content.column_names if not name.endswith(f".{SYNC_AFTER}")]
    content = content.select(names)
    series = _series(names)
    if lane:
        entry = {"column": BLOCKS, "label": BLOCKS, "unit": "", "style": "state"}
        series[BLOCKS] = {SHARED: [entry]}
    axes = sorted({axis for plot in series.values() for axis in plot if axis != SHARED})
    time_ns = values_of(content.column("time_ns"))
    events = info.events
    description: dict[str, Any] = {
        "axes": axes,
        "axis": _first_axis(content, axes, events, added),
        "plots": [{**plot, "series": series[plot["plot"]]} for plot in _plots(series)],
        "events": [asdict(event) for event in events],
        "limits": [
            *limits,
            *(limit for plots in added for limit in plots.limits),
        ],
        "windows": _windows(events, added, int(time_ns[0]), int(time_ns[-1])),
    }
    if lane:
        description["blocks"] = lane
    for plots in added:
        description |= plots.more
    kept = content
    if is_reduced:
        stretches = [(window["start_ns"], window["end_ns"]) for window in description["windows"]]
        kept = envelope(content, stretches)
    columns, parts = _encode(kept)
    description |= {"rows": kept.num_rows, "rows_recorded": content.num_rows, "columns": columns}
    return description, pack(parts)


def with_signals(
    content: pa.Table, info: RunFindings, topics: Sequence[ReportTopic] = TOPICS
) -> pa.Table:
    """Return a trace with the signals that the topics add."""
    for topic in topics:
        content = topic.with_signals(content, info)
    return content


def _encode(content: pa.Table) -> tuple[list[dict[str, Any]], list[bytes]]:
    columns, parts = [], []
    for name in content.column_names:
        values = values_of(content.column(name))
        if name == "time_ns":
            head, part = encode_signal(values.astype(np.int64), 0)
        else:
            head, part = encode_signal(values.astype(np.float64), _signal(name).digits)
        columns.append({"name": name, **vars(head)})
        parts.append(part)
    return columns, parts


def _signal(column: str) -> Signal:
    """How a column is drawn; one that the table does not know gets a plot of its own."""
    suffix = column.partition(".")[2]
    unknown = Signal(suffix, suffix, suffix, "", _UNKNOWN_DIGITS, "other", "")
    return signals().get(suffix, unknown)


def _series(columns: Sequence[str]) -> dict[str, dict[str, list[dict[str, str]]]]:
    """Plot -> axis (or SHARED) -> series."""
    plots: dict[str, dict[str, list[dict[str, str]]]] = {}
    for column in columns:
        if column == "time_ns":
            continue
        owner = column.partition(".")[0]
        signal = _signal(column)
        shared = signal.plot == "probe"
        entry = {
            "column": column,
            "label": owner if shared else signal.label,
            "unit": signal.unit,
            "style": signal.style,
        }
        plots.setdefault(signal.plot, {}).setdefault(SHARED if shared else owner, []).append(entry)
    return plots


def _plots(series: Mapping[str, object]) -> list[dict[str, Any]]:
    """The plots that have something to show, in the order of `plots.csv`, unknown ones last."""
    known = [{**row, "height": int(row["height"])} for row in _known_plots()]
    names = {row["plot"] for row in known}
    other = [
        {"plot": name, "title": name, "unit": "", "height": _height(name)}
        for name in series
        if name not in names
    ]
    return [row for row in (*known, *other) if row["plot"] in series]


@cache
def _known_plots() -> Sequence[Mapping[str, str]]:
    """Read `plots.csv`."""
    return shipped_table("plots.csv")


def _height(title: str) -> int:
    """Of a plot whose title is upright beside it, in px."""
    return max(_PLOT_HEIGHT, _LETTER * len(title))


def _first_axis(
    content: pa.Table,
    axes: Sequence[str],
    events: Sequence[Event],
    added: Sequence[Plots],
) -> str | None:
    """The axis to show first: of the first topic that has one, else of an event, else the one that
    travels farthest.
    """
    of_topics = [axis for plots in added for axis in plots.axes]
    for axis in (*of_topics, *(event.axis for event in events)):
        if axis in axes:
            return axis
    travel = {
        axis: float(np.ptp(values_of(content.column(name))))
        for axis in axes
        for name in content.column_names
        if name in (f"{axis}.actual_mm", f"{axis}.actual_deg")
    }
    return max(travel, key=lambda axis: travel[axis]) if travel else next(iter(axes), None)


def _windows(
    events: Sequence[Event],
    added: Sequence[Plots],
    start_ns: int,
    end_ns: int,
) -> list[dict[str, Any]]:
    """The stretches of `windows`; those of the topics come first, before an alarm in them."""
    spans = [span for plots in added for span in plots.spans]

    def is_outside(event: Event) -> bool:
        return not any(begin <= event.time_ns <= end for begin, end in spans)

    own = [
        {**w, "start_ns": max(start_ns, w["start_ns"]), "end_ns": min(end_ns, w["end_ns"])}
        for plots in added
        for w in plots.windows
    ]
    return [*own, *windows([event for event in events if is_outside(event)], start_ns, end_ns)]


def windows(events: Sequence[Event], start_ns: int, end_ns: int) -> list[dict[str, Any]]:
    """Find the stretches worth a button: the alarm, each measurement, its edge; the first opens.

    A measurement ends with its standstill; the edge when the probe leaves the surface is no part
    of it. Each stretch has a margin and stays inside the run; its keys are `label`, `start_ns`,
    `end_ns`.
    """
    measurements = _measurements(events)
    stretches = _around_alarm(events)
    for number, group in enumerate(measurements, start=1):
        count = f" {number}" if len(measurements) > 1 else ""
        kinds = {event.kind for event in group}
        first = group[0].time_ns
        reaction = [event.time_ns for event in group if event.kind != "standstill"]
        for label, needed, last, least in (
            ("measurement", _OF_A_RUN, group[-1].time_ns, _MARGIN_LEAST_NS),
            ("edge", _OF_AN_EDGE, max(reaction, default=first), _EDGE_LEAST_NS),
        ):
            if not kinds & needed:
                continue
            length = max(last - first, least)
            begin_ns = first - round(length * _MARGIN_BEFORE)
            stretches.append((label + count, begin_ns, last + round(length * _MARGIN_AFTER)))
    return [
        {"label": label, "start_ns": max(start_ns, begin), "end_ns": min(end_ns, end)}
        for label, begin, end in stretches
        if begin < end_ns and end > start_ns
    ]


def _around_alarm(events: Sequence[Event]) -> list[tuple[str, int, int]]:
    """The stretch around the first alarm that ended the program; nothing for warnings."""
    for event in sorted(events, key=lambda event: event.time_ns):
        if event.kind == "alarm" and not event.is_warning:
            at = event.time_ns
            return [("alarm", at - _BEFORE_ALARM_NS, at + _AFTER_ALARM_NS)]
    return []


def _measurements(events: Sequence[Event]) -> list[list[Event]]:
    """Group the events of each measurement: until its standstill, or half a second of nothing."""
    groups: list[list[Event]] = []
    for event in sorted(events, key=lambda event: event.time_ns):
        if event.kind not in _OF_A_MEASUREMENT:
            continue
        last = groups[-1][-1] if groups else None
        if last is None or last.kind == "standstill" or event.time_ns - last.time_ns > _APART_NS:
            groups.append([])
        groups[-1].append(event)
    # A lone edge is the probe leaving the surface, unless there is nothing else to look at.
    whole = [group for group in groups if {event.kind for event in group} != {"edge"}]
    return whole or groups
