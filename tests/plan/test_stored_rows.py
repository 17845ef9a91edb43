"""Tables and runs of a results folder as they are read back, and what they may hold."""

import json
from pathlib import Path
from typing import Any

import pytest
from tests.recordings import facts

from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    IN_PLAN,
    LATER_COLUMNS,
    PROBE,
    RECORDED_IN,
    RECORDING,
    RECORDINGS,
    RESULT_COLUMNS,
    RUNS,
    Said,
    StoredResults,
    StoredRun,
    check_cells,
    is_results_folder,
    read_manifest,
    read_results,
    read_rows,
)
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import VERSION, MessageRecord, RunFile
from axisrig.kernel.errors import UserError

HEAD = "run,verdict,note"
COLUMNS = ("run", "verdict")


def table(place: Path, text: str) -> Path:
    path = place / "cases.csv"
    path.write_bytes(text.encode())
    return path


# Tables


def test_a_table_is_read_with_or_without_the_mark_of_spreadsheets(tmp_path: Path) -> None:
    """Empty lines are no rows; a cell may hold an end of line."""
    text = f'{HEAD}\r\na,pass,"two\nlines"\r\n\r\nb,fail,\r\n'
    for mark in ("", "\ufeff"):
        header, rows = read_rows(table(tmp_path, mark + text), COLUMNS)
        assert header == HEAD.split(",")
        assert rows == [
            {"run": "a", "verdict": "pass", "note": "two\nlines"},
            {"run": "b", "verdict": "fail", "note": ""},
        ]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("run,note\na,\n", 1, "the column verdict is missing or there twice"),
        ("run,verdict,run\na,pass,b\n", 1, "the column run is missing or there twice"),
        ("", 1, "the column run is missing or there twice"),
        (f"{HEAD}\na,pass,\nb,pass\n", 3, "2 cells, the header has 3"),
        (f"{HEAD}\na,pass,,\n", 2, "4 cells, the header has 3"),
        (f'{HEAD}\na,pass,"x\ny"\nb,pass\n', 4, "2 cells"),
        (f"{HEAD}\na,passed,\n", 2, "verdict 'passed' is no verdict"),
        (f"{HEAD}\na b,pass,\n", 2, "run 'a b' is no run id"),
    ],
)
def test_a_damaged_table_is_named_with_its_line(
    tmp_path: Path, text: str, line: int, words: str
) -> None:
    with pytest.raises(UserError) as caught:
        read_rows(table(tmp_path, text), COLUMNS)
    assert (caught.value.line, words in caught.value.message) == (line, True)


def test_bytes_of_no_text_are_a_damaged_table(tmp_path: Path) -> None:
    path = tmp_path / "cases.csv"
    path.write_bytes(b"run,verdict\n\xff\xfe,pass\n")
    with pytest.raises(UserError, match="the results folder is damaged"):
        read_rows(path, COLUMNS)


@pytest.mark.parametrize(
    ("end", "is_whole", "runs"),
    [
        ("c,pass,\n", True, ["a", "b", "c"]),
        ("c,pass,\n", False, ["a", "b", "c"]),
        ("c,pass,x", True, ["a", "b", "c"]),  # an editor has left the last end of line out
        ("c,pass,x", False, ["a", "b"]),  # it may go on behind x
        ("c,pa", False, ["a", "b"]),
        ("", False, ["a", "b"]),
    ],
)
def test_a_row_that_was_broken_off_counts_only_in_a_finished_campaign(
    tmp_path: Path, end: str, is_whole: bool, runs: list[str]
) -> None:
    path = table(tmp_path, f"{HEAD}\na,pass,\nb,fail,\n{end}")
    rows = read_rows(path, COLUMNS, is_whole=is_whole)[1]
    assert [row["run"] for row in rows] == runs


