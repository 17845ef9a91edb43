"""Choices of a kinematic that a path keeps with their times, and their end with the program."""

from typing import Any

from axisrig.kernel.channel.path.transformation import Transformation
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
