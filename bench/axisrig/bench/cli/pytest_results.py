"""`pytest --axisrig-out DIR`: the results folder that `axisrig run` would write.

A process that runs items keeps what a run writes in a folder of its own and hands it over with the
report of the item; the controller alone writes the results folder.
"""

import shutil
import sys
import time
from collections.abc import Generator, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import pytest

from axisrig.bench.campaign.pytest_plugin import STORED, Outcome, RowItem
from axisrig.bench.campaign.results.layout import logs_beside
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, RunFiles
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.cli.outside import time_of_day
from axisrig.bench.files import in_words
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.probes import probe_id
from axisrig.bench.plan.searching import PROBES_MAX
from axisrig.bench.plan.table import SUFFIXES
from axisrig.bench.plan.verdict import Verdict, exit_code
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError

_ATTRIBUTE = "axisrig_outcome"
_TRACE, _BUS = ".parquet", ".blf"


class Staging:
    """Where the runs of this process write, and what becomes of it."""

    def __init__(self, config: pytest.Config) -> None:
        self._folder = Path(mkdtemp(prefix="axisrig-"))
        self.stopwatch = time.perf_counter
        config.stash[STORED] = self

    def files_of(self, run: str) -> RunFiles:
        """Return where bus log and series of a run, and of its probes, are to be written."""
        probes = [self._files_of(probe_id(run, n + 1)) for n in range(PROBES_MAX)]
        files = self._files_of(run)
        return RunFiles(files.bus_logs, files.trace, probes)

    def _files_of(self, run: str) -> RunFiles:
        return RunFiles([self._folder / f"{run}{_BUS}"], self._folder / f"{run}{_TRACE}")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Hand over what a row has left."""
        report = yield
        if isinstance(item, RowItem) and item.result is not None and report.when == "call":
            setattr(report, _ATTRIBUTE, self._packed(item, item.result))
            item.result = None
        return report

    def _packed(self, item: RowItem, result: CaseResult) -> bytes:
        files = {}
        for one in (result, *result.probes):
            one.series = None
            run = one.case.run
            beside = logs_beside(run, [each.name for each in self._folder.iterdir()])
            for name in (f"{run}{_TRACE}", f"{run}{_BUS}", *beside):
                path = self._folder / name
                if path.is_file():
                    files[path.name] = path.read_bytes()
                    path.unlink()
        result.depends_sha256 = depends_sha256(result.case)
        result.timestamp = time_of_day(result.wall_s)
        return Outcome(item.path, result, files).packed()

    def pytest_unconfigure(self) -> None:
        """Remove what is left."""
        shutil.rmtree(self._folder, ignore_errors=True)


class ResultsOfPytest:
    """Writes the results folder."""

    def __init__(self, config: pytest.Config, folder: Path) -> None:
        self._config, self._folder = config, folder
        self._started = datetime.now(UTC).isoformat(timespec="seconds")
        self._writer: ResultsWriter | None = None
        self._report: Path | None = None

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Open the folder for the rows of this process; a controller of others has none."""
        self._open(item.nodeid for item in session.items if isinstance(item, RowItem))

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, ids: Iterable[str]) -> None:
        """Open the folder for the rows that the workers have found."""
        self._open(ids)

    def _open(self, ids: Iterable[str]) -> None:
        if self._writer is not None:
            return
        runs: dict[Path, list[str]] = {}
        for name in ids:
            file, _, run = name.partition("::")
            path = _as_on_a_command_line(self._config.rootpath / file)
            if run and path.suffix.lower() in SUFFIXES:
                runs.setdefault(path, []).append(run)
        if not runs:
            return
        try:
            plans = [with_tested(read_plan(path)) for path in runs]
            manifest = build_manifest(
                _chosen(plans, runs),
                command=["pytest", *sys.argv[1:]],
                started=self._started,
                output=str(self._folder),
            )
            chosen = [run for of_plan in runs.values() for run in of_plan]
            self._writer = ResultsWriter(self._folder, plans, manifest, runs=chosen)
        except UserError as error:
            raise pytest.UsageError(str(error)) from None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Write the results of a row."""
        packed = getattr(report, _ATTRIBUTE, None)
        if packed is None or self._writer is None:
            return
        delattr(report, _ATTRIBUTE)
        try:
            self._put(self._writer, Outcome.unpacked(packed))
        except OSError as error:  # as `axisrig run`: a full disk, or the folder has gone
            writer, self._writer = self._writer, None
            with suppress(OSError):
                writer.close()
            pytest.exit(f"axisrig: {in_words(error)}", returncode=exit_code(Verdict.ABORTED))

    @staticmethod
    def _put(writer: ResultsWriter, outcome: Outcome) -> None:
        result = outcome.result
        files = writer.files_of(result.case.run)
        places = [files, *files.probes]
        for one, place in zip((result, *result.probes), places, strict=False):
            _write(one, place, outcome.files)
        writer.add(result)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self) -> None:
        """Close the folder and write its report."""
        if self._writer is not None:
            from axisrig.reports.build import build_report  # noqa: PLC0415 - only where asked for

            self._writer.close()
            self._report = build_report(self._folder)

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Name the report."""
        if self._report is not None:
            terminalreporter.write_line(f"axisrig: {self._report}")


def _chosen(plans: Iterable[Plan], runs: dict[Path, list[str]]) -> list[Plan]:
    """The plans with the cases that run."""
    return [
        replace(plan, cases=tuple(case for case in plan.cases if case.run in runs[plan.path]))
        for plan in plans
    ]


def _write(result: CaseResult, place: RunFiles, files: Mapping[str, bytes]) -> None:
    """Write the files of a run where they belong."""
    trace = files.get(f"{result.case.run}{_TRACE}")
    if trace is not None and place.trace is not None:
        place.trace.write_bytes(trace)
        result.series = Series(place.trace)
    log = files.get(f"{result.case.run}{_BUS}")
    for path in place.bus_logs if log is not None else ():
        path.write_bytes(log or b"")
    for name in logs_beside(result.case.run, files) if place.bus_logs else ():
        place.bus_logs[0].with_name(name).write_bytes(files[name])


def _as_on_a_command_line(path: Path) -> Path:
    """Return a path from the present folder on where it is below it: no path of this machine."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
