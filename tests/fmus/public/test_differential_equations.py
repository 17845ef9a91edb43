"""Textbook differential equations against closed forms and tight solutions."""

import numpy as np
import pytest


def lotka_volterra(t, solve):
    def f(_, x):
        return [x[0] * (0.1 - 0.02 * x[1]), x[1] * (0.02 * x[0] - 0.4)]

    return dict(zip(("rabbits", "foxes"), solve.smooth(f, [10, 10], t), strict=True))


def lorenz(t, solve):
    def f(_, s):
        x, y, z = s
        return [10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z]

    return dict(zip("xyz", solve.smooth(f, [1, 1, 1], t), strict=True))


def van_der_pol(t, solve):
    y = solve.smooth(lambda _, s: [s[1], (1 - s[0] ** 2) * s[1] - s[0]], [2, 0], t)
    return {"x": y[0], "y": y[1]}


def duffing(t, solve):
    def f(t, s):
        return [s[1], 0.5 * np.cos(1.2 * t) - 0.3 * s[1] + s[0] - s[0] ** 3]

    return dict(zip("xv", solve.smooth(f, [1, 0], t), strict=True))


def brusselator(t, solve):
    def f(_, s):
        return [1 + s[0] ** 2 * s[1] - 4 * s[0], 3 * s[0] - s[0] ** 2 * s[1]]

    return dict(zip("XY", solve.smooth(f, [1.2, 3.1], t), strict=True))


def robertson(t, solve):
    def f(_, y):
        y3 = 1 - y[0] - y[1]
        a, b = 0.04 * y[0], 1e4 * y[1] * y3
        return [b - a, a - b - 3e7 * y[1] ** 2]

    y = solve.smooth(f, [1, 0], t, method="Radau", rtol=1e-11, atol=1e-15)
    return {"y1": y[0], "y2": y[1], "y3": 1 - y[0] - y[1]}


def pendulum(t, solve):
    phi, w = solve.smooth(lambda _, s: [s[1], -9.81 * np.sin(s[0])], [1, 0], t)
    # Energy gives the tension: m L w^2 = 2 m g (cos(phi) - cos(1)).
    force = 9.81 * (3 * np.cos(phi) - 2 * np.cos(1))
    return {"phi": phi, "w": w, "F": force, "x": np.sin(phi), "y": -np.cos(phi)}


def cartesian_pendulum(t, solve):
    phi0 = np.arctan2(0.6, 0.8)
    phi, _ = solve.smooth(lambda _, s: [s[1], -9.81 * np.sin(s[0])], [phi0, 0], t)
    return {"x": np.sin(phi), "y": -np.cos(phi)}


def quarter_car(t, solve):
    def f(t, s):
        zs, zu, vs, vu = s
        road = 0.05 * np.sin(10 * np.pi * (t - 0.5)) if 0.5 < t < 0.6 else 0.0
        force = 15000 * (zu - zs) + 1000 * (vu - vs)
        return [vs, vu, force / 250, (180000 * (road - zu) - force) / 40]

    parts = [t[t <= 0.5], t[(t > 0.5) & (t <= 0.6)], t[t > 0.6]]
    states, x = [], np.zeros(4)
    for begin, end, part in zip((0, 0.5, 0.6), (0.5, 0.6, t[-1]), parts, strict=True):

        def inner(s, x, b=begin, e=end):
            return f(min(max(s, b + 1e-15), e - 1e-15), x)

        grid = np.unique(np.concatenate(([begin], part, [end])))
        y = solve.smooth(inner, x, grid)
        states.append(y[:, np.isin(grid, part)])
        x = y[:, -1]
    return dict(zip(("zs", "zu", "vs", "vu"), np.hstack(states), strict=True))


def chain(t, solve):
    def f(_, s):
        x1, v1, x2, v2 = s
        f1 = 100 * (x1 - 1) + v1
        f2 = 50 * (x2 - x1 - 1) + 0.5 * (v2 - v1)
        return [v1, f2 - f1, v2, -f2 / 2]

    y = solve.smooth(f, [1.2, 0, 2, 0], t)
    return {"x1": y[0], "x2": y[2]}


def two_tanks(t, solve):
    def f(_, h):
        q12, q2 = 0.05 * np.sqrt(19.62 * h[0]), 0.04 * np.sqrt(19.62 * h[1])
        return [0.1 - q12, q12 - q2]

    return dict(zip(("h1", "h2"), solve.smooth(f, [1, 0.5], t), strict=True))


def smooth_friction(t, solve):
    y = solve.smooth(lambda _, s: [s[1], -1.962 * np.tanh(s[1] / 0.01)], [0, 2], t, max_step=1e-3)
    return dict(zip("xv", y, strict=True))


