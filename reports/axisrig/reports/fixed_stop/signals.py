"""What the signals of a run to a fixed stop show: the criteria as curves, limits, stretches."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.judge.fixed_stop.stop_findings import StopFindings
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.series import column_of, values_of
from axisrig.reports.fixed_stop.timeline import Span, span_of
from axisrig.reports.parts.topic import Plots

CHANGE, CHANGE_TURNED = "change_um", "change_mdeg"
"""Suffix of the column that this module adds: way of an axis within the minimum time."""

# Columns and plots of a linear axis, and those of a rotary one
_TURNED = {
    **{"cnc_lag_mm": "cnc_lag_deg", "truth_mm": "truth_deg", "stop_mm": "stop_deg"},
    **{"stop_force_n": "stop_torque_nm", "actual_mm": "actual_deg", "set_mm": "set_deg"},
    **{"lag": "angular_lag", "change": "turned", "position": "angle", CHANGE: CHANGE_TURNED},
}

_NS_PER_MS = 1e6
_CHANGE_SHOWN = 5.0
_AFTER = 0.1
_LEAST_NS = 10_000_000
_SIGNALS = ("cnc_lag_mm", "truth_mm", "stop_mm", "stop_force_n")
_MEASURED = frozenset({"beyond", "window", "detected", "stands", "relax_end", "end"})

Signal = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Shortfall:
    """How far an axis came towards its criteria between arming and the end of the run.

    largest_lag_mm: amount. beyond_ms: longest uninterrupted time beyond the lag limit. change_um:
    smallest way within the minimum time while the set value moved. None where the trace, or a
    criterion, is missing.
    """

    largest_lag_mm: float | None
    beyond_ms: float | None
    change_um: float | None


@dataclass(frozen=True)
class Contact:
    """An axis that touched its stop, and when."""

    axis: str
    time_ns: int


@dataclass(frozen=True)
class Stop(StopFindings):
    """A run to a fixed stop with the names of its signals.

    signals: per axis, the columns for `cnc_lag_mm` and the like; one that the trace lacks is
    missing there.
    """

    signals: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def decided_axis(self) -> str | None:
        """The axis whose criterion found the stop."""
        return None if self.decided_by is None else self.decided_by.axis

    def column(self, axis: str | None, name: str) -> str | None:
        """Return the column of a signal of an axis, named as that of a linear one."""
        return self.signals.get(axis or "", {}).get(name)

    def min_time_ns(self, axis: str | None) -> int:
        """Return how long a criterion of an axis has to hold, 0 for one that has none."""
        limits = self.limits.get(axis or "")
        return 0 if limits is None else round(_NS_PER_MS * limits.min_time_ms)


def stops_of(info: RunFindings, columns: Sequence[str]) -> list[Stop]:
    """Return the runs to a fixed stop of a case, with the names of the signals of each axis.

    info: what is shown of it. columns: of its trace.
    """
    return [
        Stop(
            **vars(found),
            signals={
                axis: {
                    name: column
                    for name in _SIGNALS
                    for column in (f"{axis}.{name}", f"{axis}.{_TURNED[name]}")
                    if column in columns
                }
                for axis in dict.fromkeys((*found.axes, *found.watched))
            },
        )
        for found in info.of(StopFindings)
    ]


def with_signals(trace: pa.Table, info: RunFindings) -> pa.Table:
    """Return the signals of a run with those of the window criterion; see `with_changes`."""
    return with_changes(trace, stops_of(info, trace.column_names))


def plots(trace: pa.Table, info: RunFindings) -> Plots:
    """Return what runs to a fixed stop add to the plots; the last one is open."""
    stops = stops_of(info, trace.column_names)
    if not stops:
        return Plots()
    return Plots(
        axes=[] if stops[-1].main_axis is None else [stops[-1].main_axis],
        limits=limits(trace, stops),
        windows=windows(stops),
        spans=[(stop.begin_ns, stop.end_ns) for stop in stops],
        more={
            "opens": len(windows(stops[:-1])),
            "bands": bands(stops),
            "ranges": ranges(stops),
        },
    )


def of_axis(stop: Stop, axis: str, name: str) -> str:
    """Return the column or plot of an axis, as a linear or a rotary one has it."""
    return _TURNED[name] if axis in stop.rotary else name


def mark(stop: Stop, key: str, axis: str | None = None) -> int | None:
    """Return the measured instant of the first mark of a key, in ns; None when it never came."""
    for row in stop.marks:
        is_of = row.key == key and (axis is None or row.axis in (axis, None))
        if is_of and row.measured_ns is not None:
            return row.measured_ns
    return None


def contact_ns(stop: Stop) -> int | None:
    """Return the instant of `contact`, None without one."""
    found = contact(stop)
    return None if found is None else found.time_ns


def contact(stop: Stop) -> Contact | None:
    """Return the contact that a run met: of the deciding axis, else the first.

    None without a contact before the detection.
    """
    detected = mark(stop, "detected")
    before = [
        Contact(row.axis or "", row.measured_ns)
        for row in stop.marks
        if row.key == "contact"
        and row.measured_ns is not None
        and (detected is None or row.measured_ns <= detected)
    ]
    own = [touched for touched in before if touched.axis == stop.decided_axis]
    return min(own or before, key=lambda touched: touched.time_ns, default=None)


def origin_ns(stop: Stop) -> int:
    """Return the instant that the times of a run count from: its contact, else its begin."""
    touched = contact_ns(stop)
    if touched is not None:
        return touched
    begin = mark(stop, "begin")
    return stop.begin_ns if begin is None else begin


def span(stop: Stop) -> Span:
    """Return the stretch of time that the timeline of a run shows, in ms from its origin."""
    origin = origin_ns(stop)
    instants = [stop.begin_ns, stop.end_ns]
    touched = contact_ns(stop)
    if touched is not None:
        rows = [row for row in stop.marks if row.key in _MEASURED]
        known = [at for row in rows for at in (row.measured_ns, row.low_ns, row.high_ns)]
        instants = [touched, stop.end_ns, *(t for t in known if t is not None)]
    return span_of([(t - origin) / _NS_PER_MS for t in instants])


def with_changes(trace: pa.Table, stops: Sequence[Stop]) -> pa.Table:
    """Add what the window criterion compares: |x(t) - x(t - tau)| of each watched axis, in um.

    From the actual positions received, inside the runs only. Source: physics of the criterion, see
    P-AXIS-00778.
    """
    times = values_of(trace.column("time_ns"))
    added: dict[str, Signal] = {}
    for stop in stops:
        for axis, limits in stop.limits.items():
            actual = f"{axis}.{of_axis(stop, axis, 'actual_mm')}"
            if limits.window_mm is None or actual not in trace.column_names:
                continue
            inside = (times >= stop.begin_ns) & (times <= stop.end_ns)
            column = added.setdefault(
                f"{axis}.{of_axis(stop, axis, CHANGE)}", np.full(len(times), np.nan)
            )
            change = _change_um(times, values_of(trace.column(actual)), limits.min_time_ms)
            column[inside] = change[inside]
    for name, values in added.items():
        trace = trace.append_column(name, column_of(values))
    return trace


def _change_um(times_ns: npt.NDArray[np.int64], actual_mm: Signal, min_time_ms: float) -> Signal:
    """Way of an axis within the minimum time that ends at each row; shape (n,), um."""
    before = times_ns - round(min_time_ms * _NS_PER_MS)
    row = np.searchsorted(times_ns, before, side="right") - 1
    change: Signal = 1000.0 * np.abs(actual_mm - actual_mm[np.maximum(row, 0)])
    change[row < 0] = np.nan
    return change


def shortfall(trace: pa.Table | None, stop: Stop, axis: str) -> Shortfall:
    """Tell how far an axis came towards its criteria; trace: with the columns added."""
    if trace is None:
        return Shortfall(None, None, None)
    times = values_of(trace.column("time_ns"))
    begin = mark(stop, "armed") or stop.begin_ns
    inside = (times >= begin) & (times <= stop.end_ns)
    limits = stop.limits[axis]
    lag = _column(trace, stop.column(axis, "cnc_lag_mm"))
    largest = beyond = change = None
    if lag is not None and inside.any():
        largest = float(np.nanmax(np.abs(lag[inside])))
        if limits.lag_limit_mm is not None:
            over = np.abs(lag[inside]) > limits.lag_limit_mm
            beyond = _longest_ms(times[inside], over)
    way = _column(trace, f"{axis}.{of_axis(stop, axis, CHANGE)}")
    lead = _column(trace, f"{axis}.{of_axis(stop, axis, 'set_mm')}")
    if way is not None and lead is not None:
        moving = inside & (np.diff(lead, prepend=lead[:1]) != 0.0) & np.isfinite(way)
        change = float(way[moving].min()) if moving.any() else None
    return Shortfall(largest, beyond, change)


def _column(trace: pa.Table, name: str | None) -> Signal | None:
    if name is None or name not in trace.column_names:
        return None
    values: Signal = values_of(trace.column(name)).astype(np.float64)
    return values


def _longest_ms(times_ns: npt.NDArray[np.int64], over: npt.NDArray[np.bool_]) -> float:
    """Longest time without interruption in which something holds, 0 when it never does."""
    longest, begin = 0, None
    for time_ns, holds in zip(times_ns.tolist(), over.tolist(), strict=True):
        if not holds:
            begin = None
            continue
        begin = time_ns if begin is None else begin
        longest = max(longest, time_ns - begin)
    return longest / _NS_PER_MS


def value_at(trace: pa.Table | None, name: str | None, time_ns: int | None) -> float | None:
    """Return a signal at an instant, linear between its rows; None where there is none."""
    values = None if trace is None else _column(trace, name)
    if trace is None or values is None or time_ns is None:
        return None
    times = values_of(trace.column("time_ns"))
    if not times[0] <= time_ns <= times[-1]:
        return None
    found = float(np.interp(time_ns, times, values))
    return found if np.isfinite(found) else None


def largest(trace: pa.Table | None, name: str | None, stop: Stop) -> float | None:
    """Return the largest amount of a signal within a run; None where there is none."""
    values = None if trace is None else _column(trace, name)
    if trace is None or values is None:
        return None
    times = values_of(trace.column("time_ns"))
    inside = values[(times >= stop.begin_ns) & (times <= stop.end_ns) & np.isfinite(values)]
    return float(np.abs(inside).max()) if len(inside) else None


def limits(trace: pa.Table, stops: Sequence[Stop]) -> list[dict[str, Any]]:
    """Limits for the plots: lag limit, window, torque limit, and where the contact was."""
    found: list[dict[str, Any]] = []
    for stop in stops:
        for axis, own in stop.limits.items():
            lag, way = own.lag_limit_mm, own.window_mm
            if lag is not None:
                found.append(
                    _limit(of_axis(stop, axis, "lag"), axis, _sign(trace, stop, axis) * lag, "L")
                )
            if way is not None:
                found.append(_limit(of_axis(stop, axis, "change"), axis, 1000.0 * way, "W"))
            place = value_at(trace, stop.column(axis, "truth_mm"), mark(stop, "contact", axis))
            if place is not None and stop.column(axis, "stop_mm") is None:
                found.append(
                    _limit(of_axis(stop, axis, "position"), axis, round(place, 4), "contact at")
                )
            force, torque = own.force_limit_n, own.torque_limit_nm
            if force is not None:
                found.append(_limit("force", axis, round(force, 1), "torque limit"))
            if torque is not None:
                found.append(_limit("torque", axis, round(torque, 3), "torque limit"))
    return [limit for i, limit in enumerate(found) if limit not in found[:i]]


def _limit(plot: str, axis: str, value: float, label: str) -> dict[str, Any]:
    return {"plot": plot, "axis": axis, "value": round(value, 6), "label": label}


def _sign(trace: pa.Table, stop: Stop, axis: str) -> float:
    """The sign of the lag where it is largest within a run."""
    lag = _column(trace, stop.column(axis, "cnc_lag_mm"))
    times = values_of(trace.column("time_ns"))
    inside = (times >= stop.begin_ns) & (times <= stop.end_ns)
    if lag is None or not inside.any():
        return 1.0
    return float(np.sign(lag[inside][np.nanargmax(np.abs(lag[inside]))])) or 1.0


def ranges(stops: Sequence[Stop]) -> dict[str, dict[str, list[float]]]:
    """What the plots of the way within the minimum time show per axis, in um (mdeg)."""
    tops: dict[str, dict[str, list[float]]] = {}
    for stop in stops:
        for axis, own in stop.limits.items():
            if own.window_mm:
                top = _CHANGE_SHOWN * 1000.0 * own.window_mm
                tops.setdefault(of_axis(stop, axis, "change"), {})[axis] = [0.0, top]
    return tops


def bands(stops: Sequence[Stop]) -> list[dict[str, Any]]:
    """The closed form's bands to draw under the signals."""
    return [
        {"axis": row.axis, "start_ns": row.low_ns, "end_ns": row.high_ns}
        for stop in stops
        for row in stop.marks
        if row.low_ns is not None and row.high_ns is not None
    ]


