"""Parts of a campaign by themselves: shares, words of a command, statistics, sums, warnings."""

import hashlib
import json
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

from axisrig.bench.campaign.cell_warnings import CellWarnings, Looked, refuse_warnings
from axisrig.bench.campaign.results.commits import Commit, read_commit
from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.layout import refuse_links
from axisrig.bench.campaign.results.stored import CASE_COLUMNS, RESULT_COLUMNS
from axisrig.bench.campaign.results.sums import altered_files, is_log_sums, is_sum, sums_of
from axisrig.bench.campaign.sharing import Shard, _kept_words
from axisrig.bench.campaign.statistics import judged_row
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.statistic_checks import parse_any_check
from axisrig.bench.plan.table import Place
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

# Shares


@pytest.mark.parametrize("text", ["0/3", "4/3", "1/0", "1", "1/3/3", "-1/3", "a/b", "01/3", ""])
def test_what_is_no_share_is_refused(text: str) -> None:
    with pytest.raises(UserError) as caught:
        Shard.of(text)
    assert (caught.value.value, caught.value.allowed) == (text, "1/3, 2/3, 3/3")


def test_shares_take_neighbours_apart_and_are_all_of_them() -> None:
    cases: Any = list("abcdefgh")
    shares = [Shard.of(f"{number}/3").share(cases) for number in (1, 2, 3)]
    assert ["".join(share) for share in shares] == ["adg", "beh", "cf"]  # type: ignore[arg-type]
    assert Shard.of("1/1").share(cases) == tuple(cases)


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        ("run a.csv -o out -j 2 --fresh", "run"),
        ("run a.csv -oout -j2 --set plc:V.E.A=1", "run --set plc:V.E.A=1"),
        ("run a.csv --set=plc:V.E.A=1 --out=x --jobs 4 --force", "run --set=plc:V.E.A=1 --force"),
        ("run -k probe --shard 1/3 --timeout 5", "run -k probe"),
        ("run a.csv --call-timeout 5 b.csv --as-canopen", "run --as-canopen"),
        ("run --engine dask --scheduler tcp://x --full --isolate --resume --failed", "run"),
    ],
)
def test_of_a_command_stays_what_changes_results(words: str, kept: str) -> None:
    """The first word is that of the command; plans stay where they are asked for."""
    found = _kept_words(words.split()[1:])
    assert found == kept.split()[1:]
    whole = _kept_words(words.split(), has_plans=True)
    plans = [word for word in words.split() if word.endswith(".csv")]
    assert [word for word in whole if word.endswith(".csv")] == plans
    assert [word for word in whole if word not in plans] == kept.split()


# Statistics over the runs of a case


def case_of(run: str, checks: tuple[Any, ...] = (), expected: tuple[str, ...] = ()) -> Case:
    return Case("p", "c", run, 0, Path(), Path(), {"plc:V.E.A": run}, checks, "", (), "", 1, 0,
                Path("p.csv"), 2, {}, expected=expected)  # fmt: skip


CHECK = parse_any_check("count(latch_mm)", ">= 2", "p.csv:2")


def result_of(verdict: Verdict, values: int | None) -> Any:
    samples = {}
    if values is not None:
        reading = SimpleNamespace(
            touch=1, metric=SimpleNamespace(value=1.0, uncertainty=0.0, note=""), sides=()
        )
        samples = {"count(latch_mm)": [reading] * values}
    return SimpleNamespace(verdict=verdict, samples=samples, frame_log_sha256=f"{verdict}")


@pytest.mark.parametrize(
    ("second", "verdict", "words"),
    [
        (result_of(Verdict.FAIL, 1), Verdict.PASS, "n = 2 from 2 of 2 runs"),
        (None, Verdict.INCONCLUSIVE, "without values of 1 of 2 runs: b is missing"),
        (result_of(Verdict.ERROR, 1), Verdict.INCONCLUSIVE, "values of 1 of 2 runs: b is in error"),
        (result_of(Verdict.ABORTED, 1), Verdict.INCONCLUSIVE, "values of 1 of 2 runs: b is ab"),
        (result_of(Verdict.ERROR, None), Verdict.INCONCLUSIVE, "b is in error"),
        (result_of(Verdict.PASS, None), Verdict.INCONCLUSIVE, "b has no recording"),
        (result_of(Verdict.PASS, 0), Verdict.FAIL, "n = 1 from 2 of 2 runs"),
    ],
)  # fmt: skip
def test_a_run_without_values_leaves_statistics_open(
    second: Any, verdict: Verdict, words: str
) -> None:
    results: dict[str, Any] = {"a": result_of(Verdict.PASS, 1)}
    if second is not None:
        results["b"] = second
    found = judged_row(case_of("p-c", (CHECK,)), [case_of("a"), case_of("b")], results)
    assert found.verdict is verdict
    assert words in found.checks[0].note


