"""A topic of its own, in a folder of its own: metric, mark and section without a change elsewhere.

`lag` is what somebody adds who wants one more function judged: the folder here, and a line in
either table.
"""

import ast
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from tests.exercise.lag import section, signals, words
from tests.exercise.lag.findings import LagFindings, lag_events, lag_findings
from tests.exercise.lag.metrics import LAG_METRICS, LAG_PEAK
from tests.recordings import MS, facts, kept
from tests.reports.pages import opened, whole

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.topics import TOPICS, events, findings, judged, observe
from axisrig.bench.plan.checks import Check, parse_condition
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord
from axisrig.reports.build import build_report
from axisrig.reports.parts.topic import ReportTopic
from axisrig.reports.topics import TOPICS as PAGE_TOPICS

ROWS, PEAK_ROW, PEAK_MM = 101, 30, 0.25
MINE = Topic("lag", LAG_METRICS, lag_events, lag_findings)
MINE_SHOWN = ReportTopic(
    "lag", "tests.exercise.lag", section.sections, signals.with_signals, signals.plots, words.LEGEND
)
ALL, ALL_SHOWN = (*TOPICS, MINE), (*PAGE_TOPICS, MINE_SHOWN)


def check(cell: str) -> Check:
    """A check of the new metric; it would come from a row in the table of metrics."""
    return Check("lag_peak_mm:Z", parse_condition(cell), "exercise", "Z", defined=LAG_PEAK)


def recorded(path: Path | None = None) -> Observed:
    """Z runs at 10 mm/s and lags by a triangle with its top at row 30: 0.25 mm, X by nothing."""
    row = np.arange(ROWS)
    lead = 0.01 * row
    lag = PEAK_MM * np.clip(1.0 - np.abs(row - PEAK_ROW) / PEAK_ROW, 0.0, None)
    columns = {
        "time_ns": row.astype(np.int64) * MS,
        "X.set_mm": 0.0 * row,
        "X.actual_mm": 0.0 * row,
        "Z.set_mm": lead,
        "Z.actual_mm": lead - lag,
    }
    axes = {name: AxisRecord("can1", node, 10_000.0) for node, name in enumerate("XZ", start=1)}
    left = facts(axes=axes, sim_ns=ROWS * MS, end_ns=(ROWS - 1) * MS)
    return Observed(left, kept(pa.table(columns), path))


def test_its_metric_is_judged_beside_the_others() -> None:
    seen = observe(recorded(), check("<= 0.3"), ALL)
    assert seen.value == pytest.approx(PEAK_MM)
    for cell, expected in (("<= 0.3", Verdict.PASS), ("<= 0.2", Verdict.FAIL)):
        verdict, (result,) = judged(recorded(), [check(cell)], ALL)
        assert (verdict, result.verdict, result.check.unit) == (expected, expected, "mm")
        assert result.note == "a cycle of 1 ms"


def test_its_marks_and_its_block_come_with_the_others() -> None:
    marks = {mark.label: mark.time_ns for mark in events(recorded(), ALL)}
    assert marks["Z: largest lag"] == PEAK_ROW * MS
    found = findings(recorded(), ALL)
    lags = found.of(LagFindings)
    assert [lag.axis for lag in lags] == ["X", "Z"]
    assert lags[1].mm == pytest.approx(PEAK_MM)
    assert list(found.of_topics) == lags


def written(folder: Path) -> Path:
    """A results folder of one run with a check of the new metric."""
    (folder / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (folder / "a.toml").write_text("[machine]\n", encoding="utf-8")
    (folder / "plan.csv").write_text("case,program,rig\na,a.nc,a.toml\n", encoding="utf-8")
    plan = read_plan(folder / "plan.csv")
    (case,) = (replace(case, checks=(check("<= 0.3"),)) for case in plan.cases)
    plan = replace(plan, cases=(case,))
    manifest = build_manifest([plan], command=["axisrig"], started="", output="out")
    with ResultsWriter(folder / "out", [plan], manifest) as writer:
        observed = recorded(writer.files_of(case.run).trace)
        verdict, checks = judged(observed, case.checks, ALL)
        series = observed.series
        writer.add(CaseResult(case, verdict, checks, facts=observed.facts, series=series))
    return folder / "out"


@pytest.mark.long
def test_its_section_is_on_the_page(tmp_path: Path) -> None:
    """Read back from what was stored; without its lines the page has nothing of it."""
    out = written(tmp_path)
    mine = partial(findings, topics=ALL)
    path = build_report(out, findings=mine, topics=ALL_SHOWN)
    page = whole(path)
    assert "Z lags most at 30 ms: 0.25 mm" in page
    assert "Z: largest lag" in page
    assert "lag_peak_mm:Z" in page
    assert words.LEGEND in page
    (run,) = opened(path).values()
    chart = run.chart
    assert "lag_um" in [plot["plot"] for plot in chart["plots"]]
    assert [limit["value"] for limit in chart["limits"]] == pytest.approx([0.0, 1000.0 * PEAK_MM])
    assert chart["windows"][1] == {
        "label": "lag of Z", "start_ns": (PEAK_ROW - 5) * MS, "end_ns": (PEAK_ROW + 5) * MS
    }  # fmt: skip
    without = whole(build_report(out))
    assert "lags most" not in without
    assert "lag_peak_mm:Z" in without  # its check is a row of the results


def test_it_knows_no_other_topic() -> None:
    """So a change of one is none of the other."""
    others = [*(topic.name for topic in TOPICS), *(topic.name for topic in PAGE_TOPICS)]
    for path in (Path(__file__).parent / "lag").glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        froms = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        for name in froms:
            assert not set(name.split(".")) & set(others), (path.name, name)
