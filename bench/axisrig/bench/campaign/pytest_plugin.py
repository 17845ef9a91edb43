"""Plans as pytest items: every row is a test with its run id as name.

A case that passes or is marginal passes, everything else fails with what its checks say. A row
whose rig names a foreign FMU runs in a process of its own, as in `axisrig run`. Which tables are
plans says `axisrig.bench.cli.pytest_plans`, the entry point. A `conftest.py` that imports
`pytest_addoption` from here makes every table in its own folder a plan, too.
"""

import pickle
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import pytest
from _pytest._code.code import ReprEntryNative, ReprExceptionInfo, ReprFileLocation, ReprTraceback

from axisrig.bench.campaign.cell_warnings import look_at
from axisrig.bench.campaign.older_packages import leftovers
from axisrig.bench.campaign.preparing import prepare, read_case
from axisrig.bench.campaign.processes import CALL_LIMIT_S
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import Limits, Stopwatch, no_stopwatch, run_cases
from axisrig.bench.campaign.statistics import judged_row
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.checks import CheckResult, value_text
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.sentences import result_sentence, run_sentence
from axisrig.bench.plan.table import CASE_COLUMN, SUFFIXES, read_table
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.reading.foreign import foreign_rigs
from axisrig.kernel.errors import UserError

NAME = "axisrig"
"""Of the entry point."""
_OLD_NAME = "axisrig plans"


class CaseFailedError(Exception):
    """A case whose verdict is worse than marginal."""

    def __init__(self, result: CaseResult) -> None:
        super().__init__(result.case.run)
        self.result = result


def add_call_timeout(parser: pytest.Parser) -> None:
    """Add the option that limits one call into an FMU."""
    parser.getgroup("axisrig").addoption(
        "--axisrig-call-timeout",
        type=float,
        metavar="S",
        help="Wall time of one call into an FMU, s; 60 when not said. Every row of a plan then runs"
        " in a process of its own.",
    )


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Make the folder of a conftest that has this hook a folder of plans.

    Several such folders may be in one run. Where pytest loads no entry points, the first one adds
    the option and what collects plans.
    """
    if not (pluginmanager.has_plugin(NAME) or pluginmanager.has_plugin(_OLD_NAME)):
        pluginmanager.register(_Plans(pluginmanager), _OLD_NAME)
        add_call_timeout(parser)


def has_conftest(pluginmanager: pytest.PytestPluginManager, folder: Path) -> bool:
    """Whether the folder has a conftest with the hook of this module."""
    conftest = str(folder / "conftest.py")
    return any(
        getattr(plugin, "__file__", None) == conftest
        and getattr(plugin, "pytest_addoption", None) is pytest_addoption
        for plugin in pluginmanager.get_plugins()
    )


def is_plan(path: Path) -> bool:
    """Whether a table is meant to be a plan: it has `case` and one more column of a plan.

    One that lacks the others is a plan with a mistake, and says so when it is collected.
    """
    if path.suffix.lower() not in SUFFIXES:
        return False
    try:
        columns = read_table(path).columns
    except UserError:
        return path.suffix.lower() == ".csv"  # collected, so that its message is seen
    others = [column for column in columns if column in ("program", "rig", "check", "checks")]
    others += [column for column in columns if column.startswith("check:")]
    return CASE_COLUMN in columns and bool(others)


class PlanFile(pytest.File):
    """A plan; its rows are the items."""

    def collect(self) -> Iterator["RowItem"]:
        """Yield the rows; a plan that cannot be read is a collection error with its message."""
        try:
            plan = with_tested(read_plan(self.path))
        except UserError as error:
            raise self.CollectError(str(error)) from error
        by_run = {case.run: case for case in plan.cases}
        sampled: dict[str, CaseResult] = {}
        for case in plan.rows:
            if case.runs:
                runs = [by_run[run] for run in case.runs]
                yield StatisticItem.from_parent(
                    self, name=case.run, case=case, sampled=sampled, runs=runs
                )
            else:
                yield CaseItem.from_parent(self, name=case.run, case=case, sampled=sampled)


class Outcome(NamedTuple):
    """What an item hands over for a results folder: its result, and its files by their names."""

    plan: Path
    result: CaseResult
    files: Mapping[str, bytes]

    def packed(self) -> bytes:
        """Pack it for another process."""
        return pickle.dumps(self)

    @staticmethod
    def unpacked(content: bytes) -> "Outcome":
        """Unpack what `packed` gave."""
        outcome: Outcome = pickle.loads(content)
        return outcome


class Staged(Protocol):
    """Where runs write that are to be kept, and what times them."""

    stopwatch: Stopwatch

    def files_of(self, run: str) -> RunFiles:
        """Return where bus log and series of a run are to be written."""


STORED = pytest.StashKey[Staged]()
"""Of a configuration whose results are kept."""


_A_TAG = "a tag of plans"


def _marks_of_others(config: pytest.Config) -> set[str]:
    """Return the marks that pytest, its plugins and the tests of a project have declared."""
    lines = [line for line in config.getini("markers") if not line.endswith(_A_TAG)]
    return {line.partition(":")[0].partition("(")[0].strip() for line in lines}


class RowItem(pytest.Item):
    """One row of the results of a plan."""

    result: CaseResult | None = None
    """Of an item that has run."""

    def __init__(self, *, case: Case, sampled: dict[str, CaseResult], **kwargs: Any) -> None:
        """Take a row. sampled: results of runs that statistics are over, shared by a plan."""
        super().__init__(**kwargs)
        self.case = case
        self._sampled = sampled
        # A tag such as `skip` or `xfail` is a word of the plan: it chooses rows and does no more
        others = _marks_of_others(self.config)
        for tag in case.tags:
            self.keywords[tag] = True
            if tag.isidentifier() and tag not in others:
                self.config.addinivalue_line("markers", f"{tag}: {_A_TAG}")
                self.add_marker(getattr(pytest.mark, tag))

    def run_case(self, case: Case) -> CaseResult:
        """Run a case; what it gives to statistics is kept for them."""
        call_limit_s = self.config.getoption("axisrig_call_timeout", default=None)
        rigs = [case.rig]
        stored = self.config.stash.get(STORED, None)
        (result,) = run_cases(
            [case],
            (lambda _: RunFiles()) if stored is None else stored.files_of,
            limits=Limits(
                apart=foreign_rigs(rigs) if call_limit_s is None else rigs,
                call_limit_s=call_limit_s or CALL_LIMIT_S,
            ),
            stopwatch=no_stopwatch if stored is None else stored.stopwatch,
        )
        if case.sampled:
            self._sampled[case.run] = replace(result, series=None)
        return result

    def finish(self, result: CaseResult) -> None:
        """Report a result. Raises CaseFailedError for one that is worse than marginal."""
        self.result = result
        self.user_properties += [
            ("verdict", result.verdict.word),
            *(
                [("runs", str(len(self.case.runs)))]
                if self.case.runs
                else [
                    ("seed", str(self.case.seed)),
                    ("frame_log_sha256", result.frame_log_sha256),
                ]
            ),
            *((check.check.metric, value_text(check.value)) for check in result.checks),
        ]
        if result.verdict > Verdict.MARGINAL:
            raise CaseFailedError(result)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *_: Any) -> Any:
        """Say what failed in the words of the checks; in the summary, the first of them."""
        if not isinstance(excinfo.value, CaseFailedError):
            return super().repr_failure(excinfo)
        result = excinfo.value.result
        lines = [f"{self.case.file}:{self.case.line}: {self.case.run}: {result.verdict.word}"]
        lines += [_line(check) for check in result.checks if check.verdict > Verdict.MARGINAL]
        lines += result.log
        if result.error:
            lines.append(result.error)
        text = "".join(f"{line}\n" for line in lines)
        entry = ReprTraceback([ReprEntryNative([text])], None, "native")
        place = ReprFileLocation(str(self.case.file), self.case.line, _sentence(result))
        return ReprExceptionInfo(reprtraceback=entry, reprcrash=place)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Point at the row."""
        return self.case.file, self.case.line - 1, self.case.run


