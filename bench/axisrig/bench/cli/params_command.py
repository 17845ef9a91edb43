"""The command `axisrig params`; imports as in `axisrig.bench.cli.main`."""

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Literal

import typer

from axisrig.bench.cli.beside.waiting import waiting
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
    what = rig or " ".join(words or [])
    with waiting(f"reading {what}") if rig or words else nullcontext():
        text, code = _answer(words or [], rig, axis, form, assignments or [])
    print(text)
    raise typer.Exit(code)


def _answer(
    words: list[str], rig: Path | None, axis: str | None, form: str, sets: list[str]
) -> tuple[str, int]:
    """Return what is printed, and the exit code."""
    from axisrig.bench.rig.contents import contents_text
    from axisrig.bench.tools.params.effective import difference_text, effective_text, written_lists
    from axisrig.bench.tools.params.listing import parameters_text

    if words[:1] == ["diff"]:
        if len(words) != 3 or rig or axis or sets:
            raise UserError("`params diff` takes two lists or two rigs and nothing else")
        text, is_different = difference_text(Path(words[1]), Path(words[2]))
        return text, 1 if is_different else 0
    if words[:1] == ["known"]:
        return _known(words[1:]), 0
    if words[:1] == ["write"]:
        if len(words) != 2 or rig:
            raise UserError("`params write` takes one rig, and --axis and --set")
        return written_lists(Path(words[1]), axis, sets), 0
    if rig is not None:
        return effective_text(rig, axis, words, sets), 0
    if len(words) == 1 and Path(words[0]).is_file():
        return contents_text(Path(words[0])), 0
    if axis or sets:
        raise UserError("--axis and --set belong to --rig")
    return parameters_text(words, form), 0


def _known(words: list[str]) -> str:
    """Return a list whose lines that are refused are comments; put their number out beside it."""
    from axisrig.bench.tools.params.known import known_text

    if len(words) != 1:
        raise UserError("`params known` takes one list")
    text, count = known_text(Path(words[0]))
    what, they = (
        ("line is a comment", "it acts") if count == 1 else ("lines are comments", "they act")
    )
    print(f"{count} {what} now: {they} on nothing here", file=sys.stderr)
    return text.removesuffix("\n")
