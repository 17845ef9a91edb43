"""Parts of a call of `axisrig run`: which runs, how many processes, what is written and shown."""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import campaign
from axisrig.bench.campaign.campaign import Campaign, Choice, show_campaign
from axisrig.bench.campaign.plan_files import plans_in
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.resuming import CHANGED
from axisrig.bench.campaign.sharing import Shard
from axisrig.bench.plan import plan as plan_module
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

PASS, MARGINAL, INCONCLUSIVE, FAIL, ERROR = (
    Verdict.PASS, Verdict.MARGINAL, Verdict.INCONCLUSIVE, Verdict.FAIL, Verdict.ERROR,
)  # fmt: skip


def case_of(run: str, runs: tuple[str, ...] = (), rig: str = "r.toml") -> Case:
    return Case("p", run, run, 0, Path("a.nc"), Path(rig), {}, (), "", (), "", 1, 0,
                Path("p.csv"), 2, {}, runs=runs)  # fmt: skip


def result(verdict: Verdict, run: str = "a", **more: Any) -> CaseResult:
    return CaseResult(case_of(run), verdict, [], **more)


@pytest.mark.parametrize(
    ("results", "kept", "planned", "failure", "code", "is_interrupted"),
    [
        ([PASS], [], 1, None, 0, False),
        ([PASS, MARGINAL], [], 2, None, 0, False),
        ([PASS, INCONCLUSIVE, MARGINAL], [], 3, None, 3, False),
        ([PASS], [FAIL], 1, None, 1, False),
        ([INCONCLUSIVE, FAIL], [], 2, None, 1, False),
        ([ERROR, FAIL], [], 2, None, 4, False),
        ([PASS], [], 2, None, 4, True),
        ([PASS], [], 1, OSError("full"), 4, True),
        ([ERROR], [], 2, None, 4, True),
        ([], [PASS], 0, None, 0, False),
        ([], [], 0, None, 4, False),
    ],
)
def test_a_campaign_ends_by_its_worst_verdict_and_by_what_is_missing(
    results: list[Verdict], kept: list[Verdict], planned: int, failure: OSError | None,
    code: int, is_interrupted: bool,
) -> None:  # fmt: skip
    """Exit codes as in docs/commands.md; where nothing is judged nothing has passed."""
    left = Campaign(Path(), [result(one) for one in results], planned, failure, kept=kept)
    assert (left.exit_code, left.is_interrupted) == (code, is_interrupted)


def test_what_went_wrong_goes_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    done = Campaign(Path("out"), [result(PASS)], 1, report=Path("out/report.html"))
    show_campaign(done)
    out, err = capsys.readouterr()
    assert out.splitlines()[-1] == str(Path("out/report.html"))
    assert err == "1 pass in 0 s\n"
    for statistics, word in ((0, "runs"), (1, "rows")):
        show_campaign(
            Campaign(Path("out"), [result(PASS)], 3, OSError(28, "No space left", "out/x"),
                     kept=[FAIL, PASS], statistics=statistics, altered=["a run was changed"])
        )  # fmt: skip
        out, err = capsys.readouterr()
        lines = err.splitlines()
        assert lines[:2] == ["a run was changed; it was run again", "kept 2 runs, ran 1"]
        assert lines[2].startswith("error: ")
        assert "No space left" in lines[2]
        assert lines[3] == f"interrupted: 1 of 3 {word} are in out"
        assert "report" not in out
    show_campaign(Campaign(Path("out"), [], 0))
    assert capsys.readouterr() == ("", "")


def test_the_plans_of_a_folder_are_its_own_tables_by_name(tmp_path: Path) -> None:
    for name in ("b.csv", "a.XLSX", "notes.txt", "sub/c.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert [path.name for path in plans_in(tmp_path)] == ["a.XLSX", "b.csv"]
    (tmp_path / "empty").mkdir()
    for folder, message in (("empty", "the folder holds no plan"), ("gone", "no folder with")):
        with pytest.raises(UserError, match=message):
            plans_in(tmp_path / folder)


# Which runs


def plan_of(*runs: str) -> Any:
    return SimpleNamespace(cases=tuple(case_of(run) for run in runs), name=runs[0])


def test_a_call_runs_what_fits_and_a_share_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "replace", lambda plan, **new: SimpleNamespace(**new))
    monkeypatch.setattr(plan_module, "replace", lambda plan, **new: SimpleNamespace(**new))
    monkeypatch.setattr(
        plan_module, "chosen", lambda cases, word: tuple(c for c in cases if word in c.run)
    )
    plans = [plan_of("a1", "a2", "b1"), plan_of("b2", "a3")]

    def found(choice: Choice) -> tuple[list[list[str]], list[str]]:
        parts, cases = campaign._chosen(plans, choice)
        return [[case.run for case in part.cases] for part in parts], [case.run for case in cases]

    assert found(Choice()) == ([["a1", "a2", "b1"], ["b2", "a3"]], ["a1", "a2", "b1", "b2", "a3"])
    assert found(Choice("a")) == ([["a1", "a2"], ["a3"]], ["a1", "a2", "a3"])
    assert found(Choice("a", Shard(2, 3))) == ([["a2"], []], ["a2"])
    for choice, message in (
        (Choice("z"), "no case fits"), (Choice("b2", Shard(2, 2)), "more shares than runs"),
    ):  # fmt: skip
        with pytest.raises(UserError, match=message):
            found(choice)


