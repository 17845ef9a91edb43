"""The command `axisrig params`; imports as in `axisrig.bench.cli.main`."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from axisrig.bench.cli.options import SetOption, rejecting
from axisrig.kernel.errors import UserError


@rejecting
def params(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            help="A number, a path or an older name: it is explained. A list: what it sets. Other"
            " words: the parameters they fit. `diff A B`: what two lists or rigs differ in."
            " `write RIG`: its axis lists as one. `known LIST`: it, what is unknown here as"
            " comments.",
            show_default=False,
        ),
    ] = None,
    rig: Annotated[
        Path | None, typer.Option("--rig", help="Effective values of a rig and where they are set.")
    ] = None,
    axis: Annotated[
        str | None, typer.Option("--axis", help="Only this axis of the rig, or `channel`.")
    ] = None,
    form: Annotated[
        Literal["text", "csv", "markdown"],
        typer.Option("--format", help="Form of the list; markdown is docs/parameters.md."),
    ] = "text",
    assignments: SetOption = None,
) -> None:
    """List and explain parameters, show what a rig has, compare lists or rigs."""
    from axisrig.bench.rig.contents import contents_text
    from axisrig.bench.tools.params.effective import difference_text, effective_text, written_lists
    from axisrig.bench.tools.params.listing import parameters_text

    said, sets = words or [], assignments or []
    if said[:1] == ["diff"]:
        if len(said) != 3 or rig or axis or sets:
            raise UserError("`params diff` takes two lists or two rigs and nothing else")
        text, is_different = difference_text(Path(said[1]), Path(said[2]))
        print(text)
        raise typer.Exit(1 if is_different else 0)
    if said[:1] == ["known"]:
        _write_known(said[1:])
    elif said[:1] == ["write"]:
        if len(said) != 2 or rig:
            raise UserError("`params write` takes one rig, and --axis and --set")
        print(written_lists(Path(said[1]), axis, sets))
    elif rig is not None:
        print(effective_text(rig, axis, said, sets))
    elif len(said) == 1 and Path(said[0]).is_file():
        print(contents_text(Path(said[0])))
    elif axis or sets:
        raise UserError("--axis and --set belong to --rig")
    else:
        print(parameters_text(said, form))


def _write_known(words: list[str]) -> None:
    """Print a list whose lines that are refused are comments, and their number beside it."""
    from axisrig.bench.tools.params.known import known_text

    if len(words) != 1:
        raise UserError("`params known` takes one list")
    text, count = known_text(Path(words[0]))
    print(text, end="")
    print(f"{count} lines are comments now: they act on nothing here", file=sys.stderr)
