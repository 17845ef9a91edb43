"""Where an axis has met its stop, located inside a cycle from the plant's truth."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kernel.cosim.axis import hermite

Signal = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

# Largest error of the cubic Hermite polynomial over a step h when the third derivative changes by J
# anywhere inside: J h^3 / 192, reached for a change in the middle
JERK_SHARE = 1.0 / 192.0
HALVINGS = 60


@dataclass(frozen=True)
class StopContact:
    """The gap closes at `time_ns`; row: of the trace before it.

    position_mm: of the stop then. speed_mm_s: into the stop, positive, at that row; against the
    stop where that moves. uncertainty_ns: how well the instant is known.
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
) -> StopContact | None:
    """Return the first contact in a part of the trace; None when the gap never closes in it.

    stiffness_per_mass: k/m of stop and axis, 1/s2, None where the plant does not tell them. The gap
    between two rows is a cubic Hermite polynomial; the force of the stop begins with a jump of the
    jerk, J = k v (1 + a v)/m with a v below 1, and the polynomial is off by at most J h^3/192.
    Where k/m is not known, the way that the axis would have gone on evenly tells how far off it is.
    """
    gap_mm = -penetrations(stop, position_mm)
    rate_mm_s = -stop.direction * (velocity_mm_s - stop.velocity_mm_s)
    closed = np.flatnonzero((gap_mm[:-1] > 0.0) & (gap_mm[1:] <= 0.0))
    if not len(closed):
        return None
    row = int(closed[0])
    step_s = float(times_ns[row + 1] - times_ns[row]) * 1e-9
    ends = (
        float(gap_mm[row]),
        float(rate_mm_s[row]),
        float(gap_mm[row + 1]),
        float(rate_mm_s[row + 1]),
    )
    since_s = _crossing_s(step_s, ends)
    speed_mm_s = max(-ends[1], 1e-9)
    if stiffness_per_mass is None:
        error_s = abs(since_s - ends[0] / speed_mm_s)
    else:
        error_s = JERK_SHARE * 2.0 * stiffness_per_mass * step_s**3
    share = since_s / step_s
    begin_mm, end_mm = stop.position_mm[row : row + 2]
    at_mm = begin_mm + share * (end_mm - begin_mm)
    return StopContact(
        time_ns=float(times_ns[row]) + since_s * 1e9,
        row=row,
        position_mm=float(at_mm),
        speed_mm_s=speed_mm_s,
        uncertainty_ns=min(error_s, step_s) * 1e9 + 1.0,
    )


def _crossing_s(step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Return when the polynomial falls to zero, by halving the step."""
    low, high = 0.0, step_s
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if hermite(middle, step_s, ends) > 0.0:
            low = middle
        else:
            high = middle
    return high
