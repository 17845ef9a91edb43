"""The waterfall of an error budget and the table of its causes on a card."""

import csv
import re
from pathlib import Path

import pytest
from tests.reports.swept import numbers

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.reports.budget.drawing import LEFT, RIGHT, WIDTH, waterfall
from axisrig.reports.budget.section import COLUMNS, budget_path, budget_rows, budget_section

RECT = r'<rect class="(fall-\w+)" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)"'


def test_each_bar_begins_where_the_one_before_ends_and_the_last_is_the_sum() -> None:
    """4, then -6 and 3: to 4, -2 and 1; in um from -2 to 4 over the field."""
    text = waterfall([("a", 4.0), ("<b>", -6.0), ("c", 3.0)], 1.0)
    bars = [(kind, float(x), float(y), float(w)) for kind, x, y, w in re.findall(RECT, text)]
    per_um = (WIDTH - RIGHT - LEFT) / 6
    zero = LEFT + 2 * per_um
    expected = [("fall-more", 0, 4), ("fall-less", -2, 4), ("fall-more", -2, 1), ("fall-sum", 0, 1)]
    for (kind, x, _, width), (name, low, high) in zip(bars, expected, strict=True):
        assert kind == name
        assert (x, x + width) == pytest.approx((zero + low * per_um, zero + high * per_um), abs=0.2)
    tops = [bar[2] for bar in bars]
    assert tops == sorted(set(tops))  # one below the other
    assert re.findall(r"y=\"[\d.]+\">([+-][\d.]+) um<", text) == [
        "+4.0000",
        "-6.0000",
        "+3.0000",
        "+1.0000",
    ]
    assert re.findall(r'text-anchor="end">([^<]*)<', text) == [
        "a",
        "&lt;b&gt;",
        "c",
        "published value",
    ]
    (x1, x2) = numbers(r'class="fall-zero" x1="([\d.]+)" x2="([\d.]+)"', text)[0]
    assert x1 == x2 == pytest.approx(zero, abs=0.06)


def test_a_cause_that_adds_nothing_can_be_seen() -> None:
    text = waterfall([("a", 0.0), ("b", -2.0)], -2.0)
    assert [kind for kind, *_ in re.findall(RECT, text)] == ["fall-less", "fall-less", "fall-sum"]
    assert float(re.findall(RECT, text)[0][3]) == 1.0
    assert "+0.0000 um" in waterfall([("a", -0.00001)], 0.0)


def row(**cells: str) -> dict[str, str]:
    return {"cause": "c", "setting": "s", "effect": "random", "alone_um": "1", "in_turn_um": "-2",
            "closed_form_um": "", "bound_um": "", "meaning": "m", **cells}  # fmt: skip


@pytest.mark.parametrize(
    ("cells", "shown"),
    [
        ({}, ["s", "random", "+1.0000", "-2.0000", "", "", "m"]),
        ({"closed_form_um": "-2.5"}, ["s", "random", "+1.0000", "-2.0000", "", "-2.5000", "m"]),
        ({"closed_form_um": "9", "bound_um": "0.5"},
         ["s", "random", "+1.0000", "-2.0000", "", "&plusmn; 0.5000", "m"]),
        ({"closed_form_um": "-2.5", "differs_um": "0.5"},
         ["s", "random", "+1.0000", "-2.0000", "", "-2.5000, differs by +0.5000", "m"]),
        ({"combined_um": "0", "term": "t <x>", "alone_um": "", "in_turn_um": "-0.00001"},
         ["s", "random, t &lt;x&gt;", "", "+0.0000", "+0.0000", "", "m"]),
        ({"effect": "", "term": "t"}, ["s", "t", "+1.0000", "-2.0000", "", "", "m"]),
    ],
)  # fmt: skip
def test_a_cause_in_the_table_of_a_card(cells: dict[str, str], shown: list[str]) -> None:
    text = budget_rows([row(**cells)])
    assert re.findall(r"<td[^>]*>(.*?)</td>", text) == shown


