"""What a joined folder has: rows of statistics, probes, `[info]`; and which folders are refused."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from results_setup import PlanWriter, rows, run_case

from axisrig.bench.campaign import resuming
from axisrig.bench.campaign.results.layout import MANIFEST
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import DEPENDS, read_results
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.campaign.searching import run_search
from axisrig.bench.campaign.sharing import Merged, merge
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

TEXT = """\
case,program,rig,repeats,set:Z.edge,check:lag_mm_max:Z,check:mean(lag_mm_max:Z)
z,probe.nc,machine.toml,2,NEG,<= 2,<= 2
a,probe.nc,machine.toml,2,POS,<= 2,<= 2
m,probe.nc,machine.toml,,POS,<= 2,
"""
ALL = ("z-001", "z-002", "a-001", "a-002", "m")
SEARCHES = """\
case,program,rig,search:plc:V.E.FEED,check:lag_mm_max:Z,check:search_good
s,probe.nc,machine.toml,100 .. 900 to 400,<= 2,
"""


@pytest.fixture(autouse=True)
def of_two_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run depends on its program and its rig, which here has no axes."""
    monkeypatch.setattr(resuming, "files_of_case", lambda case: [case.program, case.rig])


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


def share(
    folder: Path,
    plan: Plan,
    runs: Sequence[str],
    options: Sequence[str] = (),
    limit: float = math.inf,
) -> Path:
    """A results folder with runs that were never run, by their ids without that of the plan."""
    command = ["axisrig", "run", str(plan.path), "-o", str(folder), *options]
    made = build_manifest([plan], command=command, started="now", output=str(folder))
    with ResultsWriter(folder, [plan], made) as writer:
        for case in plan.cases:
            if case.run.removeprefix("probing-") not in runs:
                continue
            if case.search is None:
                file = writer.files_of(case.run).trace
                result = run_case(case, file=file)
            else:
                result = searched(case, writer, limit)
            result.depends_sha256 = depends_sha256(case)
            writer.add(result)
    return folder


def searched(case: Case, writer: ResultsWriter, limit: float) -> CaseResult:
    """A search whose probes pass up to a limit."""
    places = iter(writer.files_of(case.run).probes)

    def probe(one: Case) -> CaseResult:
        found = run_case(one, file=next(places).trace)
        passes = float(one.inputs["plc:V.E.FEED"]) <= limit
        return replace(found, verdict=Verdict.PASS if passes else Verdict.FAIL)

    return run_search(case, probe)


def joined(into: Path, *folders: Path, **how: Any) -> Merged:
    return merge(folders, into, started="later", **how)


@pytest.mark.long
@pytest.mark.parametrize(
    ("options", "tested"),
    [
        ([], {"info:serial": "7", "info:device": "drill"}),
        (["--info", "serial=9"], {"info:serial": "9", "info:device": "drill"}),
        (
            ["--info=serial=9", "--info", "order=A = 5"],
            {"info:serial": "9", "info:device": "drill", "info:order": "A = 5"},
        ),
    ],
)
def test_shares_that_say_what_is_tested_are_joined(
    plan: Plan, tmp_path: Path, options: list[str], tested: dict[str, str]
) -> None:
    """`[info]` of the rig, and over it `--info`: in each row, those of statistics too."""
    rig = "[machine]\n[info]\nserial = 7\ndevice = 'drill'\n"
    (tmp_path / "machine.toml").write_text(rig, encoding="utf-8")
    plan = with_tested(plan, {name.removeprefix("info:"): text for name, text in tested.items()})
    one = share(tmp_path / "one", plan, ALL[:3], options)
    other = share(tmp_path / "other", plan, ALL[3:], options)
    done = joined(tmp_path / "all", one, other)
    assert (done.runs, done.statistics, done.missing) == (5, 2, [])
    for row in rows(tmp_path / "all" / "cases.csv"):
        assert {name: row[name] for name in row if name.startswith("info:")} == tested


