"""The commands `axisrig fmu ...`; heavy modules are imported inside them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import CALL_LIMIT_S, CallTimeoutOption, rejecting
from axisrig.bench.cli.start import Whole
from axisrig.kernel.errors import UserError

fmu_app = typer.Typer(cls=Whole, no_args_is_help=True, help="Plant FMUs: list, build, show, check.")


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
    is_strict: Annotated[
        bool, typer.Option("--strict", help="What only a validator dislikes is a FAIL too.")
    ] = False,
) -> None:
    """Try FMUs out in processes apart: are they safe, sound, repeatable, and what could they be?

    Exit code 0: nothing failed, 1: something did, 2: there is no such file.
    """
    import json

    with waiting(f"trying out {', '.join(files)}"):
        from axisrig.bench.tools.fmu.check import check_fmu
        from axisrig.bench.tools.fmu.findings import show_findings
        from axisrig.bench.tools.fmu.place import find_fmu

        limit_s = call_limit_s or CALL_LIMIT_S
        checked = [check_fmu(find_fmu(text), limit_s, is_strict=is_strict) for text in files]
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
    with waiting(f"reading {file}"):
        from axisrig.bench.tools.fmu.place import find_fmu
        from axisrig.bench.tools.fmu.show import read_fmu, show_fmu

        read = read_fmu(find_fmu(file))
    show_fmu(read, is_all=is_all)


@fmu_app.command("build")
@rejecting
def build(
    model: Annotated[
        str | None,
        typer.Argument(help="Model, or file of your own (.mo); every one by default, as --all."),
    ] = None,
    is_all: Annotated[bool, typer.Option("--all", help="Every model of the library.")] = False,
    fmi: Annotated[
        list[str] | None,
        typer.Option("--fmi", help="Version: 3.0 (default) or 2.0; several allowed."),
    ] = None,
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
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="Release folder: FMUs with reference results, inputs, options and checksums.",
        ),
    ] = None,
) -> None:
    """Build FMUs that the cache does not have yet; print their paths."""
    if is_all and model is not None:
        raise UserError("--all is every model: leave it out, or the model", value=model)
    versions, platforms = fmi or ("3.0",), platform or ()
    if out is not None:
        with waiting(f"building the release {out}"):
            from axisrig.bench.tools.fmu.release import release_models

            for path in release_models(out, model, versions, platforms, compiler):
                print(path, flush=True)
        return
    with waiting(f"looking for {model or 'the models of the library'} in the cache"):
        from axisrig.bench.tools.fmu.library import build_models

        for built in build_models(model, versions, platforms, compiler):
            print(built.path, flush=True)


def build_library() -> None:
    """Build what the cache lacks of the library; say on standard error where the FMUs are."""
    from axisrig.bench.tools.fmu.library import build_models

    for built in build_models(None):
        print(f"{built.model}: {built.path}", file=sys.stderr)
