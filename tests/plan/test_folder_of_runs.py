"""Rows and files of runs in a results folder, run by run: put, replaced, removed, recovered."""

import csv
from collections.abc import Sequence
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.commits import Commit
from axisrig.bench.campaign.results.folder import (
    ResultsFolder,
    clear,
    recover,
    refuse_foreign,
)
from axisrig.bench.campaign.results.layout import COMMIT, FOLDERS, NEW
from axisrig.bench.campaign.results.stored import CASE_COLUMNS, IN_PLAN, RESULT_COLUMNS
from axisrig.kernel.errors import UserError

FILES = (("traces", ".parquet"), ("runs", ".json"), ("bus", ".blf"), ("bus", "@can2.blf"))


def case(run: str, verdict: str = "pass", **more: str) -> dict[str, str]:
    return {**dict.fromkeys(CASE_COLUMNS, ""), "run": run, "verdict": verdict,
            "sim_s": "1", "wall_s": "1", **more}  # fmt: skip


def check(run: str, value: str = "1") -> dict[str, str]:
    return {**dict.fromkeys(RESULT_COLUMNS, ""), "run": run, "value": value,
            "uncertainty": "0", "verdict": "pass"}  # fmt: skip


def opened(place: Path) -> ResultsFolder:
    place.mkdir(exist_ok=True)
    results = ResultsFolder(place)
    results.open()
    return results


def put(
    results: ResultsFolder, run: str, text: str = "a", files: Sequence[tuple[str, str]] = FILES,
    verdict: str = "pass", **more: str,
) -> None:  # fmt: skip
    """A run that wrote its files."""
    for kind, suffix in files:
        results.path_of(kind, run, suffix).write_text(text, encoding="utf-8")
    results.put(run, case(run, verdict, **more), [check(run), check(run, "2")])


def rows(place: Path, name: str) -> list[tuple[str, ...]]:
    column = "verdict" if name == "cases.csv" else "value"
    with (place / name).open(encoding="utf-8", newline="") as file:
        return [(row["run"], row[column]) for row in csv.DictReader(file)]


def files_in(place: Path) -> set[str]:
    return {f"{kind}/{path.name}" for kind in FOLDERS for path in (place / kind).iterdir()}


def files_of(run: str, files: Sequence[tuple[str, str]] = FILES) -> set[str]:
    return {f"{kind}/{run}{suffix}" for kind, suffix in files}


@pytest.fixture
def filled(tmp_path: Path) -> Path:
    """Runs r, r1 and r-2, with rows and files, as a campaign has left them."""
    place = tmp_path / "results"
    results = opened(place)
    results.write_rows()
    for run in ("r", "r1", "r-2"):
        put(results, run)
    results.close()
    (place / "manifest.json").write_text('{"axisrig": "1", "runs_planned": 3}', encoding="utf-8")
    return place


def test_a_run_has_its_files_and_rows_when_it_has_ended(filled: Path) -> None:
    assert rows(filled, "cases.csv") == [("r", "pass"), ("r1", "pass"), ("r-2", "pass")]
    assert rows(filled, "results.csv") == [
        (run, value) for run in ("r", "r1", "r-2") for value in ("1", "2")
    ]
    assert files_in(filled) == files_of("r") | files_of("r1") | files_of("r-2")
    assert not (filled / NEW).exists()


def test_removed_runs_go_with_their_files_and_leave_those_of_like_names(filled: Path) -> None:
    results = opened(filled)
    results.remove([])
    assert len(results.cases) == 3
    results.remove(["r", "r-2"])
    results.close()
    assert rows(filled, "cases.csv") == [("r1", "pass")]
    assert rows(filled, "results.csv") == [("r1", "1"), ("r1", "2")]
    assert files_in(filled) == files_of("r1")


def test_files_of_a_run_without_a_row_go_and_those_of_one_with_a_row_stay(filled: Path) -> None:
    results = opened(filled)
    for name in ("bus/broken.blf", "bus/broken@can2.blf", "traces/broken.parquet",
                 "bus/broken2.blf"):  # fmt: skip
        (filled / name).write_text("x", encoding="utf-8")
    results.drop_files(["broken", "r1", "nobody"])
    assert files_in(filled) == (
        files_of("r") | files_of("r1") | files_of("r-2") | {"bus/broken2.blf"}
    )
    results.close()


