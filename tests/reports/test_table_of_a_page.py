"""The page of a folder that has tables alone: its table of runs, boxes, notices, and contents."""

import json
import re
from collections.abc import Sequence
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from axisrig.reports.build import build_report

HEAD = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,title"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"


def page(place: Path, rows: Sequence[dict[str, str]], **manifest: Any) -> str:
    """rows: cells of `cases.csv`; a run has the verdict of its only check, m, with 1 um."""
    columns = dict.fromkeys([*HEAD.split(","), *(name for row in rows for name in row)], "")
    known = columns | {"plan": "p", "case": "c", "verdict": "pass", "sim_s": "1", "wall_s": "1"}
    cells = [known | {"run": f"p-r{number}"} | row for number, row in enumerate(rows)]
    cases = [",".join(columns), *(",".join(row[name] for name in columns) for row in cells), ""]
    checks = [CHECKS]
    checks += [f"{c['plan']},{c['case']},{c['run']},<= 9,m,1,um,,9,0,{c['verdict']},p.csv:2"
               for c in cells]  # fmt: skip
    (place / "cases.csv").write_text("\n".join(cases), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    if manifest:
        (place / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    return build_report(place).read_text(encoding="utf-8")


def table(text: str) -> list[tuple[str, str, str]]:
    """ID, verdict and first cell of each row."""
    found = re.findall(
        r'<tbody id="([^"]*)" data-verdict="(\w+)".*?<th scope="row">(.*?)</th>', text, re.DOTALL
    )
    return [
        (run, verdict, unescape(" ".join(re.sub("<[^>]*>", " ", cell).split())))
        for run, verdict, cell in found
    ]


@pytest.mark.long
@pytest.mark.parametrize(
    ("plans", "cells"),
    [
        (("p", "p"), ["r0", "r1 Twice"]),
        (("p", "q"), ["r0 p", "p-r1 q Twice"]),  # a run of another plan keeps its whole name
    ],
)
def test_a_row_names_its_plan_where_there_are_several(
    tmp_path: Path, plans: tuple[str, str], cells: list[str]
) -> None:
    rows = [{"plan": plans[0]}, {"plan": plans[1], "title": "Twice"}]
    text = page(tmp_path, rows)
    assert [cell for _, _, cell in table(text)] == cells
    assert f"<title>pass · {', '.join(dict.fromkeys(plans))} · axisrig</title>" in text


@pytest.mark.long
def test_rows_are_in_the_order_of_the_folder_with_all_that_is_searched(tmp_path: Path) -> None:
    rows = [{"verdict": "fail", "plc:V.E.A": "3"}, {"verdict": "pass", "title": "<b>"},
            {"verdict": "error"}]  # fmt: skip
    text = page(tmp_path, rows)
    assert [row[:2] for row in table(text)] == [
        ("p-r0", "fail"), ("p-r1", "pass"), ("p-r2", "error"),
    ]  # fmt: skip
    searched = dict(re.findall(r'data-run="([^"]*)"[^>]*data-find="([^"]*)"', text))
    assert searched["p-r0"].split() == ["p-r0", "plc:v.e.a=3", "m"]
    assert "&lt;b&gt;" in searched["p-r1"]
    boxes = re.findall(r'<input type="checkbox" value="(\w+)" checked>', text)
    assert boxes == ["pass", "fail", "error"]  # of what there is, the best first


@pytest.mark.long
def test_tiles_count_rows_and_probes_are_in_the_table_alone(tmp_path: Path) -> None:
    rows = [{}, {"verdict": "fail"}, {"verdict": "fail", "probe": "p-r0"}, {"verdict": "fail"}]
    text = page(tmp_path, rows)
    tiles = re.findall(r'<li class="tile v-(\w+)"><b>(\d+)</b>', text)
    assert tiles == [("pass", "1"), ("fail", "2")]
    assert "Did not pass: 2 of 3 runs" in text
    assert len(table(text)) == 4
    assert re.findall(r'<article class="card[^"]*" data-run="([^"]*)"', text) == ["p-r1"]


@pytest.mark.long
@pytest.mark.parametrize("missing", [0, 2])
def test_an_interrupted_campaign_says_how_many_rows_it_lacks(tmp_path: Path, missing: int) -> None:
    text = page(tmp_path, [{}, {}], runs_planned=2 + missing)
    words = f"<b>Interrupted:</b> {missing} of {2 + missing} planned runs left no result."
    assert (words in text) is bool(missing)


@pytest.mark.long
@pytest.mark.parametrize("is_bad", [False, True])
def test_contents_name_what_the_page_has(tmp_path: Path, is_bad: bool) -> None:
    """Coverage where there is a requirement; a metric that never changes is no sweep."""
    rows = [{"plc:V.E.A": str(n), "requirement": "R-1",
             "verdict": "fail" if is_bad and not n else "pass"} for n in range(3)]  # fmt: skip
    text = page(tmp_path, rows)
    contents = re.search(r'<nav class="contents".*?</nav>', text, re.DOTALL)
    assert contents is not None
    places = re.findall(r'href="#(\w+)">', contents[0])
    first = ["failures_title"] if is_bad else []
    assert places == [*first, "summary_title", "coverage_title", "glossary_title"]
    for place in places:
        assert f'id="{place}"' in text


@pytest.mark.long
@pytest.mark.parametrize(
    ("rows", "facts"),
    [
        ([{"sim_s": "2"}, {"sim_s": "0.5"}], "2.500 s in 2 runs"),
        # A row about several runs has the time of these; a probe has run by itself
        ([{"sim_s": "2"}, {"sim_s": "8", "runs": "2"}], "2.000 s in 1 run"),
        ([{"sim_s": "8", "runs": "2", "search:plc:V.E.A": "1 .. 2"},
          {"sim_s": "3", "probe": "p-r0", "plc:V.E.A": "1"},
          {"sim_s": "4", "probe": "p-r0", "plc:V.E.A": "2"}], "7.000 s in 2 runs"),
    ],
)  # fmt: skip
def test_simulated_time_is_that_of_all_that_ran(
    tmp_path: Path, rows: list[dict[str, str]], facts: str
) -> None:
    text = page(tmp_path, rows)
    assert re.findall(r"<dt>simulated</dt><dd>([^<]*)</dd>", text) == [facts]
    assert "<dt>on a real bus</dt>" not in text


@pytest.mark.long
@pytest.mark.parametrize("word", ["pass", "fail"])
def test_a_map_has_rows_and_no_probes(tmp_path: Path, word: str) -> None:
    """The row that searches has the verdict of its probes."""
    rows = [{"verdict": word, "runs": "1", "search:plc:V.E.A": "1 .. 2"},
            {"probe": "p-r0", "plc:V.E.A": "1"}]  # fmt: skip
    text = page(tmp_path, rows)
    (cells,) = re.findall(r'"runs":(\[\[.*?\]\])', text)
    assert [run for run, _ in json.loads(cells)] == ["p-r0"]