FED = """\
case,program,rig,plc:V.E.FEED,search:plc:V.E.STEP,check:duration_s
swept,a.nc,r.toml,[600 | 900],,<= 1
single,a.nc,r.toml,500,,<= 1
other,a.nc,r.toml,,,<= 1
tried,a.nc,r.toml,700,10 .. 90 to 20,<= 1
"""


@pytest.fixture
def fed(tmp_path: Path) -> Path:
    (tmp_path / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[machine]\n[info]\ndevice = 'drill'\n", encoding="utf-8")
    (tmp_path / "fed.csv").write_text(FED, encoding="utf-8")
    return tmp_path / "fed.csv"


@pytest.mark.parametrize(
    ("text", "select", "refused"),
    [
        ("plc:V.E.FEED=800", "single or other or tried", None),
        ("plc:V.E.FEED=800", "not swept", None),
        ("plc:V.E.FEED=800", None, "swept"),
        ("plc:V.E.FEED=800", "fed-swept-900", "swept"),
        ("plc:V.E.FEED=800", "single or swept", "swept"),
        ("plc:V.E.STEP=20", "swept or single", None),
        ("plc:V.E.STEP=20", None, "tried"),
        ("plc:V.E.STEP=20", "tried", "tried"),
        ("plc:V.E.NEW=1", None, None),
    ],
)
def test_an_input_of_the_call_is_refused_only_by_a_chosen_row_that_has_several_values(
    fed: Path, text: str, select: str | None, refused: str | None
) -> None:
    """A list, or a search; the row that -k leaves out keeps its own."""
    column, _, value = text.partition("=")
    if refused is not None:
        with pytest.raises(UserError, match=f"gives this column several values.*'{refused}'"):
            campaign._read([fed], [text], select, None, {})
        return
    (plan,) = campaign._read([fed], [text], select, None, {})
    found = {case.run.removeprefix("fed-"): case.inputs.get(column) for case in plan.cases}
    assert list(found) == ["swept-600", "swept-900", "single", "other", "tried"]
    own = {"swept-600": "600", "swept-900": "900"} if column == "plc:V.E.FEED" else {}
    own |= {"tried": None} if column == "plc:V.E.STEP" else {}
    assert found == {run: own.get(run, value) for run in found}


def test_every_plan_of_a_call_has_its_inputs_its_interface_and_what_is_tested(fed: Path) -> None:
    """What the call says of an interface comes after its inputs; its words win over the rig."""
    other = fed.with_name("more.csv")
    other.write_text("case,program,rig\nalone,a.nc,r.toml\n", encoding="utf-8")
    asked: list[str] = []
    chosen: list[list[str]] = []

    def changes_of(plan: Any) -> list[Any]:
        asked.append(plan.name)
        chosen.append([case.case for case in plan.cases])
        return [parse_assignment(f"plc:V.E.OF={plan.name}")]

    outside: Any = SimpleNamespace(changes_of=changes_of)
    plans = campaign._read(
        [fed.parent], ["plc:V.E.A=1", "plc:V.E.OF=x"], None, outside, {"serial": "7"}
    )
    assert [plan.name for plan in plans] == asked == ["fed", "more"]
    for plan in plans:
        for case in plan.cases:
            assert (case.inputs["plc:V.E.A"], case.inputs["plc:V.E.OF"]) == ("1", plan.name)
            assert case.notes == {"info:device": "drill", "info:serial": "7"}
    assert [len(cases) for cases in chosen] == [5, 1]
    chosen.clear()
    campaign._read([fed.parent], [], "single", outside, {})
    assert chosen == [["single"], []]  # the rigs of other rows say nothing about the interface
    (plain,) = campaign._read([other], [], None, None, {"device": "saw"})
    assert plain.cases[0].notes == {"info:device": "saw"}


def test_a_row_of_statistics_comes_after_the_last_of_its_runs() -> None:
    places = {"a": 0, "b": 1, "c": 2}
    rows = [("s", ("a", "c")), ("c", ()), ("t", ("a",)), ("u", ("gone",)), ("b", ()), ("a", ())]
    results = [CaseResult(case_of(run, runs), PASS, []) for run, runs in rows]
    results.sort(key=lambda one: campaign._place(places, one))
    assert [one.case.run for one in results] == ["u", "a", "t", "b", "c", "s"]


def test_how_many_processes_run_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "usable_cores", lambda: 4)
    monkeypatch.setattr(sys, "gettrace", lambda: None)
    cases = [case_of(f"{n}") for n in range(9)]

    def jobs(number: int | None, count: int = 9, real: bool = False, is_apart: bool = False) -> int:
        return campaign._jobs(number, cases[:count], ["rig"] * real, is_apart=is_apart)

    assert [jobs(None), jobs(None, 3), jobs(2), jobs(1), jobs(7)] == [4, 3, 2, 1, 7]
    assert jobs(None, real=True) == 1
    monkeypatch.setattr(sys, "gettrace", lambda: print)
    assert (jobs(None), jobs(3)) == (1, 3)  # under a debugger
    for number, is_apart in ((2, False), (1, True), (None, True)):
        with pytest.raises(UserError, match="driven from this process"):
            jobs(number, real=True, is_apart=is_apart)
    assert [campaign._one_at_a_time(number, None) for number in (None, 1)] == [1, 1]
    for number, scheduler in ((2, None), (None, "tcp://x"), (1, "tcp://x")):
        with pytest.raises(UserError, match="one run at a time"):
            campaign._one_at_a_time(number, scheduler)