@pytest.mark.long
@pytest.mark.parametrize(
    ("options", "texts"),
    [
        (["--force"], [FORCED]),
        (["--as-canopen"], [AS_CANOPEN]),
        (["--as-canopen", "-j", "2", "--force"], [AS_CANOPEN, FORCED]),
        (["--set", "plc:V.E.FEED=7", "--force"], ["plc:V.E.FEED=7", FORCED]),
        (
            ["--set=plc:V.E.FEED=7", "--set", "plc:V.E.STEP=2"],
            ["plc:V.E.STEP=2", "plc:V.E.FEED=7"],
        ),
    ],
)
def test_runs_of_a_call_are_joined_with_all_that_it_has_set(
    plan: Plan, tmp_path: Path, options: list[str], texts: list[str]
) -> None:
    """What a run depends on has each of these; a plan without one asks for another run."""
    given = plan.with_inputs([parse_assignment(text) for text in texts])
    parts = [share(tmp_path / f"{n}", given, ALL[n::2], options) for n in range(2)]
    assert (done := joined(tmp_path / "all", *parts)).runs == 5
    assert (done.statistics, done.missing) == (2, [])
    found = rows(tmp_path / "all" / "cases.csv")
    for column, _, value in (text.partition("=") for text in texts):
        assert {row[column] for row in found} == {value}
    for missing in texts:
        less = plan.with_inputs([parse_assignment(text) for text in texts if text != missing])
        other = share(tmp_path / "less", less, ["m"], options)
        with pytest.raises(UserError, match="is not what it was run with"):
            joined(tmp_path / "none", other)


@pytest.mark.parametrize("file", ["probe.nc", "machine.toml"])
def test_a_share_whose_files_are_others_now_is_refused(
    plan: Plan, tmp_path: Path, file: str
) -> None:
    one = share(tmp_path / "one", plan, ALL)
    (tmp_path / file).write_text("[machine]\n\n", encoding="utf-8")
    with pytest.raises(UserError, match="depends on is not what it was run with") as refused:
        joined(tmp_path / "all", one)
    assert (refused.value.file, refused.value.value) == (str(one), "probing-z-001")
    assert not (tmp_path / "all").exists()


@pytest.mark.long
def test_a_run_that_the_plan_has_no_more_is_left_out(plan: Plan, tmp_path: Path) -> None:
    """It is neither joined nor counted."""
    one = share(tmp_path / "one", plan, ALL)
    plan.path.write_text(TEXT.rpartition("m,probe.nc")[0], encoding="utf-8")
    done = joined(tmp_path / "all", one)
    assert (done.runs, done.missing, done.bare) == (4, [], [])
    assert [run.run for run in read_results(tmp_path / "all").runs][-1] == "probing-a"


@pytest.mark.long
def test_statistics_are_over_whole_cases_and_kept_by_what_they_depend_on(
    plan: Plan, tmp_path: Path
) -> None:
    """Of case z all runs are there, of case a one: `--resume` runs the other one."""
    one = share(tmp_path / "one", plan, ["z-001", "m"])
    other = share(tmp_path / "other", plan, ["z-002", "a-002"])
    done = joined(tmp_path / "all", one, other)
    assert (done.runs, done.statistics, done.missing) == (4, 1, ["probing-a-001"])
    found = {run.run: run for run in read_results(tmp_path / "all").runs}
    assert list(found) == [f"probing-{name}" for name in ("z-001", "z-002", "z", "a-002", "m")]
    of_z, _ = plan.statistics
    assert found["probing-z"].case[DEPENDS] == depends_sha256(of_z) != ""
    assert found["probing-z"].case["runs"] == "2"


