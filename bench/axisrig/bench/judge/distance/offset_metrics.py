"""Metrics of distance control: what offset and filter did, and the own model beside them.

Those of its loop are in `metrics`.
"""

from functools import partial

import numpy as np

from axisrig.bench.judge.distance import control_stretches, expected_offset, filtering, passes
from axisrig.bench.judge.distance.registry import UM, of_axis
from axisrig.bench.judge.distance.truth import FREEZE, STATE_WORDS, TURNING_OFF, DistanceTruth
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.oracles.distance.smoothing import Smoothing
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal
from axisrig.kernel.errors import same_cause

OFFSET_METRICS: dict[str, MetricFunction] = {}
_of_axis = partial(of_axis, OFFSET_METRICS)


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
    part, _ = control_stretches.steady(truth)
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
    filtered = control_stretches.of_last_filter(truth)
    return Observation(filtering.delay_cycles(truth, filtered), note=_filter(truth).name)


@_of_axis
def distance_filter_delay_expected_cycles(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    return Observation(_filter(truth).delay_cycles, note=_filter(truth).name)


@_of_axis
def distance_filter_noise_gain(truth: DistanceTruth) -> Observation:
    """Standard deviation after over that before the filter, while the surface is at rest."""
    smooth, filtered = _filter(truth), control_stretches.of_last_filter(truth)
    settling = len(smooth.numerator) + round(6 * smooth.delay_cycles)
    gain, cycles = filtering.noise_gain(truth, filtered, settling)
    return Observation(gain, note=f"{smooth.name}; {cycles} cycles")


@_of_axis
def distance_filter_noise_gain_expected(truth: DistanceTruth) -> Observation:
    """Closed form of the same."""
    return Observation(_filter(truth).noise_gain, note=_filter(truth).name)


def _filter(truth: DistanceTruth) -> Smoothing:
    """Return the last filter that acted."""
    return truth.smoothing(control_stretches.of_last_filter(truth)[-1].listed)


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
    first = expected_offset.first_step(truth, control_stretches.compared(truth)[0].begin)
    begin_ns = truth.observed.time_ns(first) // period_ns * period_ns
    return Observation((raised[0] - offset_ns - begin_ns) // period_ns, note=f"ID {raised[1]}")


def _raised(truth: DistanceTruth) -> tuple[int, int] | None:
    """Return instant and ID of the first alarm of sensor or offset."""
    ids = [same_cause(cause) for cause in (70329, 70330, 70331, 70576, 900314)]
    for alarm in truth.observed.facts.alarms:
        if not alarm.is_further and same_cause(alarm.id) in ids:
            return alarm.time_ns, alarm.id
    return None
