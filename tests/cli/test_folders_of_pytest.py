"""`pytest --axisrig-out`: of which rows a folder is opened, and when each of them began."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.pytest_plugin import Outcome
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.cli import pytest_results
from axisrig.bench.cli.pytest_results import ResultsOfPytest, Staging
from axisrig.bench.plan.verdict import Verdict

Opened = list[dict[str, Any]]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Opened:
    """Folders that were opened: their plans and runs."""
    found: Opened = []

    def writer(folder: Path, plans: Sequence[Any], manifest: Any, *, runs: list[str]) -> str:
        found.append({"folder": folder, "plans": plans, "manifest": manifest, "runs": runs})
        return "a writer"

    monkeypatch.setattr(pytest_results, "read_plan", lambda path: f"plan {path.as_posix()}")
    monkeypatch.setattr(pytest_results, "with_tested", lambda plan: plan)
    monkeypatch.setattr(pytest_results, "_chosen", lambda plans, runs: [*plans, runs])
    monkeypatch.setattr(pytest_results, "build_manifest", lambda chosen, **_: chosen)
    monkeypatch.setattr(pytest_results, "ResultsWriter", writer)
    return found


@pytest.mark.parametrize("suffix", [".csv", ".CSV", ".xlsx", ".Ods", ".PARQUET"])
def test_a_folder_is_of_the_rows_of_plans_whatever_their_suffix_is_written_like(
    suffix: str, opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Plans are named from the present folder on, as on a command line; other items are none."""
    monkeypatch.chdir(tmp_path)
    root = tmp_path / "sub"
    of = ResultsOfPytest(SimpleNamespace(rootpath=root), Path("out"))  # type: ignore[arg-type]
    ids = [
        f"p{suffix}::p-a",
        "test_x.py::test_y",
        f"p{suffix}::p-b",
        f"q{suffix}::q-c",
        "notes.csv",
    ]
    of.pytest_xdist_node_collection_finished(ids)
    (found,) = opened
    plans = [f"plan sub/{name}{suffix}" for name in "pq"]
    assert (found["folder"], found["plans"]) == (Path("out"), plans)
    assert found["runs"] == ["p-a", "p-b", "q-c"]
    assert found["manifest"][2] == {
        Path(f"sub/p{suffix}"): ["p-a", "p-b"], Path(f"sub/q{suffix}"): ["q-c"],
    }  # fmt: skip
    of.pytest_xdist_node_collection_finished([f"r{suffix}::r-d"])  # another worker
    assert len(opened) == 1


def test_plans_of_another_place_keep_their_whole_path(
    opened: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    of = ResultsOfPytest(SimpleNamespace(rootpath=tmp_path), Path("out"))  # type: ignore[arg-type]
    of.pytest_xdist_node_collection_finished(["p.csv::p-a"])
    assert opened[0]["plans"] == [f"plan {(tmp_path / 'p.csv').as_posix()}"]


def test_without_a_row_of_a_plan_no_folder_is_opened(opened: Opened, tmp_path: Path) -> None:
    of = ResultsOfPytest(SimpleNamespace(rootpath=tmp_path), Path("out"))  # type: ignore[arg-type]
    of.pytest_xdist_node_collection_finished(["test_x.py::test_y", "p.csv"])
    assert opened == []


def test_a_row_began_as_long_ago_as_it_took(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pytest_results, "depends_sha256", lambda _: "")
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    row: Any = SimpleNamespace(path=Path("p.csv"))
    result = replace(CaseResult(case_of("a"), Verdict.PASS, []), wall_s=3600.0)
    stamp = Outcome.unpacked(staging._packed(row, result)).result.timestamp
    staging.pytest_unconfigure()
    ago = datetime.now(UTC) - datetime.fromisoformat(stamp)
    assert timedelta(minutes=59) < ago < timedelta(minutes=61)
