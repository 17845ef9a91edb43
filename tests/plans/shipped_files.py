"""Plans and rigs as the text files they are, for tests that import nothing of the bench."""

import csv
import math
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

PLANS = Path(__file__).parents[2] / "testplans"


def rows_of(plan: str) -> dict[str, dict[str, str]]:
    """Return the rows of a plan by case, as they are written."""
    with (PLANS / f"{plan}.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def limits(text: str) -> tuple[float, float]:
    """Return the ends of `5 +- 1`, `4 .. 6` or `<= 6`."""
    if text.startswith("<="):
        return -math.inf, float(text.removeprefix("<="))
    if "+-" in text:
        middle, width = (float(part) for part in text.split(" +- "))
        return middle - width, middle + width
    low, high = (float(part) for part in text.split(" .. "))
    return low, high


@cache
def rig_of(path: Path) -> dict[str, Any]:
    """Return a rig with its base."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    return merged(rig_of(path.parent / table["base"]), table) if "base" in table else table


def merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Return two tables as one; what is above counts."""
    found = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = merged(found[key], value) if both else value
    return found
