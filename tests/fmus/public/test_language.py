"""Constructs of the language against the mathematics they mean."""

import itertools
import math

import numpy as np
import pytest


def polynomial(t):
    c = np.array([1.0, -2, 3, -4])
    return {"value": np.polyval(c, t), "slope": np.polyval(np.polyder(c), t)}


def looked_up(t):
    return {"t": np.interp(t, [0, 1, 2, 4], [0, 10, 15, 5])}


def if_equations(t):
    x = 1 - np.exp(-t)
    return {"x": x, "y": np.where(t < 1, x, np.where(t < 2, 2 * x, -x))}


def inner_outer(t):
    return {"ha": 100 - 3.7 * t**2 / 2, "hb": 50 - 3.7 * t**2 / 2}


def chain(t):
    """w = 2, x0 = 1/2: x = (cos 2t - sin 2t) / 2."""
    return {"x": 0.5 * np.cos(2 * t) - 0.5 * np.sin(2 * t)}


def records(t):
    return {"distance": np.hypot(np.cos(t) - 2, np.sin(t) - 3), "x": np.cos(t)}


def steady(t):
    """6 until t = 1, then towards 8 with 2 s."""
    return {"x": np.where(t < 1, 6.0, 8 - 2 * np.exp(-0.5 * np.maximum(t - 1, 0)))}


def initial_values(t):
    return {"x": 2 + t, "y": 8 + 2 * t + t**2 / 2, "d": 28.0 * (t < 1)}


def rounding(t):
    u = 3 * np.sin(t)
    x = np.zeros(len(t))
    for i, end in enumerate(t):
        x[i] = floor_integral(end)
    return {
        "f": np.floor(u),
        "c": np.ceil(u),
        "i": np.floor(u + 0.5),
        "s": np.sign(u),
        "m": u - 1.25 * np.floor(u / 1.25),
        "r": u - 1.25 * np.trunc(u / 1.25),
        "x": x,
    }


def floor_integral(end):
    """Integral of floor(3 sin t) by its pieces."""
    levels = [math.asin(k / 3) for k in range(-2, 3)] + [
        math.pi - math.asin(k / 3) for k in range(-2, 3)
    ]
    cuts = sorted(
        c
        for n in range(-1, 3)
        for a in [*levels, math.pi / 2, -math.pi / 2]
        if 0 < (c := a + 2 * math.pi * n) < end
    )
    points = [0.0, *cuts, end]
    return sum(
        (b - a) * math.floor(3 * math.sin((a + b) / 2)) for a, b in itertools.pairwise(points)
    )


def abs_integral(t):
    """Integral of |cos 3t|: 2/3 for each half wave of pi/3, and of its sign."""
    s = 3 * np.asarray(t)
    half = np.floor(s / np.pi + 0.5)
    rest = s - half * np.pi
    triangle = np.arcsin(np.sin(s))
    return {"x": (2 * half + np.sin(rest)) / 3, "y": triangle / 3}


def table(t):
    return {"y": np.interp(2 + 2 * np.sin(t), [0, 1, 2, 4], [0, 10, 15, 5])}


def arrays(t):
    return {
        "s": 9 * t,
        "p": 24 * t**4,
        "dot": t * sum(k * np.sin(k * t) for k in range(1, 5)),
        "biggest": np.max([np.sin(k * t) for k in range(1, 5)], axis=0),
        "trace": 3 + 0 * t,
        "second": 2 - t,
    }


def special(t):
    return {
        "a": np.arctan2(np.sin(t), np.cos(t)),
        "b": np.exp(t) + np.tanh(t),
        "c": np.log(1 + t) + np.log(1 + t) / np.log(10),
        "d": np.arcsin(0.9 * np.sin(t)) + np.arccos(0.9 * np.cos(t)),
        "e": (1 + t) ** 2 * np.sqrt(1 + t) + 2**t + t**3,
        "f": np.exp(-t) * np.tan(0.5 * t),
    }


def clipped(t):
    """Integral of |clip(sin)|: 1 - cos up to pi/6, then 1/2 per second, symmetric in pi/2."""
    area = []
    quarter = (1 - math.cos(math.pi / 6)) + 0.5 * math.pi / 3
    for s in t:
        n, rest = divmod(s, math.pi)
        up = min(rest, math.pi - rest)
        part = 1 - math.cos(min(up, math.pi / 6)) + 0.5 * max(up - math.pi / 6, 0)
        area.append(2 * quarter * n + (part if rest <= math.pi / 2 else 2 * quarter - part))
    return {"y": np.clip(np.sin(t), -0.5, 0.5), "area": np.array(area)}


def saturated(t):
    """e = 2 sin t - y(e): three straight pieces."""
    u = 2 * np.sin(t)
    e = np.where(u > 1, (u - 0.45) / 1.1, np.where(u < -1, (u + 0.45) / 1.1, u / 2))
    return {"y": u - e}


