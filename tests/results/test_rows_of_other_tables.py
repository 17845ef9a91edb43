"""Tables, trends and differences where two things that look alike are beside each other."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.results.test_frames_by_time import folder_of
from tests.results.test_lines_of_a_trend import cases, folder, run
from tests.results.test_pairs import compared
from tests.results.test_pictures_of_a_comparison import RIGHT_PX, line, polylines
from tests.results.test_sources_of_a_study import line as fitted
from tests.results.test_sources_of_a_study import point, results

from axisrig.bench.campaign.results.stored import RECORDING, read_results
from axisrig.results.compare.changes import changes
from axisrig.results.compare.drawing import overlay
from axisrig.results.compare.trend import trend
from axisrig.results.loading import load
from axisrig.results.sources import METRIC, OF_STOP, source_rows

# Comparisons


@pytest.mark.parametrize(("before", "after"), [((1.0, 2.0), (4.0, 6.0, 8.0)),
                                               ((4.0, 6.0, 8.0), (1.0, 2.0))])  # fmt: skip
def test_a_shift_has_the_number_and_the_mean_of_each_folder(
    tmp_path: Path, before: Sequence[float], after: Sequence[float]
) -> None:
    def side(values: Sequence[float]) -> dict[str, Any]:
        return {
            "runs": [{"run": f"r{n}", "frame_log_sha256": f"h{n}"} for n in range(len(values))],
            "checks": [{"run": f"r{n}", "value": str(value)} for n, value in enumerate(values)],
        }

    (shift,) = compared(tmp_path, side(before), side(after)).shifts
    assert shift.n == (len(before), len(after))
    assert shift.means == (sum(before) / len(before), sum(after) / len(after))


def test_a_check_that_only_one_folder_asks_for_is_no_other_cell(tmp_path: Path) -> None:
    """What is asked of the same metric is one; without a condition on one side it is one too."""
    both = [
        {"runs": [{"run": "r"}], "checks": [{"metric": name, "check": asked} for name, asked in of]}
        for of in ((("m", "<= 1"), ("old", "<= 5"), ("open", "")),
                   (("m", "<= 2"), ("new", "<= 5"), ("open", "<= 3")))
    ]  # fmt: skip
    found = compared(tmp_path, *both)
    stored = [read_results(tmp_path / str(n)) for n in (0, 1)]
    assert dict(changes(*stored, found.pairs))["the plan"] == [
        "check:m <= 1 -> <= 2", "check:open (empty) -> <= 3",
    ]  # fmt: skip


@pytest.mark.parametrize("turn", [1, -1])
def test_a_picture_of_two_lines_is_as_wide_as_both_whichever_begins_first(turn: int) -> None:
    """5 to 10 inside 0 to 20: the longer line goes from edge to edge."""
    short, long = ("short", line([5, 10], [0, 1])), ("long", line([0, 20], [0, 1]))
    found = polylines(overlay("s", dict([short, long][::turn]), ("0", "20")))
    inner, outer = [found[kind] for kind in ("cmp-before", "cmp-after")][::turn]
    (left, _), (right, _) = outer
    assert right == RIGHT_PX
    across = [(x - left) / (right - left) for x, _ in inner]
    assert across == pytest.approx([0.25, 0.5], abs=2e-3)


# Trends


def test_a_row_about_several_runs_sweeps_no_input() -> None:
    """Its cells are empty: the runs of its case are all alike, and are followed together."""
    runs = [run("r1", "1"), run("r2", "3")]
    about = run("p-c", "2", metric="mean(m)", at=("", ""), runs="2")
    for rows in ([*runs, about], [about, *runs]):
        assert cases(trend([folder("a", *rows)], "m")) == {"p-c": [(0, 2, 2.0)]}
        assert cases(trend([folder("a", *rows)], "mean(m)")) == {"p-c": [(0, 1, 2.0)]}


def test_a_row_about_several_runs_has_the_name_of_its_case_where_inputs_are_swept() -> None:
    runs = [run("r1", "1", at=("1", "x")), run("r2", "3", at=("2", "x"))]
    about = run("p-c", "2", metric="mean(m)", at=("", ""), runs="2")
    assert cases(trend([folder("a", *runs, about)], "mean(m)")) == {"p-c": [(0, 1, 2.0)]}
    assert cases(trend([folder("a", *runs, about)], "m")) == {
        "p-c at V.E.A 1": [(0, 1, 1.0)], "p-c at V.E.A 2": [(0, 1, 3.0)],
    }  # fmt: skip


# Studies of sources


def test_a_range_is_that_of_the_metric_of_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Latch and fixed stop of one run, each with its own: 0.7 um and 0.004 mm."""
    latch = fitted(point("a", 10.0, 9.0))
    stop = fitted(point("a", 10.0, 100.25), metric=OF_STOP, intercept="100 +- 1")
    both = results(monkeypatch, latch, stop)
    ranges = {METRIC: 0.7, OF_STOP: 0.004}
    for order in (1, -1):
        for one in both.runs:
            one.checks = [type(one.checks[0])(metric=f"range({name})", number=number)
                          for name, number in [*ranges.items()][::order]]  # fmt: skip
        first, second = source_rows(both)
        assert (first.range_um, second.range_um) == pytest.approx((0.7, 4.0))


# Tables


def table(place: Path, rows: Sequence[Mapping[str, str]]) -> Path:
    place.mkdir(exist_ok=True)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with (place / "cases.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)
    (place / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    return place


def test_only_inputs_become_numbers(tmp_path: Path) -> None:
    """A serial number, a requirement and a note may have digits alone: a 0 in front stays."""
    words = {"info:serial": "007", "note:day": "0101", "requirement": "0042", "tags": "1"}
    rows = [{"run": name, "verdict": "pass", "plc:V.E.A": "007", **words} for name in ("a", "b")]
    cases_of = load(table(tmp_path, rows)).cases
    for name, text in words.items():
        assert cases_of[name].tolist() == [text, text], name
    assert cases_of["plc:V.E.A"].tolist() == [7.0, 7.0]


def test_frames_are_those_of_the_recording_that_a_run_shares(tmp_path: Path) -> None:
    """A row that was judged again, or that ran as another one, has no log of its own name."""
    place = folder_of(tmp_path, ["(0.000001) a 181#01"])
    table(place, [{"run": "r", "verdict": "pass"},
                  {"run": "again", "verdict": "pass", RECORDING: "r"}])  # fmt: skip
    found = load(place)
    assert found.frames("again")["data"].tolist() == found.frames("r")["data"].tolist() == ["01"]


def test_a_folder_whose_tables_have_no_row_has_their_columns(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("run,verdict\n", encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    found = load(tmp_path)
    assert {"run", "verdict", "plan", "case", "seed"} <= set(found.cases.columns)
    assert {"run", "metric", "value", "text", "unit", "verdict"} <= set(found.checks.columns)
    assert (len(found.cases), len(found.checks)) == (0, 0)