@pytest.mark.long
@pytest.mark.parametrize(
    ("select", "runs", "statistics"),
    [
        ("z-001", ["z-001"], []),
        ("z-001 or m", ["z-001", "m"], []),
        ("z-0", ["z-001", "z-002"], ["z"]),
        ("not z-001", ["z-002", "a-001", "a-002", "m"], ["a"]),
        ("z-0 or a-0", ["z-001", "z-002", "a-001", "a-002"], ["z", "a"]),
    ],
)
def test_statistics_of_a_choice_are_those_whose_runs_are_all_chosen(
    plan: Plan, tmp_path: Path, select: str, runs: list[str], statistics: list[str]
) -> None:
    """A row of which a run was not asked for is neither judged nor missing: all is there."""
    words = ["-k", select]
    parts = [share(tmp_path / f"{n}", plan, runs[n::2], words) for n in range(2)]
    done = joined(tmp_path / "all", *parts)
    assert (done.runs, done.statistics, done.missing) == (len(runs), len(statistics), [])
    found = read_results(tmp_path / "all")
    assert {run.run.removeprefix("probing-") for run in found.runs} == {*runs, *statistics}
    assert (found.missing, found.manifest["finished"]) == (0, True)
    assert found.runs_planned == len(runs) + len(statistics)


@pytest.mark.long
def test_a_row_that_the_joined_folder_completes_is_judged_with_what_it_has(
    plan: Plan, tmp_path: Path
) -> None:
    """The one run of case z comes with the first call, the other one with the second."""
    for name, statistics in (("z-001", 0), ("m", 0), ("z-002", 1)):
        one = share(tmp_path / name, plan, [name], ["-k", f"probing-{name}"])
        assert joined(tmp_path / "all", one).statistics == statistics
    found = read_results(tmp_path / "all")
    assert [run.run for run in found.runs] == [
        f"probing-{name}" for name in ("z-001", "z-002", "z", "m")
    ]
    assert (found.missing, found.manifest["finished"]) == (0, True)
    assert joined(tmp_path / "all", one, is_fresh=True).statistics == 0


@pytest.mark.long
@pytest.mark.parametrize("is_fresh", [False, True])
def test_shares_that_are_joined_once_more_give_the_same_folder(
    plan: Plan, tmp_path: Path, is_fresh: bool
) -> None:
    parts = [share(tmp_path / name, plan, ALL[n::2]) for n, name in enumerate("ab")]
    first = joined(tmp_path / "all", *parts)
    before = [rows(tmp_path / "all" / name) for name in ("cases.csv", "results.csv")]
    again = joined(tmp_path / "all", *parts, is_fresh=is_fresh)
    assert (again.runs, again.statistics, again.missing) == (5, 2, []) == (
        first.runs, first.statistics, first.missing,
    )  # fmt: skip
    assert [rows(tmp_path / "all" / name) for name in ("cases.csv", "results.csv")] == before
    found = read_results(tmp_path / "all")
    assert (found.runs_planned, found.manifest["finished"]) == (7, True)
    assert "earlier" not in found.manifest


def test_what_is_missing_is_named_in_the_order_of_the_plan(plan: Plan, tmp_path: Path) -> None:
    done = joined(tmp_path / "all", share(tmp_path / "one", plan, ["a-001"]))
    assert done.missing == [f"probing-{name}" for name in ALL if name != "a-001"]
    assert (done.runs, done.statistics) == (1, 0)


def test_probes_of_a_search_come_with_it(write_plan: PlanWriter, tmp_path: Path) -> None:
    """100, 900: both hold, so there are two of them, each with its row and its trace."""
    one = share(tmp_path / "one", read_plan(write_plan(SEARCHES)), ["s"])
    done = joined(tmp_path / "all", one)
    assert (done.runs, done.missing, done.bare) == (1, [], [])
    ids = [run.run for run in read_results(one).runs]
    assert len(ids) == 3
    assert [run.run for run in read_results(tmp_path / "all").runs] == ids
    traces = sorted(path.name for path in (one / "traces").iterdir())
    assert sorted(path.name for path in (tmp_path / "all" / "traces").iterdir()) == traces
    assert len(traces) == 2


