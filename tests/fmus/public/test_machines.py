"""Machines that jump, stick, saturate and switch, against closed forms of each piece."""

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

G = 9.81


def bouncing_ball(t, _):
    """Flight k lasts 2 v_k / g with v_k = e^k sqrt(2 g)."""
    v0 = math.sqrt(2 * G)
    hits = [v0 / G]
    while hits[-1] < t[-1]:
        hits.append(hits[-1] + 2 * v0 * 0.8 ** len(hits) / G)
    h, v, n = [], [], []
    for s in t:
        k = int(np.searchsorted(hits, s, side="right"))
        since = s - (hits[k - 1] if k else 0.0)
        up = v0 * 0.8**k if k else 0.0
        h.append((0.0 if k else 1.0) + up * since - G * since**2 / 2)
        v.append(up - G * since)
        n.append(k)
    return {"h": np.array(h), "v": np.array(v), "bounces": np.array(n)}


def resting_ball(t, _):
    """Lies still: after infinitely many bounces at v0/g (1 + 2 e/(1 - e))."""
    return {"h": 0 * t}


def two_balls(t, _):
    """Equal elastic balls exchange velocities: each leaves in the other's place; walls reflect.

    The pair is symmetric about 1/2: they meet at 0.25, reach the walls at 0.75, and so on.
    """
    x2 = 0.75 + np.array(
        [-min(s % 1, 0.25) + np.clip(s % 1 - 0.25, 0, 0.5) - max(s % 1 - 0.75, 0) for s in t]
    )
    hits = np.floor(t - 0.25 + 1) + np.floor(t - 0.75 + 1)
    return {"x1": 1 - x2, "x2": x2, "hits": hits}


def stick_slip(t, solve):
    """Sticks on the belt until k x = 5, then slides with 3 until as fast as the belt again."""
    rates = {
        "stuck": lambda t, x: [0.1, 0.0],
        "slips": lambda t, x: [x[1], 3 - 100 * x[0]],
    }
    guards = {
        "stuck": [(lambda t, x: 100 * x[0] - 5, lambda t, x: ("slips", x))],
        "slips": [(lambda t, x: x[1] - 0.1, lambda t, x: ("stuck", [x[0], 0.1]))],
    }
    states, modes, jumps = solve.hybrid(rates, guards, "stuck", [0, 0.1], t)
    slips = np.searchsorted(jumps[::2], t)
    return {"x": states[0], "stuck": np.array(modes) == "stuck", "slips": slips}


def coulomb_block(t, _):
    """Slides with mu g until t = 2/(mu g), then rests."""
    a = 0.2 * G
    moving = np.minimum(t, 2 / a)
    return {"x": 2 * moving - a * moving**2 / 2, "v": 2 - a * moving}


def emptying(t, _):
    """sqrt(h) falls with k/2 until h = 1e-6."""
    end = (1 - 1e-3) / 0.1
    return {"h": (1 - 0.1 * np.minimum(t, end)) ** 2, "empty": t > end}


def relay(t, solve):
    """x + v passes the other side of the band after each switch."""
    rates = {u: lambda t, x, u=u: [x[1], u] for u in (-1, 1)}
    guards = {
        -1: [(lambda t, x: -0.1 - x[0] - x[1], lambda t, x: (1, x))],
        1: [(lambda t, x: x[0] + x[1] - 0.1, lambda t, x: (-1, x))],
    }
    states, modes, _ = solve.hybrid(rates, guards, -1, [1, 0], t)
    return {"x": states[0], "v": states[1], "u": np.array(modes)}


def cascade(t, solve):
    """Acceleration of 20 (v_ref - v) with v_ref = 10 (1 - x), held within 5."""

    def demand(x):
        return 20 * (10 * (1 - x[0]) - x[1])

    rates = {
        "wait": lambda t, x: [x[1], 20 * (-10 * x[0] - x[1])],
        "up": lambda t, x: [x[1], 5.0],
        "in": lambda t, x: [x[1], demand(x)],
        "down": lambda t, x: [x[1], -5.0],
    }
    guards = {
        "wait": [(lambda t, x: t - 0.2, lambda t, x: ("up", x))],
        "up": [(lambda t, x: 5 - demand(x), lambda t, x: ("in", x))],
        "in": [
            (lambda t, x: demand(x) - 5, lambda t, x: ("up", x)),
            (lambda t, x: -5 - demand(x), lambda t, x: ("down", x)),
        ],
        "down": [(lambda t, x: demand(x) + 5, lambda t, x: ("in", x))],
    }
    states, _, _ = solve.hybrid(rates, guards, "wait", [0, 0], t)
    return {"x": states[0], "v": states[1]}