@pytest.mark.parametrize(
    ("assignments", "folder"),
    [
        ([], "out/one-two"),
        ([FORCED], "out/one-two"),
        ([AS_CANOPEN, FORCED], "out/one-two"),
        (["plc:V.E.A=1"], "out/one-two-set"),
        ([FORCED, "plc:V.E.A=1"], "out/one-two-set"),
    ],
)
def test_changed_inputs_have_a_folder_of_their_own(assignments: list[str], folder: str) -> None:
    plans: Any = [SimpleNamespace(name=name) for name in ("one", "two")]
    assert campaign._default_folder(plans, assignments) == Path(folder)


def test_rigs_that_are_foreign_run_apart_and_notes_of_plans_are_warnings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: dict[str, Any] = {}

    def prepare_all(cases: Any, **given: Any) -> list[str]:
        asked.update(given)
        return ["of a cell"]

    monkeypatch.setattr(campaign, "prepare_all", prepare_all)
    monkeypatch.setattr(campaign, "foreign_rigs", lambda rigs: {r for r in rigs if r.stem == "f"})
    cases = [case_of("a"), case_of("b", rig="f.toml"), case_of("c")]
    plan: Any = SimpleNamespace(path=Path("p.csv"), notes=["odd"], cases=cases)
    other: Any = SimpleNamespace(path=Path("q.csv"), notes=["even", "late"], cases=[])
    heard: list[str] = []
    how: tuple[Any, ...] = (False, 5.0, 3, campaign.Manner(), heard.extend)
    apart, warnings = campaign._prepared([plan, other], cases[:2], *how)
    assert set(apart) == {Path("f.toml")}
    assert warnings == heard == ["of a cell", "p.csv: odd", "q.csv: even", "q.csv: late"]
    assert (asked["call_limit_s"], asked["jobs"], asked["apart"]) == (5.0, 3, apart)
    assert [case.run for case in asked["beside"]] == ["c"]
    apart, _ = campaign._prepared([plan], cases, True, 5.0, 3)
    assert set(apart) == {Path("r.toml"), Path("f.toml")}


def test_rows_that_are_not_chosen_may_use_a_default_in_every_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr(campaign, "prepare_all", lambda cases, **given: asked.update(given) or [])
    monkeypatch.setattr(campaign, "foreign_rigs", lambda _: set())
    plans: list[Any] = [
        SimpleNamespace(
            path=Path(f"{name}.csv"), notes=[], cases=[case_of(f"{name}{n}") for n in "12"]
        )
        for name in "pqr"
    ]
    chosen = [plans[0].cases[1], plans[2].cases[0]]
    campaign._prepared(plans, chosen, False, 5.0, 1)
    assert [case.run for case in asked["beside"]] == ["p1", "q1", "q2", "r2"]
    said: list[str] = []
    campaign._prepared(plans, chosen, False, 5.0, 1, campaign.Manner(say=said.append))
    assert said == ["checking 2 runs"]


# What comes of them