def test_a_run_again_takes_the_place_of_what_it_had(filled: Path) -> None:
    """Files that it does not write any more go; its rows come last; the others stay."""
    results = opened(filled)
    assert rows(filled, "cases.csv")[0] == ("r", "pass")  # until it has ended
    put(results, "r", "b", files=FILES[:2], verdict="fail")
    results.close()
    assert rows(filled, "cases.csv") == [("r1", "pass"), ("r-2", "pass"), ("r", "fail")]
    assert files_in(filled) == files_of("r", FILES[:2]) | files_of("r1") | files_of("r-2")
    assert (filled / "traces/r.parquet").read_text(encoding="utf-8") == "b"
    assert (filled / "traces/r1.parquet").read_text(encoding="utf-8") == "a"
    assert sorted(rows(filled, "results.csv")) == sorted(
        (run, value) for run in ("r", "r1", "r-2") for value in ("1", "2")
    )


def test_columns_that_come_later_are_behind_and_empty_before(filled: Path) -> None:
    results = opened(filled)
    put(results, "r", **{"plc:V.E.A": "7"})
    put(results, "r1", **{"set:Z.b": "8", "plc:V.E.A": "9"})
    results.close()
    with (filled / "cases.csv").open(encoding="utf-8", newline="") as file:
        table = csv.DictReader(file)
        found = {row["run"]: (row["plc:V.E.A"], row["set:Z.b"]) for row in table}
        assert table.fieldnames is not None
        places = [list(table.fieldnames).index(name) for name in ("plc:V.E.A", "set:Z.b")]
        assert len(CASE_COLUMNS) <= places[0] < places[1] == len(table.fieldnames) - 1
    assert found == {"r-2": ("", ""), "r": ("7", ""), "r1": ("9", "8")}
    again = opened(filled)
    assert {"plc:V.E.A", "set:Z.b"} <= set(again.columns)
    again.close()


def test_a_mark_of_runs_outside_the_plan_is_a_column_while_there_is_one(filled: Path) -> None:
    results = opened(filled)
    results.cases["r1"] = {**results.cases["r1"], IN_PLAN: "no"}
    results.write_rows()
    assert (filled / "cases.csv").read_text(encoding="utf-8").splitlines()[0].endswith(IN_PLAN)
    results.cases["r1"] = {**results.cases["r1"], IN_PLAN: ""}
    results.write_rows()
    assert IN_PLAN not in (filled / "cases.csv").read_text(encoding="utf-8")
    results.close()


def test_runs_are_in_the_order_that_is_asked_for_with_their_checks(filled: Path) -> None:
    results = opened(filled)
    results.sort(["r-2", "r1", "r"].index)
    results.write_rows()
    results.close()
    assert [run for run, _ in rows(filled, "cases.csv")] == ["r-2", "r1", "r"]
    assert [run for run, _ in rows(filled, "results.csv")] == ["r-2"] * 2 + ["r1"] * 2 + ["r"] * 2


# A campaign that was killed


def left_commit(place: Path, run: str, names: Sequence[str], verdict: str = "fail") -> Path:
    """What a killed campaign leaves of a run that it was about to replace."""
    stage = place / NEW / "campaign-x"
    for kind in FOLDERS:
        (stage / kind).mkdir(parents=True)
    for name in names:
        (stage / name).write_text("new", encoding="utf-8")
    commit = Commit(run, list(names), case(run, verdict), [check(run, "9")])
    path = stage / f"{run}{COMMIT}"
    path.write_text(commit.text, encoding="utf-8")
    return path


