"""A measurement run to a fixed stop beside what it had to show: the oracle of a finished run.

It takes the plant's truth from the trace, the criteria from the lists as written and the cycles
from the rig; of the kernel's record only which axes took part and from when to when the run lasted.
Whether the feed went on long enough is looked up in the demand that the plant followed.
"""

from functools import cached_property

import numpy as np

from axisrig.bench.judge.fixed_stop.rows import StopRows
from axisrig.bench.judge.fixed_stop.truth import AxisTruth, axis_truth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.oracles.fixed_stop import timing
from axisrig.bench.oracles.fixed_stop.contact import StopContact, penetrations
from axisrig.bench.oracles.fixed_stop.following import Flags, Followed, Signal, follow, shifted
from axisrig.bench.oracles.fixed_stop.timing import Approach, Cycles, FreeMotionError, Instant
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Times
from axisrig.kernel.time.clock import S

STEADY_ROWS = 10
"""Rows before the contact in which the feed must be steady."""
LONG_ROWS = 100
"""Rows over which its speed is taken, if it was steady for so long."""
STEADY_SHARE = 0.01
"""By how much it may change in them: the demand is known to an increment of the encoder only."""
SLOWS_SHARE = 0.98
"""Below this share of its highest speed the interpolation counts as slowing down."""
DOUBT_CYCLES_MAX = 2.0
"""A closed form that is in doubt by more cycles says nothing any more."""


