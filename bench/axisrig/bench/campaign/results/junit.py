"""The results as JUnit XML, the form that CI servers read.

The schema is xunit1, for its test cases may carry properties: value, lower, upper, unit and
verdict of each check, the seed, the requirement, what was tested (`[info]`, `--info`) and the
simulated time `sim_s`. `time` is wall
time, `timestamp` when a run began: they alone differ between two equal campaigns. `file` and
`line` are the row of the plan.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from axisrig.bench.campaign.results.stored import (
    TIMESTAMP,
    StoredRun,
    read_manifest,
    read_results,
)
from axisrig.bench.files import write_parts
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.info import info_of
from axisrig.bench.plan.sentences import check_sentence
from axisrig.bench.plan.verdict import Verdict

_GOOD = (Verdict.PASS.word, Verdict.MARGINAL.word)

# What XML 1.0 allows; a message of an NC program or a log line may hold anything.
_ILLEGAL = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_IN_TEXT = {"&": "&amp;", "<": "&lt;", ">": "&gt;"}
_IN_VALUE = {**_IN_TEXT, '"': "&quot;", "\r": "&#13;", "\n": "&#10;", "\t": "&#09;"}
# All that is not as it is in a text, or in the value of an attribute
_NOT_IN_TEXT = re.compile(f"[&<>]|{_ILLEGAL.pattern}")
_NOT_IN_VALUE = re.compile(f'[&<>"\r\n\t]|{_ILLEGAL.pattern}')
_REPLACED = "\N{REPLACEMENT CHARACTER}"


Place = Callable[[StoredRun], Mapping[str, str]]
"""Gives file and line of the row of a plan that a run comes from, as attributes."""


def write_junit(folder: Path, runs: Sequence[StoredRun] | None = None) -> Path:
    """Write `junit.xml` of a results folder and return its path.

    runs: what the folder has, where that is known; else its other files say it.
    """
    stored = read_results(folder).runs if runs is None else runs
    path = folder / "junit.xml"
    write_parts(path, _lines(stored, _places(read_manifest(folder))))
    return path


def _places(manifest: Mapping[str, Any]) -> Place:
    """Return what gives the place of a run: the plan as the command line named it.

    A row of an included table has the name of that table.
    """
    paths = {plan["name"]: plan["path"].replace("\\", "/") for plan in manifest.get("plans", [])}

    def place(run: StoredRun) -> Mapping[str, str]:
        path = paths.get(run.case["plan"], "")
        for check in run.checks:
            name, _, line = check.reference.rpartition(":")
            if name and line.isdecimal():
                return {"file": path if path.rpartition("/")[2] == name else name, "line": line}
        return {"file": path} if path else {}

    return place


def _lines(stored: Sequence[StoredRun], place: Place) -> Iterator[str]:
    """Yield the file, an element for each line; the last one ends without an end of line."""
    yield "<?xml version='1.0' encoding='utf-8'?>\n"
    plans = dict.fromkeys(run.case["plan"] for run in stored)
    if not plans:
        yield f"<testsuites{_attributes(name='axisrig')} />"
        return
    yield f"<testsuites{_attributes(name='axisrig')}>\n"
    for plan in plans:
        own = [run for run in stored if run.case["plan"] == plan and not run.is_probe]
        yield from _suite(plan, own, place)
    yield "</testsuites>"


def _suite(plan: str, runs: Sequence[StoredRun], place: Place) -> Iterator[str]:
    planned = [run for run in runs if run.is_in_plan]
    failed = sum(run.verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE) for run in planned)
    attributes = _attributes(
        name=plan,
        tests=str(len(runs)),
        failures=str(failed),
        errors=str(sum(run.verdict >= Verdict.ABORTED for run in planned)),
        skipped=str(len(runs) - len(planned)),
        time=f"{sum(float(run.case['wall_s']) for run in runs):.3f}",
        **_timestamp(min((at for run in runs if (at := run.case.get(TIMESTAMP))), default="")),
    )
    if not runs:
        yield f" <testsuite{attributes} />\n"
        return
    yield f" <testsuite{attributes}>\n"
    for run in runs:
        yield from _case(run, place(run))
    yield " </testsuite>\n"


def _timestamp(text: str) -> dict[str, str]:
    """Return the attribute: the schema has no time zone, so it is that of UTC."""
    return {"timestamp": text.partition("+")[0]} if text else {}


def _case(run: StoredRun, place: Mapping[str, str]) -> Iterator[str]:
    attributes = _attributes(
        classname=run.case["plan"],
        name=run.run.removeprefix(f"{run.case['plan']}-"),
        time=f"{float(run.case['wall_s']):.3f}",
        **_timestamp(run.case.get(TIMESTAMP, "")),
        **place,
    )
    yield f"  <testcase{attributes}>\n   <properties>\n"
    for name in ("verdict", "seed", "requirement", "program", "rig", "sim_s", "frame_log_sha256"):
        if run.case.get(name):
            yield _property(name, run.case[name])
    for key, value in info_of(run.case).items():
        yield _property(key, value)
    for check in run.checks:
        for name in ("value", "lower", "upper", "unit", "uncertainty", "verdict"):
            yield _property(f"{check.metric}.{name}", getattr(check, name))
    yield "   </properties>\n"
    yield from _outcome(run)
    lines = run.messages + run.log
    if lines:
        yield _element("system-out", "", "\n".join(lines))
    yield "  </testcase>\n"


def _outcome(run: StoredRun) -> Iterator[str]:
    """Inconclusive counts as a failure: a CI server knows nothing between the two."""
    if not run.is_in_plan:
        yield _element("skipped", _attributes(message="no longer in the plan"), "")
        return
    if run.verdict <= Verdict.MARGINAL:
        return
    tag = "error" if run.verdict >= Verdict.ABORTED else "failure"
    lines = [run.error] if run.error else []
    lines += [_line(check) for check in run.checks if check.verdict not in _GOOD]
    word = run.verdict.word
    attributes = _attributes(type=word, message=lines[0] if lines else word)
    yield _element(tag, attributes, "\n".join(lines))


def _line(check: CheckRow) -> str:
    """Say one check in a line, in the words of the report."""
    return f"{check.verdict}: {check_sentence(check)}"


def _property(name: str, value: str) -> str:
    return f"    <property{_attributes(name=name, value=value)} />\n"


def _element(tag: str, attributes: str, text: str) -> str:
    """Return an element of a test case that has a text or nothing."""
    if not text:
        return f"   <{tag}{attributes} />\n"
    return f"   <{tag}{attributes}>{_NOT_IN_TEXT.sub(_in_text, text)}</{tag}>\n"


def _attributes(**values: str) -> str:
    named = values.items()
    return "".join(f' {name}="{_NOT_IN_VALUE.sub(_in_value, value)}"' for name, value in named)


def _in_text(found: re.Match[str]) -> str:
    return _IN_TEXT.get(found[0], _REPLACED)


def _in_value(found: re.Match[str]) -> str:
    return _IN_VALUE.get(found[0], _REPLACED)