def anti_windup(t, solve):
    """PI with kp 2, Ti 0.5; saturated at 1.2 from the start."""

    def raw(x):
        return 2 * (1 - x[0]) + x[1]

    def rate(u_of):
        def f(t, x):
            u = u_of(x)
            return [u - x[0], 4 * (1 - x[0]) + (u - raw(x)) / 0.1]

        return f

    rates = {"high": rate(lambda x: 1.2), "free": rate(raw)}
    guards = {
        "high": [(lambda t, x: 1.2 - raw(x), lambda t, x: ("free", x))],
        "free": [(lambda t, x: raw(x) - 1.2, lambda t, x: ("high", x))],
    }
    states, _, _ = solve.hybrid(rates, guards, "high", [0, 0], t)
    return {"x": states[0], "i": states[1]}


# model, last instant, interval, tolerance, reference
CASES = [
    ("Mechanics.BouncingBall", 3, 0.0303, 1e-8, bouncing_ball),
    ("Mechanics.TwoBalls", 5, 0.0303, 1e-9, two_balls),
    ("Mechanics.StickSlip", 5, 0.0303, 1e-9, stick_slip),
    ("Mechanics.CoulombBlock", 1.5, 0.0303, 1e-9, coulomb_block),
    ("Process.Emptying", 15, 0.101, 1e-8, emptying),
    ("Control.RelayControl", 10, 0.0303, 1e-8, relay),
    # min() and max() make no events: a kink of slope 540 m/s3 inside a step costs up to 540 h^2/2.
    ("Control.Cascade", 3, 0.0303, 7e-7, cascade),
    ("Control.CascadeWithEvents", 3, 0.0303, 1e-9, cascade),
    ("Control.AntiWindup", 5, 0.0303, 1e-9, anti_windup),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("model", "end_s", "interval_s", "tolerance", "reference"), CASES, ids=[c[0] for c in CASES]
)
def test_machine_moves_as_its_pieces(run, solve, model, end_s, interval_s, tolerance, reference):
    t = np.arange(round(end_s / interval_s) + 1) * interval_s
    expected = reference(t, solve)
    found = run(model, t, list(expected))
    for name, values in expected.items():
        np.testing.assert_allclose(
            found[name][1:], np.asarray(values, float)[1:], rtol=0, atol=tolerance, err_msg=name
        )


def test_ball_with_a_rest_lies_still_after_its_last_bounce(built, load):
    """Bounces end at sqrt(2/g) (1 + 2 e/(1 - e)) = 2.5586 s for e = 0.7; never below the floor."""
    plant = load(built("Mechanics.RestingBall"))
    plant.step(2.5)
    assert plant.flying
    plant.step(2.5)
    assert (plant.v, plant.flying) == (0, False)
    assert plant.h == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize("e", [0.1, 0.3, 0.5, 0.8, 0.9])
@pytest.mark.parametrize("size_s", [0.05, 1e-3, 50e-6])
def test_no_ball_falls_through_the_floor(built, load, e, size_s):
    """With a rest of its own it lies at the end; without it the pile is told, with the instant."""
    end_s = math.sqrt(2 / G) * (1 + 2 * e / (1 - e))
    resting = load(built("Mechanics.RestingBall"), e=e)
    piling = load(built("Faults.Zeno"), e=e)
    begin_s = (end_s - 0.02) // size_s * size_s if size_s < 0.05 else 0.0
    if begin_s > 0:
        resting.step(begin_s)
        piling.step(begin_s)
    steps = math.ceil((end_s + 0.02 - begin_s) / size_s)
    for _ in range(steps):
        resting.step(size_s)
    assert (resting.v, resting.flying) == (0, False)
    assert resting.h == pytest.approx(0, abs=1e-8)

    def run():
        for _ in range(steps):
            piling.step(size_s)

    with pytest.raises(FMICallException):
        run()
    answer = piling.messages[-1]
    assert "Faults/package.mo" in answer
    assert "without end at t = " in answer
    assert float(answer.split("t = ")[1].split()[0]) == pytest.approx(end_s, abs=5e-5)
