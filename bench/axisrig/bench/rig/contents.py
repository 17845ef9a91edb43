"""What a rig or a list has, as text: effective values and where each comes from."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.parameter_words import decided_by, named, with_unit
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.lists import offset_notes
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.coordinates.lists import forms, guess_list
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.nc.coordinates.tools import inch_tools
from axisrig.kernel.parameters import (
    KINDS,
    Kind,
    Parameter,
    ParameterSet,
    names,
    read_sections,
    start_up,
    table,
    written,
)
from axisrig.kernel.parameters.lists import NAME
from axisrig.kernel.parameters.relations import noted
from axisrig.kernel.parameters.table import INDEX
from axisrig.kernel.parameters.units import UNITS_PER_MM

CHANNEL = "channel"


def settings_of(rig: Path, assignments: Sequence[str]) -> Settings:
    """Read a rig with the assignments of the command line."""
    changes = [(parse_assignment(text), as_written) for text in assignments]
    return read_settings(*read_rig(rig), changes)


def parts_of(settings: Settings, axis: str | None) -> dict[str, ParameterSet]:
    """Return the parts of a rig by axis name or `channel`, or that of one axis.

    Raises UserError for an axis that the rig does not have.
    """
    parts = {CHANNEL: settings.channel, **settings.axis}
    if axis is None:
        return parts
    if axis not in parts:
        raise UserError("the rig has no such axis", value=axis, allowed=parts)
    return {axis: parts[axis]}


def contents_text(path: Path) -> str:
    """Say what a list sets, in both units, what of it is corrected and what does not act yet."""
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    offsets = guess_list(text)
    if offsets is not None:
        return _offsets_text(path, offsets)
    parts = read_parts(path)
    warnings = [
        f"warning: {warning}"
        for name, parameters in parts.items()
        for warning in start_up(parameters, name)
    ]
    blocks = blocks_text(parts, None)
    inert = [
        f"note: {key} = {written(value)} does not act yet"
        for parameters in parts.values()
        for key, value in parameters.inert()
    ]
    relations = [f"note: {words}" for parameters in parts.values() for words in noted(parameters)]
    notes = [*warnings, *relations, *_of_kind(parts.values()), *inert]
    return "\n\n".join([*blocks, *(["\n".join(notes)] if notes else [])]) or "the list is empty"


def _of_kind(parts: Iterable[ParameterSet]) -> list[str]:
    """Say of a list of which nothing acts that it changes nothing."""
    kinds = dict.fromkeys(parameters.kind for parameters in parts)
    return [
        f"note: a list of this kind ({kind}) is read and changes nothing: no rig takes it"
        for kind in kinds
        if all(row.acts == "no" for row in table(kind).parameters)
    ]


def _offsets_text(path: Path, name: str) -> str:
    """Say what a list of zero offsets or tools sets; its axes are known with a rig only."""
    lists = Lists()
    lists.read(name, path)
    unit = {form.path: form.unit for form in forms(name).values()}
    inches = inch_tools(lists.entries[name])
    lines = []
    for entry in lists.entries[name]:
        in_mm = ""
        if unit[entry.path] and not set(entry.indices[:1]) & inches:
            in_mm = f" x {unit[entry.path]} = {float(entry.value) / UNITS_PER_MM:g} mm"
        lines.append(f"  {entry.written}{in_mm}  {entry.origin.short}")
    notes = [f"note: {note}" for note in offset_notes(lists)]
    return "\n".join([name, *lines, *(["", *notes] if notes else [])])


def blocks_text(parts: Mapping[str, ParameterSet], words: Sequence[str] | None) -> list[str]:
    """List values with their places; words None: only what is set."""
    blocks = []
    for name, parameters in parts.items():
        rows = [
            (key, with_unit(row, found, is_rotary=parameters.is_rotary), place)
            for key, row, found, place in _values(parameters, words or [])
            if words is not None or parameters.is_set(key)
        ]
        if rows:
            title = f"axis {name}" if parameters.kind == "axis" else parameters.kind
            widths = [max(len(row[at]) for row in rows) for at in (0, 1)]
            lines = [f"  {key:<{widths[0]}}  {value:<{widths[1]}}  {place}".rstrip()
                     for key, value, place in rows]  # fmt: skip
            blocks.append("\n".join([title, *lines]))
    return blocks


def _values(
    parameters: ParameterSet, words: Sequence[str]
) -> Iterator[tuple[str, Parameter, bool | int | float | str, str]]:
    for row in table(parameters.kind).parameters:
        one = named(words[0]) if len(words) == 1 else None
        text = " ".join([row.number, *names(row), row.meaning]).lower()
        if one is not None and one is not row:
            continue
        if one is None and not all(word.lower() in text for word in words):
            continue
        for key in _keys(parameters, row, is_all=bool(words)):
            found = parameters.resolve(key)
            yield key, row, found.value, decided_by(found, key)


def _keys(parameters: ParameterSet, row: Parameter, *, is_all: bool) -> list[str]:
    """Return the present paths of a row that are worth a line."""
    keys = [key for key, _ in parameters.items() if INDEX.sub("[i]", key) == row.path]
    first = row.path.replace("[i]", "[1]" if "second" in row.acts else "[0]")
    is_element = "indexed" in row.acts or row.acts == "no"
    if first not in keys and (is_all or not is_element):
        keys.insert(0, first)
    return keys


def guess_kind(path: Path) -> Kind:
    """Find out which kind a list has: that of most of its names, then of the fewest errors."""
    if not path.is_file():
        return KINDS[0]  # whose reader reports it
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    words = [line.split()[0] for line in text.splitlines() if line.strip()]

    def strangeness(kind: Kind) -> tuple[int, int, int]:
        unknown = sum(table(kind).row(word) is None for word in words)
        return unknown, _error_count(path, kind), KINDS.index(kind)

    return min(KINDS, key=strangeness)


def _error_count(path: Path, kind: Kind) -> int:
    try:
        read_sections(path, kind)
    except UserError as error:
        return 1 + len(error.further)
    return 0


def read_parts(path: Path) -> dict[str, ParameterSet]:
    """Return the parts of a rig or of a list by axis name or `channel`."""
    if path.suffix.lower() == ".toml":
        return parts_of(settings_of(path, []), None)
    kind = guess_kind(path)
    sections = read_sections(path, kind)
    if kind != "axis":
        return {kind: sections[0]}
    return {section.word(NAME) or f"#{at}": section for at, section in enumerate(sections, 1)}
