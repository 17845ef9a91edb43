"""Plans as pytest items, on copies: what passes, what fails, what cannot be collected."""

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
PLANS = ROOT / "testplans"


def _shipped() -> dict[str, dict[str, str]]:
    with (PLANS / "latch_accuracy.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def _write(path: Path, *rows: dict[str, str]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What pytest prints for three plans: one good, one with a changed limit, one broken."""
    folder = tmp_path_factory.mktemp("testplans")
    for name in ("programs", "rigs"):
        shutil.copytree(PLANS / name, folder / name)
    shutil.copy(PLANS / "conftest.py", folder)
    rows = _shipped()
    words = {"tags": "skip xfail usefixtures"}  # marks of pytest are tags like others
    _write(folder / "good.csv", rows["f3000"], rows["actuated"] | words)
    _write(folder / "limit.csv", rows["f3000"] | {"check:overtravel_mm": "<= 0.5"})
    _write(folder / "broken.csv", rows["f3000"] | {"chek:alarms": "none"})
    # pytest repeats whole messages in its summary where CI is set
    env = {key: value for key, value in os.environ.items() if key not in ("CI", "BUILD_NUMBER")}
    env |= {"COLUMNS": "120"}
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "--color=no",
         "--continue-on-collection-errors", "-c", os.devnull, "--rootdir", folder, folder],
        cwd=folder, env=env,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 1, ended.stdout + ended.stderr
    return ended.stdout


def test_rows_are_items_with_the_name_of_their_run(report: str) -> None:
    assert re.search(r"good\.csv::good-f3000 PASSED", report)
    assert re.search(r"good\.csv::good-actuated PASSED", report)
    assert "2 passed" in report


def test_failing_row_names_metric_value_and_condition(report: str) -> None:
    assert re.search(r"limit\.csv::limit-f3000 FAILED", report)
    line = re.search(r"fail: overtravel_mm is (\S+) mm above its upper limit 0\.5 mm", report)
    assert line is not None, report
    low, high = map(float, _shipped()["f3000"]["check:overtravel_mm"].split(" .. "))
    assert 0.5 < low <= 0.5 + float(line[1]) <= high
    assert re.search(r"limit\.csv:2: limit-f3000: fail", report)
    # the other checks of the row hold and are not told
    assert len(re.findall(r"^ *fail: ", report, re.MULTILINE)) == 1


def test_broken_plan_is_a_collection_error_with_its_message(report: str) -> None:
    assert "ERROR collecting broken.csv" in report
    position = len(_shipped()["f3000"]) + 1
    assert f"broken.csv:1:{position}: unknown column; found 'chek:alarms'" in report
    assert "1 failed, 2 passed, 1 error" in report


def test_no_traceback_of_the_bench_is_shown(report: str) -> None:
    assert "Traceback" not in report
    assert "pytest_plugin.py" not in report


def test_the_shipped_conftest_is_the_one_line_that_the_page_shows() -> None:
    text = (PLANS / "conftest.py").read_text(encoding="utf-8")
    assert len(text.splitlines()) == 1
    assert f"```python\n{text}```" in (ROOT / "docs/campaigns.md").read_text(encoding="utf-8")


def _collected(*arguments: object) -> str:
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "--collect-only", "-p", "no:cacheprovider",
         "-c", os.devnull, *map(str, arguments)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return somebody's project: plans, more plans below them, and tables that are none."""
    rows = _shipped()
    for folder in ("plans", "plans/more"):
        (tmp_path / folder).mkdir()
        for name in ("programs", "rigs"):
            shutil.copytree(PLANS / name, tmp_path / folder / name)
        shutil.copy(PLANS / "conftest.py", tmp_path / folder)
        _write(tmp_path / folder / "p.csv", rows["f3000"])
    (tmp_path / "plans/data").mkdir()
    for table in ("plans/data/none.csv", "none.csv"):
        _write(tmp_path / table, {"no": "plan"})
    return tmp_path


@pytest.mark.parametrize("named", [[""], ["plans"], ["plans", "plans/more"]])
def test_each_table_beside_a_conftest_is_collected_once(project: Path, named: list[str]) -> None:
    """Also where folders of plans lie in each other, or are found on the way only."""
    text = _collected("--rootdir", project, *(project / name for name in named))
    assert sorted(re.findall(r"^\S+::\S+$", text, re.MULTILINE)) == [
        "plans/more/p.csv::p-f3000",
        "plans/p.csv::p-f3000",
    ]


def test_the_option_is_known_with_two_folders_of_plans(project: Path) -> None:
    limit = "--axisrig-call-timeout=9"
    assert "2 tests collected" in _collected(limit, project / "plans", project / "plans/more")