def cubic(t):
    """Cardano's formula of y^3 + y = u, in the form by hyperbolic functions."""
    u = 2 * np.sin(t)
    return {"y": 2 / np.sqrt(3) * np.sinh(np.arcsinh(1.5 * np.sqrt(3) * u) / 3)}


def sampled_pi(t):
    """Exact sampling of x' = -x + u: x+ = a x + (1 - a) u."""
    x, u, total, values, now = 0.0, 0.0, 0.0, [], 0
    for s in t:
        while now * 0.1 <= s + 1e-12:
            if now:
                x = math.exp(-0.1) * x + (1 - math.exp(-0.1)) * u
            total += 0.1 * (1 - x)
            u = 2 * (1 - x) + 1.5 * total
            now += 1
        rest = s - (now - 1) * 0.1
        values.append((u + (x - u) * math.exp(-rest), u))
    return dict(zip(("x", "u"), np.array(values).T, strict=True))


def steps(t):
    return {"x": sum(np.maximum(t - k / 10, 0) for k in range(1, 5))}


# model, last instant, interval, tolerance, reference
CASES = [
    ("Language.Functions", 4, 0.0401, 1e-12, polynomial),
    ("Language.WhileFunction", 4, 0.0401, 1e-12, lambda t: {"root": np.sqrt(1 + t)}),
    ("Language.TableFunction", 3.9, 0.0401, 1e-12, looked_up),
    ("Language.IfEquations", 3, 0.0401, 1e-10, if_equations),
    ("Language.Records", 5, 0.05, 1e-10, records),
    ("Language.InnerOuter", 5, 0.05, 1e-11, inner_outer),
    ("Language.Plant", 5, 0.05, 1e-14, lambda t: {"y": 2 * np.sin(t)}),
    ("Language.Redeclared", 5, 0.05, 1e-14, lambda t: {"y": 5 * np.sin(t) ** 2}),
    ("Language.Conditional", 5, 0.05, 1e-14, lambda t: {"y": 20 * t}),
    ("Language.Base", 5, 0.05, 1e-11, lambda t: {"x": 3 * np.exp(-t)}),
    ("Language.Extended", 5, 0.05, 1e-11, lambda t: {"x": 9 * np.exp(-3 * t)}),
    ("Language.ParameterChain", 5, 0.05, 1e-11, chain),
    ("Language.ArrayOfComponents", 5, 0.05, 1e-14, lambda t: {"s": 14 * np.sin(t)}),
    ("Language.SteadyStart", 5, 0.0701, 1e-9, steady),
    ("Language.InitialValues", 3, 0.0701, 1e-11, initial_values),
    (
        "Language.NonlinearInitial",
        3,
        0.1,
        1e-9,
        lambda t: {"T": 0 * t + (500 / 5.67e-8 + 280**4) ** 0.25},
    ),
    ("Language.Rounding", 7, 0.0703, 2e-9, rounding),
    ("Language.AbsSign", 5, 0.0503, 1e-9, abs_integral),
    ("Language.TableByIf", 7, 0.05, 1e-12, table),
    ("Language.Arrays", 4, 0.05, 1e-13, arrays),
    ("Language.Special", 2.5, 0.05, 1e-13, special),
    ("Language.Scoped", 1, 0.1, 1e-15, lambda t: {"area": 0 * t + 4 * np.pi}),
    ("Language.Homotopy", 5, 0.1, 1e-15, lambda t: {"y": np.sin(t)}),
    (
        "Language.SemiLinear",
        9,
        0.1,
        1e-14,
        lambda t: {"y": np.sin(t) * np.where(np.sin(t) >= 0, 2, 5)},
    ),
    ("Control.Limiter", 9, 0.0503, 1e-9, clipped),
    ("Control.SmoothLimiter", 9, 0.0503, 1e-8, clipped),
    ("Control.Steps", 1, 0.01, 1e-9, steps),
    ("Control.AlgebraicFeedback", 5, 0.05, 1e-14, lambda t: {"y": 0.75 * np.sin(t)}),
    ("Control.SaturatedFeedback", 7, 0.05, 1e-12, saturated),
    ("Control.CubicLoop", 7, 0.05, 1e-12, cubic),
    (
        "Control.TwoUnknowns",
        3,
        0.05,
        1e-11,
        lambda t: {"x": (1 + t) / math.sqrt(1.25), "y": (1 + t) / math.sqrt(5)},
    ),
    ("Control.PIDSampled", 5, 0.0303, 1e-10, sampled_pi),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("model", "end_s", "interval_s", "tolerance", "reference"), CASES, ids=[c[0] for c in CASES]
)
def test_construct_means_what_the_language_says(
    run, model, end_s, interval_s, tolerance, reference
):
    t = np.arange(round(end_s / interval_s) + 1) * interval_s
    expected = reference(t)
    found = run(model, t, list(expected))
    for name, values in expected.items():
        scale = max(1.0, np.max(np.abs(values)))
        np.testing.assert_allclose(
            found[name][1:], values[1:], rtol=0, atol=tolerance * scale, err_msg=name
        )
