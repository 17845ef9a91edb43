"""The results as JUnit XML, the form that CI servers read.

The schema is xunit1, for its test cases may carry properties: value, lower, upper, unit and
verdict of each check, the seed, the requirement and the simulated time `sim_s`. `time` is wall
time: it alone differs between two equal campaigns.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

from axisrig.bench.campaign.results.stored import NOTE, StoredRun, read_results
from axisrig.bench.files import write_whole
from axisrig.bench.plan.verdict import Verdict

_GOOD = (Verdict.PASS.word, Verdict.MARGINAL.word)

# What XML 1.0 allows; a message of an NC program or a log line may hold anything.
_ILLEGAL = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_junit(folder: Path, runs: Sequence[StoredRun] | None = None) -> Path:
    """Write `junit.xml` of a results folder and return its path.

    runs: what the folder has, where that is known; else its other files say it.
    """
    stored = read_results(folder).runs if runs is None else runs
    root = ElementTree.Element("testsuites", name="axisrig")
    for plan in dict.fromkeys(run.case["plan"] for run in stored):
        runs = [run for run in stored if run.case["plan"] == plan and not run.is_probe]
        _add_suite(root, plan, runs)
    ElementTree.indent(root, " ")
    path = folder / "junit.xml"
    text = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True).decode()
    write_whole(path, text)
    return path


def _add_suite(root: ElementTree.Element, plan: str, runs: list[StoredRun]) -> None:
    planned = [run for run in runs if run.is_in_plan]
    failed = sum(run.verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE) for run in planned)
    suite = ElementTree.SubElement(
        root,
        "testsuite",
        name=plan,
        tests=str(len(runs)),
        failures=str(failed),
        errors=str(sum(run.verdict >= Verdict.ABORTED for run in planned)),
        skipped=str(len(runs) - len(planned)),
        time=f"{sum(float(run.case['wall_s']) for run in runs):.3f}",
    )
    for run in runs:
        _add_case(suite, run)


def _add_case(suite: ElementTree.Element, run: StoredRun) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        classname=run.case["plan"],
        name=run.run.removeprefix(f"{run.case['plan']}-"),
        time=f"{float(run.case['wall_s']):.3f}",
    )
    properties = ElementTree.SubElement(case, "properties")
    for name in ("verdict", "seed", "requirement", "program", "rig", "sim_s", "frame_log_sha256"):
        if run.case.get(name):
            _add_property(properties, name, run.case[name])
    for check in run.checks:
        for name in ("value", "lower", "upper", "unit", "uncertainty", "verdict"):
            _add_property(properties, f"{check['metric']}.{name}", check[name])
    _add_outcome(case, run)
    lines = run.messages + run.log
    if lines:
        ElementTree.SubElement(case, "system-out").text = _legal("\n".join(lines))


def _add_outcome(case: ElementTree.Element, run: StoredRun) -> None:
    """Inconclusive counts as a failure: a CI server knows nothing between the two."""
    if not run.is_in_plan:
        ElementTree.SubElement(case, "skipped", message="no longer in the plan")
        return
    if run.verdict <= Verdict.MARGINAL:
        return
    tag = "error" if run.verdict >= Verdict.ABORTED else "failure"
    lines = [run.error] if run.error else []
    lines += [_line(check) for check in run.checks if check["verdict"] not in _GOOD]
    outcome = ElementTree.SubElement(
        case, tag, type=run.verdict.word, message=_legal(lines[0] if lines else run.verdict.word)
    )
    outcome.text = _legal("\n".join(lines))


def _line(check: Mapping[str, str]) -> str:
    """Say one check in a line: metric, value, condition, verdict, note."""
    value = f"{check['value'] or 'no value'} {check['unit']}".strip()
    note = check.get(NOTE, "")
    text = f"{check['verdict']}: {check['metric']} is {value}, asked for {check['check']}"
    return f"{text} ({note})" if note else text


def _add_property(properties: ElementTree.Element, name: str, value: str) -> None:
    ElementTree.SubElement(properties, "property", name=name, value=_legal(value))


def _legal(text: str) -> str:
    return _ILLEGAL.sub("\N{REPLACEMENT CHARACTER}", text)