def test_a_run_is_once_in_the_table_of_cases_and_has_many_checks(tmp_path: Path) -> None:
    row = {**dict.fromkeys(CASE_COLUMNS, ""), "run": "a", "verdict": "pass", "sim_s": "1",
           "wall_s": "1"}  # fmt: skip
    text = ",".join(CASE_COLUMNS) + "\n" + (",".join(row.values()) + "\n") * 2
    with pytest.raises(UserError, match="the run a is there twice") as caught:
        read_rows(table(tmp_path, text), CASE_COLUMNS)
    assert caught.value.line == 3
    assert len(read_rows(table(tmp_path, f"{HEAD}\na,pass,\na,fail,\n"), COLUMNS)[1]) == 2


def test_what_a_table_of_another_tool_lacks_is_filled_in(tmp_path: Path) -> None:
    """A column, or a cell; a column that is there twice stays a mistake."""
    lacking = {"sim_s": "0", "note": "none"}
    path = table(tmp_path, "run,verdict,note\na,pass,\nb,pass,own\n")
    rows = read_rows(path, ("run", "verdict", "sim_s"), lacking=lacking)[1]
    assert [(row["sim_s"], row["note"]) for row in rows] == [("0", "none"), ("0", "own")]
    for text in ("run,verdict,sim_s,sim_s\na,pass,1,1\n", "run,note\na,\n"):
        with pytest.raises(UserError, match="is missing or there twice"):
            read_rows(table(tmp_path, text), ("run", "verdict", "sim_s"), lacking=lacking)


@pytest.mark.parametrize(
    ("column", "good", "bad"),
    [
        ("run", ("a", "a.b_c-1"), ("", "a/b", "a b", "\u00e4", "a\n")),
        (RECORDING, ("", "a"), ("a/b", " ")),
        ("verdict", tuple(verdict.word for verdict in Verdict), ("", "PASS", "passed", "0")),
        ("sim_s", ("0", "1.5", "1e-3"), ("", "-1", "nan", "inf", "1 s")),
        ("wall_s", ("0", "2"), ("-0.1", "nan", "inf")),
        ("uncertainty", ("0", "0.5", "inf"), ("", "-1", "nan", "-inf")),
        ("trace_sha256", ("", "a" * 64), ("a" * 63, "A" * 64, "g" * 64)),
        ("recording_sha256", ("", "0" * 64), ("0" * 65,)),
        ("bus_log_sha256", ("", f".blf:{'a' * 64}"), ("a" * 64, ".exe:" + "a" * 64)),
        ("title", ("", "../..", "nan"), ()),
    ],
)
def test_each_cell_has_its_form(column: str, good: tuple[str, ...], bad: tuple[str, ...]) -> None:
    for cell in good:
        check_cells(Path("cases.csv"), {column: cell})
    for cell in bad:
        with pytest.raises(UserError, match="is no"):
            check_cells(Path("cases.csv"), {column: cell}, 7)


# The manifest


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ('{"axisrig": "1", "runs_planned": 3}', True),
        ('{"axisrig": null, "runs_planned": 0}', True),
        ('{"axisrig": "1"}', False),
        ('{"runs_planned": 3}', False),
        ("{", False),
        ("[1]", False),
        (None, False),
    ],
)
def test_a_folder_is_one_of_results_by_its_manifest(
    tmp_path: Path, text: str | None, is_one: bool
) -> None:
    if text is not None:
        (tmp_path / "manifest.json").write_text(text, encoding="utf-8")
    assert is_results_folder(tmp_path) is is_one


@pytest.mark.parametrize(
    "entries",
    [{"missing": {"p": ["p-a", "../x"]}}, {"earlier": [{"runs": ["p-a"]}, {"runs": ["a/b"]}]}],
)
def test_names_in_a_manifest_are_run_ids(tmp_path: Path, entries: Any) -> None:
    path = tmp_path / "manifest.json"
    assert read_manifest(tmp_path) == {}
    path.write_text(json.dumps(entries), encoding="utf-8")
    with pytest.raises(UserError, match="is no run id"):
        read_manifest(tmp_path)
    path.write_text("[]", encoding="utf-8")
    with pytest.raises(UserError, match="no object"):
        read_manifest(tmp_path)


