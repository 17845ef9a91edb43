"""What a run leaves in its row and its file: why it ended, how many runs a row is over, probes."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from results_setup import TEXT, PlanWriter, left, rows, run_case
from tests.recordings import facts

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, RunFiles, no_values
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import Facts, Note

MIXED = """\
case,program,rig,repeats,plc:V.E.FEED,search:plc:V.E.STEP,check:lag_mm_max:Z,check:mean(lag_mm_max:Z)
r,probe.nc,machine.toml,3,600,,<= 2,<= 2
w,probe.nc,machine.toml,,[600 | 900],,<= 2,<= 2
s,probe.nc,machine.toml,,700,100 .. 900 to 400,<= 2,
n,probe.nc,machine.toml,,800,,<= 2,
"""


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


@pytest.fixture
def mixed(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(MIXED))


def as_left(out: Path, run: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((out / "runs" / f"{run}.json").read_text(encoding="utf-8"))
    return content


@pytest.mark.parametrize(
    ("of_run", "error", "in_file", "shown"),
    [
        (left(), None, None, None),
        # It came to its end early: its facts are whole, and the file says who ended it
        (facts(is_stopped=True), STOPPED, STOPPED, STOPPED),
        # Facts up to a failure say so themselves, once
        (facts(unfinished="a plant failed"), "a plant failed", None, "a plant failed"),
        (facts(unfinished="a plant failed", is_stopped=True), "a plant failed", None, STOPPED),
        (None, "the process died", "the process died", "the process died"),
    ],
)
def test_the_file_of_a_run_has_the_reason_of_its_end_in_one_place(
    plan: Plan, tmp_path: Path, of_run: Facts | None, error: str | None, in_file: str | None,
    shown: str | None,
) -> None:  # fmt: skip
    case, out = plan.cases[0], tmp_path / "out"
    with ResultsWriter(out, [plan], {}) as writer:
        writer.add(CaseResult(case, Verdict.ERROR, [], facts=of_run, error=error, log=["one"]))
    found = as_left(out, case.run)
    assert found["error"] == in_file
    assert (found["facts"] is None) == (of_run is None)
    assert (found["facts"] or {}).get("unfinished", "") == ("" if of_run is None else
                                                            of_run.unfinished)  # fmt: skip
    assert found["log"] == ["one"]
    (run,) = read_results(out).runs
    assert run.error == shown


def test_what_a_result_reports_is_what_its_folder_reports_later(plan: Plan, tmp_path: Path) -> None:
    """Error, messages and log: of a run with facts what these say, else what was printed."""
    noted = replace(left("M 1"), notes=(Note("rig", "an old list"),))
    results = [
        CaseResult(plan.cases[0], Verdict.PASS, [], facts=noted, log=["printed"]),
        CaseResult(
            plan.cases[1], Verdict.ERROR, [], facts=replace(noted, is_stopped=True), error="other"
        ),
        no_values(plan.cases[2], Verdict.ERROR, "it broke"),
    ]
    results[2].log = ["printed", "twice"]
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {}) as writer:
        for result in results:
            writer.add(result)
    said = [(result.said.error, list(result.said.messages), list(result.said.log))
            for result in results]  # fmt: skip
    assert [(run.error, run.messages, run.log) for run in read_results(out).runs] == said
    assert [error for error, *_ in said] == [None, STOPPED, "it broke"]
    assert [messages for _, messages, _ in said] == [["M 1"], ["M 1"], []]
    assert said[0][2] == said[1][2] == results[0].lines
    assert any("an old list" in line for line in said[0][2])
    assert said[2][2] == ["printed", "twice"]


def searched(plan: Plan, count: int, **more: Any) -> CaseResult:
    """The row that searches, with so many probes."""
    case = next(case for case in plan.cases if case.search is not None)
    values = ("100", "900", "500", "300")[:count]
    probes = [run_case(probe_of(case, n, value)) for n, value in enumerate(values, 1)]
    checks = [judge(check, 500.0) for check in case.checks]
    return CaseResult(case, Verdict.PASS, checks, probes=tuple(probes), **more)


def written(plan: Plan, out: Path) -> dict[str, dict[str, str]]:
    """The rows of cases of a folder with every row of the plan; the search has three probes."""
    with ResultsWriter(out, [plan], {}) as writer:
        for case in plan.rows:
            if case.search is not None:
                writer.add(searched(plan, 3, depends_sha256="d" * 64, timestamp="2026-11-29T02"))
            elif case.runs:
                writer.add(CaseResult(case, Verdict.PASS, [judge(one, 1.0) for one in case.checks]))
            else:
                writer.add(run_case(case))
    return {row["run"].removeprefix("probing-"): row for row in rows(out / "cases.csv")}


def test_a_row_over_several_runs_has_how_many_these_are(mixed: Plan, tmp_path: Path) -> None:
    """Of statistics its runs, of a search its probes; a run and a probe are over nothing."""
    found = written(mixed, tmp_path / "out")
    counts = {run: row["runs"] for run, row in found.items() if row["runs"]}
    assert counts == {"r": "3", "w": "2", "s": "3"}
    assert list(found) == [
        *("r-001", "r-002", "r-003", "r", "w-600", "w-900", "w"),
        *("s", "s-s01", "s-s02", "s-s03", "n"),
    ]
    kinds = {run.run.removeprefix("probing-"): (run.is_statistic, run.is_probe)
             for run in read_results(tmp_path / "out").runs}  # fmt: skip
    assert {run for run, (is_statistic, _) in kinds.items() if is_statistic} == {"r", "w", "s"}
    assert {run for run, (_, is_probe) in kinds.items() if is_probe} == {"s-s01", "s-s02", "s-s03"}


def test_a_row_names_each_check_that_has_to_fail(write_plan: PlanWriter, tmp_path: Path) -> None:
    path = write_plan(
        "case,program,rig,expect,check:latch_error_um:Z,check:lag_mm_max:Z\n"
        "both,probe.nc,machine.toml,fail:latch_error_um:Z lag_mm_max:Z,<= 2,<= 2\n"
        "one,probe.nc,machine.toml,fail:lag_mm_max:Z,<= 2,<= 2\n"
        "none,probe.nc,machine.toml,,<= 2,<= 2\n"
    )
    found = written(read_plan(path), tmp_path / "out")
    assert {run: row["expected"] for run, row in found.items()} == {
        "both": "fail:latch_error_um:Z lag_mm_max:Z", "one": "fail:lag_mm_max:Z", "none": "",
    }  # fmt: skip


def test_a_row_over_runs_of_several_programs_or_rigs_names_none(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    """What all runs have is that of the row."""
    path = write_plan(
        "case,program,rig,check:mean(lag_mm_max:Z)\n"
        "p,[probe.nc | other.nc],machine.toml,<= 2\n"
        "r,probe.nc,[machine.toml | other.toml],<= 2\n"
    )
    for kind in ("probe.nc", "machine.toml"):
        here = path.parent / kind
        shutil.copy(here, here.with_stem("other"))
    found = written(read_plan(path), tmp_path / "out")
    assert [(row["program"], row["rig"]) for row in found.values()] == [
        *(("probe.nc", "machine.toml"), ("other.nc", "machine.toml"), ("", "machine.toml")),
        *(("probe.nc", "machine.toml"), ("probe.nc", "other.toml"), ("probe.nc", "")),
    ]


def test_a_row_over_several_runs_has_what_all_of_these_share(mixed: Plan, tmp_path: Path) -> None:
    """The seed is that of one run, a list is what its runs differ in."""
    found = written(mixed, tmp_path / "out")
    feed = {run: row["plc:V.E.FEED"] for run, row in found.items()}
    assert feed == {
        **dict.fromkeys(("r-001", "r-002", "r-003", "r"), "600"),
        **{"w-600": "600", "w-900": "900", "w": ""},
        **dict.fromkeys(("s", "s-s01", "s-s02", "s-s03"), "700"),
        "n": "800",
    }
    assert [run for run, row in found.items() if not row["seed"]] == ["r", "w"]
    seeds = {case.run.removeprefix("probing-"): str(case.seed) for case in mixed.cases}
    for run, seed in seeds.items():
        assert found[run]["seed"] == seed
    assert {found[f"s-s0{n}"]["seed"] for n in (1, 2, 3)} == {seeds["s"]}


def test_a_search_has_its_range_and_each_probe_its_value(mixed: Plan, tmp_path: Path) -> None:
    found = written(mixed, tmp_path / "out")
    cells = {run: (row["plc:V.E.STEP"], row["search:plc:V.E.STEP"], row["probe"])
             for run, row in found.items() if any(row[name] for name in
             ("plc:V.E.STEP", "search:plc:V.E.STEP", "probe"))}  # fmt: skip
    assert cells == {
        "s": ("", "100 .. 900 to 400", ""),
        "s-s01": ("100", "", "probing-s"),
        "s-s02": ("900", "", "probing-s"),
        "s-s03": ("500", "", "probing-s"),
    }


def test_probes_have_the_time_and_the_hash_of_their_search(mixed: Plan, tmp_path: Path) -> None:
    """They are of one row: `--resume` keeps all of them or none."""
    found = written(mixed, tmp_path / "out")
    of_search = ("s", "s-s01", "s-s02", "s-s03")
    for run, row in found.items():
        is_of_search = run in of_search
        assert row["depends_sha256"] == ("d" * 64 if is_of_search else ""), run
        assert row["timestamp"] == ("2026-11-29T02" if is_of_search else ""), run
    assert float(found["s"]["sim_s"]) == pytest.approx(3 * 0.005)
    assert {float(found[run]["sim_s"]) for run in of_search[1:]} == {0.005}


def test_rows_that_are_no_runs_leave_no_files(mixed: Plan, tmp_path: Path) -> None:
    written(mixed, tmp_path / "out")
    runs = {path.stem for path in (tmp_path / "out" / "runs").iterdir()}
    assert runs == {
        f"probing-{run}"
        for run in ("r-001", "r-002", "r-003", "w-600", "w-900", "s-s01", "s-s02", "s-s03", "n")
    }


def test_every_probe_has_places_for_each_of_its_logs(mixed: Plan, tmp_path: Path) -> None:
    """And the pipe of a live view goes with them."""
    writer = ResultsWriter(tmp_path / "out", [mixed], {}, ["blf", "asc"])
    with writer:
        files, plain = writer.files_of("probing-s"), writer.files_of("probing-n")
    assert [log.name for log in plain.bus_logs] == ["probing-n.blf", "probing-n.asc"]
    assert not plain.probes
    assert len(files.probes) == 40
    for number, probe in enumerate(files.probes, 1):
        name = f"probing-s-s{number:02}"
        assert [log.name for log in probe.bus_logs] == [f"{name}.blf", f"{name}.asc"]
        assert probe.trace is not None
        assert probe.trace.name == f"{name}.parquet"
    shown = files.with_live(Path("pipe"))
    assert {one.live for one in (shown, *shown.probes)} == {Path("pipe")}
    assert shown.bus_logs == files.bus_logs
    assert RunFiles().with_live(None) == RunFiles(probes=[])


def test_the_manifest_has_what_each_substituted_run_ran_on(plan: Plan, tmp_path: Path) -> None:
    """Only runs whose lists name another drive; the words are those of their rows."""
    of_lists = {"a": "Z: SERCOS", "b": "", "c": "X Z: PROFIDRIVE"}
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {}) as writer:
        for case in plan.cases:
            result = run_case(case)
            result.facts = replace(left(), drive_substituted=of_lists[case.case])
            writer.add(result)
    made = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    expected = {f"probing-{name}": words for name, words in of_lists.items() if words}
    assert made["drive_substituted"] == expected
    found = {row["case"]: row["drive_substituted"] for row in rows(out / "cases.csv")}
    assert found == of_lists


@pytest.mark.parametrize(
    ("first", "second"),
    [("lag_mm_max:Z", ""), ("", "lag_mm_max:Z"), ("lag_mm_max:Z", "lag_mm_max:Z"), ("", "")],
)
def test_what_a_row_expects_is_a_column_where_any_row_expects_something(
    write_plan: PlanWriter, tmp_path: Path, first: str, second: str
) -> None:
    cells = [f"fail:{metric}" if metric else "" for metric in (first, second)]
    lines = [f"{n},probe.nc,machine.toml,<= 2,{cell}" for n, cell in zip("ab", cells, strict=True)]
    head = "case,program,rig,check:lag_mm_max:Z,expect"
    plan = read_plan(write_plan("\n".join([head, *lines, ""])))
    with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
        for case in plan.cases:
            writer.add(run_case(case))
    found = rows(tmp_path / "out" / "cases.csv")
    assert [row.get("expected", "") for row in found] == cells
    assert ("expected" in found[0]) is (cells != ["", ""])
    assert "expect" not in found[0]
