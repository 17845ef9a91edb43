"""What a master may do with several slaves, however their groups come and go."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.axes.coupling import Couplings
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import AxisPair

BLOCK = Block(1, 10, "N10")


def settings(name: str, a_mm_s2: float, speed_mm_s: float) -> AxisSettings:
    slope = Slope(a_mm_s2, a_mm_s2, 1000.0)
    dynamics = Dynamics(slope, slope, slope, speed_mm_s)
    return AxisSettings(name, True, 0.01, 0, dict.fromkeys(Motion, dynamics))


class StandingPath:
    """Axes that stand at 0."""

    def __init__(self) -> None:
        axes = (settings("X", 1000, 500), settings("X2", 400, 600), settings("X3", 800, 100))
        self.axes = {axis.name: axis for axis in axes}
        self.leaders: list[Any] = []

    def settings(self, axis: str) -> AxisSettings:
        return self.axes[axis]

    def use(self, axis: AxisSettings) -> None:
        self.axes[axis.name] = axis

    def position_acs_mm(self, axis: str) -> float:
        return 0.0

    def superposed_mm(self, axis: str) -> float:
        return 0.0


def limits(path: StandingPath) -> tuple[float, float]:
    dynamics = path.settings("X").dynamics[Motion.FEED]
    return dynamics.acceleration.a_low_mm_s2, dynamics.speed_max_mm_s


@pytest.mark.parametrize(("first_off", "between"), [(1, (800.0, 100.0)), (2, (400.0, 500.0))])
def test_groups_may_end_in_any_order(first_off: int, between: tuple[float, float]) -> None:
    path = StandingPath()
    links = {name: SimpleNamespace(actual_mm=0.0) for name in path.axes}
    couplings = Couplings(path, links)  # type: ignore[arg-type]
    couplings.switch_on(canon.AxisLinkOn(BLOCK, 1, (AxisPair("X2", "X"),)))
    assert limits(path) == (400.0, 500.0)
    couplings.switch_on(canon.AxisLinkOn(BLOCK, 2, (AxisPair("X3", "X"),)))
    assert limits(path) == (400.0, 100.0)
    couplings.switch_off(canon.AxisLinkOff(BLOCK, first_off))
    assert limits(path) == between
    couplings.switch_off(canon.AxisLinkOff(BLOCK, 3 - first_off))
    assert limits(path) == (1000.0, 500.0)
    assert path.leaders == []


@pytest.mark.parametrize("shape", Shape)
def test_a_master_is_as_slow_as_its_slave_with_every_profile(shape: Shape) -> None:
    """Ramps of 10 ms of the master and of 40 ms of the slave, 1000 and 400 mm/s2."""
    path = StandingPath()
    for name, a_mm_s2, ramp_s, speed in (("X", 1000.0, 0.01, 500.0), ("X2", 400.0, 0.04, 300.0)):
        slope = JerkSlope(a_mm_s2, ramp_s, ramp_s, shape)
        limited = dict.fromkeys(Motion, Dynamics(slope, slope, slope, speed))
        path.use(replace(path.settings(name), jerk_limited={shape: limited}))
    links = {name: SimpleNamespace(actual_mm=0.0) for name in path.axes}
    couplings = Couplings(path, links)  # type: ignore[arg-type]
    couplings.switch_on(canon.AxisLinkOn(BLOCK, 1, (AxisPair("X2", "X"),)))
    for motion in Motion:
        found = path.settings("X").dynamics_of(motion, shape)
        assert found.speed_max_mm_s == 300.0
        for slope in (found.acceleration, found.deceleration, found.stop_deceleration):
            assert isinstance(slope, JerkSlope)
            assert (slope.a_mm_s2, slope.rise_s, slope.fall_s) == (400.0, 0.04, 0.04)
    couplings.end_program()
    assert path.settings("X").dynamics_of(Motion.FEED, shape).speed_max_mm_s == 500.0
