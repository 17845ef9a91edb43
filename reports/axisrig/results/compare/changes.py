"""What two campaigns were made from that differs: versions, files, keys of them, cells of plans."""

import json
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from axisrig.bench.campaign.results.layout import INPUTS
from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.results.compare.pairs import RunPair

KEYS_MAX = 20
"""So many keys of a file are named."""
_SHORT = 12
_ABSENT, _EMPTY = "(missing)", "(empty)"


def changes(
    before: StoredResults, after: StoredResults, pairs: Sequence[RunPair]
) -> list[tuple[str, list[str]]]:
    """Say what differs between two folders: what it is, and its keys with both values.

    Files come with the begin of their hashes. Keys are known of TOML and of parameter lists whose
    text both folders have; of other files only that they differ. Cells of the plan are those of
    runs that both folders have.
    """
    return [
        *_versions(before.manifest, after.manifest),
        *_files(before, after),
        *_cells(pairs),
    ]


def _versions(
    before: Mapping[str, Any], after: Mapping[str, Any]
) -> Iterator[tuple[str, list[str]]]:
    names = ("axisrig", "sources_sha256", "compiled", "python", "platform")
    pairs = [(name, before.get(name), after.get(name)) for name in names]
    packages = (before.get("packages", {}), after.get("packages", {}))
    pairs += [
        (name, *(one.get(name) for one in packages)) for name in {**packages[0], **packages[1]}
    ]
    for name, one, other in pairs:
        if one != other and not (one is None or other is None):
            yield f"{name.removesuffix('_sha256')} {_brief(one)} -> {_brief(other)}", []


def _brief(value: object) -> str:
    text = str(value)
    is_hash = len(text) == 64 and all(sign in "0123456789abcdef" for sign in text)
    return text[:_SHORT] if is_hash else text


def _hashes(manifest: Mapping[str, Any]) -> dict[str, str]:
    plans = {Path(plan["path"]).name: plan["sha256"] for plan in manifest.get("plans", [])}
    return {**plans, **manifest.get("files", {}), **manifest.get("fmus", {})}


def _files(before: StoredResults, after: StoredResults) -> Iterator[tuple[str, list[str]]]:
    hashes = [_hashes(folder.manifest) for folder in (before, after)]
    texts = [_texts(folder.folder) for folder in (before, after)]
    for name in sorted({*hashes[0], *hashes[1]}):
        one, other = (found.get(name) for found in hashes)
        if one == other:
            continue
        if one is None or other is None:
            yield f"{name} {'is new' if one is None else 'is missing'}", []
            continue
        keys = _keys(name, texts[0].get(name), texts[1].get(name))
        more = [f"{len(keys) - KEYS_MAX} more"] if len(keys) > KEYS_MAX else []
        yield f"{name} {one[:_SHORT]} -> {other[:_SHORT]}", [*keys[:KEYS_MAX], *more]


def _texts(folder: Path) -> dict[str, str]:
    """Return the texts that a folder has kept; none where an older version wrote it."""
    try:
        found = json.loads((folder / INPUTS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    is_right = isinstance(found, dict) and all(isinstance(text, str) for text in found.values())
    return found if is_right else {}


def _keys(name: str, before: str | None, after: str | None) -> list[str]:
    """Say which keys of a file have which values, where it has keys."""
    if before is None or after is None:
        return []
    read = _of_toml if name.endswith(".toml") else _of_lines
    one, other = read(before), read(after)
    if one is None or other is None:
        return []
    return [
        f"{key} {one.get(key, _ABSENT)} -> {other.get(key, _ABSENT)}"
        for key in dict.fromkeys((*one, *other))
        if one.get(key) != other.get(key)
    ]


def _of_toml(text: str) -> dict[str, str] | None:
    try:
        return dict(_flat(tomllib.loads(text)))
    except tomllib.TOMLDecodeError:
        return None


def _flat(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", json.dumps(value, ensure_ascii=False, default=str).strip('"')


def _of_lines(text: str) -> dict[str, str] | None:
    """Read lines of a name and a value; None where a name is there twice: no such file."""
    found: dict[str, str] = {}
    for line in text.splitlines():
        name, _, value = line.partition("#")[0].strip().partition(" ")
        if not name or name in ("Ende", "End"):
            continue
        if name in found:
            return None
        found[name] = " ".join(value.split())
    return found


def _cells(pairs: Sequence[RunPair]) -> Iterator[tuple[str, list[str]]]:
    """Cells of the plan that differ, with the number of runs."""
    found: Counter[tuple[str, str, str]] = Counter()
    for pair in pairs:
        found.update(_of_pair(pair))
    if found:
        yield (
            "the plan",
            [
                f"{name} {one or _EMPTY} -> {other or _EMPTY}" + (f" in {n} runs" if n > 1 else "")
                for (name, one, other), n in found.most_common(KEYS_MAX)
            ],
        )


def _of_pair(pair: RunPair) -> Iterator[tuple[str, str, str]]:
    before, after = pair.before.case, pair.after.case
    for column in dict.fromkeys((*before, *after)):
        kind = column.partition(":")[0] if ":" in column else ""
        one, other = before.get(column, ""), after.get(column, "")
        if one != other and (
            kind in (*INPUT_KINDS, "info") or column in ("program", "rig", "seed")
        ):
            yield column, one, other
    checks = {row.metric: row.asked for row in pair.before.checks}
    for row in pair.after.checks:
        asked = checks.get(row.metric, row.asked)
        if asked != row.asked:
            yield f"check:{row.metric}", asked, row.asked
