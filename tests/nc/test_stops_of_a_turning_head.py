"""A run that ends early while the head turns: every axis of the kinematic has moved."""

import pytest
from tests.nc.five_axes import ON, direction, machine, printed, run5

LAG = 0.5
"""mm of X, Y and Z, degrees of C and A."""
TCP = '#MSG["%.9g %.9g %.9g", V.A.ABS.X, V.A.ABS.Y, V.A.ABS.Z]'


@pytest.mark.parametrize(("turn", "angle"), [("", 0.0), (" C90", 45.0), (" C-60", -30.0)])
def test_after_a_run_the_tool_is_where_the_axes_have_stopped(turn: str, angle: float) -> None:
    """Down from Z 120 to 100 and met at 110, half of the turn with it; X and Y stay 10 and 20."""
    at = machine(plane=("Z", 110.0))
    text = f"{ON}G1 X10 Y20 Z120 A30 F1000\nG100 Z100{turn} F100\n{TCP}\n"
    numbers = printed(run5(text + '#MSG["%.9g", V.A.ABS.C]', at))
    assert numbers == pytest.approx([10.0, 20.0, 110.0, angle])


def test_a_move_after_it_begins_there() -> None:
    """G91 by 1 in X from the tool, and no other axis of it moves."""
    at = machine(plane=("Z", 110.0))
    run5(f"{ON}G1 X10 Y20 Z120 A30 F1000\nG100 Z100 C90 F100\nG91 G1 X1 F100", at)
    assert at.tool() == pytest.approx({"X": 11.0, "Y": 20.0, "Z": 110.0, "C": 45.0, "A": 30.0})


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_the_actual_position_of_the_tool_is_that_of_all_actual_axes(axis: str) -> None:
    """Each of the five axes is 0.5 mm or degrees ahead of where it was sent."""
    at = machine()
    at.lag_mm = LAG
    text = f'{ON}G1 X10 Y20 Z120 C40 A30 F1000\n#MSG["%.9g", V.A.ACT_POS.{axis}]'
    (shown,) = printed(run5(text, at))
    pivot = [at.acs_mm[name] + LAG for name in "XYZ"]
    tool = pivot - 80.0 * direction(40.0 + LAG, 30.0 + LAG)
    assert shown == pytest.approx(tool["XYZ".index(axis)])
