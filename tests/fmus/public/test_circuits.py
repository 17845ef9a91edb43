"""Circuits from components with connectors, against circuit analysis by hand."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import lambertw


def rc(t, _):
    charged = 1 - np.exp(-np.maximum(t - 0.1, 0) / 0.1)
    current = np.where(t < 0.1, 0, 5 / 1000 * np.exp(-np.maximum(t - 0.1, 0) / 0.1))
    return {"vc": 5 * charged, "i": current}


def rlc(t, solve):
    def f(t, s):
        i, v = s
        return [(10 * np.sin(10 * np.pi * t) - 2 * i - v) / 0.1, i / 1e-2]

    return dict(zip(("i", "vc"), solve.smooth(f, [0, 0], t), strict=True))


def bridge(t, _):
    """Nodes a (r1, r3, r5), b (r2, r4, r5); source 3 V above ground."""
    g1, g2, g3, g4, g5 = 1 / np.array([100, 220, 330, 470, 50])
    u = 3 * np.sin(2 * np.pi * t)
    a, b = np.linalg.solve([[g1 + g3 + g5, -g5], [-g5, g2 + g4 + g5]], [g1 * u, g2 * u])
    return {"i5": (a - b) * g5, "i": (u - a) * g1 + (u - b) * g2}


def clipper(t, _):
    def voltage(u):
        return brentq(lambda v: (u - v) / 1000 - 1e-9 * (np.exp(v / 0.04) - 1), -3, 3, xtol=1e-15)

    u = 2 * np.sin(2 * np.pi * t)
    v = np.array([voltage(value) for value in u])
    return {"vd": v, "id": (u - v) / 1000}


def rectifier(t, solve):
    """Current of diode and resistor in closed form by Lambert's W."""

    def f(t, v):
        u = 10 * np.sin(100 * np.pi * t) - v[0] + 1e-8
        current = 0.04 / 10 * lambertw(1e-9 * 10 / 0.04 * np.exp(u / 0.04)).real - 1e-9
        return [(current - v[0] / 1000) / 1e-4]

    return {"vc": solve.smooth(f, [0], t, method="Radau", rtol=1e-10, atol=1e-12, max_step=1e-4)[0]}


def chua(t, solve):
    def resistor(v):
        return -0.409091 * v + 0.5 * (-0.757576 + 0.409091) * (abs(v + 1) - abs(v - 1))

    def f(_, s):
        v1, v2, i = s
        through = 0.565 * (v2 - v1)
        return [(through - resistor(v1)) / 10, (-through - i) / 100, (v2 - 12.5e-3 * i) / 18]

    y = solve.smooth(f, [4, 0, 0], t, max_step=0.05)
    return dict(zip(("v1", "v2", "iL"), y, strict=True))


def ladder(t, solve):
    a = -2 * np.eye(5) + np.eye(5, k=1) + np.eye(5, k=-1)
    a[-1, -1] = -1
    b = np.eye(5)[0]
    return {"v_last": solve.smooth(lambda _, v: (a @ v + b) / 0.1, np.zeros(5), t)[-1]}


# model, last instant, interval, internal step, tolerance, reference
CASES = [
    ("Circuits.RC", 1, 0.01, None, 1e-10, rc),
    ("Circuits.RLC", 1, 0.01, None, 1e-10, rlc),
    ("Circuits.Divider", 1, 0.01, None, 1e-13, lambda t, _: {"v": 2 * np.sin(2 * np.pi * t)}),
    ("Circuits.Bridge", 1, 0.01, None, 1e-13, bridge),
    ("Circuits.DiodeClipper", 1, 0.01, None, 1e-10, clipper),
    ("Circuits.Rectifier", 0.1, 0.001, 1e-5, 1e-6, rectifier),
    ("Circuits.Chua", 100, 1, 1e-3, 1e-7, chua),
    ("Circuits.Ladder", 3, 0.05, None, 1e-10, ladder),
    ("Circuits.ParallelCapacitors", 5, 0.1, None, 1e-10, lambda t, _: {"v": 1 - np.exp(-t / 3)}),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("model", "end_s", "interval_s", "step_s", "tolerance", "reference"),
    CASES,
    ids=[case[0] for case in CASES],
)
def test_circuit_follows_its_analysis(
    run, solve, model, end_s, interval_s, step_s, tolerance, reference
):
    t = np.arange(round(end_s / interval_s) + 1) * interval_s
    expected = reference(t, solve)
    found = run(model, t, list(expected), step_s)
    for name, values in expected.items():
        scale = max(1.0, np.max(np.abs(values)))
        # At t = 0.1 the step of the source falls onto an instant of communication.
        beside = np.abs(t - 0.1) > 1e-9 if model == "Circuits.RC" else np.full(len(t), True)
        np.testing.assert_allclose(
            found[name][beside], values[beside], rtol=0, atol=tolerance * scale, err_msg=name
        )
