"""What 3D distance control makes of axes that are not where they were sent: the lag, and REF.

Both encoders: the distance counts for where the axes were sent, sensor less the lag along the
normal (P-CHAN-00810, FCT-M3 7.1). Without them it is what the sensor gives.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

Make = Callable[..., Any]
SLOPE_DEG = 30.0
INCLINED = (0.0, math.sin(math.radians(SLOPE_DEG)), math.cos(math.radians(SLOPE_DEG)))
HEIGHT_MM = 80.0
LAG_MM = (0.0, 0.3, 0.4)


def lagging(loop: Any, lag_mm: Sequence[float]) -> Any:
    """One cycle in which the axes are by so much beside where they were sent."""
    for link, lag in zip(loop.links, lag_mm, strict=False):
        link.actual_mm = link.set_mm + lag
    return loop.run(1).control


def make(make_tool_loop: Make, tool: Any, mode: str, **changes: Any) -> Any:
    """A control at its distance; the tool of ECS is upright on an inclined plane."""
    normal = INCLINED if mode == "ECS" else (0.0, 0.0, 1.0)
    pose = ((0.0, 0.0, 0.0), 0.0, -SLOPE_DEG if mode == "ECS" else 0.0)
    loop = make_tool_loop(lambda _cycle: pose, tool.plane(np.array(normal)), kp=0.5, **changes)
    loop.plan(mode, "Z", normal=normal)
    return loop


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("both_encoders", [False, True])
@pytest.mark.parametrize("mode", ["ACS", "MCS", "ECS"])
def test_with_both_encoders_the_lag_along_the_normal_is_no_distance(
    make_tool_loop: Make, tool: Any, mode: str, both_encoders: bool, sign: float
) -> None:
    """An axis is its own normal; 0.3 mm in Y and 0.4 mm in Z are 0.496 mm along one of 30 degrees.

    kp 0.5 takes half of what is not at SET_DIST.
    """
    loop = make(make_tool_loop, tool, mode, both_encoders=both_encoders)
    loop.on(set_dist=HEIGHT_MM)
    loop.run(3)
    assert loop.offsets_mm == pytest.approx([0.0] * 3, abs=1e-9)
    normal = INCLINED if mode == "ECS" else (0.0, 0.0, 1.0)
    along_mm = sign * float(np.dot(normal, LAG_MM))
    control = lagging(loop, [sign * mm for mm in LAG_MM])
    assert control.distance_mm == pytest.approx(HEIGHT_MM + along_mm, abs=1e-9)
    left_mm = 0.0 if both_encoders else along_mm
    assert control.feedback_mm == pytest.approx(HEIGHT_MM + left_mm, abs=1e-9)
    assert control.error_mm == pytest.approx(-left_mm, abs=1e-9)
    assert control.offset_mm == pytest.approx(-0.5 * left_mm, abs=1e-9)


@pytest.mark.parametrize("both_encoders", [False, True])
@pytest.mark.parametrize("mode", ["ACS", "MCS", "ECS"])
def test_the_surface_is_where_the_actual_axes_and_the_sensor_say(
    make_tool_loop: Make, tool: Any, mode: str, both_encoders: bool
) -> None:
    """In SET_POS a lag moves no surface, with one encoder as with both: nothing is to follow."""
    loop = make(make_tool_loop, tool, mode, both_encoders=both_encoders)
    # An axis counts from its own 0: the pivot is 180 mm above the plane, its clamping point 80 mm
    surface_mm = 100.0 if mode == "ACS" else 0.0
    loop.on(set_pos=surface_mm)
    loop.run(3)
    control = lagging(loop, LAG_MM)
    assert control.surface_mm == pytest.approx(surface_mm, abs=1e-9)
    assert control.feedback_mm == pytest.approx(0.0, abs=1e-9)
    assert control.offset_mm == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("mode", ["ACS", "MCS", "ECS"])
def test_ref_takes_the_values_of_axes_that_swing_around_where_they_stand(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """Set positions stand: the mean of the last four is 0 and not the last swing."""
    loop = make(make_tool_loop, tool, mode, n_cycles=4)
    loop.run(3)
    for swing_mm in (0.4, -0.1, 0.3, -0.6):
        lagging(loop, (0.0, 0.0, swing_mm))
    loop.control.reference(loop.control3d.require_sensor())
    assert loop.control.zero_mm == pytest.approx(-HEIGHT_MM, abs=1e-9)


@pytest.mark.parametrize("mode", ["ACS", "MCS", "ECS"])
def test_ref_begins_anew_where_the_axes_are_sent_elsewhere(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """Along the normal too: two values at 81 mm, four before them at 80 mm."""
    loop = make(make_tool_loop, tool, mode, n_cycles=6)
    loop.run(4)
    ((x, y, z), c, a), normal = loop.program(0), INCLINED if mode == "ECS" else (0.0, 0.0, 1.0)
    loop.program = lambda _cycle: ((x + normal[0], y + normal[1], z + normal[2]), c, a)
    loop.run(3)
    loop.control.reference(loop.control3d.require_sensor())
    assert loop.control.zero_mm == pytest.approx(-HEIGHT_MM - 1.0, abs=1e-9)
