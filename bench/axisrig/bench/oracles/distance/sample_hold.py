"""Stability of a loop whose sensor value comes with every N-th SYNC only and is held in between.

Such a loop changes its law from cycle to cycle, so that it has no characteristic polynomial; its
cycles over one period of N are multiplied (Floquet): what is left of the state after N cycles is
M x, and the loop is stable when no eigenvalue of M is on or outside the unit circle. The law of
each cycle is that of `loop`.
"""

import math
from dataclasses import dataclass

import numpy as np

from axisrig.bench.oracles.distance.loop import BOTH, SET_POS, Loop
from axisrig.bench.oracles.distance.smoothing import Polynomial, Smoothing

_SEARCH_MAX, _COARSE, _CLOSE = 20.0, 200, 1e-9
_EDGE = 1.0 - 1e-12


class _Filter:
    """b(q)/a(q) on linear functions of the state; a value is the row of its coefficients."""

    def __init__(self, smoothing: Smoothing) -> None:
        self.above, self.below = smoothing.numerator, smoothing.denominator
        self.inputs = len(self.above) - 1
        self.outputs = len(self.below) - 1
        self.past_in: list[Polynomial] = []
        self.past_out: list[Polynomial] = []

    def step(self, value: Polynomial) -> Polynomial:
        """Take one value, return the filtered one."""
        answer: Polynomial = self.above[0] * value
        for weight, past in zip(self.above[1:], self.past_in, strict=True):
            answer = answer + weight * past
        for weight, past in zip(self.below[1:], self.past_out, strict=True):
            answer = answer - weight * past
        answer = answer / self.below[0]
        self.past_in = [value, *self.past_in][: self.inputs]
        self.past_out = [answer, *self.past_out][: self.outputs]
        return answer


@dataclass
class _State:
    """Everything that one cycle hands to the next, each a linear function of the state at first."""

    offsets: list[Polynomial]
    positions: list[Polynomial]
    held: Polynomial
    total: Polynomial
    before: Polynomial
    smoothing: _Filter
    drive: _Filter

    def rows(self) -> list[Polynomial]:
        """All of it, in a fixed order."""
        filters = (self.smoothing, self.drive)
        past = [row for f in filters for row in (*f.past_in, *f.past_out)]
        return [*self.offsets, *self.positions, self.held, self.total, self.before, *past]


def _start(loop: Loop) -> _State:
    smoothing, drive = _Filter(loop.smoothing), _Filter(loop.drive)
    kept = max(loop.dead_cycles, loop.sent_cycles) + 1
    filters = smoothing.inputs + smoothing.outputs + drive.inputs + drive.outputs
    positions = max(loop.skew_cycles, -loop.skew_cycles)
    rows = iter(np.eye(kept + positions + 3 + filters))

    def some(count: int) -> list[Polynomial]:
        return [next(rows) for _ in range(count)]

    state = _State(
        some(kept), some(positions), next(rows), next(rows), next(rows), smoothing, drive
    )
    for part in (smoothing, drive):
        part.past_in, part.past_out = some(part.inputs), some(part.outputs)
    return state


def _walk(loop: Loop, kp: float, state: _State, *, is_fresh: bool) -> None:
    """One cycle over a level surface; is_fresh: a sensor value has come."""
    ahead = max(-loop.skew_cycles, 0)  # a sensor value that is newer than the position
    newest = state.drive.step(state.offsets[loop.dead_cycles - ahead])
    kept = len(state.positions)
    state.positions = [newest, *state.positions]
    position = state.positions[ahead]
    if is_fresh:
        state.held = loop.sign * state.positions[ahead + loop.skew_cycles]
    state.positions = state.positions[:kept]
    if loop.mode == SET_POS:
        seen = state.smoothing.step(position - state.held)
        error = seen - state.offsets[0]
    elif loop.mode == BOTH:
        sent = state.offsets[loop.sent_cycles]
        error = seen = -state.smoothing.step(state.held - position + sent)
    else:
        error = seen = -state.smoothing.step(state.held)
    looked_at = error if loop.of_error else seen
    state.total = state.total + error
    step = error + loop.integral * state.total + loop.derivative * (looked_at - state.before)
    state.before = looked_at
    state.offsets = [state.offsets[0] + kp * step, *state.offsets][: len(state.offsets)]


def held_growth(loop: Loop, every: int, kp: float) -> float:
    """Return what is left of an error after one cycle, on average over `every` cycles."""
    state = _start(loop)
    for cycle in range(every):
        _walk(loop, kp, state, is_fresh=cycle == 0)
    rows = np.array(state.rows())
    if not loop.integral:  # the sum of errors comes back nowhere
        place = len(state.offsets) + len(state.positions) + 1
        rows = np.delete(np.delete(rows, place, 0), place, 1)
    largest = float(np.max(np.abs(np.linalg.eigvals(rows))))
    return math.pow(largest, 1.0 / every)


def held_limit(loop: Loop, every: int) -> float:
    """Return the smallest kp at which the loop is no longer stable; 0.0 where none is stable.

    Searched up to 20; inf where none is found.
    """
    low, high = 1e-3, float("inf")
    if held_growth(loop, every, low) >= _EDGE:
        return 0.0
    for kp in np.linspace(0.0, _SEARCH_MAX, _COARSE + 1)[1:]:
        if held_growth(loop, every, float(kp)) >= _EDGE:
            high = float(kp)
            break
        low = float(kp)
    while high - low > _CLOSE * high and high < float("inf"):
        middle = 0.5 * (low + high)
        if held_growth(loop, every, middle) >= _EDGE:
            high = middle
        else:
            low = middle
    return high