@pytest.mark.parametrize(("frames", "is_shown"), [("ab", True), ("cd", False)])
def test_a_budget_of_other_frames_is_not_drawn(tmp_path: Path, frames: str, is_shown: bool) -> None:
    """What is left is the first bar, the published value is the sum: -1.5 + 4 - 1."""
    run = StoredRun({"run": "r", "frame_log_sha256": "ab"}, [], None, None)
    assert budget_section(tmp_path, run) == ""
    path = budget_path(tmp_path, "r")
    assert path == tmp_path / "budgets" / "r.csv"
    path.parent.mkdir()
    causes = (("a", "4"), ("b", "-1"), ("left", "-1.5"))
    rows = [
        {"run": "r", "axis": "Z<", "frame_log_sha256": frames, **row(cause=name, in_turn_um=um)}
        for name, um in causes
    ]
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(rows)
    text = budget_section(tmp_path, run)
    assert ("made of other frames" in text) is not is_shown
    if is_shown:
        assert "axis Z&lt;" in text
        names = re.findall(r'text-anchor="end">([^<]*)<', text)
        assert names == ["left", "a", "b", "published value"]
        assert "published value +1.5000 um" in text


@pytest.mark.parametrize("frames", [("ab", "cd"), ("cd", "ab"), ("cd", "cd"), ()])
def test_a_budget_is_of_one_run_in_all_its_rows(tmp_path: Path, frames: tuple[str, ...]) -> None:
    """A row of other frames, wherever it is, and a table without rows: made again."""
    run = StoredRun({"run": "r", "frame_log_sha256": "ab"}, [], None, None)
    path = budget_path(tmp_path, "r")
    path.parent.mkdir()
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(
            {"run": "r", "axis": "Z", "frame_log_sha256": sha, **row()} for sha in frames
        )
    text = budget_section(tmp_path, run)
    assert "made of other frames" in text
    assert "<svg" not in text


def test_a_run_that_was_taken_over_has_the_budget_of_its_recording(tmp_path: Path) -> None:
    """The table is named as the run whose recording it is."""
    run = StoredRun({"run": "new", "recording": "old", "frame_log_sha256": "ab"}, [], None, None)
    path = budget_path(tmp_path, run.recorded)
    path.parent.mkdir()
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerow({"run": "old", "axis": "Y", "frame_log_sha256": "ab", **row()})
    assert "Budget of the measured value, axis Y" in budget_section(tmp_path, run)


def test_the_published_value_is_the_error_and_not_the_sum_of_its_causes() -> None:
    """5, -1 and 3 are 7, and 6.5 were published: what is missing can be seen."""
    text = waterfall([("a", 5.0), ("b", -1.0), ("c", 3.0)], 6.5)
    found = re.findall(RECT, text)
    assert [kind for kind, *_ in found] == ["fall-more", "fall-less", "fall-more", "fall-sum"]
    per_um = (WIDTH - RIGHT - LEFT) / 7
    ends = [(float(x), float(x) + float(width)) for _, x, _, width in found]
    expected = [(0, 5), (4, 5), (4, 7), (0, 6.5)]
    for end, (low, high) in zip(ends, expected, strict=True):
        assert end == pytest.approx((LEFT + low * per_um, LEFT + high * per_um), abs=0.2)
    assert (
        'aria-label="a +5.0000 um; b -1.0000 um; c +3.0000 um; published value +6.5000 um"' in text
    )


def test_causes_below_0_are_less_wherever_they_end() -> None:
    text = waterfall([("a", -4.0), ("b", 1.0), ("c", -2.0)], -5.0)
    kinds = [kind for kind, *_ in re.findall(RECT, text)]
    assert kinds == ["fall-less", "fall-more", "fall-less", "fall-sum"]
    (x1, _) = numbers(r'class="fall-zero" x1="([\d.]+)" x2="([\d.]+)"', text)[0]
    assert x1 == pytest.approx(WIDTH - RIGHT, abs=0.06)  # nothing is above 0
