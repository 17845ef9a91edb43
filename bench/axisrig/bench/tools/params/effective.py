"""What a rig has: effective values and where each comes from; what two lists or rigs differ in."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.bench.rig.contents import CHANNEL, blocks_text, parts_of, read_parts, settings_of
from axisrig.bench.rig.parameter_words import with_unit
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Parameter, ParameterSet, list_text, table
from axisrig.kernel.parameters.lists import NAME
from axisrig.kernel.parameters.table import INDEX


def effective_text(
    rig: Path, axis: str | None, words: Sequence[str], assignments: Sequence[str]
) -> str:
    """Show the effective values of a rig, or of one axis (`channel` for the channel).

    words: only parameters that fit them all; without any, what is set or acts.
    """
    settings = settings_of(rig, assignments)
    blocks = blocks_text(parts_of(settings, axis), words)
    if not blocks:
        raise UserError("no parameter of the rig fits", value=" ".join(words))
    notes = [f"warning: {warning}" for warning in settings.warnings]
    notes += [f"note: {note}" for note in settings.notes]
    return "\n\n".join([*blocks, *(["\n".join(notes)] if notes else [])])


# --- two lists or rigs ---------------------------------------------------------------------------


def difference_text(left: Path, right: Path) -> tuple[str, bool]:
    """Say what two lists or two rigs differ in, in effective values; and whether they do.

    Two lists with one axis each are compared whatever the names of the axes.
    """
    ours, theirs = read_parts(left), read_parts(right)
    if len(ours) == len(theirs) == 1:
        (name, mine), (other, yours) = *ours.items(), *theirs.items()
        if mine.kind != yours.kind:
            raise UserError(
                f"a list of the {mine.kind} and one of the {yours.kind} have nothing in common"
            )
        name = name if name == other else f"{name}, {other}"
        ours, theirs = {name: mine}, {name: yours}
    lines = [f"--- {left}", f"+++ {right}"]
    for name in dict.fromkeys([*ours, *theirs]):
        if name not in ours or name not in theirs:
            lines.append(f"{name}: only in {left if name in ours else right}")
            continue
        for key, row, values in _differences(ours[name], theirs[name]):
            is_rotary = ours[name].is_rotary
            before, after = (with_unit(row, value, is_rotary=is_rotary) for value in values)
            lines.append(f"{name}: {key}: {before} -> {after}")
    if lines[2:]:
        return "\n".join(lines), True
    return "no difference", False


def _differences(
    mine: ParameterSet, yours: ParameterSet
) -> Iterator[tuple[str, Parameter, tuple[bool | int | float | str, ...]]]:
    keys = {key for parameters in (mine, yours) for key, _ in parameters.items()}
    for row in table(mine.kind).parameters:
        own = {key for key in keys if INDEX.sub("[i]", key) == row.path}
        for key in sorted(own | {row.path.replace("[i]", "[0]")}):
            values = (mine.get(key), yours.get(key))
            if values[0] != values[1]:
                yield key, row, values


def written_lists(rig: Path, axis: str | None, assignments: Sequence[str]) -> str:
    """Return the lists of all axes of a rig as one, or that of one axis or of the channel."""
    settings = settings_of(rig, assignments)
    parts = parts_of(settings, axis)
    if axis is None:
        parts.pop(CHANNEL)
    for name, parameters in parts.items():
        if parameters.kind == "axis" and not parameters.is_set(NAME):
            parameters.correct(NAME, name)
    return list_text(list(parts.values())).rstrip("\n")
