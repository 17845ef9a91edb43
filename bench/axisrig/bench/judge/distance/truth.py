"""Signals of one axis with distance control: what plant, bus and kernel say of it.

Row k of every signal belongs to the SYNC of cycle k: the state of the plant at that SYNC and what
the kernel made of it in the cycle after it.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.distance.orders import orders_of, set_by_program
from axisrig.bench.judge.distance.times import Unbroken, changes, unbroken
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.plant_values import PlantValues
from axisrig.bench.oracles.distance.acting import Acting, acting
from axisrig.bench.oracles.distance.cycles import (
    WAY_CYCLES,
    DeadCycles,
    Measured,
    measured,
    predicted,
)
from axisrig.bench.oracles.distance.lists import OF_AXIS, PER_MM, Limits, Listed
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.model import first_order_drive
from axisrig.bench.oracles.distance.smoothing import Smoothing, none, of_control
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.distance import ChannelDistanceRecord, DistanceRecord, PlcSensor
from axisrig.bench.record.series import SECOND, TARGET, Signal, Telegrams, Times
from axisrig.kernel.time.clock import S

Flags = npt.NDArray[np.bool_]

INACTIVE, ACTIVE, FREEZE, TURNING_OFF, ACTIVE_CONST_DIST, ERROR = range(6)
FOLLOWING = (ACTIVE, ACTIVE_CONST_DIST)
"""States in which the control follows its sensor."""
STATE_WORDS = ("INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "ACTIVE_CONST_DIST", "ERROR")
# At SYNC k the drive is at what was sent in cycle k - 2: docs/architecture.md
DEMAND_CYCLES = WAY_CYCLES

BEFORE = DEMAND_CYCLES + 1
"""Rows before its own that a part needs for the distance wanted in them."""


class TruthPart(NamedTuple):
    """Rows of an axis that are looked at together; see `bench.judge.observed.observed.Part`."""

    truth: "DistanceTruth"
    begin: int
    inside: slice


@dataclass(frozen=True)
class DistanceTruth:
    """One axis of a finished run, or some rows of it.

    whole: the run that rows are of, None for a whole one.
    """

    axis: str
    observed: Observed
    whole: "DistanceTruth | None" = None

    def __getitem__(self, name: str) -> Signal:
        return self.observed.column(self.axis, name)

    # Rows

    def parts(self, rows: slice | None = None, before: int = 0) -> Iterator["TruthPart"]:
        """Yield the signals of some rows of the run, or of all, as `Observed.parts`.

        Those of the plant that come from a set position need `before` of BEFORE at least.
        """
        for observed, begin, inside in self.observed.parts(rows, before):
            truth = (
                self if observed is self.observed else replace(self, observed=observed, whole=self)
            )
            yield TruthPart(truth, begin, inside)

    def gathered(
        self, signal: Callable[["DistanceTruth"], Signal], rows: slice | None = None
    ) -> Signal:
        """Return a signal in some rows of the run, or all, shape (n,); it alone is held whole."""
        parts = [signal(truth)[inside] for truth, _, inside in self.parts(rows, BEFORE)]
        return parts[0] if len(parts) == 1 else np.concatenate([np.empty(0), *parts])

    @cached_property
    def states(self) -> list[Unbroken]:
        """Unbroken times in one state."""
        return unbroken((truth.state[inside], begin) for truth, begin, inside in self.parts())

    @cached_property
    def held(self) -> list[Unbroken]:
        """Unbroken times in which feedhold or override of the axis hold the offset."""
        flags = ((truth.is_held[inside], begin) for truth, begin, inside in self.parts())
        return [time for time in unbroken(flags) if time.value]

    @property
    def was_on(self) -> bool:
        """Whether the control has ever followed."""
        return any(time.value in (ACTIVE, ACTIVE_CONST_DIST) for time in self.states)

    @cached_property
    def record(self) -> AxisRecord:
        """The axis with its drive."""
        return self.observed.axes[self.axis]

    @cached_property
    def control(self) -> DistanceRecord | ChannelDistanceRecord:
        """What the run has left of its control."""
        return self.observed.facts.distance[self.axis]

    @property
    def times_ns(self) -> Times:
        """SYNC instants of the rows."""
        return self.observed.times_ns

    @cached_property
    def gap_given_mm(self) -> Signal | None:
        """Distance as its sensor gives it, None where the axis has none in the plant."""
        return self._of_sensor("distance_mm")

    @cached_property
    def gap_true_mm(self) -> Signal | None:
        """True distance below the sensor."""
        return self._of_sensor("distance_true_mm")

    @property
    def sensor_name(self) -> str:
        """Plant that gives the distance."""
        return self.record.sensor if self.variable is None else self.variable.sensor

    def _of_sensor(self, name: str) -> Signal | None:
        sensor = self.sensor_name
        return self.observed.column(sensor, name) if self.observed.has(sensor, name) else None

    def read_mm(self, mode: str) -> Signal:
        """Return what the law of a mode reads of the sensor: it counts against the motor."""
        return self["sensor_mm"]

    @property
    def watched_mm(self) -> Signal:
        """The sensor value that has limits."""
        return self["sensor_mm"]

    def axes_allow(self, begin: int, end: int) -> Signal | None:
        """Return speed and acceleration that the axes leave the offset in rows begin .. end - 1,
        shape (n, 2), mm/s and mm/s2; None where it is one axis.
        """
        return None

    @property
    def period_ns(self) -> int:
        """Period of SYNC and cycle."""
        return self.observed.facts.timing.period_ns

    @property
    def period_s(self) -> float:
        """The same in seconds."""
        return self.period_ns / S

    @property
    def written(self) -> tuple[Mapping[str, object], tuple[str, ...]]:
        """What list and plan have written, and the names of the structure in it."""
        return self.record.written, OF_AXIS

    @cached_property
    def acting(self) -> list[Acting]:
        """What acted from which row on: list, words of the program, CNC objects."""
        if self.whole is not None:
            return self.whole.acting

        def follows_in(row: int) -> bool:
            return int(self.observed.value(self.axis, "distance_state", row)) in FOLLOWING

        orders = orders_of(self.observed, self.control)
        found = acting(*self.written, orders, self.period_ns, follows_in)
        changes = self.control.changes
        if not changes:
            return found
        rig = changes[0].controller  # what a rig has chosen of the law is in no list
        return [replace(one, listed=one.listed.choosing(rig)) for one in found]

    def acting_in(self, row: int) -> Acting:
        """Return what acts in the step of a row of the run."""
        return self.acting[bisect_right(self.acting, row, key=lambda one: one.row) - 1]

    def limits(self) -> Iterator[tuple[Limits, slice]]:
        """Yield limits with the rows of the run in which they act."""
        ends = [*(one.row for one in self.acting[1:]), len(self.observed)]
        for one, end in zip(self.acting, ends, strict=True):
            if one.row < end:
                yield one.listed.limits, slice(one.row, end)

    def wanted_mm(self, name: str) -> Signal:
        """Return SET_POS or SET_DIST as each step had it, by its column; 0 without one.

        The column is that of the end of the cycle: what the program has set in it acts in the next.
        """
        values = np.nan_to_num(self[name])
        first, ends = self.observed.rows.start, self[name]
        for row, by_plc in self.set_by_program[name].items():
            place = row - first
            if 0 <= place < len(values):
                before = ends[place - 1] if place else np.nan
                values[place] = np.nan_to_num(before if by_plc is None else by_plc)
        return values

    @cached_property
    def set_by_program(self) -> Mapping[str, Mapping[int, float | None]]:
        """Rows in which the program has given SET_POS or SET_DIST, by column, with what the PLC
        side gave in the same cycle.
        """
        if self.whole is not None:
            return self.whole.set_by_program
        return set_by_program(self.observed, self.control)

    @property
    def listed(self) -> Listed:
        """What the lists and the plan say of what nothing else changes, such as the sensor."""
        return self.acting[0].listed

    @cached_property
    def state(self) -> npt.NDArray[np.int64]:
        """State in each row."""
        return self["distance_state"].astype(np.int64)

    @cached_property
    def is_active(self) -> Flags:
        """Rows in which the control follows."""
        active: Flags = (self.state == ACTIVE) | (self.state == ACTIVE_CONST_DIST)
        return active

    @cached_property
    def is_held(self) -> Flags:
        """Rows in which feedhold or override of the axis hold the offset."""
        held: Flags = self["distance_held"] == 1
        return held

    @property
    def override(self) -> Signal:
        """Override of the axis in each row, 1 = 100 %."""
        share: Signal = self["distance_override_pct"] / 100.0
        return share

    @cached_property
    def program_mm(self) -> Signal:
        """Interpolated position that was sent in each cycle: the set position less the offset."""
        offset = self["offset_mm"]
        out = offset if self.listed.is_optimized else np.concatenate([offset[:1], offset[:-1]])
        return self["set_mm"] - out

    @property
    def has_surface(self) -> bool:
        """Whether a plant gives the distance, and with it the surface."""
        return self.observed.has(self.sensor_name, "distance_true_mm")

    @cached_property
    def surface_mm(self) -> Signal | None:
        """Height of the workpiece below the tool, of the plant's truth."""
        return None if self.gap_true_mm is None else self["truth_mm"] - self.gap_true_mm

    @cached_property
    def zeros(self) -> list[tuple[int, float]]:
        """From which row on which gap has the sensor value 0, each time that the control was on.

        By ref_offset (s = -g - ref_offset), or after REF what the plant has beside the sensor
        value.
        """
        if self.whole is not None:
            return self.whole.zeros
        if not (self.control.is_referenced and self.has_surface):
            return []
        on = [time for time in self.states if time.value in FOLLOWING]
        found = [(time.begin, self.gathered(self.beside_mm, slice(*time[:2]))) for time in on]
        return [(begin, float(np.median(values))) for begin, values in found]

    @staticmethod
    def beside_mm(some: "DistanceTruth") -> Signal:
        """Return what the sensor gives beside the sensor value of the control."""
        assert some.gap_given_mm is not None
        return some.gap_given_mm + some["sensor_mm"]

    @property
    def unreferenced_mm(self) -> float:
        """Gap at which the sensor value is 0 without REF."""
        return -self.listed.ref_offset_mm

    @property
    def zero_mm(self) -> float:
        """Gap at which the sensor value was 0 when the control was on last."""
        return self.zeros[-1][1] if self.zeros else self.unreferenced_mm

    @cached_property
    def zero_by_row_mm(self) -> Signal:
        """The same in each row; before the control was on as when it was on first."""
        first, count = self.observed.rows.start, len(self.observed)
        rows = np.full(count, self.zeros[0][1] if self.zeros else self.unreferenced_mm)
        for begin, zero_mm in self.zeros[1:]:
            rows[max(begin - first, 0) :] = zero_mm
        return rows

    @cached_property
    def wanted_gap_mm(self) -> Signal:
        """Distance that the tool should have at each SYNC."""
        late = np.concatenate([np.full(DEMAND_CYCLES, self.program_mm[0]), self.program_mm])
        by_surface = late[: len(self.program_mm)] - self["set_pos_mm"]
        wanted: Signal = np.where(self.state == ACTIVE_CONST_DIST, self["set_dist_mm"], by_surface)
        return wanted + self.zero_by_row_mm

    @cached_property
    def behind_mm(self) -> Signal | None:
        """By how much the tool is too near: wanted less true distance."""
        return None if self.gap_true_mm is None else self.wanted_gap_mm - self.gap_true_mm

    # Dead time

    @cached_property
    def values(self) -> PlantValues | None:
        """What the FMU of the axis gives beside its roles; None for a real drive."""
        plant = self.observed.plant_of(self.axis)
        return None if plant is None else PlantValues(plant)

    @cached_property
    def variable(self) -> PlcSensor | None:
        """The entry of `[plc]` that was the sensor when the control was on last; None: 60E4."""
        used = [change.sensor for change in self.control.changes if change.is_on]
        name = used[-1].removeprefix("VARIABLE ") if used else self.control.variable
        return self.observed.facts.plc_sensors.get(name)

    @property
    def increment_mm(self) -> float:
        """Resolution of the sensor value: of 60E4 by the list, of a variable 0.1 um."""
        return self.listed.mm_per_increment if self.variable is None else 1.0 / PER_MM

    @cached_property
    def sensor_age_cycles(self) -> int:
        """Cycles by which the sensor value is older than 6064, by the rig; below 0 = newer.

        A V.E. variable is of the last SYNC, also where 6064 of it comes a cycle later.
        """
        if self.variable is not None:
            newer = self.record.later_cycles
            return self.variable.delay_cycles - newer
        return self.record.second_delay_cycles

    @property
    def late_cycles(self) -> int:
        """Cycles that the carrier adds to the way of a set position until 6064 shows it."""
        return self.record.late_cycles

    @cached_property
    def dead(self) -> DeadCycles:
        """Dead cycles by the arithmetic of the rig."""
        return predicted(
            is_optimized=self.listed.is_optimized,
            sensor_age_cycles=self.sensor_age_cycles,
            every=self.every,
            late_cycles=self.late_cycles,
        )

    @cached_property
    def every(self) -> int:
        """60E4 comes with every so many SYNCs; 1 where it is sent when it changes."""
        if self.variable is not None:
            return 1
        types = [t.transmission for t in self.record.telegrams if SECOND in t.fields]
        return types[0] if types and types[0] <= 240 else 1

    def measured_dead(self, quiet_increments: int = 0) -> Measured:
        """Return dead cycles as frames show them; raises NotMeasurableError."""
        start_ns = self._control_ns
        targets = changes(self.observed.telegrams(self.axis, TARGET), start_ns)
        if self.variable is None:
            sensor = changes(self.observed.telegrams(self.axis, SECOND), start_ns)
        else:  # no frame carries it: what the control has read
            increments = np.round(np.nan_to_num(self.watched_mm) / self.increment_mm).astype(int)
            sensor = changes([Telegrams(self.times_ns, increments)], start_ns)
        return measured(targets, sensor, self.period_ns, quiet_increments)

    @property
    def _control_ns(self) -> int:
        """SYNC of the first row in which the control follows, without one of the last row."""
        on = (time.begin for time in self.states if time.value in (ACTIVE, ACTIVE_CONST_DIST))
        return self.observed.time_ns(next(on, len(self.observed) - 1))

    # The loop

    def smoothing(self, listed: Listed) -> Smoothing:
        """Return the filter of the sensor value."""
        return of_control(listed.control, self.period_ns)

    @cached_property
    def surface_gain(self) -> float:
        """By how much the distance grows for 1 mm of offset."""
        return 1.0

    @property
    def gap_gain(self) -> float:
        """By how much the true distance grows for 1 mm of the axis."""
        return 1.0

    def loop(self, mode: str, listed: Listed) -> Loop:
        """Return the loop in a mode; needs 60E4 with every SYNC.

        listed: what acts in it, as of `acting`.
        """
        control = listed.control
        lag_s = self.drive_lag_s
        return Loop(
            mode,
            self.dead.dead - self.sensor_age_cycles,
            self.smoothing(listed),
            sent_cycles=self.dead.reaction,
            skew_cycles=self.sensor_age_cycles,
            integral=control.integral(self.period_ns),
            derivative=control.rate(self.period_ns),
            of_error=control.looks_at_error,
            drive=first_order_drive(lag_s, self.period_ns) if lag_s else none(),
            sign=1 if self.counts_right else -1,
            gain=self.surface_gain,
        )

    @cached_property
    def counts_right(self) -> bool:
        """Whether the sensor value falls when the tool lifts.

        60E4 gives the gap, so P-AXIS-00230 has to invert it; on a variable that does not act.
        """
        return self.listed.sign == -1 if self.variable is None else self.variable.sign == -1

    @cached_property
    def drive_lag_s(self) -> float:
        """Lag of the drive, (1 - f)/Kv; 0 for one that follows its ramp."""
        gain = None if self.values is None else self.values.get("kv")
        if self.values is None or not gain:
            return 0.0
        return (1.0 - self.values.number("feed_forward")) / gain

    @staticmethod
    def mode_in(state: int, listed: Listed) -> str:
        """Return the mode of the loop in a state. listed: what acts in it."""
        if state != ACTIVE_CONST_DIST:
            return SET_POS
        return BOTH if listed.uses_both else CONST_DIST
