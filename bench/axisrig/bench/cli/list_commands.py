"""The commands that list what plans, rigs and this installation have."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import SelectOption, SetOption, rejecting
from axisrig.bench.cli.params_command import params
from axisrig.bench.cli.start import Whole


@rejecting
def metrics() -> None:
    """List what a check column may ask for."""
    from axisrig.bench.tools.listings.metrics import metrics_table

    print(metrics_table())


@rejecting
def oracles(
    word: Annotated[
        str | None, typer.Argument(help="A name or word: these closed forms whole, not the list.")
    ] = None,
) -> None:
    """List the closed forms that checks are compared with: formula and source."""
    from axisrig.bench.tools.listings.oracles import oracle_listing

    print(oracle_listing(word))


@rejecting
def drives(
    profile: Annotated[
        str | None, typer.Argument(help="Name of a profile: all its keys, not the list.")
    ] = None,
) -> None:
    """List the drive profiles that a rig may name, or the keys of one."""
    from axisrig.bench.drive.cia402.dictionary.profiles import profile_listing

    print(profile_listing(profile))


@rejecting
def faults(
    kind: Annotated[
        str | None, typer.Argument(help="A kind: what bus, drive and kernel do, not the list.")
    ] = None,
) -> None:
    """List what a fault column may cause, or the reactions to one kind."""
    from axisrig.bench.rig.reading.faults import faults_table

    print(faults_table(kind))


@rejecting
def objects() -> None:
    """List the CNC objects of distance control, which a plc: column may write."""
    from axisrig.bench.rig.cnc_objects import objects_table

    print(objects_table())


@rejecting
def errors(
    word: Annotated[
        str | None, typer.Argument(help="An ID: all about it. Or a word: the alarms that have it.")
    ] = None,
    reaction_class: Annotated[
        int | None, typer.Option("--class", min=1, max=7, help="Only this reaction class.")
    ] = None,
    area: Annotated[str | None, typer.Option("--area", help="Only this area.")] = None,
    form: Annotated[
        Literal["text", "markdown"],
        typer.Option("--format", help="Form of the list; markdown is docs/errors.md."),
    ] = "text",
) -> None:
    """List the alarms, or show all about one: class, values, remedy, twin, source."""
    from axisrig.bench.tools.listings.alarms import alarm_listing, page

    if form == "markdown":
        print(page(), end="")
    else:
        print(alarm_listing(word, reaction_class, area))


@rejecting
def explain(alarm_id: Annotated[str, typer.Argument(metavar="ID", help="ID of an alarm.")]) -> None:
    """Show all about one alarm: class, values, remedy, twin, source."""
    from axisrig.bench.tools.listings.alarms import alarm_listing

    print(alarm_listing(alarm_id))


@rejecting
def language(
    word: Annotated[
        str | None, typer.Argument(help="A word of NC programs: all about it, not the list.")
    ] = None,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="The page docs/nc-language.md instead.")
    ] = False,
) -> None:
    """List the words, commands and variables of NC programs; (-) marks what does not act."""
    from axisrig.bench.tools.listings.language import language_listing, page

    print(page() if markdown else f"{language_listing(word)}\n", end="")


@rejecting
def doctor(
    is_building: Annotated[
        bool, typer.Option("--build", help="Build the FMUs of the library that are not there.")
    ] = False,
) -> None:
    """Say what this installation has, what it lacks, and what to do about it."""
    with waiting("looking at this installation"):
        from axisrig.bench.tools.listings.doctor import LACK, examine

        is_well = True
        for line in examine(is_building=is_building):
            is_well = is_well and not line.startswith(LACK)
            print(line, flush=True)
    raise typer.Exit(0 if is_well else 1)


@rejecting
def docs(
    name: Annotated[
        str | None, typer.Argument(metavar="PAGE", help="A page, such as plans; else the list.")
    ] = None,
    is_opened: Annotated[
        bool, typer.Option("--open", help="Open it with the program for such files.")
    ] = False,
    notebook: Annotated[
        Path | None,
        typer.Option("--notebook", metavar="PATH", help="Copy the notebook about results there."),
    ] = None,
) -> None:
    """List the documents, print one of them, or open it."""
    from axisrig.bench.tools.listings.documents import copy_notebook, listing, page

    if notebook is not None:
        print(copy_notebook(notebook))
        return
    if name is None and not is_opened:
        print(listing())
        return
    path = page(name or "index")
    if is_opened:
        print(path)
        typer.launch(str(path))
        return
    text = path.read_text(encoding="utf-8")
    if not sys.stdout.isatty():
        print(text, end="")
        return
    from rich.console import Console
    from rich.markdown import Markdown

    console = Console()
    with console.pager(styles=True):
        console.print(Markdown(text))


LISTINGS = (
    docs,
    metrics,
    oracles,
    drives,
    faults,
    objects,
    params,
    errors,
    explain,
    language,
    doctor,
)

plan_app = typer.Typer(cls=Whole, no_args_is_help=True, help="Plans as they are meant.")


@plan_app.callback()
def _group() -> None:
    """Keep `expand` a word of its own while it is the only command."""


@plan_app.command()
@rejecting
def expand(
    plan: Annotated[Path, typer.Argument(help="Plan: CSV, XLSX, ODS or Parquet.")],
    select: SelectOption = None,
    assignments: SetOption = None,
) -> None:
    """Print a plan with a row for each run: defaults, included tables, lists; a plan itself."""
    with waiting(f"reading {plan}"):
        from axisrig.bench.campaign.checking import check_inputs
        from axisrig.bench.plan.assignment import parse_assignment
        from axisrig.bench.plan.expanded import expanded_text
        from axisrig.bench.plan.plan import read_plan, selected

        changes = [parse_assignment(text) for text in assignments or []]
        meant = selected(read_plan(plan).with_inputs(changes, select), select)
        check_inputs(meant)
        text = expanded_text(meant)
    print(text, end="")
