"""What the suite says: as a table, as the table of a page, and beside an earlier measurement."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from axisrig.bench.tools.perf.gains import gain, gains_table
from axisrig.bench.tools.perf.perf import build_line
from axisrig.kernel.errors import UserError

Result = Mapping[str, Any]

HEADER = ("measure", "row", "reach", "measured", "reached")
# What a table says beside the value of an entry that has it
_BESIDE = {
    "apart": "two processes apart",
    "by_cpu": "by CPU time",
    "row_ms": "without opening and closing the folder",
}


def show_suite(result: Result) -> str:
    """Return the suite as a table of text."""
    rows = [HEADER, *_rows(result)]
    widths = [max(len(row[place]) for row in rows) for place in range(len(HEADER))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    return "\n".join([*lines, "", *_remarks(result)])


def markdown(result: Result) -> str:
    """Return the suite as the table of docs/performance.md."""
    lines = ["| " + " | ".join(row) + " |" for row in (HEADER, *_rows(result))]
    lines.insert(1, "|" + "---|" * len(HEADER))
    return "\n".join([*lines, "", *(f"- {remark}" for remark in _remarks(result))])


def row_of(entry: Result) -> str:
    """Return how a table names what is measured: row of a plan, or file."""
    return f"`{entry['plan']}` {entry['row']}".strip() if entry["plan"] else ""


def reach_of(entry: Result) -> str:
    """Return what is to be reached, compiled / interpreted where there are two numbers."""
    sign = "" if entry["better"] == "more" else "<= "
    both = (entry["reach"], entry["reach_interpreted"])
    numbers = " / ".join(f"{number:g}" for number in both if number is not None)
    return f"{sign}{numbers} {entry['unit']}".rstrip()


def _rows(result: Result) -> list[tuple[str, ...]]:
    return [
        (e["measure"], row_of(e), reach_of(e), _measured(e), _reached(e)) for e in result["suite"]
    ]


def _measured(entry: Result) -> str:
    if entry["value"] is None:
        return f"not here: {entry['note']}"
    text = f"{_number(entry['value'])} ({_number(entry['least'])} to {_number(entry['most'])})"
    beside = [f"{words} {_number(entry[key])}" for key, words in _BESIDE.items() if key in entry]
    return "; ".join([text, *beside])


def _number(value: float) -> str:
    return f"{value:.1f}" if abs(value) >= 3 else f"{value:.2f}"


def _reached(entry: Result) -> str:
    if entry["value"] is None:
        return ""
    words = {True: "yes", False: "no", None: "-"}
    return words[entry["is_reached"]]


def _remarks(result: Result) -> list[str]:
    """Say what ran and where, and what a measurement needs that this machine lacks."""
    said = "unknown" if result["load_1min"] is None else f"{result['load_1min']:.1f}"
    lines = [
        f"{build_line(result)}; Python {result['python']}, {result['machine']},"
        f" {result['cores']} cores, load at the begin {said}; median of {result['repeats']} turns"
        " at most, least and most beside it",
    ]
    if any(e["value"] is not None and e["is_reached"] is None for e in result["suite"]):
        lines.append("`-`: the number holds for the compiled build")
    if any("apart" in entry for entry in result["suite"]):
        lines.append(
            "`two processes apart`: what the machine allowed at that time, two processes that each"
            " run rows for themselves and share nothing; `by CPU time`: what two idle cores would"
            " allow, for two workers take more CPU time than one"
        )
    if not result["has_two_idle_cores"]:
        lines.append("this machine has not two idle cores: two workers gain less, CPU times grow")
    return lines


def read_suite_result(path: Path) -> dict[str, Any]:
    """Read what `--json` printed. Raises UserError when a file is none of that."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"no result of the suite: {error}", file=path) from error
    if not isinstance(found, dict) or "suite" not in found:
        raise UserError("no result of the suite", file=path, hint="--json prints one")
    return found


def gains(now: Result, before: Result) -> dict[str, float | None]:
    """Return how much better each measure is than before: 2 is twice as good, below 1 is worse.

    None: not measured in both, or no ratio.
    """
    old = {entry["measure"]: entry.get("value") for entry in before["suite"]}
    return {
        entry["measure"]: gain(
            entry["value"], old.get(entry["measure"]), is_more_better=entry["better"] == "more"
        )
        for entry in now["suite"]
    }


def show_gains(now: Result, before: Result) -> str:
    """Return the gains as a table, with what was measured then."""

    def hashes(result: Result) -> dict[str, str]:
        found = [entry for entry in result["suite"] if "frame_log_sha256" in entry]
        return {entry["measure"]: entry["frame_log_sha256"] for entry in found}

    old = hashes(before)
    differ = [name for name, sha in hashes(now).items() if old.get(name, sha) != sha]
    return gains_table(gains(now, before), before, differ)
