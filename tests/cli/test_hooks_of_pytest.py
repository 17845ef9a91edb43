"""Hooks of the pytest plugin, called as pytest calls them: what goes from a row to a report."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import pytest_plugin
from axisrig.bench.campaign.pytest_plugin import CaseItem, Outcome, PlanFile, RowItem, StatisticItem
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.cli import pytest_plans
from axisrig.bench.cli.pytest_results import ResultsOfPytest, Staging
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

HEAD = "case,program,rig\n"


@pytest.fixture
def case(tmp_path: Path) -> Any:
    (tmp_path / "a.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("[machine]\n", encoding="utf-8")
    (tmp_path / "p.csv").write_text(f"{HEAD}a,a.nc,r.toml\nb,a.nc,r.toml\n", encoding="utf-8")
    return read_plan(tmp_path / "p.csv").cases[0]


class Row(CaseItem):
    """A row with its name."""

    nodeid = "p.csv::p-a"


def item_of(kind: type[RowItem], case: Any, result: CaseResult | None) -> Any:
    item = object.__new__(kind)
    item.case, item.result, item.path = case, result, case.file
    return item


# What a row hands over


@pytest.mark.parametrize("kind", [CaseItem, StatisticItem])
@pytest.mark.parametrize("when", ["setup", "call", "teardown"])
@pytest.mark.parametrize("has_run", [True, False])
def test_a_row_hands_its_result_over_with_its_call_and_once(
    case: Any, kind: type[RowItem], when: str, has_run: bool
) -> None:
    """Not with what comes before and after it, nor where it was never run."""
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    item = item_of(kind, case, CaseResult(case, Verdict.FAIL, []) if has_run else None)
    report: Any = SimpleNamespace(when=when)
    hook = staging.pytest_runtest_makereport(item)
    next(hook)
    with pytest.raises(StopIteration) as ended:
        hook.send(report)
    assert ended.value.value is report
    is_handed = has_run and when == "call"
    assert hasattr(report, "axisrig_outcome") is is_handed
    if is_handed:
        outcome = Outcome.unpacked(report.axisrig_outcome)
        assert (outcome.plan, outcome.result.case.run) == (case.file, "p-a")
        assert outcome.result.verdict is Verdict.FAIL
        assert item.result is None
    else:
        assert (item.result is not None) is has_run
    staging.pytest_unconfigure()


def test_a_test_that_is_no_row_hands_nothing_over() -> None:
    staging = Staging(SimpleNamespace(stash={}))  # type: ignore[arg-type]
    item: Any = SimpleNamespace(result="of its own")
    report: Any = SimpleNamespace(when="call")
    hook = staging.pytest_runtest_makereport(item)
    next(hook)
    with pytest.raises(StopIteration):
        hook.send(report)
    assert vars(report) == {"when": "call"}
    staging.pytest_unconfigure()


# The folder of a session


def test_the_folder_is_of_the_rows_of_this_process_and_has_its_report_at_the_end(
    case: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("axisrig.reports.build.build_report", lambda folder: folder / "r.html")
    config: Any = SimpleNamespace(rootpath=tmp_path)
    found = ResultsOfPytest(config, tmp_path / "out")
    row = item_of(Row, case, None)
    other: Any = SimpleNamespace(nodeid="p.csv::p-b")  # no row, whatever its name is
    found.pytest_collection_finish(SimpleNamespace(items=[other, row]))  # type: ignore[arg-type]
    lines: list[str] = []
    terminal = SimpleNamespace(write_line=lines.append)
    found.pytest_terminal_summary(terminal)
    assert lines == []  # before the end there is none
    text = (tmp_path / "out" / "manifest.json").read_text(encoding="utf-8")
    assert '"runs_planned": 1' in text
    found.pytest_sessionfinish()
    assert (tmp_path / "out" / "junit.xml").is_file()
    found.pytest_terminal_summary(terminal)
    assert lines == [f"axisrig: {tmp_path / 'out' / 'r.html'}"]


def test_without_rows_there_is_no_folder_and_no_report(tmp_path: Path) -> None:
    found = ResultsOfPytest(SimpleNamespace(rootpath=tmp_path), tmp_path / "out")  # type: ignore[arg-type]
    other: Any = SimpleNamespace(nodeid="test_a.py::test_b")
    found.pytest_collection_finish(SimpleNamespace(items=[other]))  # type: ignore[arg-type]
    found.pytest_sessionfinish()
    found.pytest_terminal_summary(SimpleNamespace(write_line=pytest.fail))
    assert not (tmp_path / "out").exists()


# The plugin of a process


class Plugins:
    """Configuration of a process, and what is registered in it."""

    def __init__(self, out: Path | None, jobs: object = None, *, is_worker: bool = False) -> None:
        self.names: dict[str, object] = {}
        self.pluginmanager = SimpleNamespace(
            register=lambda one, name: self.names.update({name: one})
        )
        self.stash: dict[Any, Any] = {}
        self._options = {"axisrig_out": out, "numprocesses": jobs}
        if is_worker:
            self.workerinput: dict[str, object] = {}

    def getoption(self, name: str, default: object = None) -> object:
        return self._options.get(name, default)


@pytest.mark.parametrize(
    ("out", "jobs", "is_worker", "names"),
    [
        (None, None, False, []),
        (None, 2, True, []),
        (Path("out"), None, False, ["axisrig staging", "axisrig results"]),
        (Path("out"), 0, False, ["axisrig staging", "axisrig results"]),
        (Path("out"), 2, False, ["axisrig results"]),  # its workers run the rows
        (Path("out"), None, True, ["axisrig staging"]),
        (Path("out"), 2, True, ["axisrig staging"]),
    ],
)
def test_rows_are_staged_where_they_run_and_written_in_one_process(
    out: Path | None, jobs: object, is_worker: bool, names: list[str]
) -> None:
    config: Any = Plugins(out, jobs, is_worker=is_worker)
    pytest_plans.pytest_configure(config)
    assert list(config.names) == names
    kinds = {"axisrig staging": Staging, "axisrig results": ResultsOfPytest}
    assert all(isinstance(one, kinds[name]) for name, one in config.names.items())
    if "axisrig staging" in names:
        config.names["axisrig staging"].pytest_unconfigure()


def test_options_have_their_types_and_nothing_is_kept_unless_asked() -> None:
    added: dict[str, dict[str, Any]] = {}
    ini: list[Any] = []
    group = SimpleNamespace(addoption=lambda name, **more: added.update({name: more}))
    parser: Any = SimpleNamespace(
        addini=lambda name, text, **more: ini.append((name, more)), getgroup=lambda _: group
    )
    pytest_plans.pytest_addoption(parser)
    assert ini == [("axisrig_plans", {"type": "paths", "default": []})]
    found = {name: (more["type"], more.get("default")) for name, more in added.items()}
    assert found == {"--axisrig-call-timeout": (float, None), "--axisrig-out": (Path, None)}


@pytest.mark.parametrize("is_worker", [True, False])
def test_a_worker_removes_what_its_models_were_unpacked_into(
    is_worker: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The main process does so when it exits."""
    removed: list[str] = []
    session = SimpleNamespace(remove_session_folder=lambda: removed.append("folder"))
    monkeypatch.setitem(sys.modules, "axisrig.kernel.cosim.fmi.session", session)
    config = SimpleNamespace(**({"workerinput": {}} if is_worker else {}))
    pytest_plans.pytest_sessionfinish(SimpleNamespace(config=config))  # type: ignore[arg-type]
    assert removed == ["folder"] * is_worker
    monkeypatch.delitem(sys.modules, "axisrig.kernel.cosim.fmi.session")
    pytest_plans.pytest_sessionfinish(SimpleNamespace(config=config))  # type: ignore[arg-type]
    assert removed == ["folder"] * is_worker


