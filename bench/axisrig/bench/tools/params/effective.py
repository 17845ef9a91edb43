"""What a rig has: effective values and where each comes from; what two lists or rigs differ in."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.bench.files import sha256_of
from axisrig.bench.plan.assignment import MAP_KEYS
from axisrig.bench.rig.contents import CHANNEL, blocks_text, parts_of, read_parts, settings_of
from axisrig.bench.rig.parameter_words import with_unit
from axisrig.bench.rig.reading.file import LIST_KEYS, PROGRAM_KEYS, read_rig
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Parameter, ParameterSet, list_text, table
from axisrig.kernel.parameters.lists import NAME
from axisrig.kernel.parameters.table import INDEX

RIG_SUFFIX = ".toml"
FILE_KEYS = (*LIST_KEYS, *MAP_KEYS, *PROGRAM_KEYS)


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

    Of rigs all else counts too: segments, drives, plants, wiring, PLC, zero offsets, tools; a key
    that a file leaves out counts with its default. Two lists with one axis each are compared
    whatever the names of the axes.
    """
    are_rigs = [path.suffix.lower() == RIG_SUFFIX for path in (left, right)]
    if any(are_rigs) and not all(are_rigs):
        raise UserError("a rig and a list are compared by nothing", hint="name two of a kind")
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
    if all(are_rigs):
        lines += _rig_differences(left, right)
    if lines[2:]:
        return "\n".join(lines), True
    return "no difference", False


def _rig_differences(left: Path, right: Path) -> Iterator[str]:
    """Yield the keys of rigs with their values, without those of lists, which are compared."""
    ours, theirs = (_keys(path) for path in (left, right))
    for key in sorted(ours.keys() | theirs.keys()):
        before, after = (keys.get(key, "not set") for keys in (ours, theirs))
        if before != after:
            yield f"{key}: {before} -> {after}"


def _keys(path: Path) -> dict[str, str]:
    rig, _ = read_rig(path)
    table = rig.model_dump(mode="json")
    table.pop("title", None)
    for part in (table["channel"], *table["axis"].values()):
        part.pop("list", None)
    return dict(_flat(table, ""))


def _flat(value: object, key: str) -> Iterator[tuple[str, str]]:
    """Yield the keys below a value; a file that a key names counts by its content."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _flat(inner, f"{key}.{name}" if key else str(name))
    elif key.rpartition(".")[2] in FILE_KEYS and value is not None:
        file = Path(str(value))
        content = f" (SHA-256 {sha256_of(file)[:12]})" if file.is_file() else ""
        yield key, f"{file.name}{content}"
    elif value is not None:
        yield key, str(value)


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
