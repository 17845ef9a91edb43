"""One run of a results folder as the page shows it: its row, its failure, and what it opens."""

import math
import posixpath
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any
from urllib.parse import quote

import pyarrow as pa
from markupsafe import Markup

from axisrig.bench.campaign.results.stored import PROBE, StoredRun
from axisrig.bench.judge.observed.event import BESIDES, Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import RunFindings, of_facts
from axisrig.bench.plan.check_row import CheckRow, finite
from axisrig.bench.plan.checks import parse_check, plot_limits
from axisrig.bench.plan.expectation import EXPECTED, NOT_MET
from axisrig.bench.plan.searching import BAD, GOOD
from axisrig.bench.plan.sentences import check_sentence, run_sentence, short_number
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import AlarmRecord
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError
from axisrig.reports.blocks.section import Address, blocks_lane, blocks_view
from axisrig.reports.parts.bar import bar
from axisrig.reports.parts.buses import bus_row
from axisrig.reports.parts.picture import picture
from axisrig.reports.parts.realtime import real_time
from axisrig.reports.parts.topic import ReportTopic
from axisrig.reports.parts.words import shown_unit
from axisrig.reports.signals import chart, with_signals
from axisrig.reports.sweeps.searches import searched_column

Findings = Callable[[Observed], RunFindings]
"""What is shown of a run beside its checks."""

SECTION = "section.html"
BUS_LOG = "bus log"
# What comes up where a part of a recording lacks what another part has
_UNREADABLE = (LookupError, TypeError, ValueError, ArithmeticError, AttributeError, AssertionError)
_WHOLE, _TINY = 1e15, 1e-3
_SHOWN_ELSEWHERE = frozenset({"title", "program", "rig", "tags", "requirement"})
_GOOD = (Verdict.PASS, Verdict.MARGINAL)


@dataclass(frozen=True)
class Parts:
    """Who says what is shown of a run, and the topics that show it."""

    findings: Findings
    topics: Sequence[ReportTopic]


def run_view(
    run: StoredRun,
    columns: Sequence[str],
    output: str,
    parts: Parts,
    links: Sequence[tuple[str, str, str]],
    *,
    is_reduced: bool,
) -> dict[str, Any]:
    """Return everything that the templates print of a run, and what its plots need.

    columns: of `cases.csv` that are inputs. output: the folder as a command line names it.
    links: its files: what each is, its name below `output`, its address from the page.
    is_reduced: smallest and largest values in place of all samples. Raises UserError for a
    recording that is damaged, or that another version wrote.
    """
    with readable(run, "what it left"):
        return _view(run, columns, output, parts, links, is_reduced)


def _view(
    run: StoredRun,
    columns: Sequence[str],
    output: str,
    parts: Parts,
    links: Sequence[tuple[str, str, str]],
    is_reduced: bool,
) -> dict[str, Any]:
    series = None if run.trace is None else Series(run.trace)
    trace = None if series is None else series.whole
    case, info = run.case, _info(run, series, parts.findings)
    _check_numbers(trace, run)
    blocks, lane = _blocks(run, partial(_program_address, links), is_reduced=is_reduced)
    alarms = [alarm_words(alarm) for alarm in info.alarms]
    alarm_texts = {f"ID {alarm['id']}": alarm["short"] for alarm in alarms}
    sections = []
    for topic in parts.topics:
        with readable(run, topic.name):
            found = topic.sections(info, trace, run.run, alarm_texts)
        sections.append({"template": f"{topic.name}/{SECTION}", "found": found})
    with readable(run, "trace"):
        drawn: tuple[dict[str, Any], str] = ({}, "")
        if trace is not None:
            limits = _plot_limits(run)
            drawn = chart(
                trace, info, parts.topics, limits=limits, lane=lane, is_reduced=is_reduced
            )
        pictures = _pictures(run, trace, info, drawn[0], parts.topics)
    checks = [_check(row) for row in run.checks]
    commands = [["replay", output, run.recorded]] if run.file else []
    commands += [["bus", f"{output}/{name}"] for what, name, _ in links if what == BUS_LOG][:1]
    inputs = [(c, case[c]) for c in columns if case[c] and c not in _SHOWN_ELSEWHERE]
    return {
        "id": run.run,
        "case": run.run.removeprefix(f"{case['plan']}-"),
        "plan": case["plan"],
        "verdict": verdict_words(run.verdict),
        "is_good": run.verdict in _GOOD,
        "is_in_plan": run.is_in_plan,
        "probe_of": run.case.get(PROBE, ""),
        "title": case.get("title", ""),
        "sentence": _sentence(run, info.error),
        "failures": _failures(run, pictures),
        "about": _about(case),
        "inputs": inputs,
        "seed": case["seed"],
        "clock": "ran" if info.real_time else "simulated",
        "sim_s": f"{float(case['sim_s']):.3f}",
        "alarms": alarms,
        "hash": case["frame_log_sha256"],
        "unproved": case.get("unproved_latches", ""),
        "checks": checks,
        # A run that ended before it could be judged needs one line, not one for each check.
        "unjudged": _is_unjudged(run, info),
        "error": info.error,
        "messages": info.messages,
        "log": info.log,
        "sections": sections,
        "events": event_rows(info.events),
        "blocks": blocks,
        "real_time": real_time(info.real_time),
        "buses": [bus_row(bus) for bus in info.buses],
        "waits": any(bus.waiting for bus in info.buses),
        "commands": [shlex.join(["axisrig", *words]) for words in commands],
        "chart": drawn[0],
        "data": drawn[1],
        "links": links,
        "find": _find_text(run, alarms, inputs),
    }