def test_statistics_can_be_expected_to_fail() -> None:
    results = {"a": result_of(Verdict.PASS, 1)}
    row = case_of("p-c", (CHECK,), expected=("count(latch_mm)",))
    found = judged_row(row, [case_of("a")], results)
    assert found.verdict is Verdict.PASS
    assert found.checks[0].note.startswith("was expected to fail")


# Sums and links


def digits(text: bytes) -> str:
    return hashlib.sha256(text).hexdigest()


def test_files_of_a_run_are_known_by_their_sums(tmp_path: Path) -> None:
    names = ("traces/r.parquet", "runs/r.json", "bus/r.blf", "bus/r.can2.asc")
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(name.encode())
    row = sums_of(tmp_path, "r", names[:3])
    assert row == {
        "trace_sha256": digits(b"traces/r.parquet"), "recording_sha256": digits(b"runs/r.json"),
        "bus_log_sha256": f".blf:{digits(b'bus/r.blf')}",
    }  # fmt: skip
    assert is_log_sums(row["bus_log_sha256"])
    assert list(altered_files(tmp_path, "r", row)) == []
    for name in names[:3]:
        kept = (tmp_path / name).read_bytes()
        (tmp_path / name).write_bytes(b"of another run")
        assert list(altered_files(tmp_path, "r", row)) == [name]
        assert list(altered_files(tmp_path, "r", {**row, "recording_sha256": ""})) == []
        (tmp_path / name).unlink()
        assert list(altered_files(tmp_path, "r", row)) == []  # missing is not altered
        (tmp_path / name).write_bytes(kept)


@pytest.mark.parametrize("has_trace", [True, False])
def test_every_file_of_a_run_is_compared_with_its_own_sum(tmp_path: Path, has_trace: bool) -> None:
    """Also of a run without a series; several logs have one sum each."""
    names = ["runs/r.json", "bus/r.blf", "bus/r@ec1.pcapng", "bus/r@ec2.pcapng"]
    names += ["traces/r.parquet"] if has_trace else []
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(name.encode())
    row = sums_of(tmp_path, "r", names)
    assert row["trace_sha256"] == (digits(b"traces/r.parquet") if has_trace else "")
    assert list(altered_files(tmp_path, "r", row)) == []
    for name in names:
        (tmp_path / name).write_bytes(b"of another run")
        assert list(altered_files(tmp_path, "r", row)) == [name]
        (tmp_path / name).write_bytes(name.encode())
    (tmp_path / "traces").mkdir(exist_ok=True)
    (tmp_path / "traces/r.parquet").write_bytes(b"of another run")
    assert list(altered_files(tmp_path, "r", row)) == ["traces/r.parquet"]


@pytest.mark.parametrize(
    ("cell", "plain", "logs"),
    [
        ("", True, True),
        ("a" * 64, True, False),
        ("a" * 63, False, False),
        ("A" * 64, False, False),
        (".blf:" + "a" * 64, False, True),
        (f".blf:{'a' * 64} .asc:{'b' * 64}", False, True),
        (f".blf:{'a' * 64}  .asc:{'b' * 64}", False, False),
        (f"/x.blf:{'a' * 64}", False, False),
        (f".exe:{'a' * 64}", False, False),
    ],
)
def test_cells_of_sums_have_their_form(cell: str, plain: bool, logs: bool) -> None:
    assert (is_sum(cell), is_log_sums(cell)) == (plain, logs)


@pytest.mark.skipif(os.name != "posix", reason="links need rights elsewhere")
@pytest.mark.parametrize(
    ("name", "is_refused"),
    [("cases.csv", True), ("traces", True), ("traces/r.parquet", True), ("plans/deep/p.csv", True),
     (".new", True), ("of-the-user.txt", False), ("mine/r.parquet", False)],
)  # fmt: skip
def test_a_link_in_what_is_the_folders_own_is_refused(
    tmp_path: Path, name: str, is_refused: bool
) -> None:
    folder = tmp_path / "out"
    (folder / name).parent.mkdir(parents=True)
    (folder / name).symlink_to(tmp_path)
    if is_refused:
        with pytest.raises(UserError) as caught:
            refuse_links(folder)
        assert (caught.value.file, caught.value.value) == (str(folder), name)
    else:
        refuse_links(folder)
    refuse_links(tmp_path / "not there")


