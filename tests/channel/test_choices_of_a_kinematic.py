"""Choices of a kinematic that a path keeps with their times, and their end with the program."""

import math
from types import SimpleNamespace
from typing import Any

import pytest
from tests.kinematics.machines import MACHINES

from axisrig.kernel.channel.path.transformation import Transformation
from axisrig.kernel.kinematics import KinematicData, build
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block


def test_choices_of_a_kinematic_are_those_that_change_something() -> None:
    clock: Any = type("Clock", (), {"now_ns": 0})()
    path = Transformation(clock, ())
    kinematic: Any = object()
    on = canon.KinematicChoice(Block(1, 1, ""), kinematic)
    off = canon.KinematicChoice(Block(2, 2, ""), None)
    path.end()
    path.choose(off)
    assert path.choices == []
    for clock.now_ns, command in ((10, on), (20, on), (30, off), (40, off), (50, on)):
        path.choose(command)
    assert path.kinematic is kinematic
    clock.now_ns = 60
    path.end()
    path.end()
    assert path.choices == [(10, on), (20, on), (30, None), (50, on), (60, None)]
    assert path.coordinates((1.0, 2.0)) == (1.0, 2.0)
    assert path.state() == (None, None)


@pytest.mark.parametrize("machine", ["9", "45"])
def test_tilt_and_length_are_those_of_the_tool_where_the_axes_are(machine: str) -> None:
    """By the chain of matrices: the angle of u to Z, at the actual positions."""
    lists = MACHINES[machine]
    kernel, oracle = lists.kernel(), lists.oracle()
    for axes in lists.axes(3, seed=2):
        links: Any = [SimpleNamespace(actual_mm=float(at)) for at in (*axes, 55.0)]
        path = Transformation(SimpleNamespace(now_ns=0), links)  # type: ignore[arg-type]
        path.choose(canon.KinematicChoice(Block(1, 1, ""), kernel))
        u = oracle.direction(axes[None])[0]
        tilt_deg = math.degrees(math.acos(u[2]))
        assert path.state() == pytest.approx((tilt_deg, lists.tool_mm), abs=1e-6)


def test_an_extended_tool_is_shown_with_its_virtual_length() -> None:
    """[30; 60] of 80 mm: 80 cos 30 / cos 45 at a tilt of 45 degrees."""
    written = {(1, 98, k): 1e4 * v for k, v in enumerate((0.0, 30.0, 60.0, 91.0))}
    kernel = build([9, 98], KinematicData(), written, 80.0)
    links: Any = [SimpleNamespace(actual_mm=at) for at in (0.0, 0.0, 300.0, 0.0, 45.0)]
    path = Transformation(SimpleNamespace(now_ns=0), links)  # type: ignore[arg-type]
    path.choose(canon.KinematicChoice(Block(1, 1, ""), kernel))
    length_mm = 80.0 * math.cos(math.radians(30.0)) / math.cos(math.radians(45.0))
    assert path.state() == pytest.approx((45.0, length_mm))
