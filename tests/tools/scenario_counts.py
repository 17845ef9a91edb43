"""Counts of a log of scenarios, as the table of docs/reliability.md has them.

`python -m tests.tools.scenario_counts LOG SEED` writes docs/reliability.csv and the rows of the
page between its marks, from what `axisrig scenarios --machine all --log LOG` has written. Machines
that the log does not have keep their rows.
"""

import csv
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from axisrig.bench.tools.scenarios.log import Entry, ScenarioLog
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Result

DOCS = Path(__file__).parents[2] / "docs"
TABLE, PAGE = DOCS / "reliability.csv", DOCS / "reliability.md"
COLUMNS = (
    "machine", "seed", "run", "good", "alarm", "no control can know", "no truth", "findings",
    "alarms most often",
)  # fmt: skip
BEGIN, END = "<!-- counts -->", "<!-- end of counts -->"
ALARMS = 3
"""How many alarms a row names."""


def rows_of(
    seed: int, entries: Iterable[Entry], kept: Mapping[str, Mapping[str, str]]
) -> list[dict[str, str]]:
    """Return a row for each machine of the scenarios of a seed, and one for their sum.

    kept: rows by machine, for those that have no entry. Which alarms the sum has most often nobody
    knows from rows.
    """
    found: dict[str, list[Entry]] = {name: [] for name in machines()}
    for scenario, judgement in entries:
        found[scenario.machine].append((scenario, judgement))
    rows = [
        _row(name, seed, some) if some or name not in kept else dict(kept[name])
        for name, some in found.items()
    ]
    sums = {column: str(sum(int(row[column]) for row in rows)) for column in COLUMNS[2:-1]}
    return [*rows, {**dict.fromkeys(COLUMNS, ""), "machine": "all", "seed": str(seed), **sums}]


def _row(name: str, seed: int, entries: list[Entry]) -> dict[str, str]:
    results = Counter(judgement.result for _, judgement in entries)
    last = Counter(j.alarms[-1] for _, j in entries if j.result is Result.ALARM)
    often = sorted(last.items(), key=lambda item: (-item[1], item[0]))[:ALARMS]
    counts = (
        len(entries),
        results[Result.GOOD],
        results[Result.ALARM],
        results[Result.UNKNOWABLE],
        results[Result.NO_TRUTH],
        sum(results[each] for each in DEFECTS),
    )
    alarms = " ".join(f"{number} ({count})" for number, count in often)
    return dict(zip(COLUMNS, map(str, (name, seed, *counts, alarms)), strict=True))


def table_of(rows: Iterable[Mapping[str, str]]) -> list[str]:
    """Return the lines of the table of the page."""
    lines = [f"| {' | '.join(COLUMNS)} |", "|" + "---|" * len(COLUMNS)]
    for row in rows:
        cells = [f"`{row['machine']}`", *(row[column] for column in COLUMNS[1:])]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def read_rows() -> list[dict[str, str]]:
    """Read docs/reliability.csv."""
    return list(csv.DictReader(TABLE.read_text("utf-8").splitlines()))


def write(seed: int, entries: Iterable[Entry]) -> None:
    """Write the table and the rows of the page."""
    rows = rows_of(seed, entries, {row["machine"]: row for row in read_rows()})
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = PAGE.read_text("utf-8")
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2]
    inside = "\n".join(["", *table_of(rows), ""])
    PAGE.write_text(f"{before}{BEGIN}\n{inside}\n{END}{after}", "utf-8")


if __name__ == "__main__":
    write(int(sys.argv[2]), ScenarioLog(Path(sys.argv[1]), int(sys.argv[2])).entries)
