"""Distance sensors at an inclined tool: kinematics by matrices, the nearest point by scipy."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize, minimize_scalar
from scipy.spatial.transform import Rotation

HEAD = "AxisRig.Sensors.HeadDistanceSensor"
ROBOT = "AxisRig.Sensors.RobotDistanceSensor"
EXACT_M = 1e-12
"""1e-9 mm."""


@pytest.fixture(scope="module")
def head(load):
    return load(HEAD)


@pytest.fixture(scope="module")
def robot(load):
    return load(ROBOT)


def at(**places):
    """Axes that rest."""
    return {f"{g}_{end}": value for g, value in places.items() for end in ("start", "end")}


def frame(turn: str = "z", angle: float = 0.0, shift=(0.0, 0.0, 0.0)) -> np.ndarray:
    """First the shift, then a turn about an axis of the shifted frame."""
    found = np.eye(4)
    found[:3, :3] = Rotation.from_euler(turn, angle).as_matrix()
    found[:3, 3] = shift
    return found


def clamping(fmu) -> np.ndarray:
    return np.array([fmu.clamping_x, fmu.clamping_y, fmu.clamping_z])


def tcp(fmu) -> np.ndarray:
    return np.array([fmu.tcp_x, fmu.tcp_y, fmu.tcp_z])


def test_head_is_the_product_of_its_matrices(head):
    numbers = np.random.default_rng(1)
    for _ in range(40):
        hd, reach, length = numbers.uniform(-0.3, 0.3, 9), 0.1, 0.08
        x, y, z, c, a = numbers.uniform(-2.5, 2.5, 5)
        head.restart(
            **at(x=x, y=y, z=z, c=c, a=a),
            **{f"head.hd{k}": value for k, value in enumerate(hd, 1)},
            **{"head.reach": reach, "tool_length": length},
        )
        tool = frame(shift=(x, y, z)) @ frame("z", c + hd[3], (hd[6], hd[7], 0))
        tool = tool @ frame("x", a + hd[2], (hd[5], hd[4], -hd[1]))
        point = tool @ [0, hd[8], -(hd[0] + reach), 1]
        end = tool @ [0, hd[8], -(hd[0] + reach + length), 1]
        assert clamping(head) == pytest.approx(point[:3], abs=EXACT_M)
        assert tcp(head) == pytest.approx(end[:3], abs=EXACT_M)
        assert head.tilt == pytest.approx(np.arccos(tool[2, 2]), abs=1e-12)


def test_robot_is_the_product_of_its_matrices(robot):
    numbers = np.random.default_rng(2)
    for _ in range(40):
        hd = dict(enumerate(numbers.uniform(-0.5, 0.5, 15), 1))
        q = numbers.uniform(-3, 3, 6)
        given = {f"robot.hd{k}": value for k, value in hd.items() if k != 13}
        robot.restart(**at(**{f"j{k}": value for k, value in enumerate(q, 1)}), **given)
        tool = frame("z", q[0]) @ frame("y", q[1] + hd[14], (hd[11], 0, hd[7]))
        tool = tool @ frame("y", q[2] + hd[15], (0, 0, hd[8]))
        tool = tool @ frame("x", q[3], (hd[9], 0, -hd[12])) @ frame("y", q[4]) @ frame("x", q[5])
        tool = tool @ frame("y", -np.pi / 2, (hd[10], 0, 0))
        tool = tool @ frame("z", hd[6], (hd[2], hd[3], -hd[1]))
        tool = tool @ frame("y", hd[5]) @ frame("x", hd[4])
        assert clamping(robot) == pytest.approx(tool[:3, 3], abs=EXACT_M)
        assert tcp(robot) == pytest.approx((tool @ [0, 0, -0.08, 1])[:3], abs=EXACT_M)


def test_robot_points_straight_down_with_its_wrist_at_90_degrees(robot):
    robot.restart(**at(j5=np.pi / 2), **{"robot.hd8": 0.6, "robot.hd9": 0.64, "robot.hd10": 0.1})
    assert clamping(robot) == pytest.approx([0.64, 0.0, 0.5], abs=EXACT_M)
    assert tcp(robot) == pytest.approx([0.64, 0.0, 0.42], abs=EXACT_M)
    assert robot.tilt == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("limits", "angle", "length_mm"),
    [
        ((30, 60), 45, 97.980),
        ((30, 60), 60, 138.564),
        ((50, 70), 70, 150.351),
        ((50, 70), 80, 150.351),
        ((10, 31), 31, 91.913),
        ((90, 0), 75, 80.0),
    ],
)
def test_tool_is_extended_as_the_manual_says(head, limits, angle, length_mm):
    """80 mm cos(HD2)/cos(angle) up to HD3, then frozen; the clamping point does not move."""
    begin, end = np.radians(limits)
    pose = at(z=0.3, a=np.radians(angle))
    head.restart(**pose)
    point = clamping(head)
    head.restart(**pose, **{"extension.hd2": begin, "extension.hd3": end})
    assert head.virtual_length == pytest.approx(length_mm * 1e-3, abs=5e-7)
    assert np.array_equal(clamping(head), point)
    assert np.linalg.norm(tcp(head) - point) == pytest.approx(head.virtual_length, abs=EXACT_M)


@pytest.mark.parametrize("tilt", [0.0, 0.3, -0.7])
def test_over_a_tilted_sheet_both_distances_are_those_of_a_plane(head, tilt):
    head.restart(
        **at(x=0.1, y=0.2, z=0.4, c=0.4, a=0.6),
        **{"workpiece_tilt_x": 0.2, "workpiece_tilt_y": tilt, "workpiece.plane.level": 3e-3},
        **{"workpiece_x": 0.01, "workpiece_y": 0.02, "workpiece_z": 0.05, "lift": 2e-3},
    )
    normal = Rotation.from_euler("YX", [tilt, 0.2]).apply([0, 0, 1])
    u = Rotation.from_euler("ZX", [0.4, 0.6]).apply([0, 0, 1])
    distance = normal @ (np.array([0.1, 0.2, 0.4]) - [0.01, 0.02, 0.05]) - 5e-3
    assert head.distance_true == pytest.approx(distance, abs=EXACT_M)
    assert head.distance_along == pytest.approx(distance / (normal @ u), abs=EXACT_M)
    assert head.distance == head.distance_along


Profile = Callable[[np.ndarray], np.ndarray]


def obstacle(rise: float, flank: float) -> Profile:
    """A rise with the smooth cubic, from 0 on."""

    def height(s: np.ndarray) -> np.ndarray:
        u = np.clip(np.asarray(s) / flank, 0, 1)
        return rise * u * u * (3 - 2 * u)

    return height


def bar(radius: float) -> Profile:
    """A circle up to 0.95 of its radius, its tangent from there on."""

    def height(s: np.ndarray) -> np.ndarray:
        round_part = np.clip(s, -0.95 * radius, 0.95 * radius)
        over = np.abs(s - round_part)
        return np.sqrt(radius**2 - round_part**2) - radius - over * 0.95 / np.sqrt(1 - 0.95**2)

    return height


# Surface, its parameters, its profile, largest curvature in 1/m
SURFACES = {
    "inclined": ({"angle": 0.7}, lambda s: np.tan(0.7) * s, 0.0),
    "sine": (
        {"amplitude": 2e-3, "wavelength": 0.05, "phase": 1.0},
        lambda s: 2e-3 * np.sin(2 * np.pi * s / 0.05 + 1.0),
        2e-3 * (2 * np.pi / 0.05) ** 2,
    ),
    "step": ({"rise": 2.8e-3, "flank": 5e-3}, obstacle(2.8e-3, 5e-3), 6 * 2.8e-3 / 5e-3**2),
    "cylinder": ({"radius": 0.05}, bar(0.05), 0.0),
}


def nearest_on(profile: Profile, at_s: float, z: float) -> float:
    """The least of all local minima, each by scipy."""
    s = np.linspace(at_s - 0.2, at_s + 0.2, 40001)
    d = np.hypot(s - at_s, profile(s) - z)
    found = np.flatnonzero((d[1:-1] <= d[:-2]) & (d[1:-1] <= d[2:])) + 1
    least = float(d.min())
    for k in found[np.argsort(d[found])[:4]]:
        bounds = (s[k] - 1e-5, s[k] + 1e-5)
        best = minimize_scalar(
            lambda q: float((q - at_s) ** 2 + (profile(q) - z) ** 2),
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-12},
        )
        least = min(least, float(np.sqrt(best.fun)))
    return least


@pytest.mark.parametrize("surface", SURFACES)
def test_orthogonal_distance_is_that_of_the_nearest_point(head, surface):
    """Within 1e-9 m as long as gap times curvature stays below 50; profiles in any direction."""
    values, profile, curvature = SURFACES[surface]
    numbers = np.random.default_rng(3)
    for _ in range(25):
        gap = numbers.uniform(1e-3, min(0.15, 50 / curvature if curvature else 1.0))
        s, across, azimuth = numbers.uniform(-0.04, 0.04, 3) * [1, 1, 50]
        place = complex(s, across) * np.exp(1j * azimuth)
        z = float(profile(s)) + gap
        given = {f"workpiece.{surface}.{name}": value for name, value in values.items()}
        head.restart(
            **at(x=place.real, y=place.imag, z=z),
            **given,
            **{f"workpiece.{surface}.azimuth": azimuth},
        )
        assert head.distance_true == pytest.approx(nearest_on(profile, s, z), abs=1e-9)


@pytest.mark.parametrize("rise", [5e-3, -5e-3])
def test_corners_of_a_ramp_are_found(head, rise):
    """Three straight lines: the distance from each piece in closed form."""
    corners = np.array([[-0.5, 0.0], [0.01, 0.0], [0.04, rise], [0.5, rise]])
    for s in np.linspace(-0.02, 0.07, 31):
        point = np.array([s, np.interp(s, corners[:, 0], corners[:, 1]) + 0.08])
        least = np.inf
        for begin, end in pairwise(corners):
            way = end - begin
            share = np.clip((point - begin) @ way / (way @ way), 0, 1)
            least = min(least, np.linalg.norm(point - begin - share * way))
        head.restart(
            **at(x=point[0], z=point[1]),
            **{"workpiece.ramp.rise": rise, "workpiece.ramp.start": 0.01},
            **{"workpiece.ramp.length": 0.03},
        )
        assert head.distance_true == pytest.approx(least, abs=EXACT_M)


def test_two_waves_in_different_directions(head):
    """Gap times curvature is 0.28 at most: below 1e-9 m, by the simplex search of scipy."""
    numbers = np.random.default_rng(4)
    start = {"workpiece.sine.amplitude": 1e-3, "workpiece.sine.azimuth": 0.4}
    start |= {"workpiece.inclined.angle": 0.2, "workpiece.inclined.azimuth": 1.7}
    waves = {"amplitude": [0.5e-3, 0.0, 0.0, 0.0], "wavelength": [0.2, 1.0, 1.0, 1.0]}
    waves |= {"phase": [0.0] * 4, "azimuth": -0.9}
    start |= {f"workpiece.waviness.{name}": value for name, value in waves.items()}

    def along(q, azimuth: float) -> float:
        return float(q[0] * np.cos(azimuth) + q[1] * np.sin(azimuth))

    def height(q) -> float:
        sine = 1e-3 * np.sin(2 * np.pi * along(q, 0.4) / 0.1)
        wave = 0.5e-3 * np.sin(2 * np.pi * along(q, -0.9) / 0.2)
        return float(sine + wave + np.tan(0.2) * along(q, 1.7))

    for _ in range(10):
        p = numbers.uniform(-0.05, 0.05, 2)
        z = height(p) + numbers.uniform(0.01, 0.06)
        head.restart(**at(x=p[0], y=p[1], z=z), **start)
        best = minimize(
            lambda q, p=p, z=z: float(((q - p) ** 2).sum() + (height(q) - z) ** 2),
            p,
            method="Nelder-Mead",
            options={"xatol": 1e-9, "fatol": 1e-20},
        )
        assert head.distance_true == pytest.approx(np.sqrt(best.fun), abs=1e-9)


def test_along_the_tool_the_beam_meets_the_wave(head):
    """Slope 0.063 times tan(45 degrees) is below 0.1."""
    for s in np.linspace(0.0, 0.1, 11):
        pose = at(x=s, z=0.08, c=np.pi / 2, a=np.pi / 4)
        head.restart(**pose, **{"workpiece.sine.amplitude": 1e-3, "workpiece.sine.wavelength": 0.1})
        d = head.distance_along * np.sqrt(0.5)
        hit = s - d  # u is (1, 0, 1)/sqrt(2)
        assert 0.08 - d == pytest.approx(1e-3 * np.sin(2 * np.pi * hit / 0.1), abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 30.0, 60.0])
def test_electrode_across_an_inclined_tool_tells_the_mean_of_a_disc(head, angle):
    """d (1 + sqrt(1 - (r tan b/d)^2))/2 of an ideal disc, d along the tool."""
    head.restart(**at(z=0.05, a=np.radians(angle)), quantity=2, electrode_radius=5e-3)
    along = 0.05 / np.cos(np.radians(angle))
    q = (5e-3 * np.tan(np.radians(angle)) / along) ** 2
    assert head.distance == pytest.approx(along * (1 + np.sqrt(1 - q)) / 2, rel=1e-6)
    head.restart(**at(z=0.05, a=np.radians(angle)), quantity=1)
    assert head.distance == pytest.approx(0.05, abs=EXACT_M)


@pytest.mark.parametrize("x", [0.049, 0.051])
def test_border_counts_where_the_beam_hits(head, x):
    """The clamping point is 80 mm away from the border when the beam passes it."""
    pose = at(x=x + 0.08, z=0.08, c=np.pi / 2, a=np.pi / 4)
    head.restart(**pose, **{"workpiece.border.position": 0.05})
    assert head.valid is (x < 0.05)
    assert head.distance == pytest.approx(0.08 * np.sqrt(2) if x < 0.05 else 0.5, abs=1e-12)


@pytest.mark.parametrize("angle", [90.0, 120.0])
def test_tool_that_does_not_point_at_the_surface_sees_nothing(head, angle):
    head.restart(**at(z=0.08, a=np.radians(angle)))
    assert (head.valid, head.touching, head.distance) == (False, False, 0.5)
    assert head.distance_true == pytest.approx(0.08, abs=EXACT_M)


def test_touch_is_located(head):
    """5 mm above the clamping point at 50 mm/s, over a tilted sheet."""
    head.restart(
        z_start=5e-3, z_end=-5e-3, z_rate_start=-0.05, z_rate_end=-0.05, step_size=0.2, a_end=0.0
    )
    head.step_to(0.12)
    assert head.touch_time == pytest.approx(0.1, abs=1e-9)
    assert (head.touching, head.touch_count, head.distance) == (True, 1, 0.0)
    assert head.distance_true == pytest.approx(-1e-3, abs=1e-12)
