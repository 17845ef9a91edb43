"""Shipped rigs with their axes on an EtherCAT line in the place of CAN, all else as it is."""

import json
import re
from pathlib import Path
from typing import Any

from tests.plans.distance_law import PLANS, rig_of

SERCOS_KEYS = ("encoder_increments", "lead_mm", "second_delay_cycles", "lag_limit_mm")
"""Keys of a drive that mean the same for SERCOS."""


def on_ethercat(
    name: str, folder: Path, line: dict[str, float] | None = None, *, sercos: bool = False
) -> Path:
    """Write a rig of `testplans` into a folder and return its path.

    line: keys of each `[segment]` beside the carrier. sercos: its drives are SERCOS drives with the
    second position feedback in the AT, no axis measures, and P-AXIS-00020 = 2 is in their
    lists.
    """
    rig: dict[str, Any] = json.loads(json.dumps(rig_of(name)))
    for segment in rig["segment"].values():
        segment.clear()
        segment.update({"carrier": "ethercat"} | (line or {}))
    for axis in rig["axis"].values():
        axis.pop("node", None)
    if sercos:
        rig["drive"] = {key: _as_sercos(drive) for key, drive in rig["drive"].items()}
    rig.pop("base", None)
    lists = folder / "lists"
    if not lists.exists():
        if sercos:
            _write_lists(lists)
        else:
            lists.symlink_to(PLANS / "rigs" / "lists")
    path = folder / Path(name).name
    path.write_text("\n".join(_written(rig, ())), encoding="utf-8")
    return path


def _write_lists(folder: Path) -> None:
    """Write the lists of `testplans` with drives of the type SERCOS and no measuring axes."""
    folder.mkdir()
    for path in (PLANS / "rigs" / "lists").iterdir():
        text = path.read_text(encoding="utf-8")
        text = re.sub(r"(?m)^(kenngr\.antr_typ\s+)8\b", r"\g<1>2", text)
        text = re.sub(r"(?m)^(kenngr\.messachse\s+)1\b", r"\g<1>0", text)
        (folder / path.name).write_text(text, encoding="utf-8")


def _as_sercos(drive: dict[str, Any]) -> dict[str, Any]:
    kept = {key: drive[key] for key in SERCOS_KEYS if key in drive}
    telegrams = {
        "at": ["S-0-0051", "S-0-0053"],
        "resolution": drive["encoder_increments"],
    }
    return {"family": "sercos"} | kept | telegrams


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
