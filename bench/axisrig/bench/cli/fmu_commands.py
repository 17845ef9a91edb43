"""The commands `axisrig fmu ...`; heavy modules are imported inside them."""

import sys
from typing import Annotated

import typer

from axisrig.bench.cli.options import CALL_LIMIT_S, CallTimeoutOption, rejecting

fmu_app = typer.Typer(no_args_is_help=True, help="Plant FMUs: list, build, show, check.")


@fmu_app.command("list")
@rejecting
def list_models() -> None:
    """List the models of the library and where their FMUs are."""
    from axisrig.bench.tools.fmu.library import listing

    print(listing())


@fmu_app.command("check")
@rejecting
def check_fmus(
    files: Annotated[list[str], typer.Argument(metavar="FMU...", help="Files or models.")],
    call_limit_s: CallTimeoutOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
) -> None:
    """Try FMUs out in processes apart: are they safe, sound, repeatable, and what could they be?

    Exit code 0: nothing failed, 1: something did, 2: there is no such file.
    """
    import json

    from axisrig.bench.tools.fmu.check import check_fmu
    from axisrig.bench.tools.fmu.findings import show_findings
    from axisrig.bench.tools.fmu.place import find_fmu

    checked = [check_fmu(find_fmu(text), call_limit_s or CALL_LIMIT_S) for text in files]
    if as_json:
        print(json.dumps({"fmus": [fmu.as_data() for fmu in checked]}, indent=2))
    else:
        for fmu in checked:
            show_findings(fmu.findings, f"{fmu.path}: {fmu.verdict}")
    raise typer.Exit(0 if all(fmu.is_good for fmu in checked) else 1)


@fmu_app.command("show")
@rejecting
def show(
    file: Annotated[str, typer.Argument(metavar="FMU", help="File or model.")],
    is_all: Annotated[bool, typer.Option("--all", help="Local variables too.")] = False,
) -> None:
    """Show variables, units, structure, platforms and capabilities; no code of it runs."""
    from axisrig.bench.tools.fmu.place import find_fmu
    from axisrig.bench.tools.fmu.show import read_fmu, show_fmu

    show_fmu(read_fmu(find_fmu(file)), is_all=is_all)


@fmu_app.command("build")
@rejecting
def build(
    model: Annotated[str | None, typer.Argument(help="Model; all by default.")] = None,
    fmi: Annotated[str, typer.Option("--fmi", help="Version: 3.0 or 2.0.")] = "3.0",
    platform: Annotated[
        list[str] | None,
        typer.Option(
            "--platform",
            help="x86_64-linux, x86_64-windows, ... or all; several allowed. Default: this one.",
        ),
    ] = None,
    compiler: Annotated[
        str | None, typer.Option("--compiler", help="cc, zig or omc (OpenModelica).")
    ] = None,
) -> None:
    """Build FMUs that the cache does not have yet."""
    from axisrig.bench.tools.fmu.library import build_models

    for line in build_models(model, fmi, platform or (), compiler):
        print(line, file=sys.stderr)
