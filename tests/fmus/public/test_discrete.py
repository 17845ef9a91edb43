"""Discrete variables, when-clauses and relations: whole numbers that must be exact.

Instants of communication lie beside the events, so that each value is known beyond doubt.
"""

import math

import numpy as np
import pytest

PI = math.pi


def crossings(t, instants):
    """How many of the instants lie before each t."""
    return np.searchsorted(np.sort(instants), t).astype(float)


def edges(t):
    up = math.asin(0.3) / 10 + 2 * PI / 10 * np.arange(200)
    down = (PI - math.asin(0.3)) / 10 + 2 * PI / 10 * np.arange(200)
    r, f = crossings(t, up), crossings(t, down)
    return {"rising": r, "falling": f, "changes": r + f}


def flip_flop(t):
    a = math.asin(0.9)
    set_, reset = a + 2 * PI * np.arange(50), PI + a + 2 * PI * np.arange(50)
    return {"q": crossings(t, set_) - crossings(t, reset)}


def binary_counter(t):
    """The clock rises at k pi/10; the first rise is no edge: sin(0) = 0 is not above 0, then is."""
    n = crossings(t, 2 * PI / 20 * np.arange(0, 200))
    # b1 toggles where b0 falls, b2 where b1 falls.
    return {"value": n % 8, "b0": n % 2, "b1": n // 2 % 2, "b2": n // 4 % 2}


def debounce(t):
    return {"clean": (t > 0.14) & (t < 0.52), "n": (t > 0.14) * 1.0 + (t > 0.52)}


def traffic(t):
    phase = np.mod(t, 9)
    return {"state": 1 + (phase > 3) * 1.0 + (phase > 4) + (phase > 8)}


def simultaneous(t):
    """a falls and b rises through zero at pi/3, pi, ..."""
    down = PI / 3 + 2 * PI / 3 * np.arange(30)
    third = np.mod(t, 2 * PI / 3)
    n = crossings(t, down)
    x = np.where(third < PI / 3, third, 2 * PI / 3 - third)
    return {"na": n, "nb": n, "together": n, "x": x}


def cascade(t):
    return {"a": t > 0.5, "b": t > 0.5, "c": t > 0.5, "d": t > 0.5, "t_d": 0.5 * (t > 0.5)}


def same_instant(t):
    """After 0.5: a = 1, c = 2, b = 12, s = 0.5, w = 2."""
    on = t > 0.5
    return {
        "a": on,
        "c": 2 * on,
        "b": 12 * on,
        "d": 13 * on,
        "s": np.where(on, 0.5, -1),
        "w": np.where(on, 2, -1),
    }


def shift_register(t):
    n = np.floor(t / 0.25)
    return {"n": n, "q1": n, "q2": np.maximum(n - 1, 0), "q3": np.maximum(n - 2, 0)}


def boolean_algebra(t):
    a, b, c = np.sin(t) > 0, np.sin(2 * t) > 0, np.cos(3 * t) < 0.2
    andor = a & b | ~c & (a | b)
    implies = ~a | b
    nested = ~(a == b) & np.where(c, a, ~b)
    word = andor + 2.0 * (a != b) + 4 * implies + 8 * nested
    return {"andor": andor, "xor_": a != b, "implies": implies, "nested": nested, "word": word}


def thermostat(t):
    """T tends to 45 while heated, to 5 else, with 100 s; it swings between 19 and 21."""
    up0 = 100 * math.log((45 - 15) / (45 - 21))
    down, up = 100 * math.log(16 / 14), 100 * math.log(26 / 24)
    off = up0 + (down + up) * np.arange(50)
    on = off + down
    heat = 1 - crossings(t, off) + crossings(t, on)
    last = np.array([max([0.0, *off[off < s], *on[on < s]]) for s in t])
    begin = np.where(last == 0, 15.0, np.where(heat == 1, 19.0, 21.0))
    goal = np.where(heat == 1, 45.0, 5.0)
    temperature = goal + (begin - goal) * np.exp(-(t - last) / 100)
    return {"T": temperature, "heat": heat, "switchings": crossings(t, off) + crossings(t, on)}


def hysteresis(t):
    on = PI / 6 + 2 * PI * np.arange(20)
    off = PI + PI / 6 + 2 * PI * np.arange(20)
    y = crossings(t, on) - crossings(t, off)
    t_on = [max([0.0, *on[on < s]]) for s in t]
    # `not y` holds from the start, so that its first edge is at the first fall.
    t_off = [max([0.0, *off[off < s]]) for s in t]
    return {"x": np.sin(t), "y": y, "t_on": np.array(t_on), "t_off": np.array(t_off)}


def reactor(t):
    """Fill to 0.8 in 8 s, heat by 40 at 8 per second, drain in 3.2 s."""
    phase = 1 + (t > 8) * 1.0 + (t > 13) + (t > 16.2)
    level = np.interp(t, [0, 8, 13, 16.2, 99], [0, 0.8, 0.8, 0, 0])
    temperature = np.interp(t, [0, 8, 13, 99], [20, 20, 60, 60])
    times = {"t_heat": 8 * (t > 8), "t_drain": 13 * (t > 13), "t_done": 16.2 * (t > 16.2)}
    return {"phase": phase, "level": level, "T": temperature, **times}


def pulse(t):
    k, inside = np.floor(t), np.mod(t, 1.0)
    high = inside < 0.3
    return {
        "high": high,
        "x": 0.3 * k + np.minimum(inside, 0.3),
        "n": 2 * k + (inside > 0.3),
        "next": np.where(high, k + 0.3, k + 1),
    }


def two_rates(t):
    def ticks(first, period):
        return np.floor((t - first) / period + 1) * (t >= first)

    return {"a": ticks(0.01, 0.02), "b": ticks(0.01, 0.03), "both": ticks(0.01, 0.06)}


def integers(t):
    a = np.floor(10 * t) - 5
    return {
        "a": a,
        "b": np.trunc(a / 3),
        "c": a - 3 * np.floor(a / 3),
        "d": a - 3 * np.trunc(a / 3),
        "e": np.abs(a),
    }


def generator(step, start, first, period):
    """Values of a recursion in exact whole numbers."""

    def values(t):
        seeds = [start]
        while len(seeds) < 10000:
            seeds.append(step(seeds[-1]))
        n = np.floor((t - first) / period + 1) * (t >= first)
        return {"seed": np.array([seeds[int(k)] for k in n], dtype=float)}

    return values


def enumeration(t):
    return {"mode": 1 + (t > 1) * 1.0 + (t > 2), "x": np.interp(t, [0, 1, 2, 9], [0, 0, 1, 22])}


# model, last instant, interval, reference
CASES = [
    ("Logic.Edges", 5, 0.0101, edges),
    ("Logic.FlipFlop", 20, 0.0503, flip_flop),
    ("Logic.BinaryCounter", 3, 0.0101, binary_counter),
    ("Logic.Debounce", 1, 0.00301, debounce),
    ("Logic.TrafficLight", 60, 0.1003, traffic),
    (
        "Logic.WhenElsewhen",
        3,
        0.0701,
        lambda t: {
            "first": (t > 1) + 2.0 * (t > 2),
            "second": 10.0 * (t > 1) + 20 * (t > 2),
        },
    ),
    ("Logic.Vector", 9, 0.0701, lambda t: {"n": crossings(t, [1, math.asin(0.99), 3, 7.7125])}),
    ("Logic.Simultaneous", 10, 0.0303, simultaneous),
    ("Logic.CascadeOfEvents", 1, 0.0701, cascade),
    ("Logic.SameInstant", 1, 0.0303, same_instant),
    ("Logic.ShiftRegister", 3, 0.0303, shift_register),
    ("Logic.BooleanAlgebra", 10, 0.0307, boolean_algebra),
    (
        "Logic.InitiallyTrue",
        20,
        0.0707,
        lambda t: {"n": crossings(t, PI * 1.5 + 2 * PI * np.arange(9))},
    ),
    ("Logic.InitialEvent", 1, 0.0701, lambda t: {"n": 1.0 + (t > 0.5), "t": 0.5 * (t > 0.5)}),
    ("Logic.Sequence", 20, 0.0701, lambda t: {"limit": 2.0 ** np.ceil(np.log2(np.maximum(t, 1)))}),
    ("Logic.TouchOnly", 1, 0.0701, lambda t: {"n": 0 * t}),
    ("Process.Thermostat", 200, 0.503, thermostat),
    ("Process.Hysteresis", 30, 0.0503, hysteresis),
    ("Process.Reactor", 20, 0.0503, reactor),
    ("Control.Pulse", 5, 0.0303, pulse),
    ("Control.TwoRates", 1, 0.00301, two_rates),
    ("Language.IntegerArithmetic", 1.2, 0.010703, integers),
    (
        "Language.Random",
        5,
        0.010703,
        generator(lambda s: 16807 * s % 2147483647, 12345, 0.01, 0.01),
    ),
    (
        "Language.SampledRandom",
        5,
        0.010703,
        generator(lambda s: (1664 * s + 1013) % 65536, 1, 0.005, 0.01),
    ),
    ("Language.Enumeration", 4, 0.0701, enumeration),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("model", "end_s", "interval_s", "reference"), CASES, ids=[case[0] for case in CASES]
)
def test_discrete_values_are_exact(run, model, end_s, interval_s, reference):
    # Index 0 is the start, where some references stand on an event.
    t = np.arange(round(end_s / interval_s) + 1) * interval_s
    expected = reference(t)
    found = run(model, t, list(expected))
    for name, values in expected.items():
        np.testing.assert_allclose(
            found[name][1:],
            np.asarray(values, dtype=float)[1:],
            rtol=0,
            atol=2e-9,
            err_msg=name,
        )
