"""What a run to a fixed stop has measured and pressed, beside what it had to: for the report."""

import math
from dataclasses import dataclass

import numpy as np

from axisrig.bench.judge.fixed_stop.run import StopRun
from axisrig.bench.judge.fixed_stop.truth import AxisTruth
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.oracles.fixed_stop.false_triggers import Motion, false_triggers
from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.pressing import Pressing
from axisrig.bench.oracles.fixed_stop.slopes import has_ramps, slopes_as_written
from axisrig.bench.oracles.fixed_stop.timing import bus_lag_mm
from axisrig.kernel.time.clock import S

REST_MM_S = 0.1
"""An axis that is slower counts as at rest: less than 1 um in 10 ms."""
DECAYS = 5.0
"""Decay times of the ringing after which the latched value is that of rest."""
LATCHED_MM = 1e-3
"""How near x_stop + F/k a value has to be that was latched at rest, beside what friction leaves."""


_AT_MOST = "at most force limit less weight and friction, and v sqrt(k m) of what still rings"
_RAMPS = "no closed form with the ramps of P-CHAN-00071"
_PROGRAMMED = "no closed form with dynamics that the program has chosen (#SLOPE, G130 to G134)"


@dataclass(frozen=True)
class Value:
    """One value with what was expected of it.

    expected, low, high: in `unit`, of the closed form; None where there is none or no such bound.
    note: the formula with its numbers, or why there is none.
    """

    key: str
    label: str
    unit: str
    axis: str
    measured: float | None
    expected: float | None = None
    low: float | None = None
    high: float | None = None
    note: str = ""


def values(run: StopRun) -> list[Value]:
    """Return the values of every axis that met its stop."""
    found: list[Value] = []
    for axis, truth in run.truths.items():
        contact = run.contact(axis)
        if contact is None:
            continue
        found += [_running_lag(run, truth), _latched(run, truth)]
        found += [*_forces(run, truth), _excess(run, truth)]
    return [value for value in found if value.measured is not None]


def _running_lag(run: StopRun, truth: AxisTruth) -> Value:
    contact = run.contact(truth.name)
    assert contact is not None
    measured = abs(float(truth.cnc_lag_mm[contact.row]))
    label, note = "lag in motion", "(1 - f) v/Kv + (n1 + n2 + 1 - d) v T"
    try:
        approach, cycles = run.approach(truth.name), run.cycles_of(truth.name)
        shown_mm = bus_lag_mm(approach.speed_mm_s, cycles)
        judged_mm = bus_lag_mm(approach.speed_mm_s, cycles.judged)
        expected = abs(approach.running_lag_mm - judged_mm + shown_mm)
    except NoClosedFormError as reason:
        return Value("running_lag", label, "mm", truth.name, measured, note=str(reason))
    return Value("running_lag", label, "mm", truth.name, measured, expected, note=note)


def _latched(run: StopRun, truth: AxisTruth) -> Value:
    label, measured = "latched position", run.record.latched_mm.get(truth.name)
    pressing, path = run.pressing(truth.name), truth.stop_path
    contact = run.contact(truth.name)
    if measured is None or pressing is None or path is None or contact is None:
        return Value("latched", label, "mm", truth.name, measured)
    detected_ns = run.stop.detected_ns or run.end_ns
    if contact.time_ns > detected_ns:
        return Value("latched", label, "mm", truth.name, measured, note="latched before contact")
    restless = _restless(run, truth)
    if restless:
        return Value("latched", label, "mm", truth.name, measured, note=restless)
    stop_mm = float(path.position_mm[run.row_at(detected_ns)]) - truth.zero_mm
    low, high = pressing.latched_mm(stop_mm)
    low, high = low - LATCHED_MM, high + LATCHED_MM
    note = (
        f"x_stop + (F_lim - F_g +- F_c)/k +- 1 um, F_lim {pressing.limit_n:.6g} N,"
        f" F_g {pressing.stop.direction * pressing.axis.weight_n:.4g} N,"
        f" F_c {pressing.axis.friction_n:.4g} N; ringing decays in {pressing.decay_s * 1e3:.3g} ms"
    )
    return Value("latched", label, "mm", truth.name, measured, (low + high) / 2.0, low, high, note)


def _restless(run: StopRun, truth: AxisTruth) -> str:
    """Say why the axis was not at rest against its stop at the detection, empty when it was."""
    pressing, path = run.pressing(truth.name), truth.stop_path
    limits = run.limits.get(truth.name)
    if run.stop.detected_ns is None or pressing is None or path is None:
        return "no detection at a stop"
    row = run.row_at(run.stop.detected_ns)
    if abs(float(path.velocity_mm_s[row])) > REST_MM_S:
        return "the stop moves"
    if abs(float(truth.velocity_mm_s[row])) > REST_MM_S:
        return "the axis was not at rest at the detection"
    if limits is not None and limits.min_time_ns < DECAYS * pressing.decay_s * S:
        return f"the minimum time is shorter than {DECAYS:g} decay times of the ringing"
    return ""


def _speed_at_end(run: StopRun, truth: AxisTruth, pressing: Pressing) -> float:
    """Return the largest speed in the last period of the ringing, mm/s."""
    period_ns = 2.0 * math.pi * S * math.sqrt(pressing.axis.mass_kg / pressing.stop.stiffness_n_m)
    last = slice(run.row_at(run.end_ns - period_ns), run.row_at(run.end_ns) + 1)
    return float(np.max(np.abs(truth.velocity_mm_s[last])))


