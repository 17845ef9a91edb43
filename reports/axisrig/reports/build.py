"""Builds `report.html`: one page that opens offline by double click, from the result files alone.

Equal result folders give equal bytes: the page holds no clock and no path of the machine.
"""

import math
import shlex
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from decimal import Decimal
from importlib import resources
from pathlib import Path
from typing import Any

import pyarrow as pa
from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from axisrig.bench.campaign.results.stored import (
    NOTE,
    RECORDED_IN,
    StoredResults,
    StoredRun,
    read_results,
)
from axisrig.bench.files import write_whole
from axisrig.bench.judge.observed.event import BESIDES
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import findings, shown_facts
from axisrig.bench.plan.checks import parse_check, plot_limits
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError
from axisrig.reports.glossary import glossary
from axisrig.reports.parts.bar import bar
from axisrig.reports.parts.realtime import real_time
from axisrig.reports.parts.topic import ReportTopic
from axisrig.reports.signals import chart
from axisrig.reports.topics import TOPICS

Findings = Callable[[Observed], Mapping[str, Any]]
"""What is shown of a run beside its checks: a block for each topic, marks, log; plain data."""

_SECTION = "section.html"
# What comes up where a part of a recording lacks what another part has
_UNREADABLE = (LookupError, TypeError, ValueError, ArithmeticError, AttributeError, AssertionError)
_WHOLE, _TINY = 1e15, 1e-3
_SHOWN_ELSEWHERE = frozenset({"title", "program", "rig", "tags", "requirement"})


@dataclass(frozen=True)
class _Parts:
    """Who says what is shown of a run, and the topics that show it."""

    findings: Findings
    topics: Sequence[ReportTopic]

    def template(self, name: str) -> str:
        """Return a template of the page; `<topic>/section.html` is that of a topic."""
        packages = {f"{topic.name}/{_SECTION}": topic.package for topic in self.topics}
        if name in packages:
            return resources.files(packages[name]).joinpath(_SECTION).read_text(encoding="utf-8")
        return _file(name)


