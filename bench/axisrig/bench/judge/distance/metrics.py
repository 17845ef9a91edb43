"""The metrics of distance control.

They compare with the plant's truth, with frames of the bus and with `oracles/distance`.
Without a named axis they are about the only one, or the first, that has distance control.
"""

import math
from collections.abc import Callable

import numpy as np

from axisrig.bench.judge.distance import expected_offset, filtering, passes, stretches
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import (
    FREEZE,
    NO_PLANT,
    STATE_WORDS,
    TURNING_OFF,
    DistanceTruth,
    behind_mm,
    surface_mm,
)
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.oracles.distance import following, limits
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.distance.loop import Loop, growth
from axisrig.bench.oracles.distance.stability import KP_MAX, kp_limit
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal
from axisrig.kernel.errors import same_cause

DISTANCE_METRICS: dict[str, MetricFunction] = {}
UM = 1e3
SETTLED_MM, SETTLED_SHARE = 0.005, 0.01


def _of_axis(
    function: Callable[[DistanceTruth], Observation],
) -> Callable[[DistanceTruth], Observation]:
    """Register a metric of one axis under the name of its function."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        truth = distance_truth(observed, axis)
        if truth is None:
            whose = f"axis {axis} has" if axis else "no axis has"
            return Observation(None, note=f"{whose} no distance control" if axis else f"{whose} it")
        try:
            return function(truth)
        except (NoClosedFormError, NotMeasurableError) as reason:
            return Observation(None, note=str(reason))

    DISTANCE_METRICS[function.__name__] = metric
    return function


def _increment_um(truth: DistanceTruth) -> float:
    return truth.listed.mm_per_increment * UM


def _loop(truth: DistanceTruth, mode: str) -> Loop:
    if truth.every > 1:
        raise NoClosedFormError("60E4 does not come with every SYNC")
    return truth.loop(mode)


# Dead time


@_of_axis
def distance_dead_cycles(truth: DistanceTruth) -> Observation:
    """Cycles by which the loop is dead, from the frames around the first answer to a step."""
    found = truth.measured_dead()
    note = f"reaction {found.cycles.reaction}, way {found.cycles.way} cycles"
    return Observation(found.cycles.dead, note=note)


@_of_axis
def distance_dead_cycles_expected(truth: DistanceTruth) -> Observation:
    """The same by the arithmetic of the rig."""
    dead = truth.dead
    return Observation(dead.dead, note=f"reaction {dead.reaction}, way {dead.way} cycles")


@_of_axis
def distance_dead_time_ms(truth: DistanceTruth) -> Observation:
    """From the sensor value that changed to the one that shows the answer, ends of frames."""
    found = truth.measured_dead()
    assert found.seen_ns is not None
    return Observation((found.shown_ns - found.seen_ns) / 1e6, note="ends of frames on the bus")


# Stability


def _known_loop(truth: DistanceTruth) -> Loop:
    """Return the loop of the last stretch; raises NoClosedFormError where its poles are unknown."""
    mode = stretches.last_active(truth).mode
    reason = truth.unknown_poles(mode)
    if reason:
        raise NoClosedFormError(f"{mode}: {reason}; axisrig tune distance measures the loop")
    return truth.loop(mode)


@_of_axis
def distance_kp_limit(truth: DistanceTruth) -> Observation:
    """Largest kp with which the loop is stable, from its poles."""
    loop = _known_loop(truth)
    limit = kp_limit(loop)
    note = f"{loop.mode}, {truth.dead.dead} dead cycles, {loop.smoothing.name}"
    return Observation(min(limit, KP_MAX), note=note)


@_of_axis
def distance_growth(truth: DistanceTruth) -> Observation:
    """Factor per cycle by which the steps of the offset change when nothing excites them."""
    found = stretches.envelope(truth, stretches.last_active(truth))
    return Observation(found.growth, note=f"{found.note}, {found.cycles} cycles")


@_of_axis
def distance_growth_expected(truth: DistanceTruth) -> Observation:
    """Magnitude of the largest pole of the loop."""
    loop = _known_loop(truth)
    return Observation(growth(loop, truth.listed.control.kp), note=loop.smoothing.name)


@_of_axis
def distance_stability(truth: DistanceTruth) -> Observation:
    """Say whether the steps of the offset died away."""
    found = stretches.envelope(truth, stretches.last_active(truth))
    word = "stable" if found.growth < 1.0 else "unstable"
    return Observation(word, note=f"factor {found.growth:.5g} per cycle: {found.note}")


# Errors


@_of_axis
def distance_error_um(truth: DistanceTruth) -> Observation:
    """Mean of the error that the loop sees at the SYNC, before the step of the cycle."""
    part, speed = stretches.steady(truth)
    errors = truth.gathered(lambda some: some["error_mm"], part.judged)
    note = f"surface {speed:.4g} mm/s, last {len(errors)} of {part.end - part.begin} cycles"
    return Observation(float(np.mean(errors)) * UM, _increment_um(truth), f"{note}; an increment")


@_of_axis
def distance_error_expected_um(truth: DistanceTruth) -> Observation:
    """Closed form of the same: v T/kp, 0 with an integral part."""
    part, speed = stretches.steady(truth)
    control = truth.listed.control
    stretches.must_settle(_loop(truth, part.mode), control.kp, part)
    stretches.must_not_clamp(truth, part)
    if control.tn_s:
        return Observation(0.0, note="integral part")
    return Observation(following.ramp_error_mm(speed, control.kp, truth.period_ns) * UM)


@_of_axis
def distance_behind_um(truth: DistanceTruth) -> Observation:
    """By how much the tool is really behind the surface in the steady part, the plant's truth."""
    part, speed = stretches.steady(truth)
    behind = truth.gathered(behind_mm, part.judged)
    increment = _increment_um(truth)
    return Observation(
        float(np.mean(behind)) * UM, increment, f"surface {speed:.4g} mm/s; an increment"
    )


