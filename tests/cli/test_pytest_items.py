"""Rows as pytest items, in this process: what a row hands over to the results folder."""

import csv
import errno
import io
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.campaign import pytest_plugin
from axisrig.bench.campaign.pytest_plugin import (
    STORED,
    CaseFailedError,
    CaseItem,
    Outcome,
    PlanFile,
    RowItem,
    StatisticItem,
    _Plans,
    has_conftest,
    is_plan,
)
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, RunFiles
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.cli.pytest_results import ResultsOfPytest, Staging
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.probes import probe_id
from axisrig.bench.plan.verdict import Verdict, exit_code

PLANS = Path(__file__).parents[2] / "testplans"


def test_a_row_that_pytest_runs_is_kept_by_what_it_depends_on(tmp_path: Path) -> None:
    """The hash that `axisrig run` writes, and the files of its probes; nothing stays behind."""
    case = read_plan(PLANS / "latch_accuracy.csv").cases[0]
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    files = staging.files_of(case.run)
    assert files.trace is not None
    (log,) = files.bus_logs
    files.trace.write_bytes(b"trace")
    log.write_bytes(b"log")
    row: Any = SimpleNamespace(path=tmp_path / "p.csv")
    outcome = Outcome.unpacked(staging._packed(row, CaseResult(case, Verdict.PASS, [])))
    assert outcome.result.depends_sha256 == depends_sha256(case) != ""
    assert outcome.files == {f"{case.run}.parquet": b"trace", f"{case.run}.blf": b"log"}
    assert not files.trace.exists()
    assert not log.exists()
    staging.pytest_unconfigure()
    assert not log.parent.exists()


@pytest.mark.parametrize("is_kept", [True, False])
def test_files_of_a_row_and_of_each_probe_go_to_their_own_places(
    is_kept: bool, tmp_path: Path
) -> None:
    """A row that searched with two probes; a results folder without bus logs has the series."""
    case = read_plan(PLANS / "latch_accuracy.csv").cases[0]
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    runs = [case.run, *(probe_id(case.run, number) for number in (1, 2))]
    row, *probes = (CaseResult(replace(case, run=run), Verdict.PASS, []) for run in runs)
    row.probes = probes
    staged = staging.files_of(case.run)
    for run, place in zip(runs, (staged, *staged.probes[:2]), strict=True):
        assert place.trace is not None
        (log,) = place.bus_logs
        place.trace.write_text(f"series of {run}")
        log.write_text(f"log of {run}")
        log.with_name(f"{run}{SEGMENT_MARK}can2.pcap").write_text(f"can2 of {run}")
    packed = staging._packed(SimpleNamespace(path=tmp_path / "p.csv"), row)  # type: ignore[arg-type]
    assert list(log.parent.iterdir()) == []
    staging.pytest_unconfigure()

    own = [RunFiles([tmp_path / f"{run}.blf"] * is_kept, tmp_path / f"{run}.parquet")
           for run in runs]  # fmt: skip
    added: list[CaseResult] = []
    writer: Any = SimpleNamespace(
        files_of=lambda _: RunFiles(own[0].bus_logs, own[0].trace, own[1:]), add=added.append
    )
    ResultsOfPytest._put(writer, Outcome.unpacked(packed))
    words = {f"{run}.parquet": f"series of {run}" for run in runs}
    for run in runs if is_kept else ():
        words |= {f"{run}.blf": f"log of {run}"}
        words |= {f"{run}{SEGMENT_MARK}can2.pcap": f"can2 of {run}"}
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == words
    (written,) = added
    assert [one.case.run for one in (written, *written.probes)] == runs
    assert all(one.series is not None for one in (written, *written.probes))


HEAD = "case,program,rig\n"