def rod(n, t, solve):
    def f(_, x):
        full = np.concatenate(([100.0], x, [20.0]))
        return 0.5 * (full[:-2] - 2 * full[1:-1] + full[2:])

    return solve.smooth(f, [20.0] * n, t)


def rod_scalar(t, solve):
    y = rod(8, t, solve)
    return {"middle": y[3], "mean": y.mean(axis=0)}


def implicit_derivative(t, solve):
    """x + ln x - ... : ln x + x^2/2 = 1/2 - t."""
    return {"x": solve.smooth(lambda _, x: -x / (1 + x**2), [1.0], t)[0]}


def coupled_derivatives(t, solve):
    inverse = np.linalg.inv([[2, 1], [1, 3]])
    return dict(zip("xy", solve.smooth(lambda _, s: -inverse @ s, [1.0, 0.0], t), strict=True))


def scalar_function(t, solve):
    return {"x": solve.smooth(lambda _, x: -x / (1 + x * x), [1.0], t)[0]}


def state_space(t, solve):
    a, b = np.array([[0, 1], [-4, -0.4]]), np.array([0, 1])
    y = solve.smooth(lambda t, x: a @ x + b * np.sin(3 * t), [0, 0], t)
    return {"out": y[0] + 0.5 * y[1] + 0.1 * np.sin(3 * t)}


def gears(t, solve):
    """Inertia 1 + 4/4 at the first shaft: 2 w' = sin t."""
    return {"w1": (1 - np.cos(t)) / 2}


def stiff_decay(t, _):
    """x' = -f (x - cos t), y' = x - y: forced parts, and what dies out with f and with 1.

    The fast mode forgets within microseconds, so that x is off by the error of one step.
    """
    f = 1e6
    a, b, c = f**2 / (1 + f**2), f / (1 + f**2), 1 / (1 + f**2)
    p, q, d = (a - b) / 2, (a + b) / 2, c / (1 - f)
    fast, slow = np.exp(-f * t), np.exp(-t)
    return {
        "x": a * np.cos(t) + b * np.sin(t) + c * fast,
        "y": p * np.cos(t) + q * np.sin(t) + d * fast - (p + d) * slow,
    }


# model, last instant, interval, tolerance, reference
CASES = [
    ("Classics.Dahlquist", 20, 0.5, 1e-12, lambda t, _: {"x": np.exp(-t)}),
    ("Classics.VanDerPol", 20, 0.1, 1e-9, van_der_pol),
    ("Classics.LotkaVolterra", 60, 0.5, 1e-9, lotka_volterra),
    ("Classics.Lorenz", 12, 0.1, 1e-7, lorenz),
    ("Classics.Duffing", 20, 0.1, 1e-9, duffing),
    ("Classics.Brusselator", 15, 0.1, 1e-9, brusselator),
    ("Classics.Robertson", 40, 0.5, 1e-9, robertson),
    ("Classics.Resonance", 30, 0.3, 1e-10, lambda t, _: {"x": t * np.sin(t) / 2}),
    # What a state may be off by in one step
    ("Classics.StiffDecay", 1, 0.05, 1e-9, stiff_decay),
    ("Mechanics.Pendulum", 5, 0.05, 1e-9, pendulum),
    ("Mechanics.CartesianPendulum", 0.5, 0.05, 1e-8, cartesian_pendulum),
    ("Mechanics.QuarterCar", 3, 0.03, 1e-10, quarter_car),
    ("Mechanics.MassSpringChain", 5, 0.05, 1e-10, chain),
    ("Mechanics.SmoothFriction", 1.5, 0.05, 1e-9, smooth_friction),
    ("Mechanics.Gears", 5, 0.1, 1e-10, gears),
    ("Process.TwoTanks", 60, 0.5, 1e-9, two_tanks),
    ("Process.HeatRodScalar", 20, 0.5, 1e-9, rod_scalar),
    ("Control.StateSpace", 10, 0.1, 1e-10, state_space),
    ("Language.ImplicitDerivative", 5, 0.1, 1e-11, implicit_derivative),
    ("Language.CoupledDerivatives", 5, 0.1, 1e-11, coupled_derivatives),
    ("Language.ScalarFunction", 5, 0.1, 1e-11, scalar_function),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("model", "end_s", "interval_s", "tolerance", "reference"), CASES, ids=[c[0] for c in CASES]
)
def test_solution_is_that_of_the_equations(
    run, solve, model, end_s, interval_s, tolerance, reference
):
    t = np.arange(round(end_s / interval_s) + 1) * interval_s
    expected = reference(t, solve)
    found = run(model, t, list(expected))
    for name, values in expected.items():
        scale = max(1.0, np.max(np.abs(values)))
        np.testing.assert_allclose(
            found[name], values, rtol=0, atol=tolerance * scale, err_msg=name
        )
