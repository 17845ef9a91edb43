"""References of the second encoder and of the terminal with its stamps; whole numbers of Python."""

from collections.abc import Mapping, Sequence

import numpy as np
from edges import Vector, last_edge, sine_edges, uniform, within
from paths import cubic


def stamps(
    edges: Sequence[float], multiplier: int, seed: int, jitter: float, error: float, start_ns: int
) -> list[int]:
    """Stamps in whole nanoseconds of the reference clock; exact integers."""
    numbers = uniform(multiplier, seed, len(edges))
    return [
        start_ns + round((t + error + jitter * (2 * u - 1)) * 1e9)
        for t, u in zip(edges, numbers, strict=True)
    ]


def held(edges: Sequence[float], values: Sequence[int], before: int, time_s: Vector) -> list[int]:
    """The last value at each instant."""
    places = np.searchsorted(np.array(edges), time_s, side="right")
    return [values[k - 1] if k else before for k in places]


def edge_stamp(time_s: Vector) -> Mapping[str, Vector]:
    """Stamps across the end of a second and several wraps of 32 bits."""
    edges = [t for t, up in sine_edges(25.13, 0.3, float(time_s[-1])) if up]
    start = 846000003 * 10**9 + 999900000
    last = held(edges, stamps(edges, 16807, 4711, 1.7e-6, -2.3e-6, start), start, time_s)
    all_first = stamps(edges, 48271, 4711, 1e-6, 4e-6, 0)
    rearmed = next(k for k, t in enumerate(edges) if t > 4.01)
    first = held([edges[0], edges[rearmed]], [all_first[0], all_first[rearmed]], 0, time_s)
    return {
        "count": np.searchsorted(np.array(edges), time_s, side="right").astype(float),
        "seconds": np.array([float(value // 10**9) for value in last]),
        "nanoseconds": np.array([float(value % 10**9) for value in last]),
        "low_word": np.array([float(value % 2**32) for value in last]),
        "first_nanoseconds": np.array([float(value % 10**9) for value in first]),
    }


def digital_input(time_s: Vector) -> Mapping[str, Vector]:
    """A pulse that passes the filter, and one that does not."""
    rise, fall, rest = 3e-6, 70e-6, 200e-6
    up, down = 0.01004 + rise + rest, 0.02005 + fall + rest
    start = 846000003 * 10**9 + 999000000
    (rising,) = stamps([up], 16807, 3, 0.4e-6, 0.9e-6, start)
    (falling,) = stamps([down], 48271, 3, 0.4e-6, 0.9e-6, start)
    rising_stamp = held([up], [rising], start, time_s)
    falling_stamp = held([down], [falling], start, time_s)
    return {
        "level": within([(up, down)], time_s),
        "rising_nanoseconds": np.array([float(v % 10**9) for v in rising_stamp]),
        "falling_nanoseconds": np.array([float(v % 10**9) for v in falling_stamp]),
        "falling_seconds": np.array([float(v // 10**9) for v in falling_stamp]),
        "falling_count": (time_s >= down).astype(float),
        "falling_low_word": np.array([float(v % 2**32) for v in falling_stamp]),
    }


def second_encoder(time_s: Vector) -> Mapping[str, Vector]:
    """A scale that has grown by 30 um/m, with a periodic error; whole counts of 50 nm."""
    x = cubic(0.01, 2e-3, 0.0101, -1e-3, 1.0)
    scaled = 0.2 + 1.00003 * x(time_s)
    reading = scaled + 0.15e-6 * np.sin(2 * np.pi * scaled / 20e-6 + 0.7)
    slope = 1 + 0.15e-6 * 2 * np.pi / 20e-6 * np.cos(2 * np.pi * scaled / 20e-6 + 0.7)
    return {
        "position": 50e-9 * np.rint(reading / 50e-9),
        "velocity": 1.00003 * x.deriv()(time_s) * slope,
    }


def position_switch(time_s: Vector) -> Mapping[str, Vector]:
    """A cam from 5 to 15 mm that lets go 1 mm outside; the way is 0.2 t - 0.5 t2, up to 20 mm.

    Places are passed at t = 0.2 -+ sqrt(0.04 - 2 x).
    """
    places = {"close": 5e-3, "leave": 16e-3, "enter": 15e-3, "open": 4e-3}
    back = {name: 0.2 + np.sqrt(0.04 - 2 * x) for name, x in places.items()}
    up = {name: 0.4 - t for name, t in back.items()}
    spans = [(up["close"], up["leave"]), (back["enter"], back["open"])]
    edges = [(t, to) for span in spans for t, to in zip(span, (True, False), strict=True)]
    x = 0.2 * time_s - 0.5 * time_s**2
    ends = np.array(sorted(places.values()))
    return {
        "signal": within(spans, time_s),
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
        "clearance": np.abs(x[:, None] - ends).min(axis=1),
    }