def folder_of_pytest(root: Path) -> ResultsOfPytest:
    """Results into `out`, of a pytest whose root holds two plans and a table that is none."""
    (root / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (root / "r.toml").write_text("[machine]\n", encoding="utf-8")
    for name, cases in (("p.csv", "abc"), ("q.csv", "de"), ("wrong.csv", "f")):
        rows = "".join(f"{case},a.nc,{'none' if case == 'f' else 'r'}.toml\n" for case in cases)
        (root / name).write_text(HEAD + rows, encoding="utf-8")
    return ResultsOfPytest(SimpleNamespace(rootpath=root), root / "out")  # type: ignore[arg-type]


def test_the_folder_of_pytest_is_for_the_rows_that_it_runs(tmp_path: Path) -> None:
    """Of several plans, whoever found them, and of nothing else that pytest collects."""
    found = folder_of_pytest(tmp_path)
    found.pytest_xdist_node_collection_finished(["test_a.py::test_b[p.csv]", "test_a.py"])
    assert not (tmp_path / "out").exists()
    found.pytest_xdist_node_collection_finished(
        ["p.csv::p-c", "q.csv::q-d", "test_a.py::test_b", "p.csv::p-a"]
    )
    found.pytest_xdist_node_collection_finished(["q.csv::q-e"])  # of the next worker
    plans = json.loads((tmp_path / "out/manifest.json").read_text(encoding="utf-8"))["plans"]
    assert [(plan["name"], plan["runs"]) for plan in plans] == [("p", 2), ("q", 1)]
    for run in ("p-a", "p-c", "q-d"):
        case = next(c for n in "pq" for c in read_plan(tmp_path / f"{n}.csv").cases if c.run == run)
        result = CaseResult(case, Verdict.ERROR, [], error="not run")
        report = SimpleNamespace(axisrig_outcome=Outcome(tmp_path, result, {}).packed())
        found.pytest_runtest_logreport(report)  # type: ignore[arg-type]
        assert not hasattr(report, "axisrig_outcome")
    found.pytest_runtest_logreport(SimpleNamespace())  # type: ignore[arg-type]
    text = (tmp_path / "out/cases.csv").read_text(encoding="utf-8")
    with io.StringIO(text) as file:
        assert [row["run"] for row in csv.DictReader(file)] == ["p-a", "p-c", "q-d"]


def test_a_plan_with_a_mistake_is_one_of_who_called_pytest(tmp_path: Path) -> None:
    with pytest.raises(pytest.UsageError, match=r"wrong\.csv"):
        folder_of_pytest(tmp_path).pytest_xdist_node_collection_finished(["wrong.csv::wrong-f"])


def test_a_folder_that_cannot_be_written_ends_pytest_as_aborted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reports that come after it are not written; what was is closed, even if that fails too."""
    found = folder_of_pytest(tmp_path)
    found.pytest_xdist_node_collection_finished(["p.csv::p-a"])
    case = read_plan(tmp_path / "p.csv").cases[0]
    packed = Outcome(tmp_path, CaseResult(case, Verdict.PASS, []), {}).packed()

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "out/cases.csv")

    close, closed = ResultsWriter.close, list[ResultsWriter]()

    def closing(writer: ResultsWriter) -> None:
        closed.append(writer)
        close(writer)
        full()

    monkeypatch.setattr(ResultsOfPytest, "_put", staticmethod(full))
    monkeypatch.setattr(ResultsWriter, "close", closing)
    with pytest.raises(pytest.exit.Exception, match="No space left on device") as caught:
        found.pytest_runtest_logreport(SimpleNamespace(axisrig_outcome=packed))  # type: ignore[arg-type]
    assert caught.value.returncode == exit_code(Verdict.ABORTED) == 4
    try:
        found.pytest_runtest_logreport(SimpleNamespace(axisrig_outcome=packed))  # type: ignore[arg-type]
    except pytest.exit.Exception:  # it would end this run of pytest
        pytest.fail("the report after it was written")
    found.pytest_sessionfinish()
    assert len(closed) == 1
    assert not (tmp_path / "out/report.html").exists()


# What is a plan, and its rows


@pytest.mark.parametrize(
    ("name", "text", "is_it"),
    [
        ("a.csv", "case,program,rig\n", True),
        ("a.csv", "case,check:alarms\n", True),
        ("a.csv", "case,checks\n", True),
        ("a.csv", "case,limit\n", False),
        ("a.csv", "program,rig,check:alarms\n", False),
        ("a.csv", "", True),  # no table at all: its message is to be seen
        ("a.txt", "case,program,rig\n", False),
        ("a.xlsx", "no workbook", False),
    ],
)
def test_a_table_with_cases_and_one_more_column_is_a_plan(
    name: str, text: str, is_it: bool, tmp_path: Path
) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    assert is_plan(tmp_path / name) is is_it


@pytest.mark.parametrize(
    ("name", "is_it"), [("P.CSV", True), ("p.Csv", True), ("P.TXT", False), ("p", False)]
)
def test_the_letters_of_a_suffix_do_not_matter(name: str, is_it: bool, tmp_path: Path) -> None:
    """A table of another system; also one that cannot be read, which then says so."""
    (tmp_path / name).write_text("case,program,check:alarms\na,a.nc,none\n", encoding="utf-8")
    assert is_plan(tmp_path / name) is is_it
    (tmp_path / name).write_bytes(b"case,\xff\xfe\x00")
    assert is_plan(tmp_path / name) is is_it


def test_a_folder_is_one_of_plans_by_the_hook_of_its_own_conftest(tmp_path: Path) -> None:
    def conftest(folder: str, hook: object) -> Any:
        return SimpleNamespace(__file__=str(tmp_path / folder / "conftest.py"), **(
            {} if hook is None else {"pytest_addoption": hook}
        ))  # fmt: skip

    ours = pytest_plugin.pytest_addoption
    manager: Any = SimpleNamespace(
        get_plugins=lambda: [conftest("a", ours), conftest("b", len), conftest("c", None)]
    )
    found = [has_conftest(manager, tmp_path / folder) for folder in "abcd"]
    assert found == [True, False, False, False]


def test_a_table_is_collected_where_it_is_a_plan_in_a_folder_of_plans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where there is no entry point: a plan elsewhere is none of ours, another table nowhere."""
    conftest = SimpleNamespace(
        __file__=str(tmp_path / "plans/conftest.py"),
        pytest_addoption=pytest_plugin.pytest_addoption,
    )
    plans = _Plans(SimpleNamespace(get_plugins=lambda: [conftest]))  # type: ignore[arg-type]
    monkeypatch.setattr(
        PlanFile, "from_parent", classmethod(lambda cls, parent, path: (cls, parent, path))
    )
    parent: Any = object()
    for folder, name, text, is_one in (
        ("plans", "a.csv", "case,program,rig\n", True),
        ("plans", "b.csv", "case,limit\n", False),
        ("plans/below", "c.csv", "case,program,rig\n", False),
        ("other", "d.csv", "case,program,rig\n", False),
    ):
        path = tmp_path / folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        found: Any = plans.pytest_collect_file(path, parent)
        assert found == ((PlanFile, parent, path) if is_one else None), name


@pytest.mark.parametrize("texts", [[], ["a: bench of an older axisrig", "b: kernel of one"]])
def test_pytest_names_at_its_end_what_an_older_axisrig_has_left(
    texts: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pytest_plugin, "leftovers", lambda: texts)
    for write in (pytest_plugin.write_leftovers, _Plans(object()).pytest_terminal_summary):  # type: ignore[arg-type]
        lines: list[str] = []
        write(SimpleNamespace(write_line=lines.append))
        assert lines == [f"axisrig: {text}" for text in texts]


def test_each_row_is_an_item_and_statistics_share_what_runs_have_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Any] = []
    for item in (CaseItem, StatisticItem):
        monkeypatch.setattr(
            item, "from_parent",
            classmethod(lambda cls, _parent, **given: made.append((cls, given)) or cls),
        )  # fmt: skip
    runs = [SimpleNamespace(run=f"p-a-{n}", runs=()) for n in (1, 2)]
    whole = SimpleNamespace(run="p-a", runs=("p-a-1", "p-a-2"))
    plan = SimpleNamespace(cases=runs, rows=[*runs, whole], with_cases=lambda _: plan)
    monkeypatch.setattr(pytest_plugin, "read_plan", lambda _: plan)
    list(PlanFile.collect(SimpleNamespace(path=tmp_path)))  # type: ignore[arg-type]
    assert [(cls, given["name"]) for cls, given in made] == [
        (CaseItem, "p-a-1"), (CaseItem, "p-a-2"), (StatisticItem, "p-a"),
    ]  # fmt: skip
    assert made[2][1]["runs"] == runs
    assert len({id(given["sampled"]) for _, given in made}) == 1


