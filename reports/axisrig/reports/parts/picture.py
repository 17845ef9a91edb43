"""One signal with its limits as a small drawing, beside a failure."""

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.record.series import TIME, values_of
from axisrig.reports.parts.axes import Field, with_room

WIDTH, HEIGHT = 440, 104
_LEFT, _RIGHT, _TOP, _BOTTOM = 6.0, 6.0, 16.0, 15.0
_COLUMNS = 210
_STYLES = ("actual", "truth", "velocity")
_POSITION = ("position", "angle")

Array = npt.NDArray[np.float64]


def picture(content: pa.Table, chart: Mapping[str, Any], metric: str) -> str:
    """Draw what a check is about as SVG, empty where there is nothing to draw.

    content: all rows of the trace. chart: the description of its plots (`signals.chart`). metric:
    of the check. With limits in a plot: its signal over the whole run and these limits. Without:
    the position in the stretch that the plots open with.
    """
    limits = [limit for limit in chart.get("limits", []) if limit["label"] == metric]
    plots = {plot["plot"]: plot for plot in chart.get("plots", [])}
    axis = metric.partition(":")[2] or chart.get("axis")
    names = [limit["plot"] for limit in limits] or list(_POSITION)
    plot = next((plots[name] for name in names if name in plots), None)
    series = [] if plot is None else plot["series"].get(axis) or plot["series"].get("*") or []
    if plot is None or not series:
        return ""
    entry = min(series, key=lambda one: _rank(one["style"]))
    time_ns = values_of(content.column(TIME))
    values = values_of(content.column(entry["column"])).astype(np.float64)
    begin, end = int(time_ns[0]), int(time_ns[-1])
    if not limits and chart.get("windows"):
        window = chart["windows"][chart.get("opens") or 0]
        begin, end = window["start_ns"], window["end_ns"]
    inside = (time_ns >= begin) & (time_ns <= end)
    heights = sorted({float(limit["value"]) for limit in limits})
    title = f"{axis} {entry['label']}, {plot['unit']}" if axis else f"{entry['label']}"
    marks = [
        (mark["time_ns"], mark["kind"])
        for mark in chart.get("events", [])
        if begin <= mark["time_ns"] <= end
        and mark["kind"] in {"alarm", "fault", "contact", "edge", "latch"}
    ]
    return _drawing(time_ns[inside], values[inside], (begin, end), heights, marks, title)


def _rank(style: str) -> int:
    return _STYLES.index(style) if style in _STYLES else len(_STYLES)


def _drawing(
    time_ns: npt.NDArray[np.int64],
    values: Array,
    span: tuple[int, int],
    limits: Sequence[float],
    marks: Sequence[tuple[int, str]],
    title: str,
) -> str:
    known = np.isfinite(values)
    time_ns, values = time_ns[known], values[known]
    if not len(values) or span[1] <= span[0]:
        return ""
    least = min(float(values.min()), *limits, math.inf)
    most = max(float(values.max()), *limits, -math.inf)
    ends = with_room((least, most), 1e-6)
    field = Field(_LEFT, WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM, span, ends)
    words = f"{title} from {_ms(span[0])} to {_ms(span[1])}"
    parts = [
        f'<svg class="pic" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
        f' aria-label="{escape(words, quote=True)}">',
        field.frame(),
    ]
    for instant, kind in dict.fromkeys((round(field.x(t), 1), kind) for t, kind in marks):
        parts.append(
            f'<line class="pic-mark k-{kind}" x1="{instant}" x2="{instant}" y1="{_TOP:g}"'
            f' y2="{HEIGHT - _BOTTOM:g}"/>'
        )
    parts.append(f'<polyline class="pic-signal" points="{_points(time_ns, values, field)}"/>')
    for limit in limits:
        place = round(field.y(limit), 1)
        parts.append(
            f'<line class="pic-limit" x1="{_LEFT:g}" x2="{WIDTH - _RIGHT:g}" y1="{place}"'
            f' y2="{place}"/>'
        )
    if limits:
        text = "limit " + " and ".join(f"{limit:.7g}" for limit in limits)
        parts.append(
            f'<text class="pic-limit-word" x="{WIDTH - _RIGHT:g}" y="11"'
            f' text-anchor="end">{text}</text>'
        )
    foot = HEIGHT - 3
    parts += [
        f'<text x="{_LEFT:g}" y="11">{escape(title)}: {least:.7g} to {most:.7g}</text>',
        f'<text x="{_LEFT:g}" y="{foot}">{_ms(span[0])}</text>',
        f'<text x="{WIDTH - _RIGHT:g}" y="{foot}" text-anchor="end">{_ms(span[1])}</text>',
        "</svg>",
    ]
    return "".join(parts)


def _points(time_ns: npt.NDArray[np.int64], values: Array, field: Field) -> str:
    """Smallest and largest value of each column of pixels, in the order of the signal."""
    x, y = field.x, field.y
    if len(values) <= 2 * _COLUMNS:
        return " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in zip(time_ns, values, strict=True))
    first = np.linspace(0, len(values), _COLUMNS, endpoint=False).astype(np.int64)
    least, most = np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)
    last = np.append(first[1:], len(values)) - 1
    points = []
    for at, low, high, is_rising in zip(
        time_ns[first].tolist(), least, most, values[first] <= values[last], strict=True
    ):
        ends = (low, high) if is_rising else (high, low)
        points += [f"{x(at):.1f},{y(end):.1f}" for end in dict.fromkeys(ends)]
    return " ".join(points)


def _ms(instant_ns: int) -> str:
    return f"{instant_ns / 1e6:.6g} ms"