def windows(stops: Sequence[Stop]) -> list[dict[str, Any]]:
    """Stretches worth a button: what the timeline shows, and the detection; see `signals.windows`.

    `origin_ns` and `zero`: what the times of the stretch count from.
    """
    found = []
    for stop in stops:
        count = f" {stop.number}" if len(stops) > 1 else ""
        origin, shown = origin_ns(stop), span(stop)
        zero = {
            "origin_ns": origin,
            "zero": ("begin" if contact_ns(stop) is None else "contact") + count,
        }
        found.append(
            {
                "label": "fixed stop" + count,
                "start_ns": origin + round(shown.low * _NS_PER_MS),
                "end_ns": origin + round(shown.high * _NS_PER_MS),
                **zero,
            }
        )
        detected = mark(stop, "detected")
        if detected is not None:
            begin, end = _detection(stop, detected)
            found.append({"label": "detection" + count, "start_ns": begin, "end_ns": end, **zero})
    return found


def _detection(stop: Stop, detected: int) -> tuple[int, int]:
    """From before the criteria of the deciding axis began to hold until the set value rests."""
    end = max(mark(stop, "stands") or detected, detected)
    begin = detected - stop.min_time_ns(stop.decided_axis)
    margin = round(max(_AFTER * (end - begin), _LEAST_NS))
    return begin - margin, end + margin