# What an item does


CASE = read_plan(PLANS / "latch_accuracy.csv").cases[0]


def result_of(verdict: Verdict, *checks: tuple[str, str, float], **more: Any) -> CaseResult:
    found = [judge(parse_check(name, text, ""), value, 0.0) for name, text, value in checks]
    return CaseResult(CASE, verdict, found, **more)


CHECKS = (("latch_mm", "<= 5", 4.0), ("lag_mm_max", "<= 1", 2.0), ("overtravel_mm", "<= 1", 3.0))


@pytest.mark.parametrize("verdict", Verdict)
def test_what_is_worse_than_marginal_fails(verdict: Verdict) -> None:
    item: Any = SimpleNamespace(case=CASE, user_properties=[])
    result = result_of(verdict, *CHECKS)
    if verdict in (Verdict.PASS, Verdict.MARGINAL):
        RowItem.finish(item, result)
    else:
        with pytest.raises(CaseFailedError):
            RowItem.finish(item, result)
    assert item.result is result
    assert item.user_properties == [
        ("verdict", verdict.word), ("seed", str(CASE.seed)), ("frame_log_sha256", ""),
        ("latch_mm", "4.0"), ("lag_mm_max", "2.0"), ("overtravel_mm", "3.0"),
    ]  # fmt: skip
    over = SimpleNamespace(case=SimpleNamespace(runs=("a", "b")), user_properties=[])
    RowItem.finish(over, result_of(Verdict.PASS))  # type: ignore[arg-type]
    assert over.user_properties == [("verdict", "pass"), ("runs", "2")]


