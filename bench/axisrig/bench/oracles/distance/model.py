"""The whole loop walked cycle by cycle: what closed forms cannot say.

Written from the laws in `loop` alone: sensor and position of each SYNC, filter, controller, limits,
output delay, a drive that follows its ramp exactly or with a lag of first order. Lengths in mm.
"""

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.limits import (
    adaptive_mm_s2,
    downwards,
    lowest_step_mm,
    stopping_step_mm,
)
from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import BOTH, SET_POS
from axisrig.bench.oracles.distance.smoothing import Smoothing, none
from axisrig.kernel.time.clock import S, TimeNs

Signal = npt.NDArray[np.float64]
NO_ERROR_MM = 1e-9
"""What is less is rounding and has no direction."""
UNLIMITED = Limits(math.inf, math.inf, math.inf, math.inf, -math.inf, math.inf)


class Filtering:
    """A linear filter sample by sample, filled with its first value."""

    def __init__(self, smoothing: Smoothing) -> None:
        self._above = [float(one) for one in smoothing.numerator]
        self._below = [float(one) for one in smoothing.denominator]
        self._inputs: deque[float] | None = None
        self._outputs: deque[float] = deque()

    def fill(self, value: float) -> None:
        """Begin as if nothing but this value had ever come."""
        self._inputs = deque([value] * len(self._above), maxlen=len(self._above))
        self._outputs = deque([value] * len(self._below), maxlen=len(self._below))

    def step(self, value: float) -> float:
        """Take one value, return the filtered one."""
        if self._inputs is None:
            self.fill(value)
        assert self._inputs is not None
        self._inputs.appendleft(value)
        answer = past = 0.0
        for b, x in zip(self._above, self._inputs, strict=True):
            answer += b * x
        for a, y in zip(self._below[1:], self._outputs, strict=False):
            past += a * y
        answer = (answer - past) / self._below[0]
        self._outputs.appendleft(answer)
        return answer


