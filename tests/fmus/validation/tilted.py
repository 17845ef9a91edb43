"""References of inclined tools: products of matrices, distances from planes, nearest points."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from edges import Vector, last_edge, within
from paths import crossings, cubic
from scipy.integrate import solve_ivp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from workpieces import Height, moved, swayed, waves

from distance import noise_at


def frame(turn: str = "z", angle: float = 0.0, shift: Sequence[float] = (0, 0, 0)) -> Vector:
    """A 4x4 matrix: first the shift, then a turn about an axis of the shifted frame."""
    found: Vector = np.eye(4)
    found[:3, :3] = Rotation.from_euler(turn, angle).as_matrix()
    found[:3, 3] = shift
    return found


def head_frame(axes: Sequence[float], hd: Sequence[float]) -> Vector:
    """The frame at the A axis that turns with the tool, of kinematic 9; z is the direction u."""
    x, y, z, c, a = axes
    turned = frame(shift=(x, y, z)) @ frame("z", c + hd[3], (hd[6], hd[7], 0))
    return np.asarray(turned @ frame("x", a + hd[2], (hd[5], hd[4], -hd[1])))


def head_tool(axes: Sequence[float], hd: Sequence[float], reach: float) -> tuple[Vector, Vector]:
    """Clamping point and direction of a head; hd: HD1 to HD9."""
    tool = head_frame(axes, hd)
    return (tool @ [0, hd[8], -(hd[0] + reach), 1])[:3], tool[:3, 2]


def robot_tool(
    joints: Sequence[float], hd: Mapping[int, float], reach: float
) -> tuple[Vector, Vector]:
    """Clamping point and direction of a robot; hd: by number."""
    q1, q2, q3, q4, q5, q6 = joints
    chain = (
        frame("z", q1)
        @ frame("y", q2 + hd[14], (hd[11], 0, hd[7]))
        @ frame("y", q3 + hd[15], (0, 0, hd[8]))
        @ frame("x", q4, (hd[9], 0, -hd[12]))
        @ frame("y", q5)
        @ frame("x", q6)
        @ frame("y", -np.pi / 2, (hd[10], 0, 0))
        @ frame("z", hd[6], (hd[2], hd[3], -hd[1]))
        @ frame("y", hd[5])
        @ frame("x", hd[4])
    )
    return (chain @ [0, 0, -reach, 1])[:3], chain[:3, 2]


HEAD_HD = (21e-3, 17e-3, 0.05, -0.07, 8e-3, -6e-3, 4e-3, 3e-3, 12e-3)


def placed(tools: Sequence[tuple[Vector, Vector]]) -> dict[str, Vector]:
    """Points and directions by name."""
    points, directions = np.array(tools).transpose(1, 2, 0)
    names = {f"point_{g}": v for g, v in zip("xyz", points, strict=True)}
    return names | {f"direction_{g}": v for g, v in zip("xyz", directions, strict=True)}


def head_ca(time_s: Vector) -> Mapping[str, Vector]:
    """A head that turns all round."""
    poses = [(0.3 * t, 0.1 - 0.2 * t, 0.4 * t * t, 8 * t - 4, 2 - 5 * t) for t in time_s]
    return placed([head_tool(axes, HEAD_HD, 51e-3) for axes in poses])


def six_joint_robot(time_s: Vector) -> Mapping[str, Vector]:
    """A robot that turns all its joints."""
    hd = {1: 50e-3, 2: 4e-3, 3: -5e-3, 4: 0.3, 5: -0.2, 6: 0.5, 7: 0.45, 8: 0.6, 9: 0.64}
    hd |= {10: 0.1, 11: 0.15, 12: 0.1, 14: 0.02, 15: -0.03}
    begin, rate = np.array([-3, -1, 1.5, -4, -1, 2]), np.array([6, 2, -2, 9, 2.5, -7])
    return placed([robot_tool(begin + rate * t, hd, 11e-3) for t in time_s])


def extended(tilt: Vector, nominal: float, begin: float, end: float) -> Vector:
    """The height of the head stays what it is at `begin`, up to `end`."""
    height = nominal * np.cos(begin)
    found = np.where(tilt <= begin, nominal, height / np.cos(np.minimum(tilt, end)))
    return np.asarray(found)


def tool_extension(time_s: Vector) -> Mapping[str, Vector]:
    """A tool that tilts."""
    return {"length": extended(1.4 * time_s, 82e-3, 0.5, 1.1)}


def ways(
    motion: Sequence[tuple[float, float, float, float]], span: float
) -> Callable[[float], list[float]]:
    """The positions of all axes at an instant; motion: place and rate at both ends."""
    cubics = [cubic(a, va, b, vb, span) for a, va, b, vb in motion]
    return lambda t: [float(way(t)) for way in cubics]


def angle_from_z(u: Vector) -> float:
    """Between a direction and z, from the chord of the unit sphere."""
    return float(2 * np.arcsin(0.5 * np.linalg.norm(u - [0, 0, 1])))


def named(points: Sequence[Vector], name: str) -> dict[str, Vector]:
    """The coordinates of points by name."""
    return {f"{name}_{g}": v for g, v in zip("xyz", np.array(points).T, strict=True)}


HEAD_MOTION = (
    *((0, 0.1, 0.05, 0.15), (0.01, -0.05, -0.02, -0.1), (0.30, -0.1, 0.27, 0.1)),
    *((0.2, 1, 0.9, 2), (-0.3, 2, 0.8, 3)),
)


def electrode_mean(along: float, slope: float, radius: float) -> float:
    """The rule of Abramowitz and Stegun 25.4.61 on a plane that rises across the disc."""
    ring = [radius * np.sqrt(2 / 3) * np.cos(np.pi / 3 * k) for k in range(6)]
    return float(1 / (0.25 / along + sum(0.125 / (along + slope * r) for r in ring)))


def head_distance_sensor(time_s: Vector) -> Mapping[str, Vector]:
    """A head above an inclined sheet: the distance from a plane, a filter as an integral."""
    full, radius, excess = 0.4, 3e-3, 4.0
    axes = ways(HEAD_MOTION, 0.4)
    turn = Rotation.from_euler("YX", [-0.15, 0.1])
    rise = np.tan(0.2) * np.array([np.cos(0.4), np.sin(0.4)])
    normal = turn.apply(np.array([-rise[0], -rise[1], 1.0]) * np.cos(0.2))
    origin = np.array([11e-3, -7e-3, 23e-3])
    # A point of the plane at rest: its level, less what the inclined one has at its foot
    foot = turn.apply([0.0, 0.0, 1.4e-3 - np.tan(0.2) * 5e-3]) + origin
    upwards = float(normal @ turn.apply([0.0, 0.0, 1.0]))

    def height(t: float) -> float:
        ramps = [(4e-3, 0.0503, 0.1207), (-3e-3, 0.1011, 0.2203)]
        at = np.array([t])
        return float(moved(at, ramps)[0] + swayed(at, 0.9e-3, 7.0, 0.2503)[0])

    def distances(t: float) -> tuple[float, float, float]:
        point, u = head_tool(axes(t), HEAD_HD, 51e-3)
        orthogonal = float(normal @ (point - foot)) - upwards * height(t)
        cosine = float(normal @ u)
        return orthogonal, orthogonal / cosine, float(np.tan(np.arccos(cosine)))

    def linearised(t: float) -> float:
        _, along, slope = distances(t)
        mean = electrode_mean(along, slope, radius)
        seen = mean - excess * (radius * slope) ** 2 / (4 * mean)
        return seen + 0.01 * seen * (1 - seen / full)

    w, damping = 2 * np.pi * 200, 0.6
    state, y = [linearised(0.0), 0.0], np.empty_like(time_s)
    stops = [0.0, 0.0503, 0.1011, 0.1207, 0.2203, 0.2503, 0.3001, 0.3209, time_s[-1] + 1e-9]
    for begin, end in pairwise(stops):
        lost = begin == 0.3001

        def rate(t: float, s: Vector, lost: bool = lost) -> list[float]:
            u = full if lost else linearised(t)
            return [s[1], w * w * (u - s[0]) - 2 * damping * w * s[1]]

        inside = (time_s >= begin) & (time_s < end)
        at = np.array([*time_s[inside], end])
        solution = solve_ivp(
            rate, (begin, end), state, "DOP853", at, rtol=1e-11, atol=1e-15, max_step=2e-3
        )
        y[inside], state = solution.y[0][:-1], list(solution.y[:, -1])
    noisy = y + 4e-6 * (y / 90e-3) ** 2 * noise_at(time_s, 130e-6, 7)
    tools = [head_tool(axes(t), HEAD_HD, 51e-3) for t in time_s]
    tilt = np.array([angle_from_z(u) for _, u in tools])
    length = extended(tilt, 82e-3, 0.3, 0.6)
    tcp = [point - one * u for (point, u), one in zip(tools, length, strict=True)]
    orthogonal, along, _ = np.array([distances(t) for t in time_s]).T
    found = {"distance": np.clip(noisy, 0, full), "distance_true": orthogonal}
    found |= {"distance_along": along, "tilt": tilt, "virtual_length": length}
    found |= named([point for point, _ in tools], "clamping") | named(tcp, "tcp")
    found["valid"] = 1 - within([(0.3001, 0.3209)], time_s)
    return found


ROBOT_MOTION = (
    *((0, 1, 0.3, 1.2), (0, 0.3, 0.05, 0.1), (0, -0.2, -0.05, 0.1)),
    *((0.02, 1, 0.2, 0.8), (1.4, 0.5, 1.5, 0.4), (0, 1, 0.4, 1.1)),
)


def nearest(height: Height, point: Vector) -> float:
    """Distance from a smooth surface, by scipy, from the point below."""

    def square(q: Vector) -> float:
        level = float(np.real(height(q[0] + 0j, q[1] + 0j)))
        return float((q[0] - point[0]) ** 2 + (q[1] - point[1]) ** 2 + (level - point[2]) ** 2)

    options = {"xatol": 1e-9, "fatol": 1e-22, "maxiter": 2000}
    simplex = point[:2] + np.array([[0, 0], [2e-3, 0], [0, 2e-3]])
    found = minimize(
        square, point[:2], method="Nelder-Mead", options=options | {"initial_simplex": simplex}
    )
    return float(np.sqrt(found.fun))


def robot_distance_sensor(time_s: Vector) -> Mapping[str, Vector]:
    """A robot above a wavy sheet that rises to it."""
    hd = {1: 50e-3, 2: 4e-3, 3: -5e-3, 4: 0.03, 5: -0.02, 6: 0.3, 7: 0.45, 8: 0.6, 9: 0.64}
    hd |= {10: 0.1, 11: 0.15, 12: 0.1, 14: 0.02, 15: -0.03}
    joints, turn = ways(ROBOT_MOTION, 0.3), Rotation.from_euler("YX", [0.07, 0.05])
    height = waves([0.9e-3], [0.08], [0.4], 0.3)

    def level(q: Vector) -> float:
        return float(np.real(height(q[0] + 0j, q[1] + 0j)))

    def inside(t: float) -> tuple[Vector, Vector]:
        """The clamping point and the beam in the frame of the sheet."""
        point, u = robot_tool(joints(t), hd, 11e-3)
        up = moved(np.array([t]), [(60e-3, 0.0503, 0.2207)])[0]
        local = turn.inv().apply(point - [0, 0, 0.71]) - [0, 0, up]
        return local, -turn.inv().apply(u)

    def gap(t: float) -> float:
        local, _ = inside(t)
        return float(local[2] - level(local))

    def along(t: float) -> float:
        local, beam = inside(t)
        way = -local[2] / beam[2]
        found = crossings(
            lambda s: float(local[2] + s * beam[2] - level(local + s * beam)),
            np.array([way - 3e-3, way + 3e-3]),
        )
        return found[0]

    tools = [robot_tool(joints(t), hd, 11e-3) for t in time_s]
    gaps = np.array([gap(t) for t in time_s])
    signed = np.sign(gaps) * [nearest(height, inside(t)[0]) for t in time_s]
    touches = crossings(gap, np.linspace(0, time_s[-1], 301))
    edges = [(t, k % 2 == 0) for k, t in enumerate(touches)]
    touching = (gaps <= 0).astype(float)
    found = {"distance": np.clip(signed, 0, 0.4), "distance_true": signed}
    found |= {"distance_along": np.array([along(t) for t in time_s])}
    found |= named([point for point, _ in tools], "clamping")
    found |= named([point - 82e-3 * u for point, u in tools], "tcp")
    found["tilt"] = np.array([angle_from_z(u) for _, u in tools])
    found["valid"] = np.ones_like(time_s)
    found |= {"touching": touching, "touch_time": last_edge(edges, True, time_s)}
    return found
