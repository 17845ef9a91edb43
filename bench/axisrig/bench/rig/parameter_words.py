"""Parameters and their values in words, shared by all outputs of `axisrig params`."""

from collections.abc import Iterator, Sequence

from axisrig.kernel.parameters import (
    KINDS,
    UNITS,
    Parameter,
    Resolved,
    Value,
    names,
    table,
    written,
)
from axisrig.kernel.parameters.table import Fallback

UNSET = {"=0": "0", "<0": "negative", "<=0": "0 or negative", "blank": "blank"}


def every_parameter() -> Iterator[Parameter]:
    """Give all rows of all tables, in the order of the topics."""
    for kind in KINDS:
        yield from table(kind).parameters


def chosen(words: Sequence[str]) -> list[Parameter]:
    """Return the rows in whose number, names, topic, source or meaning every word occurs."""
    found = []
    for row in every_parameter():
        text = " ".join([row.number, *names(row), row.kind, row.topic, row.source, row.meaning])
        if all(word.lower() in text.lower() for word in words):
            found.append(row)
    return found


def named(word: str) -> Parameter | None:
    """Return the one row that a number, a present or an older path means.

    Of a number without its kind zeros in front may be missing: `774` is P-AXIS-00774.
    """
    for kind in KINDS:
        row = table(kind).numbered(word) or table(kind).row(word)
        if row is not None:
            return row
    digits = f"-{word.zfill(5)}" if word.isdecimal() else f"-{word}"
    short = [row for row in every_parameter() if row.number.endswith(digits)]
    return short[0] if len(short) == 1 else None


def default(row: Parameter) -> str:
    """Write the default."""
    return written(row.default) or "blank"


def unit_of(row: Parameter, *, is_rotary: bool = False) -> str:
    """Return the manuals' unit of a row, for a linear or a rotary axis."""
    return UNITS[row.unit].of(is_rotary=is_rotary) if row.unit else ""


def with_unit(row: Parameter, value: Value, *, is_rotary: bool = False) -> str:
    """Write a value in the manuals' unit and in that of people: `100 0.1 um = 0.01 mm`."""
    text = written(value) or "blank"
    if isinstance(value, str) or not row.unit:
        return text
    unit = UNITS[row.unit]
    name = unit.of(is_rotary=is_rotary)
    as_listed = f"{text} x {name}" if name[0].isdigit() else f"{text} {name}"
    is_mark = row.unset.startswith("<") and value < 0  # means not set, it is no length
    if unit.divisor == 1 or is_mark:
        return as_listed
    return f"{as_listed} = {unit.converted(value, is_rotary=is_rotary)}"


def range_of(row: Parameter) -> str:
    """Say what may be written, without the unit."""
    return row.allowed.removesuffix(f" {row.unit}") if row.unit else row.allowed


def chain(row: Parameter) -> str:
    """Say what decides while the parameter is unset, link by link; blank if nothing does."""
    if not row.fallback:
        return ""
    indices = dict.fromkeys(other.index for other in row.fallback)
    parts = [
        ("" if index is None else f"[{index}] ") + ", then ".join(_links(row, index, set()))
        for index in indices
    ]
    end = "" if row.otherwise is None else f"; else {written(row.otherwise)}"
    return f"{UNSET[row.unset]}: " + "; ".join(parts) + end


def _links(row: Parameter, index: int | None, seen: set[str]) -> Iterator[str]:
    fallback = [other for other in row.fallback if other.index == index]
    several = [other for other in fallback if other.word is None]
    if len(several) > 1:
        yield "the smallest of " + " and ".join(_label(row, other) for other in several)
        return
    for other in fallback:
        found = table_row(row, other)
        if found.path in seen:
            continue
        seen.add(found.path)
        yield _label(row, other)
        if other.word is None:
            yield from _links(found, None, seen)


def table_row(row: Parameter, other: Fallback) -> Parameter:
    """Return the row that a fallback names."""
    for kind in KINDS:
        if kind == row.kind:
            found = table(kind).row(other.path)
            if found is not None:
                return found
    raise KeyError(other.path)


def _label(row: Parameter, other: Fallback) -> str:
    found = table_row(row, other)
    number = f" ({found.number})" if found.number else ""
    word = "" if other.word is None else f"{other.word} by "
    return f"{word}{found.path}{number}"


def warning(row: Parameter) -> str:
    """Say what becomes of a value out of range that has a documented warning."""
    how = row.correction
    if how is None:
        return ""
    ids = f"{how.alarm_id}" + (f" ({how.older_id} in the older structure)" if how.older_id else "")
    if how.is_kept:
        return f"{ids}, not corrected"
    if how.low is not None:
        return f"{ids}, corrected to {written(how.low)} or the upper limit"
    return f"{ids}, corrected to the nearer limit" + (" when above" if how.is_above_only else "")


def acts(row: Parameter) -> str:
    """Say whether the parameter acts, or which values of it do."""
    words = [word for word in row.acts.split() if word not in ("indexed", "second")]
    return ", ".join(words)


def decided_by(found: Resolved, key: str) -> str:
    """Say where an effective value comes from."""
    place = "default" if found.origin is None else found.origin.short
    return place if found.key == key else f"{found.key}: {place}"
