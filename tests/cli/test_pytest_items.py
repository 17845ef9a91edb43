"""Rows as pytest items, in this process: what a row hands over to the results folder."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from axisrig.bench.campaign.pytest_plugin import Outcome
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.cli.pytest_results import Staging
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

PLANS = Path(__file__).parents[2] / "testplans"


def test_a_row_that_pytest_runs_is_kept_by_what_it_depends_on(tmp_path: Path) -> None:
    """The hash that `axisrig run` writes, and the files of its probes; nothing stays behind."""
    case = read_plan(PLANS / "latch_accuracy.csv").cases[0]
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    files = staging.files_of(case.run)
    assert files.trace is not None
    (log,) = files.bus_logs
    files.trace.write_bytes(b"trace")
    log.write_bytes(b"log")
    row: Any = SimpleNamespace(path=tmp_path / "p.csv")
    outcome = Outcome.unpacked(staging._packed(row, CaseResult(case, Verdict.PASS, [])))
    assert outcome.result.depends_sha256 == depends_sha256(case) != ""
    assert outcome.files == {f"{case.run}.parquet": b"trace", f"{case.run}.blf": b"log"}
    assert not files.trace.exists()
    assert not log.exists()
    staging.pytest_unconfigure()
    assert not log.parent.exists()
