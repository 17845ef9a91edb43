"""What `junit.xml` has of a run besides its outcome: its place, its properties, its words."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.stored import CASE_COLUMNS, RESULT_COLUMNS, Said, StoredRun


def check(metric: str = "lag_mm_max", reference: str = "", **more: str) -> dict[str, str]:
    cells = {"check": "<= 1", "value": "0.5", "upper": "1", "verdict": "pass", "uncertainty": "0"}
    return {**cells, "metric": metric, "reference": reference, **more}


def run(name: str, *checks: Mapping[str, str], said: Said | None = None, **cells: str) -> StoredRun:
    row = {"plan": "p", "case": name, "run": f"p-{name}", "verdict": "pass", "sim_s": "1.25"}
    row |= {"wall_s": "0.5", "seed": "7", "frame_log_sha256": "ab"}
    return StoredRun({**row, **cells}, checks, None, None, said or Said(None, (), ()))


def written(place: Path, *runs: StoredRun, **plans: str) -> ElementTree.Element:
    listed = [{"name": name, "path": path, "sha256": "f0"} for name, path in plans.items()]
    (place / "manifest.json").write_text(json.dumps({"plans": listed}), encoding="utf-8")
    return ElementTree.parse(write_junit(place, runs)).getroot()


@pytest.mark.parametrize(
    ("references", "path", "found"),
    [
        (["p.csv:4"], "plans/p.csv", {"file": "plans/p.csv", "line": "4"}),
        (["p.csv:4", "p.csv:9"], "plans/p.csv", {"file": "plans/p.csv", "line": "4"}),
        # The check of alarms that a row does not give has no line
        (["no alarm unless a row expects it", "p.csv:4"], "p.csv", {"file": "p.csv", "line": "4"}),
        (["ISO 230-10: 2016", "p.csv:4"], "p.csv", {"file": "p.csv", "line": "4"}),
        (["norm:a", "rows.csv:12"], "p.csv", {"file": "rows.csv", "line": "12"}),
        ([":4"], "plans/p.csv", {"file": "plans/p.csv"}),
        (["p.csv:"], "plans/p.csv", {"file": "plans/p.csv"}),
        ([], "plans/p.csv", {"file": "plans/p.csv"}),
        ([], None, {}),
        (["p.csv:4"], None, {"file": "p.csv", "line": "4"}),
        (["p.xlsx:3"], "C:\\plans\\p.xlsx", {"file": "C:/plans/p.xlsx", "line": "3"}),
    ],
)
def test_the_place_of_a_run_is_that_of_its_first_check_with_a_line(
    tmp_path: Path, references: list[str], path: str | None, found: dict[str, str]
) -> None:
    one = run("a", *(check(reference=text) for text in references))
    (case,) = written(tmp_path, one, **({} if path is None else {"p": path})).iter("testcase")
    assert {name: case.get(name) for name in ("file", "line") if name in case.attrib} == found


def test_a_plan_that_has_probes_alone_is_a_suite_without_cases(tmp_path: Path) -> None:
    """What a campaign leaves that was broken off while its row searched."""
    probe = run("s-s01", check(), probe="p-s", verdict="fail", timestamp="2026-11-29T02:00:01")
    root = written(tmp_path, probe, run("b", check(), plan="q", run="q-b"))
    p, q = root.findall("testsuite")
    assert (p.get("name"), len(p), q.get("name"), len(q)) == ("p", 0, "q", 1)
    assert {name: p.get(name) for name in ("tests", "failures", "errors", "skipped", "time")} == {
        **dict.fromkeys(("tests", "failures", "errors", "skipped"), "0"), "time": "0.000",
    }  # fmt: skip
    assert "timestamp" not in p.attrib


def test_a_name_loses_the_name_of_its_plan_once_and_at_its_begin(tmp_path: Path) -> None:
    root = written(tmp_path, run("p-a"), run("b-p-c"), run("x", run="other"))
    assert [one.get("name") for one in root.iter("testcase")] == ["p-a", "b-p-c", "other"]
    assert {one.get("classname") for one in root.iter("testcase")} == {"p"}


def test_properties_are_what_the_row_has_and_then_those_of_its_checks(tmp_path: Path) -> None:
    """In the order of the list; what is empty is left out of the row, not of a check."""
    one = run(
        "a",
        check("lag_mm_max:Z", unit="mm", lower="-1", uncertainty="0.25", verdict="marginal"),
        check("alarms", value="", upper="", unit=""),
        requirement="REQ-1", program="nc/a.nc", rig="", verdict="marginal",
        **{"info:serial": "0042", "info:by": "", "info:order": "7", "title": "none"},
    )  # fmt: skip
    (case,) = written(tmp_path, one).iter("testcase")
    found = [(each.get("name"), each.get("value")) for each in case.iter("property")]
    assert found == [
        ("verdict", "marginal"), ("seed", "7"), ("requirement", "REQ-1"), ("program", "nc/a.nc"),
        ("sim_s", "1.25"), ("frame_log_sha256", "ab"), ("serial", "0042"), ("order", "7"),
        ("lag_mm_max:Z.value", "0.5"), ("lag_mm_max:Z.lower", "-1"), ("lag_mm_max:Z.upper", "1"),
        ("lag_mm_max:Z.unit", "mm"), ("lag_mm_max:Z.uncertainty", "0.25"),
        ("lag_mm_max:Z.verdict", "marginal"), ("alarms.value", ""), ("alarms.lower", ""),
        ("alarms.upper", ""), ("alarms.unit", ""), ("alarms.uncertainty", "0"),
        ("alarms.verdict", "pass"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("messages", "log", "text"),
    [
        (["Z 67.0", "done"], ["alarm 1"], "Z 67.0\ndone\nalarm 1"),
        ([], ["alarm 1"], "alarm 1"),
        (["Z 67.0"], [], "Z 67.0"),
        ([], [], None),
    ],
)
def test_what_a_program_printed_comes_before_what_the_run_has_to_say(
    tmp_path: Path, messages: list[str], log: list[str], text: str | None
) -> None:
    one = run("a", said=Said(None, messages, log))
    (case,) = written(tmp_path, one).iter("testcase")
    assert case.findtext("system-out") == text


AWKWARD = "a & b < c > \"d\" 'e'\tf\ng\r\x00\x1b\ufffe \U0001f527"


def test_signs_of_xml_come_back_as_they_were_and_others_are_replaced(tmp_path: Path) -> None:
    """XML 1.0, 2.2: neither 0 nor ESC nor FFFE is a character of it."""
    bad = "\N{REPLACEMENT CHARACTER}"
    wanted = AWKWARD.replace("\x00", bad).replace("\x1b", bad).replace("\ufffe", bad)
    one = run("a", requirement=AWKWARD, said=Said(None, [AWKWARD], ()))
    (case,) = written(tmp_path, one).iter("testcase")
    found = {each.get("name"): each.get("value") for each in case.iter("property")}
    assert found["requirement"] == wanted
    # In a text a reader makes one end of line of each kind (XML 1.0, 2.11)
    assert case.findtext("system-out") == wanted.replace("\r", "\n")


@pytest.mark.parametrize(
    ("verdict", "error", "tag", "lines"),
    [
        ("fail", None, "failure", ["fail: m1 ", "inconclusive: m3 "]),
        ("error", "it broke", "error", ["it broke", "fail: m1 ", "inconclusive: m3 "]),
        ("aborted", "stopped", "error", ["stopped", "fail: m1 ", "inconclusive: m3 "]),
        ("inconclusive", None, "failure", ["fail: m1 ", "inconclusive: m3 "]),
    ],
)
def test_an_outcome_names_its_reason_first_and_each_check_that_is_not_good(
    tmp_path: Path, verdict: str, error: str | None, tag: str, lines: list[str]
) -> None:
    checks = [
        check(f"m{n}", value="2", verdict=word)
        for n, word in enumerate(("pass", "fail", "marginal", "inconclusive"))
    ]
    one = run("a", *checks, verdict=verdict, said=Said(error, (), ()))
    (case,) = written(tmp_path, one).iter("testcase")
    outcome: Any = case.find(tag)
    assert outcome is not None
    assert outcome.get("type") == verdict
    found = outcome.text.splitlines()
    assert outcome.get("message") == found[0]
    assert len(found) == len(lines)
    assert all(line.startswith(begin) for line, begin in zip(found, lines, strict=True))
    assert (found[0] == error) is (error is not None)


def test_without_runs_the_folder_is_read(tmp_path: Path) -> None:
    row = dict.fromkeys(CASE_COLUMNS, "") | {"run": "p-a", "plan": "p", "verdict": "pass"}
    row |= {"sim_s": "1", "wall_s": "2"}
    text = ",".join(CASE_COLUMNS) + "\n" + ",".join(row.values()) + "\n"
    (tmp_path / "cases.csv").write_text(text, encoding="utf-8")
    (tmp_path / "results.csv").write_text(",".join(RESULT_COLUMNS) + "\n", encoding="utf-8")
    (suite,) = ElementTree.parse(write_junit(tmp_path)).getroot()
    assert (suite.get("tests"), suite.get("time")) == ("1", "2.000")
    assert list(ElementTree.parse(write_junit(tmp_path, [])).getroot()) == []


def test_a_suite_is_as_long_as_all_its_runs_and_began_with_the_first(tmp_path: Path) -> None:
    """Also of runs that their plan has no more; times are without their zone, which is UTC."""
    runs = [
        run("a", timestamp="2026-11-29T02:00:07+00:00"),
        run("b", in_plan="no", timestamp="2026-11-29T02:00:05+00:00", wall_s="1.25"),
        run("c", timestamp=""), run("d", wall_s="0.0004"),
    ]  # fmt: skip
    (suite,) = written(tmp_path, *runs)
    assert (suite.get("time"), suite.get("timestamp")) == ("2.250", "2026-11-29T02:00:05")
    found = [(one.get("time"), one.get("timestamp")) for one in suite]
    assert found == [
        ("0.500", "2026-11-29T02:00:07"), ("1.250", "2026-11-29T02:00:05"), ("0.500", None),
        ("0.000", None),
    ]  # fmt: skip
