"""Metrics of rotary axes: in degrees and N.m, under names of their own, or none and why.

What is 1 mm of a linear axis is 1 degree of a rotary one, so lengths keep their number; a force
times its arm is a torque.
"""

from dataclasses import replace

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.plan.checks import Check, known_metrics, rotary_twin

FORCE, TORQUE = "N", "N.m"
LENGTHS = ("mm", "um", "mm/s", "mm/s2", "mm/s3")
ANGLES = ("deg", "mdeg", "deg/s", "deg/s2", "deg/s3")


def turned(observed: Observed, check: Check) -> str:
    """Say why a length or force is none of the axes that a check is about; empty when it is.

    The same the other way round, for an angle or torque of axes that do not turn.
    """
    metric, about = check.definition, observed.about(check.definition, check.axis)
    if metric.scope == "run":  # of the tool
        return ""
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
        return f"{axes} is given in {known_metrics()[metric.linear].unit}: ask {metric.linear}"
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
