"""A position loop in the control: its lag, up to which gain it is stable, where a run stops.

Sampled with the period T, gain K, n dead cycles, an ideal speed loop. A set speed that acts at once
and is held: x(k+1) = x(k) + T u(k - n), poles z^(n+1) - z^n + K T = 0. One that is reached evenly
within a period: x(k+1) = x(k) + T (u(k - n) + u(k - n - 1))/2, z^(n+2) - z^(n+1) + K T (z + 1)/2 =
0. Both cross the unit circle where the phase of the loop is -180 degrees.
"""

import math

from axisrig.kernel.time.clock import TimeNs


def gain_limit(dead_cycles: float, *, is_held: bool) -> float:
    """Return the largest stable K T: 2 sin(pi/(2(2n+1))) held, 2 tan(pi/(4(n+1))) interpolated.

    dead_cycles: n; a fraction is the time of a speed loop as a dead time, which is a lower bound
    for a lag of first order, whose phase stays above that of the dead time.
    """
    if is_held:
        return 2.0 * math.sin(math.pi / (2.0 * (2.0 * dead_cycles + 1.0)))
    return 2.0 * math.tan(math.pi / (4.0 * (dead_cycles + 1.0)))


def dead_cycles(late_cycles: int, speed_loop_ns: TimeNs, period_ns: TimeNs) -> float:
    """Return n: a set speed acts at the SYNC after its cycle, later with the carrier and the drive.

    late_cycles: that the carrier adds. speed_loop_ns: time of the speed loop of the drive.
    """
    return 1 + late_cycles + speed_loop_ns / period_ns


def ramp_lag_mm(speed_mm_s: float, kv_per_s: float, feed_forward: float = 0.0) -> float:
    """Return (1 - f) v/Kv, the lag that the control computes at a steady speed."""
    return (1.0 - feed_forward) * speed_mm_s / kv_per_s
