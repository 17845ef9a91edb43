"""The comparison of two campaigns sees every kind of difference, and no other."""

import csv
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from compare_campaigns import main

CASES = [
    ["plan", "case", "run", "verdict", "sim_s", "wall_s", "frame_log_sha256"],
    ["p", "a", "p-a", "pass", "1.0", "0.3", "aa"],
    ["p", "b", "p-b", "fail", "1.0", "0.3", "bb"],
]
RESULTS = [
    ["plan", "case", "run", "check", "metric", "value", "verdict"],
    ["p", "a", "p-a", "<= 1", "lag_mm_max", "0.5", "pass"],
    ["p", "a", "p-a", "none", "alarms", "", "pass"],
    ["p", "b", "p-b", "<= 1", "lag_mm_max", "1.5", "fail"],
]


def _write(folder: Path, cases: list[list[str]], results: list[list[str]]) -> Path:
    folder.mkdir(exist_ok=True)
    for name, rows in (("cases.csv", cases), ("results.csv", results)):
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
    return folder


@pytest.fixture
def compare(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    """Compare a campaign with one in which one cell is another; gives code and output."""
    before = _write(tmp_path / "before", CASES, RESULTS)

    def call(
        table: str = "", line: int = 0, column: str = "", cell: str = "", *words: str
    ) -> tuple[int, str]:
        cases, results = [list(row) for row in CASES], [list(row) for row in RESULTS]
        rows = {"cases": cases, "results": results}.get(table)
        if rows is not None:
            rows[line][rows[0].index(column)] = cell
        after = _write(tmp_path / "after", cases, results)
        code = main([str(before), str(after), *words])
        return code, capsys.readouterr().out

    return call


def test_equal_campaigns_but_for_the_clock(compare: Callable[..., tuple[int, str]]) -> None:
    assert compare() == (0, "2 runs equal, 0 differ, 0 of them as expected\n")
    assert compare("cases", 1, "wall_s", "7")[0] == 0


@pytest.mark.parametrize(
    ("change", "found"),
    [
        (("cases", 1, "frame_log_sha256", "a0"), "p-a: frames"),
        (("cases", 2, "verdict", "pass"), "p-b: verdict fail -> pass"),
        (("results", 1, "value", "0.6"), "p-a: lag_mm_max value 0.5 -> 0.6"),
        (("results", 2, "value", "50052"), "p-a: alarms value none -> 50052"),
        (("results", 3, "verdict", "error"), "p-b: lag_mm_max verdict fail -> error"),
        (("results", 1, "check", "<= 2"), "p-a: lag_mm_max check <= 1 -> <= 2"),
        (
            ("results", 2, "metric", "lag_mm"),
            "p-a: alarms is not checked any more; lag_mm is checked now",
        ),
    ],
)
def test_a_difference_is_told_and_ends_with_1(
    compare: Callable[..., tuple[int, str]], change: tuple[str, int, str, str], found: str
) -> None:
    code, out = compare(*change)
    assert (code, out) == (1, f"{found}\n1 runs equal, 1 differ, 0 of them as expected\n")


def test_runs_that_are_new_or_lost(compare: Callable[..., tuple[int, str]]) -> None:
    code, out = compare("cases", 2, "run", "p-c")
    assert (code, out.splitlines()[:2]) == (1, ["p-b: lost", "p-c: new"])
    assert out.endswith("1 runs equal, 2 differ, 0 of them as expected\n")


def test_expected_differences_are_told_and_pass(
    compare: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    file = tmp_path / "expected"
    file.write_text("# rows of the new rig\np-a  # three segments\np-z\n", encoding="utf-8")
    code, out = compare("cases", 1, "frame_log_sha256", "a0", "--expected", str(file))
    assert (code, out.splitlines()) == (0, [
        "expected p-a: frames",
        "expected to differ, but equal or unknown: p-z",
        "1 runs equal, 1 differ, 1 of them as expected",
    ])  # fmt: skip
    assert compare("cases", 2, "frame_log_sha256", "b0", "--expected", str(file))[0] == 1


def test_what_cannot_be_compared_ends_with_2(
    compare: Callable[..., tuple[int, str]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = _write(tmp_path / "before", CASES, RESULTS)
    assert main([str(before), str(tmp_path / "no")]) == 2
    assert main([str(before), str(_write(tmp_path / "empty", CASES[:1], RESULTS[:1]))]) == 2
    assert main([str(before), str(_write(tmp_path / "other", [["a"], ["1"]], RESULTS))]) == 2
    folder = shutil.copytree(before, tmp_path / "copy")
    assert main([str(before), str(folder), "--expected", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().out == ""