def _program_address(links: Sequence[tuple[str, str, str]], path: str) -> str:
    """Return the address of a file beside the program of a run, empty where that has none."""
    program = next((address for what, _, address in links if what == "program"), "")
    return posixpath.normpath(posixpath.join(program, "..", quote(path))) if program else ""


def _blocks(
    run: StoredRun, address: Address, *, is_reduced: bool
) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """The table of NC blocks and their lane."""
    facts = run.recording.facts
    trace = None if facts is None else facts.blocks
    try:
        lane = blocks_lane(trace, is_reduced=is_reduced)
        return blocks_view(trace, address, is_reduced=is_reduced), lane
    except UserError as error:
        error.file = error.file or str(run.file)
        raise


def probe_rows(run: StoredRun, probes: Sequence[StoredRun]) -> list[dict[str, Any]]:
    """The probes of a row that searches, by the value that they try; empty for any other run."""
    column = searched_column(run)
    if not column:
        return []
    rows = [
        {
            "id": probe.run,
            "value": probe.case.get(column, ""),
            "verdict": verdict_words(probe.verdict),
            "sentence": _sentence(probe, None),
        }
        for probe in probes
    ]
    return sorted(rows, key=lambda row: float(row["value"] or 0.0))


def _is_unjudged(run: StoredRun, info: RunFindings) -> bool:
    return bool(info.error) and not any(row.value for row in run.checks)


def _about(case: Mapping[str, str]) -> list[tuple[str, str]]:
    replaced = case.get("drive_substituted", "")
    return [
        *((n, case[n]) for n in ("program", "rig", "requirement", "tags") if case.get(n)),
        *([("CiA 402 drive in place of", replaced)] if replaced else []),
    ]


def _sentence(run: StoredRun, error: str | None) -> str:
    """The cause of a verdict; of a run that passed, how many checks did."""
    if run.verdict is not Verdict.PASS:
        return run_sentence(run.verdict, error, _with_units(run.checks))
    found = {row.metric: f"{row.value} {shown_unit(row.unit)}".rstrip() for row in run.checks}
    if {GOOD, BAD} <= found.keys():
        return f"holds at {found[GOOD]}, not at {found[BAD]}"
    failed = sum(row.had_to_fail for row in run.checks)
    count = len(run.checks) - failed
    passed = f"{count} check{'s' if count != 1 else ''} passed"
    return f"{passed}, {failed} failed as expected" if failed else passed


def _with_units(rows: Sequence[CheckRow]) -> list[CheckRow]:
    return [replace(row, unit=shown_unit(row.unit)) for row in rows]


def _failed(run: StoredRun) -> list[CheckRow]:
    """The checks that did not pass, the worst first, without those that are only marginal."""
    rows = [row for row in run.checks if row.outcome not in _GOOD or row.has_missed]
    return sorted(rows, key=lambda row: -row.outcome)


def _pictures(
    run: StoredRun,
    trace: pa.Table | None,
    info: RunFindings,
    description: Mapping[str, Any],
    topics: Sequence[ReportTopic],
) -> dict[str, Markup]:
    """A drawing for each check that did not pass; equal ones are drawn once."""
    failed = _failed(run)
    if trace is None or not description or not failed:
        return {}
    content = with_signals(trace, info, topics)
    found: dict[str, Markup] = {}
    for row in failed:
        drawn = Markup(picture(content, description, row.metric))
        if drawn not in found.values():
            found[row.metric] = drawn
    return found


def _check_sentence(row: CheckRow) -> str:
    if row.has_missed:
        return f"{row.metric} {NOT_MET}"
    return check_sentence(_with_units([row])[0])


def _failures(run: StoredRun, pictures: Mapping[str, Markup]) -> list[dict[str, Any]]:
    """What is shown above everything else: each check that did not pass, with its picture."""
    return [
        {
            "sentence": _check_sentence(row),
            "verdict": verdict_words(row.outcome),
            "reference": row.reference,
            "condition": row.asked,
            "note": _note(row) if row.value else "",
            "bar": _bar(row, float(row.uncertainty)),
            "picture": pictures.get(row.metric, Markup("")),
        }
        for row in _failed(run)
    ]