def build_report(
    results_dir: Path,
    *,
    findings: Findings = findings,
    topics: Sequence[ReportTopic] = TOPICS,
) -> Path:
    """Write `report.html` into a results folder and return its path.

    findings: of a recorded run, a block for each of the topics by its name. Raises UserError when
    the folder is none, or a recording is damaged, OSError with the name of the file.
    """
    results, parts = read_results(results_dir), _Parts(findings, topics)
    environment = Environment(
        loader=FunctionLoader(parts.template),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template("page.html").render(
        view=_page(results, parts),
        style=Markup(_file("vendor/uplot/uPlot.min.css") + _file("style.css")),
        library=Markup(_file("vendor/uplot/uPlot.iife.min.js")),
        script=Markup(_file("page.js")),
        licence=_file("vendor/uplot/LICENSE"),
    )
    path = results_dir / "report.html"
    write_whole(path, page)
    return path


def _file(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _page(results: StoredResults, parts: _Parts) -> dict[str, Any]:
    """Everything the template prints."""
    manifest = results.manifest
    folder = manifest.get("output", results.folder.name)
    output = str(manifest.get(RECORDED_IN, folder))
    runs = []
    for run in results.runs:
        with _readable(run, "what it left"):
            runs.append(_run(run, results.input_columns, output, parts))
    counts = [
        (_verdict(verdict), sum(run.verdict == verdict for run in results.planned))
        for verdict in Verdict
    ]
    return {
        "plans": list(dict.fromkeys(run.case["plan"] for run in results.runs)),
        "verdict": _verdict(results.verdict),
        "counts": counts,
        "missing": results.missing,
        "done": len(results.planned),
        "planned": results.runs_planned,
        "facts": _facts(results),
        "files": _files(manifest),
        "packages": manifest.get("packages", {}),
        "runs": runs,
        "legends": [topic.legend for topic in parts.topics if topic.legend],
        "glossary": glossary(),
    }


def _verdict(verdict: Verdict) -> dict[str, str]:
    return {"word": verdict.word, "glyph": verdict.glyph}


def _facts(results: StoredResults) -> list[tuple[str, str]]:
    """The header of the report: what is known about the campaign."""
    manifest, runs = results.manifest, results.runs
    facts = {
        "started": manifest.get("started"),
        "command": shlex.join(manifest.get("command", [])),
        "axisrig": manifest.get("axisrig"),
        "Python": manifest.get("python"),
        "platform": manifest.get("platform"),
        "CANopen drive in place of": "; ".join(_substituted(runs)),
        "rigs": ", ".join(dict.fromkeys(run.case.get("rig", "") for run in runs)),
        "simulated": _time_of([run for run in runs if not _is_real(run)]),
        "on a real bus": _time_of([run for run in runs if _is_real(run)]),
        "computed in": f"{sum(float(run.case['wall_s']) for run in runs):.1f} s",
        "of earlier calls": "; ".join(_earlier(manifest)),
    }
    return [(name, str(value)) for name, value in facts.items() if value]


def _is_real(run: StoredRun) -> bool:
    facts = run.recording.facts
    return facts is not None and facts.real_time is not None


def _substituted(runs: Sequence[StoredRun]) -> list[str]:
    """What drives stood for that the lists do not name, and in how many runs."""
    found = [run.case.get("drive_substituted", "") for run in runs]
    told = Counter(text for text in found if text)
    return [f"{text} ({_runs(count)})" for text, count in told.items()]


def _earlier(manifest: Mapping[str, Any]) -> Iterator[str]:
    """Calls before the last one whose results are still in the folder."""
    for call in manifest.get("earlier", []):
        command = shlex.join(call.get("command", []))
        yield f"{_runs(len(call['runs']))} of {call.get('started', '')} {command}".rstrip()


def _runs(count: int) -> str:
    return f"{count} run{'s' if count > 1 else ''}"


def _time_of(runs: list[StoredRun]) -> str:
    if not runs:
        return ""
    total_s = sum(float(run.case["sim_s"]) for run in runs)
    return f"{total_s:.3f} s in {_runs(len(runs))}"


def _files(manifest: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Files of the campaign with their SHA-256."""
    plans = {plan["path"]: plan["sha256"] for plan in manifest.get("plans", [])}
    return list({**plans, **manifest.get("files", {}), **manifest.get("fmus", {})}.items())


def _run(run: StoredRun, columns: list[str], output: str, parts: _Parts) -> dict[str, Any]:
    case, info = run.case, _info(run, parts.findings)
    trace = _trace(run)
    alarms = [_alarm(alarm) for alarm in info["alarms"]]
    told = {f"ID {alarm['id']}": alarm["short"] for alarm in alarms}
    sections = []
    for topic in parts.topics:
        with _readable(run, topic.name):
            found = topic.sections(info, trace, run.run, told)
        sections.append({"template": f"{topic.name}/{_SECTION}", "found": found})
    with _readable(run, "trace"):
        description, packed = ({}, "") if trace is None else chart(trace, info, parts.topics)
    checks = [_check(row) for row in run.checks]
    replaced = case.get("drive_substituted", "")
    inputs = [(c, case[c]) for c in columns if case[c] and c not in _SHOWN_ELSEWHERE]
    return {
        "id": run.run,
        "case": run.run.removeprefix(f"{case['plan']}-"),
        "verdict": _verdict(run.verdict),
        "is_in_plan": run.is_in_plan,
        "title": case.get("title", ""),
        "about": [
            *((n, case[n]) for n in ("program", "rig", "requirement", "tags") if case.get(n)),
            *([("CANopen drive in place of", replaced)] if replaced else []),
        ],
        "inputs": inputs,
        "seed": case["seed"],
        "clock": "ran" if info.get("real_time") else "simulated",
        "sim_s": f"{float(case['sim_s']):.3f}",
        "alarms": alarms,
        "hash": case["frame_log_sha256"],
        "unproved": case.get("unproved_latches", ""),
        "checks": checks,
        # A run that ended before it could be judged needs one line, not one for each check.
        "unjudged": bool(info.get("error")) and not any(row["value"] for row in run.checks),
        "error": info.get("error"),
        "messages": info.get("messages", []),
        "log": info.get("log", []),
        "sections": sections,
        "events": _events(info),
        "real_time": real_time(info.get("real_time")),
        "buses": [_bus(bus) for bus in info.get("bus", [])],
        "replay": shlex.join(["axisrig", "replay", output, run.recorded]),
        "chart": description,
        "data": packed,
    }


@contextmanager
def _readable(run: StoredRun, block: str) -> Iterator[None]:
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


def _info(run: StoredRun, findings: Findings) -> dict[str, Any]:
    """What is shown of a run beside its checks: the findings, and limits to draw."""
    facts = run.recording.facts
    found: dict[str, Any] = {"alarms": [], "log": run.log, "error": run.error}
    if facts is not None:
        found = shown_facts(facts)
        found |= {} if run.trace is None else findings(Observed(facts, Series(run.trace)))
    checks = []
    for row in run.checks:
        with suppress(UserError):  # a metric of another version
            checks.append(parse_check(row["metric"], row["check"], row["reference"]))
    return found | {"limits": [limit for check in checks for limit in plot_limits(check)]}


def _trace(run: StoredRun) -> pa.Table | None:
    """The signals of a run, None when it left none. Raises UserError when they are damaged."""
    if run.trace is None:
        return None
    trace = Series(run.trace).table()
    for name, column in zip(trace.column_names, trace.columns, strict=True):
        kind = column.type
        if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
            raise UserError(f"the trace is damaged: {name!r} holds no numbers", file=run.trace)
    return trace


def _alarm(alarm: Mapping[str, Any]) -> dict[str, str]:
    """An alarm with what it says; short: its first sentence, without the place in the program."""
    place = f" ({alarm['place']})" if alarm["place"] else ""
    text = alarm["text"].partition(": ")[2]
    return {
        "id": str(alarm["id"]),
        "text": f"{BESIDES}{text}" if alarm["is_further"] else text,
        "short": text.replace(place, "", 1).partition(". ")[0],
    }


def _check(row: Mapping[str, str]) -> dict[str, Any]:
    uncertainty = float(row["uncertainty"])
    return {
        "metric": row["metric"],
        "condition": row["check"],
        "value": _short(row["value"]),
        "full": row["value"],
        "unit": _unit(row["unit"]),
        "uncertainty": _plain(uncertainty, 2) if uncertainty else "",
        "verdict": _verdict(Verdict.of(row["verdict"])),
        "reference": row["reference"],
        "note": row.get(NOTE, ""),
        "bar": _bar(row, uncertainty),
    }


def _bar(row: Mapping[str, str], uncertainty: float) -> Markup:
    """The drawing of value and limits, or nothing where there is no number to draw."""
    lower, upper = _number(row["lower"]), _number(row["upper"])
    value = _number(row["value"])
    # Between equal limits there is nothing to draw
    limited = lower != upper
    if value is None or not limited or not math.isfinite(uncertainty):
        return Markup("")
    label = (
        f"{row['metric']} is {_short(row['value'])} {_unit(row['unit'])}, asked for {row['check']}"
    )
    return Markup(bar(value, uncertainty, lower, upper, row["verdict"], label))


def _unit(name: str) -> str:
    """A unit of the result files as a reader writes it."""
    return name.replace("um", "µm").replace("pct", "%")


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _short(text: str) -> str:
    """A number with the digits that a reader compares; any other or short text as it is."""
    number = _number(text)
    if number is not None and number.is_integer() and abs(number) < _WHOLE:
        return f"{number:.0f}"
    if number is None or len(text) <= 9:
        return text
    return _plain(number, 7 if abs(number) >= _TINY else 3)


def _plain(number: float, digits: int) -> str:
    """A number with so many significant digits, without exponent where that stays short."""
    text = f"{number:.{digits}g}"
    if "e-" in text and abs(number) >= 1e-7:
        text = f"{Decimal(text):f}"
    return text


def _bus(bus: Mapping[str, Any]) -> dict[str, Any]:
    """The figures of a segment as the table prints them."""
    return {
        "segment": bus["segment"],
        "bitrate": f"{bus['bitrate'] / 1000:g} kbit/s",
        "loads": [f"{bus[key]:.1f}" for key in ("load_pct", "load_100ms_pct", "load_1ms_pct")],
        "frames": bus["frames"],
        "error_frames": bus["error_frames"],
        "overload": bus["overload"],
        "counters": [
            {"port": port, "tec": tec, "rec": rec, "state": state}
            for port, tec, rec, state in bus["counters"]
        ],
        "waiting": [
            {"name": wait["name"], "id": f"{wait['can_id']:03X}", "us": f"{wait['worst_us']:.1f}"}
            for wait in bus["waiting"]
        ],
    }


def _events(info: Mapping[str, Any]) -> list[dict[str, str]]:
    """Events with their time, and the time since the contact (else the edge) before them."""
    rows, origin_ns = [], None
    for event in info.get("events", []):
        if event["kind"] == "contact" or (event["kind"] == "edge" and origin_ns is None):
            origin_ns = event["time_ns"]
        since = "" if origin_ns is None else f"{(event['time_ns'] - origin_ns) / 1e6:.6f}"
        rows.append(
            {
                "time": f"{event['time_ns'] / 1e6:.6f}",
                "since": since,
                "kind": event["kind"],
                "label": event["label"],
                "axis": event["axis"] or "",
            }
        )
    return rows
