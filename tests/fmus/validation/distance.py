"""References of the distance sensor: integrals over the electrode, filters, noise."""

from collections.abc import Callable, Mapping

import numpy as np
from edges import MODULUS, Vector, last_edge, within
from numpy.polynomial import Chebyshev
from paths import crossings, cubic
from scipy.integrate import quad, solve_ivp
from scipy.signal import StateSpace, lsim
from workpieces import moved, ramp_between, sampled, swayed


def normal_numbers(seed: int, count: int) -> Vector:
    """Box and Muller from two congruential sequences.

    State k of a sequence is a^k times its first one modulo 2^31 - 1, by powers of integers.
    """
    radius = 1 + 742938285 * seed % (MODULUS - 1)
    angle = 1 + 950706376 * seed % (MODULUS - 1)
    k = range(1, count + 1)
    u = np.array([pow(16807, n, MODULUS) * radius % MODULUS / MODULUS for n in k])
    v = np.array([pow(48271, n, MODULUS) * angle % MODULUS / MODULUS for n in k])
    return np.asarray(np.real(np.sqrt(-2 * np.log(u)) * np.exp(2j * np.pi * v)))


def noise_at(time_s: Vector, period: float, seed: int) -> Vector:
    """The number that holds at each instant; 0 within the first period."""
    places = np.floor(time_s / period).astype(int)
    numbers: Vector = np.array([0.0, *normal_numbers(seed, int(places.max()))])
    return np.asarray(numbers[places])


def sampled_noise(time_s: Vector) -> Mapping[str, Vector]:
    """Normal numbers, each for 130 us."""
    return {"y": noise_at(time_s, 130e-6, 12)}


def sensor_filter(time_s: Vector) -> Mapping[str, Vector]:
    """Both orders behind a cosine on a ramp, at rest at the start."""
    w1, w2, damping = 2 * np.pi * 120, 2 * np.pi * 150, 0.4

    def rate(t: float, y: Vector) -> list[float]:
        u = 1e-3 * (1 + np.cos(500 * t)) + 0.02 * t
        return [w1 * (u - y[0]), y[2], w2 * w2 * (u - y[1]) - 2 * damping * w2 * y[2]]

    solution = solve_ivp(
        rate, (0.0, time_s[-1]), [2e-3, 2e-3, 0.0], "DOP853", time_s, rtol=1e-12, atol=1e-16
    )
    return {"first_order": solution.y[0], "second_order": solution.y[1]}


