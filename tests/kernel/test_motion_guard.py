"""What may go into the set point buffer: by axis, from one cycle to the next."""

import pytest

from axisrig.kernel.motion.guard import AxisLimits, SetpointGuard
from axisrig.kernel.time.clock import MS

T = 1e-3
# Two axes with limits of their own: 100 and 50 mm/s, 1000 and 400 mm/s2, increments of 1 and 10 um
LIMITS = [AxisLimits("X", 100.0, 1000.0, 0.001), AxisLimits("Y", 50.0, 400.0, 0.01)]


def guard_at(speed_mm_s: float, axis: int) -> SetpointGuard:
    """Give a guard whose last two positions of an axis are a cycle apart at a speed."""
    guard = SetpointGuard(LIMITS, MS)
    positions = [0.0, 0.0]
    guard.put_all((0.0, 0.0))
    positions[axis] = speed_mm_s * T
    guard.take((positions[0], positions[1]))
    return guard


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_speed_may_be_its_limit_and_an_increment_in_a_cycle(axis: int, sign: float) -> None:
    limit = LIMITS[axis]
    most_mm = limit.speed_mm_s * T + limit.increment_mm
    for share, is_legal in ((0.9999, True), (1.0001, False)):
        guard = guard_at(sign * limit.speed_mm_s, axis)
        positions = [0.0, 0.0]
        positions[axis] = sign * (limit.speed_mm_s * T + share * most_mm)
        alarm = guard.judge((positions[0], positions[1]))
        assert (alarm is None) is is_legal


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_change_of_the_step_may_be_the_acceleration_and_two_increments(
    axis: int, sign: float
) -> None:
    limit = LIMITS[axis]
    most_mm = limit.a_mm_s2 * T * T + 2.0 * limit.increment_mm
    for share, is_legal in ((0.9999, True), (1.0001, False)):
        guard = guard_at(10.0, axis)
        positions = [0.0, 0.0]
        positions[axis] = 2.0 * 10.0 * T + sign * share * most_mm
        alarm = guard.judge((positions[0], positions[1]))
        assert (alarm is None) is is_legal


def test_every_axis_that_passes_a_limit_is_named_and_nothing_is_taken() -> None:
    guard = guard_at(0.0, 0)
    alarm = guard.judge((5.0, -5.0))
    assert alarm is not None
    assert (alarm.id, alarm.values["axis"]) == (900500, "X Y")
    alarm = guard.judge((0.0005, 5.0))  # X goes on from where it was
    assert alarm is not None
    assert alarm.values["axis"] == "Y"


def test_a_position_that_is_put_is_one_at_rest() -> None:
    """Before and after: a jump of one axis, while the other one goes on."""
    guard = guard_at(10.0, 1)
    guard.put(0, 70.0)
    assert guard.judge((70.0, 0.02)) is None
    assert guard.judge((80.0, 0.03)) is not None


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("all_axes", [False, True])
def test_what_an_axis_did_before_it_was_put_counts_no_more(axis: int, all_axes: bool) -> None:
    """It went with its limit; put, it may stay or go by an increment, and not go on as it went."""
    limit = LIMITS[axis]

    def put() -> SetpointGuard:
        guard = guard_at(limit.speed_mm_s, axis)
        if all_axes:
            guard.put_all((7.0, 7.0))
        else:
            guard.put(0, 7.0)
            guard.put(1, 7.0)
        return guard

    for way_mm, is_legal in (
        (0.0, True),
        (limit.increment_mm, True),
        (-limit.increment_mm, True),
        (limit.speed_mm_s * T, False),
        (-limit.speed_mm_s * T, False),
    ):
        positions = [7.0, 7.0]
        positions[axis] += way_mm
        assert (put().judge((positions[0], positions[1])) is None) is is_legal


def test_another_zero_changes_nothing() -> None:
    guard = guard_at(10.0, 0)
    guard.move(0, -3.0)
    assert guard.judge((0.02 - 3.0, 0.0)) is None


def test_an_acceleration_that_a_program_weights_is_allowed_and_a_smaller_one_forbids_nothing() -> (
    None
):
    step_mm = 2000.0 * T * T
    for allowed, is_legal in ((500.0, False), (2000.0, True)):
        guard = guard_at(0.0, 0)
        guard.allow(0, allowed)
        assert (guard.judge((step_mm + 0.0019, 0.0)) is None) is is_legal
        assert guard.judge((1.0, 0.0)) is not None


@pytest.mark.parametrize("after", [0.0, 500.0])
def test_what_a_weight_has_allowed_is_not_allowed_without_it(after: float) -> None:
    guard = guard_at(0.0, 0)
    guard.allow(0, 2000.0)
    guard.allow(0, after)  # the next path
    assert guard.judge((2000.0 * T * T + 0.0019, 0.0)) is not None
    assert guard.judge((1000.0 * T * T + 0.0019, 0.0)) is None
