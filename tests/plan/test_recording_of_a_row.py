"""`axisrig judge`: which recording a row is judged by, and what must be that of the recording."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of
from tests.recordings import facts

from axisrig.bench.campaign import rejudge
from axisrig.bench.campaign.results.stored import PROBE, RECORDING, RUNS, StoredRun
from axisrig.bench.campaign.results.sums import TRACE_SUM
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.files import sha256_of
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult
from axisrig.bench.plan.plan import default_seed
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import VERSION, RunFile
from axisrig.kernel.errors import UserError

RIG = "[axis.Z]\n"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a program and a rig, and two others of another content."""
    for name, text in (("part.nc", "M30\n"), ("rig.toml", RIG), ("other.nc", "(x)\nM30\n"),
                       ("other.toml", RIG + "# x\n")):  # fmt: skip
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(rejudge, "file_hashes", lambda _: {"part.nc": sha256_of(Path("part.nc"))})
    return tmp_path


def hashes() -> dict[str, str]:
    return {name: sha256_of(Path(name)) for name in ("part.nc", "rig.toml")}


def run_of(run: str, plan: str = "p", **more: str) -> StoredRun:
    row = {"run": run, "plan": plan, "seed": "5", "program": "part.nc", "rig": "rig.toml", **more}
    return StoredRun(row, [], None, None)


def case(name: str = "a", **changes: Any) -> Case:
    return replace(case_of(name), **{"seed": 5, **changes})


# Which recording


@pytest.mark.parametrize(
    ("runs", "found"),
    [
        ([("p-a", "p"), ("p-b", "p")], "p-a"),
        ([("p-b", "p"), ("q-a", "q")], "q-a"),  # the same case of a plan of another name
        ([("q-a", "q"), ("p-a", "p")], "p-a"),  # its own before that of any other
        ([("q-a", "q"), ("r-a", "r"), ("p-a", "p")], "p-a"),
        ([("q-a", "q"), ("r-a", "r")], "several plans of the folder have this case: q-a, r-a"),
        ([("p-b", "p"), ("q-p-a", "q")], "has no recording of this case"),
        ([], "has no recording of this case"),
    ],
)
def test_a_row_is_judged_by_its_own_plan_or_the_only_other_one(
    runs: list[tuple[str, str]], found: str
) -> None:
    stored = [run_of(*one) for one in runs]
    if found.count(" ") == 0:
        assert rejudge._recording_of(stored, case()).run == found
        return
    with pytest.raises(UserError, match=found):
        rejudge._recording_of(stored, case())


def test_what_says_something_over_several_runs_is_no_recording() -> None:
    over = run_of("p-a", **{RUNS: "2"})
    assert rejudge._recording_of([over, run_of("q-a", "q")], case()).run == "q-a"
    with pytest.raises(UserError, match="no recording"):
        rejudge._recording_of([over], case())


# What must be the same


@pytest.mark.parametrize(
    ("recorded", "changes", "words"),
    [
        ({}, {}, ""),
        ({"title": "other", "tags": "x", "check:m": "< 1", "note:batch": "3"}, {}, ""),
        ({"plc:V.E.A": "1"}, {"inputs": {"plc:V.E.A": "1"}}, ""),
        ({"plc:V.E.A": "1", "set:Z.edge": ""}, {"inputs": {"plc:V.E.A": "1"}}, ""),
        ({"plc:V.E.A": "1"}, {"inputs": {"plc:V.E.A": "2"}},
         "plc:V.E.A is not that of the recording: 1 was run, the plan has 2"),
        ({"plant:z.kv": "1"}, {}, "plant:z.kv .*: 1 was run, the plan has no value"),
        ({}, {"inputs": {"fault:bus.at_ms": "3"}},
         "fault:bus.at_ms .*: no value was run, the plan has 3"),
        ({"plc:V.E.A": "1"}, {"inputs": {"plc:V.E.A": "1", "set:Z.edge": "NEG"}}, "set:Z.edge"),
        ({"seed": "6"}, {}, "the seed is not that of the recording: 6 was run, the plan has 5"),
        ({"seed": "5"}, {"seed": 7}, "the seed .*: 5 was run, the plan has 7"),
        ({"program": "gone.nc"}, {}, "the program .*: gone.nc was run, the plan has part.nc, o"),
        ({}, {"program": Path("other.nc")}, "the program .*: part.nc was run, the plan has other"),
        ({}, {"rig": Path("other.toml")}, "the rig .*: rig.toml was run, the plan has other"),
    ],
)  # fmt: skip
def test_a_row_that_asks_for_another_run_is_refused(
    place: Path, recorded: dict[str, str], changes: dict[str, Any], words: str
) -> None:
    """What only describes a run, and its checks, may differ."""
    one = run_of("p-a", **recorded)
    if not words:
        rejudge._check_is_same(one, case(**changes), hashes())
        return
    with pytest.raises(UserError, match=words):
        rejudge._check_is_same(one, case(**changes), hashes())