class StopRun(StopRows):
    """One run of type 7 beside what it had to show."""

    # The closed form

    def approach(self, axis: str) -> Approach:
        """Return how an axis has met its stop; raises NoClosedFormError."""
        contact, truth = self.contact(axis), self.truths.get(axis)
        if contact is None or truth is None or truth.stop_path is None:
            raise NoClosedFormError(f"axis {axis} meets no stop in the run")
        if np.ptp(truth.stop_path.position_mm[contact.row : self.rows.stop]) > 0.0:
            raise NoClosedFormError("the stop moves")
        pressing = self.pressing(axis)
        if truth.kv_per_s is None or pressing is None:
            raise NoClosedFormError("the plant does not give gain, mass and stiffness")
        if not pressing.is_held:
            raise NoClosedFormError("the force limit does not overcome weight and friction")
        speed_mm_s = self._feed_mm_s(truth, contact)
        share = truth.values.number("feed_forward")
        drive_mm = (1.0 - share) * speed_mm_s / truth.kv_per_s
        course, row = truth.course, contact.row
        encoder_lag_mm = abs(float(course.demand_mm[row] - course.encoder_mm[row]))
        doubt_ns = contact.uncertainty_ns + abs(encoder_lag_mm - drive_mm) / speed_mm_s * S
        if doubt_ns > self.cycles.period_ns:
            raise NoClosedFormError(
                f"the lag had not settled before the contact: {encoder_lag_mm:.4g} mm in the drive,"
                f" {drive_mm:.4g} mm in steady motion"
            )
        running_mm = timing.running_lag_mm(
            speed_mm_s, truth.kv_per_s, share, self.cycles_of(axis).judged
        )
        return Approach(
            contact.time_ns,
            doubt_ns,
            speed_mm_s,
            running_mm,
            pressing.penetration_mm,
            self.armed_ns,
        )

    def running_lag_mm(self, axis: str, speed_mm_s: float) -> float | None:
        """Return e0 at a feed, None where the plant gives no gain."""
        truth = self.truths[axis]
        if truth.kv_per_s is None:
            return None
        share = truth.values.number("feed_forward")
        cycles = self.cycles_of(axis).judged
        return timing.running_lag_mm(speed_mm_s, truth.kv_per_s, share, cycles)

    def _feed_mm_s(self, truth: AxisTruth, contact: StopContact) -> float:
        """Return the speed of the demand into the stop; raises NoClosedFormError."""
        assert truth.stop_path is not None
        last, middle = contact.row, contact.row - STEADY_ROWS // 2
        first = contact.row - STEADY_ROWS
        if first < self.rows.start:
            raise NoClosedFormError("the contact came before the feed was steady")
        demand, times = truth.course.demand_mm * truth.stop_path.direction, truth.syncs_ns

        def between(begin: int, end: int) -> float:
            return float(demand[end] - demand[begin]) * S / float(times[end] - times[begin])

        early, late, whole = between(first, middle), between(middle, last), between(first, last)
        if whole <= 0.0 or abs(late - early) > STEADY_SHARE * whole:
            raise NoClosedFormError("the feed was not steady before the contact")
        long = between(max(last - LONG_ROWS, self.rows.start), last)
        return long if abs(long - whole) <= STEADY_SHARE * whole else whole

    def beyond(self, axis: str) -> Instant:
        """Return when the lag exceeds its limit."""
        try:
            return self._beyond(axis)
        except NoClosedFormError as reason:
            return timing.none(str(reason))

    def window(self, axis: str) -> Instant:
        """Return when the axis has stayed inside its window for the time."""
        try:
            return self._window(axis)
        except NoClosedFormError as reason:
            return timing.none(str(reason))

    def _beyond(self, axis: str) -> Instant:
        limit_mm = self.limits[axis].lag_limit_mm
        if limit_mm is None:
            raise NoClosedFormError("the lag is no criterion")
        approach = self.approach(axis)
        if limit_mm <= abs(approach.running_lag_mm):
            raise FreeMotionError(
                f"the lag limit {limit_mm:g} mm is not above the running lag"
                f" {abs(approach.running_lag_mm):.4g} mm: found in free motion"
            )
        at_ns = approach.lag_exceeded_ns(limit_mm)
        instant = self._judged(axis, approach, at_ns, "t_c + (L - e0 + delta)/v")
        row = self.followed[axis].beyond
        late_ns = instant.high_ns
        if row is not None and late_ns is not None and self.cycle_ns(row) > late_ns:
            raise NoClosedFormError("the axis rings and its lag falls to the limit again")
        return instant

    def _window(self, axis: str) -> Instant:
        limits = self.limits[axis]
        tau_ns, window_mm = limits.min_time_ns, limits.window_mm
        if window_mm is None:
            raise NoClosedFormError("the change of position is no criterion")
        approach = self.approach(axis)
        if window_mm * S / tau_ns >= approach.speed_mm_s:
            raise FreeMotionError(
                f"W/tau is not below the feed {approach.speed_mm_s:.4g} mm/s: found in free motion"
            )
        if window_mm < approach.penetration_mm:
            return self._walked_window(axis, window_mm, approach.penetration_mm)
        lasting_ns = self.cycles.up(tau_ns) * self.cycles.period_ns
        at_ns = approach.window_true_ns(window_mm, lasting_ns)
        return self._judged(axis, approach, at_ns, "t_c + tau - (W - delta)/v")

    def _walked_window(self, axis: str, window_mm: float, deep_mm: float) -> Instant:
        """Return when a window smaller than delta holds: how the axis comes to rest decides."""
        row = self.followed[axis].window
        small = f"the window {window_mm:g} mm is smaller than the penetration {deep_mm:.4g} mm"
        if row is None:
            raise NoClosedFormError(small)
        cycle_ns = self.cycle_ns(row)
        between_ns = float(self.times_ns[row]) - self.cycles.period_ns / 2.0
        return Instant(between_ns, cycle_ns, cycle_ns, f"along the motion of the plant: {small}")

    def _judged(self, axis: str, approach: Approach, at_ns: float, what: str) -> Instant:
        """Return an instant with its band, after what must hold for the closed form."""
        if self.arming_mm is None:
            raise NoClosedFormError("the arming path depends on the length of the block")
        if approach.armed_ns is None:
            raise NoClosedFormError("the arming path was not reached")
        truth, period_ns = self.truths[axis], self.cycles.period_ns
        if approach.armed_ns > at_ns:
            late = "arming path gone after the criterion came true"
            return timing.seen(approach.armed_ns, 0.0, self.cycles, late)
        pressed_mm = self._pressed_mm(truth, at_ns)
        off_mm = abs(pressed_mm - approach.penetration_mm)
        doubt_ns = approach.doubt_ns + off_mm / approach.speed_mm_s * S
        held_mm = self._friction_mm(axis)
        if doubt_ns > DOUBT_CYCLES_MAX * period_ns + held_mm / approach.speed_mm_s * S:
            raise NoClosedFormError(
                f"the axis has not come to rest by then: {pressed_mm * 1e3:.3g} um deep, at rest"
                f" {approach.penetration_mm * 1e3:.3g} um"
            )
        until_ns = min(at_ns, float(self.stop.detected_ns or at_ns))
        if not self._goes_on(truth, approach, until_ns):
            raise NoClosedFormError("the set value did not go on with the feed until then")
        return timing.seen(at_ns, doubt_ns, self.cycles, what)

    def _friction_mm(self, axis: str) -> float:
        """Return F_c/k, half of the band in which friction may hold the axis at rest."""
        pressing = self.pressing(axis)
        assert pressing is not None
        low, high = pressing.latched_mm(0.0)
        return (high - low) / 2.0

    def _pressed_mm(self, truth: AxisTruth, at_ns: float) -> float:
        assert truth.stop_path is not None
        deep = penetrations(truth.stop_path, truth.position_mm)
        return float(np.interp(at_ns, truth.times_ns, deep))

    def _goes_on(self, truth: AxisTruth, approach: Approach, until_ns: float) -> bool:
        """Whether the demand keeps its speed from the contact on, to within a cycle."""
        begin, end = self.row_at(approach.contact_ns), self.row_at(until_ns)
        demand, times = truth.course.demand_mm[begin : end + 1], truth.syncs_ns[begin : end + 1]
        if not len(demand):
            return True
        way_mm = approach.speed_mm_s * (times - times[0]) / S
        off_mm = np.abs(np.abs(demand - demand[0]) - way_mm)
        return bool(np.max(off_mm) <= approach.speed_mm_s * self.cycles.period_ns / S)

    def found(self, axis: str) -> Instant:
        """Return when the criteria of one axis have held long enough."""
        limits = self.limits[axis]
        if not limits.detects:
            return timing.none("no criterion is on: nothing can detect")
        if limits.lag_limit_mm is None:
            return self.window(axis)
        lasting = "then for the minimum time"
        by_lag = timing.after(self.beyond(axis), limits.min_time_ns, self.cycles, lasting)
        if limits.window_mm is None:
            return by_lag
        by_window = self.window(axis)
        for check, other in ((self._beyond, by_window), (self._window, by_lag)):
            try:
                check(axis)
            except FreeMotionError:
                return other  # what holds in free motion already leaves it to the other one
            except NoClosedFormError:
                pass
        return timing.later(by_lag, by_window)

    @cached_property
    def detection(self) -> tuple[str | None, Instant]:
        """Axis and instant at which the run must end: the first axis that has its criteria."""
        found = {axis: self.found(axis) for axis in self.limits}
        known = {axis: at for axis, at in found.items() if at.time_ns is not None}
        if not known:
            notes = dict.fromkeys(at.note for at in found.values())
            return None, timing.none("; ".join(notes) or "no plant gives the truth")
        first = min(known, key=lambda axis: known[axis].time_ns or 0.0)
        return first, known[first]

    # Along the plant's own motion

    @cached_property
    def followed(self) -> dict[str, Followed]:
        """The criteria of each axis walked along its motion; rows are those of the NC cycles."""
        judged, moving = self._armed_rows()
        found = {}
        for axis, limits in self.limits.items():
            truth = self.truths[axis]
            course = truth.course.read(truth.record.later_cycles)
            found[axis] = follow(course, limits, self.cycles_of(axis).judged, judged, moving)
        return found

    def _armed_rows(self) -> tuple[Flags, Flags]:
        """Return the rows whose cycle judges, and those in which the interpolation does not slow.

        The arming path was gone one cycle before. While the set value brakes or is at rest the
        window does not count.
        """
        count = len(self.path_mm)
        armed = np.zeros(count, dtype=bool)
        way_mm, rows = self.arming_mm, self.rows
        if way_mm is None:
            return armed, armed
        begin = self.row_at(self.record.start_ns or self.record.begin_ns) + 1
        ahead = shifted(self.path_mm, self._lead_cycles - 1, fill=float(self.path_mm[-1]))
        armed[begin : rows.stop] = ahead[begin : rows.stop] >= way_mm - self.resolution_mm
        step_mm = np.diff(ahead, prepend=ahead[:1])
        fastest_mm = np.maximum.accumulate(np.where(armed, step_mm, 0.0))
        moving: Flags = step_mm >= SLOWS_SHARE * fastest_mm - self.resolution_mm
        return armed, moving & armed

    @property
    def followed_ns(self) -> float | None:
        """When the first axis has its criteria along its own motion, as its cycle has it."""
        rows = [item.found for item in self.followed.values() if item.found is not None]
        return self.cycle_ns(min(rows)) if rows else None

    def cycle_ns(self, row: int) -> float:
        """Return the NC cycle that reads the actual positions of a row."""
        period_ns = self.cycles.period_ns
        sync_ns = int(self.times_ns[row]) // period_ns * period_ns
        return float(sync_ns + self.observed.facts.timing.offset_ns)

    # What the run brought

    def set_mm(self, axis: str) -> Signal:
        """Return the set values that were sent, at each row."""
        return self.truths[axis].set_mm

    def deciding_criterion(self) -> str | None:
        """Return which criterion of the detecting axis came true last; None: nothing was found."""
        axis = self.stop.detected_by
        if self.stop.detected_ns is None or axis not in self.limits:
            return None
        limits = self.limits[axis]
        if limits.lag_limit_mm is None or limits.window_mm is None:
            return "window" if limits.lag_limit_mm is None else "lag"
        beyond_ns, window_ns = self.stop.beyond_ns.get(axis, 0), self.stop.window_ns.get(axis, 0)
        lasting_ns = self.cycles.up(limits.min_time_ns) * self.cycles.period_ns
        return "lag" if beyond_ns + lasting_ns >= window_ns else "window"

    def command_excess_mm(self, truth: AxisTruth) -> float | None:
        """Return how far the demand went past the latched position; None without one."""
        latched_mm = self.record.latched_mm.get(truth.name)
        if latched_mm is None or self.stop.detected_ns is None:
            return None
        begin, end = self.row_at(self.stop.detected_ns), self.row_at(self.end_ns)
        demand_mm = truth.course.demand_mm
        ahead = float(demand_mm[begin] - demand_mm[self.rows.start])
        beyond_mm = demand_mm[begin : end + 1] - (latched_mm + truth.zero_mm)
        return float(np.max(beyond_mm if ahead >= 0.0 else -beyond_mm))

    @property
    def is_found(self) -> bool:
        """Whether the run has found a stop."""
        return self.stop.detected_ns is not None

    def main_axis(self) -> str | None:
        """Return the axis that detected, else the one that met its stop first, else the first."""
        if self.stop.detected_by:
            return self.stop.detected_by
        if self.earliest_contact is not None:
            return self.earliest_contact[0]
        return next(iter(self.limits), None)