@pytest.mark.parametrize(
    ("keyword", "kept", "dropped"),
    [
        ("p-a", ["test_p-a", "p-a"], ["p-b"]),
        ("not p-a", ["p-b"], ["p-a"]),
        ("p", ["test_p-a", "p-a", "p-b"], []),
        ("(", None, None),
    ],
)
def test_an_expression_chooses_rows_as_the_command_line_does(
    case: Any, monkeypatch: pytest.MonkeyPatch, keyword: str, kept: list[str] | None,
    dropped: list[str] | None,
) -> None:  # fmt: skip
    """Tests that are no rows are chosen by pytest, which then chooses no second time."""
    rows = [item_of(CaseItem, one, None) for one in read_plan(case.file).cases]
    other: Any = SimpleNamespace(case=SimpleNamespace(run="test_p-a"))
    items: list[Any] = [other, *rows]
    out: list[Any] = []
    option = SimpleNamespace(keyword=keyword)

    def deselected(items: list[Any]) -> None:
        out.extend(items)

    hook = SimpleNamespace(pytest_deselected=deselected)
    config: Any = SimpleNamespace(option=option, hook=hook)

    def by_keyword(others: list[Any], _config: object) -> None:
        others[:] = [one for one in others if keyword in one.case.run]

    monkeypatch.setattr("_pytest.mark.deselect_by_keyword", by_keyword)
    found = pytest_plans.pytest_collection_modifyitems(config, items)
    if kept is None:
        with pytest.raises(pytest.UsageError, match="cannot be read"):
            next(found)
        return
    next(found)
    assert option.keyword == ""
    assert [one.case.run for one in items] == kept
    assert [one.case.run for one in out] == dropped
    with pytest.raises(StopIteration):
        found.send(None)
    assert option.keyword == keyword


# Plans and rows


def test_a_plan_that_cannot_be_read_is_an_error_of_its_collection(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(f"{HEAD}a,none.nc,none.toml\n", encoding="utf-8")
    plan: Any = SimpleNamespace(path=tmp_path / "p.csv", CollectError=PlanFile.CollectError)
    with pytest.raises(PlanFile.CollectError, match=r"p\.csv:2:2: there is no such program file"):
        list(PlanFile.collect(plan))


def test_each_warning_of_a_cell_is_one_of_the_row_before_it_runs(case: Any) -> None:
    done: list[str] = []

    def run_case(one: Any) -> str:
        done.append(f"runs {one.run}")
        return "result"

    item: Any = SimpleNamespace(
        case=case, _warnings=lambda: ["one", "two"], warn=lambda text: done.append(f"warns {text}"),
        run_case=run_case, finish=done.append,
    )  # fmt: skip
    CaseItem.runtest(item)
    assert done == ["warns one", "warns two", "runs p-a", "result"]


def test_another_exception_than_a_verdict_is_shown_as_pytest_does(
    case: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = item_of(CaseItem, case, None)
    monkeypatch.setattr(pytest.Item, "repr_failure", lambda *_: "by pytest")
    caught: Any = SimpleNamespace(value=ValueError("a defect"))
    assert item.repr_failure(caught) == "by pytest"
    failed = pytest_plugin.CaseFailedError(CaseResult(case, Verdict.FAIL, []))
    shown = item.repr_failure(SimpleNamespace(value=failed))
    lines = shown.reprtraceback.reprentries[0].lines[0].splitlines()
    assert lines == [f"{case.file}:2: p-a: fail"]