class CaseItem(RowItem):
    """One run of a plan."""

    def runtest(self) -> None:
        """Run the case and judge it; what `axisrig check` warns of is a warning of pytest."""
        for text in self._warnings():
            self.warn(pytest.PytestWarning(text))
        self.finish(self.run_case(self.case))

    def _warnings(self) -> list[str]:
        """Look at the cells of the row; an FMU that is not ours is not loaded for it.

        A default that this row does not use may be used by another one.
        """
        try:
            is_foreign = bool(foreign_rigs([self.case.rig]))
            looked = look_at(self.case, (read_case if is_foreign else prepare)(self.case))
        except UserError:
            return []  # the run says it
        return [one.text for one in looked if one.text and not one.is_unused]


class StatisticItem(RowItem):
    """The statistics over the runs of a case; runs that this process has not run yet run here."""

    def __init__(self, *, runs: Sequence[Case], **kwargs: Any) -> None:
        """Take a row of statistics. runs: of its case, in their order."""
        super().__init__(**kwargs)
        self._runs = runs

    def runtest(self) -> None:
        """Judge the statistics."""
        for case in self._runs:
            if case.run not in self._sampled:
                self.run_case(case)
        self.finish(judged_row(self.case, self._runs, self._sampled))


def _sentence(result: CaseResult) -> str:
    rows = [CheckRow.of(check) for check in result.checks]
    return run_sentence(result.verdict, result.error, rows)


def _line(check: CheckResult) -> str:
    return f"  {check.verdict.word}: {result_sentence(check)}"


class _Plans:
    """Collects the tables that have such a conftest beside them, where there is no entry point."""

    def __init__(self, pluginmanager: pytest.PytestPluginManager) -> None:
        self._pluginmanager = pluginmanager

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> PlanFile | None:
        """Collect a table whose folder is one of plans."""
        if has_conftest(self._pluginmanager, file_path.parent) and is_plan(file_path):
            return PlanFile.from_parent(parent, path=file_path)
        return None

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Name what an older axisrig has left on the search path."""
        write_leftovers(terminalreporter)


def write_leftovers(terminalreporter: Any) -> None:
    """Name what an older axisrig has left on the search path."""
    for text in leftovers():
        terminalreporter.write_line(f"axisrig: {text}")