@pytest.mark.long
def test_probes_of_a_joined_search_are_those_of_its_last_call(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    """Two in place of the four that were joined before; those of another search stay."""
    finer = (
        SEARCHES.replace("to 400", "to 200") + "t,probe.nc,machine.toml,100 .. 900 to 400,<= 2,\n"
    )
    plan = read_plan(write_plan(finer))
    joined(tmp_path / "all", share(tmp_path / "one", plan, ["s", "t"], limit=600.0))
    ids = {run.run.removeprefix("probing-") for run in read_results(tmp_path / "all").runs}
    assert ids == {
        *("s", "s-s01", "s-s02", "s-s03", "s-s04"),  # 100, 900, 500, 700
        *("t", "t-s01", "t-s02", "t-s03"),  # 100, 900, 500
    }
    joined(tmp_path / "all", share(tmp_path / "two", plan, ["s"]))
    ids = {run.run.removeprefix("probing-") for run in read_results(tmp_path / "all").runs}
    assert ids == {"s", "s-s01", "s-s02", "t", "t-s01", "t-s02", "t-s03"}
    traces = {path.stem for path in (tmp_path / "all" / "traces").iterdir()}
    assert traces == {f"probing-{run}" for run in ids if len(run) > 1}


@pytest.mark.long
def test_the_joined_folder_may_be_made_anew_but_is_none_of_its_parts(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However the folder is written. Without --fresh what was there stays."""
    one = share(tmp_path / "one", plan, ["m"])
    monkeypatch.chdir(tmp_path)
    for name in (one, Path("one"), Path("all/../one")):
        (tmp_path / "all").mkdir(exist_ok=True)
        with pytest.raises(UserError, match="one of those to join"):
            joined(name, one)
    share(tmp_path / "all", plan, ["z-001"])
    for is_fresh, names in ((False, ["z-001", "m"]), (True, ["m"])):
        joined(tmp_path / "all", one, is_fresh=is_fresh)
        found = [run.run for run in read_results(tmp_path / "all").runs]
        assert found == [f"probing-{name}" for name in names]


@pytest.mark.long
def test_the_manifest_names_the_parts_and_a_command_that_goes_on(
    plan: Plan, tmp_path: Path
) -> None:
    """The words of a share that change no result are not those of the whole."""
    words = ["--shard", "1/2", "-x", "--force"], ["--shard=2/2", "-qv", "--force", "--yes"]
    parts = [share(tmp_path / name, plan, [], of) for name, of in zip("ab", words, strict=True)]
    done = joined(tmp_path / "all", *parts)
    assert done.report is None
    made = json.loads((tmp_path / "all" / MANIFEST).read_text(encoding="utf-8"))
    assert made["merged"] == [str(part) for part in parts]
    assert made["command"] == [
        "axisrig", "run", str(plan.path), "--force", "-o", str(tmp_path / "all"),
    ]  # fmt: skip
    report = joined(tmp_path / "all", *parts, is_fresh=True, build_report=lambda of: of / "r.html")
    assert report.report == tmp_path / "all" / "r.html"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"command": ["axisrig", "judge", "one"]}, "does not come from `axisrig run`"),
        ({"command": []}, "does not come from `axisrig run`"),
        ({"sources_sha256": ""}, "the manifest has no sources_sha256"),
        ({"plans": []}, "the manifest has no plans"),
        ({"sources_sha256": "0" * 64}, "other axisrig than"),
    ],
)
@pytest.mark.parametrize("place", [0, 1])
def test_a_folder_of_something_else_is_refused(
    plan: Plan, tmp_path: Path, changes: dict[str, Any], words: str, place: int
) -> None:
    parts = [share(tmp_path / name, plan, []) for name in ("one", "other")]
    file = parts[place] / MANIFEST
    known = json.loads(file.read_text(encoding="utf-8"))
    file.write_text(json.dumps(known | changes), encoding="utf-8")
    with pytest.raises(UserError, match=words):
        joined(tmp_path / "all", *parts)
    assert not (tmp_path / "all").exists()


def test_other_plans_are_named_with_those_of_the_first_folder(
    write_plan: PlanWriter, plan: Plan, tmp_path: Path
) -> None:
    one = share(tmp_path / "one", plan, [])
    other = read_plan(write_plan(TEXT.replace("NEG", "POS"), "other.csv"))
    two = share(tmp_path / "two", other, [])
    with pytest.raises(UserError, match="not of one campaign: other plans than") as refused:
        joined(tmp_path / "all", one, two)
    assert refused.value.file == str(two)
    assert str(refused.value.value).startswith("other (")
    assert str(refused.value.allowed).startswith("probing (")
