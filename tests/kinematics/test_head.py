"""Kinematic 9: signs of the head, pose by pose, computed by hand."""

import math

import pytest
from tests.kinematics.machines import MACHINES

from axisrig.kernel.kinematics import HeadCA


def _head(*hd: float, tool_mm: float = 80.0) -> HeadCA:
    return HeadCA(hd, tool_mm)


@pytest.mark.parametrize(
    ("c", "a", "u"),
    [
        (0, 0, (0, 0, 1)),
        (0, 90, (0, -1, 0)),
        (90, 90, (1, 0, 0)),
        (0, -45, (0, math.sqrt(0.5), math.sqrt(0.5))),  # leans to +Y
    ],
)
def test_the_tool_leans_right_handed(c: float, a: float, u: tuple[float, ...]) -> None:
    assert _head().direction((0, 0, 0, c, a)) == pytest.approx(u, abs=1e-12)


def test_the_shift_of_an_offset_along_the_tool() -> None:
    """A deviation of 1.5 mm with A -35 and C 20: 1.8312 mm along the tool."""
    u = _head().direction((0, 0, 0, 20, -35))
    along_mm = 1.5 / u[2]
    assert along_mm == pytest.approx(1.8312, abs=5e-5)
    assert along_mm * u[0] == pytest.approx(-0.3592, abs=5e-5)
    assert along_mm * u[1] == pytest.approx(0.9870, abs=5e-5)
    assert along_mm * math.hypot(u[0], u[1]) == pytest.approx(1.0503, abs=5e-5)


@pytest.mark.parametrize(
    ("hd", "axes", "tcp"),
    [
        ((100,), (1, 2, 3, 0, 0), (1, 2, 3 - 180)),
        ((100, 50), (0, 0, 0, 0, 0), (0, 0, -230)),
        ((100, 50), (0, 0, 0, 0, 90), (0, 180, -50)),
        ((100, 50), (0, 0, 0, 90, 90), (-180, 0, -50)),
        ((0, 0, 90), (0, 0, 0, 0, 0), (0, 80, 0)),
        ((0, 0, 90, 90), (0, 0, 0, 0, 0), (-80, 0, 0)),
        ((0, 0, 0, 0, 7), (0, 0, 0, 0, 0), (0, 7, -80)),
        ((0, 0, 0, 0, 7), (0, 0, 0, 90, 0), (-7, 0, -80)),
        ((0, 0, 0, 0, 0, 7), (0, 0, 0, 90, 0), (0, 7, -80)),
        ((0, 0, 0, 0, 0, 0, 7, 8), (0, 0, 0, 90, 0), (7, 8, -80)),
        ((0, 0, 0, 0, 0, 0, 0, 0, 9), (0, 0, 0, 0, 90), (0, 80, 9)),
    ],
)
def test_where_each_offset_leads(
    hd: tuple[float, ...], axes: tuple[float, ...], tcp: tuple[float, ...]
) -> None:
    assert _head(*hd).forward(axes)[:3] == pytest.approx(tcp, abs=1e-12)


def test_the_way_back_needs_no_pose_before() -> None:
    kinematic = MACHINES["9"].kernel()
    tool = (10.0, 20.0, 30.0, 400.0, -50.0)
    near = (0.0,) * 5
    assert kinematic.forward(kinematic.inverse(tool, near)) == pytest.approx(tool, abs=1e-12)
