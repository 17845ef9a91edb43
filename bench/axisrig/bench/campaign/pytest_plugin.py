"""Plans as pytest items: every row is a test with its run id as name.

A `conftest.py` that imports `pytest_addoption` from here, as `testplans/conftest.py` does, makes
every table in its own folder a plan; tables in subfolders are none. A case that passes or is
marginal passes, everything else fails with what its checks say. A row whose rig names a foreign
FMU runs in a process of its own, as in `axisrig run`.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.leftovers import leftovers
from axisrig.bench.campaign.processes import CALL_LIMIT_S
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import no_stopwatch, run_cases
from axisrig.bench.plan.checks import CheckResult, value_text
from axisrig.bench.plan.plan import Case, read_plan
from axisrig.bench.plan.table import SUFFIXES
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.reading.foreign import foreign_rigs
from axisrig.kernel.errors import UserError

_NAME = "axisrig plans"


class CaseFailedError(Exception):
    """A case whose verdict is worse than marginal."""

    def __init__(self, result: CaseResult) -> None:
        super().__init__(result.case.run)
        self.result = result


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Make the folder of a conftest that has this hook a folder of plans.

    Several such folders may be in one run: the first adds the option and what collects plans.
    """
    if pluginmanager.has_plugin(_NAME):
        return
    pluginmanager.register(_Plans(pluginmanager), _NAME)
    parser.getgroup("axisrig").addoption(
        "--axisrig-call-timeout",
        type=float,
        metavar="S",
        help="Wall time of one call into an FMU, s; 60 when not said. Every row of a plan then runs"
        " in a process of its own.",
    )


class PlanFile(pytest.File):
    """A plan; its rows are the items."""

    def collect(self) -> Iterator["CaseItem"]:
        """Yield the rows; a plan that cannot be read is a collection error with its message."""
        try:
            plan = read_plan(self.path)
        except UserError as error:
            raise self.CollectError(str(error)) from error
        for case in plan.cases:
            yield CaseItem.from_parent(self, name=case.run, case=case)


class CaseItem(pytest.Item):
    """One row of a plan."""

    def __init__(self, *, case: Case, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.case = case
        for tag in case.tags:
            self.keywords[tag] = True

    def runtest(self) -> None:
        """Run the case and judge it."""
        call_limit_s = self.config.getoption("axisrig_call_timeout", default=None)
        rigs = [self.case.rig]
        (result,) = run_cases(
            [self.case],
            lambda _: RunFiles(),
            jobs=1,
            timeout_s=None,
            stopwatch=no_stopwatch,
            apart=foreign_rigs(rigs) if call_limit_s is None else rigs,
            call_limit_s=call_limit_s or CALL_LIMIT_S,
        )
        self.user_properties += [
            ("verdict", result.verdict.word),
            ("seed", str(self.case.seed)),
            ("frame_log_sha256", result.frame_log_sha256),
            *((check.check.metric, value_text(check.value)) for check in result.checks),
        ]
        if result.verdict > Verdict.MARGINAL:
            raise CaseFailedError(result)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *_: Any) -> str:
        """Tell what failed in the words of the checks."""
        if not isinstance(excinfo.value, CaseFailedError):
            return str(super().repr_failure(excinfo))
        result = excinfo.value.result
        lines = [f"{self.case.file}:{self.case.line}: {self.case.run}: {result.verdict.word}"]
        lines += [_line(check) for check in result.checks if check.verdict > Verdict.MARGINAL]
        lines += result.log
        if result.error:
            lines.append(result.error)
        return "\n".join(lines)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Point at the row."""
        return self.case.file, self.case.line - 1, self.case.run


def _line(check: CheckResult) -> str:
    note = f" ({check.note})" if check.note else ""
    return f"  {check.verdict.word}: {check.summary}{note}"


class _Plans:
    """Collects the tables that have such a conftest beside them."""

    def __init__(self, pluginmanager: pytest.PytestPluginManager) -> None:
        self._pluginmanager = pluginmanager

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> PlanFile | None:
        """Collect a table whose folder is one of plans."""
        if file_path.suffix.lower() in SUFFIXES and self._is_plan_folder(file_path.parent):
            return PlanFile.from_parent(parent, path=file_path)
        return None

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Name what an older axisrig has left on the search path."""
        for text in leftovers():
            terminalreporter.write_line(f"axisrig: {text}")

    def _is_plan_folder(self, folder: Path) -> bool:
        conftest = str(folder / "conftest.py")
        return any(
            getattr(plugin, "__file__", None) == conftest
            and getattr(plugin, "pytest_addoption", None) is pytest_addoption
            for plugin in self._pluginmanager.get_plugins()
        )
