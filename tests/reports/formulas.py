"""A results folder of runs whose signals and findings are made of formulas."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
from tests.recordings import facts, kept

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.judge.topics import findings
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import Facts
from axisrig.reports.build import Findings


def write_runs(
    folder: Path,
    name: str,
    traces: Mapping[str, pa.Table],
    left: Mapping[str, Facts] | None = None,
) -> Path:
    """Write plan `name` below `folder`, and a results folder with a run for each trace.

    left: facts of runs that have more than the least.
    """
    (folder / "a.nc").write_text("N10 G0 Z0\n", encoding="utf-8")
    (folder / "a.toml").write_text("[machine]\n", encoding="utf-8")
    lines = [f"{case},a.nc,a.toml,none" for case in traces]
    text = "\n".join(["case,program,rig,check:alarms", *lines]) + "\n"
    (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    plan = read_plan(folder / f"{name}.csv")
    manifest = build_manifest([plan], command=["axisrig"], started="", output="out")
    with ResultsWriter(folder / "out", [plan], manifest) as writer:
        for case in plan.cases:
            checks = [judge(check, [], 0.0, "") for check in case.checks]
            series = kept(traces[case.case], writer.files_of(case.run).trace)
            of_run = (left or {}).get(case.case, facts())
            writer.add(CaseResult(case, Verdict.PASS, checks, facts=of_run, series=series))
    return folder / "out"


def made(found: Mapping[str, RunFindings]) -> Findings:
    """Make findings: those of the judge with the events, and what topics find, of a case."""

    def of_run(observed: Observed) -> RunFindings:
        assert isinstance(observed.series.source, Path)
        case = observed.series.source.stem.partition("-")[2]
        own = found[case]
        return replace(findings(observed), events=own.events, of_topics=own.of_topics)

    return of_run
