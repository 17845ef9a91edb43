"""A circle of a tilted and shifted system on three real axes, from the text of a program."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

RADIUS_MM = 20.0
# An angle B of 15 degrees tilts Z of the system from (0, 0, 1) to this
NORMAL = np.array([math.sin(math.radians(15)), 0.0, math.cos(math.radians(15))])
PROGRAM = """\
N10 G54 G90 G0 X0 Y0 Z200
N20 #CS ON[10,5,200,0,15,0]
N30 G92 X3
N40 D2
N50 G1 X20 Y0 Z0 F3000
N60 G3 X20 Y0 I-20 F2000
N70 #CS OFF
"""


@pytest.mark.long
def test_set_positions_of_a_full_circle_lie_on_the_tilted_circle(
    run_nc: Callable[..., Any],
) -> None:
    """Centre by hand: shifted origin (10, 5, 233), X3 along X of the system, the fixed tool of 50
    mm along Z of the axes; no formula of the kernel.
    """
    outcome = run_nc(PROGRAM, "", base="probe-xyz-ball.toml")
    assert outcome.alarms == []
    along_x = np.array([math.cos(math.radians(15)), 0.0, -math.sin(math.radians(15))])
    centre = np.array([10.0, 5.0, 233.0]) + 3.0 * along_x + np.array([0.0, 0.0, 50.0])
    points = np.stack([outcome.column(f"{axis}.set_mm") for axis in "XYZ"], axis=1)
    begin = centre + RADIUS_MM * along_x
    at_begin = np.flatnonzero(np.linalg.norm(points - begin, axis=1) < 1e-9)
    on_circle = points[at_begin[0] : at_begin[-1] + 1] - centre
    assert len(on_circle) > 1000
    assert np.abs(np.linalg.norm(on_circle, axis=1) - RADIUS_MM).max() < 1e-9
    assert np.abs(on_circle @ NORMAL).max() < 1e-9
    # Counter-clockwise about the normal, once round
    across = np.cross(NORMAL, along_x)
    angle = np.unwrap(np.arctan2(on_circle @ across, on_circle @ along_x))
    assert np.all(np.diff(angle) > -1e-5)
    assert abs(math.degrees(angle[-1] - angle[0]) - 360) < 1e-6