# Runs


def run_of(
    recording: RunFile | None = None, without: Said | None = None, **case: str
) -> StoredRun:  # fmt: skip
    """without: what is known of the run where its recording is not read."""
    made = StoredRun({"run": "p-a", "verdict": "pass", **case}, [], None, None, without)
    if recording is not None:
        made.__dict__["recording"] = recording  # as the cache of the property has it
    return made


def left(**entries: Any) -> RunFile:
    return RunFile(version=VERSION, **entries)


@pytest.mark.parametrize(
    ("recording", "error", "is_judged"),
    [
        (left(), None, False),
        (left(error="no rig"), "no rig", False),
        (left(facts=facts()), None, True),
        (left(facts=facts(), error="later"), "later", True),
        (left(facts=facts(unfinished="a plant fell"), error="other"), "a plant fell", False),
        (left(facts=facts(is_stopped=True, unfinished="x"), error="other"), STOPPED, False),
    ],
)
def test_a_run_says_why_it_ended(recording: RunFile, error: str | None, is_judged: bool) -> None:
    """That the operator stopped it comes before anything else."""
    stored = run_of(recording)
    assert stored.error == error
    assert (stored.judged_facts is not None) is is_judged


def test_a_run_has_the_words_of_its_recording_or_what_is_known_without_it() -> None:
    known = run_of(left(error="other"), Said("error", ["message"], ["line"]))
    assert (known.error, known.messages, known.log) == ("error", ["message"], ["line"])
    broken = run_of(left(error="x", log=("first", "second")))
    assert (broken.messages, broken.log) == ([], ["first", "second"])
    printed = (MessageRecord(None, (), "one"), MessageRecord(None, (), "two"))
    whole = run_of(left(facts=facts(messages=printed), log=("not this",)))
    assert whole.messages == ["one", "two"]
    assert "not this" not in whole.log


def test_kinds_of_rows_are_reported_by_their_cells() -> None:
    for cells, kinds in (
        ({}, (False, False, True)),
        ({RUNS: "", PROBE: "", IN_PLAN: ""}, (False, False, True)),
        ({RUNS: "3"}, (True, False, True)),
        ({PROBE: "p-s"}, (False, True, True)),
        ({IN_PLAN: "no"}, (False, False, False)),
    ):
        one = run_of(**cells)
        assert (one.is_statistic, one.is_probe, one.is_in_plan) == kinds


# A folder


def test_a_folder_is_as_bad_as_its_planned_runs_and_aborted_while_some_are_missing() -> None:
    """Neither a probe nor a run that the plan has no more counts."""
    runs = [
        run_of(run="p-a", verdict="marginal"),
        run_of(run="p-b", verdict="fail", **{IN_PLAN: "no"}),
        run_of(run="p-s-s01", verdict="error", **{PROBE: "p-s"}),
        run_of(run="p-s", verdict="pass", **{RUNS: "1"}),
    ]
    whole = StoredResults(Path(), runs, {})
    assert [run.run for run in whole.planned] == ["p-a", "p-s"]
    assert (whole.runs_planned, whole.missing, whole.verdict) == (2, 0, Verdict.MARGINAL)
    short = StoredResults(Path(), runs, {"runs_planned": 3})
    assert (short.runs_planned, short.missing, short.verdict) == (3, 1, Verdict.ABORTED)
    worse = StoredResults(Path(), [run_of(verdict="error")], {"runs_planned": 2})
    assert worse.verdict is Verdict.ERROR


