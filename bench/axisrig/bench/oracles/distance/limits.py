"""What the limits of distance control do to a step: closed forms.

v, a limits of speed and acceleration of the offset, K = kp/T gain per time, H height of a step.
Sources: FCT-M3 7.2, 7.4; P-AXIS-00414 to 00417, 00501 to 00505, 00533, 00534.
"""

import math

from axisrig.kernel.time.clock import S, TimeNs

PER_MILLE = 1000.0


def stopping_step_mm(way_mm: float, change_mm: float) -> float:
    """Return the largest step from which an offset can still stop at the end of a way.

    change_mm: b = a T^2, by which a step may be less than the one before. n steps s, s - b, s - 2b
    .. end at n s - b n (n - 1)/2; with n of them, b n (n - 1)/2 < way <= b n (n + 1)/2, the last
    one is no more than b, and after it the offset stands. Infinite without a limit.
    """
    if not math.isfinite(change_mm):
        return math.inf
    if change_mm <= 0.0:
        return 0.0
    count = max(int(math.sqrt(2.0 * way_mm / change_mm)), 1)
    while change_mm * count * (count + 1) / 2 < way_mm:
        count += 1
    while count > 1 and change_mm * count * (count - 1) / 2 >= way_mm:
        count -= 1
    return way_mm / count + change_mm * (count - 1) / 2


def sloped_overshoot_mm(v_mm_s: float, period_ns: TimeNs, unseen_cycles: float) -> float:
    """Return v T (n + delay of the filter): how far a slope goes past a far surface, CONST_DIST.

    It brakes so that it would stop at the error; the error is that old, and the offset has gone on
    by as much (v: v_max, or what a nearer surface lets it reach). SET_POS knows its offset: 0.
    """
    return v_mm_s * period_ns / S * unseen_cycles


def overshoot_mm(kp: float, period_ns: TimeNs, v_mm_s: float, a_mm_s2: float) -> float:
    """Return v^2/2a - v/K + a/2K^2: a P law with plain clamps, continuous, no dead time.

    At the distance v/K from the end the law asks for less than v, at a/K^2 for a stronger braking
    than a from v = a/K on: 0 for v <= a T/kp.
    """
    gain = kp / (period_ns / S)
    if v_mm_s <= a_mm_s2 / gain:
        return 0.0
    return v_mm_s**2 / (2 * a_mm_s2) - v_mm_s / gain + a_mm_s2 / (2 * gain**2)


def braking_mm(v_mm_s: float, a_mm_s2: float) -> float:
    """Return v^2/2a."""
    return v_mm_s**2 / (2 * a_mm_s2)


def adaptive_mm_s2(
    error_mm: float, a_min_mm_s2: float, a_max_mm_s2: float, low_mm: float, high_mm: float
) -> float:
    """Return a_min + (a_max - a_min) clip((|e| - e_min)/(e_max - e_min), 0, 1).

    low_mm, high_mm: P-AXIS-00504 and 00505.
    """
    a_min_mm_s2 = min(a_min_mm_s2, a_max_mm_s2)
    if high_mm <= low_mm:
        return a_max_mm_s2 if abs(error_mm) >= high_mm else a_min_mm_s2
    share = min(max((abs(error_mm) - low_mm) / (high_mm - low_mm), 0.0), 1.0)
    return a_min_mm_s2 + (a_max_mm_s2 - a_min_mm_s2) * share


def downwards(limit: float, weight_per_mille: float) -> float:
    """Return a limit of the motion towards the workpiece; weight 0 = not weighted."""
    return limit if weight_per_mille == 0 else limit * weight_per_mille / PER_MILLE


def lowest_step_mm(before_mm: float, change_mm: float, weight_per_mille: float) -> float:
    """Return the smallest step of a cycle after a step of before_mm; change_mm: a T^2.

    What brakes an upward motion is not weighted; what is left of the cycle builds up the way down
    with the weighted acceleration (P-AXIS-00534; docs/ambiguities.md).
    """
    if before_mm >= change_mm:
        return before_mm - change_mm
    left = 1.0 - max(before_mm, 0.0) / change_mm
    return min(before_mm, 0.0) - downwards(change_mm, weight_per_mille) * left
