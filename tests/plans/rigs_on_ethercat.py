"""Shipped rigs with their axes on an EtherCAT line in the place of CAN, all else as it is."""

import json
from pathlib import Path
from typing import Any

from tests.plans.distance_law import PLANS, rig_of


def on_ethercat(name: str, folder: Path, line: dict[str, float] | None = None) -> Path:
    """Write a rig of `testplans` into a folder and return its path.

    line: keys of each `[segment]` beside the carrier.
    """
    rig: dict[str, Any] = json.loads(json.dumps(rig_of(name)))
    for segment in rig["segment"].values():
        segment.clear()
        segment.update({"carrier": "ethercat"} | (line or {}))
    for axis in rig["axis"].values():
        axis.pop("node", None)
    rig.pop("base", None)
    lists = folder / "lists"
    if not lists.exists():
        lists.symlink_to(PLANS / "rigs" / "lists")
    path = folder / Path(name).name
    path.write_text("\n".join(_written(rig, ())), encoding="utf-8")
    return path


def _written(table: dict[str, Any], place: tuple[str, ...]) -> list[str]:
    """Return a table of TOML; tables below the second level are inline."""
    lines = [f"[{'.'.join(map(json.dumps, place))}]"] if place else []
    inner = {key: value for key, value in table.items() if isinstance(value, dict)}
    inner = inner if len(place) < 2 else {}
    plain = {key: value for key, value in table.items() if key not in inner}
    lines += [f"{json.dumps(key)} = {_value(value)}" for key, value in plain.items()]
    for key, value in inner.items():
        lines += _written(value, (*place, key))
    return lines


def _value(value: Any) -> str:
    if isinstance(value, dict):
        entries = (f"{json.dumps(key)} = {_value(entry)}" for key, entry in value.items())
        return f"{{ {', '.join(entries)} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return json.dumps(value)
