"""A measurement of a row beside an earlier one."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from axisrig.bench.tools.perf.perf import build_line
from axisrig.kernel.errors import UserError

Result = Mapping[str, Any]

# What a row has beside its case: key -> whether more is better
MORE_IS_BETTER = {
    "real_time_factor": True,
    "cpu_factor": True,
    "cpu_s": False,
    "beyond_simulation_ms": False,
}


def read_result(path: Path) -> dict[str, Any]:
    """Read what `--json` printed. Raises UserError when a file is none of that."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"no result of axisrig perf: {error}", file=path) from error
    if not isinstance(found, dict) or "real_time_factor" not in found:
        raise UserError("no result of axisrig perf --json", file=path)
    return found


def gain(now: float | None, before: float | None, *, is_more_better: bool) -> float | None:
    """Return how much better a number is than before: 2 is twice as good; None without a ratio."""
    if now is None or before is None or now <= 0 or before <= 0:
        return None
    return now / before if is_more_better else before / now


def gains(now: Result, before: Result) -> dict[str, float | None]:
    """Return the gain of each number of a row. Raises UserError for another row."""
    if now["case"] != before["case"]:
        raise UserError("not the same row", value=before["case"], allowed=[now["case"]])
    return {
        name: gain(now.get(name), before.get(name), is_more_better=is_more)
        for name, is_more in MORE_IS_BETTER.items()
    }


def gains_table(found: Mapping[str, float | None], before: Result, differ: list[str]) -> str:
    """Return gains as a table, with what was measured then; differ: names of other frames."""
    width = max(map(len, found))
    lines = ["against the file (above 1: better than it)"]
    for name, value in found.items():
        lines.append(f"  {name.ljust(width)}  {'-' if value is None else f'{value:.2f}'}")
    lines.append(f"the file: {build_line(before)}" if "compiled" in before else "")
    lines += [f"frames differ: {name}" for name in differ]
    return "\n".join(lines).rstrip()


def show_gains(now: Result, before: Result) -> str:
    """Return the gains of a row as a table."""
    sha = now.get("frame_log_sha256")
    is_other = before.get("frame_log_sha256", sha) != sha
    return gains_table(gains(now, before), before, [now["case"]] if is_other else [])
