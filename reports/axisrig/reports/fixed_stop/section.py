"""The timeline of a run to a fixed stop: from its findings to the page.

Nothing is judged here: measured instants are beside those of the closed form, with its band.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa
from markupsafe import Markup

from axisrig.bench.judge.fixed_stop.stop_findings import KERNEL, Mark
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.fixed_stop.signals import (
    Stop,
    contact_ns,
    mark,
    origin_ns,
    span,
    stops_of,
    with_changes,
)
from axisrig.reports.fixed_stop.timeline import Row, Span, axis, lane
from axisrig.reports.fixed_stop.words import answers, state
from axisrig.reports.parts.bar import bar

_NS_PER_MS = 1e6
_AFTER_END_NS = 20_000_000
_KINDS = {
    "contact": "contact",
    "beyond": "edge",
    "window": "edge",
    "detected": "latch",
    "stands": "brake",
    "relax_begin": "pdo",
    "relax_end": "pdo",
    "alarm": "alarm",
    "fault": "fault",
}
_FROM = {"stands": "detected", "relax_end": "relax_begin"}
_STATES = {
    "found": ("●", "stop found"),
    "false": ("▲", "false trigger"),
    "missed": ("○", "no stop found"),
    "ended": ("■", "ended by"),
}


def sections(
    info: RunFindings, trace: pa.Table | None, run: str, alarms: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Make what the page prints of each run to a fixed stop of a case, in their order.

    info: what is shown of the run. trace: its signals, if it left any. run: makes names on the
    page.
    alarms: what each alarm says, by the words of its event (`ID 900036`).
    """
    stops = stops_of(info, () if trace is None else trace.column_names)
    if trace is not None and stops:
        trace = with_changes(trace, stops)
    return [
        {
            "number": stop.number if len(stops) > 1 else "",
            **_timeline(
                stop,
                _trouble(stop, info.events, alarms),
                trace,
                f"{run}-{stop.number}",
            ),
        }
        for stop in stops
    ]


def _timeline(
    stop: Stop, trouble: Sequence[Mark], trace: pa.Table | None, name: str
) -> dict[str, Any]:
    shown, origin = span(stop), origin_ns(stop)
    now = state(stop, trouble)
    glyph, word = _STATES[now]
    if trouble:
        word = f"{word}{' ' if now == 'ended' else ', then '}{trouble[0].label}"
    last = [row.key in ("monitoring_on", "end") for row in stop.marks]
    end = last.index(True) if any(last) else len(last)
    rows = [*stop.marks[:end], *trouble, *stop.marks[end:]]
    return {
        "block": stop.block,
        "glyph": glyph,
        "word": word,
        "state": now,
        "origin": "contact" if contact_ns(stop) is not None else "begin",
        "answers": answers(stop, trouble, trace),
        "prediction": stop.prediction,
        "notes": stop.notes,
        "axis": Markup(axis(shown, f"grid-{name}")),
        "rows": [_row(row, stop, origin, shown, f"grid-{name}") for row in rows],
        "values": [_value(row) for row in stop.values],
    }


def _trouble(stop: Stop, events: Sequence[Event], alarms: Mapping[str, str]) -> list[Mark]:
    """Alarms that end programs, and faults, within a run: as marks."""
    return [
        Mark(event.kind, event.label, None, event.time_ns, KERNEL, note=alarms.get(event.label, ""))
        for event in events
        if event.kind in ("alarm", "fault")
        and not event.is_warning
        and stop.begin_ns <= event.time_ns <= stop.end_ns + _AFTER_END_NS
    ]


# Rows


