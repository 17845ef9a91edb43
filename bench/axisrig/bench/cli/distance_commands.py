"""The commands `axisrig distance ...`; heavy modules are imported inside them."""

from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import SetOption, rejecting
from axisrig.bench.cli.start import Whole

distance_app = typer.Typer(
    cls=Whole,
    no_args_is_help=True,
    help="Distance control: what the manuals leave open, on a real control.",
)


@distance_app.callback()
def _group() -> None:
    """Keep `readings` a word of its own while it is the only command."""


@distance_app.command()
@rejecting
def readings(
    rig: Annotated[Path, typer.Argument(help="Rig file (TOML): its cycle and dead cycles count.")],
    assignments: SetOption = None,
) -> None:
    """Say what a real control shows under each reading of the law, so that one look decides it."""
    with waiting(f"stepping each reading with {rig}"):
        from axisrig.bench.rig.contents import settings_of
        from axisrig.bench.tools.distance.readings import readings_text

        text = readings_text(settings_of(rig, assignments or []))
    print(text)