def _forces(run: StopRun, truth: AxisTruth) -> list[Value]:
    peak_n = truth.stop_force_max_n(run.rows)
    pressing, contact = run.pressing(truth.name), run.contact(truth.name)
    if truth.stop_force_n is None or peak_n is None or pressing is None or contact is None:
        return []
    end_n = float(truth.stop_force_n[run.row_at(run.end_ns)])
    if truth.stop_path is not None and np.ptp(truth.stop_path.position_mm[run.rows]) > 0.0:
        return []  # a stop that moves works on the axis
    speed_mm_s = _speed_at_end(run, truth, pressing)
    restless = "the axis was not at rest at the end: no bound" if speed_mm_s > REST_MM_S else ""
    # What is left of the ringing swings with k v/omega = v sqrt(k m)
    left_n = speed_mm_s * 1e-3 * math.sqrt(pressing.stop.stiffness_n_m * pressing.axis.mass_kg)
    most_n = pressing.force_n[1] + left_n
    low_n, high_n = pressing.peak_force_n(contact.speed_mm_s)
    mass = f"m_eff {pressing.axis.mass_kg:.5g} kg"
    bound = "no bound for a stop that is not straight or damps more than a v = 1"
    return [
        Value(
            *("stop_force_max", "largest force at the stop", "N", truth.name, peak_n),
            *(None, low_n, high_n),
            bound if high_n is None else f"v sqrt(k m) .. F + sqrt(F^2 + k m v^2), {mass}",
        ),
        Value(
            *("stop_force_end", "force at the stop at the end", "N", truth.name, end_n),
            *((None, None, None, restless) if restless else (None, 0.0, most_n, _AT_MOST)),
        ),
    ]


def _excess(run: StopRun, truth: AxisTruth) -> Value:
    label = "way of the set value past the latched position"
    measured = run.command_excess_mm(truth)
    axis, detection = run.detection
    if measured is None or detection.low_ns is None or detection.high_ns is None:
        return Value("command_excess", label, "mm", truth.name, measured, note=detection.note)
    restless = _restless(run, truth)
    if axis != truth.name or len(run.record.axes) > 1 or restless:
        return Value("command_excess", label, "mm", truth.name, measured, note=restless)
    approach = run.approach(axis)
    other = _other_dynamics(run)
    if other:
        return Value("command_excess", label, "mm", axis, measured, note=other)
    slope = slopes_as_written(truth.written, run.observed.facts.channel).on_signal
    cycles = run.cycles_of(axis).judged
    late_ns = (cycles.delay_cycles - 1 + cycles.buffer_cycles) * cycles.period_ns
    ends_mm = [
        approach.running_lag_mm
        + approach.speed_mm_s * (at_ns - age_ns - approach.contact_ns + late_ns) / S
        - approach.penetration_mm
        + slope.way_mm(approach.speed_mm_s)
        for at_ns, age_ns in zip((detection.low_ns, detection.high_ns), cycles.age_ns, strict=True)
    ]
    note = "L + v (tau + t_d) + v^2/2a"
    low, high = ends_mm
    return Value("command_excess", label, "mm", axis, measured, (low + high) / 2.0, low, high, note)


def _other_dynamics(run: StopRun) -> str:
    """Say why the linear slope of the lists is not what acts in a run; empty where it does."""
    facts = run.observed.facts
    if has_ramps(facts.channel):
        return _RAMPS
    if facts.blocks is None or "dynamics" not in facts.blocks.kinds:
        return ""
    rows = facts.blocks.rows()
    is_chosen = rows.kind == facts.blocks.kinds.index("dynamics")
    chosen = rows.begin_ns[is_chosen & (rows.begin_ns <= run.record.begin_ns)]
    return _PROGRAMMED if len(chosen) else ""


def prediction(run: StopRun) -> str:
    """Say in one sentence what the settings of a run foretell."""
    if run.limits and not any(limits.detects for limits in run.limits.values()):
        return "nothing can detect: no criterion is on"
    other = _other_dynamics(run)
    if other:
        return other
    reasons = [
        f"{axis}: {reason}"
        for axis, limits in run.limits.items()
        for reason in false_triggers(limits, _motion(run, axis), run.pressing(axis))
    ]
    if reasons:
        return "found in free motion: " + "; ".join(reasons)
    axis, detection = run.detection
    if detection.time_ns is None or axis is None:
        return ""
    return f"contact of {axis} with its stop, found by {_criteria(run.limits[axis])}"


def _criteria(limits: Limits) -> str:
    words = [] if limits.lag_limit_mm is None else ["lag"]
    return " and ".join([*words, *([] if limits.window_mm is None else ["window"])])


def _motion(run: StopRun, axis: str) -> Motion:
    truth, rows = run.truths[axis], run.rows
    until = run.row_at(run.stop.detected_ns or run.end_ns) + 1
    demand_mm, times = (
        truth.course.demand_mm[rows.start : until],
        truth.syncs_ns[rows.start : until],
    )
    moves = len(demand_mm) > 1
    speeds = np.abs(np.diff(demand_mm)) * S / np.diff(times) if moves else np.zeros(1)
    speed_mm_s = float(np.quantile(speeds, 0.9))  # a drive that faults lets its demand jump
    channel = run.observed.facts.channel
    return Motion(
        speed_mm_s,
        slopes_as_written(truth.written, channel).up.low_mm_s2,
        run.running_lag_mm(axis, speed_mm_s),
        run.arming_mm,
        truth.values.number("breakaway_friction", "friction.breakaway"),
    )