def test_a_run_whose_files_changed_meanwhile_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    now = {"a": "1", "b": "2"}
    monkeypatch.setattr(campaign, "depends_sha256", lambda case: now[case.run])

    def running() -> Iterator[CaseResult]:
        yield result(PASS, "a", wall_s=1.0)
        yield result(PASS, "b", wall_s=2.0)

    first, second = campaign._dated(
        running(), {"a": "1", "b": "other"}, lambda ago_s: f"{ago_s:g} s ago"
    )
    assert (first.verdict, first.depends_sha256) == (PASS, "1")
    assert (second.verdict, second.error, second.wall_s) == (ERROR, CHANGED, 2.0)
    assert second.depends_sha256 == "2"
    assert (first.timestamp, second.timestamp) == ("1 s ago", "2 s ago")


def test_statistics_come_with_their_hash_those_that_stay_first() -> None:
    def row(run: str) -> CaseResult:
        return CaseResult(case_of(run), PASS, [])

    statistics: Any = SimpleNamespace(
        kept=lambda: iter([row("s0")]),
        after=lambda one: iter([row("s1")] if one.case.run == "b" else []),
    )
    running = (row(run) for run in "abc")
    hashes = {"s0": "h0", "s1": "h1"}
    found = list(campaign._with_statistics(running, statistics, hashes))
    assert [(one.case.run, one.depends_sha256) for one in found] == [
        ("s0", "h0"), ("a", ""), ("b", ""), ("s1", "h1"), ("c", ""),
    ]  # fmt: skip


class Beside:
    """Something that is open while results are written."""

    def __init__(self) -> None:
        self.is_open = False

    def __enter__(self) -> "Beside":
        self.is_open = True
        return self

    def __exit__(self, *_: object) -> None:
        self.is_open = False


@pytest.mark.parametrize("fails_at", [None, 1])
def test_results_are_written_as_they_come_until_a_disk_is_full(fails_at: int | None) -> None:
    results: list[CaseResult] = []
    written: list[str] = []
    shown: list[str] = []
    closed: list[bool] = []

    class Writer(Beside):
        def add(self, one: CaseResult) -> None:
            if len(written) == fails_at:
                raise OSError("full")
            written.append(one.case.run)

    class Progress(Beside):
        def show(self, one: CaseResult) -> None:
            shown.append(one.case.run)

    def running() -> Iterator[CaseResult]:
        try:
            yield from (result(PASS, run) for run in "abc")
        finally:
            closed.append(True)

    watch: Any = SimpleNamespace(beside=lambda _: Beside())
    error = campaign._write(running(), Writer(), results, Progress(), watch)  # type: ignore[arg-type]
    done = ["a", "b", "c"][:fails_at]
    assert written == shown == [one.case.run for one in results] == done
    assert closed == [True]
    assert (str(error) == "full") is (fails_at is not None)


def test_the_first_that_went_wrong_is_the_failure() -> None:
    full, other = OSError("full"), OSError("other")

    def breaks(error: Exception) -> Any:
        def build(_: Path) -> Path:
            raise error

        return build

    def good(folder: Path) -> Path:
        return folder / "r"

    assert campaign._report(good, Path("o"), None) == (Path("o/r"), None)
    assert campaign._report(good, Path("o"), full) == (Path("o/r"), full)
    assert campaign._report(None, Path("o"), full) == (None, full)
    assert campaign._report(breaks(other), Path("o"), None) == (None, other)
    assert campaign._report(breaks(other), Path("o"), full) == (None, full)
    assert campaign._report(breaks(UserError("gone")), Path("o"), full) == (None, full)
    with pytest.raises(UserError, match="gone"):
        campaign._report(breaks(UserError("gone")), Path("o"), None)


def test_a_cluster_runs_cases_where_one_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "run_on_cluster", lambda *given: ("cluster", given[2]))
    monkeypatch.setattr(campaign, "run_cases", lambda *given, **more: ("here", given[2], more))
    how: Any = (3, None, None, "hardware", "progress")
    files: Any = None
    assert campaign._running([], files, "tcp://x", *how) == ("cluster", "tcp://x")
    assert campaign._running([], files, None, *how) == (
        "here", 3, {"hardware": "hardware", "follower": "progress"},
    )  # fmt: skip


def test_hashes_are_of_runs_and_of_rows_of_statistics(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "depends_sha256", lambda case: f"h{case.run}")
    plan: Any = SimpleNamespace(statistics=[case_of("s", ("a",))])
    found = campaign._hashes([plan], [replace(case_of("a"), title="t"), case_of("b")])
    assert found == {"a": "ha", "b": "hb", "s": "hs"}
