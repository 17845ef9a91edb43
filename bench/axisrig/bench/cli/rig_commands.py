"""The commands `axisrig rig ...`; heavy modules are imported inside them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import SetOption, rejecting
from axisrig.bench.cli.start import Whole

rig_app = typer.Typer(cls=Whole, no_args_is_help=True, help="Rigs from lists, and for other tools.")


@rig_app.command("from")
@rejecting
def from_lists(
    lists: Annotated[list[Path], typer.Argument(metavar="LIST...", help="Axis and channel lists.")],
    output: Annotated[Path, typer.Option("-o", "--out", help="Rig file to write (TOML).")],
    eds: Annotated[
        Path | None, typer.Option("--eds", help="EDS or DCF of the drives of all axes.")
    ] = None,
) -> None:
    """Write a rig for the lists of a machine, with what had to be assumed at its top."""
    with waiting(f"reading {', '.join(map(str, lists))}"):
        from axisrig.bench.tools.project.rig_from import rig_from

        assumed = list(rig_from(lists, eds, output))
    for line in assumed:
        print(f"assumed: {line}", file=sys.stderr)
    print(output)


@rig_app.command()
@rejecting
def export(
    rig: Annotated[Path, typer.Argument(help="Rig file (TOML).")],
    output: Annotated[
        Path | None, typer.Option("-o", "--out", help="File; RIG.ssp here when not said.")
    ] = None,
    fmi: Annotated[str, typer.Option("--fmi", help="Version of the FMUs: 2.0 or 3.0.")] = "2.0",
    assignments: SetOption = None,
) -> None:
    """Write the plants of a rig as one package (SSP 1.0) that other co-simulation masters open.

    A sensor and the axes it reads become one FMU. What of a rig cannot be exported is reported.
    """
    with waiting(f"packing the plants of {rig}"):
        from axisrig.bench.rig.contents import settings_of
        from axisrig.bench.tools.rig_export.package import SUFFIX, export_rig

        target = output or Path(rig.with_suffix(SUFFIX).name)
        left_out = list(export_rig(settings_of(rig, assignments or []), target, fmi))
    for line in left_out:
        print(line, file=sys.stderr)
    print(target)
