"""Compares two results folders: `python tests/tools/compare_campaigns.py BEFORE AFTER`.

Says of which runs frames, verdict, or a check with its value, verdict or condition changed, and
which runs are new or lost. `--expected FILE` names runs that may: an id a line, behind `#` why.
Exit code: 0 when all others are equal, 1 when not, 2 when a folder or the file cannot be read.
"""

import argparse
import csv
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

Row = Mapping[str, str]
Checks = dict[str, Row]
Campaign = dict[str, tuple[Row, Checks]]

FRAMES = "frame_log_sha256"
OF_A_CHECK = ("check", "value", "verdict")


def main(arguments: list[str] | None = None) -> int:
    """Compare and print; return the exit code."""
    parser = argparse.ArgumentParser(description="Compare two results folders of axisrig.")
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--expected", type=Path, help="file with ids of runs that may differ")
    words = parser.parse_args(arguments)
    try:
        before, after = read(words.before), read(words.after)
        expected = expectations(words.expected) if words.expected else set()
    except (OSError, UnicodeDecodeError, KeyError, csv.Error) as error:
        print(f"error: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    if not before or not after:
        print("error: a folder without runs shows nothing", file=sys.stderr)
        return 2
    differences = dict(compare(before, after))
    for run, text in differences.items():
        print(f"{'expected ' if run in expected else ''}{run}: {text}")
    for run in sorted(expected - differences.keys()):
        print(f"expected to differ, but equal or unknown: {run}")
    surprises = differences.keys() - expected
    equal = len(before.keys() & after.keys()) - sum(
        run in before and run in after for run in differences
    )
    print(
        f"{equal} runs equal, {len(differences)} differ,"
        f" {len(differences) - len(surprises)} of them as expected"
    )
    return int(bool(surprises))


def compare(before: Campaign, after: Campaign) -> Iterator[tuple[str, str]]:
    """Yield the runs that differ, and how."""
    for run in [*before, *(run for run in after if run not in before)]:
        if run not in after:
            yield run, "lost"
        elif run not in before:
            yield run, "new"
        elif changes := list(changes_of(before[run], after[run])):
            yield run, "; ".join(changes)


def changes_of(before: tuple[Row, Checks], after: tuple[Row, Checks]) -> Iterator[str]:
    """Say what changed in a run."""
    (old, old_checks), (new, new_checks) = before, after
    if old[FRAMES] != new[FRAMES]:
        yield "frames"
    if old["verdict"] != new["verdict"]:
        yield f"verdict {old['verdict']} -> {new['verdict']}"
    for metric in dict.fromkeys([*old_checks, *new_checks]):
        if metric not in new_checks:
            yield f"{metric} is not checked any more"
        elif metric not in old_checks:
            yield f"{metric} is checked now"
        else:
            one, other = old_checks[metric], new_checks[metric]
            for name in OF_A_CHECK:
                if one[name] != other[name]:
                    yield f"{metric} {name} {one[name] or 'none'} -> {other[name] or 'none'}"


def read(folder: Path) -> Campaign:
    """Read the runs of a results folder; of runs that the plan no longer has none."""
    campaign: Campaign = {}
    for row in _rows(folder / "cases.csv", ("run", "verdict", FRAMES)):
        if row.get("in_plan") != "no":
            campaign[row["run"]] = (row, {})
    for row in _rows(folder / "results.csv", ("run", "metric", *OF_A_CHECK)):
        if row["run"] in campaign:
            campaign[row["run"]][1][row["metric"]] = row
    return campaign


def _rows(path: Path, columns: tuple[str, ...]) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    missing = [name for name in columns if name not in (reader.fieldnames or ())]
    if missing:
        raise KeyError(f"{path} has no column {missing[0]}")
    return rows


def expectations(path: Path) -> set[str]:
    """Read the ids of runs that may differ."""
    lines = (line.partition("#")[0].strip() for line in path.read_text("utf-8").splitlines())
    return {line for line in lines if line}


if __name__ == "__main__":
    sys.exit(main())
