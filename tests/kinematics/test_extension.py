"""Kinematic 98, the virtually extended tool: FCT-M3 12.4.2 and 12.9 with the length 80 mm."""

import math
from collections.abc import Sequence

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic, KinematicData, build
from axisrig.kernel.kinematics.extension import ExtendedTool

HD1_MM = 100.0


def _extended(hd: Sequence[float], head_mm: float = 0.0, tool_mm: float = 80.0) -> Kinematic:
    written = {(1, 98, k): 1e4 * value for k, value in enumerate(hd)}
    written[0, 9, 0] = 1e4 * head_mm
    return build([9, 98], KinematicData(), written, tool_mm)


@pytest.mark.parametrize(
    ("start", "end", "tilt", "l2_mm"),
    [
        (30, 60, 0, 80.0),
        (30, 60, 30, 80.0),
        (30, 60, 45, 97.980),
        (30, 60, 60, 138.564),
        (30, 60, 75, 138.564),
        (50, 70, 70, 150.351),
        (50, 70, 90, 150.351),
        (10, 31, 31, 91.913),
        (90, 0, 89, 80.0),
    ],
)
def test_the_length_of_the_tool_over_the_tilt(
    start: float, end: float, tilt: float, l2_mm: float
) -> None:
    kinematic = _extended((HD1_MM, start, end, 91))
    for c, sign in ((0, 1), (70, -1)):
        pose = (1.0, 2.0, 3.0, c, sign * tilt)
        assert kinematic.length_mm(pose) == pytest.approx(l2_mm, abs=5e-4)
        assert kinematic.tilt_deg(pose) == pytest.approx(tilt, abs=1e-9)


@pytest.mark.parametrize("tilt", [31.0, 45.0, 60.0])
def test_between_both_angles_the_clamping_point_keeps_its_height(tilt: float) -> None:
    kinematic = _extended((HD1_MM, 30, 60, 91))
    height_mm = kinematic.clamp_mm((0, 0, 0, 15, tilt))[2]
    assert height_mm == pytest.approx(80 * math.cos(math.radians(30)), abs=1e-12)


def test_above_hd3_the_frozen_tool_lets_the_head_down_to_the_surface() -> None:
    kinematic = _extended((HD1_MM, 50, 70, 91))
    assert kinematic.clamp_mm((0, 0, 0, 0, 90))[2] == pytest.approx(0, abs=1e-12)


def test_without_hd3_the_height_is_kept_up_to_hd4() -> None:
    """[0; -] of FCT-M3 12.9: from the first degree on."""
    kinematic = _extended((0, 0, 0, 80))
    for tilt in (10, 45, 80):
        assert kinematic.clamp_mm((0, 0, 0, 0, tilt))[2] == pytest.approx(80, abs=1e-12)


@pytest.mark.parametrize(
    ("tool_mm", "hd1_mm", "head_mm", "lever_mm"),
    [(80, 100, 0, 180), (80, 0, 100, 180), (80, 100, 30, 210), (80, 0, 0, 80)],
)
def test_each_length_counts_once_in_the_lever(
    tool_mm: float, hd1_mm: float, head_mm: float, lever_mm: float
) -> None:
    """From the A axis to the TCP: tool, HD1 of 98 and HD1 of 9."""
    kinematic = _extended((hd1_mm, 30, 60, 91), head_mm, tool_mm)
    assert kinematic.forward((0, 0, 0, 0, 0))[2] == pytest.approx(-lever_mm, abs=1e-12)
    further = lever_mm + 80 * math.cos(math.radians(30)) / math.cos(math.radians(45)) - 80
    if tool_mm == 80:
        y, z = kinematic.forward((0, 0, 0, 0, 45))[1:3]
        assert math.hypot(y, z) == pytest.approx(further, abs=1e-12)