def test_inputs_are_the_columns_that_are_not_the_folders_own() -> None:
    own = dict.fromkeys((*CASE_COLUMNS, *LATER_COLUMNS, RECORDING, RUNS, PROBE, IN_PLAN), "")
    one = StoredRun({"title": "t", **own, "plc:V.E.A": ""}, [], None, None)
    assert StoredResults(Path(), [one], {}).input_columns == ["title", "plc:V.E.A"]
    assert StoredResults(Path(), [], {}).input_columns == []


def written(place: Path, *runs: str, recording: str = "", **manifest: Any) -> Path:
    place.mkdir(parents=True)
    for folder in ("runs", "traces"):
        (place / folder).mkdir()
    cells = dict.fromkeys(CASE_COLUMNS, "") | {"verdict": "pass", "sim_s": "1", "wall_s": "1"}
    lines = [",".join([*CASE_COLUMNS, RECORDING])]
    lines += [",".join([*{**cells, "run": run}.values(), recording]) for run in runs]
    (place / "cases.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
    check = dict.fromkeys(RESULT_COLUMNS, "") | {"verdict": "pass", "uncertainty": "0"}
    lines = [",".join(RESULT_COLUMNS)]
    lines += [",".join({**check, "run": run, "metric": m}.values())
              for m in ("m1", "m2") for run in reversed(runs)]  # fmt: skip
    (place / "results.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
    content = {"axisrig": "1", "runs_planned": len(runs), "finished": True, **manifest}
    (place / "manifest.json").write_text(json.dumps(content), encoding="utf-8")
    return place


def test_each_run_has_its_own_checks_in_their_order_and_its_own_files(tmp_path: Path) -> None:
    place = written(tmp_path / "out", "p-a", "p-b")
    (place / "runs" / "p-b.json").touch()
    (place / "traces" / "p-a.parquet").touch()
    found = read_results(place)
    assert [(run.run, [check.metric for check in run.checks]) for run in found.runs] == [
        ("p-a", ["m1", "m2"]), ("p-b", ["m1", "m2"]),
    ]  # fmt: skip
    assert [(run.file, run.trace) for run in found.runs] == [
        (None, place / "traces" / "p-a.parquet"), (place / "runs" / "p-b.json", None),
    ]  # fmt: skip
    assert {run.place for run in found.runs} == {found.place} == {place}
    (place / "results.csv").unlink()
    with pytest.raises(UserError, match=r"no results folder: results\.csv is missing"):
        read_results(place)


def test_verdicts_made_anew_have_the_recordings_of_the_folder_above(tmp_path: Path) -> None:
    """By the run that was recorded; taken out of their folder they have none."""
    out = written(tmp_path / "out", "p-a")
    (out / "runs" / "p-a.json").touch()
    entries = {RECORDINGS: "../..", RECORDED_IN: "out"}
    judged = written(out / "judged" / "1-q", "q-a", recording="p-a", **entries)
    (one,) = read_results(judged).runs
    assert (one.recorded, one.file) == ("p-a", judged / "../.." / "runs" / "p-a.json")
    judged.rename(tmp_path / "1-q")
    moved = read_results(tmp_path / "1-q")
    assert (moved.place, moved.runs[0].file, moved.runs[0].altered) == (None, None, [])


def test_results_of_another_tool_take_the_plan_from_the_name_of_their_folder(
    tmp_path: Path,
) -> None:
    place = tmp_path / "tool"
    place.mkdir()
    (place / "cases.csv").write_text("run,verdict\na,pass\nb,fail", encoding="utf-8")
    (place / "results.csv").write_text("run,metric,verdict\nb,m,fail", encoding="utf-8")
    a, b = read_results(place).runs
    assert (a.case["plan"], a.case["sim_s"], list(a.checks)) == ("tool", "0", [])
    assert [(check.metric, check.verdict) for check in b.checks] == [("m", "fail")]
    (place / "cases.csv").write_text("run,verdict\na,good\n", encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_results(place)
    assert "results of another tool need the columns run and verdict" in (caught.value.hint or "")
