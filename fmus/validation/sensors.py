"""References of the sensors: closed forms, statics, and quadrature where the models have rules."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, root
from scipy.signal import StateSpace, lsim
from workpieces import inclined, ramp_between, sampled, waves

Vector = NDArray[Any]
Edges = list[tuple[float, bool]]

MODULUS = 2**31 - 1


# --- Boolean signals as lists of edges: (instant, level behind it), low at first ------------------


def level_at(edges: Edges, time_s: Vector) -> Vector:
    """The level at each instant."""
    instants = np.array([t for t, _ in edges])
    levels = np.array([0.0, *(float(level) for _, level in edges)])
    return levels[np.searchsorted(instants, time_s, side="right")]


def last_edge(edges: Edges, level: bool, time_s: Vector) -> Vector:
    """The instant of the last edge to `level`, 0 before the first."""
    instants = np.array([0.0, *(t for t, to in edges if to is level)])
    return instants[np.searchsorted(instants[1:], time_s, side="right")]


def count_of(edges: Edges, level: bool, time_s: Vector) -> Vector:
    """How many edges to `level` there have been."""
    instants = np.array([t for t, to in edges if to is level])
    return np.searchsorted(instants, time_s, side="right").astype(float)


def within(spans: Sequence[tuple[float, float]], time_s: Vector) -> Vector:
    """1 within one of the spans."""
    found = np.zeros_like(time_s)
    for begin, end in spans:
        found[(time_s >= begin) & (time_s < end)] = 1.0
    return found


def sine_edges(omega: float, phase: float, until: float) -> Edges:
    """Edges of sin(omega t - phase) > 0, which is low at 0."""
    count = int((omega * until - phase) / np.pi)
    return [((k * np.pi + phase) / omega, k % 2 == 0) for k in range(count + 1)]


def lehmer(multiplier: int, state: int) -> int:
    """The next state of the multiplicative congruential generator modulo 2^31 - 1."""
    return multiplier * state % MODULUS


def uniform(multiplier: int, seed: int, count: int) -> list[float]:
    """The first numbers of an edge sequence, within 0..1."""
    state = lehmer(multiplier, 1 + 742938285 * seed % (MODULUS - 1))
    found = []
    for _ in range(count):
        found.append(float(Fraction(state, MODULUS)))
        state = lehmer(multiplier, state)
    return found


def delayed(edges: Edges, delay: float, jitter: float, seed: int) -> tuple[Edges, list[Any]]:
    """The edges behind a delay with jitter, and the spans during which each is under way."""
    found: Edges = []
    spans = []
    for level, multiplier in ((True, 16807), (False, 48271)):
        mine = [t for t, to in edges if to is level]
        for t, u in zip(mine, uniform(multiplier, seed, len(mine)), strict=True):
            arrival = t + max(0.0, delay + jitter * (2 * u - 1))
            found.append((arrival, level))
            spans.append((t, arrival))
    return sorted(found), spans


def bounced(edges: Edges, closing: int, opening: int, duration: float) -> tuple[Edges, list[Any]]:
    """The edges with their bouncing, and the spans during which the contact bounces."""
    found: Edges = []
    spans = []
    ends = [t for t, _ in edges[1:]] + [np.inf]
    for (t, level), end in zip(edges, ends, strict=True):
        times = 2 * (closing if level else opening)
        mine = [(t + k * duration / max(1, times), level ^ (k % 2 == 1)) for k in range(times + 1)]
        kept = [edge for edge in mine if edge[0] < end]
        if found and found[-1][1] is level:
            kept = kept[1:]  # it bounced to this level already
        found += kept
        spans.append((t, min(end, t + duration if times else t)))
    return found, spans


def edge_delay(time_s: Vector) -> Mapping[str, Vector]:
    """A square wave of 40 Hz behind 30 ms with up to 3 ms to either side."""
    edges, spans = delayed(sine_edges(251.3, 0.3, float(time_s[-1])), 30e-3, 3e-3, 77)
    return {
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
        "rising_count": count_of(edges, True, time_s),
        "waiting": within(spans, time_s),
    }


def contact_bounce(time_s: Vector) -> Mapping[str, Vector]:
    """Two closings; the second one ends while the contact still bounces."""
    touches: Edges = [(0.01003, True), (0.02003, False), (0.03003, True), (0.03074, False)]
    edges, spans = bounced(touches, 3, 2, 1.3e-3)
    return {
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
        "rising_count": count_of(edges, True, time_s),
        "bouncing": within(spans, time_s),
    }


def switch_on_delay(time_s: Vector) -> Mapping[str, Vector]:
    """On until 30.1 ms, and from 40.2 ms on; ready 12.3 ms later."""
    ready: Edges = [(0.0123, True), (0.0301, False), (0.0402 + 0.0123, True)]
    return {
        "ready": level_at(ready, time_s),
        "waiting": within([(0.0, 0.0123), (0.0402, 0.0525)], time_s),
        "ready_time": last_edge(ready, True, time_s),
    }


def level_filter(time_s: Vector) -> Mapping[str, Vector]:
    """What lasts for 2 ms passes 2 ms later."""
    rest = 2e-3
    passed: Edges = [
        (0.02003 + rest, True),
        (0.02205 + rest, False),
        (0.03003 + rest, True),
    ]
    resting = [
        (0.01003, 0.01202),
        (0.02003, 0.02003 + rest),
        (0.02205, 0.02205 + rest),
        (0.03003, 0.03003 + rest),
        (0.03503, 0.03603),
    ]
    return {
        "level": level_at(passed, time_s),
        "rising_time": last_edge(passed, True, time_s),
        "falling_time": last_edge(passed, False, time_s),
        "waiting": within(resting, time_s),
    }


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


# --- Filters -------------------------------------------------------------------------------------


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


# --- Touch probe ---------------------------------------------------------------------------------


def seat_pretravel(
    normal: Vector, force: float, length: float, radius: float, first: float, bending: float,
    axial: float,
) -> float:  # fmt: skip
    """Pre-travel at which the first of three pads is without load, from force and moments.

    Loads N_i of the pads: sum N_i = F_p - F n_z, sum x_i N_i = -F L n_x, sum y_i N_i = -F L n_y,
    with the contact force F n at the ball, L below the pads.
    """
    angles = first + np.array([0.0, 2 * np.pi / 3, 4 * np.pi / 3])
    statics = np.array([np.ones(3), radius * np.cos(angles), radius * np.sin(angles)])
    unloaded = np.linalg.solve(statics, [force, 0.0, 0.0])
    per_force = np.linalg.solve(statics, [-normal[2], -length * normal[0], -length * normal[1]])
    lifting = [
        load / -change for load, change in zip(unloaded, per_force, strict=True) if change < 0
    ]
    compliance = (normal[0] ** 2 + normal[1] ** 2) / bending + normal[2] ** 2 / axial
    return float(min(lifting) * compliance)


def three_leg_seat(time_s: Vector) -> Mapping[str, Vector]:
    """A normal that turns down from the axis."""
    down, turn = 1.6 * time_s, 9 * time_s
    normals = np.array([np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), np.cos(down)]).T
    return {
        "pretravel": np.array(
            [seat_pretravel(n, 2.5, 50e-3, 10e-3, 0.2, 0.2e6, 2e6) for n in normals]
        )
    }


def cubic(
    start: float, start_rate: float, finish: float, finish_rate: float, span: float
) -> Polynomial:
    """The cubic through both ends with given rates, by its four linear conditions."""
    conditions = np.array(
        [
            [1, 0, 0, 0],
            [0, 1, 0, 0],
            [1, span, span**2, span**3],
            [0, 1, 2 * span, 3 * span**2],
        ]
    )
    return Polynomial(np.linalg.solve(conditions, [start, start_rate, finish, finish_rate]))


def crossings(f: Callable[[float], float], grid: Vector) -> list[float]:
    """The instants at which f changes its sign, bracketed on a grid."""
    values = np.array([f(t) for t in grid])
    places = np.nonzero(np.sign(values[:-1]) != np.sign(values[1:]))[0]
    return [brentq(f, grid[k], grid[k + 1], xtol=1e-15, rtol=1e-15) for k in places]


def touch_probe(time_s: Vector) -> Mapping[str, Vector]:
    """A ball of 2 mm on an inclined plane; instants as roots of a polynomial."""
    span = 0.4
    x = cubic(0.01, 0.02, 0.012, -0.01, span)
    y = cubic(-0.02, 0.0, -0.021, 0.0, span)
    z = cubic(0.108, -0.05, 0.108, 0.05, span)
    normal = np.array([np.sin(0.3) * np.cos(0.4), np.sin(0.3) * np.sin(0.4), np.cos(0.3)])
    gap = normal[0] * x + normal[1] * y + normal[2] * z - (0.1 + 2e-3)
    pretravel = 5e-6 + seat_pretravel(normal, 2.5, 50e-3, 10e-3, 0.1, 0.2e6, 2e6)

    def roots(p: Polynomial) -> list[float]:
        found = [complex(r) for r in p.roots()]
        return sorted(r.real for r in found if abs(r.imag) < 1e-9 and 0 < r.real < span)

    (touch, _), (on, off) = roots(gap), roots(gap + pretravel)
    edges: Edges = [(on + 3e-3, True), (off + 3e-3, False)]
    under_way = within([(on, on + 3e-3), (off, off + 3e-3)], time_s)
    near = np.minimum(np.abs(gap(time_s)), np.abs(gap(time_s) + pretravel))
    return {
        "gap": gap(time_s),
        "clearance": np.where(under_way > 0, 0.0, near),
        "contact_time": last_edge([(touch, True)], True, time_s),
        "contact_z": np.where(time_s >= touch, z(touch), 0.0),
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
    }


def workpiece_probe(time_s: Vector) -> Mapping[str, Vector]:
    """A ball of 3 mm on a wavy inclined plane: distance from the foot of the normal."""
    span, radius = 0.4, 3e-3
    x = cubic(0.01, 0.02, 0.018, 0.02, span)
    y = cubic(-0.02, 0.01, -0.016, 0.01, span)
    z = cubic(6.5e-3, -0.05, 7.5e-3, 0.05, span)
    parts = [inclined(0.2, 1e-3, 0.3), waves([0.3e-3], [0.05], [0.4], 0.1)]

    def surface(u: Vector, v: Vector) -> Vector:
        return np.asarray(parts[0](u, v) + parts[1](u, v))

    def nearest(t: float) -> tuple[float, Vector]:
        """Distance of the centre from the surface, signed, and the normal at the foot.

        Where the distance is smallest, the way from the foot to the centre is along the normal.
        """
        center = np.array([x(t), y(t), z(t)])

        def across(p: Vector) -> list[float]:
            h, slope_x, slope_y = (float(a[0]) for a in sampled(surface, p[:1], p[1:]))
            up = center[2] - h
            return [center[0] - p[0] + up * slope_x, center[1] - p[1] + up * slope_y]

        foot = root(across, center[:2], tol=1e-15).x
        h, slope_x, slope_y = (float(a[0]) for a in sampled(surface, foot[:1], foot[1:]))
        normal = np.array([-slope_x, -slope_y, 1.0]) / np.hypot(1.0, np.hypot(slope_x, slope_y))
        return float(normal @ (center - np.array([*foot, h]))), normal

    def pretravel(normal: Vector) -> float:
        return 5e-6 + seat_pretravel(normal, 2.5, 50e-3, 10e-3, 0.1, 0.2e6, 2e6)

    def switching(t: float) -> float:
        distance, normal = nearest(t)
        return distance - radius + pretravel(normal)

    grid = np.linspace(0, span, 81)
    touch = crossings(lambda t: nearest(t)[0] - radius, grid)
    on, off = crossings(switching, grid)
    late, under_way = delayed([(on, True), (off, False)], 10e-3, 2e-3, 5)
    contact, bouncing = bounced(late, 2, 1, 1.2e-3)
    ready, off_at = 0.0319, 0.37
    distances, normals = zip(*(nearest(t) for t in time_s), strict=True)
    height, _, _ = sampled(surface, x(time_s), y(time_s))
    steepest = np.tan(0.2) + 2 * np.pi * 0.3e-3 / 0.05
    free = np.maximum(0.0, (z(time_s) - height) / np.hypot(1.0, steepest) - radius)
    held_back = within([(0.0, ready), *under_way, *bouncing, (touch[0], touch[1])], time_s)
    return {
        "gap": np.array(distances) - radius,
        "contact_time": last_edge([(touch[0], True)], True, time_s),
        "contact_x": np.where(time_s >= touch[0], x(touch[0]), 0.0),
        "total_pretravel": np.array([pretravel(n) for n in normals]),
        "rising_time": last_edge(contact, True, time_s),
        "falling_time": last_edge(contact, False, time_s),
        "rising_count": count_of(contact, True, time_s),
        "ready": within([(ready, off_at)], time_s),
        "clearance": np.where(held_back > 0, 0.0, free),
    }


def probe_at_walls(time_s: Vector) -> Mapping[str, Vector]:
    """Distance from a quadrant and from a cylinder inside, by cases."""
    radius, top = 3e-3, 4e-3
    x = cubic(14.3e-3, 0.0, 9e-3, -0.02, 1.0)(time_s)
    z = cubic(0.0, 0.02, 8e-3, 0.0, 1.0)(time_s)
    wall = x * np.cos(0.3) - 11e-3
    above = z - top
    corner = np.hypot(wall, above)
    outside = np.where((wall > 0) & (above > 0), corner, np.maximum(wall, above)) - radius
    u = cubic(1e-3, 0.0, 5e-3, 0.0, 1.0)(time_s) - 1e-3
    v = cubic(2e-3, 0.0, 6e-3, 0.0, 1.0)(time_s) - 2e-3
    inside = 8e-3 - np.hypot(u, v) - radius
    free = np.maximum(0.0, np.maximum(wall, above) - radius)
    return {
        "outside_gap": outside,
        "outside_clearance": np.where(outside > 0, free, np.abs(outside)),
        "inside_gap": inside,
        "inside_count": (inside <= 0).astype(float),
    }


# --- Distance sensor -----------------------------------------------------------------------------


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
    return lambda u: table(np.clip(u, low, high))


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
    z = cubic(4.2e-3, -2e-3, 1.2e-3, -2e-3, span)
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
    told = inside + 0.01 * inside * (1 - inside / full)
    told[ticks >= touch] = 0.0  # short circuit; the step to full scale behind it in closed form
    y = followed(told, tick, 300, 0.7)[::parts] + full * step_response(time_s - left, 300, 0.7)
    noisy = y + 3e-6 * (y / 1.1e-3) ** 2 * noise_at(time_s, 130e-6, 99)
    touching = within([(touch, left)], time_s)
    true = gap(time_s)
    slope = 1.5 / 20
    return {
        "distance": np.where(touching > 0, 0.0, np.clip(noisy, 0.0, full)),
        "distance_true": true,
        "valid": (raw(time_s) < full).astype(float),
        "touching": touching,
        "touch_time": last_edge([(touch, True)], True, time_s),
        "clearance": np.maximum(0.0, np.abs(true) - slope * radius) / np.hypot(1.0, slope),
    }


# --- Encoder and terminal ------------------------------------------------------------------------


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