def test_a_program_may_have_another_name(place: Path) -> None:
    (place / "copy.nc").write_text("M30\n", encoding="utf-8")
    rejudge._check_is_same(run_of("p-a"), case(program=Path("copy.nc")), hashes())


def test_a_file_beside_program_and_rig_counts_too(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rejudge, "file_hashes", lambda _: {"lists/z.lst": "f" * 64})
    with pytest.raises(UserError, match=r"lists/z\.lst has other content"):
        rejudge._check_is_same(run_of("p-a"), case(), hashes())
    rejudge._check_is_same(run_of("p-a"), case(), {**hashes(), "elsewhere.lst": "f" * 64})


def test_seeds_that_follow_from_names_are_equal_whatever_these_are(place: Path) -> None:
    """Of a probe it follows from the row that searches; one that is given is another one."""
    of_other = run_of("q-a", "q", seed=str(default_seed("q-a")))
    rejudge._check_is_same(of_other, case(seed=default_seed("p-a")), hashes())
    with pytest.raises(UserError, match=r"the seed .*: none given was run, the plan has 5"):
        rejudge._check_is_same(of_other, case(), hashes())
    probe = run_of("q-a-s02", "q", seed=str(default_seed("q-a")), **{PROBE: "q-a"})
    of_probe = case("a-s02", seed=default_seed("p-a"), probe_of="p-a")
    rejudge._check_is_same(probe, of_probe, hashes())
    with pytest.raises(UserError, match="the seed"):
        rejudge._check_is_same(probe, replace(of_probe, seed=default_seed("p-a-s02")), hashes())


# What comes of it


def with_recording(run: StoredRun, recording: RunFile) -> StoredRun:
    run.__dict__["recording"] = recording  # as the cache of the property has it
    return run


def left(**entries: Any) -> RunFile:
    return RunFile(version=VERSION, log=("line",), **entries)


@pytest.mark.parametrize(
    ("recording", "reason"),
    [
        (left(error="it broke"), "it broke"),
        (left(), "its time series are missing"),
        (left(facts=facts(unfinished="a plant stood still"), error="other"),
         "a plant stood still"),
        (left(facts=facts()), "its time series are missing"),
    ],
)  # fmt: skip
def test_a_run_that_left_nothing_to_judge_is_an_error_with_its_reason(
    recording: RunFile, reason: str
) -> None:
    """Of one that was broken off its facts stay, and what was printed until then."""
    result = rejudge._judge(with_recording(run_of("p-a"), recording), case())
    assert (result.verdict, result.error, result.log) == (Verdict.ERROR, reason, ["line"])
    is_unfinished = recording.facts is not None and bool(recording.facts.unfinished)
    assert (result.facts is not None) == is_unfinished


