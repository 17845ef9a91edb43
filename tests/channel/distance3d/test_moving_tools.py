"""3D distance control beside a tool that moves: what it reads, what stays, how ERROR ends."""

import math
from typing import Any

import pytest
from tests.channel.distance3d.programs import Make

from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA

COUNT = 5


def test_the_distance_is_shorter_by_the_tilt_that_the_tool_actually_has(
    make_tool_loop: Make,
) -> None:
    """A turns by a degree in each cycle, its drive is a cycle late: L (1 - cos a) of where it is.

    12.1.2 of FCT-M3; a dry run, so that nothing is put out.
    """
    loop = make_tool_loop(lambda cycle: ((0.0, 0.0, 0.0), 0.0, 10.0 + cycle))
    loop.plan("MCS").on(set_dist=80.0, dry_run=True)
    for _ in range(10):
        actual = [link.actual_mm for link in loop.links]
        for link, position_mm in zip(loop.links, loop.base(loop.cycle + 1), strict=True):
            link.set_mm = position_mm  # what was sent is a step ahead
        distance_mm = loop.plane.distance_mm(actual, loop.cycle)
        loop.run(1)
        shorter_mm = 80.0 * (1.0 - math.cos(math.radians(actual[4])))
        assert loop.control.feedback_mm == pytest.approx(distance_mm + shorter_mm, abs=1e-9)


@pytest.mark.parametrize(
    ("mode", "axis", "moves", "waits"),
    [
        ("ACS", "Z", "X", False),  # the surface under Z is where it was, as far as anybody knows
        ("ACS", "Z", "Z", True),
        ("ACS", "X", "X", True),
        ("MCS", None, "X", True),
        ("MCS", None, "Z", True),
        ("MCS", None, None, False),
    ],
)
def test_a_reference_waits_for_the_axes_whose_motion_changes_the_distance(
    make_tool_loop: Make, mode: str, axis: str | None, moves: str | None, waits: bool
) -> None:
    """As many values as its filter has, since any of them was last sent anywhere."""
    names = ("X", "Y", "Z")

    def place(cycle: int) -> tuple[tuple[float, ...], float, float]:
        return tuple(0.01 * cycle if name == moves else 0.0 for name in names), 0.0, 0.0

    loop = make_tool_loop(place, filter_type="MOVING_AVERAGE", n_cycles=COUNT)
    loop.plan(mode, axis)
    loop.run(3 * COUNT)
    assert loop.control3d.may_reference() is not waits


@pytest.mark.parametrize("anew", [None, HeadCA((150.0,), 80.0), HeadCA((100.0,), 60.0)])
def test_an_offset_stays_on_its_axes_whatever_kinematic_comes(
    make_tool_loop: Make, tool: Any, anew: HeadCA | None
) -> None:
    """Frozen along the tool; with the kinematic gone, or another one, the tool turns on by A."""
    turns_from = 20

    def place(cycle: int) -> tuple[tuple[float, ...], float, float]:
        return (0.0, 0.0, 0.0), 20.0, 30.0 + 0.5 * max(0, cycle - turns_from)

    loop = make_tool_loop(place, tool.plane(height_mm=lambda _k: 1.0))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(5).say(DistanceCommand.FREEZE).run(2)
    kept = dict(loop.control3d.deltas_mm)
    assert len(kept) == 3
    loop.kinematic = anew
    loop.run(30)
    assert loop.base(loop.cycle - 1)[4] > 35.0
    for name, delta_mm in loop.control3d.deltas_mm.items():
        assert delta_mm == pytest.approx(kept[name], abs=1e-9)


@pytest.mark.parametrize("ends", ["switch_off_kept", "end_program"])
@pytest.mark.parametrize("fails", [False, True])
def test_an_error_of_3d_control_stays_until_a_reset_and_its_offset_too(
    make_tool_loop: Make, tool: Any, ends: str, fails: bool
) -> None:
    """1 mm is the most; a surface that rises by 3 mm in ERROR holds it there."""
    height_mm = 3.0 if fails else 0.5
    loop = make_tool_loop(
        plane=tool.plane(height_mm=lambda _k: height_mm), kp=0.5, max_deviation_mm=1.0
    ).plan("MCS")
    loop.on(set_pos=0.0)
    if fails:
        with pytest.raises(Alarm):
            loop.run(30)
    else:
        loop.run(30)
    offset_mm = loop.control.offset_mm
    assert offset_mm == pytest.approx(1.0 if fails else 0.5, abs=1e-3)
    getattr(loop.control3d, ends)()
    assert loop.control.state is (DistanceState.ERROR if fails else DistanceState.INACTIVE)
    assert loop.control.offset_mm == offset_mm
    loop.control.switch_off_kept()
    assert loop.control.state is DistanceState.INACTIVE


def test_the_end_of_a_program_forgets_its_mode_and_its_direction(make_tool_loop: Make) -> None:
    loop = make_tool_loop().plan("ACS", "Z")
    assert (loop.control3d.wanted_mode, loop.control3d.wanted_axis) == ("ACS", "Z")
    loop.control3d.end_program()
    assert (loop.control3d.wanted_mode, loop.control3d.wanted_axis) == ("MCS", None)
    loop.kinematic = None
    assert loop.control3d.wanted_mode == "ACS"
