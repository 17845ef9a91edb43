"""Results come as runs end; a campaign lists them in the order of its plans."""

import random
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import pytest

from axisrig.bench.campaign import campaign
from axisrig.bench.campaign.campaign import _place
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, no_values
from axisrig.bench.campaign.resuming import longest_first
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

TESTPLANS = Path(__file__).parents[2] / "testplans"


def test_results_are_listed_in_plan_order_each_statistic_after_its_runs() -> None:
    plan = read_plan(TESTPLANS / "statistics.csv")
    assert plan.statistics
    expected, left = [], {row.run: Counter(row.runs) for row in plan.statistics}
    for case in plan.cases:  # as one process gives them
        expected.append(case.run)
        for row in plan.statistics:
            left[row.run] -= Counter([case.run])
            if case.run in row.runs and not left[row.run]:
                expected.append(row.run)
    rows = [*plan.cases, *plan.statistics]
    results = [no_values(row, Verdict.ERROR, "not run") for row in rows]
    random.Random(1).shuffle(results)
    results.sort(key=partial(_place, {case.run: at for at, case in enumerate(plan.cases)}))
    assert [result.case.run for result in results] == expected


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_campaign_lists_its_results_in_plan_order_however_they_ended(
    jobs: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[machine]\n", encoding="utf-8")
    plan = tmp_path / "p.csv"
    rows = "".join(f"{name},a.nc,r.toml\n" for name in "cabd")
    plan.write_text(f"case,program,rig\n{rows}", encoding="utf-8")

    def running(cases: Sequence[Case], *_: object) -> Iterator[CaseResult]:
        yield from (no_values(case, Verdict.ERROR, "not run") for case in reversed(cases))

    monkeypatch.setattr(campaign, "_prepared", lambda *_: ((), []))
    monkeypatch.setattr(campaign, "_running", running)
    monkeypatch.setattr(campaign, "depends_sha256", lambda case: case.run)
    monkeypatch.setattr(campaign, "real_cases", lambda _: [])
    made = campaign.run_campaign(
        [plan], out=tmp_path / "out", select=campaign.Choice(), jobs=jobs, timeout_s=None,
        assignments=[], command=[], started="", stopwatch=lambda: 0.0,
    )  # fmt: skip
    assert [result.case.case for result in made.results] == list("cabd")


def test_runs_that_took_longest_are_handed_out_first_after_those_nobody_knows(
    tmp_path: Path,
) -> None:
    plan = read_plan(TESTPLANS / "latch_accuracy.csv")
    cases, folder = plan.cases[:5], tmp_path / "out"
    assert longest_first(cases, folder) == list(cases)
    manifest = build_manifest([plan], command=[], started="", output="")
    with ResultsWriter(folder, [plan], manifest) as writer:
        for case, wall_s in zip(cases, (0.3, 0.1, 0.2), strict=False):
            writer.add(no_values(case, Verdict.ERROR, "not run", wall_s=wall_s))
    assert longest_first(cases, folder) == [cases[place] for place in (3, 4, 0, 2, 1)]
    (folder / "cases.csv").write_text("moon\n")
    assert longest_first(cases, folder) == list(cases)