@pytest.mark.parametrize("moved", [False, True])
def test_a_commit_that_was_left_is_carried_out_however_far_it_had_come(
    filled: Path, moved: bool
) -> None:
    path = left_commit(filled, "r1", ["traces/r1.parquet"])
    if moved:  # the file had its place already
        (path.parent / "traces/r1.parquet").replace(filled / "traces/r1.parquet")
    recover(filled)
    assert rows(filled, "cases.csv") == [("r", "pass"), ("r-2", "pass"), ("r1", "fail")]
    assert ("r1", "9") in rows(filled, "results.csv")
    assert ("r1", "1") not in rows(filled, "results.csv")
    assert files_in(filled) == files_of("r") | files_of("r-2") | {"traces/r1.parquet"}
    assert (filled / "traces/r1.parquet").read_text(encoding="utf-8") == "new"
    assert not (filled / NEW).exists()


@pytest.mark.parametrize("has_commit", [True, False])
def test_what_a_full_disk_kept_from_its_place_stays_for_the_next_campaign(
    filled: Path, has_commit: bool
) -> None:
    """The new results of r1 are written and not yet in their place when the folder is closed."""
    results = opened(filled)
    new = results.path_of("traces", "r1", ".parquet")
    new.write_text("new", encoding="utf-8")
    if has_commit:
        commit = Commit("r1", ["traces/r1.parquet"], case("r1", "fail"), [check("r1", "9")])
        (new.parents[1] / f"r1{COMMIT}").write_text(commit.text, encoding="utf-8")
    results.close()
    assert new.exists() is (filled / NEW).exists() is has_commit
    opened(filled).close()
    assert dict(rows(filled, "cases.csv"))["r1"] == ("fail" if has_commit else "pass")
    text = (filled / "traces/r1.parquet").read_text(encoding="utf-8")
    assert text == ("new" if has_commit else "a")
    assert not (filled / NEW).exists()


def test_without_a_commit_nothing_is_recovered(filled: Path) -> None:
    before = (filled / "cases.csv").stat().st_mtime_ns
    (filled / NEW / "campaign-y" / "traces").mkdir(parents=True)
    recover(filled)
    assert (filled / NEW).exists()
    assert (filled / "cases.csv").stat().st_mtime_ns == before


def test_checks_without_a_row_of_their_run_are_dropped(filled: Path) -> None:
    """A run that was killed between its checks and its row."""
    with (filled / "results.csv").open("a", encoding="utf-8") as file:
        file.write("p,c,half,,m,1,um,,,0,pass,x,\n")
    results = opened(filled)
    results.close()
    assert "half" not in (filled / "results.csv").read_text(encoding="utf-8")


def test_what_was_made_of_the_rows_goes_when_the_folder_is_opened(filled: Path) -> None:
    for name in ("junit.xml", "report.html"):
        (filled / name).write_text("x", encoding="utf-8")
    results = opened(filled)
    assert not (filled / "junit.xml").exists()
    results.close()


def test_a_cleared_folder_has_no_results_and_keeps_what_the_next_needs(filled: Path) -> None:
    (filled / "budgets").mkdir()
    (filled / "budgets" / "r.csv").write_text("x", encoding="utf-8")
    (filled / "traces" / "deep").mkdir()
    clear(filled)
    assert files_in(filled) == set()
    assert sorted(path.name for path in filled.iterdir()) == sorted(FOLDERS)


@pytest.mark.parametrize(
    ("names", "is_refused"),
    [((), False), (("notes.txt",), True), (("traces/",), False), (("traces/x",), True),
     (("plans/",), False), (("plans/a.csv",), True), (("other/",), True)],
)  # fmt: skip
def test_a_folder_of_something_else_is_refused(
    tmp_path: Path, names: tuple[str, ...], is_refused: bool
) -> None:
    """Empty folders are what a process leaves that was killed at once."""
    place = tmp_path / "out"
    for name in names:
        path = place / name
        if name.endswith("/"):
            path.mkdir(parents=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("x", encoding="utf-8")
    if is_refused:
        with pytest.raises(UserError, match="no results folder"):
            refuse_foreign(place)
    else:
        refuse_foreign(place)


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    place = tmp_path / "out"
    place.write_text("x", encoding="utf-8")
    with pytest.raises(UserError, match="not a folder"):
        refuse_foreign(place)
