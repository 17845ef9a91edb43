"""Forward, inverse and oracle over seeded poses: 1e-9 mm and 1e-9 degrees."""

import numpy as np
import numpy.typing as npt
import pytest
from tests.kinematics.machines import MACHINES, MachineLists

from axisrig.kernel.kinematics import Kinematic

Array = npt.NDArray[np.float64]
MM = DEG = 1e-9
QUICK, ALL = 300, 10_000
NAMES = list(MACHINES)


def forward(kinematic: Kinematic, axes: Array) -> Array:
    return np.array([kinematic.forward(tuple(row)) for row in axes.tolist()])


def inverse(kinematic: Kinematic, tools: Array, near: Array) -> Array:
    pairs = zip(tools.tolist(), near.tolist(), strict=True)
    return np.array([kinematic.inverse(tuple(tool), tuple(row)) for tool, row in pairs])


def assert_same_tool(machine: MachineLists, found: Array, expected: Array) -> None:
    """Place, orientation and what is redundant of two sets of axis positions, by the oracle."""
    oracle = machine.oracle()
    first, second = oracle.frame(found), oracle.frame(expected)
    assert np.abs(first[:, :3, 3] - second[:, :3, 3]).max() < MM
    # Frames that differ by a small angle t differ by sqrt(2) t in all
    turn = np.linalg.norm(first[:, :3, :3] - second[:, :3, :3], axis=(1, 2)) / np.sqrt(2)
    assert np.degrees(turn).max() < DEG
    own = oracle.tool(found)[:, 6:] - oracle.tool(expected)[:, 6:]
    assert np.abs(own).max(initial=0.0) < MM


def check_inverse(name: str, count: int, seed: int) -> None:
    machine = MACHINES[name]
    kinematic, axes = machine.kernel(), machine.axes(count, seed)
    near = axes + np.random.default_rng(seed).uniform(-1, 1, axes.shape)
    found = inverse(kinematic, forward(kinematic, axes), near)
    assert_same_tool(machine, found, axes)


def check_forward(name: str, count: int, seed: int) -> None:
    machine = MACHINES[name]
    kinematic, axes = machine.kernel(), machine.axes(count, seed)
    difference = forward(kinematic, axes) - machine.oracle().tool(axes)
    if not name.startswith(("9", "91")):
        difference[:, 3:6] = (difference[:, 3:6] + 180) % 360 - 180
    assert np.abs(difference).max() < MM


@pytest.mark.parametrize("name", NAMES)
def test_forward_of_inverse_gives_the_tool_back(name: str) -> None:
    check_inverse(name, QUICK, seed=1)


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_forward_of_inverse_gives_the_tool_back_in_10_000_poses(name: str) -> None:
    check_inverse(name, ALL, seed=2)


@pytest.mark.parametrize("name", NAMES)
def test_kernel_and_oracle_give_the_same_tool(name: str) -> None:
    check_forward(name, QUICK, seed=3)


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_kernel_and_oracle_give_the_same_tool_in_10_000_poses(name: str) -> None:
    check_forward(name, ALL, seed=4)


@pytest.mark.parametrize("name", NAMES)
def test_direction_and_clamping_point_are_those_of_the_oracle(name: str) -> None:
    machine = MACHINES[name]
    kinematic, axes = machine.kernel(), machine.axes(QUICK, 5)
    tools = [tuple(row) for row in forward(kinematic, axes).tolist()]
    oracle = machine.oracle()
    assert np.abs([kinematic.direction(t) for t in tools] - oracle.direction(axes)).max() < 1e-12
    assert np.abs([kinematic.clamp_mm(t) for t in tools] - oracle.clamp_mm(axes)).max() < MM


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_the_way_back_is_the_one_that_newton_finds_from_the_way_forward(name: str) -> None:
    machine = MACHINES[name]
    kinematic, oracle = machine.kernel(), machine.oracle()
    for axes in machine.axes(5, 6):
        near = axes + 0.2
        tool = kinematic.forward(tuple(axes.tolist()))
        expected = oracle.axes(tool, near)
        assert_same_tool(machine, expected[None], axes[None])
        assert kinematic.inverse(tool, tuple(near.tolist())) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", ["210 slide first", "210 robot first", "210 two slides"])
@pytest.mark.parametrize("way_mm", [-250.0, 190.0, 700.0])
def test_a_slide_has_no_turns_however_far_it_is_away(name: str, way_mm: float) -> None:
    """Angles count to the nearest turn, a way counts whole: Newton's method finds the slide."""
    machine = MACHINES[name]
    oracle = machine.oracle()
    (axes,) = machine.axes(1, 6)
    near = np.array(axes)
    near[6:] += way_mm
    tool = oracle.tool(axes[None])[0]
    assert oracle.axes(tool, near)[6:] == pytest.approx(axes[6:], abs=1e-6)


@pytest.mark.parametrize("name", ["9", "9, 98", "91"])
def test_across_a_0_the_axes_go_on_steadily(name: str) -> None:
    machine = MACHINES[name]
    kinematic = machine.kernel()
    axes = (0.0,) * 5
    for step in range(-100, 101):
        tool = (100.0, 50.0, -20.0, 30.0, step * 0.01)
        last, axes = axes, kinematic.inverse(tool, axes)
        assert kinematic.forward(axes) == pytest.approx(tool, abs=MM)
        if step > -100:
            assert np.abs(np.subtract(axes, last)).max() < 0.1