def _find_text(
    run: StoredRun, alarms: Sequence[Mapping[str, str]], inputs: Sequence[tuple[str, str]]
) -> str:
    """What the field `find` looks in: names, tags, requirement, rig, inputs, metrics, alarms."""
    case = run.case
    words = [
        *(run.run, *(case.get(name, "") for name in ("title", "tags", "requirement"))),
        *(case.get(name, "").rpartition("/")[2] for name in ("program", "rig")),
        *(f"{name}={value}" for name, value in inputs),
        *(row.metric for row in run.checks),
        *(f"{alarm['id']} {alarm['short']}" for alarm in alarms),
        case.get("drive_substituted", ""),
    ]
    return " ".join(dict.fromkeys(word for word in words if word)).lower()


def verdict_words(verdict: Verdict) -> dict[str, str]:
    """Return word and sign of a verdict for the templates."""
    return {"word": verdict.word, "glyph": verdict.glyph}


@contextmanager
def readable(run: StoredRun, block: str) -> Iterator[None]:
    """Raise UserError for a part of a run that was edited, or that another version wrote."""
    try:
        yield
    except _UNREADABLE as error:
        raise UserError(
            f"`{block}` of run {run.run} cannot be read: {_one_line(error)}",
            hint="run the case again with this version",
        ) from error


def _one_line(error: Exception) -> str:
    return repr(error) if type(error) is KeyError else str(error).strip().partition("\n")[0]


def _info(run: StoredRun, series: Series | None, findings: Findings) -> RunFindings:
    """What is shown of a run beside its checks."""
    facts = run.recording.facts
    if facts is None:
        return RunFindings(log=run.log, error=run.error)
    if series is None:
        return of_facts(facts)
    observed = Observed(facts, series)
    found = findings(observed)
    observed.forget()
    return found


def _plot_limits(run: StoredRun) -> list[dict[str, Any]]:
    """The limits of its checks, to draw."""
    checks = []
    for row in run.checks:
        with suppress(UserError):  # a metric of another version
            checks.append(parse_check(row.metric, row.asked, row.reference))
    return [limit for check in checks for limit in plot_limits(check)]


def _check_numbers(trace: pa.Table | None, run: StoredRun) -> None:
    """Raise UserError where a signal of a run is no number."""
    for item in () if trace is None else trace.schema:
        if not (pa.types.is_floating(item.type) or pa.types.is_integer(item.type)):
            raise UserError(f"the trace is damaged: {item.name!r} holds no numbers", file=run.trace)


def alarm_words(alarm: AlarmRecord) -> dict[str, str]:
    """An alarm with what it says; short: its first sentence, without the place in the program."""
    place = f" ({alarm.place})" if alarm.place else ""
    text = alarm.text.partition(": ")[2]
    return {
        "id": str(alarm.id),
        "text": f"{BESIDES}{text}" if alarm.is_further else text,
        "short": text.replace(place, "", 1).partition(". ")[0],
    }


def _check(row: CheckRow) -> dict[str, Any]:
    uncertainty = float(row.uncertainty)
    return {
        "metric": row.metric,
        "condition": row.asked,
        "value": _short(row.value),
        "full": row.value,
        "unit": shown_unit(row.unit),
        "uncertainty": short_number(uncertainty, 2) if uncertainty else "",
        "verdict": verdict_words(row.outcome),
        "reference": row.reference,
        "note": _note(row),
        "bar": _bar(row, uncertainty),
    }


def _note(row: CheckRow) -> str:
    """The note of a check: why it has no value, or what its uncertainty is made of."""
    note = row.note
    is_of_value = bool(row.value) and float(row.uncertainty) > 0.0
    return f"uncertainty: {note}" if note and is_of_value and EXPECTED not in note else note


def _bar(row: CheckRow, uncertainty: float) -> Markup:
    """The drawing of value and limits, or nothing where there is no number to draw."""
    (lower, upper), value = row.limits, row.number
    # Between equal limits there is nothing to draw
    limited = lower != upper
    if value is None or not limited or not math.isfinite(uncertainty):
        return Markup("")
    value_words = f"{_short(row.value)} {shown_unit(row.unit)}"
    label = f"{row.metric} is {value_words}, asked for {row.asked}"
    return Markup(bar(value, uncertainty, lower, upper, row.verdict, label))


def _short(text: str) -> str:
    """A number with the digits that a reader compares; any other or short text as it is."""
    number = finite(text)
    if number is not None and number.is_integer() and abs(number) < _WHOLE:
        return f"{number:.0f}"
    if number is None or len(text) <= 9:
        return text
    return short_number(number, 7 if abs(number) >= _TINY else 3)


def event_rows(events: Sequence[Event]) -> list[dict[str, str]]:
    """Events with their time, and the time since the contact (else the edge) before them."""
    rows: list[dict[str, str]] = []
    origin_ns: int | None = None
    for event in events:
        if event.kind == "contact" or (event.kind == "edge" and origin_ns is None):
            origin_ns = event.time_ns
        since = "" if origin_ns is None else f"{(event.time_ns - origin_ns) / 1e6:.6f}"
        rows.append(
            {
                "time": f"{event.time_ns / 1e6:.6f}",
                "since": since,
                "kind": event.kind,
                "label": event.label,
                "axis": event.axis or "",
            }
        )
    return rows
