"""`axisrig replay`: the case and inputs of a recorded run, and the comparison of its frames."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import replay
from axisrig.bench.plan.case import Case
from axisrig.kernel.errors import UserError


def stored_run(run: str, **case: str) -> Any:
    row = {"run": run, "plan": "p", "frame_log_sha256": "ab", **case}
    return SimpleNamespace(run=run, case=row, altered_words=f"of {run}")


def test_a_recorded_case_comes_with_the_inputs_of_its_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "p.csv"
    path.touch()
    runs = [
        stored_run("p-a", **{"plc:V.E.A": "7", "plc:V.E.B": "", "check:m": "< 1", "title": "t"}),
        stored_run("p-s-s02", probe="p-s"),
        stored_run("p-x", runs="p-x-1 p-x-2"),
        stored_run("p-x-1"),
        stored_run("q-b", plan="q"),
        stored_run("p-gone"),
    ]
    listed = {"plans": [{"name": "p", "path": str(path)}, {"name": "q", "path": "/none/q.csv"}]}
    stored = SimpleNamespace(runs=runs, manifest=listed)
    search = SimpleNamespace(checks=("asked",))
    cases = (case_of("a", inputs={"plc:V.E.A": "1"}), case_of("s", search=search))
    monkeypatch.setattr(replay, "read_results", lambda _: stored)
    monkeypatch.setattr(replay, "own_plan", lambda _folder, name: Path(name))
    monkeypatch.setattr(replay, "read_plan", lambda _: SimpleNamespace(cases=cases))
    case, row = replay.recorded_case(tmp_path, "p-a")
    assert (case.run, dict(case.inputs), row["title"]) == ("p-a", {"plc:V.E.A": "7"}, "t")
    probe, _ = replay.recorded_case(tmp_path, "p-s-s02")
    assert (probe.run, probe.checks, probe.search) == ("p-s-s02", ("asked",), None)
    assert replay.altered_words(tmp_path, "p-x-1") == "of p-x-1"
    for run, message in (
        ("p-b", "the folder has no such run"),
        ("p-x", "says something over several runs"),
        ("q-b", "the plan of this run is not there any more"),
        ("p-gone", "the plan has no such run any more"),
    ):
        with pytest.raises(UserError, match=message):
            replay.recorded_case(tmp_path, run)
    # What was a probe is none of a row that does not search any more, and the other way round
    runs.append(stored_run("p-a-s01", probe="p-a"))
    runs.append(stored_run("p-s"))
    for run in ("p-a-s01", "p-s"):
        with pytest.raises(UserError, match="the plan has no such run any more"):
            replay.recorded_case(tmp_path, run)


def test_a_probe_is_replayed_by_its_own_checks_and_expects_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is expected to fail is a value that the search finds, none of a probe."""
    (tmp_path / "p.csv").touch()
    runs = [stored_run("p-s", runs="2"), stored_run("p-s-s01", probe="p-s"), stored_run("p-a")]
    listed = {"plans": [{"name": "p", "path": str(tmp_path / "p.csv")}]}
    monkeypatch.setattr(
        replay, "read_results", lambda _: SimpleNamespace(runs=runs, manifest=listed)
    )
    search = SimpleNamespace(checks=("asked",))
    cases = (case_of("s", search=search, expected=("search_good",)),
             case_of("a", expected=("lag_mm_max",)))  # fmt: skip
    monkeypatch.setattr(replay, "read_plan", lambda _: SimpleNamespace(cases=cases))
    probe, _ = replay.recorded_case(tmp_path / "out", "p-s-s01")
    assert (probe.checks, probe.expected) == (("asked",), ())
    plain, _ = replay.recorded_case(tmp_path / "out", "p-a")
    assert plain.expected == ("lag_mm_max",)


HEAD = "case,program,rig"


@pytest.mark.parametrize(
    ("columns", "cells", "inputs"),
    [
        (",plc:V.E.A", ",1", {"plc:V.E.A": "7", "set:Z.edge": "NEG"}),
        # The plan has got a column since, has lost one, or has one that was empty then
        (",plc:V.E.A,plc:V.E.NEW", ",1,5", {"plc:V.E.A": "7", "set:Z.edge": "NEG"}),
        ("", "", {"plc:V.E.A": "7", "set:Z.edge": "NEG"}),
        (
            ",plc:V.E.EMPTY,fault:drop",
            ",5,Z.TPDO2 at=motion",
            {"plc:V.E.A": "7", "set:Z.edge": "NEG"},
        ),
    ],
)
def test_a_run_is_replayed_with_the_inputs_it_had_and_no_other(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    columns: str,
    cells: str,
    inputs: dict[str, str],
) -> None:
    """Whatever is in the plan by now; what is no input of the row stays that of the plan."""
    for name in ("part.nc", "r.toml"):
        (tmp_path / name).touch()
    (tmp_path / "p.csv").write_text(
        f"{HEAD},title{columns}\na,part.nc,r.toml,now{cells}\n", encoding="utf-8"
    )
    then = stored_run(
        "p-a",
        **{"plc:V.E.A": "7", "set:Z.edge": "NEG", "plc:V.E.EMPTY": "", "title": "then",
           "check:lag_mm_max:Z": "<= 1", "value:lag_mm_max:Z": "0.5", "info:serial": "3"},
    )  # fmt: skip
    listed = {"plans": [{"name": "p", "path": str(tmp_path / "p.csv")}]}
    stored = SimpleNamespace(runs=[then], manifest=listed)
    monkeypatch.setattr(replay, "read_results", lambda _: stored)
    case, row = replay.recorded_case(tmp_path / "out", "p-a")
    assert dict(case.inputs) == inputs
    assert (case.title, row["title"]) == ("now", "then")