def test_a_commit_names_files_and_rows_of_its_run_alone(tmp_path: Path) -> None:
    row = dict.fromkeys(CASE_COLUMNS, "") | {"run": "r", "verdict": "pass", "sim_s": "1",
                                             "wall_s": "1", "seed": "1"}  # fmt: skip
    check = dict.fromkeys(RESULT_COLUMNS, "") | {"run": "r", "verdict": "pass", "metric": "m",
                                                 "uncertainty": "0"}  # fmt: skip
    files = ["traces/r.parquet", "runs/r.json", "bus/r.blf"]
    path = tmp_path / "r.commit"

    def read(**changes: Any) -> Commit:
        known: dict[str, Any] = {"run": "r", "files": files, "case": row, "checks": [check]}
        path.write_text(Commit(**{**known, **changes}).text, encoding="utf-8")
        return read_commit(path)

    assert read() == Commit("r", files, row, [check])
    refused: tuple[tuple[dict[str, Any], str], ...] = (
        ({"case": {**row, "run": "other"}}, "case is no row of the run r"),
        ({"case": {"run": "r"}}, "case is no row of the run r"),
        ({"case": {**row, "seed": 1}}, "case is no row of the run r"),
        ({"checks": [check, {**check, "run": "other"}]}, "checks are no rows of the run r"),
        ({"checks": {}}, "checks are no rows of the run r"),
        ({"files": "traces/r.parquet"}, "files is no list of names"),
        *(
            ({"files": [name]}, f"{name!r} is no file of the run r")
            for name in ("traces/other.parquet", "runs/r.parquet", "else/r.json", "runs/../r.json",
                         "traces/r.parquet.txt", "bus/r")
        ),
    )  # fmt: skip
    for changes, words in refused:
        with pytest.raises(UserError) as caught:
            read(**changes)
        assert words in str(caught.value)
        assert caught.value.file == str(path)


# Warnings of cells

HERE, THERE = (Place(Path("p.csv"), line, 4, "plc:V.E.A") for line in (2, 3))


def test_a_default_that_one_row_uses_is_no_warning() -> None:
    warnings = CellWarnings()
    warnings.add([Looked(HERE, "plc:V.E.A", "is not used", is_unused=True)])
    warnings.add([Looked(THERE, "plc:V.E.A", "is not used", is_unused=True)])
    warnings.add([Looked(HERE, "plc:V.E.A", "", is_unused=False)])
    assert warnings.lines() == ["p.csv:3:4: is not used"]
    twice = CellWarnings()
    for text in ("first", "second"):
        twice.add([Looked(HERE, "plc:V.E.A", text, is_unused=False)])
    twice.add([Looked(HERE, "plc:V.E.A", "", is_unused=False)])  # used, and without its unit
    assert twice.lines() == ["p.csv:2:4: first"]


def test_what_is_not_looked_at_may_use_it() -> None:
    beside: Any = SimpleNamespace(places={"plc:V.E.A": HERE})
    warnings = CellWarnings([beside])
    warnings.add(
        [Looked(place, "plc:V.E.A", "is not used", is_unused=True) for place in (HERE, THERE)]
    )
    assert warnings.lines() == ["p.csv:3:4: is not used"]


def test_a_value_of_the_command_line_that_no_row_uses_is_refused() -> None:
    warnings = CellWarnings()
    warnings.add([Looked(None, "plc:V.E.B", "plc:V.E.B is not used", is_unused=True),
                  Looked(None, "rig", "no unit", is_unused=False)])  # fmt: skip
    with pytest.raises(UserError, match=r"^--set plc:V\.E\.B is not used"):
        warnings.lines()
    warnings.add([Looked(None, "plc:V.E.B", "", is_unused=False)])
    assert warnings.lines() == ["no unit"]
    refuse_warnings([])
    with pytest.raises(UserError) as caught:
        refuse_warnings(["first", "second"])
    assert [caught.value.message, *(one.message for one in caught.value.further)] == [
        "first", "second",
    ]  # fmt: skip


# JUnit


def stored(run: str, verdict: Verdict, *, plan: str = "p", is_in_plan: bool = True,
           is_probe: bool = False, **more: Any) -> Any:  # fmt: skip
    case = {"plan": plan, "wall_s": "1.5", "verdict": verdict.word, "seed": "7", "requirement": ""}
    checks = [
        {
            "metric": "m", "value": "2", "unit": "um", "lower": "", "upper": "1",
            "uncertainty": "0.0", "verdict": verdict.word, "check": "<= 1", "note": "why",
        }
    ]  # fmt: skip
    read = [CheckRow.read(row) for row in checks]
    known = {"case": case, "checks": read, "run": run, "verdict": verdict, "error": None,
             "messages": [], "log": [], "is_in_plan": is_in_plan, "is_probe": is_probe}  # fmt: skip
    return SimpleNamespace(**{**known, **more})


