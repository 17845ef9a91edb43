"""Alarms as text for a reader: the list, one of them, and the page docs/errors.md."""

import re
from collections.abc import Iterable, Iterator
from difflib import SequenceMatcher
from textwrap import fill

from axisrig.kernel.errors import (
    CatalogueEntry,
    Guess,
    UserError,
    catalogue,
    nearest,
    reaction_classes,
)

_NEAR = 500
_WIDTH, _INDENT = 96, 11
_GUESSED_FROM, _ALIKE = 4, 0.75
_UNITS = {
    "mm": "mm", "ms": "ms", "s": "s", "us": "us", "hz": "Hz", "deg": "degrees",
    "um_s": "um/s", "mm_s": "mm/s", "mm_s2": "mm/s2", "mm_min": "mm/min", "permille": "0.1 %",
}  # fmt: skip


def unit_of(name: str) -> str:
    """The unit at the end of the name of a value, or nothing."""
    ends = [end for end in _UNITS if name == end or name.endswith(f"_{end}")]
    return _UNITS[max(ends, key=len)] if ends else ""


def alarm_listing(
    word: str | None = None, reaction_class: int | None = None, area: str | None = None
) -> str:
    """One line per alarm whose text, remedy, source or values have the word; or all of one ID.

    Raises UserError for an ID or an area that is not there, and when nothing fits.
    """
    if word is not None and word.removeprefix("ID").strip().isdecimal():
        return explained(int(word.removeprefix("ID")))
    areas = sorted({entry.area for entry in catalogue().values()})
    if area is not None and area not in areas:
        raise UserError("no area of alarms", value=area, allowed=nearest(area, areas) or areas)
    asked = [
        entry
        for entry in catalogue().values()
        if (reaction_class is None or entry.reaction_class == reaction_class)
        and (area is None or entry.area == area)
    ]
    found = [entry for entry in asked if word is None or word.casefold() in _searched(entry)]
    if not found:
        words = {part for entry in asked for part in _searched(entry).split()}
        raise UserError(
            "no alarm fits",
            value=word or reaction_class,
            allowed=_alike(word or "", words) or None,
            hint="axisrig errors lists all",
        )
    lines = [f"{e.id:>6}  {e.reaction_class}  {_mark(e)}{_plain(e.text)}" for e in found]
    legend = f"ID, class, text; {len(found)} of {len(catalogue())}. (-) nothing raises it yet."
    return "\n".join([*lines, "", legend, "axisrig errors ID shows all about one."])


def _alike(word: str, words: Iterable[str]) -> Guess:
    """Words that differ from one by little: a short one has none, for it is like many."""
    if len(word) < _GUESSED_FROM:
        return Guess()
    ratio = SequenceMatcher(None, "", word.casefold())
    close = nearest(word, {part.strip(".,:;(){}") for part in words})
    found = Guess()
    for other in close:
        ratio.set_seq1(other)
        if ratio.ratio() >= _ALIKE:
            found.append(other)
    return found


def _searched(entry: CatalogueEntry) -> str:
    return f"{entry.text} {entry.remedy} {entry.source} {entry.area} {entry.reaction}".casefold()


def _mark(entry: CatalogueEntry) -> str:
    return "(-) " if _is_later(entry) else ""


def _plain(text: str) -> str:
    """The text with its places as names in angle brackets."""
    return re.sub(r"\{(\w+)\}", r"<\1>", text)


def explained(alarm_id: int) -> str:
    """Everything about one ID; raises UserError with the nearest ones for one that is not there."""
    entry = catalogue().get(alarm_id)
    if entry is None:
        raise UserError("no alarm has this ID", value=alarm_id, allowed=_near(alarm_id) or None)
    reaction = reaction_classes()[entry.reaction_class]
    head = f"ID {entry.id}, class {entry.reaction_class}: {entry.reaction} ({entry.area})"
    return "\n".join([head, *(f"{name:<{_INDENT}}{text}" for name, text in _rows(entry, reaction))])