def test_a_failure_is_reported_in_the_words_of_its_checks() -> None:
    item: Any = SimpleNamespace(case=CASE)
    result = result_of(Verdict.FAIL, *CHECKS, error="it broke")
    result.log = ["a line of its log"]
    caught: Any = SimpleNamespace(value=CaseFailedError(result))
    shown = RowItem.repr_failure(item, caught)
    lines = shown.reprtraceback.reprentries[0].lines[0].splitlines()
    assert lines[0] == f"{CASE.file}:{CASE.line}: {CASE.run}: fail"
    assert [line.split(":")[0].strip() for line in lines[1:3]] == ["fail", "fail"]
    assert "lag_mm_max" in lines[1]
    assert "overtravel_mm" in lines[2]
    assert lines[3:] == ["a line of its log", "it broke"]
    assert (shown.reprcrash.path, shown.reprcrash.lineno) == (str(CASE.file), CASE.line)
    assert RowItem.reportinfo(item) == (CASE.file, CASE.line - 1, CASE.run)
    first = result_of(Verdict.FAIL, *CHECKS[1:])
    assert "lag_mm_max" in pytest_plugin._sentence(first)


class Asked:
    """Configuration of a run of pytest."""

    def __init__(self, timeout_s: float | None, stored: Any = None) -> None:
        self.stash: dict[Any, Any] = {} if stored is None else {STORED: stored}
        self._timeout_s = timeout_s

    def getoption(self, name: str, default: object = None) -> object:
        assert name == "axisrig_call_timeout"
        return self._timeout_s