@dataclass
class Law:
    """The control of one axis from its start on.

    offset_mm: where it starts. step_mm: of the cycle before. asked_mm: the offset before
    max_deviation clamps it. override: of the axis, 1 = 100 %; v_max is scaled by it. axes: speed
    and acceleration that the axes of 3D control allow the offset, mm/s and mm/s2.
    """

    mode: str
    control: Control
    period_ns: TimeNs
    limits: Limits = UNLIMITED
    smoothing: Smoothing = field(default_factory=none)
    offset_mm: float = 0.0
    step_mm: float = 0.0
    error_mm: float = 0.0
    filtered_mm: float = 0.0
    asked_mm: float = 0.0
    override: float = 1.0
    axes: tuple[float, float] = (math.inf, math.inf)

    def __post_init__(self) -> None:
        self._filter = Filtering(self.smoothing)
        self._integral_mm, self._before_mm = 0.0, math.nan

    def walk(self, sensor_mm: float, actual_mm: float, sent_mm: float, set_mm: float) -> float:
        """Take what a cycle reads, return the offset that it computes.

        sensor_mm: counts against the motor. sent_mm: total set position sent in the cycle before.
        set_mm: SET_POS or SET_DIST.
        """
        self.listen(sensor_mm, actual_mm, sent_mm, set_mm)
        error = self.error_mm
        asked, integral = self._pid(error)
        step, is_limited = self._limited(asked, error)
        if not is_limited:
            self._integral_mm = integral
        self._before_mm = self._looked_at_mm()
        self.step_mm = step
        self.offset_mm += step
        return self.offset_mm

    def listen(self, sensor_mm: float, actual_mm: float, sent_mm: float, set_mm: float) -> None:
        """Take what a cycle reads without any motion, as in FREEZE: the filter goes on."""
        if self.mode == SET_POS:
            self.filtered_mm = self._filter.step(actual_mm + sensor_mm - set_mm)
            self.error_mm = self.filtered_mm - self.offset_mm
            return
        lag = actual_mm - sent_mm if self.mode == BOTH else 0.0
        self.filtered_mm = self._filter.step(-sensor_mm - lag)
        self.error_mm = set_mm - self.filtered_mm

    def hold(self, sensor_mm: float, actual_mm: float, sent_mm: float, set_mm: float) -> None:
        """Take what a cycle reads while feedhold or override of the axis hold the offset."""
        self.listen(sensor_mm, actual_mm, sent_mm, set_mm)
        self._before_mm = self._looked_at_mm()
        self.step_mm, self.asked_mm = 0.0, self.offset_mm

    def change(self, control: Control, smoothing: Smoothing) -> None:
        """Take other parameters while on; another filter begins with what the last one gave."""
        if not smoothing.is_same(self.smoothing):
            self._filter = Filtering(smoothing)
            self._filter.fill(self.filtered_mm)
        self.control, self.smoothing = control, smoothing

    def stand(self) -> None:
        """Begin to follow again: nothing in the sum, no error before, speed 0."""
        self._integral_mm, self._before_mm, self.step_mm = 0.0, math.nan, 0.0

    def _pid(self, error: float) -> tuple[float, float]:
        """Return what is asked for, and the I part with the error of this cycle.

        The I part is a sum of shares T/Tn, so that another Tn makes no step, and is none without Tn
        (docs/ambiguities.md).
        """
        control, looked_at = self.control, self._looked_at_mm()
        before = looked_at if math.isnan(self._before_mm) else self._before_mm
        share = error * control.integral(self.period_ns)
        integral = self._integral_mm + share if control.tn_s else 0.0
        rise = control.rate(self.period_ns) * (looked_at - before)
        return control.kp * (error + integral + rise), integral

    def _looked_at_mm(self) -> float:
        """Return what the derivative part takes the change of."""
        if self.control.looks_at_error:
            return self.error_mm
        return self.filtered_mm if self.mode == SET_POS else -self.filtered_mm

    def _limited(self, asked: float, error: float) -> tuple[float, bool]:
        limits, period_s = self.limits, self.period_ns / S
        v, a = min(limits.v_mm_s, self.axes[0]) * self.override, limits.a_mm_s2
        if limits.adaptive is not None:
            least, low, high = limits.adaptive
            a = adaptive_mm_s2(error, least, a, low, high)
        change = min(a, self.axes[1]) * period_s**2
        step = self._sloped(asked, error, change)
        step = min(max(step, -downwards(v, limits.v_weight) * period_s), v * period_s)
        if math.isfinite(change):
            least = lowest_step_mm(self.step_mm, change, limits.a_weight)
            step = min(max(step, least), self.step_mm + change)
        self.asked_mm = self.offset_mm + step
        reached = min(max(self.asked_mm, -limits.deviation_mm), limits.deviation_mm)
        step = reached - self.offset_mm
        return step, abs(step - asked) > 1e-12

    def _sloped(self, asked: float, error: float, change: float) -> float:
        """Hold a step towards the error so small that it can stop there."""
        is_towards = abs(error) >= NO_ERROR_MM and asked * error > 0.0
        if not self.control.is_sloped or not is_towards:
            return asked
        return math.copysign(min(abs(asked), stopping_step_mm(abs(error), change)), asked)


@dataclass(frozen=True)
class Course:
    """What the loop did, one value per cycle, shape (n,), mm: state at the SYNC and what the cycle
    made of it. gap_mm: tool above the surface at the SYNC. error_mm: before the update.
    asked_mm: the offset before max_deviation clamps it.
    """

    offset_mm: Signal
    step_mm: Signal
    error_mm: Signal
    actual_mm: Signal
    sensor_mm: Signal
    gap_mm: Signal
    asked_mm: Signal


