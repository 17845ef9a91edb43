"""The part of a finished run that belongs to one measurement run to a fixed stop."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from axisrig.bench.judge.fixed_stop.truth import AxisTruth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.tool import kinematic_at, way_of_tool
from axisrig.bench.oracles.fixed_stop.contact import (
    ROWS_BEFORE,
    StopContact,
    first_contact,
    penetrations,
)
from axisrig.bench.oracles.fixed_stop.following import Signal
from axisrig.bench.oracles.fixed_stop.lists import arming_mm, delay_cycles, limits_as_written
from axisrig.bench.oracles.fixed_stop.pressing import Pressing
from axisrig.bench.oracles.fixed_stop.timing import Cycles
from axisrig.bench.record.measuring import FixedStop, MeasurementRun
from axisrig.bench.record.series import Times
from axisrig.kernel.time.clock import MS

BOUNCE_NS = 50 * MS
"""A contact that lets go for no longer bounces and goes on; source: docs/fixed-stop.md."""


@dataclass(frozen=True)
class Lasting:
    """The contact of an axis that lasts at the detection.

    contact: its begin, None when it was lost. first_ns: first contact of the run. at_ns: of the
    detection. lost_ns: how long the contact was lost since the first one, bounces left out.
    """

    contact: StopContact | None
    first_ns: float
    at_ns: float
    lost_ns: float

    @property
    def lost_text(self) -> str:
        """That the contact was lost in between, empty when it was not."""
        if not self.lost_ns:
            return ""
        first_ms, lost_ms = (self.at_ns - self.first_ns) / MS, self.lost_ns / MS
        return f"first contact {first_ms:.1f} ms before, lost for {lost_ms:.0f} ms"


class StopRows:
    """One run of type 7. number: of those of the program, from 1. truths: its axes with a plant."""

    def __init__(
        self,
        number: int,
        record: MeasurementRun,
        observed: Observed,
        cycles: Cycles,
        truths: Mapping[str, AxisTruth],
    ) -> None:
        assert record.fixed_stop is not None
        self.number, self.record, self.cycles, self.truths = number, record, cycles, truths
        self.stop: FixedStop = record.fixed_stop
        self.observed = observed
        self.end_ns = record.end_ns or observed.facts.end_ns
        self.watched = [axis for axis in self.stop.criteria if axis in truths]
        self.limits = {
            axis: limits_as_written(truths[axis].written, cycles.period_ns) for axis in self.watched
        }
        self._contacts: dict[str, StopContact | None] = {}

    def cycles_of(self, axis: str) -> Cycles:
        """Return the time base with the delay that the list of an axis compensates.

        Lags that are judged take its `judged`.
        """
        return replace(self.cycles, delay_cycles=delay_cycles(self.truths[axis].written))

    # Axes that turn

    @cached_property
    def rotary(self) -> list[str]:
        """Axes of the run whose positions are degrees."""
        return [axis for axis in self.truths if self.observed.is_rotary(axis)]

    def torque_arm_m(self, axis: str) -> float | None:
        """Return what makes torques of the forces at an axis; None where they are forces."""
        return self.observed.torque_arm_m(axis)

    # Rows of the trace

    @cached_property
    def times_ns(self) -> Times:
        """SYNC instants of the rows."""
        return next(iter(self.truths.values())).times_ns

    @cached_property
    def rows(self) -> slice:
        """Rows of the run."""
        times = self.times_ns
        begin = int(np.searchsorted(times, self.record.begin_ns))
        return slice(begin, max(int(np.searchsorted(times, self.end_ns, side="right")), begin))

    def row_at(self, time_ns: float) -> int:
        """Return the last row at or before an instant."""
        return max(int(np.searchsorted(self.times_ns, time_ns, side="right")) - 1, 0)

    @cached_property
    def path_mm(self) -> Signal:
        """How far the demand has gone on its path since the run began, of all measuring axes."""
        if self._tool is not None:
            return self._tool[0]
        total = np.zeros(len(self.times_ns))
        for axis in self.record.axes:
            if axis in self.truths:
                demand = self.truths[axis].course.demand_mm
                total += (demand - demand[min(self.rows.start, len(demand) - 1)]) ** 2
        way: Signal = np.sqrt(total)
        return way

    @cached_property
    def _tool(self) -> tuple[Signal, float] | None:
        """Way of the tool and length of the block; None without a kinematic or all of its axes."""
        on, target_mm = kinematic_at(self.observed, self.record.begin_ns), self.record.target_mm
        if on is None or target_mm is None:
            return None
        names = [*on.axes, *(axis for axis in target_mm if axis not in on.axes)]
        if any(axis not in self.truths for axis in names):
            return None
        truths = [self.truths[axis] for axis in names]
        axes = np.stack([truth.course.demand_mm - truth.zero_mm for truth in truths], axis=-1)
        begin = min(self.rows.start, len(self.times_ns) - 1)
        return way_of_tool(self.observed, on, axes, begin, target_mm)

    @property
    def arming_mm(self) -> float | None:
        """Path after which the criteria count; None: the length of the block is not known."""
        return arming_mm(list(self.limits.values()), self.block_mm)

    @cached_property
    def block_mm(self) -> float | None:
        """Length of the block: from where the demand stood to the target in the program."""
        if self._tool is not None:
            return self._tool[1]
        target_mm = self.record.target_mm
        if target_mm is None or any(axis not in self.truths for axis in target_mm):
            return None
        row = min(self.rows.start, len(self.times_ns) - 1)
        ways_mm = [
            place_mm + self.truths[axis].zero_mm - float(self.truths[axis].course.demand_mm[row])
            for axis, place_mm in target_mm.items()
        ]
        return math.hypot(*ways_mm)

    @property
    def resolution_mm(self) -> float:
        """To how much the path of the demand is known: an increment of the encoders."""
        return sum(1.0 / self.observed.axes[a].increments_per_mm for a in self.record.axes)

    @cached_property
    def armed_ns(self) -> float | None:
        """From when on the criteria count, None when the arming path was never gone.

        That is one cycle after the interpolation has gone it.
        """
        way_mm, path_mm = self.arming_mm, self.path_mm[self.rows]
        if way_mm is None:
            return None
        reached = np.flatnonzero(path_mm >= way_mm - self.resolution_mm)
        if not len(reached):
            return None
        times = self.times_ns[self.rows]
        row = int(reached[0])
        at_ns = float(times[row])
        if row and path_mm[row] > path_mm[row - 1]:
            share = (path_mm[row] - way_mm) / (path_mm[row] - path_mm[row - 1])
            at_ns -= float(share) * float(times[row] - times[row - 1])
        return at_ns - (self._lead_cycles - 1) * self.cycles.period_ns

    @property
    def _lead_cycles(self) -> int:
        """Cycles by which the interpolation is ahead of the demand of the drives."""
        return self.cycles.way_cycles + self.cycles.buffer_cycles

    # The contact

    def contact(self, axis: str) -> StopContact | None:
        """Return the first contact of an axis with its stop in this run."""
        if axis not in self._contacts:
            self._contacts[axis] = self._find_contact(axis, self.rows.start)
        return self._contacts[axis]

    def _find_contact(self, axis: str, begin: int) -> StopContact | None:
        """Return the first contact from a row on."""
        truth = self.truths.get(axis)
        rows = slice(begin, self.rows.stop)
        if truth is None or truth.stop_path is None or rows.stop - rows.start < 2:
            return None
        path = truth.stop_path
        inside = type(path)(path.position_mm[rows], path.velocity_mm_s[rows], path.direction)
        stiffness = truth.stop.stiffness_n_m if truth.stop is not None else None
        mass = truth.axis.mass_kg if truth.axis is not None else None
        found = first_contact(
            truth.times_ns[rows],
            truth.position_mm[rows],
            truth.velocity_mm_s[rows],
            inside,
            stiffness / mass if stiffness and mass else None,
            None if truth.peak_n is None else truth.peak_n[rows],
        )
        return None if found is None else replace(found, row=found.row + rows.start)

    def lasting(self, axis: str) -> Lasting | None:
        """Return the contact that lasts when the stop is detected; None without one before."""
        first, truth, at_ns = self.contact(axis), self.truths.get(axis), self.stop.detected_ns
        if first is None or truth is None or truth.stop_path is None or at_ns is None:
            return None
        if first.time_ns > at_ns:
            return None
        last = self.row_at(at_ns)
        touches = penetrations(truth.stop_path, truth.position_mm) >= 0.0
        if truth.peak_n is not None:
            touches |= truth.peak_n > 0.0
        touching = [first.row, *(first.row + 1 + np.flatnonzero(touches[first.row + 1 : last + 1]))]
        return_row, lost_ns = None, 0
        for before, after in pairwise(touching):
            open_ns = int(self.times_ns[after] - self.times_ns[before])
            if open_ns > BOUNCE_NS:
                return_row, lost_ns = int(after), lost_ns + open_ns
        since_ns = at_ns - float(self.times_ns[touching[-1]])
        if since_ns > BOUNCE_NS:
            return Lasting(None, first.time_ns, at_ns, lost_ns + since_ns)
        if return_row is None:
            return Lasting(first, first.time_ns, at_ns, 0.0)
        again = self._find_contact(axis, return_row - 1 - ROWS_BEFORE)
        return Lasting(again, first.time_ns, at_ns, lost_ns)

    @cached_property
    def earliest_contact(self) -> tuple[str, StopContact] | None:
        """Axis and contact that came first."""
        found = [(axis, self.contact(axis)) for axis in self.truths]
        known = [(axis, contact) for axis, contact in found if contact is not None]
        return min(known, key=lambda item: item[1].time_ns) if known else None

    def pressing(self, axis: str) -> Pressing | None:
        """Return how an axis presses with the force limit of the detection (or the end)."""
        at_ns = self.stop.detected_ns or self.end_ns
        return self.truths[axis].pressing(at_ns) if axis in self.truths else None