@pytest.mark.provokes(900444, 2, limit_deg="91")
def test_above_hd4_the_program_ends() -> None:
    kinematic = _extended((HD1_MM, 50, 70, 91))
    near = (0.0, 0.0, 0.0, 0.0, 0.0)
    kinematic.inverse((0, 0, 0, 0, 91), near)
    with pytest.raises(Alarm, match=r"tilted by 91\.1000 deg"):
        kinematic.inverse((0, 0, 0, 0, 91.1), near)


@pytest.mark.parametrize("largest", range(61, 121))
def test_a_tilt_of_hd4_itself_is_allowed(largest: int) -> None:
    """Whatever the rounding of the tilt is."""
    kinematic = _extended((HD1_MM, 30, 60, largest))
    for c in (0.0, 20.0, 77.7):
        kinematic.inverse((0, 0, 0, c, -largest), (0.0,) * 5)


def test_the_first_step_does_the_rest() -> None:
    kinematic = _extended((HD1_MM, 30, 60, 91))
    axes = (10.0, 20.0, 30.0, 40.0, -50.0)
    assert kinematic.inverse(kinematic.forward(axes), axes) == pytest.approx(axes, abs=1e-12)
    assert (kinematic.name, kinematic.count) == ("9, 98", 5)


def test_where_the_tilt_passes_the_angles_of_98() -> None:
    """On a way of A alone the tilt is |A|; with HD2 at 90 degrees the length never changes."""
    start, end = (0.0, 0.0, 0.0, 20.0, -40.0), (9.0, 0.0, 0.0, 20.0, 80.0)
    kinks = _extended((HD1_MM, 30, 60, 91)).kinks(start, end)
    assert [-40.0 + 120.0 * share for share in kinks] == pytest.approx([-30, 30, 60], abs=1e-9)
    assert _extended((HD1_MM, 90, 0, 91)).kinks(start, end) == ()
    assert _extended((HD1_MM, 30, 60, 91)).kinks(start, start) == ()
    twice = ExtendedTool(_extended((HD1_MM, 30, 60, 91)), 0.0, 25.0, 35.0, 91.0)
    both = [-40.0 + 120.0 * share for share in twice.kinks(start, end)]
    assert both == pytest.approx([-35, -30, -25, 25, 30, 35, 60], abs=1e-9)  # of both steps


@pytest.mark.parametrize("tilt", [89.9, 90.0, 90.1, 120.0, 179.0])
def test_from_hd2_at_90_degrees_on_the_tool_is_never_longer(tilt: float) -> None:
    """Its height cannot be kept there: a cosine of 0 would make the length 0."""
    for start in (90.0, 90.5):
        kinematic = _extended((HD1_MM, start, 0, 180))
        assert kinematic.length_mm((0, 0, 0, 30, tilt)) == 80.0


def test_kinks_lie_between_the_ends_of_the_way() -> None:
    """The tilt passes HD2 at the very begin, and at the very end."""
    kinematic = _extended((HD1_MM, 30, 60, 91))

    def at(tilt: float) -> tuple[float, ...]:
        return (0.0, 0.0, 0.0, 0.0, tilt)

    assert kinematic.kinks_along(lambda share: at(40.0 if share >= 1.0 else 20.0)) == ()
    assert kinematic.kinks_along(lambda share: at(40.0 if share > 0.5 else 20.0)) == (
        pytest.approx(0.5),
    )
    assert kinematic.kinks_along(lambda _: at(30.0)) == ()


def test_a_clamping_point_is_as_far_from_the_tool_centre_point_as_the_tool_is_long() -> None:
    """C 90 and A 30 tilt the tool towards +X (u = (sin C sin A, -cos C sin A, cos A))."""
    kinematic = _extended((HD1_MM, 50, 70, 91))
    found = kinematic.clamp_mm((10.0, 20.0, 30.0, 90.0, 30.0))
    assert found == pytest.approx((10.0 + 40.0, 20.0, 30.0 + 80.0 * math.cos(math.radians(30.0))))
    assert kinematic.nominal_length_mm((0.0, 0.0, 0.0, 0.0, 60.0)) == 80.0
