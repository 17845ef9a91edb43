"""A run once as it is, and once more with the plant looked at every 10 us: what is true between.

The fine run has the same frames. Its series has a row each 10 us while an axis moves, besides those
of the SYNCs: what the plant gives is of that instant, what kernel and drives give that of the SYNC
before.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.plan.case import Case
from axisrig.bench.record.series import SYNC_AFTER
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import US, Phase

STEP_NS = 10 * US
RESTING_M_S = 1e-7
"""Below this speed an axis rests until the next SYNC; in 1 ms it goes a tenth of a nanometre."""
AHEAD_M = 1e-9
"""So far from its demand at least it does not rest."""


@dataclass(frozen=True)
class Both:
    """The same run: as it is, and with fine rows."""

    shipped: Observed
    fine: Observed


class Watch:
    """Looks at the plant of a machine each 10 us of its clock, and at the ticks of the drives."""

    def __init__(self, machine: Machine) -> None:
        self.machine, self.plant = machine, machine.plant
        self.rows: dict[str, list[Any]] = {"time_ns": []}
        self._period_ns = machine.timing.period_ns
        for name, axis in machine.settings.rig.axis.items():
            if axis.plant in self.plant.axes:
                self.rows[name] = []
        for name in self.plant.distances:
            self.rows[name] = []
        self._again()

    def _again(self) -> None:
        clock = self.machine.scheduler
        moves = any(
            abs(axis.motion[1]) > RESTING_M_S or abs(axis.motion[4] - axis.motion[2]) > AHEAD_M
            for axis in self.plant.axes.values()
        )
        step_ns = STEP_NS if moves or self.plant.distances else self._period_ns // 4
        clock.call_at(clock.now_ns // step_ns * step_ns + step_ns, Phase.APPLICATION, self._look)

    def _look(self) -> None:
        now_ns = self.machine.scheduler.now_ns
        self.plant.advance_to(now_ns)
        if self.plant.now_ns == now_ns:
            self.rows["time_ns"].append(now_ns)
            for name, axis in self.machine.settings.rig.axis.items():
                if name in self.rows:
                    self.rows[name].append(list(self.plant.axes[axis.plant].motion))
            for name, sensor in self.plant.distances.items():
                self.rows[name].append((sensor.distance_m, sensor.distance_true_m))
        self._again()


def run_both(case: Case, period_us: int | None = None) -> Both | None:
    """Run a case twice, with another cycle where one is given.

    None where the rig cannot have that cycle, or the finer steps change a frame.
    """
    try:
        settings = with_period(settings_of(case), period_us)
        shipped, fine = (_run(case, settings, is_fine=is_fine) for is_fine in (False, True))
    except (UserError, SimulatedTimeoutError):
        if period_us is None:
            raise
        return None  # the rig is not made for that cycle
    # Shorter steps may move a rounded position by an increment: then it is another motion
    is_same = fine.facts.frame_log_sha256 == shipped.facts.frame_log_sha256
    return Both(shipped, fine) if is_same else None


def with_period(settings: Settings, period_us: int | None) -> Settings:
    """Return a rig with another cycle; its NC cycle is as long after the SYNC as before."""
    if period_us is None:
        return settings
    cycle = settings.rig.cycle.model_copy(update={"period_us": period_us})
    return replace(settings, rig=settings.rig.model_copy(update={"cycle": cycle}))


def _run(case: Case, settings: Settings, *, is_fine: bool) -> Observed:
    program = read_program(case.program, tuple(settings.rig.axis))
    machine = Machine(settings, program, seed=case.seed)
    try:
        watch = Watch(machine) if is_fine else None
        facts = facts_of(machine, machine.run())
        series = machine.recorder.series()
        if watch is not None:
            ticks_ns = {name: drive.tick_ns for name, drive in machine.drives.items()}
            series = replace(series, source=fine_table(series.table(), watch.rows, ticks_ns))
        return Observed(facts, series)
    finally:
        machine.close()


def fine_table(table: pa.Table, rows: Mapping[str, list[Any]], ticks_ns: Mapping[str, int]) -> Any:
    """Put what was seen between the SYNCs into the rows of these."""
    syncs = table.column("time_ns").to_numpy()
    seen = np.array(rows["time_ns"], dtype=np.int64)
    seen_kept = (seen > syncs[0]) & (seen < syncs[-1]) & ~np.isin(seen, syncs)
    times = np.sort(np.concatenate([syncs, seen[seen_kept]]))
    before = np.searchsorted(syncs, times, side="right") - 1
    is_sync = syncs[before] == times
    found = np.searchsorted(seen, times)
    found = np.minimum(found, len(seen) - 1)
    columns: dict[str, Any] = {"time_ns": times}
    values = dict(_columns(rows, ticks_ns))
    peaks = dict(_peaks(rows, ticks_ns, seen, syncs))
    for name in table.column_names[1:]:
        held = table.column(name).to_numpy()[before]
        if name in peaks:
            # At the SYNC itself the row has the lag of that instant
            at_sync = np.abs(table.column(name.replace("_peak", "")).to_numpy())
            held = np.where(is_sync, np.maximum(peaks[name], at_sync)[before], 0.0)
        elif name.endswith(f".{SYNC_AFTER}"):
            held = np.where(is_sync, held, 0)
        elif name in values:
            held = np.where(is_sync, held, values[name][found])
        columns[name] = held
    return pa.table(columns)


def _peaks(
    rows: Mapping[str, list[Any]], ticks_ns: Mapping[str, int], seen: Any, syncs: Any
) -> Iterator[tuple[str, Any]]:
    """Yield the largest lag of each drive at its ticks between two SYNCs; they count from one."""
    for name, tick_ns in ticks_ns.items():
        values = np.array(rows[name], dtype=np.float64)
        lag_mm = (values[:, 4] - values[:, 2]) * 1e3
        found = np.zeros(len(syncs))
        for row, (begin_ns, end_ns) in enumerate(pairwise(syncs.tolist()), start=1):
            at_ns = np.arange(begin_ns + tick_ns, end_ns, tick_ns)
            # Before a tick, which may change the demand, it goes on as in the 10 us before
            last = np.searchsorted(seen, at_ns) - 1
            share = (at_ns - seen[last]) / (seen[last] - seen[last - 1])
            before_mm = lag_mm[last] + share * (lag_mm[last] - lag_mm[last - 1])
            found[row] = np.max(np.abs(before_mm), initial=0.0)
        yield f"{name}.drive_lag_peak_mm", found
        yield f"{name}.drive_lag_peak_deg", found


def _columns(
    rows: Mapping[str, list[Any]], ticks_ns: Mapping[str, int]
) -> Iterator[tuple[str, Any]]:
    for name, motions in rows.items():
        if name == "time_ns":
            continue
        values = np.array(motions, dtype=np.float64)
        if name not in ticks_ns:
            yield f"{name}.distance_mm", values[:, 0] * 1e3
            yield f"{name}.distance_true_mm", values[:, 1] * 1e3
            continue
        lag_mm = (values[:, 4] - values[:, 2]) * 1e3
        for unit in ("mm", "deg"):
            yield f"{name}.truth_{unit}", values[:, 0] * 1e3
            yield f"{name}.velocity_{unit}_s", values[:, 1] * 1e3
            yield f"{name}.drive_lag_{unit}", lag_mm
            yield f"{name}.stop_{unit}", values[:, 7] * 1e3
        yield f"{name}.force_n", values[:, 5]
        yield f"{name}.stop_force_n", values[:, 6]
        yield f"{name}.stop_force_peak_n", _summits(values[:, 6])


def _summits(force_n: Any) -> Any:
    """Return the summit of the parabola around each instant, which misses 0.064 h^3 f'''."""
    found = force_n.copy()
    before, at, after = force_n[:-2], force_n[1:-1], force_n[2:]
    bend = before - 2.0 * at + after
    is_summit = (at >= before) & (at > after) & (before > 0.0) & (after > 0.0)
    shift = np.where(is_summit, (after - before) ** 2 / np.where(is_summit, -8.0 * bend, 1.0), 0.0)
    found[1:-1] += shift
    return found
