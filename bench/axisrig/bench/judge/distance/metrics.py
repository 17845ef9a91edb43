"""The metrics of the loop of distance control: dead time, stability, errors, steps.

They compare with the plant's truth, with frames of the bus and with `oracles/distance`.
Without a named axis they are about the only one, or the first, that has distance control.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from axisrig.bench.judge.distance import control_stretches, passes
from axisrig.bench.judge.distance.control_stretches import Stretch
from axisrig.bench.judge.distance.plant import NO_PLANT, behind_mm, surface_mm
from axisrig.bench.judge.distance.registry import UM, of_axis
from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.oracles.distance import following, limits
from axisrig.bench.oracles.distance.loop import BOTH, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.stability import KP_MAX, kp_limit
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

LOOP_METRICS: dict[str, MetricFunction] = {}
_of_axis = partial(of_axis, LOOP_METRICS)
SETTLED_MM, SETTLED_SHARE = 0.005, 0.01


def _increment_um(truth: DistanceTruth) -> float:
    return truth.increment_mm * UM


def _loop(truth: DistanceTruth, stretch: Stretch) -> Loop:
    if truth.every > 1:
        raise NoClosedFormError("60E4 does not come with every SYNC")
    return truth.loop(stretch.mode, stretch.listed)


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


def _known_loop(truth: DistanceTruth) -> tuple[Loop, float]:
    """Return loop and kp of the last law that acted.

    Raises NoClosedFormError where its poles are unknown.
    """
    stretch = control_stretches.last_active(truth)
    reason = control_stretches.unknown_poles(truth, stretch.mode)
    if reason:
        words = f"{stretch.mode}: {reason}"
        raise NoClosedFormError(f"{words}; axisrig tune distance measures the loop")
    return truth.loop(stretch.mode, stretch.listed), stretch.kp


@_of_axis
def distance_kp_limit(truth: DistanceTruth) -> Observation:
    """Largest kp with which the loop is stable, from its poles."""
    loop, _ = _known_loop(truth)
    limit = kp_limit(loop)
    note = f"{loop.mode}, {truth.dead.dead} dead cycles, {loop.smoothing.name}"
    return Observation(min(limit, KP_MAX), note=note)


@_of_axis
def distance_growth(truth: DistanceTruth) -> Observation:
    """Factor per cycle by which the steps of the offset change when nothing excites them."""
    found = control_stretches.envelope(truth, control_stretches.last_active(truth))
    return Observation(found.growth, found.uncertainty, found.note)


@_of_axis
def distance_growth_expected(truth: DistanceTruth) -> Observation:
    """Magnitude of the largest pole of the loop."""
    loop, kp = _known_loop(truth)
    return Observation(growth(loop, kp), note=f"kp {kp:g}, {loop.smoothing.name}")


@_of_axis
def distance_stability(truth: DistanceTruth) -> Observation:
    """Say whether the steps of the offset died away."""
    found = control_stretches.envelope(truth, control_stretches.last_active(truth))
    doubt = f"factor {found.growth:.5g} per cycle: {found.note}"
    if not found.stability:
        raise NoClosedFormError(f"neither stable nor unstable for sure, {doubt}")
    return Observation(found.stability, note=doubt)


# Errors


def _mean(truth: DistanceTruth, signal: Callable[[DistanceTruth], Signal]) -> Observation:
    """Return the mean of a signal in the judged share of the steady part.

    It is as uncertain as the signal is unsteady there: half of its swing, an increment of the
    sensor at least.
    """
    part, speed = control_stretches.steady(truth)
    values = truth.gathered(signal, part.judged)
    half, increment = float(np.ptp(values)) / 2.0 * UM, _increment_um(truth)
    note = f"surface {speed:.4g} mm/s, last {len(values)} of {part.end - part.begin} cycles"
    why = "half of its swing" if half > increment else "an increment"
    return Observation(float(np.mean(values)) * UM, max(half, increment), f"{note}; {why}")


@_of_axis
def distance_error_um(truth: DistanceTruth) -> Observation:
    """Mean of the error that the loop sees at the SYNC, before the step of the cycle."""
    return _mean(truth, lambda some: some["error_mm"])


@_of_axis
def distance_error_expected_um(truth: DistanceTruth) -> Observation:
    """Closed form of the same: v T/kp, 0 with an integral part."""
    part, speed = control_stretches.steady(truth)
    control_stretches.must_settle(_loop(truth, part), part)
    control_stretches.must_not_clamp(truth, part)
    if part.listed.control.tn_s:
        return Observation(0.0, note="integral part")
    return Observation(following.ramp_error_mm(speed, part.kp, truth.period_ns) * UM)


@_of_axis
def distance_behind_um(truth: DistanceTruth) -> Observation:
    """By how much the tool is really behind the surface in the steady part, the plant's truth."""
    return _mean(truth, behind_mm)