def _rows(entry: CatalogueEntry, reaction: dict[str, str]) -> Iterator[tuple[str, str]]:
    facts = {
        "says": _plain(entry.text),
        "values": ", ".join(_with_unit(name) for name in entry.values),
        "family": entry.relation,
        "machine": reaction["machine"],
        "remedy": entry.remedy,
        "afterwards": reaction["afterwards"],
        "type": _TYPES.get(entry.error_type, ""),
        "raised": _raised(entry),
        "source": entry.source,
        "inferred": ", ".join(entry.inferred),
    }
    for name, text in facts.items():
        if text:
            yield name, fill(text, _WIDTH - _INDENT, subsequent_indent=" " * _INDENT)


def _raised(entry: CatalogueEntry) -> str:
    if _is_later(entry):
        return "not yet: what leads to it does not act here"
    return "yes" if entry.is_raised else f"as {entry.older_id}"


def _is_later(entry: CatalogueEntry) -> bool:
    """Whether nothing raises it, nor its older twin in its place."""
    return not any(catalogue()[i].is_raised for i in (entry.id, entry.older_id or entry.id))


_TYPES: dict[int | None, str] = {
    1: "from the NC program",
    2: "from the transfer of the parameters",
    11: "from the position control",
}


def _with_unit(name: str) -> str:
    unit = unit_of(name)
    return f"{name} [{unit}]" if unit and unit != name else name


def _near(alarm_id: int) -> Guess:
    """IDs that look alike or are next to it, with what they say."""
    known = catalogue()
    alike = [int(word) for word in nearest(str(alarm_id), map(str, known))]
    beside = sorted(known, key=lambda other: abs(other - alarm_id))[:2]
    ids = dict.fromkeys([*alike, *(i for i in beside if abs(i - alarm_id) <= _NEAR)])
    return Guess(f"{i} ({_plain(known[i].text)})" for i in list(ids)[:4])


# The page


def page() -> str:
    """The text of docs/errors.md."""
    entries = list(catalogue().values())
    areas = sorted({entry.area for entry in entries}, key=lambda area: _order(area, entries))
    parts = [_PAGE_HEAD, *_class_table(), ""]
    for area in areas:
        parts += [
            f"## {area[0].upper()}{area[1:]}",
            "",
            *_table(e for e in entries if e.area == area),
        ]
        parts.append("")
    return "\n".join(parts).rstrip() + "\n"


def _order(area: str, entries: Iterable[CatalogueEntry]) -> tuple[bool, str]:
    """Areas that act come first."""
    return not any(entry.is_raised for entry in entries if entry.area == area), area.casefold()


_PAGE_HEAD = """# Alarms

All alarm IDs, by area, made from `kernel/axisrig/kernel/errors.csv` by
`axisrig errors --format markdown`.
IDs below 900000 are those of the manuals, the others are ours where no ID is documented.
`axisrig errors 70331` shows all about one, `axisrig errors probe` finds those that have to do with
a probe. How to add one: [architecture.md](architecture.md), "Errors and alarms".

*(later)*: nothing raises it yet, its function does not act. *(?)* after class or text: no source
at hand says so, it is inferred. Where an ID has an older or newer twin the older one is reported,
and a check of a plan takes either. The block that the manuals list among the values is the place
of the alarm.

## What the classes do
"""


def _class_table() -> Iterator[str]:
    yield "| class | reaction | the machine | afterwards |"
    yield "|---|---|---|---|"
    for number, row in reaction_classes().items():
        yield f"| {number} | {row['reaction']} | {row['machine']} | {row['afterwards']} |"


def _table(entries: Iterable[CatalogueEntry]) -> Iterator[str]:
    yield "| ID | class | text | what to do | source |"
    yield "|---|---|---|---|---|"
    for e in entries:
        twin = e.newer_id or e.older_id
        name = f"{e.id}{f' ({twin})' if twin else ''}{' *(later)*' if _is_later(e) else ''}"
        number = f"{e.reaction_class}{_guess('class', e)}"
        text = f"{_cell(e.text)}{_guess('text', e)}"
        yield f"| {name} | {number} | {text} | {_cell(e.remedy)} | {_cell(e.source)} |"


def _guess(column: str, entry: CatalogueEntry) -> str:
    return " *(?)*" if column in entry.inferred else ""


def _cell(text: str) -> str:
    return re.sub(r"\{(\w+)\}", r"*\1*", text).replace("|", "\\|")
