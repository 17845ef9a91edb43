"""The commands that draw and compare results and hand them to other programs."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import FreshOption, FullOption, rejecting
from axisrig.kernel.errors import UserError

FolderArgument = Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")]


@rejecting
def report(
    folder: Annotated[Path, typer.Argument(help="Results folder of a run.")],
    is_full: FullOption = False,
    as_pdf: Annotated[
        bool, typer.Option("--pdf", help="Print it as report.pdf, too, where a Chromium is found.")
    ] = False,
) -> None:
    """Write report.html again from a results folder.

    A folder of another tool needs cases.csv (run, verdict) and results.csv (run, metric, verdict).
    """
    with waiting(f"writing the report of {folder}"):
        from axisrig.bench.campaign.results.folder import recover
        from axisrig.reports.build import build_report

        recover(folder)
        path = build_report(folder, is_full=is_full, put_out=_to_stderr)
    print(path)
    if as_pdf:
        with waiting(f"printing {path}"):
            from axisrig.reports.pdf import print_pdf

            printed = print_pdf(path)
        print(printed)


@rejecting
def export(
    folder: FolderArgument,
    runs: Annotated[list[str] | None, typer.Argument(metavar="RUN", help="Runs; all.")] = None,
    into: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the files; DIR/export.")
    ] = None,
    mf4: Annotated[
        bool, typer.Option("--mf4", help="ASAM MDF 4.10, each signal with its unit.")
    ] = False,
    csv: Annotated[bool, typer.Option("--csv", help="CSV, the units in the second row.")] = False,
    diagnosis: Annotated[
        bool, typer.Option("--diagnosis", help="Diagnosis data of 3D distance control, as a text.")
    ] = False,
) -> None:
    """Write the time series of runs for other programs, a file for each run."""
    if mf4 + csv + diagnosis != 1:
        raise UserError("no form, or several, are named", allowed=("--mf4", "--csv", "--diagnosis"))
    target = into or folder / "export"
    with waiting(f"writing the series of {folder} to {target}"):
        from axisrig.results.export import export as exported
        from axisrig.results.export import export_diagnosis
        from axisrig.results.loading import load

        if diagnosis:
            for path in export_diagnosis(load(folder), runs or [], target):
                print(path)
            return
        try:
            for path in exported(load(folder), runs or [], target, "mf4" if mf4 else "csv"):
                print(path)
        except ImportError as error:
            raise _lacking("asammdf", "mdf") from error


@rejecting
def query(
    folder: FolderArgument,
    sql: Annotated[str, typer.Argument(metavar="SQL", help='"select run, verdict from cases"')],
    csv: Annotated[bool, typer.Option("--csv", help="CSV in place of a table.")] = False,
) -> None:
    """Ask a results folder in SQL: tables cases, checks and signals."""
    with waiting(f"asking {folder}"):
        from axisrig.results.loading import load
        from axisrig.results.query import query as asked

        results = load(folder)
        try:
            found = asked(results, sql)
        except ImportError as error:
            raise _lacking("duckdb", "query") from error
    if csv:
        print(found.to_csv(index=False, lineterminator="\n"), end="")
    else:
        print(found.to_string(index=False, na_rep=""))


@rejecting
def sources(folder: FolderArgument) -> None:
    """Say which signal source is how accurate, from results of testplans/latch_study.csv."""
    with waiting(f"reading {folder}"):
        from axisrig.bench.campaign.results.stored import read_results
        from axisrig.results.sources import sources_table

        table = sources_table(read_results(folder))
    print(table, end="")


@rejecting
def merge(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Results folders.")],
    into: Annotated[Path, typer.Option("-o", "--out", help="Results folder to make.")],
    is_fresh: FreshOption = False,
) -> None:
    """Join the results of the shares of a campaign (`run --shard`)."""
    from datetime import UTC, datetime

    started = datetime.now(UTC).isoformat(timespec="seconds")
    with waiting(f"joining {len(folders)} folders"):
        from axisrig.bench.campaign.sharing import merge as joined
        from axisrig.bench.plan.plan import counted
        from axisrig.reports.build import build_report

        made = joined(folders, into, started=started, is_fresh=is_fresh, build_report=build_report)
    for run in made.doubled:
        print(f"in several folders, with equal results: {run}", file=sys.stderr)
    for run in made.missing:
        print(f"missing: {run}", file=sys.stderr)
    for run in made.bare:
        print(f"the trace or the file of the run is missing: {run}", file=sys.stderr)
    print(f"{counted(made.runs, made.statistics)}, {len(made.missing)} missing")
    print(made.report)
    raise typer.Exit(4 if made.missing or made.bare else 0)


@rejecting
def diff(
    before: Annotated[Path, typer.Argument(metavar="A", help="Results folder to compare with.")],
    after: Annotated[Path, typer.Argument(metavar="B", help="Results folder to look at.")],
    page: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write a page with signals, too.")
    ] = None,
) -> None:
    """Compare two results folders; exit code 1 when something got worse."""
    with waiting(f"comparing {before} and {after}"):
        from axisrig.bench.campaign.results.stored import read_results
        from axisrig.results.compare.changes import changes
        from axisrig.results.compare.pairs import compare
        from axisrig.results.compare.words import diff_lines

        folders = [read_results(before), read_results(after)]
        found = compare(*folders)
        changed = changes(folders[0], folders[1], found.pairs)
    for one in folders:
        for run in one.runs:
            if run.altered:
                _to_stderr(f"{one.folder}: {run.run}: {run.altered_words}")
    for line in diff_lines(found, changed):
        print(line)
    if page is not None:
        with waiting(f"writing {page}"):
            from axisrig.results.compare.page import write_diff

            write_diff(page, found, folders, changed)
        print(page)
    raise typer.Exit(1 if found.worse() else 0)


@rejecting
def trend(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Results folders.")],
    metric: Annotated[str, typer.Option("--metric", help="As in a plan: latch_error_um:Z")],
    case: Annotated[
        str | None, typer.Option("--case", help="One case, with or without its plan; all.")
    ] = None,
    page: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write a page with plots, too.")
    ] = None,
) -> None:
    """Follow a metric over campaigns, in the order of the folders."""
    with waiting(f"reading {len(folders)} folders"):
        from axisrig.bench.campaign.results.stored import read_results
        from axisrig.results.compare.trend import trend as follow
        from axisrig.results.compare.words import trend_lines

        found = follow([read_results(folder) for folder in folders], metric, case)
    for line in trend_lines(found):
        print(line)
    if page is not None:
        from axisrig.results.compare.page import write_trend

        print(write_trend(page, found))


def _to_stderr(text: str) -> None:
    print(text, file=sys.stderr)


def _lacking(package: str, extra: str) -> UserError:
    return UserError(
        f"{package} is not installed", hint=f"pip install 'axisrig[{extra}]' brings it"
    )


DATA = (report, merge, diff, trend, export, query, sources)
