"""`axisrig judge`: new verdicts from stored recordings, without a simulation."""

import csv
import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from cli_plan import HEADER
from tests.reports.pages import whole

from axisrig.bench.cli.main import main
from axisrig.bench.files import sha256_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.record.facts import VERSION

Call = Callable[..., tuple[int, str, str]]
METRICS = f"{HEADER},check:latch_error_um:Z,check:lag_mm_max"
ROWS = ("a,part.nc,rig.toml,3000,== 1,,<= 1,< 5", "b,part.nc,rig.toml,1500,== 1,,<= 1,< 5")


@pytest.fixture(scope="module")
def recorded(originals: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with plan, files and the results of two runs."""
    folder: Path = tmp_path_factory.mktemp("recorded")
    shutil.copytree(originals, folder, dirs_exist_ok=True)
    plan = write(folder, *ROWS)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        with pytest.raises(SystemExit):
            main(["run", plan, "-o", "out"])
    return folder


@pytest.fixture
def place(recorded: Path, place: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a test with the results; nothing can be simulated in it."""
    shutil.copytree(recorded, place, dirs_exist_ok=True)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a machine is built")

    monkeypatch.setattr(Machine, "__init__", refuse)
    return place


def write(folder: Path, *rows: str, name: str = "plan.csv", header: str = METRICS) -> str:
    (folder / name).write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    return name


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def hashes(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.relative_to(folder).parts[0] != "judged"
    }


def notes(place: Path, number: int = 1, name: str = "plan") -> dict[str, str]:
    found = rows_of(place / "out" / "judged" / f"{number}-{name}" / "results.csv")
    return {f"{row['case']} {row['metric']}": f"{row['verdict']}: {row['note']}" for row in found}


@pytest.mark.long
def test_the_same_plan_gives_the_same_results_to_the_byte(place: Path, axisrig: Call) -> None:
    before = hashes(place / "out")
    code, out, err = axisrig("judge", "out", "--plan", "plan.csv")
    assert (code, err.partition(" in ")[0]) == (0, "2 pass")
    assert "judged/1-plan/report.html" in out
    made = place / "out" / "judged" / "1-plan"
    assert (made / "results.csv").read_bytes() == (place / "out/results.csv").read_bytes()
    names = {path.name for path in made.iterdir() if not path.name.startswith(".")}
    files = {"results.csv", "cases.csv", "junit.xml", "report.html", "manifest.json"}
    assert names == {*files, "inputs.json", "plans"}
    axisrig("judge", "out", "--plan", "plan.csv")
    assert (made.parent / "2-plan" / "results.csv").is_file()
    assert hashes(place / "out") == before


@pytest.mark.long
def test_other_checks_give_other_verdicts_and_the_worst_is_the_exit_code(
    place: Path, axisrig: Call
) -> None:
    plan = write(
        place,
        "a,part.nc,rig.toml,3000,== 1,,< 60",
        "b,part.nc,rig.toml,1500,== 0,,< 60",
        name="other.csv",
        header=f"{HEADER},check:velocity_mm_s_max",
    )
    code, out, _ = axisrig("judge", "out", "--plan", plan)
    assert code == 1, out
    cases = rows_of(place / "out" / "judged" / "1-other" / "cases.csv")
    assert [(row["run"], row["recording"]) for row in cases] == [
        ("other-a", "plan-a"),
        ("other-b", "plan-b"),
    ]
    page = whole(place / "out" / "judged" / "1-other" / "report.html")
    assert "axisrig replay out plan-a" in page
    assert axisrig("report", "out/judged/1-other")[0] == 0


@pytest.mark.parametrize(
    ("row", "why"),
    [
        (
            "a,part.nc,rig.toml,2999,== 1,,<= 1,< 5",
            "plc:V.E.FEED is not that of the recording: 3000",
        ),
        ("a,other.nc,rig.toml,3000,== 1,,<= 1,< 5", "the program is not that of the recording"),
        ("a,part.nc,other.toml,3000,== 1,,<= 1,< 5", "the rig is not that of the recording"),
        ("c,part.nc,rig.toml,3000,== 1,,<= 1,< 5", "the folder has no recording of this case"),
    ],
)
def test_a_row_that_asks_for_another_run_is_not_run(
    place: Path, axisrig: Call, row: str, why: str
) -> None:
    (place / "other.nc").write_text((place / "part.nc").read_text() + "(longer)\n")
    (place / "other.toml").write_text(
        (place / "rig.toml").read_text().replace("kv = 40", "kv = 39")
    )
    code, _, err = axisrig("judge", "out", "--plan", write(place, row))
    assert code == 4
    found = notes(place)
    assert all(text.startswith(f"error: not run: {why}") for text in found.values()), found
    assert "no row of the plan judges " in err
    assert "plan-b" in err


@pytest.mark.long
def test_a_list_that_has_changed_since_is_another_rig(place: Path, axisrig: Call) -> None:
    with (place / "lists" / "axis-z.lst").open("a") as file:
        file.write("# changed\n")
    code, _, _ = axisrig("judge", "out", "--plan", "plan.csv")
    assert code == 4
    assert "has other content than when the case was run" in notes(place)["a alarms"]


@pytest.mark.long
def test_another_seed_is_another_run(place: Path, axisrig: Call) -> None:
    rows = [f"{row},7" for row in ROWS]
    code, _, _ = axisrig("judge", "out", "--plan", write(place, *rows, header=f"{METRICS},seed"))
    assert code == 4
    assert "the seed is not that of the recording" in notes(place)["b alarms"]


@pytest.mark.long
def test_what_was_not_recorded_is_an_error_and_never_a_pass(place: Path, axisrig: Call) -> None:
    trace, table = place / "out" / "traces" / "plan-a.parquet", place / "out" / "cases.csv"
    before = sha256_of(trace)
    pq.write_table(pq.read_table(trace).drop_columns(["Z.cnc_lag_mm"]), trace)
    code, _, _ = axisrig("judge", "out", "--plan", "plan.csv")
    assert code == 4
    words = "error: not run: not as the run has written it: traces/plan-a.parquet"
    assert notes(place)["a lag_mm_max"] == words
    # As a run that did not record it would have written it
    table.write_text(table.read_text().replace(before, sha256_of(trace)))
    code, _, _ = axisrig("judge", "out", "--plan", "plan.csv")
    assert code == 4
    found = notes(place, 2)
    assert found["a lag_mm_max"] == "error: the recording has no signal Z.cnc_lag_mm"
    assert found["a latch_error_um:Z"].startswith("pass")


@pytest.mark.long
def test_a_recording_without_its_series_is_an_error(place: Path, axisrig: Call) -> None:
    (place / "out" / "traces" / "plan-b.parquet").unlink()
    assert axisrig("judge", "out", "--plan", "plan.csv")[0] == 4
    assert notes(place)["b alarms"] == "error: its time series are missing"


def test_a_folder_that_has_no_results_is_named(place: Path, rejected: Callable[..., str]) -> None:
    assert "no results folder" in rejected("judge", "lists", "--plan", "plan.csv")


@pytest.mark.long
def test_a_judged_folder_has_no_recordings_of_its_own(
    place: Path, axisrig: Call, rejected: Callable[..., str]
) -> None:
    axisrig("judge", "out", "--plan", "plan.csv")
    said = rejected("judge", "out/judged/1-plan", "--plan", "plan.csv")
    assert "its recordings are in another one; judge out" in said


def test_a_recording_of_another_version_is_refused_and_nothing_is_written(
    place: Path, rejected: Callable[..., str]
) -> None:
    file = place / "out" / "runs" / "plan-b.json"
    file.write_text(file.read_text().replace(f'"version": {VERSION}', '"version": 0'))
    said = rejected("judge", "out", "--plan", "plan.csv")
    assert said.startswith("out/runs/plan-b.json: a recording of another version; found 0")
    assert not (place / "out" / "judged").exists()


@pytest.mark.long
def test_a_judged_folder_never_gets_the_number_of_another_one(place: Path, axisrig: Call) -> None:
    """The first of two was deleted, and what is no number counts for nothing."""
    for name in ("2-plan", "x-plan", "notes"):
        (place / "out" / "judged" / name).mkdir(parents=True)
    axisrig("judge", "out", "--plan", "plan.csv")
    assert notes(place, 3)
    assert list((place / "out" / "judged" / "2-plan").iterdir()) == []