def _row(row: Mark, stop: Stop, origin: int, shown: Span, grid: str) -> dict[str, Any]:
    """One line of the table: names, drawing, instants in ms from the origin."""
    at, middle = _ms(row.measured_ns, origin), _ms(row.oracle_ns, origin)
    low, high = _ms(row.low_ns, origin), _ms(row.high_ns, origin)
    band = None if middle is None or low is None or high is None else (low, middle, high)
    label = row.label + (f" · {row.axis}" if row.axis else "")
    words = f"{label}: " + ("never" if at is None else f"{at:.2f} ms")
    kind = _KINDS.get(row.key, "mark")
    drawing = lane(shown, Row(kind, at, words, _stretch(row, stop, origin), band), grid)
    return {
        "key": row.key,
        "kind": kind,
        "label": label,
        "lane": Markup(drawing),
        "at": "never" if at is None else f"{at:.2f}",
        **_beside(at, band, label),
        "is_inside": row.is_inside,
        "note": row.note,
    }


def _beside(
    at: float | None, band: tuple[float, float, float] | None, label: str
) -> dict[str, Any]:
    """The closed form beside the measured instant: instant, band, difference, as words."""
    if band is None:
        return {"form": "", "band": "", "apart": "", "bar": Markup("")}
    low, middle, high = band
    cells = {
        "form": f"{middle:.2f}",
        "band": f"{low - middle:+.2f} … {high - middle:+.2f}",
        "apart": "",
        "bar": Markup(""),
    }
    if at is None:
        return cells
    words = f"{label}: {at - middle:+.2f} ms from the closed form"
    verdict = "pass" if low <= at <= high else "fail"
    drawn = bar(at - middle, 0.0, low - middle, high - middle, verdict, words)
    return {**cells, "apart": f"{at - middle:+.2f}", "bar": Markup(drawn)}


def _stretch(row: Mark, stop: Stop, origin: int) -> tuple[float, float] | None:
    """What lasts: the minimum time of a criterion, a motion, the time without monitoring."""
    at = row.measured_ns
    if at is None:
        return None
    tau_ns = stop.min_time_ns(row.axis)
    begin, end = at, at
    if row.key == "beyond":
        end = at + tau_ns
    elif row.key == "window":
        begin = at - tau_ns
    elif row.key == "monitoring_off":
        end = mark(stop, "monitoring_on") or stop.end_ns
    else:
        begin = mark(stop, _FROM.get(row.key, ""), row.axis) or at
    if begin >= end:
        return None
    return (begin - origin) / _NS_PER_MS, (end - origin) / _NS_PER_MS


def _ms(time_ns: int | None, origin: int) -> float | None:
    return None if time_ns is None else (time_ns - origin) / _NS_PER_MS


# Values


def _value(row: Value) -> dict[str, Any]:
    """One measured value beside the bounds of the closed form, as far as the digits shown go."""
    measured, low, high = (_rounded(side) for side in (row.measured, row.low, row.high))
    if low == high:  # no bounds but a value, which is in a column of its own
        low = high = None
    label = row.label + (f" · {row.axis}" if row.axis else "")
    drawn = ""
    is_inside = None
    if measured is not None and (low is not None or high is not None):
        is_inside = (low is None or low <= measured) and (high is None or measured <= high)
        words = f"{label}: {_number(measured)} {row.unit}"
        drawn = bar(measured, 0.0, low, high, "pass" if is_inside else "fail", words)
    bounds = [("≥" if high is None else "", low), ("≤" if low is None else "", high)]
    return {
        "label": label,
        "unit": row.unit,
        "measured": "" if measured is None else _number(measured),
        "expected": "" if row.expected is None else _number(row.expected),
        "apart": _apart(row),
        "band": " … ".join(f"{sign}{_number(v)}" for sign, v in bounds if v is not None),
        "bar": Markup(drawn),
        "is_inside": is_inside,
        "note": row.note,
    }


def _apart(row: Value) -> str:
    """Measured less expected, lengths in um."""
    if row.measured is None or row.expected is None:
        return ""
    apart = row.measured - row.expected
    if row.unit == "mm":
        return f"{1000.0 * apart:+.3f} µm"
    return f"{apart:+.4g} {row.unit}"


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(_number(value))


def _number(value: float) -> str:
    """Six significant digits without exponent: micrometres of a position, tenths of a force."""
    text = f"{value:.7g}" if abs(value) >= 100.0 else f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
