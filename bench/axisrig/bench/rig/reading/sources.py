"""The files that a rig is made from, to keep their hashes."""

from pathlib import Path
from typing import Any

from axisrig.bench.plan.assignment import MAP_KEYS
from axisrig.bench.rig.reading.file import (
    LIST_KEYS,
    MODEL_SUFFIX,
    PROGRAM_KEYS,
    load_tables,
)
from axisrig.kernel.errors import UserError


def rig_files(path: Path) -> list[Path]:
    """Return a rig, its bases, and the lists, EDS files, PDO maps, FMUs, models and PLC program.

    Raises UserError when it cannot be read.
    """
    table, files = load_tables(path.resolve())
    named = {
        *_named(table.get("channel"), LIST_KEYS),
        *_named(table.get("plc"), PROGRAM_KEYS),
        *(name for axis in _entries(table, "axis") for name in _named(axis, LIST_KEYS)),
        *(name for drive in _entries(table, "drive") for name in _named(drive, MAP_KEYS)),
        *(name for plant in _entries(table, "plant") for name in _named(plant, ("fmu",))),
    }
    # A model or a map of this bench is called by its name
    paths = {Path(name) for name in named if Path(name).is_absolute()}
    # A model may use those beside it
    folders = {path.parent for path in paths if path.suffix == MODEL_SUFFIX and path.is_file()}
    paths |= {path for folder in folders for path in folder.rglob(f"*{MODEL_SUFFIX}")}
    return [*files, *sorted(paths)]


def info_of_rig(path: Path) -> dict[str, Any]:
    """Return the table `[info]` of a rig with its bases; empty where the rig cannot be read."""
    try:
        table, _ = load_tables(path.resolve())
    except (UserError, OSError):
        return {}
    found = table.get("info")
    return dict(found) if isinstance(found, dict) else {}


def _entries(table: dict[str, Any], kind: str) -> list[Any]:
    entries = table.get(kind)
    return list(entries.values()) if isinstance(entries, dict) else []


def _named(entry: Any, keys: tuple[str, ...]) -> set[str]:
    return {str(entry[key]) for key in keys if key in entry} if isinstance(entry, dict) else set()
