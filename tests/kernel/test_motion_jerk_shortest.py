"""Paths with ramps take the shortest time: a linear program and a search find nothing faster."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize

from axisrig.kernel.motion.course import State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape

TRAPEZ, SIN2 = Shape.TRAPEZ, Shape.SIN2


def equal(a: float, ramp_s: float, shape: Shape = TRAPEZ) -> JerkSlope:
    return JerkSlope(a, ramp_s, ramp_s, shape)


def _feasible(
    steps: int, dt: float, state: State, length: float, v: float, a: float, j: float
) -> bool:
    """Whether any jerk, constant in each step, leads from a state to rest at the end.

    A linear program over the jerks alone: no structure of ramps is assumed.
    """
    k = np.arange(1, steps + 1)[:, None]
    i = np.arange(steps)[None, :]
    after = np.clip(k - i - 1, 0, None) * dt
    is_past = (k > i).astype(float)
    to_a = is_past * dt
    to_v = is_past * (dt * dt / 2 + after * dt)
    to_s = is_past * (dt**3 / 6 + after * dt * dt / 2 + after**2 * dt / 2)
    times = k[:, 0] * dt
    free_v = state.speed_mm_s + state.a_mm_s2 * times
    total = steps * dt
    free_s = state.speed_mm_s * total + state.a_mm_s2 * total**2 / 2
    upper = np.vstack([to_a, -to_a, to_v, -to_v])
    limits = np.concatenate(
        [
            np.full(steps, a - state.a_mm_s2),
            np.full(steps, a + state.a_mm_s2),
            v - free_v,
            free_v,
        ]
    )
    last = np.vstack([to_a[-1], to_v[-1], to_s[-1]])
    wanted = [-state.a_mm_s2, -free_v[-1], length - free_s]
    found = linprog(np.zeros(steps), upper, limits, last, wanted, bounds=(-j, j), method="highs")
    return bool(found.status == 0)


@pytest.mark.long
@pytest.mark.parametrize(
    ("length", "speed", "a0"),
    [
        (20.0, 0.0, 0.0),
        (2.0, 0.0, 0.0),
        (20.0, 40.0, 600.0),
        (3.3, 40.0, 200.0),  # just enough to stop
        (4.0, 60.0, -500.0),  # braking already, and there is room
        (2.45, 60.0, -800.0),
        (8.0, 21.0, -900.0),
    ],
)
def test_nothing_is_faster_by_a_linear_program(length: float, speed: float, a0: float) -> None:
    """Two steps less have no solution at all, three more have one; v 80, a 1000, j 20 000."""
    slope, state = equal(1000.0, 0.05), State(0.0, speed, a0)
    path = slope.rest(state, length, 80.0, slope)
    steps = 120
    dt = path.duration_s / steps
    limits = 80.0, 1000.0, 20_000.0
    assert path.end_mm == length
    assert not _feasible(steps - 2, dt, state, length, *limits)
    assert _feasible(steps + 3, dt, state, length, *limits)


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(
    st.tuples(*[st.floats(0.005, 0.08)] * 4),
    st.floats(300.0, 3000.0),
    st.floats(300.0, 3000.0),
    st.floats(0.5, 60.0),
    st.floats(20.0, 120.0),
)
def test_a_search_over_switching_times_finds_nothing_faster(
    times: tuple[float, float, float, float], a: float, d: float, length: float, feed: float
) -> None:
    """Seven durations between jerks of both signs, ramps of four different times."""
    t1, t2, t3, t4 = times
    up, down = JerkSlope(a, t1, t2), JerkSlope(d, t3, t4)
    path = up.plan(length, feed, down)
    j = np.array([a / t1, 0.0, -a / t2, 0.0, -d / t3, 0.0, d / t4])

    def run(durations: np.ndarray) -> np.ndarray:
        s = v = acc = peak_v = peak_a = low_a = mid_a = 0.0
        for index, (jerk, t) in enumerate(zip(j, durations, strict=True)):
            s += v * t + acc * t * t / 2 + jerk * t**3 / 6
            v += acc * t + jerk * t * t / 2
            acc += jerk * t
            if index == 0:
                peak_a = acc
            if index == 2:
                mid_a, peak_v = acc, v
            if index == 4:
                low_a = acc
        return np.array([s, v, acc, peak_v, peak_a, low_a, mid_a])

    scale = path.duration_s
    found = []
    for guess in (np.full(7, 1 / 7), np.array([1, 3, 1, 5, 1, 3, 1]) / 15.0):
        solved = minimize(
            np.sum,
            guess,
            method="SLSQP",
            bounds=[(0.0, 2.0)] * 7,
            constraints=[
                {
                    "type": "eq",
                    "fun": lambda x: (
                        run(x * scale)[[0, 1, 2, 6]] / np.array([length, feed, a, a])
                        - np.array([1.0, 0.0, 0.0, 0.0])
                    ),
                },
                {
                    "type": "ineq",
                    "fun": lambda x: np.array(
                        [
                            1 - run(x * scale)[3] / feed,
                            1 - run(x * scale)[4] / a,
                            1 + run(x * scale)[5] / d,
                        ]
                    ),
                },
            ],
            options={"ftol": 1e-12, "maxiter": 400},
        )
        error = np.abs(run(solved.x * scale)[[0, 1, 2, 6]] / np.array([length, feed, a, a]))
        error[0] = abs(run(solved.x * scale)[0] / length - 1.0)
        if solved.success and np.max(error) < 1e-7:
            found.append(float(solved.fun))
    assume(found)
    assert min(found) >= 1.0 - 1e-6