@_of_axis
def distance_behind_expected_um(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    part, speed = control_stretches.steady(truth)
    loop = _loop(truth, part)
    control_stretches.must_settle(loop, part)
    control_stretches.must_not_clamp(truth, part)
    if part.listed.control.tn_s:
        raise NoClosedFormError("closed form of P control only")
    return Observation(following.ramp_lag_mm(loop, speed, part.kp, truth.period_ns) * UM)


@_of_axis
def distance_behind_um_max(truth: DistanceTruth) -> Observation:
    """Largest magnitude of it while the control was on."""
    return Observation(passes.most_while_on(truth, lambda part: np.abs(behind_mm(part))) * UM)


@_of_axis
def distance_behind_end_um(truth: DistanceTruth) -> Observation:
    """The same in the last cycle with the control on."""
    row = control_stretches.last_active(truth).end - 1
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
    stretch = control_stretches.last_active(truth)
    loop = _loop(truth, stretch)
    return Observation(following.sine_gain(loop, stretch.kp, frequency, truth.period_ns))


def _sines(truth: DistanceTruth) -> tuple[float, complex, complex]:
    stretch = control_stretches.last_active(truth)
    # Behind the transient, and before a profile ends in the braking ramp of its axis
    length = stretch.end - stretch.begin
    settled = slice(stretch.begin + length // 2, stretch.end - length // 10)
    heights = truth.gathered(surface_mm, settled)
    frequency, _, surface = control_stretches.sine_parts(heights, truth.period_s)
    behinds = truth.gathered(behind_mm, settled)
    _, behind = control_stretches.fitted(behinds, frequency, truth.period_s)
    return frequency, surface, behind


# Steps


def _last_on(truth: DistanceTruth) -> slice:
    """Return the rows of the last unbroken time with the control on."""
    found = control_stretches.last_on(truth)
    return slice(found[0].begin, found[-1].end)


@_of_axis
def distance_settling_ms(truth: DistanceTruth) -> Observation:
    """From the largest error of the last time with the control on until it stays settled."""
    if not truth.has_surface:
        raise NoClosedFormError(NO_PLANT)
    inside = np.abs(truth.gathered(behind_mm, _last_on(truth)))
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
    behind = truth.gathered(behind_mm, _last_on(truth))
    begin = int(np.argmax(np.abs(behind)))
    side = math.copysign(1.0, float(behind[begin]))
    return Observation(max(0.0, float(np.max(-side * behind[begin:]))), _increment_um(truth) / UM)


def _past_mm(truth: DistanceTruth, part: Stretch) -> float:
    """How far a slope goes past a far surface by what its error does not see yet."""
    unseen = max(0.0, float(truth.sensor_age_cycles))
    if part.mode != SET_POS:
        dead = truth.dead.reaction if part.mode == BOTH else truth.dead.dead
        unseen = dead + truth.smoothing(part.listed).delay_cycles
    return limits.sloped_overshoot_mm(part.listed.limits.v_mm_s, truth.period_ns, unseen)


@_of_axis
def distance_overshoot_expected_mm(truth: DistanceTruth) -> Observation:
    """Closed form, once v_max is reached: v T (n + delay of the filter) of a slope, 0 in SET_POS;
    after plain clamps, without dead time, v^2/2a - v/K + a/2K^2.
    """
    rows = _last_on(truth)
    if any(np.any(part.override[inside] != 1.0) for part, _, inside in truth.parts(rows)):
        raise NoClosedFormError("an override of the axis scaled v_max")
    parts = control_stretches.last_on(truth)
    if len({(one.kp, one.listed.limits) for one in parts}) > 1:
        raise NoClosedFormError("kp or a limit was changed while the control was on")
    limit, kp = parts[-1].listed.limits, parts[-1].kp
    if parts[-1].listed.control.is_sloped:
        return Observation(_past_mm(truth, parts[-1]), note="where v_max is reached")
    value = limits.overshoot_mm(kp, truth.period_ns, limit.v_mm_s, limit.a_mm_s2)
    way = limit.v_mm_s * truth.period_s * (truth.dead.dead + 1)
    return Observation(value, note=f"dead time adds up to {way:.3g} mm")
