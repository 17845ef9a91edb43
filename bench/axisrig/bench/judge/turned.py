"""Metrics of rotary axes: in degrees and N.m, under names of their own, or none and why.

What is 1 mm of a linear axis is 1 degree of a rotary one, so lengths keep their number; a force
times its arm is a torque.
"""

from dataclasses import replace

import pyarrow as pa

from axisrig.bench.judge.observation import Observation
from axisrig.bench.judge.observe import Observed
from axisrig.bench.plan.checks import Check, known_metrics, rotary_twin

# Columns of a trace and their names for a rotary axis; those of forces where its plant turns
LENGTH_COLUMNS = {
    "set_mm": "set_deg",
    "actual_mm": "actual_deg",
    "truth_mm": "truth_deg",
    "velocity_mm_s": "velocity_deg_s",
    "cnc_lag_mm": "cnc_lag_deg",
    "drive_lag_mm": "drive_lag_deg",
    "drive_lag_peak_mm": "drive_lag_peak_deg",
    "stop_mm": "stop_deg",
}
FORCE_COLUMNS = {
    "force_n": "torque_nm",
    "stop_force_n": "stop_torque_nm",
    "stop_force_peak_n": "stop_torque_peak_nm",
}
FORCE, TORQUE = "N", "N.m"
LENGTHS = ("mm", "um", "mm/s", "mm/s2")
ANGLES = ("deg", "mdeg", "deg/s")


def turned(observed: Observed, check: Check) -> str:
    """Say why a length or force is none of the axes that a check is about; empty when it is.

    The same the other way round, for an angle or torque of axes that do not turn.
    """
    metric, about = check.definition, observed.about(check.definition, check.axis)
    if metric.unit in (*LENGTHS, *ANGLES):
        rotary = [axis for axis in about if observed.is_rotary(axis)]
    elif metric.unit in (FORCE, TORQUE):
        rotary = [axis for axis in about if observed.torque_arm_m(axis) is not None]
    else:
        return ""
    wants_rotary = bool(metric.linear)
    if rotary == (about if wants_rotary else []):
        return ""
    if rotary and len(rotary) < len(about):
        return f"of axes {' '.join(about)} only {' '.join(rotary)} turn: name one axis"
    axes = f"axis {' '.join(about)}"
    if wants_rotary:
        return f"{axes} is told in {known_metrics()[metric.linear].unit}: ask {metric.linear}"
    twin = rotary_twin(metric.name)
    return f"{axes} turns" + (f": ask {twin}" if twin else f" and has no value in {metric.unit}")


def in_newton_metres(found: Observation, observed: Observed, check: Check) -> Observation:
    """Make a torque of a force at a rotary axis, or at the axes of a run that have one arm."""
    arms = {observed.torque_arm_m(a) for a in observed.about(check.definition, check.axis)}
    arm_m = arms.pop() if len(arms) == 1 else None
    if found.value is None:
        return found
    if arm_m is None or not isinstance(found.value, float):
        return Observation(None, note="the axes have arms of different lengths: name one axis")
    return replace(found, value=found.value * arm_m, uncertainty=found.uncertainty * arm_m)


def turned_trace(observed: Observed) -> pa.Table:
    """Return the trace with the columns of rotary axes in their units: deg, deg/s, N.m."""
    trace = observed.trace
    for axis in filter(observed.is_rotary, observed.machine.links):
        arm_m = observed.torque_arm_m(axis)
        names = LENGTH_COLUMNS if arm_m is None else LENGTH_COLUMNS | FORCE_COLUMNS
        for name, turned_name in names.items():
            place = trace.schema.get_field_index(f"{axis}.{name}")
            if place < 0:
                continue
            values = trace.column(place)
            if name in FORCE_COLUMNS:
                values = pa.array(values.to_numpy() * arm_m)
            trace = trace.set_column(place, f"{axis}.{turned_name}", values)
    return trace
