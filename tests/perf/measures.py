"""The suite of measures: a table says what is measured and what is to be reached (suite.csv).

Measures take turns, so that the load of a shared machine falls on all of them; the median counts.
"""

import csv
import os
import platform
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from tests.perf.yardsticks import KINDS, Place, Sample, Yardstick

from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.perf import build
from axisrig.kernel.errors import UserError

TABLE = Path(__file__).with_name("suite.csv")
QUIET_LOAD = 0.5
"""Load of the machine that two processes at work hardly notice, in processes that want to run."""

Progress = Callable[[int, int, str], None]
"""Takes how many samples are there, how many there will be, and what is measured next."""


class Measure(NamedTuple):
    """A row of the table.

    kind: of `KINDS`. better: `more` or `less`. reach: number to be reached, compiled;
    reach_interpreted: the same interpreted, None without one. turns: the most that are worth it.
    """

    name: str
    kind: str
    plan: str
    row: str
    better: str
    reach: float
    reach_interpreted: float | None
    unit: str
    turns: int | None
    note: str

    def is_reached(self, value: float, is_compiled: bool) -> bool | None:
        """Whether a value is as good as wanted; None where nothing is wanted of this build."""
        wanted = self.reach if is_compiled else self.reach_interpreted
        if wanted is None:
            return None
        return value >= wanted if self.better == "more" else value <= wanted


def read_suite() -> tuple[Measure, ...]:
    """Return the rows of suite.csv."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return tuple(_measure(row) for row in csv.DictReader(file))


def _measure(row: dict[str, str]) -> Measure:
    """Read a row. Raises ValueError for one that is wrong: a defect."""
    if row["kind"] not in KINDS or row["better"] not in ("more", "less"):
        raise ValueError(f"{TABLE.name}: {row}")
    lesser, turns = row["reach_interpreted"], row["turns"]
    return Measure(
        row["measure"],
        row["kind"],
        row["plan"],
        row["row"],
        row["better"],
        float(row["reach"]),
        float(lesser) if lesser else None,
        row["unit"],
        int(turns) if turns else None,
        row["note"],
    )


def selected(measures: Sequence[Measure], text: str | None) -> tuple[Measure, ...]:
    """Return the measures with a text in name or kind. Raises UserError when there is none."""
    found = tuple(m for m in measures if text is None or text in m.name or text == m.kind)
    if not found:
        raise UserError("no such measure", value=text, allowed=[m.name for m in measures])
    return found


def run_suite(
    measures: Sequence[Measure],
    plans: Path,
    repeats: int,
    clocks: Clocks,
    progress: Progress,
) -> dict[str, Any]:
    """Measure in turns and return one object: `suite`, a list with an entry for each measure.

    plans: folder of the plans. repeats: samples of each measure, fewer where its row says so.
    An entry has the cells of the row, `value` (the median), `least`, `most`, `samples`,
    `is_reached` (null where this build need not) and the medians of what explains the value.
    Raises UserError when something cannot be measured.
    """
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    samples: dict[str, list[Sample]] = {measure.name: [] for measure in measures}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        order = list(_turns(measures, repeats))
        sticks: dict[str, Yardstick] = {}
        for number, measure in enumerate(order):
            progress(number, len(order), measure.name)
            make = KINDS[measure.kind]
            assert make is not None
            if measure.name not in sticks:
                place = Place(plans, Path(folder) / str(len(sticks)), clocks)
                sticks[measure.name] = make(measure.plan, measure.row, place)
            samples[measure.name].append(sticks[measure.name].sample())
        progress(len(order), len(order), "")
    which = build()
    entries = [_entry(m, samples[m.name], which["compiled"]) for m in measures]
    return {
        **which,
        "python": platform.python_version(),
        "machine": platform.machine(),
        "cores": _cores(),
        "load_1min": load,
        "has_two_idle_cores": load is not None and _cores() - load >= 2 - QUIET_LOAD,
        "repeats": repeats,
        "suite": entries,
    }


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _turns(measures: Sequence[Measure], repeats: int) -> Iterator[Measure]:
    """Yield every measure as often as it is sampled: one after the other, again and again."""
    for turn in range(repeats):
        for measure in measures:
            if KINDS[measure.kind] and turn < min(repeats, measure.turns or repeats):
                yield measure


def _entry(measure: Measure, samples: Sequence[Sample], is_compiled: bool) -> dict[str, Any]:
    """Return the entry of a measure. Raises UserError when texts of its samples differ."""
    entry: dict[str, Any] = dict(zip(("measure", *Measure._fields[1:]), measure, strict=True))
    entry["samples"] = len(samples)
    if not samples:
        return entry | {"value": None, "is_reached": None}
    for name in samples[0]:
        of_all = [sample[name] for sample in samples]
        numbers = [value for value in of_all if not isinstance(value, str)]
        if numbers:
            entry[name] = median(numbers)
            if name == "value":
                entry |= {"least": min(numbers), "most": max(numbers)}
        elif len(set(of_all)) > 1:
            raise UserError(f"{measure.name}: {name} is not the same in every run", value=of_all)
        else:
            entry[name] = of_all[0]
    entry["is_reached"] = measure.is_reached(entry["value"], is_compiled)
    return entry
