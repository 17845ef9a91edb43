"""The page of an error budget: what leads from the contact to the published value."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import pytest

from axisrig.bench.tools.budget.budget import Budget, Share
from axisrig.bench.tools.budget.causes import causes
from axisrig.kernel.errors import UserError
from axisrig.reports.budget.drawing import waterfall
from axisrig.results.budget.page import add_budget, write_budget

FIRST, SECOND, THIRD = causes()[:3]
# Two causes act on each other: in turn they make 10 um, alone 12
BUDGET = Budget(
    run="p-a", axis="Z", error_um=9.5, velocity_mm_s=-10.0, increment_um=0.01, left_um=0.5,
    shares=(
        Share(FIRST, "8 um", 8.0, 5.0, None, None, 6.5, interacts=True),
        Share(SECOND, "3 us", 4.0, 5.0, None, None, 3.5, interacts=True),
        Share(THIRD, "on", -1.0, -1.0, -1.0, None),
    ),
    frame_log_sha256="ab" * 32, quantum_um=1.0,
)  # fmt: skip


def page_of(folder: Path, budget: Budget = BUDGET) -> str:
    return write_budget(folder / "b.html", budget).read_text(encoding="utf-8")


def test_the_waterfall_leads_by_what_each_cause_adds_in_turn(tmp_path: Path) -> None:
    """So that its bars add up to the published value; what is left comes first."""
    text = page_of(tmp_path)
    names = re.findall(r'<text x="[\d.]+" y="[\d.]+" text-anchor="end">([^<]*)<', text)
    sizes = [float(size) for size in re.findall(r'y="[\d.]+">([+-][\d.]+) um</text>', text)]
    assert names == [
        "left with all causes off", *(each.cause for each in (FIRST, SECOND, THIRD)),
        "published value",
    ]  # fmt: skip
    assert sizes == [0.5, 5.0, 5.0, -1.0, 9.5]
    assert sum(sizes[:-1]) == pytest.approx(BUDGET.error_um)
    assert waterfall([(name, size) for name, size in zip(names[:-1], sizes[:-1], strict=True)],
                     9.5) in text  # fmt: skip


def test_the_table_has_each_cause_alone_in_turn_and_together(tmp_path: Path) -> None:
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page_of(tmp_path))
    for alone, in_turn, together in (("+8.0000", "+5.0000", "+6.5000"),
                                     ("+4.0000", "+5.0000", "+3.5000")):  # fmt: skip
        place = cells.index(alone)
        assert cells[place : place + 3] == [alone, in_turn, together]
    path = write_budget(tmp_path / "b.csv", BUDGET)
    assert b"\r" not in path.read_bytes()  # one line break, as in every table of a results folder
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["alone_um"] for row in rows] == ["8.0", "4.0", "-1.0", ""]
    assert [row["in_turn_um"] for row in rows] == ["5.0", "5.0", "-1.0", "0.5"]
    assert {(row["run"], row["axis"], row["frame_log_sha256"]) for row in rows} == {
        ("p-a", "Z", "ab" * 32)
    }


@pytest.mark.parametrize(
    ("velocity_mm_s", "side"), [(-10.0, "smaller"), (10.0, "larger"), (2.5, "larger")]
)
def test_the_head_says_where_the_axis_went(velocity_mm_s: float, side: str, tmp_path: Path) -> None:
    text = page_of(tmp_path, replace(BUDGET, velocity_mm_s=velocity_mm_s, error_um=-9.5))
    assert f"published value -9.5000 um from the contact at {abs(velocity_mm_s):g} mm/s" in text
    assert f"towards {side} positions" in text
    assert "<h1>p-a, axis Z</h1>" in text


def test_the_largest_cause_is_the_largest_in_turn(tmp_path: Path) -> None:
    """The first one is the largest alone; the second one is so in turn."""
    first, second, third = BUDGET.shares
    turned = replace(BUDGET, shares=(replace(first, in_turn_um=4.0), second, third))
    assert f"; largest cause: {SECOND.cause}<" in page_of(tmp_path, turned)
    small = replace(BUDGET, increment_um=100.0)
    assert "largest cause" not in page_of(tmp_path, small)


def test_causes_that_act_on_each_other_are_named(tmp_path: Path) -> None:
    text = page_of(tmp_path)
    assert f"by more than that: {FIRST.cause}, {SECOND.cause}.</p>" in text
    alone = [replace(share, interacts=False, combined_um=None) for share in BUDGET.shares]
    apart = page_of(tmp_path, replace(BUDGET, shares=tuple(alone)))
    assert "An increment of the encoder is 0.0100 um.</p>" in apart


@pytest.mark.parametrize(
    ("left_um", "quantum_um", "words"),
    [
        (0.5, 1.0, ""),
        (1.5, 1.0, "the way in a cycle of the PLC and one of the CNC (1.0000 um)"),
        (-1.5, 1.0, "the way in a cycle of the PLC and one of the CNC (1.0000 um)"),
        (0.5, 0.0, "an increment (0.0100 um)"),
        (0.005, 0.0, ""),
    ],
)
def test_what_is_left_is_explained_up_to_what_nobody_can_know(
    left_um: float, quantum_um: float, words: str, tmp_path: Path
) -> None:
    text = page_of(tmp_path, replace(BUDGET, left_um=left_um, quantum_um=quantum_um))
    found = re.findall(r"<strong>not explained: (\S+) um are left .*?more than (.*?):", text)
    assert found == ([(f"{left_um:+.4f}", words)] if words else [])


def results_of(folder: Path, *runs: tuple[str, str]) -> Path:
    """A results folder with some runs and the hash of their frames."""
    rows = "".join(f"{run},pass,{frames}\n" for run, frames in runs)
    (folder / "cases.csv").write_text(f"run,verdict,frame_log_sha256\n{rows}", encoding="utf-8")
    (folder / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    return folder


def test_a_budget_is_put_beside_its_run(tmp_path: Path) -> None:
    """A later one replaces it; the folder has one for each run."""
    folder = results_of(tmp_path, ("p-b", "cd" * 32), ("p-a", "ab" * 32))
    other = replace(BUDGET, run="p-b", frame_log_sha256="cd" * 32)
    for budget in (BUDGET, replace(BUDGET, left_um=0.25), other):
        path = add_budget(folder, budget)
        assert path == folder / "budgets" / f"{budget.run}.csv"
        with path.open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert {row["run"] for row in rows} == {budget.run}
        assert float(rows[-1]["in_turn_um"]) == budget.left_um
    assert sorted(path.name for path in (folder / "budgets").iterdir()) == ["p-a.csv", "p-b.csv"]


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ([("p-a", "cd" * 32)], "the results folder has other frames than this budget"),
        ([("p-b", "ab" * 32)], "the results folder has no such run"),
        ([("p-b", "ab" * 32), ("p-a", "")], "the results folder has other frames than this budget"),
        ([], "the results folder has no such run"),
    ],
)
def test_a_budget_of_another_run_is_refused(
    runs: list[tuple[str, str]], words: str, tmp_path: Path
) -> None:
    """Nothing is written then."""
    with pytest.raises(UserError) as refused:
        add_budget(results_of(tmp_path, *runs), BUDGET)
    found = refused.value
    assert (found.message, found.file, found.value) == (words, str(tmp_path), "p-a")
    assert "run the row with the same settings" in str(found)
    assert not (tmp_path / "budgets").exists()


@pytest.mark.parametrize("name", ["b.pdf", "b", "b.csv.gz"])
def test_a_budget_of_another_ending_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(UserError) as refused:
        write_budget(tmp_path / name, BUDGET)
    assert (refused.value.message, refused.value.allowed) == ("no kind of a budget", ".csv, .html")
    assert list(tmp_path.iterdir()) == []
    assert write_budget(tmp_path / "B.CSV", BUDGET).is_file()


def test_what_a_cause_has_no_number_for_is_an_empty_cell(tmp_path: Path) -> None:
    """In the page as in the file: 0 would be a number."""
    rows = re.findall(r"<tr><th scope=\"row\">(.*?)</th>(.*?)</tr>", page_of(tmp_path), re.DOTALL)
    cells = {name: re.findall(r"<td[^>]*>(.*?)</td>", row) for name, row in rows}
    # alone, in turn, mean, closed form
    assert cells[THIRD.cause][2:6] == ["-1.0000", "-1.0000", "", "-1.0000"]
    assert cells[FIRST.cause][2:6] == ["+8.0000", "+5.0000", "+6.5000", ""]
    left = [row for name, row in cells.items() if name not in (FIRST.cause, SECOND.cause,
                                                               THIRD.cause)]  # fmt: skip
    assert [row[2:6] for row in left] == [["", "+0.5000", "", ""]]
    with write_budget(tmp_path / "b.csv", BUDGET).open(encoding="utf-8") as file:
        stored = list(csv.DictReader(file))
    assert [row["closed_form_um"] for row in stored] == ["", "", "-1.0", ""]
    assert [row["combined_um"] for row in stored] == ["6.5", "3.5", "", ""]
