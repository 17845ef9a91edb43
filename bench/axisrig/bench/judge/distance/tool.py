"""Signals of 3D distance control: the same as of an axis, along the normal of the surface.

Positions are those of the tool clamping point along the normal, by chains of 4x4 matrices at the
positions of all axes; the sensor value counts the other way round, as the law of an axis wants it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from axisrig.bench.judge.distance.truth import (
    ACTIVE,
    ACTIVE_CONST_DIST,
    DEMAND_CYCLES,
    INACTIVE,
    DistanceTruth,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.plant_values import PlantValues
from axisrig.bench.judge.observed.tool import chain_of
from axisrig.bench.oracles.distance.cycles import (
    QUIET_CYCLES,
    Measured,
    NotMeasurableError,
    Sent,
    measured,
)
from axisrig.bench.oracles.distance.lists import (
    CHANNEL,
    OF_CHANNEL,
    axis_limits,
)
from axisrig.bench.oracles.distance.loop import SET_POS
from axisrig.bench.oracles.distance.tool import ACS, ToolWay
from axisrig.bench.oracles.kinematics.chain import Array, Chain
from axisrig.bench.record.distance import ChannelDistanceRecord
from axisrig.bench.record.kinematics import GuideChange
from axisrig.bench.record.series import Signal
from axisrig.kernel.time.clock import TimeNs

ALONG_NORMAL = ("actual_mm", "set_mm", "truth_mm")
"""Columns of the axes that are one position along the normal here."""
# A rate below it is rounding
_STILL = 1e-7
# Changes up to these count as none: of the sensor in 0.1 um, of what is superposed in mm
_QUIET, _QUIET_MM = 20, 1e-3
_MOVES_MM = 1e-4


@dataclass(frozen=True)
class Choice:
    """A kinematic that was on: rows begin .. end - 1, its chain and how many axes it has."""

    begin: int
    end: int
    chain: Chain
    count: int


def axes_of(observed: Observed, column: str, rows: slice | None = None) -> Array:
    """Return a column of every axis of the channel, shape (n, axes), mm and degrees."""
    found = [observed.column(name, column, rows) for name in observed.axes]
    return np.stack(found, axis=1)


def choices(observed: Observed) -> list[Choice]:
    """Return the times in which a kinematic was on, rows counted from the begin of the run."""
    found = []
    for on in observed.facts.kinematics:
        begin = first_row(observed, on.begin_ns)
        end = len(observed) if on.end_ns is None else first_row(observed, on.end_ns)
        if begin < end:
            found.append(Choice(begin, end, chain_of(observed, on), len(on.axes)))
    return found


def first_row(observed: Observed, time_ns: TimeNs) -> int:
    """Return the first row of a run at or after an instant."""
    row = observed.index_at(time_ns)
    return row if observed.time_ns(row) >= time_ns else row + 1


@dataclass(frozen=True)
class ToolTruth(DistanceTruth):
    """3D distance control of a finished run, or some rows of it."""

    def __getitem__(self, name: str) -> Signal:
        if name in ALONG_NORMAL:
            return self._along(lambda way, axes: way.height_mm(axes), self.columns(name))
        found = self.observed.column(CHANNEL, name)
        if name == "sensor_mm":
            return -found
        return found + self.shorter_mm if name == "distance_cnc_mm" else found

    # Where the offset acts

    @cached_property
    def ways(self) -> list[tuple[TimeNs, ToolWay]]:
        """Where the offset acted from a SYNC on."""
        if isinstance(self.whole, ToolTruth):
            return self.whole.ways
        guides = self.control.guides
        return [(guide.time_ns, self._way(guide)) for guide in guides if guide.mode]

    def _way(self, guide: GuideChange) -> ToolWay:
        if guide.mode == ACS:
            return ToolWay(ACS, list(self.observed.axes).index(guide.axis))
        # The program may choose both in one cycle
        period_ns = self.period_ns
        acting = [
            on
            for on in self.observed.facts.kinematics
            if on.begin_ns // period_ns * period_ns <= guide.time_ns
        ]
        on = acting[-1]
        until_ns = None if on.end_ns is None else on.end_ns // period_ns * period_ns
        chain = chain_of(self.observed, on)
        return ToolWay(guide.mode, 0, chain, len(on.axes), guide.normal, guide.origin_mm, until_ns)

    def way_at(self, time_ns: TimeNs) -> ToolWay | None:
        """Return where the offset acts at a SYNC, the first one before any was chosen."""
        found = self.ways[0][1] if self.ways else None
        for since_ns, way in self.ways:
            if since_ns <= time_ns:
                found = way
        return found

    def _along(
        self, value: Callable[[ToolWay, Array], Array], axes: Array, otherwise: float = 0.0
    ) -> Signal:
        """Return a value of the way in force in each row, shape (n,)."""
        found = np.full(len(axes), otherwise)
        for way, rows in self.way_rows():
            found[rows] = value(way, axes[rows])
        return found

    def way_rows(self, rows: slice | None = None) -> list[tuple[ToolWay, slice]]:
        """Return in which of some rows each way is in force, counted from the first of them."""
        times = self.times_ns if rows is None else self.times_ns[rows]
        edges = [int(np.searchsorted(times, since)) for since, _ in self.ways]
        found = []
        for place, (_, way) in enumerate(self.ways):
            begin = edges[place] if place else 0
            end = edges[place + 1] if place + 1 < len(edges) else len(times)
            if begin < end:
                found.append((way, slice(begin, end)))
        return found

    def columns(self, name: str) -> Array:
        """Return a column of all axes, shape (n, axes)."""
        return axes_of(self.observed, name)

    @cached_property
    def base(self) -> Array:
        """Positions of the program: sent less what is superposed, shape (n, axes)."""
        return self.columns("set_mm") - self.columns("superposed_mm")

    # Signals

    @cached_property
    def share(self) -> Signal:
        """Distance of the clamping point of a tool on the surface over SET_DIST, actual axes."""
        return self._along(lambda way, axes: way.share(axes), self.columns("actual_mm"), 1.0)

    @cached_property
    def shorter_mm(self) -> Signal:
        """By how much the distance of an inclined tool is less than SET_DIST without an error."""
        shorter: Signal = np.nan_to_num(self["set_dist_mm"]) * (1.0 - self.share)
        return np.where(self.state == ACTIVE, 0.0, shorter)

    def read_mm(self, mode: str) -> Signal:
        """Return -h; for a constant distance with what an inclined tool is nearer."""
        sensor = self["sensor_mm"]
        return sensor if mode == SET_POS else sensor - self.shorter_mm

    @property
    def watched_mm(self) -> Signal:
        """The sensor value as the PLC gives it."""
        return self.observed.column(CHANNEL, "sensor_mm")

    @cached_property
    def program_mm(self) -> Signal:
        """Clamping point of the program along the normal."""
        return self._along(lambda way, axes: way.height_mm(axes), self.base)

    @cached_property
    def wanted_gap_mm(self) -> Signal:
        """Distance that the clamping point should have at each SYNC."""
        late = np.concatenate([np.full(DEMAND_CYCLES, self.program_mm[0]), self.program_mm])
        by_surface = late[: len(self.program_mm)] - self["set_pos_mm"] + self.zero_by_row_mm
        share = self._along(lambda way, axes: way.share(axes), self.columns("truth_mm"), 1.0)
        constant = self["set_dist_mm"] * share + self.zero_by_row_mm
        return np.where(self.state == ACTIVE_CONST_DIST, constant, by_surface)

    @staticmethod
    def beside_mm(some: DistanceTruth) -> Signal:
        """Return what the plant has beside the value that the PLC gives."""
        assert some.gap_true_mm is not None
        return some.gap_true_mm - some.watched_mm

    @property
    def unreferenced_mm(self) -> float:
        """Distance at which the sensor value is 0 without REF."""
        return self.listed.ref_offset_mm

    # The control

    @cached_property
    def control(self) -> ChannelDistanceRecord:
        """What the run has left of it."""
        found = self.observed.facts.distance_3d
        assert found is not None
        return found

    @property
    def written(self) -> tuple[Mapping[str, object], tuple[str, ...]]:
        """What the list of the channel has written, and the name of the structure in it."""
        return self.observed.facts.channel, OF_CHANNEL

    @property
    def sensor_name(self) -> str:
        """Plant whose distance the PLC gives."""
        return "" if self.variable is None else self.variable.sensor

    @property
    def sensor_age_cycles(self) -> int:
        """Cycles by which the value of the PLC is older than 6064 of the axes; below 0 = newer."""
        fresh = max((axis.fresh_late_cycles for axis in self.observed.axes.values()), default=0)
        age = 0 if self.variable is None else self.variable.delay_cycles
        return age - (self.late_cycles - fresh)

    @property
    def late_cycles(self) -> int:
        """Cycles that the carriers add, that of the latest axis."""
        return max((axis.late_cycles for axis in self.observed.axes.values()), default=0)

    @property
    def every(self) -> int:
        """A V.E. variable is there in every cycle."""
        return 1

    @property
    def counts_right(self) -> bool:
        """Whether the value grows when the tool lifts."""
        return self.variable is None or self.variable.sign == 1

    @property
    def values(self) -> PlantValues | None:
        """The FMU of the first axis whose drive has loops, of any axis without one."""
        plants = [plant for plant in self.observed.facts.plants.values() if plant.values]
        with_loops = [plant for plant in plants if PlantValues(plant).get("kv")]
        found = next(iter([*with_loops, *plants]), None)
        return None if found is None else PlantValues(found)

    def measured_dead(self, quiet_increments: int = 0) -> Measured:
        """Return dead cycles as the trace shows them: a V.E. variable is in no frame."""
        if not self.was_on:
            raise NotMeasurableError("distance control was never on")
        begin = next(t.begin for t in self.states if t.value in (ACTIVE, ACTIVE_CONST_DIST))
        rows = slice(begin, None)
        watched_mm = np.nan_to_num(self.gathered(lambda part: part.watched_mm, rows))
        sensor = np.round(watched_mm * 1e4).astype(int)
        shifts = self.columns("superposed_mm")[rows]
        first = _first_step(sensor, shifts)
        moved = np.max(np.abs(shifts - shifts[first - 1]), axis=1) > _QUIET_MM
        times, late_ns = self.times_ns[rows], self.observed.facts.timing.offset_ns
        from_row = slice(first - QUIET_CYCLES, None)
        values = zip(times[from_row].tolist(), sensor[from_row].tolist(), strict=True)
        sent = zip(times[from_row].tolist(), moved[from_row].tolist(), strict=True)
        return measured(
            [Sent(int(t) + late_ns, int(v)) for t, v in sent],
            [Sent(int(t), int(v)) for t, v in values],
            self.period_ns,
            max(quiet_increments, _QUIET),
        )

    @cached_property
    def surface_gain(self) -> float:
        """By how much what the control sees grows for 1 mm of offset, in its last cycle on.

        Of the workpiece as a whole: `seen_gain` with its normal.
        """
        if isinstance(self.whole, ToolTruth):
            return self.whole.surface_gain
        sensor, on = self.variable, np.flatnonzero(self.is_active)
        if sensor is None or sensor.normal is None or not len(on):
            return 1.0
        row = int(on[-1])
        way = self.way_at(self.observed.time_ns(row))
        if way is not None and way.mode == ACS:
            on_now = [c for c in choices(self.observed) if c.begin <= row < c.end]
            way = replace(way, chain=on_now[-1].chain, count=on_now[-1].count) if on_now else None
        if way is None or way.chain is None:
            return 1.0
        axes = self.columns("truth_mm")[row : row + 1]
        return way.gain(
            axes,
            sensor.normal,
            along_tool=sensor.is_along,
            is_normalised=sensor.is_along and sensor.is_normalised,
        )

    @cached_property
    def gap_gain(self) -> float:
        """By how much the true distance grows for 1 mm along the normal, as the plant shows it."""
        if isinstance(self.whole, ToolTruth):
            return self.whole.gap_gain
        found = [np.empty(0)]
        for part, _, _ in self.parts(before=1):
            if part.gap_true_mm is None:
                return self.surface_gain
            rises, gaps = np.diff(part["truth_mm"]), np.diff(part.gap_true_mm)
            moves = (np.abs(rises) > _MOVES_MM) & part.is_active[1:]
            found.append(gaps[moves] / rises[moves])
        ratios = np.concatenate(found)
        return float(np.median(ratios)) if len(ratios) else self.surface_gain

    def axes_allow(self, begin: int, end: int) -> Signal | None:
        """Return speed and acceleration that the axes leave the offset: theirs over their rates.

        The rates are those of the pose of the cycle before.
        """
        before = slice(max(begin - 1, 0), max(end - 1, 1))
        set_mm = axes_of(self.observed, "set_mm", before)
        poses = set_mm - axes_of(self.observed, "superposed_mm", before)
        if begin == 0:
            poses = np.concatenate([poses[:1], poses])
        poses = poses[: end - begin]
        way = self.way_at(self.observed.time_ns(begin))
        if way is None or way.mode == ACS:
            return None
        unique, place = np.unique(poses, axis=0, return_inverse=True)
        rates = np.abs(way.rates(unique))
        rates[rates < _STILL] = np.nan
        limits = np.array([axis_limits(dict(r.written)) for r in self.observed.axes.values()])
        allow = [np.nanmin(limits[:, k] / rates, axis=1, initial=np.inf) for k in (0, 1)]
        return np.stack(allow, axis=1)[place.reshape(-1)]


def _first_step(sensor: "np.ndarray[Any, Any]", shifts: Array) -> int:
    """Return the first row whose sensor value steps after all was quiet for QUIET_CYCLES.

    sensor: in 0.1 um, shape (n,). shifts: superposed on each axis, shape (n, axes).
    """
    steps = np.flatnonzero(np.abs(np.diff(sensor, prepend=sensor[:1])) > _QUIET)
    for row in steps[steps >= QUIET_CYCLES].tolist():
        before = slice(row - QUIET_CYCLES, row)
        is_quiet = np.ptp(sensor[before]) <= _QUIET
        if is_quiet and np.max(np.ptp(shifts[before], axis=0)) <= _QUIET_MM:
            return int(row)
    raise NotMeasurableError("the sensor value never stepped while the offset was constant")


def _truths(observed: Observed) -> dict[str, DistanceTruth]:
    axes = [name for name in observed.axes if observed.has(name, "offset_mm")]
    found: dict[str, DistanceTruth] = {name: DistanceTruth(name, observed) for name in axes}
    if observed.facts.distance_3d is not None and observed.has(CHANNEL, "offset_mm"):
        found[CHANNEL] = ToolTruth(CHANNEL, observed)
    return found


def distance_truth(observed: Observed, axis: str | None) -> DistanceTruth | None:
    """Return the signals of an axis with distance control.

    Without a name those of 3D control where it was on, else of the first axis that has one.
    """
    truths = observed.once(_truths)
    if axis is not None:
        return truths.get(axis)
    of_channel = truths.get(CHANNEL)
    if of_channel is not None and any(t.value != INACTIVE for t in of_channel.states):
        return of_channel
    return next(iter(truths.values()), None)


def distance_truths(observed: Observed) -> list[DistanceTruth]:
    """Return the signals of each control that was ever on, that of the channel last."""
    truths = observed.once(_truths).values()
    return [truth for truth in truths if any(time.value != INACTIVE for time in truth.states)]