@dataclass(frozen=True)
class Rig:
    """What is around the control.

    reaction_cycles: 0 with optimized scheduling, else 1. way_cycles: from sending to being reached
    at a SYNC whose position is read. skew_cycles: by how many cycles the sensor is older,
    below 0 = newer, less than way_cycles. lag_s: of the drive, first order. increment_mm: of the
    sensor, 0 = none. sign: -1 = the sensor counts the wrong way round.
    """

    reaction_cycles: int = 0
    way_cycles: int = 2
    skew_cycles: int = 0
    lag_s: float = 0.0
    increment_mm: float = 0.0
    sign: int = 1


def simulate(
    law: Law,
    rig: Rig,
    surface_mm: Signal,
    program_mm: float | Signal,
    set_mm: float | Signal,
    noise_mm: Signal | None = None,
) -> Course:
    """Walk a loop over a surface that is given at each SYNC, shape (n,).

    program_mm: interpolated positions; the axis is there at the start. noise_mm: added to the
    sensor.
    """
    count = len(surface_mm)
    program, wanted = np.broadcast_to(program_mm, count), np.broadcast_to(set_mm, count)
    first = float(program[0]) + law.offset_mm
    sent = deque([first] * (rig.way_cycles + 1), maxlen=rig.way_cycles + 1)
    waiting = deque([law.offset_mm] * (rig.reaction_cycles + 1), maxlen=rig.reaction_cycles + 1)
    follow = _Drive(first, rig.lag_s, law.period_ns / S)
    ahead = max(-rig.skew_cycles, 0)
    reached = deque([first] * (ahead + 1), maxlen=ahead + 1)
    gaps: deque[float] = deque(maxlen=max(rig.skew_cycles, 0) + 1)
    rows = np.zeros((count, 7))
    for k in range(count):
        # Reached at the SYNC of cycle k: what was sent way_cycles before; a newer sensor sees more
        reached.appendleft(follow.reach(sent[rig.way_cycles - 1 - ahead]))
        actual = reached[-1]
        gap = reached[0] - float(surface_mm[k])
        noisy = gap + (float(noise_mm[k]) if noise_mm is not None else 0.0)
        gaps.appendleft(noisy)
        given_mm = gaps[-1]
        if rig.increment_mm:
            given_mm = round(given_mm / rig.increment_mm) * rig.increment_mm
        sensor = -rig.sign * given_mm
        offset = law.walk(sensor, actual, sent[0], float(wanted[k]))
        waiting.appendleft(offset)
        sent.appendleft(float(program[k]) + waiting[-1])
        rows[k] = (offset, law.step_mm, law.error_mm, actual, sensor, gap, law.asked_mm)
    return Course(*rows.T)


class _Drive:
    """Follows a set position that moves straight from one SYNC to the next.

    First order: y' = (u - y)/tau; over a cycle with u straight from u0 to u1 exactly
    y = u1 - s tau + (y0 - u0 + s tau) exp(-T/tau), s = (u1 - u0)/T.
    """

    def __init__(self, position_mm: float, lag_s: float, period_s: float) -> None:
        self._demand = self._position = position_mm
        self._lag_s, self._period_s = lag_s, period_s

    def reach(self, demand_mm: float) -> float:
        """Return where the axis is at the end of a cycle that leads to a demand."""
        if self._lag_s == 0.0:
            self._position = demand_mm
        else:
            behind = (demand_mm - self._demand) / self._period_s * self._lag_s
            rest = math.exp(-self._period_s / self._lag_s)
            self._position = demand_mm - behind + (self._position - self._demand + behind) * rest
        self._demand = demand_mm
        return self._position


def first_order_drive(lag_s: float, period_ns: TimeNs) -> Smoothing:
    """Return the same drive as a transfer function in q, from demand to position at the SYNCs."""
    period_s = period_ns / S
    rest, part = math.exp(-period_s / lag_s), lag_s / period_s
    # y1 = rest y0 + (1 - part (1 - rest)) u1 + (part (1 - rest) - rest) u0
    new = 1.0 - part * (1.0 - rest)
    old = part * (1.0 - rest) - rest
    return Smoothing(f"lag {lag_s * 1e3:g} ms", np.array([new, old]), np.array([1.0, -rest]))