@_of_axis
def distance_behind_expected_um(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    part, speed = stretches.steady(truth)
    control = truth.listed.control
    loop = _loop(truth, part.mode)
    stretches.must_settle(loop, control.kp, part)
    stretches.must_not_clamp(truth, part)
    if control.tn_s:
        raise NoClosedFormError("closed form of P control only")
    return Observation(following.ramp_lag_mm(loop, speed, control.kp, truth.period_ns) * UM)


@_of_axis
def distance_behind_um_max(truth: DistanceTruth) -> Observation:
    """Largest magnitude of it while the control was on."""
    return Observation(passes.most_while_on(truth, lambda part: np.abs(behind_mm(part))) * UM)


@_of_axis
def distance_behind_end_um(truth: DistanceTruth) -> Observation:
    """The same in the last cycle with the control on."""
    row = stretches.last_active(truth).end - 1
    (behind,) = truth.gathered(behind_mm, slice(row, row + 1))
    return Observation(float(behind) * UM, _increment_um(truth), "an increment")


@_of_axis
def distance_sine_gain(truth: DistanceTruth) -> Observation:
    """Amplitude of the distance's error over that of the surface."""
    frequency, surface, behind = _sines(truth)
    return Observation(abs(behind) / abs(surface), note=f"{frequency:.4g} Hz")


@_of_axis
def distance_sine_gain_expected(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    frequency, _, _ = _sines(truth)
    stretch = stretches.last_active(truth)
    kp, loop = truth.listed.control.kp, _loop(truth, stretch.mode)
    return Observation(following.sine_gain(loop, kp, frequency, truth.period_ns))


def _sines(truth: DistanceTruth) -> tuple[float, complex, complex]:
    stretch = stretches.last_active(truth)
    # Behind the transient, and before a profile ends in the braking ramp of its axis
    length = stretch.end - stretch.begin
    settled = slice(stretch.begin + length // 2, stretch.end - length // 10)
    heights = truth.gathered(surface_mm, settled)
    frequency, _, surface = stretches.sine_parts(heights, truth.period_s)
    behinds = truth.gathered(behind_mm, settled)
    _, behind = stretches.fitted(behinds, frequency, truth.period_s)
    return frequency, surface, behind


# Steps


@_of_axis
def distance_settling_ms(truth: DistanceTruth) -> Observation:
    """From the largest error of the last time with the control on until it stays settled."""
    if not truth.has_surface:
        raise NoClosedFormError(NO_PLANT)
    stretch = stretches.last_active(truth)
    inside = np.abs(truth.gathered(behind_mm, stretch.rows))
    begin = int(np.argmax(inside))
    band = max(SETTLED_MM, SETTLED_SHARE * float(inside[begin]))
    beyond = np.flatnonzero(inside > band)
    if len(beyond) and int(beyond[-1]) == len(inside) - 1:
        raise NoClosedFormError(f"not settled to {band * UM:.3g} um")
    end = int(beyond[-1]) + 1 if len(beyond) else begin
    time_ms = (end - begin) * truth.period_ns / 1e6
    return Observation(time_ms, note=f"to {band * UM:.3g} um, looked at once per cycle")


@_of_axis
def distance_overshoot_mm(truth: DistanceTruth) -> Observation:
    """How far the offset went past the surface it had to follow, after the largest error."""
    stretch = stretches.last_active(truth)
    behind = truth.gathered(behind_mm, stretch.rows)
    begin = int(np.argmax(np.abs(behind)))
    side = math.copysign(1.0, float(behind[begin]))
    return Observation(max(0.0, float(np.max(-side * behind[begin:]))), _increment_um(truth) / UM)


@_of_axis
def distance_overshoot_expected_mm(truth: DistanceTruth) -> Observation:
    """Closed form after plain clamps, without dead time: v^2/2a - v/K + a/2K^2."""
    rows = stretches.last_active(truth).rows
    if any(np.any(part.override[inside] != 1.0) for part, _, inside in truth.parts(rows)):
        raise NoClosedFormError("an override of the axis scaled v_max")
    limit, control = truth.listed.limits, truth.listed.control
    value = limits.overshoot_mm(control.kp, truth.period_ns, limit.v_mm_s, limit.a_mm_s2)
    way = limit.v_mm_s * truth.period_s * (truth.dead.dead + 1)
    return Observation(value, note=f"dead time adds up to {way:.3g} mm")


# The offset


@_of_axis
def offset_end_mm(truth: DistanceTruth) -> Observation:
    """Offset at the end of the program."""
    return Observation(truth.observed.value(truth.axis, "offset_mm", len(truth.observed) - 1))


@_of_axis
def offset_mm_max(truth: DistanceTruth) -> Observation:
    """Largest offset, away from the workpiece."""
    return Observation(passes.extreme(truth, lambda part: part["offset_mm"]))


@_of_axis
def offset_mm_min(truth: DistanceTruth) -> Observation:
    """Smallest offset, towards the workpiece."""
    return Observation(passes.extreme(truth, lambda part: part["offset_mm"], np.min))


@_of_axis
def offset_speed_mm_s_max(truth: DistanceTruth) -> Observation:
    """Largest speed of the offset."""
    most_mm = passes.extreme(truth, lambda part: np.abs(_offset_steps(part)))
    return Observation(most_mm / truth.period_s)


@_of_axis
def offset_speed_down_mm_s_max(truth: DistanceTruth) -> Observation:
    """Largest speed of the offset towards the workpiece."""
    most_mm = passes.extreme(truth, lambda part: -_offset_steps(part))
    return Observation(max(0.0, most_mm) / truth.period_s)


@_of_axis
def offset_acceleration_mm_s2_max(truth: DistanceTruth) -> Observation:
    """Largest change of the speed of the offset from cycle to cycle, while the control was on."""
    most_mm = passes.most_while_on(truth, lambda p: np.abs(np.diff(_offset_steps(p), prepend=0.0)))
    return Observation(most_mm / truth.period_s**2)


def _offset_steps(truth: DistanceTruth) -> Signal:
    """Return the steps that the control makes: what OFF NO_MOVE hands over is none."""
    offset = truth["offset_mm"]
    runs_out = np.concatenate([[False], truth.state[:-1] == TURNING_OFF])
    return np.where(truth.is_active | runs_out, np.diff(offset, prepend=offset[:1]), 0.0)


@_of_axis
def offset_noise_um(truth: DistanceTruth) -> Observation:
    """Standard deviation of the offset in the steady part."""
    part, _ = stretches.steady(truth)
    offset = truth.gathered(lambda some: some["offset_mm"], part.rows)
    return Observation(float(np.std(offset[-(part.end - part.begin) // 2 :])) * UM)


@_of_axis
def freeze_drift_um(truth: DistanceTruth) -> Observation:
    """Largest change of the offset during any one FREEZE."""
    frozen = [time for time in truth.states if time.value == FREEZE]
    if not frozen:
        raise NoClosedFormError("distance control was never frozen")
    drifts = [passes.drift_mm(truth, slice(begin, end)) for begin, end, _ in frozen]
    return Observation(max(drifts) * UM, note=f"{len(drifts)} time(s) in FREEZE")


@_of_axis
def offset_held_drift_um(truth: DistanceTruth) -> Observation:
    """Largest change of the offset while feedhold or override 0 of the axis hold it."""
    if not truth.held:
        raise NoClosedFormError("neither feedhold nor override of the axis held the offset")
    drifts = [passes.drift_mm(truth, slice(max(begin - 1, 0), end)) for begin, end, _ in truth.held]
    return Observation(max(drifts) * UM, note=f"held {len(drifts)} time(s)")


@_of_axis
def distance_state_end(truth: DistanceTruth) -> Observation:
    """State at the end of the program."""
    return Observation(STATE_WORDS[truth.states[-1].value])


# The filter


@_of_axis
def distance_filter_delay_cycles(truth: DistanceTruth) -> Observation:
    """By how many cycles the filter is late, at the largest step of the surface."""
    return Observation(filtering.delay_cycles(truth), note=truth.smoothing.name)


@_of_axis
def distance_filter_delay_expected_cycles(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    return Observation(truth.smoothing.delay_cycles, note=truth.smoothing.name)


@_of_axis
def distance_filter_noise_gain(truth: DistanceTruth) -> Observation:
    """Standard deviation after over that before the filter, while the surface is at rest."""
    settling = len(truth.smoothing.numerator) + round(6 * truth.smoothing.delay_cycles)
    gain, cycles = filtering.noise_gain(truth, settling)
    return Observation(gain, note=f"{truth.smoothing.name}; {cycles} cycles")


@_of_axis
def distance_filter_noise_gain_expected(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    return Observation(truth.smoothing.noise_gain, note=truth.smoothing.name)


# The own model


@_of_axis
def offset_model_error_um(truth: DistanceTruth) -> Observation:
    """Largest difference between the offset and that of the own model along the same values."""
    model = expected_offset.walk(truth).offset_mm
    found = []
    for part, begin, inside in truth.parts():
        expected = model[begin : begin + inside.stop - inside.start]
        rows = ~np.isnan(expected) & part.is_active[inside]
        if rows.any():
            found.append(np.max(np.abs(part["offset_mm"][inside] - expected)[rows]))
    if not found:
        raise NoClosedFormError("distance control was never on")
    return Observation(float(np.max(found)) * UM)


@_of_axis
def distance_alarm_late_cycles(truth: DistanceTruth) -> Observation:
    """Cycle of the alarm less the one in which it is due by the values that the bus brought."""
    due = expected_offset.due(truth, expected_offset.walk(truth))
    raised = _raised(truth)
    if due is None or raised is None:
        words = f"due: {'none' if due is None else due.alarm}"
        raise NoClosedFormError(f"{words}, raised: {'none' if raised is None else raised[1]}")
    time_ns, number = raised
    if same_cause(number) != same_cause(due.alarm):
        raise NoClosedFormError(f"due was {due.alarm}, raised {number}")
    sync_ns = truth.observed.time_ns(due.row) // truth.period_ns * truth.period_ns
    late = (time_ns - truth.observed.facts.timing.offset_ns - sync_ns) / truth.period_ns
    return Observation(late, note=f"ID {number} due in the cycle of {sync_ns / 1e6:g} ms")


@_of_axis
def distance_alarm_after_cycles(truth: DistanceTruth) -> Observation:
    """Cycles from the first one that controls to the one with the alarm; 0: in the first."""
    raised = _raised(truth)
    if raised is None:
        raise NoClosedFormError("no alarm of sensor or offset came up")
    period_ns, offset_ns = truth.period_ns, truth.observed.facts.timing.offset_ns
    first = expected_offset.first_step(truth, stretches.active(truth)[0])
    begin_ns = truth.observed.time_ns(first) // period_ns * period_ns
    return Observation((raised[0] - offset_ns - begin_ns) // period_ns, note=f"ID {raised[1]}")


def _raised(truth: DistanceTruth) -> tuple[int, int] | None:
    """Return instant and ID of the first alarm of sensor or offset."""
    ids = [same_cause(cause) for cause in (70329, 70330, 70331, 70576, 900314)]
    for alarm in truth.observed.facts.alarms:
        if not alarm.is_further and same_cause(alarm.id) in ids:
            return alarm.time_ns, alarm.id
    return None
