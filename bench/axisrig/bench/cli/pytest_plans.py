"""The entry point of pytest: plans as test items, and their results as a folder.

pytest loads this module in every project, so nothing heavy is imported before a plan is there.
Tables are collected in folders that the ini value `axisrig_plans` names, in folders and files that
the command line gives, and beside a `conftest.py` that asks for it; not in their subfolders.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable

_SUFFIXES = (".csv", ".xlsx", ".ods", ".parquet")
_INI = "axisrig_plans"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the ini value and the options."""
    parser.addini(_INI, "Folders whose tables are test plans.", type="paths", default=[])
    group = parser.getgroup("axisrig")
    group.addoption(
        "--axisrig-call-timeout",
        type=float,
        metavar="S",
        help="Wall time of one call into an FMU, s; 60 when not said. Every row of a plan then runs"
        " in a process of its own.",
    )
    group.addoption(
        "--axisrig-out",
        type=Path,
        metavar="DIR",
        help="Results folder of the plans, with report and junit.xml, as `axisrig run -o` writes.",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Make ready for a results folder where one is asked for."""
    out = config.getoption("axisrig_out")
    if out is None:
        return
    from axisrig.bench.cli.pytest_results import ResultsOfPytest, Staging

    is_worker = hasattr(config, "workerinput")
    if is_worker or not config.getoption("numprocesses", default=None):
        config.pluginmanager.register(Staging(config), "axisrig staging")
    if not is_worker:
        config.pluginmanager.register(ResultsOfPytest(config, out), "axisrig results")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a table of a folder of plans, unless it lacks the columns of a plan."""
    if file_path.suffix.lower() not in _SUFFIXES or not _is_asked_for(file_path, parent.config):
        return None
    from axisrig.bench.campaign.pytest_plugin import PlanFile, is_plan

    return PlanFile.from_parent(parent, path=file_path) if is_plan(file_path) else None


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> Generator[None, None, None]:
    """Let `-k` choose rows of plans as `axisrig run -k` does."""
    keyword = config.option.keyword
    plugin = sys.modules.get("axisrig.bench.campaign.pytest_plugin") if keyword else None
    rows = [] if plugin is None else [i for i in items if isinstance(i, plugin.RowItem)]
    if not rows:
        return (yield)
    from _pytest.mark import deselect_by_keyword

    from axisrig.bench.plan.select import chosen
    from axisrig.kernel.errors import UserError

    of_plans = {id(item) for item in rows}
    others = [item for item in items if id(item) not in of_plans]
    deselect_by_keyword(others, config)
    try:
        kept = {case.run for case in chosen([item.case for item in rows], keyword)}
    except UserError as error:
        raise pytest.UsageError(str(error)) from None
    dropped = [item for item in rows if item.case.run not in kept]
    if dropped:
        config.hook.pytest_deselected(items=dropped)
    stays = {id(item) for item in (*others, *rows)} - {id(item) for item in dropped}
    items[:] = [item for item in items if id(item) in stays]
    config.option.keyword = ""
    try:
        return (yield)
    finally:
        config.option.keyword = keyword


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Remove the unpacked FMUs of a worker of pytest-xdist, which is interrupted while it exits."""
    plugin = sys.modules.get("axisrig.kernel.cosim.fmi.session")
    if plugin is not None and hasattr(session.config, "workerinput"):
        plugin.remove_session_folder()


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """Name what an older axisrig has left on the search path, where plans were collected."""
    plugin = sys.modules.get("axisrig.bench.campaign.pytest_plugin")
    if plugin is not None:
        plugin.write_leftovers(terminalreporter)


def _is_asked_for(path: Path, config: pytest.Config) -> bool:
    folders = {folder.resolve() for folder in config.getini(_INI)}
    given = _given(config.args) if config.args_source is pytest.Config.ArgsSource.ARGS else set()
    if path.parent.resolve() in folders | given or path.resolve() in given:
        return True
    if not (path.parent / "conftest.py").is_file():
        return False
    from axisrig.bench.campaign.pytest_plugin import has_conftest

    return has_conftest(config.pluginmanager, path.parent)


def _given(arguments: Iterable[str]) -> set[Path]:
    """Files and folders of the command line, without the names of items in them."""
    return {Path(argument.partition("::")[0]).resolve() for argument in arguments}