def _run(*arguments: object, cwd: Path, code: int = 0) -> str:
    env = {key: value for key, value in os.environ.items() if key not in ("CI", "BUILD_NUMBER")}
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no", "-c", os.devnull,
         *map(str, arguments)],
        cwd=cwd, env=env | {"COLUMNS": "200"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == code, ended.stdout + ended.stderr
    return ended.stdout


@pytest.fixture
def bare(project: Path) -> Path:
    """Return the project without any conftest."""
    for path in project.rglob("conftest.py"):
        path.unlink()
    return project


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["."], []),
        (["plans"], ["plans/p.csv::p-f3000"]),
        (["plans/p.csv"], ["plans/p.csv::p-f3000"]),
        (["plans/p.csv::p-f3000"], ["plans/p.csv::p-f3000"]),
        (["-c", "own.ini"], ["plans/more/p.csv::p-f3000", "plans/p.csv::p-f3000"]),
        (["plans", "plans/data"], ["plans/p.csv::p-f3000"]),
    ],
)
def test_without_conftest_folders_are_named(
    bare: Path, arguments: list[str], found: list[str]
) -> None:
    (bare / "own.ini").write_text("[pytest]\naxisrig_plans = plans plans/more\n", encoding="utf-8")
    code = 0 if found else 5
    text = _run("-q", "--collect-only", "--rootdir", bare, *arguments, cwd=bare, code=code)
    assert sorted(re.findall(r"^\S+::\S+$", text, re.MULTILINE)) == found


def test_without_entry_points_a_conftest_is_enough(project: Path) -> None:
    text = _run(
        "-q", "--collect-only", "-p", "no:axisrig", "--rootdir", project, "plans", cwd=project
    )
    assert sorted(re.findall(r"^\S+::\S+$", text, re.MULTILINE))[-1] == "plans/p.csv::p-f3000"


@pytest.fixture
def several(bare: Path) -> Path:
    rows = _shipped()
    named = [rows["f60"], rows["f600"], rows["f3000"] | {"check:overtravel_mm": "<= 0.5"}]
    _write(bare / "plans" / "p.csv", *named)
    return bare


def test_k_and_markers_choose_as_axisrig_run_does(several: Path) -> None:
    rows, names = _shipped(), ("f60", "f600", "f3000")
    where = ("-q", "--collect-only", "--rootdir", several, "plans")
    for chosen, found in (
        (["-k", "f60"], ["f60"]),  # the whole name of a case means it alone
        (["-k", "f6"], ["f60", "f600"]),
        (["-k", "not plans"], ["f60", "f600", "f3000"]),  # the folder is no name of a case
        (["-k", "rising and not f600"], ["f60", "f3000"]),  # a word of the title
        (["-m", "demo"], [case for case in names if "demo" in rows[case]["tags"].split()]),
    ):
        text = _run(*where, *chosen, cwd=several)
        runs = re.findall(r"^\S+::p-(\S+)$", text, re.MULTILINE)
        assert runs == found, chosen


def test_the_results_folder_is_that_of_axisrig_run(several: Path) -> None:
    """With several workers, too; a failure is one line with value and limit in the summary."""
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", "plans/p.csv", "-o", "run"]
    subprocess.run(command, cwd=several, check=False, capture_output=True)
    for workers, out in (("0", "one"), ("2", "two")):
        text = _run("-n", workers, "--rootdir", several, "plans", "--axisrig-out", out,
                    cwd=several, code=1)  # fmt: skip
        assert "1 failed, 2 passed" in text
        assert re.search(
            r"FAILED plans/p\.csv::p-f3000 - overtravel_mm is .* above its upper", text
        )
        assert _content(several / out) == _content(several / "run")
        assert (several / out / "report.html").is_file()


def _content(folder: Path) -> dict[str, bytes]:
    """Every file but those that say when and how it was run."""
    found = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name not in ("manifest.json", "report.html", ".lock")
    }
    found["junit.xml"], count = re.subn(rb' time(stamp)?="[^"]*"', b"", found["junit.xml"])
    assert count == 2 * (1 + 3)  # both of the suite and of each run
    with (folder / "cases.csv").open(encoding="utf-8", newline="") as file:
        rows = [{**row, "wall_s": "", "timestamp": ""} for row in csv.DictReader(file)]
    return {**found, "cases.csv": repr(rows).encode()}


GOES = """\
import shutil

import pytest

from axisrig.bench.campaign.pytest_plugin import pytest_addoption  # noqa: F401


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_logreport(report):
    if report.when == "call":
        shutil.rmtree("out")
"""


def test_a_results_folder_that_goes_ends_pytest_with_4(tmp_path: Path) -> None:
    for name in ("programs", "rigs"):
        shutil.copytree(PLANS / name, tmp_path / name)
    (tmp_path / "conftest.py").write_text(GOES, encoding="utf-8")
    rows = _shipped()
    _write(tmp_path / "good.csv", rows["f3000"], rows["actuated"])
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir",
         tmp_path, tmp_path, "--axisrig-out", "out"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 4, ended.stdout + ended.stderr
    assert "axisrig: " in ended.stdout + ended.stderr
    assert "No such file or directory" in ended.stdout + ended.stderr
    assert "INTERNALERROR" not in ended.stdout