@pytest.mark.parametrize("is_foreign", [True, False])
@pytest.mark.parametrize("timeout_s", [None, 5.0])
@pytest.mark.parametrize("is_stored", [True, False])
def test_a_row_runs_apart_where_its_rig_is_foreign_or_calls_are_limited(
    is_foreign: bool, timeout_s: float | None, is_stored: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {}

    def run_cases(cases: Any, files_of: Any, **given: Any) -> Any:
        asked.update(given, cases=cases, files=files_of("r"))
        return [result_of(Verdict.PASS, series="series")]

    monkeypatch.setattr(pytest_plugin, "run_cases", run_cases)
    monkeypatch.setattr(pytest_plugin, "foreign_rigs", lambda rigs: set(rigs) if is_foreign else ())
    stored = SimpleNamespace(files_of=lambda run: f"files of {run}", stopwatch="watch")
    kept: dict[str, CaseResult] = {}
    item: Any = SimpleNamespace(config=Asked(timeout_s, stored if is_stored else None),
                                _sampled=kept)  # fmt: skip
    RowItem.run_case(item, CASE)
    assert asked["cases"] == [CASE]
    limits = asked["limits"]
    assert limits.is_apart(CASE) is (is_foreign or timeout_s is not None)
    assert limits.call_limit_s == (timeout_s or pytest_plugin.CALL_LIMIT_S)
    assert (asked["files"] == "files of r") is is_stored
    assert (asked["stopwatch"] == "watch") is is_stored
    assert kept == {}  # no statistic asks for it
    sampled: Any = SimpleNamespace(rig=CASE.rig, run="p-a", sampled=("mean(m)",))
    RowItem.run_case(item, sampled)
    assert list(kept) == ["p-a"]
    assert kept["p-a"].series is None


def test_statistics_run_what_has_not_run_yet(monkeypatch: pytest.MonkeyPatch) -> None:
    runs: Any = [SimpleNamespace(run=f"p-a-{n}") for n in (1, 2, 3)]
    sampled: dict[str, Any] = {"p-a-2": "known"}
    ran: list[str] = []
    finished: list[Any] = []
    item: Any = SimpleNamespace(
        _runs=runs, _sampled=sampled, case="row", run_case=lambda case: ran.append(case.run),
        finish=finished.append,
    )  # fmt: skip
    monkeypatch.setattr(pytest_plugin, "judged_row", lambda *given: given)
    StatisticItem.runtest(item)
    assert ran == ["p-a-1", "p-a-3"]
    assert finished == [("row", runs, sampled)]


@pytest.mark.parametrize("is_foreign", [True, False])
def test_a_warning_of_a_cell_is_one_of_pytest_unless_another_row_may_use_it(
    is_foreign: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked = [SimpleNamespace(text=text, is_unused=unused)
              for text, unused in (("one", False), ("", False), ("two", True))]  # fmt: skip
    monkeypatch.setattr(pytest_plugin, "foreign_rigs", lambda rigs: set(rigs) if is_foreign else ())
    monkeypatch.setattr(pytest_plugin, "look_at", lambda case, prepared: prepared)
    monkeypatch.setattr(pytest_plugin, "prepare", lambda _: [] if is_foreign else looked)
    monkeypatch.setattr(pytest_plugin, "read_case", lambda _: looked if is_foreign else [])
    item: Any = SimpleNamespace(case=CASE)
    assert CaseItem._warnings(item) == ["one"]

    def broken(_: object) -> None:
        raise pytest_plugin.UserError("no rig")

    monkeypatch.setattr(pytest_plugin, "look_at", lambda case, _: broken(case))
    assert CaseItem._warnings(item) == []  # the run reports it


# Options, tags


def test_the_first_conftest_adds_the_option_where_no_entry_point_has() -> None:
    for known, is_added in (((), True), (("axisrig",), False), (("axisrig plans",), False)):
        added: list[Any] = []
        registered: list[str] = []
        group = SimpleNamespace(addoption=lambda *words, **more: added.append((words, more)))  # noqa: B023
        manager: Any = SimpleNamespace(
            has_plugin=known.__contains__,
            register=lambda _, name: registered.append(name),  # noqa: B023
        )
        parser: Any = SimpleNamespace(getgroup=lambda _: group)  # noqa: B023
        pytest_plugin.pytest_addoption(parser, manager)
        assert (len(added), registered) == (is_added, ["axisrig plans"] * is_added)
        for words, more in added:
            assert (words, more["type"], more["metavar"]) == (
                ("--axisrig-call-timeout",),
                float,
                "S",
            )


def test_a_tag_chooses_rows_and_is_no_mark_that_does_something(
    request: pytest.FixtureRequest,
) -> None:
    """`skip` of pytest, `long` of this project; a tag that is no name is a keyword alone."""
    tags = ("own_tag_of_a_plan", "skip", "long", "not-a-name")
    case = replace(CASE, tags=tags)
    item = CaseItem.from_parent(request.session, name="p-a", case=case, sampled={})
    assert item.case is case
    assert [mark.name for mark in item.iter_markers()] == ["own_tag_of_a_plan"]
    assert all(tag in item.keywords for tag in tags)
    others = pytest_plugin._marks_of_others(request.config)
    assert {"skip", "long", "provokes"} <= others
    assert "own_tag_of_a_plan" not in others
    again = CaseItem.from_parent(request.session, name="p-b", case=case, sampled={})
    assert [mark.name for mark in again.iter_markers()] == ["own_tag_of_a_plan"]
