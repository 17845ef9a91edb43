"""Where an axis has met its stop, located inside a cycle from the plant's truth."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.interpolation import cubic

Signal = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

# Largest error of the cubic Hermite polynomial over a step h when the third derivative changes by J
# anywhere inside: J h^3 / 192, reached for a change in the middle
JERK_SHARE = 1.0 / 192.0
HALVINGS = 60
# Rows before the contact whose steps give the acceleration of the free motion
ROWS_BEFORE = 2
LEAST_MM_S = 1e-9


@dataclass(frozen=True)
class StopContact:
    """The gap closes at `time_ns`; row: of the trace before it.

    position_mm: of the stop then. speed_mm_s: into the stop, positive, at that row; against the
    stop where that moves. uncertainty_ns: how exact the instant is.
    """

    time_ns: float
    row: int
    position_mm: float
    speed_mm_s: float
    uncertainty_ns: float


@dataclass(frozen=True)
class StopPath:
    """Where the stop is at each row of the trace. direction: 1 = it is met going upwards."""

    position_mm: Signal
    velocity_mm_s: Signal
    direction: int

    @classmethod
    def at_rest(cls, position_mm: float, direction: int, rows: int) -> "StopPath":
        """Return a stop that does not move."""
        return cls(np.full(rows, position_mm), np.zeros(rows), direction)


def penetrations(stop: StopPath, position_mm: Signal) -> Signal:
    """Return how far the axis is past the first touch at each row, negative before it."""
    return stop.direction * (position_mm - stop.position_mm)


def first_contact(
    times_ns: Times,
    position_mm: Signal,
    velocity_mm_s: Signal,
    stop: StopPath,
    stiffness_per_mass: float | None,
    peak_n: Signal | None = None,
) -> StopContact | None:
    """Return the first contact in a part of the trace; None when the gap never closes in it.

    stiffness_per_mass: k/m of stop and axis, 1/s2, None where the plant does not give them. peak_n:
    largest force at the stop since the row before, None where it is not given: by it a contact
    shows that lets go again before the next row. Of two ways to locate it the surer one counts:
    the free motion goes on as before (`_by_free_motion`), or the gap is a polynomial (`_by_bend`).
    """
    gap_mm = -penetrations(stop, position_mm)
    rate_mm_s = -stop.direction * (velocity_mm_s - stop.velocity_mm_s)
    meets = gap_mm[1:] <= 0.0
    if peak_n is not None:
        meets |= peak_n[1:] > 0.0
    met = np.flatnonzero((gap_mm[:-1] > 0.0) & meets)
    if not len(met):
        return None
    row = int(met[0])
    step_s = float(times_ns[row + 1] - times_ns[row]) * 1e-9
    before = slice(max(row - ROWS_BEFORE, 0), row + 1)
    located = [_by_free_motion(step_s, times_ns[before], gap_mm[before], rate_mm_s[before])]
    if gap_mm[row + 1] <= 0.0 and stiffness_per_mass is not None:
        ends = gap_mm[row], rate_mm_s[row], gap_mm[row + 1], rate_mm_s[row + 1]
        located.append(_by_bend(step_s, ends, stiffness_per_mass))
    since_s, error_s = min(located, key=lambda each: each[1])
    begin_mm, end_mm = stop.position_mm[row : row + 2]
    return StopContact(
        time_ns=float(times_ns[row]) + since_s * 1e9,
        row=row,
        position_mm=float(begin_mm + since_s / step_s * (end_mm - begin_mm)),
        speed_mm_s=max(-float(rate_mm_s[row]), LEAST_MM_S),
        uncertainty_ns=error_s * 1e9 + 1.0,
    )


def _by_free_motion(
    step_s: float, times_ns: Times, gap_mm: Signal, rate_mm_s: Signal
) -> tuple[float, float]:
    """Return when the gap closes if it goes on closing as in the last row, and the doubt, s.

    gap_mm, rate_mm_s: up to that row. In doubt is what the largest acceleration a of the steps
    before it can do: with it against the motion the gap g closes at 2g/(v + sqrt(v^2 - 2ag)). The
    whole step where that does not close it, or where there are no such steps.
    """
    way_mm, speed_mm_s = float(gap_mm[-1]), -float(rate_mm_s[-1])
    since_s = way_mm / max(speed_mm_s, LEAST_MM_S)
    if len(times_ns) <= ROWS_BEFORE or since_s > 2.0 * step_s:
        return min(since_s, step_s), step_s
    largest_mm_s2 = float(np.max(np.abs(np.diff(rate_mm_s) / (np.diff(times_ns) * 1e-9))))
    left = speed_mm_s**2 - 2.0 * largest_mm_s2 * way_mm
    if left < 0.0:
        return min(since_s, step_s), step_s
    error_s = 2.0 * way_mm / (speed_mm_s + math.sqrt(left)) - since_s
    return min(since_s, step_s), min(error_s + max(since_s - step_s, 0.0), step_s)


def _by_bend(
    step_s: float, ends: tuple[float, float, float, float], stiffness_per_mass: float
) -> tuple[float, float]:
    """Return when a cubic Hermite polynomial of the gap falls to zero, and the doubt, s.

    The force of the stop begins with a jump of the jerk, J = k v (1 + a v)/m with a v below 1; the
    polynomial is off by at most J h^3/192.
    """
    low, high = 0.0, step_s
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if cubic(middle, step_s, ends) > 0.0:
            low = middle
        else:
            high = middle
    return high, min(JERK_SHARE * 2.0 * stiffness_per_mass * step_s**3, step_s)
