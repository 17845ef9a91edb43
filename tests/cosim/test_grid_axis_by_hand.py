"""An axis on an FMU that takes steps of one length: what it reports at its points and between."""

from typing import Any

import pytest
from tests.cosim.fmus_by_hand import Fmu

from axisrig.kernel.cosim.plant.grid import GridAxis
from axisrig.kernel.cosim.plant.outputs import (
    DEMAND_POSITION,
    FORCE,
    MOTOR_POSITION,
    POSITION,
    VELOCITY,
)
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("tells_demand", [True, False])
def test_demand_and_force_are_those_of_the_instant_also_at_a_point_of_the_grid(
    tells_demand: bool,
) -> None:
    """Points every 4 ms, 0.5 mm/ms; the demand is an output of the FMU or the last command."""
    more: dict[str, Any] = {"demand_position": lambda ns: 1e-3 * ns / MS} if tells_demand else {}
    fmu = Fmu(
        "demand", grid_ns=4 * MS, position=lambda ns: 0.01 * ns / MS, velocity=10.0,
        force=lambda ns: 3.0 * ns / MS, **more,
    )  # fmt: skip
    axis = GridAxis(fmu.roles, lambda _ns: None)
    axis.start(0)
    axis.command(0, 0.0, 0.5, 100 * MS, True)
    per_ms = 1e-3 if tells_demand else 0.5e-3
    for end_ms in (1, 3, 4, 6, 8, 12, 13):
        axis.step_to(end_ms * MS)
        assert axis.motion[POSITION] == pytest.approx(0.01 * end_ms)
        assert axis.motion[DEMAND_POSITION] == pytest.approx(per_ms * end_ms), end_ms
        assert axis.motion[FORCE] == pytest.approx(3.0 * end_ms)
        assert axis.motion_at(end_ms * MS) == axis.motion


def grid_axis(grid_ms: int = 4, **outputs: Any) -> tuple[Fmu, GridAxis]:
    """An axis whose FMU moves at 0.01 m/ms."""
    more = {"position": lambda ns: 0.01 * ns / MS, "velocity": 10.0, **outputs}
    fmu = Fmu("demand", grid_ns=grid_ms * MS, **more)
    axis = GridAxis(fmu.roles, lambda _ns: None)
    axis.start(0)
    return fmu, axis


@pytest.mark.parametrize("grid_ms", [1, 4, 5])
@pytest.mark.parametrize("step_ms", [1, 2, 3, 4, 8, 9])
def test_the_fmu_is_at_the_next_point_of_its_grid_and_no_further(
    grid_ms: int, step_ms: int
) -> None:
    """At a point of the grid its time is that point; a step may go over several points."""
    fmu, axis = grid_axis(grid_ms)
    for end_ms in range(step_ms, 40, step_ms):
        axis.step_to(end_ms * MS)
        points = -(-end_ms // grid_ms)
        assert fmu.time_ns == points * grid_ms * MS, end_ms
        assert fmu.steps == [grid_ms * MS * (n + 1) for n in range(points)]
        assert axis.motion[POSITION] == pytest.approx(0.01 * end_ms)


@pytest.mark.parametrize(("commanded_ms", "acts_ms"), [(4, 4), (5, 8), (7, 8), (8, 8)])
def test_a_demand_acts_from_the_next_point_of_the_grid_on(commanded_ms: int, acts_ms: int) -> None:
    """1 m from the command on: the FMU has it in the step that begins at the next point."""
    fmu, axis = grid_axis()
    axis.command(0, 0.0, 0.0, 100 * MS, True)
    for end_ms in range(1, 13):
        axis.step_to(end_ms * MS)
        if end_ms == commanded_ms:
            axis.command(end_ms * MS, 1.0, 0.0, 100 * MS, True)
    given = {at_ns // MS: values["demand"] for at_ns, values in fmu.written}
    assert given == {at_ms: 1.0 if at_ms >= acts_ms else 0.0 for at_ms in (0, 4, 8)}


def test_a_ramp_is_sampled_at_the_points_of_the_grid() -> None:
    """0.5 m/s from 1 m on, until 10 ms: held from one point to the next."""
    fmu, axis = grid_axis()
    axis.command(0, 1.0, 0.5, 10 * MS, True)
    for end_ms in range(1, 17):
        axis.step_to(end_ms * MS)
    given = [(at_ns // MS, values["demand"]) for at_ns, values in fmu.written]
    assert given == [
        (0, 1.0), (4, pytest.approx(1.002)), (8, pytest.approx(1.004)), (12, pytest.approx(1.005)),
    ]  # fmt: skip


def test_between_two_points_the_motion_is_the_cubic_through_them() -> None:
    """x = t^3 (t in units of 10 ms): a cubic is its own interpolation, and so is its slope."""

    def cube(ns: int) -> float:
        return (ns / (10 * MS)) ** 3

    def slope(ns: int) -> float:
        return 3 * (ns / (10 * MS)) ** 2 / 0.01

    _, axis = grid_axis(5, position=cube, velocity=slope, motor_position=cube, motor_velocity=slope)
    before = (0.0, 0.0)
    for end_ms in (1, 2, 4, 5, 6, 9, 10, 13):
        axis.step_to(end_ms * MS)
        found = axis.motion[POSITION], axis.motion[VELOCITY]
        assert found == pytest.approx((cube(end_ms * MS), slope(end_ms * MS)))
        assert axis.motion[MOTOR_POSITION] == pytest.approx(cube(end_ms * MS))
        assert axis.motion[MOTOR_POSITION + 1] == pytest.approx(slope(end_ms * MS))
        assert axis.tick == pytest.approx((*before, *found))
        before = found


def test_what_was_saved_between_two_points_goes_on_as_before() -> None:
    fmu, axis = grid_axis()
    for end_ms in (2, 6):
        axis.step_to(end_ms * MS)
    axis.save()
    kept = list(axis.motion)
    runs = []
    for _ in range(2):
        for end_ms in (7, 8, 11):
            axis.step_to(end_ms * MS)
        runs.append(list(axis.motion))
        assert fmu.time_ns == 12 * MS
        axis.restore()
        assert axis.motion == kept
        assert fmu.time_ns == 8 * MS
    assert runs[0] == runs[1]
    axis.step_to(7 * MS)
    assert axis.motion[POSITION] == pytest.approx(0.07)


def test_an_axis_that_begins_later_has_its_grid_from_there_on() -> None:
    fmu = Fmu("demand", grid_ns=4 * MS, position=lambda ns: 0.01 * ns / MS, velocity=10.0)
    axis = GridAxis(fmu.roles, lambda _ns: None)
    axis.start(6 * MS)
    for end_ms in (7, 10, 11):
        axis.step_to(end_ms * MS)
        assert axis.motion[POSITION] == pytest.approx(0.01 * end_ms)
    assert fmu.steps == [10 * MS, 14 * MS]
