"""The lag of a drive between two rows of the trace."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]
_EXACT: Final = 1e-9
"""Of a speed, at least of 1 mm/s: so far that of a straight step is off by rounding."""


def largest_lag(
    times_ns: NDArray[np.int64], motion: tuple[Column, Column, Column], tick_ns: int
) -> Column:
    """Return for each row the largest magnitude of demand - motor since the row before it.

    times_ns: SYNC instants, shape (n,). motion: demand, motor position, motor velocity there.
    Looked at are the ticks of the drive, counted from each SYNC on, and the row itself (60F4 at
    each drive tick). Between two rows the demand is straight and the motor a cubic Hermite
    polynomial, or straight where its way is the speed at one end times the step (an axis that
    follows its demand exactly); the polynomial is off by h^4 / 384 times the fourth derivative,
    some nm for 1 ms and a velocity loop of 60 Hz.
    """
    demand, motor, velocity = motion
    largest: Column = np.abs(demand - motor)
    span = np.diff(times_ns)
    if not len(span):
        return largest
    step_s = span * 1e-9
    mean = np.diff(motor) / np.maximum(step_s, 1e-9)
    rounding = _EXACT * np.maximum(np.abs(mean), 1e-3)
    straight = np.minimum(abs(mean - velocity[:-1]), abs(mean - velocity[1:])) <= rounding
    since = largest[1:].copy()
    for tick in range(1, -(-int(span.max()) // tick_ns)):
        inside = tick * tick_ns < span
        u = np.where(inside, tick * tick_ns / np.maximum(span, 1), 0.0)
        w = 1.0 - u
        reached = w * w * (1.0 + 2.0 * u) * motor[:-1] + u * u * (3.0 - 2.0 * u) * motor[1:]
        reached += step_s * u * w * (w * velocity[:-1] - u * velocity[1:])
        reached = np.where(straight, w * motor[:-1] + u * motor[1:], reached)
        lag = np.abs(w * demand[:-1] + u * demand[1:] - reached)
        since = np.where(inside, np.maximum(since, lag), since)
    largest[1:] = since
    return largest
