"""The touch probe at a head: its clearance is a bound, and it is the TouchProbe at the tip."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

MODEL = "AxisRig.Sensors.HeadTouchProbe"
HEAD = {
    "head.hd1": 0.1,
    "head.hd2": 0.035,
    "head.hd5": 0.004,
    "head.hd6": -0.003,
    "head.hd9": 0.006,
    "tool_length": 0.08,
}
NAMES = "xyzca"


def at(axes) -> dict[str, float]:
    """Inputs of a step in which the axes rest; m and rad."""
    places = zip(NAMES, axes, strict=True)
    return {f"{n}_{end}": float(v) for n, v in places for end in ("start", "end")}


def tip(axes) -> np.ndarray:
    x, y, z, c, a = axes
    about_c, about_a = Rotation.from_euler("z", c), Rotation.from_euler("x", a)
    down = about_a.apply([0.0, 0.006, -0.18])
    return np.array([x, y, z]) + about_c.apply(np.array([-0.003, 0.004, -0.035]) + down)


def test_the_tip_is_where_the_axes_put_it(load):
    rng = np.random.default_rng(1)
    fmu = load(MODEL, **HEAD, **at((0.0, 0.0, 1.0, 0.0, 0.0)))
    for _ in range(20):
        axes = rng.uniform(-1, 1, 5) * (0.1, 0.1, 0.1, math.pi, 1.5) + (0, 0, 1, 0, 0)
        fmu.set(step_time=fmu.time, step_size=1e-3, **at(axes))
        fmu.step(1e-3)
        assert (fmu.tcp_x, fmu.tcp_y, fmu.tcp_z) == pytest.approx(tuple(tip(axes)), abs=1e-12)


def test_no_way_as_long_as_the_clearance_reaches_the_plane(load):
    """In the worst direction, too; lengths in mm, a degree counted as one."""
    rng = np.random.default_rng(2)
    normal = np.array([0.6, 0.0, 0.8])
    plane = dict(zip(("normal_x", "normal_y", "normal_z"), normal, strict=True))
    fmu = load(
        MODEL, **HEAD, **{f"probe.{n}": float(v) for n, v in plane.items()}, **at((0, 0, 1, 0, 0))
    )
    unit = np.array([1e-3, 1e-3, 1e-3, math.radians(1.0), math.radians(1.0)])
    nearest = math.inf
    for _ in range(30):
        axes = rng.uniform(-1, 1, 5) * (0.05, 0.05, 0.05, math.pi, 1.5) + (0, 0, 0.35, 0, 0)
        fmu.set(step_time=fmu.time, step_size=1e-3, **at(axes))
        fmu.step(1e-3)
        gap, room_mm = fmu.gap, fmu.clearance * 1e3
        assert gap == pytest.approx(normal @ tip(axes) - 0.1, abs=1e-12)
        steps = np.eye(5) * 1e-7
        slope = [(normal @ (tip(axes + s * unit) - tip(axes - s * unit))) / 2e-7 for s in steps]
        way = room_mm * np.array(slope) / np.linalg.norm(slope)
        left = [abs(normal @ tip(axes + sign * way * unit) - 0.1) for sign in (-1, 1)]
        nearest = min(nearest, min(left) / abs(gap))
        assert min(left) > 0
        assert room_mm * 1e-3 < abs(gap)
    assert nearest < 0.5, "far too careful"