def disc_mean(f: Callable[[float, float], float], radius: float) -> float:
    """The mean of f over a disc, by the trapezoidal rule in the angle and Gauss in the radius."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    angles = np.arange(48) * np.pi / 24
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        r = radius * (node + 1) / 2
        ring = np.mean([f(r * np.cos(a), r * np.sin(a)) for a in angles])
        total += weight * ring * (node + 1) / 2
    return float(total)


def capacitive_electrode(time_s: Vector) -> Mapping[str, Vector]:
    """Plate capacitors over the whole disc, integrated."""
    slope, radius, tilt, residual, full = np.tan(0.2), 2e-3, 5.0, 0.02, 5.5e-3
    averaged = []
    for t in time_s:
        gap = 6e-3 - 4e-3 * t
        inverse = disc_mean(lambda u, v, gap=gap: 1 / (gap - slope * u), radius)  # type: ignore[misc]
        averaged.append(1 / ((1 - 0.3 * t) * inverse))
    d = np.array(averaged)
    tilted = d - (tilt - 1) * (radius * slope) ** 2 / (4 * d)
    inside = np.minimum(tilted, full)
    return {
        "averaged": d,
        "seen": tilted,
        "linearised": inside + residual * inside * (1 - inside / full),
    }


def lost_at_hole(center: float, offset: float, hole: float, radius: float) -> float:
    """The share of a disc that lies above a hole, from the chords of both circles."""
    distance = float(np.hypot(center, offset))

    def chord(u: float) -> float:
        mine = np.sqrt(max(0.0, radius**2 - u**2))
        theirs = np.sqrt(max(0.0, hole**2 - (u - distance) ** 2))
        return float(2 * min(mine, theirs))

    low, high = max(-radius, distance - hole), min(radius, distance + hole)
    if low >= high:
        return 0.0
    both = (distance**2 + radius**2 - hole**2) / (2 * distance)
    points = [both] if low < both < high else None
    area, _ = quad(chord, low, high, points=points, epsabs=1e-14, epsrel=1e-11, limit=200)
    return float(area / (np.pi * radius**2))


def lost_at_edge(beyond: float, radius: float) -> float:
    """The share of a disc that lies beyond a straight edge, from its chords."""
    low = max(-radius, -beyond)
    if low >= radius:
        return 0.0
    area, _ = quad(
        lambda u: 2 * np.sqrt(max(0.0, radius**2 - u**2)), low, radius, epsabs=1e-14, epsrel=1e-11
    )
    return float(area / (np.pi * radius**2))


def tabulated(f: Callable[[float], float], low: float, high: float) -> Callable[[Vector], Vector]:
    """f within low..high as a polynomial through Chebyshev nodes, constant outside."""
    table = Chebyshev.interpolate(np.vectorize(f), 400, [low, high])

    def values(u: Vector) -> Vector:
        found = np.where(u < low, table(low), table(high))
        inside = (u > low) & (u < high)
        found[inside] = table(u[inside])
        return found

    return values


def followed(u: Vector, tick: float, bandwidth: float, damping: float) -> Vector:
    """Second-order filter, at rest at first, of an input that is straight between its ticks."""
    w = 2 * np.pi * bandwidth
    system = StateSpace(
        [[0.0, 1.0], [-w * w, -2 * damping * w]], [[0.0], [w * w]], [[1.0, 0.0]], 0.0
    )
    _, y, _ = lsim(system, u, tick * np.arange(len(u)), X0=[u[0], 0.0], interp=True)
    return np.asarray(y)


def step_response(time_s: Vector, bandwidth: float, damping: float) -> Vector:
    """Second-order filter behind a step from 0 to 1 at 0."""
    decay = damping * 2 * np.pi * bandwidth
    turning = np.sqrt(1 - damping**2) * 2 * np.pi * bandwidth
    t = np.maximum(0.0, time_s)
    swing = np.cos(turning * t) + decay / turning * np.sin(turning * t)
    return np.asarray(1 - np.exp(-decay * t) * swing)


def distance_sensor(time_s: Vector) -> Mapping[str, Vector]:
    """A nozzle over a ramp, across a hole, down to the sheet and off its edge.

    The mean over the electrode is the rule of Abramowitz and Stegun 25.4.61 with seven points.
    """
    radius, full, span, parts = 2e-3, 8e-3, 0.5, 1000
    feed, hole, level = 0.16, 3e-3, 0.4e-3
    z = cubic(4.2e-3, -2e-3, 1.2e-3, -3e-3, span)
    rise = ramp_between(1.5e-3, 5e-3, 20e-3, 0.2)
    ring = radius * np.sqrt(2 / 3) * np.exp(1j * np.pi / 3 * np.arange(6))
    points = [(0.0, 0.0, 1 / 4), *((p.real, p.imag, 1 / 8) for p in ring)]
    over_hole = tabulated(
        lambda d: lost_at_hole(d, 0.0, hole, radius), abs(hole - radius), hole + radius
    )
    over_edge = tabulated(lambda e: lost_at_edge(e, radius), -radius, radius)

    def gap(t: Vector, u: float = 0.0, v: float = 0.0) -> Vector:
        return np.asarray(z(t) - level - rise(feed * t + u + 0j, np.full_like(t, v)).real)

    def raw(t: Vector) -> Vector:
        x = feed * t
        share = over_hole(np.hypot(x - 50e-3, 0.5e-3)) + over_edge(x * np.cos(0.1) - 70e-3)
        inverse = sum(w / np.maximum(1e-6, gap(t, u, v)) for u, v, w in points)
        seen = 1 / (np.maximum(1e-9, 1 - share) * inverse)
        _, slope_x, slope_y = sampled(rise, x, np.zeros_like(x))
        seen = seen - 4.0 * radius**2 * (slope_x**2 + slope_y**2) / (4 * np.maximum(1e-6, seen))
        return np.asarray(np.maximum(0.0, seen))

    tick = time_s[1] / parts
    ticks = tick * np.arange(parts * (len(time_s) - 1) + 1)
    (touch,) = crossings(lambda t: float(z(t)) - 1.9e-3, np.linspace(0.0, span, 101))
    left = (70e-3 + radius) / np.cos(0.1) / feed
    inside = np.minimum(raw(ticks), full)
    answer = inside + 0.01 * inside * (1 - inside / full)
    answer[ticks >= touch] = 0.0  # short circuit; the step to full scale behind it in closed form
    y = followed(answer, tick, 300, 0.7)[::parts] + full * step_response(time_s - left, 300, 0.7)
    noisy = y + 3e-6 * (y / 1.1e-3) ** 2 * noise_at(time_s, 130e-6, 99)
    touching = within([(touch, left)], time_s)
    true = gap(time_s)
    slope = 1.5 / 20
    free = np.maximum(0.0, np.abs(true) - slope * radius) / np.hypot(1.0, slope)
    x = feed * time_s
    wall = np.maximum(hole - np.hypot(x - 50e-3, 0.5e-3), x * np.cos(0.1) - 70e-3)
    return {
        "distance": np.where(touching > 0, 0.0, np.clip(noisy, 0.0, full)),
        "distance_true": true,
        "valid": (raw(time_s) < full).astype(float),
        "touching": touching,
        "touch_time": last_edge([(touch, True)], True, time_s),
        "clearance": np.where(true > 0, free, np.minimum(free, np.abs(wall - radius))),
    }


def distance_sensor_moved(time_s: Vector) -> Mapping[str, Vector]:
    """A nozzle that stands 4.3 mm above a sheet that rises and sways."""
    ramps = [(1.1e-3, 0.0503, 0.1207), (2.6e-3, 0.1011, 0.2203)]
    true = 4.7e-3 - 0.4e-3 - moved(time_s, ramps) - swayed(time_s, 0.9e-3, 7.0, 0.2503)
    lost = within([(0.3301, 0.3609)], time_s) > 0
    return {
        "distance": np.where(lost, 8e-3, np.maximum(true, 0.0)),
        "distance_true": true,
        "valid": (~lost).astype(float),
        "touching": (true <= 0.0).astype(float),
    }
