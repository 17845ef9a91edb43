"""References of the touch probes: statics of the seat, roots of the distance."""

from collections.abc import Mapping

import numpy as np
from edges import MODULUS, Edges, Vector, bounced, count_of, delayed, last_edge, within
from numpy.polynomial import Polynomial
from paths import crossings, cubic
from scipy.optimize import root
from scipy.spatial.transform import Rotation
from workpieces import inclined, sampled, waves


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


def touch_difference(
    number: int, scatter: float, first: float, drift: float, least: float, seed: int
) -> float:
    """Pre-travel of touch 1, 2, ... less the usual one: Box and Muller, first touch, drift.

    State k of a sequence is a^k times its first one modulo 2^31 - 1, by powers of integers.
    """
    radius = pow(48271, number, MODULUS) * (1 + 1226874159 * seed % (MODULUS - 1)) % MODULUS
    angle = pow(69621, number, MODULUS) * (1 + 62089911 * seed % (MODULUS - 1)) % MODULUS
    normal = np.sqrt(-2 * np.log(radius / MODULUS)) * np.cos(2 * np.pi * angle / MODULUS)
    wanted = scatter * normal + drift * (number - 1) + (first if number == 1 else 0.0)
    return float(max(least, wanted))


def pretravel_scatter(time_s: Vector) -> Mapping[str, Vector]:
    """Touches that end at (pi (2 k - 1) + 0.4)/62.3."""
    ended = np.floor((62.3 * time_s - 0.4 + np.pi) / (2 * np.pi)).astype(int)
    numbers = 1 + np.maximum(0, ended)
    return {
        "difference": np.array(
            [touch_difference(int(k), 5e-6, 20e-6, 2e-6, -2e-6, 12) for k in numbers]
        )
    }


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


def head_touch_probe(time_s: Vector) -> Mapping[str, Vector]:
    """A ball of 2 mm at a head: the tip of a chain of 4x4 matrices, its distance from a plane."""
    span = 0.4
    axes = [
        cubic(0.01, 0.02, 0.012, -0.01, span),
        cubic(-0.02, 2e-3, -0.021, -1e-3, span),
        cubic(0.2311, -0.05, 0.2311, 0.05, span),
        cubic(0.3, 0.1, 0.33, 0.05, span),
        cubic(-0.4, -0.05, -0.42, -0.02, span),
    ]
    normal = np.array([np.sin(0.3) * np.cos(0.4), np.sin(0.3) * np.sin(0.4), np.cos(0.3)])
    pretravel = 5e-6 + seat_pretravel(normal, 2.5, 50e-3, 10e-3, 0.1, 0.2e6, 2e6)

    def shift(x: float, y: float, z: float) -> Vector:
        matrix = np.eye(4)
        matrix[:3, 3] = x, y, z
        return matrix

    def turn(about: str, angle: float) -> Vector:
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_euler(about, angle).as_matrix()
        return matrix

    def tip(t: float) -> Vector:
        x, y, z, c, a = (axis(t) for axis in axes)
        chain = (
            shift(x + 1e-3, y + 2e-3, z)
            @ turn("z", c - 0.07)
            @ shift(-3e-3, 4e-3, -35e-3)
            @ turn("x", a + 0.05)
            @ shift(0.0, 6e-3, -(20e-3 + 10e-3 + 60e-3))
        )
        return np.asarray(chain[:3, 3])

    def gap(t: float) -> float:
        return float(normal @ tip(t)) - (0.1 + 2e-3)

    grid = np.linspace(0.0, span, 401)
    (touch, _), (on, off) = crossings(gap, grid), crossings(lambda t: gap(t) + pretravel, grid)
    edges: Edges = [(on + 3e-3, True), (off + 3e-3, False)]
    under_way = within([(on, on + 3e-3), (off, off + 3e-3)], time_s)
    gaps = np.array([gap(t) for t in time_s])
    tips = np.array([tip(t) for t in time_s])
    # The ball from the C axis when its arms are stretched; a millimetre of an axis is a degree
    lever = np.hypot(3e-3, 4e-3 + np.hypot(6e-3, 90e-3))
    fastest = np.linalg.norm([1.0, np.radians(1e3 * lever), np.radians(1e3 * lever)])
    near = np.minimum(np.abs(gaps), np.abs(gaps + pretravel)) / fastest
    touched = [(touch, True)]
    return {
        "gap": gaps,
        **dict(zip(("tcp_x", "tcp_y", "tcp_z"), tips.T, strict=True)),
        "clearance": np.where(under_way > 0, 0.0, near),
        "contact_time": last_edge(touched, True, time_s),
        "contact_c": np.where(time_s >= touch, axes[3](touch), 0.0),
        "contact_z": np.where(time_s >= touch, axes[2](touch), 0.0),
        "contact_tcp_y": np.where(time_s >= touch, tip(touch)[1], 0.0),
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
    }


def hertz_approach(normal: Vector, seat: tuple[float, ...], radius: float, modulus: float) -> float:
    """By how much a ball and a flat body come closer at the trigger force of the seat.

    Hertz by its contact radius: a^3 = 3 F r/(4 E), approach = a^2/r (K. L. Johnson, Contact
    Mechanics, 1985, 4.22). F from the pre-travel with stiffness 1 in every direction.
    """
    force = seat_pretravel(normal, *seat[:4], 1.0, 1.0)
    return float(np.cbrt(3 * force * radius / (4 * modulus)) ** 2 / radius)


def workpiece_probe(time_s: Vector) -> Mapping[str, Vector]:
    """A ball of 3 mm on a wavy inclined plane: distance from the foot of the normal."""
    span, radius = 0.4, 3e-3
    x = cubic(0.01, 0.02, 0.018, 0.03, span)
    y = cubic(-0.02, 0.01, -0.016, 0.015, span)
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

    grid = np.linspace(0, span, 81)
    touch = crossings(lambda t: nearest(t)[0] - radius, grid)

    def pretravel(normal: Vector, number: int) -> float:
        seat = (2.5, 50e-3, 10e-3, 0.1, 0.2e6, 2e6)
        usual = seat_pretravel(normal, *seat) + hertz_approach(normal, seat, radius, 1e11)
        return 15e-6 + usual + touch_difference(number, 4e-6, 3e-6, 2e-6, -15e-6, 5)

    def switching(t: float) -> float:
        distance, normal = nearest(t)
        return distance - radius + pretravel(normal, 1)

    on, off = crossings(switching, grid)
    late, under_way = delayed([(on, True), (off, False)], 10e-3, 2e-3, 5)
    contact, bouncing = bounced(late, 2, 1, 1.2e-3)
    ready, off_at = 0.0319, 0.37
    distances, normals = zip(*(nearest(t) for t in time_s), strict=True)
    height, _, _ = sampled(surface, x(time_s), y(time_s))
    steepest = np.tan(0.2) + 2 * np.pi * 0.3e-3 / 0.05
    free = np.maximum(0.0, (z(time_s) - height) / np.hypot(1.0, steepest) - radius)
    held_back = within([(0.0, ready), *under_way, *bouncing, (touch[0], touch[1])], time_s)
    numbers = [2 if t > touch[1] else 1 for t in time_s]
    return {
        "gap": np.array(distances) - radius,
        "contact_time": last_edge([(touch[0], True)], True, time_s),
        "contact_x": np.where(time_s >= touch[0], x(touch[0]), 0.0),
        "total_pretravel": np.array(
            [pretravel(n, k) for n, k in zip(normals, numbers, strict=True)]
        ),
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
