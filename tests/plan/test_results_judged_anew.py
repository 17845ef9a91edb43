"""Verdicts made anew: each run has its own checks, and the files of the recording it judges."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    RECORDED_IN,
    RECORDING,
    RECORDINGS,
    RESULT_COLUMNS,
    read_results,
)
from axisrig.bench.campaign.results.sums import RECORDING_SUM, TRACE_SUM
from axisrig.kernel.errors import UserError


def table(path: Path, columns: tuple[str, ...], rows: list[Mapping[str, str]]) -> None:
    lines = [",".join(columns), *(",".join(row.get(name, "") for name in columns) for row in rows)]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")


def folder(
    place: Path, runs: Mapping[str, str], sums: Mapping[str, str] | None = None, **manifest: Any
) -> Path:
    """Results of runs, each with the recording that it judges, and two checks named after it."""
    place.mkdir(parents=True)
    own = {"verdict": "pass", "sim_s": "1", "wall_s": "1"}
    cases = [{**own, "run": run, RECORDING: of, **(sums or {})} for run, of in runs.items()]
    table(place / "cases.csv", (*CASE_COLUMNS, RECORDING, RECORDING_SUM, TRACE_SUM), cases)
    checks = [
        {"run": run, "metric": f"{n} of {run}", "verdict": "pass", "uncertainty": "0"}
        for n in ("first", "second")
        for run in runs
    ]
    table(place / "results.csv", RESULT_COLUMNS, checks)
    content = {"axisrig": "1", "runs_planned": len(runs), "finished": True, **manifest}
    (place / "manifest.json").write_text(json.dumps(content), encoding="utf-8")
    return place


def judged(out: Path, runs: Mapping[str, str], **words: Any) -> Path:
    entries = {RECORDINGS: "../..", RECORDED_IN: "out"}
    return folder(out / "judged" / "1-q", runs, **words, **entries)


def recorded(out: Path, *runs: str) -> None:
    for name, suffix in (("runs", "json"), ("traces", "parquet")):
        (out / name).mkdir(exist_ok=True)
        for run in runs:
            (out / name / f"{run}.{suffix}").write_text(f"{name} of {run}", encoding="utf-8")


OTHERS = [
    {"q-a": "p-a", "q-b": "p-b"},
    {"q-a": "p-b", "q-b": "p-a"},  # the other way round
    {"p-a": "p-b", "p-b": "p-a"},  # its own ID is that of another recording
    {"q-a": "p-a", "q-b": "p-a"},  # two judge the same one
    {"p-a": "", "q-b": "p-a"},  # as it was recorded, and anew
]


@pytest.mark.parametrize("runs", OTHERS)
def test_a_run_has_the_checks_of_its_own_id_whatever_recording_it_judges(
    tmp_path: Path, runs: dict[str, str]
) -> None:
    out = folder(tmp_path / "out", {"p-a": "", "p-b": ""})
    found = read_results(judged(out, runs)).runs
    assert [run.run for run in found] == [*runs]
    for run in found:
        metrics = [check.metric for check in run.checks]
        assert metrics == [f"first of {run.run}", f"second of {run.run}"]


@pytest.mark.parametrize("runs", OTHERS)
def test_a_run_has_the_files_of_the_recording_that_it_judges(
    tmp_path: Path, runs: dict[str, str]
) -> None:
    out = folder(tmp_path / "out", {"p-a": "", "p-b": ""})
    recorded(out, "p-a", "p-b", "q-a", "q-b")
    found = read_results(judged(out, runs))
    assert found.place is not None
    assert found.place.resolve() == out.resolve()
    for run, of in zip(found.runs, runs.values(), strict=True):
        wanted = of or run.run
        assert run.recorded == wanted
        assert run.file is not None
        assert run.trace is not None
        assert run.file.read_text() == f"runs of {wanted}"
        assert run.trace.read_text() == f"traces of {wanted}"
        assert run.place == found.place


def test_of_the_two_files_of_a_recording_either_may_be_missing(tmp_path: Path) -> None:
    out = folder(tmp_path / "out", {"p-a": "", "p-b": ""})
    recorded(out, "p-a", "p-b")
    (out / "runs" / "p-a.json").unlink()
    (out / "traces" / "p-b.parquet").unlink()
    a, b = read_results(judged(out, {"q-a": "p-a", "q-b": "p-b"})).runs
    assert (a.file is None, a.trace is None) == (True, False)
    assert (b.file is None, b.trace is None) == (False, True)


def test_a_run_without_checks_has_none_of_another(tmp_path: Path) -> None:
    out = folder(tmp_path / "out", {"p-a": "", "p-b": ""})
    place = judged(out, {"q-a": "p-a", "q-b": "p-a"})
    rows = (place / "results.csv").read_text(encoding="utf-8").splitlines()
    kept = [row for row in rows if ",q-a," not in row]
    (place / "results.csv").write_text("\n".join([*kept, ""]), encoding="utf-8")
    a, b = read_results(place).runs
    assert (len(a.checks), len(b.checks)) == (0, 2)


def test_checks_of_a_run_that_is_not_in_the_table_are_of_no_run(tmp_path: Path) -> None:
    """Not even of one that judges the recording of that name."""
    out = folder(tmp_path / "out", {"p-a": ""})
    place = judged(out, {"q-a": "p-a"})
    text = (place / "results.csv").read_text(encoding="utf-8").replace("q-a", "p-a")
    (place / "results.csv").write_text(text, encoding="utf-8")
    (run,) = read_results(place).runs
    assert list(run.checks) == []


@pytest.mark.parametrize("changed", ["", "runs/p-a.json", "traces/p-a.parquet"])
def test_a_recording_that_was_changed_is_named_by_its_own_id(tmp_path: Path, changed: str) -> None:
    """By the SHA-256 that `cases.csv` has of it; a file that is missing is not changed."""
    out = folder(tmp_path / "out", {"p-a": ""})
    recorded(out, "p-a")
    sums = {
        column: hashlib.sha256(f"{name} of p-a".encode()).hexdigest()
        for column, name in ((RECORDING_SUM, "runs"), (TRACE_SUM, "traces"))
    }
    place = judged(out, {"q-a": "p-a"}, sums=sums)
    if changed:
        (out / changed).write_text("other", encoding="utf-8")
    (run,) = read_results(place).runs
    assert run.altered == ([changed] if changed else [])
    wanted = f"not as the run has written it: {changed}" if changed else ""
    assert run.altered_words == wanted
    for name in ("runs/p-a.json", "traces/p-a.parquet"):
        (out / name).unlink()
    (run,) = read_results(place).runs
    assert run.altered == []


@pytest.mark.parametrize("name", ["judged", "other", "judged-2"])
def test_recordings_are_those_above_a_folder_of_verdicts_only(tmp_path: Path, name: str) -> None:
    """Elsewhere what lies two folders above it is not its own."""
    out = folder(tmp_path / "out", {"p-a": ""})
    recorded(out, "p-a")
    place = folder(out / name / "1-q", {"q-a": "p-a"}, **{RECORDINGS: "../.."})
    found = read_results(place)
    assert (found.place is not None) is (name == "judged")
    assert (found.runs[0].file is not None) is (name == "judged")
    assert len(found.runs[0].checks) == 2


@pytest.mark.parametrize(
    ("inside", "named"),
    [("out/judged/1-q", "."), ("out/judged", "1-q"), ("out", "judged/1-q"),
     ("out/runs", "../judged/1-q"), ("out/judged/1-q", "../1-q"), (".", "out/judged/1-q")],
)  # fmt: skip
def test_recordings_are_found_from_wherever_the_verdicts_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inside: str, named: str
) -> None:
    """Also inside of their folder, where the name says nothing of what is above it."""
    out = folder(tmp_path / "out", {"p-a": ""})
    recorded(out, "p-a")
    judged(out, {"q-a": "p-a"})
    monkeypatch.chdir(tmp_path / inside)
    found = read_results(Path(named))
    assert found.place is not None
    assert found.place.resolve() == out.resolve()
    (run,) = found.runs
    assert run.file is not None
    assert run.trace is not None
    assert run.file.read_text(encoding="utf-8") == "runs of p-a"
    assert run.trace.read_text(encoding="utf-8") == "traces of p-a"


@pytest.mark.parametrize(("inside", "named"), [("elsewhere/1-q", "."), ("elsewhere", "1-q")])
def test_verdicts_that_were_taken_out_have_no_recordings_inside_of_their_folder_either(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inside: str, named: str
) -> None:
    out = folder(tmp_path / "out", {"p-a": ""})
    recorded(tmp_path, "p-a")  # two folders above: those of another campaign
    (tmp_path / "elsewhere").mkdir()
    judged(out, {"q-a": "p-a"}).rename(tmp_path / "elsewhere" / "1-q")
    monkeypatch.chdir(tmp_path / inside)
    found = read_results(Path(named))
    assert found.place is None
    assert [(run.file, run.trace, run.altered) for run in found.runs] == [(None, None, [])]
    assert len(found.runs[0].checks) == 2


def test_a_folder_without_that_entry_has_its_own_recordings(tmp_path: Path) -> None:
    """Also where it lies in a folder of that name."""
    out = folder(tmp_path / "out", {"p-a": ""})
    recorded(out, "p-a")
    place = folder(out / "judged" / "1-q", {"p-a": ""})
    found = read_results(place)
    assert (found.place, found.runs[0].file) == (place, None)
    recorded(place, "p-a")
    (run,) = read_results(place).runs
    assert run.file == place / "runs" / "p-a.json"


def test_a_link_above_verdicts_made_anew_is_refused(tmp_path: Path) -> None:
    out = folder(tmp_path / "out", {"p-a": ""})
    place = judged(out, {"q-a": "p-a"})
    (tmp_path / "elsewhere").mkdir()
    (out / "runs").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(UserError, match="a results folder has no links") as caught:
        read_results(place)
    assert caught.value.value == "runs"


@pytest.mark.parametrize("bad", ["../p-a", "a b", "p/a"])
def test_the_recording_of_a_run_is_a_run_id(tmp_path: Path, bad: str) -> None:
    out = folder(tmp_path / "out", {"p-a": ""})
    with pytest.raises(UserError, match=f"{RECORDING} '{bad}' is no run id") as caught:
        read_results(judged(out, {"q-a": "p-a", "q-b": bad}))
    assert (caught.value.line, Path(str(caught.value.file)).name) == (3, "cases.csv")