def test_a_judged_run_names_its_recording_with_the_sums_of_its_files(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What cannot be judged names none: it is one that no row has used."""
    whole = with_recording(run_of("q-a", "q", **{TRACE_SUM: "a" * 64}), RunFile(version=VERSION))
    stored: Any = SimpleNamespace(runs=[whole], manifest={"files": hashes()})
    result = rejudge._judged_run(stored, case())
    assert (result.recording, result.sums[TRACE_SUM]) == ("q-a", "a" * 64)
    other = rejudge._judged_run(stored, case("b"))
    assert (other.recording, other.verdict) == ("", Verdict.ERROR)
    assert other.error == "not run: the folder has no recording of this case"
    whole.__dict__["altered"] = ["traces/q-a.parquet"]
    altered = rejudge._judged_run(stored, case())
    assert (altered.recording, altered.error) == (
        "", "not run: not as the run has written it: traces/q-a.parquet",
    )  # fmt: skip


def test_a_run_that_is_judged_again_has_the_metrics_of_the_module_of_its_case(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Those of its own checks, and those that statistics over its runs ask for."""
    asked: list[Any] = []
    monkeypatch.setattr(rejudge, "Series", lambda path: f"series of {path}")
    monkeypatch.setattr(rejudge, "Observed", lambda *what: what)
    monkeypatch.setattr(
        rejudge, "judged", lambda *what, module: asked.append(module) or (Verdict.PASS, [])
    )
    monkeypatch.setattr(rejudge, "sampled", lambda *what, module: {"of": (*what, module)})
    run: Any = SimpleNamespace(judged_facts=facts(), trace="t.parquet")
    own: Any = replace(case(), module="own", sampled=("mean(width)",))  # type: ignore[arg-type]
    result = rejudge._judge(run, own)
    observed = (run.judged_facts, "series of t.parquet")
    assert asked == ["own"]
    assert result.samples == {"of": (observed, ("mean(width)",), "own")}


def test_a_judged_row_finds_the_files_of_the_run_that_was_recorded() -> None:
    assert run_of("p-a", **{RECORDING: "q-a"}).recorded == "q-a"
    assert run_of("p-a", **{RECORDING: ""}).recorded == run_of("p-a").recorded == "p-a"


@pytest.mark.parametrize(
    ("taken", "name"),
    [((), "1-p"), (("1-p", "2-q"), "3-p"), (("9-p", "10-p"), "11-p"), (("4-p", "x-p"), "5-p")],
)
def test_verdicts_get_the_next_number(tmp_path: Path, taken: tuple[str, ...], name: str) -> None:
    for one in taken:
        (tmp_path / "judged" / one).mkdir(parents=True)
    plan: Any = SimpleNamespace(name="p")
    assert rejudge._new_folder(tmp_path, plan) == tmp_path / "judged" / name


@pytest.mark.parametrize(("is_stopped", "error"), [(True, "broke"), (True, None), (False, "broke")])
def test_a_run_that_the_operator_stopped_is_named_so_before_anything_else(
    is_stopped: bool, error: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In its result and in what was stored of it; without facts its error is all that is left."""
    left = facts(is_stopped=is_stopped)
    result = CaseResult(case_of("a"), Verdict.ABORTED, [], facts=left, error=error)
    words = STOPPED if is_stopped else error
    assert result.said.error == words
    stored = StoredRun({"run": "p-a"}, [], None, None)
    monkeypatch.setitem(vars(stored), "recording", RunFile(VERSION, facts=left, error=error or ""))
    assert stored.error == words
    bare = CaseResult(case_of("a"), Verdict.ERROR, [], error=error, log=["a line"])
    assert (bare.said.error, list(bare.said.log)) == (error, ["a line"])


def test_recordings_that_no_row_judges_are_named_and_what_is_none_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a case, a search with its probes, and statistics over two runs: one run is left."""
    runs = [run_of(name) for name in ("p-a", "p-s01", "p-s02", "p-left")]
    runs += [run_of("p-mean", **{RUNS: "2"})]
    for run in runs:
        vars(run)["recording"] = RunFile(VERSION)
    stored = SimpleNamespace(runs=runs, manifest={})
    judged = [CaseResult(case("a"), Verdict.FAIL, [], recording="p-a")]
    judged += [CaseResult(case("s"), Verdict.PASS, [], probes=tuple(
        CaseResult(case(f"s-s0{n}"), Verdict.PASS, [], recording=f"p-s0{n}") for n in (1, 2)
    ))]  # fmt: skip
    into, written = tmp_path / "judged" / "1-p", list[Any]()
    plan: Any = SimpleNamespace(cases=(case("a"),), with_inputs=lambda *_: plan)
    plan.with_cases = lambda change: plan

    class Writer:
        """Makes the folders of runs, as the real one does."""

        def __init__(self, folder: Path, plans: Any, manifest: Any, *_: Any, **given: Any) -> None:
            assert given == {"is_judged_again": True}
            assert manifest == {"made": 1, "recordings": "../..", "recorded_in": str(tmp_path)}
            for name in rejudge.FOLDERS:
                (folder / name).mkdir(parents=True)

        def __enter__(self) -> Any:
            return SimpleNamespace(add=written.append)

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr(rejudge, "read_results", lambda _: stored)
    monkeypatch.setattr(rejudge, "read_plan", lambda _: plan)
    monkeypatch.setattr(rejudge, "selected", lambda found, _: found)
    monkeypatch.setattr(rejudge, "build_manifest", lambda *_, **__: {"made": 1})
    monkeypatch.setattr(rejudge, "_new_folder", lambda *_: into)
    monkeypatch.setattr(rejudge, "_judged", lambda *_: iter(judged))
    monkeypatch.setattr(rejudge, "ResultsWriter", Writer)
    found = rejudge.rejudge(
        tmp_path, Path("p.csv"), assignments=(), command=(), started="", build_report=lambda of: of
    )
    assert (list(found.results), written) == (judged, judged)
    assert list(found.left) == ["p-left"]
    assert (found.folder, found.report, found.exit_code) == (into, into, 1)
    assert list(into.iterdir()) == []  # the recordings are in the folder above


@pytest.mark.parametrize("is_stopped", [True, False])
@pytest.mark.parametrize(("expected", "verdict"), [((), Verdict.FAIL), (("m",), Verdict.PASS)])
def test_a_recording_is_judged_by_what_is_expected_and_names_a_stop(
    monkeypatch: pytest.MonkeyPatch, expected: tuple[str, ...], verdict: Verdict, is_stopped: bool
) -> None:
    """A check that has to fail and does is what the row asks for."""
    check: Any = SimpleNamespace(metric="m")
    failed = CheckResult(check, 2.0, 0.0, Verdict.FAIL, "")
    monkeypatch.setattr(rejudge, "Series", lambda _: None)
    monkeypatch.setattr(rejudge, "Observed", lambda *_: None)
    monkeypatch.setattr(rejudge, "judged", lambda *_, **__: (Verdict.FAIL, [failed]))
    monkeypatch.setattr(rejudge, "sampled", lambda *_, **__: {})
    run = replace(run_of("p-a"), trace=Path("a.parquet"))
    recording = left(facts=facts(is_stopped=is_stopped))
    result = rejudge._judge(with_recording(run, recording), case(expected=expected))
    assert result.error == (STOPPED if is_stopped else None)
    assert result.verdict is verdict