def test_each_verdict_is_what_a_server_knows(tmp_path: Path) -> None:
    runs = [stored(f"p-{verdict.word}", verdict) for verdict in Verdict]
    runs += [stored("p-gone", Verdict.FAIL, is_in_plan=False),
             stored("p-s01", Verdict.FAIL, is_probe=True),
             stored("q-one", Verdict.PASS, plan="q", messages=["hello"], log=["a < b\x00"]),
             stored("p-odd", Verdict.ERROR, error="it broke")]  # fmt: skip
    root = ElementTree.parse(write_junit(tmp_path, runs)).getroot()
    p, q = root.findall("testsuite")
    counts = {
        name: p.get(name) for name in ("name", "tests", "failures", "errors", "skipped", "time")
    }
    assert counts == {"name": "p", "tests": "8", "failures": "2", "errors": "3", "skipped": "1",
                      "time": "12.000"}  # fmt: skip
    found = {}
    for one in p.findall("testcase"):
        outcome = next(
            (child for child in one if child.tag not in ("properties", "system-out")), None
        )
        found[one.get("name")] = None if outcome is None else (outcome.tag, outcome.get("type"))
    assert found == {
        "pass": None, "marginal": None, "inconclusive": ("failure", "inconclusive"),
        "fail": ("failure", "fail"), "aborted": ("error", "aborted"), "error": ("error", "error"),
        "gone": ("skipped", None), "odd": ("error", "error"),
    }  # fmt: skip
    fail = p.find("testcase[@name='fail']/failure")
    assert fail is not None
    assert fail.get("message") == fail.text == "fail: m is 1 um above its upper limit 1 um"
    odd = p.find("testcase[@name='odd']/error")
    assert odd is not None
    assert odd.get("message") == "it broke"
    assert odd.text == "it broke\nerror: m is 1 um above its upper limit 1 um"
    (one,) = q.findall("testcase")
    assert one.find("system-out").text == "hello\na < b\N{REPLACEMENT CHARACTER}"  # type: ignore[union-attr]
    properties = {each.get("name"): each.get("value") for each in one.iter("property")}
    assert properties == {"verdict": "pass", "seed": "7", "m.value": "2", "m.lower": "",
                          "m.upper": "1", "m.unit": "um", "m.uncertainty": "0.0",
                          "m.verdict": "pass"}  # fmt: skip
    assert (
        write_junit(tmp_path, [])
        .read_text(encoding="utf-8")
        .endswith('<testsuites name="axisrig" />')
    )


def test_a_run_has_its_place_in_the_plan_and_its_time(tmp_path: Path) -> None:
    """The plan as it was called; an included table by its own name; the suite began first."""
    manifest = {"plans": [{"name": "p", "path": "plans/p.csv", "sha256": "0" * 64}]}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    runs = [stored(f"p-{n}", Verdict.PASS) for n in range(3)]
    places = ("p.csv:4", "other.csv:2", "")
    for run, place, second in zip(runs, places, (7, 5, 9), strict=True):
        run.checks[0] = replace(run.checks[0], reference=place)
        run.case["timestamp"] = f"2026-11-29T02:00:0{second}+00:00"
    (suite,) = ElementTree.parse(write_junit(tmp_path, runs)).getroot()
    assert suite.get("timestamp") == "2026-11-29T02:00:05"
    found = [[one.get(name) for name in ("file", "line", "timestamp")]
             for one in suite.findall("testcase")]  # fmt: skip
    assert found == [
        ["plans/p.csv", "4", "2026-11-29T02:00:07"],
        ["other.csv", "2", "2026-11-29T02:00:05"],
        ["plans/p.csv", None, "2026-11-29T02:00:09"],
    ]


@pytest.mark.parametrize(
    ("plan", "table", "file"),
    [
        ("plans/all.csv", "all.csv", "plans/all.csv"),
        ("all.csv", "all.csv", "all.csv"),
        ("plans\\all.csv", "all.csv", "plans/all.csv"),
        # An included table whose name is the end of that of the plan
        ("plans/all_edges.csv", "edges.csv", "edges.csv"),
        ("plans/all-p.csv", "p.csv", "p.csv"),
        ("plans/edges.csv", "all_edges.csv", "all_edges.csv"),
    ],
)
def test_a_row_is_of_the_table_that_its_checks_name(
    tmp_path: Path, plan: str, table: str, file: str
) -> None:
    manifest = {"plans": [{"name": "p", "path": plan, "sha256": "0" * 64}]}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    run = stored("p-a", Verdict.PASS)
    run.checks[0] = replace(run.checks[0], reference=f"{table}:4")
    (suite,) = ElementTree.parse(write_junit(tmp_path, [run])).getroot()
    (one,) = suite.findall("testcase")
    assert (one.get("file"), one.get("line")) == (file, "4")
