"""Every metric of the plant that has a unit, against what it is when the plant is looked at finely.

`python tests/study/fine_study.py FIRST COUNT` runs rows and prints every value that is farther from
its fine one than its uncertainty says; `test_fine_study.py` holds what has to be true of them.

A row: one of a dozen shipped plans by its number, a row of it and a cycle by a seed.
"""

import csv
import random
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from fine_runs import Both, run_both

from axisrig.bench.judge.fixed_stop.run import stop_run
from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.motion import state_at
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import Metric, known_metrics, parse_check
from axisrig.bench.plan.plan import read_plan

ROOT = Path(__file__).parents[2]
PLANS = (
    *("latch_limits", "measuring_types", "probe_reality", "probe_stroke", "slope", "plc_sources"),
    *("fixed_stop_timing", "fixed_stop_rotary", "fixed_stop_gantry", "distance_control"),
    *("override", "kinematics"),
)
PERIODS_US = (None, None, 2000, 4000, 8000)
"""Cycles: that of the rig, or another one."""
LONGEST_S = 2.2
"""Simulated time of a row at most, as `tests/plans/simulated.csv` has it."""
ROUNDING = 1e-8
"""Of a value: sums of numbers, and the nanosecond of an instant."""


@dataclass(frozen=True)
class Compared:
    """A metric of a row. apart: of the fine value from it. uncertainty: as it says."""

    metric: str
    value: float
    uncertainty: float
    apart: float

    @property
    def share(self) -> float:
        """How many times its uncertainty the value is off; 0 for rounding."""
        apart = abs(self.apart) - ROUNDING * max(1.0, abs(self.value))
        if apart <= 0.0:
            return 0.0
        return apart / self.uncertainty if self.uncertainty else float("inf")


def metrics_of_the_plant() -> list[Metric]:
    """Return metrics that need the plant and have a unit; those of rotary axes are the same."""
    return [
        metric
        for metric in known_metrics().values()
        if metric.needs == "plant" and metric.unit and metric.type == "number"
    ]


@cache
def fine_values() -> Mapping[str, Mapping[str, str]]:
    """Read `fine_values.csv` by metric."""
    text = (Path(__file__).parent / "fine_values.csv").read_text(encoding="utf-8")
    return {row["metric"]: row for row in csv.DictReader(text.splitlines())}


@cache
def _rows(plan: str) -> tuple[Case, ...]:
    with (ROOT / "tests" / "plans" / "simulated.csv").open(encoding="utf-8") as file:
        sim_s = {row["run"]: float(row["sim_s"]) for row in csv.DictReader(file)}
    cases = read_plan(ROOT / "testplans" / f"{plan}.csv").cases
    # What ends sooner than that never gets to its motion
    return tuple(case for case in cases if 0.06 < sim_s.get(case.run, LONGEST_S) <= LONGEST_S)


def row(seed: int) -> tuple[Case, int | None]:
    """Return the case of a seed, and its cycle in us, None for that of its rig."""
    rows = _rows(PLANS[seed % len(PLANS)])
    chosen = random.Random(seed)
    return chosen.choice(rows), chosen.choice(PERIODS_US)


def compared(both: Both) -> Iterator[Compared]:
    """Yield each metric that has a value, and a fine one."""
    axis = _axis_of_stop(both.shipped)
    for metric in metrics_of_the_plant():
        how = fine_values()[metric.linear or metric.name]["fine"]
        name = f"{metric.name}:{axis}" if axis and metric.scope == "axis" else metric.name
        seen = observe(both.shipped, parse_check(name, "> 0", ""))
        if not how or not isinstance(seen.value, int | float):
            continue
        fine = _fine(both, name, how, seen, axis)
        if fine is not None:
            value = float(seen.value)
            yield Compared(metric.name, value, seen.uncertainty, fine - value)


def _axis_of_stop(observed: Observed) -> str | None:
    """Return the axis of a run to a fixed stop: finer rows may find another one touch first."""
    run = observed.last_run(None)
    return None if run is None or run.fixed_stop is None else stop_run(observed, run).main_axis()


def _fine(both: Both, name: str, how: str, seen: Observation, of_stop: str | None) -> float | None:
    if how in ("contact", "latch"):
        return _at_contact(both, seen, how, of_stop)
    if how == "deflection":
        return _deflection_mm(both.fine)
    found = touch(both.fine, None)
    if how == "stamp" and (found is None or "PLC_TIMESTAMP" not in found.run.sources.values()):
        return None
    value = observe(both.fine, parse_check(name, "> 0", "")).value
    return float(value) if isinstance(value, int | float) else None


def _at_contact(both: Both, seen: Observation, how: str, of_stop: str | None) -> float | None:
    """Return where the axis was at the contact by the fine rows, or what the latch was off."""
    found, known = touch(both.fine, of_stop), touch(both.shipped, of_stop)
    if found is None or found.contact is None or known is None:
        return None
    # Of a gantry both axes move as far: finer rows may name the other one
    axis = of_stop or both.shipped.moved_axis(known.run)
    state = state_at(both.fine, axis, found.contact.time_ns)
    if state is None:
        return None
    if how == "contact":
        return state.position_mm
    zero_mm = both.fine.zero_mm(axis, found.run) or 0.0
    return (found.run.latched_mm[axis] + zero_mm - state.position_mm) * 1e3


def _deflection_mm(fine: Observed) -> float | None:
    """Return how far an axis went past the largest deflection's contact, for probes of one axis."""
    probes = [probe for probe in fine.facts.probes.values() if probe.deflections]
    if len(probes) != 1 or len(probes[0].contacts) != 1:
        return None
    contact = probes[0].contacts[0]
    axes = [name for name, axis in fine.axes.items() if axis.plant in contact.position_mm]
    if len(axes) != 1 or len(contact.position_mm) != 1:
        return None
    there = state_at(fine, axes[0], contact.time_ns)
    if there is None or not there.speed_mm_s:
        return None
    rows = slice(fine.index_at(contact.time_ns) + 1, None)
    ways_mm = fine.column(axes[0], "truth_mm", rows) - contact.position_mm[fine.axes[axes[0]].plant]
    return float(np.max(ways_mm * np.sign(there.speed_mm_s), initial=0.0))


def main(first: int, count: int) -> None:
    """Run rows and print what is beyond its uncertainty, and how many were within."""
    shares: list[float] = []
    for seed in range(first, first + count):
        case, period_us = row(seed)
        both = run_both(case, period_us)
        words = f"{seed} {case.run} {period_us or ''}"
        if both is None:
            print(words, "the finer steps change a frame, or the rig has no such cycle", flush=True)
            continue
        found = list(compared(both))
        shares += [each.share for each in found]
        beyond = [each for each in found if each.share > 1.0]
        print(words, len(found), *beyond, sep="\n  " if beyond else " ", flush=True)
    inside = sum(share <= 1.0 for share in shares)
    print(
        f"{inside} of {len(shares)} within, {sum(share > 3.0 for share in shares)} beyond 3 times"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