@pytest.mark.parametrize("kind", ["set", "plant", "drive", "bus", "distance", "plc", "fault"])
def test_each_kind_of_input_is_that_of_the_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    (tmp_path / "p.csv").touch()
    listed = {"plans": [{"name": "p", "path": str(tmp_path / "p.csv")}]}
    stored = SimpleNamespace(runs=[stored_run("p-a", **{f"{kind}:x": "7"})], manifest=listed)
    monkeypatch.setattr(replay, "read_results", lambda _: stored)
    plan = SimpleNamespace(cases=(case_of("a", inputs={f"{kind}:x": "1", f"{kind}:y": "2"}),))
    monkeypatch.setattr(replay, "read_plan", lambda _: plan)
    case, _ = replay.recorded_case(tmp_path / "out", "p-a")
    assert dict(case.inputs) == {f"{kind}:x": "7"}


@pytest.mark.parametrize(
    ("recorded", "seed"), [({"seed": "7"}, 7), ({"seed": "0"}, 0), ({"seed": ""}, 1), ({}, 1)]
)
@pytest.mark.parametrize("probe", ["", "p-a"])
def test_the_seed_is_that_of_the_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recorded: dict[str, str], seed: int, probe: str
) -> None:
    """The frames follow from it; the cell of the plan may be another one by now."""
    (tmp_path / "p.csv").touch()
    run = "p-a-s01" if probe else "p-a"
    listed = {"plans": [{"name": "p", "path": str(tmp_path / "p.csv")}]}
    then = stored_run(run, probe=probe, **recorded)
    monkeypatch.setattr(
        replay, "read_results", lambda _: SimpleNamespace(runs=[then], manifest=listed)
    )
    search = SimpleNamespace(checks=("asked",)) if probe else None
    plan = SimpleNamespace(cases=(case_of("a", seed=1, search=search),))
    monkeypatch.setattr(replay, "read_plan", lambda _: plan)
    case, _ = replay.recorded_case(tmp_path / "out", run)
    assert (case.run, case.seed) == (run, seed)


def test_a_replay_is_the_same_by_its_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def run(case: Case, files: Any) -> Any:
        asked.append((case.run, files.bus_logs))
        return SimpleNamespace(frame_log_sha256="ab")

    monkeypatch.setattr(replay, "run_case", run)
    for sha, is_same in (("ab", True), ("cd", False)):
        found = replay.replay(case_of("a"), {"frame_log_sha256": sha}, [Path("x.blf")])
        assert found.is_same is is_same
    assert asked == [("p-a", [Path("x.blf")])] * 2


@pytest.mark.parametrize(
    ("run", "others", "allowed"),
    [
        ("p-t1", ["p-t1-001", "p-t1-002", "p-t10", "p-t10-001"], ["p-t1-001", "p-t1-002"]),
        ("p-t1", ["p-t1-a-001", "q-p-t1-001", "p-t1_x"], ["p-t1-a-001"]),
        ("p-s", ["p-s-s01", "p-s-s02", "p-sweep-s01"], ["p-s-s01", "p-s-s02"]),
    ],
)
def test_a_row_over_several_runs_names_these_and_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run: str, others: list[str],
    allowed: list[str],
) -> None:  # fmt: skip
    runs = [stored_run(run, runs="2"), *map(stored_run, others)]
    monkeypatch.setattr(replay, "read_results", lambda _: SimpleNamespace(runs=runs))
    with pytest.raises(UserError, match="this row says something over several runs") as caught:
        replay.recorded_case(tmp_path, run)
    assert (caught.value.file, caught.value.value) == (str(tmp_path), run)
    assert caught.value.allowed == ", ".join(allowed)
    assert caught.value.hint == "replay one of its runs"


@pytest.mark.parametrize(("run", "near"), [("p-edge", "p-edges"), ("zzzzzzzz", "p-edges, p-lag")])
def test_a_run_that_is_not_there_names_what_is_near_or_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run: str, near: str
) -> None:
    runs = [stored_run("p-edges"), stored_run("p-lag")]
    monkeypatch.setattr(replay, "read_results", lambda _: SimpleNamespace(runs=runs))
    with pytest.raises(UserError, match="the folder has no such run") as caught:
        replay.recorded_case(tmp_path, run)
    assert near in str(caught.value)
    assert ("p-lag" in str(caught.value)) is (near != "p-edges")


def test_what_was_changed_of_a_run_is_that_of_this_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = [stored_run("p-a"), stored_run("p-b"), stored_run("p-c")]
    monkeypatch.setattr(replay, "read_results", lambda _: SimpleNamespace(runs=runs))
    assert [replay.altered_words(tmp_path, run) for run in ("p-c", "p-b", "p-a")] == [
        "of p-c", "of p-b", "of p-a",
    ]  # fmt: skip


@pytest.mark.parametrize("has_plan", [True, False])
def test_a_plan_that_has_gone_is_named_or_the_manifest_that_has_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_plan: bool
) -> None:
    listed = {"plans": [{"name": "p", "path": str(tmp_path / "gone.csv")}]} if has_plan else {}
    stored = SimpleNamespace(runs=[stored_run("p-a")], manifest=listed)
    monkeypatch.setattr(replay, "read_results", lambda _: stored)
    monkeypatch.setattr(replay, "own_plan", lambda _folder, name: Path(name))
    with pytest.raises(UserError, match="the plan of this run is not there any more") as caught:
        replay.recorded_case(tmp_path, "p-a")
    assert caught.value.file == str(tmp_path / ("gone.csv" if has_plan else "manifest.json"))
