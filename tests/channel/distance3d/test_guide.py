"""The way of an offset through every kinematic, judged by chains of matrices (bench.oracles)."""

import math
from typing import Any

import numpy as np
import pytest
from tests.kinematics.machines import MACHINES

from axisrig.kernel.channel.distance.guide import LEAST_COSINE, ToolGuide
from axisrig.kernel.errors import Alarm

POSES = 40
NEAR_MM, NEAR = 1e-6, 1e-9


def names(count: int) -> tuple[str, ...]:
    return tuple(f"Q{number}" for number in range(count))


@pytest.mark.long
@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.parametrize("machine", MACHINES)
def test_the_tool_moves_by_o_over_cos_b_and_keeps_its_orientation(machine: str, mode: str) -> None:
    """o / cos b along u (ECS), o along n (MCS), with n up to 60 deg from u."""
    lists = MACHINES[machine]
    kernel, oracle = lists.kernel(), lists.oracle()
    random, offset_mm, judged = np.random.default_rng(7), 1.5, 0
    for axes in lists.axes(POSES, seed=3):
        before = oracle.frame(axes[None])[0]
        u = before[:3, 2]
        side = np.cross(u, random.normal(size=3))
        b = math.radians(random.uniform(0, 60))
        n = math.cos(b) * u + math.sin(b) * side / np.linalg.norm(side)
        normal = (float(n[0]), float(n[1]), float(n[2]))
        guide = ToolGuide(mode, kernel, names(len(axes)), normal, (0.0, 0.0, 0.0))
        positions = tuple(map(float, axes))
        try:
            moved = guide.superposed(positions, offset_mm)
        except Alarm:  # at the end of the reach
            continue
        judged += 1
        after = oracle.frame(np.array(moved)[None])[0]
        way = offset_mm / math.cos(b) * u if mode == "ECS" else offset_mm * n
        assert after[:3, 3] - before[:3, 3] == pytest.approx(way, abs=NEAR_MM)
        assert after[:3, :3] == pytest.approx(before[:3, :3], abs=NEAR)
        assert guide.cosine(positions) == pytest.approx(
            1.0 if mode == "MCS" else math.cos(b), abs=1e-12
        )
        clamp_mm = oracle.clamp_mm(axes[None])[0]
        assert guide.height_mm(positions) == pytest.approx(float(n @ clamp_mm), abs=NEAR_MM)
        grown = guide.height_mm(moved) - guide.height_mm(positions)
        assert grown == pytest.approx(offset_mm, abs=NEAR_MM)
    assert judged > 0.8 * POSES


@pytest.mark.parametrize("machine", ["9", "45"])
def test_rates_are_those_of_the_axes_of_the_chain(machine: str) -> None:
    """Against a difference of the oracle's own way back, over 0.01 mm."""
    lists = MACHINES[machine]
    kernel, oracle = lists.kernel(), lists.oracle()
    for axes in lists.axes(4, seed=5):
        u = oracle.direction(axes[None])[0]
        normal = (float(u[0]), float(u[1]), float(u[2]))
        guide = ToolGuide("ECS", kernel, names(len(axes)), normal, (0.0, 0.0, 0.0))
        tool = np.array(oracle.tool(axes[None])[0])
        step = 0.01
        further: Any = tool.copy()
        further[:3] += step * u
        expected = (oracle.axes(further, axes) - axes) / step
        assert guide.rates(tuple(map(float, axes))) == pytest.approx(expected, rel=2e-3, abs=2e-4)


def test_the_way_is_bounded_at_the_steepest_angle() -> None:
    lists = MACHINES["9"]
    kernel, oracle = lists.kernel(), lists.oracle()
    axes = lists.axes(1)[0]
    u = oracle.direction(axes[None])[0]
    across = np.cross(u, (0.0, 0.0, 1.0))
    n = across / np.linalg.norm(across)
    guide = ToolGuide("ECS", kernel, names(5), (n[0], n[1], n[2]), (0.0, 0.0, 0.0))
    before = oracle.frame(axes[None])[0]
    after = oracle.frame(np.array(guide.superposed(tuple(axes), 1.0))[None])[0]
    way = np.linalg.norm(after[:3, 3] - before[:3, 3])
    assert way == pytest.approx(1.0 / LEAST_COSINE, rel=1e-9)


def test_another_origin_of_the_coordinate_system_is_another_guide() -> None:
    """SET_POS counts from the origin, which an offset does not depend on."""
    kernel = MACHINES["9"].kernel()
    first, second = (
        ToolGuide("MCS", kernel, names(5), (0.0, 0.0, 1.0), (0.0, 0.0, z_mm)) for z_mm in (0.0, 5.0)
    )
    positions = (1.0, 2.0, 300.0, 20.0, -35.0)
    assert not first.is_same(second)
    assert first.height_mm(positions) - second.height_mm(positions) == pytest.approx(5.0)
    assert first.superposed(positions, 1.5) == second.superposed(positions, 1.5)
