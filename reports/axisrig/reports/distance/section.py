"""Distance control of a case: from its findings to the page.

Nothing is judged here: what the control did is beside what closed forms say of its loop.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa
from markupsafe import Markup

from axisrig.bench.judge.distance.control_findings import (
    DEGREE,
    ControlFindings,
    DistanceLaw,
    EndError,
    UsedLimit,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.distance.path import drawing
from axisrig.reports.distance.words import happened, is_unstable, law_words, state
from axisrig.reports.parts.bar import bar

_NS_PER_MS = 1e6
_REACHED = 1e-6


def sections(
    info: RunFindings, trace: pa.Table | None, _run: str, alarms: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Make what the page prints of each axis with distance control, in their order.

    info: what is shown of the run. trace: its signals as recorded, if it left any. alarms: what
    each alarm says, by the words of its event (`ID 70331`).
    """
    return [
        _section(control, _ended(control, info.events), trace, alarms)
        for control in info.of(ControlFindings)
    ]


def _ended(control: ControlFindings, events: Sequence[Event]) -> list[Event]:
    """Alarms that ended the program while the control was on, or in the cycle that it fell off."""
    on = [s for s in control.stretches if s.state != "INACTIVE"]
    slack = round(2 * control.period_ms * _NS_PER_MS)
    return [
        event
        for event in events
        if event.kind == "alarm"
        and not event.is_warning
        and any(s.begin_ns - slack <= event.time_ns <= s.end_ns + slack for s in on)
    ]


def _section(
    control: ControlFindings,
    ended: Sequence[Event],
    trace: pa.Table | None,
    alarms: Mapping[str, str],
) -> dict[str, Any]:
    key, glyph, word = state(control, ended)
    return {
        "axis": control.axis,
        "unit": control.unit,
        "small": "m°" if control.unit == DEGREE else "µm",
        "sensor": control.sensor,
        "period": f"{control.period_ms:g}",
        "state": key,
        "glyph": glyph,
        "word": word,
        "happened": happened(control, ended, trace, alarms),
        "laws": [_law(row, control) for row in control.laws],
        "errors": [_error(row) for row in control.errors],
        "limits": [_limit(row) for row in control.limits],
        "notes": control.notes,
        "path": Markup(drawing(trace, control)),
    }


def _law(row: DistanceLaw, control: ControlFindings) -> dict[str, Any]:
    """One law with its controller: what theory and frames say of it."""
    limit, unstable = row.kp_limit, is_unstable(row)
    measured = control.dead.measured
    return {
        "mode": row.mode,
        "formula": row.formula,
        "filter": "none" if row.filter == "mean of 1" else row.filter,
        "delay": f"{round(row.delay_cycles, 9) + 0.0:.3g}",
        "noise": f"{row.noise_gain:.3g}",
        "kp": f"{row.kp:g}",
        "tn": f"{row.tn_s:g} s" if row.tn_s else "off",
        "tv": f"{row.tv_s:g} s" if row.tv_s else "off",
        "predicted": control.dead.predicted,
        "measured": "–" if measured is None else measured,
        "dead_off": measured is not None and measured != control.dead.predicted,
        "dead_note": control.dead.note,
        "limit": _limit_of_kp(row),
        "margin": _margin(row),
        "bar": Markup(
            ""
            if not limit
            else bar(
                row.kp,
                0.0,
                None,
                limit,
                "fail" if unstable else "pass",
                f"kp {row.kp:g}, limit {limit:.3f}",
            )
        ),
        "unstable": unstable,
        "words": law_words(row),
    }


def _limit_of_kp(row: DistanceLaw) -> str:
    if row.kp_limit_unknown:
        return "not known"
    return "none" if row.kp_limit is None else f"{row.kp_limit:.3f}"


def _margin(row: DistanceLaw) -> str:
    """Gain margin: limit over kp."""
    limit = row.kp_limit
    return "" if limit is None else f"{limit / row.kp:.2f}"


def _error(row: EndError) -> dict[str, Any]:
    """The true error at the end of a stretch beside its closed form, in um or 0.001 degrees."""
    expected = row.expected_mm
    return {
        "mode": row.mode,
        "begin": f"{row.begin_ns / _NS_PER_MS:.0f}",
        "speed": f"{row.speed_mm_s:.3f}",
        "measured": f"{1000.0 * row.measured_mm:.2f}",
        "spread": f"{1000.0 * row.spread_mm:.2f}",
        "expected": "–" if expected is None else f"{1000.0 * expected:.2f}",
        "apart": "" if expected is None else f"{1000.0 * (row.measured_mm - expected):+.2f}",
        "note": row.note,
    }


def _limit(row: UsedLimit) -> dict[str, Any]:
    """A limit and the most that was used of it."""
    value, used, is_lower = row.value, row.used, row.key == "min_pos"
    cells = {
        "key": row.key,
        "parameter": row.parameter,
        "unit": row.unit,
        "value": f"{value:.6g}",
        "used": "–" if used is None else f"{used:.6g}",
        "acts": row.acts,
        "word": "",
        "off": False,
        "bar": Markup(""),
    }
    if used is None:
        return cells
    room = _REACHED * max(abs(value), 1e-3)
    beyond = used < value - room if is_lower else used > value + room
    reached = abs(used - value) <= room
    drawn = bar(
        used,
        0.0,
        value if is_lower else None,
        None if is_lower else value,
        "fail" if beyond else "pass",
        f"{row.key}: {used:.6g} of {value:.6g} {row.unit}",
    )
    word = "outside" if beyond else ("reached" if reached else "")
    return {**cells, "word": word, "off": beyond, "bar": Markup(drawn)}
