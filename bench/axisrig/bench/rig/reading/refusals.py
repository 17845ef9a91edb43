"""What is wrong with the tables of a rig: errors of their form, and names that nothing has."""

import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic_core import ErrorDetails

from axisrig.bench.rig.reading.places import locate
from axisrig.bench.rig.reading.tables import in_words
from axisrig.kernel.errors import UserError

Keys = tuple[str, ...]
_UNKNOWN, _MISSING = "extra_forbidden", "missing"
NAMED_MAX = 20
"""So many keys are named beside the one that was meant."""


def form_errors(
    details: Sequence[ErrorDetails],
    files: list[Path],
    keys_of: Callable[[ErrorDetails], Keys],
    known_keys: Callable[[Keys], list[str]],
) -> Iterator[UserError]:
    """Make the errors of a rig that has not the form of one, one for each key.

    keys_of: the keys that a detail is about. known_keys: those that there may be instead of one.
    A key that is missing since it was misspelt, or may be, is reported by its wrong name only.
    """
    meant: set[Keys] = set()
    unclear: set[Keys] = set()
    for one in sorted(details, key=lambda e: e["type"] != _UNKNOWN):
        keys = keys_of(one)
        if keys in meant:
            continue
        meant.add(keys)
        file, line = locate(files, keys)
        place = ".".join(keys)
        if one["type"] == _UNKNOWN:
            known = known_keys(keys)
            near = difflib.get_close_matches(keys[-1], known, n=1) or _same_but_unit(keys, known)
            meant.update((*keys[:-1], name) for name in near)
            unclear.update([keys[:-1]] if not near else [])
            hint = f"did you mean {near[0]}?" if near else None
            message = f"unknown rig key {place}"
            allowed = known if len(known) <= NAMED_MAX or not near else None
            yield UserError(message, file=file, line=line, allowed=allowed, hint=hint)
        elif one["type"] == _MISSING:
            if keys[:-1] in unclear:
                continue
            yield UserError(f"the rig lacks the key {place}", file=file, line=line)
        else:
            message = f"{place}: {in_words(one['type'], one['msg'])}"
            yield UserError(message, file=file, line=line, value=one.get("input"))


def _same_but_unit(keys: Keys, known: Sequence[str]) -> list[str]:
    """Return the key with the same first word, where there is one only."""
    first = keys[-1].partition("_")[0]
    same = [name for name in known if name.partition("_")[0] == first]
    return same if len(same) == 1 else []


def reference_errors(
    table: Mapping[str, Any],
    files: list[Path],
    plant_keys: Sequence[str],
    ideal: Mapping[str, str],
    known: Sequence[str],
) -> Iterator[UserError]:
    """Find what axes and variables of the PLC name and the rig does not have.

    table: the rig as it was read, whatever its form is. plant_keys: keys of an axis that name a
    plant. ideal: key -> a word that names none. known: tables that a rig may have; what a misspelt
    one holds is not reported as missing.
    """
    unread = {
        near
        for name in table
        if name not in known
        for near in difflib.get_close_matches(name, known, n=1)
    }
    kinds = {"segment": "segment", "drive": "drive", **dict.fromkeys(plant_keys, "plant")}
    asked: list[tuple[Keys, str, str, object]] = []
    for name, axis in _tables(table, "axis"):
        for key, kind in kinds.items():
            if axis.get(key) != ideal.get(key, ""):
                asked.append((("axis", name, key), f"axis {name}: {key}", kind, axis.get(key)))
    for name, entry in _tables(table, "plc"):
        if name.startswith("V.E."):
            asked.append((("plc", name), f"{name}: sensor", "plant", entry.get("sensor")))
    for keys, what, kind, value in asked:
        there = table.get(kind)
        if not isinstance(value, str) or not isinstance(there, dict) or kind in unread:
            continue
        if value not in there:
            file, line = locate(files, keys)
            message = f"{what} names nothing in this rig"
            yield UserError(message, file=file, line=line, value=value, allowed=there)


def _tables(table: Mapping[str, Any], kind: str) -> Iterator[tuple[str, dict[str, Any]]]:
    inside = table.get(kind)
    for name, entry in (inside if isinstance(inside, dict) else {}).items():
        if isinstance(entry, dict):
            yield name, entry
