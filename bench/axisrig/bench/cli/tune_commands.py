"""The commands `axisrig tune ...`; heavy modules are imported inside them."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import SetOption, rejecting
from axisrig.bench.cli.start import Whole
from axisrig.kernel.errors import UserError

if TYPE_CHECKING:
    from axisrig.bench.tools.tune.distance import Tuning

tune_app = typer.Typer(
    cls=Whole, no_args_is_help=True, help="Measure a control loop and say what to set."
)


@tune_app.callback()
def _group() -> None:
    """Keep `distance` a word of its own while it is the only command."""


@tune_app.command()
@rejecting
def distance(
    rig: Annotated[Path, typer.Option("--rig", help="Rig file (TOML).")],
    axis: Annotated[
        str | None, typer.Option("--axis", help="Axis; where several have distance control.")
    ] = None,
    variable: Annotated[
        str | None,
        typer.Option("--variable", help="V.E. variable with the distance, not encoder 2."),
    ] = None,
    step_mm: Annotated[
        float | None,
        typer.Option("--step", min=0.001, max=5.0, help="Step, mm; by the noise when not said."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="Picture: .svg, .png, .pdf; tune-AXIS.svg when not said."),
    ] = None,
    assignments: SetOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
) -> None:
    """Measure dead time and loop of distance control; report stable and suggested kp, Tn, Tv.

    It runs the rig with small steps and writes a picture. Warnings go to standard error.
    """
    with waiting(f"measuring the loop of {rig}"):
        found, target = _tuned(rig, axis, variable, step_mm, picture, assignments or [])
    import json

    from axisrig.bench.tools.tune.report import data_of, text_of, warnings_of

    print(json.dumps(data_of(found), indent=2) if as_json else text_of(found))
    for warning in warnings_of(found):
        print(f"warning: {warning}", file=sys.stderr)
    print(target, file=sys.stderr)


def _tuned(
    rig: Path,
    axis: str | None,
    variable: str | None,
    step_mm: float | None,
    picture: Path | None,
    assignments: list[str],
) -> "tuple[Tuning, Path]":
    """Measure, and draw the picture; return what was found and where the picture is."""
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.tune.distance import tune
    from axisrig.bench.tools.tune.measure import choose

    try:
        from axisrig.bench.tools.tune.picture import draw, kind_of
    except ImportError as error:
        hint = "pip install 'axisrig[tune]' brings it"
        raise UserError("matplotlib is not installed: it draws the picture", hint=hint) from error
    bench = choose(rig, axis, variable, assignments)
    target = kind_of(picture or Path(f"tune-{bench.axis}.svg"))
    found = do_apart(tune, bench, step_mm, rigs=[rig], file=rig)
    draw(found, target)
    return found, target
