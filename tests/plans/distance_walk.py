"""A row of testplans/distance_control.csv walked cycle by cycle: laws, limits, way of the offset.

Nothing of the bench is imported. Lengths in mm.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from tests.plans.distance_law import BOTH, HEIGHT, SURFACE, Setup

Signal = npt.NDArray[np.float64]
GAP = 2.0  # at the start, in every rig with Z alone


@dataclass(frozen=True)
class Walk:
    """Distance, offset and sensor value at each SYNC; offset that was asked for, uncut."""

    gap: Signal
    offset: Signal
    sensor: Signal
    asked: Signal


def wanted(setup: Setup) -> float:
    """SET_POS or SET_DIST of the program."""
    return setup.number("plc:V.E.POS" if setup.mode == SURFACE else "plc:V.E.DIST")


def walk(setup: Setup, surface: Signal, positions: Signal | None = None) -> Walk:
    """Walk with the surface at each SYNC over the level; the axis stands 2 mm above it.

    positions: SET_POS or SET_DIST in each cycle, that of the program without them.
    """
    above, below = setup.filter
    period, count = setup.T, len(surface)
    if positions is None:
        positions = np.full(count, wanted(setup))
    v, a = setup.listed("v_max") * 1e-3 * period, setup.listed("a_max") * period**2
    most = setup.listed("max_deviation") * 1e-4
    start = HEIGHT + GAP
    sent, offsets, gaps = [start] * (count + 9), [0.0] * (count + 9), np.zeros(count)
    places = np.zeros(count)
    sensors, asked, made = np.zeros(count), np.zeros(count), np.zeros(count)
    inputs: list[float] = []
    outputs: list[float] = []
    offset = step = total = 0.0
    before: float | None = None
    lag = _Lag(start, setup.drive_lag, period)
    for k in range(count):
        # what was sent two cycles ago stands at this SYNC; `sent[k]` left in cycle k - 1
        places[k] = lag.to(sent[max(k - 1, 0)])
        gaps[k] = places[k] - HEIGHT - surface[k]
        actual = places[max(k - setup.late, 0)]
        seen = gaps[max(k - setup.late - setup.age, 0)]
        sensors[k] = -setup.sign * round(seen / setup.increment) * setup.increment
        asked_pos = float(positions[k])
        raw = actual + sensors[k] - asked_pos if setup.mode == SURFACE else -sensors[k]
        if setup.mode == BOTH:
            raw -= actual - sent[k]
        inputs = [raw, *(inputs or [raw] * len(above))][: len(above)]
        outputs = outputs or [raw] * (len(below) - 1)
        value = (float(above @ inputs) - float(below[1:] @ outputs)) / float(below[0])
        outputs = [value, *outputs][: len(below) - 1]
        error = value - offset if setup.mode == SURFACE else asked_pos - value
        looked_at = value if setup.mode == SURFACE else -value  # the feedback, as every row has it
        slope = 0.0 if before is None else looked_at - before
        before = looked_at
        delta = setup.kp * (error + setup.g * (total + error) + setup.r * slope)
        new = _clamped(setup, delta, step, error, v, a)
        asked[k] = offset + new
        reached = min(max(asked[k], -most), most)
        if abs(reached - offset - delta) < 1e-12:
            total += error
        step, offset = reached - offset, reached
        made[k] = offset
        offsets[k + 1] = offset
        out = offsets[k + 1] if setup.is_optimized else offsets[k]
        sent[k + 1] = start + out
    return Walk(gaps, made, sensors, asked)


def _clamped(setup: Setup, delta: float, step: float, error: float, v: float, a: float) -> float:
    """The step behind the clamps of speed and acceleration; only the way down is weighted."""
    if setup.listed("use_adaptive_acceleration"):
        low, high = (setup.listed(f"dist_error_a_{end}") * 1e-4 for end in ("min", "max"))
        least = setup.listed("a_min") * setup.T**2
        a = least + (a - least) * min(max((abs(error) - low) / (high - low), 0.0), 1.0)
    if not setup.is_clamped:
        delta = _sloped(delta, error, a)
    down_v = v * (setup.listed("v_weight_down") / 1000 or 1)
    down_a = a * (setup.listed("a_weight_down") / 1000 or 1)
    lowest = step - a if step >= a else min(step, 0.0) - down_a * (1 - max(step, 0.0) / a)
    return min(max(min(max(delta, -down_v), v), lowest), step + a)


def _sloped(delta: float, error: float, a: float) -> float:
    """A step towards the error: at most one of those that shrink by a and end there."""
    if delta * error <= 0.0 or abs(error) < 1e-9:
        return delta
    count, way = 1, a
    while way < abs(error):
        count += 1
        way += count * a
    most = abs(error) / count + a * (count - 1) / 2
    return math.copysign(min(abs(delta), most), delta)


class _Lag:
    """A drive of first order behind a demand that moves straight from SYNC to SYNC."""

    def __init__(self, place: float, lag: float, period: float) -> None:
        self._demand = self._place = place
        self._lag, self._period = lag, period

    def to(self, demand: float) -> float:
        """Return where it is when the demand has arrived."""
        late = (demand - self._demand) / self._period * self._lag
        rest = math.exp(-self._period / self._lag) if self._lag else 0.0
        self._place = demand - late + (self._place - self._demand + late) * rest
        self._demand = demand
        return self._place


def settled(walked: Walk, wanted_gap: float) -> tuple[int, float]:
    """Return cycles until the error stays within 1 % (5 um), and how far it went beyond."""
    behind = wanted_gap - walked.gap
    begin = int(np.argmax(np.abs(behind)))
    band = max(0.005, 0.01 * abs(float(behind[begin])))
    beyond = np.flatnonzero(np.abs(behind) > band)
    side = math.copysign(1.0, float(behind[begin]))
    return int(beyond[-1]) + 1 - begin, max(0.0, float(np.max(-side * behind[begin:])))


def alarm(setup: Setup, walked: Walk) -> tuple[int, int] | None:
    """Return ID of the older family and cycle of the first alarm."""
    change = setup.listed("max_act_value_change") * 1e-3 * setup.T
    tolerance = setup.listed("tolerance") * 1e-4
    high = setup.listed("max_pos") * 1e-4 - tolerance
    low = setup.listed("min_pos") * 1e-4 + tolerance
    most = setup.listed("max_deviation") * 1e-4
    steps = np.abs(np.diff(walked.sensor, prepend=walked.sensor[:1]))
    for k in range(len(walked.gap)):
        for number, is_due in (
            (70329, steps[k] > change + 1e-9),
            (70330, walked.sensor[k] > high + 1e-9),
            (70576, walked.sensor[k] < low - 1e-9),
            (70331, abs(walked.asked[k]) > most),
        ):
            if is_due:
                return number, k
    return None