def stop_runs(observed: Observed) -> list[StopRun]:
    """Return the runs to a fixed stop of a finished program, in order.

    A run has the truth of the axes that take part in it, slaves included, but for those that have
    no known zero, or no plant here.
    """
    return [stop_run(observed, record) for record in _records(observed)]


def stop_run(observed: Observed, record: MeasurementRun) -> StopRun:
    """Return the run to a fixed stop that a record is of; of a long series it makes this one."""
    made = observed.once(_none_made)
    number = next(n for n, each in enumerate(_records(observed), 1) if each is record)
    if number not in made:
        made[number] = _made(observed, number, record)
    return made[number]


def _records(observed: Observed) -> list[MeasurementRun]:
    return [record for record in observed.facts.runs if record.fixed_stop is not None]


def _none_made(_observed: Observed) -> dict[int, StopRun]:
    return {}


def _made(observed: Observed, number: int, record: MeasurementRun) -> StopRun:
    assert record.fixed_stop is not None
    truths = {}
    for name, axis in observed.axes.items():
        if name not in record.fixed_stop.axes:
            continue  # another run, or none, is about it
        zero = None if axis.is_outside else observed.zero_mm(name, record)
        if zero is not None:
            truths[name] = axis_truth(observed, name, zero)
    syncs = [truth.syncs_ns for truth in truths.values()] or [observed.times_ns]
    cycles = cycles_of(observed.facts.timing, np.concatenate(syncs))
    return StopRun(number, record, observed, cycles, truths)


def cycles_of(timing: Timing, times_ns: Times) -> Cycles:
    """Return the time base of a rig; times_ns: SYNC instants on the wire, of its axes."""
    ages = timing.offset_ns - times_ns % timing.period_ns
    return Cycles(
        timing.period_ns,
        (int(ages.min()), int(ages.max())) if len(ages) else (0, timing.offset_ns),
        buffer_cycles=timing.buffer_cycles,
    )
