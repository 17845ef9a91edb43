"""Errors while the control follows: in the cycle of the value, with class and values."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.errors import Alarm

Command, State = DistanceCommand, DistanceState
AT = 5


def step_of(height_mm: float) -> Callable[[int], float]:
    """A surface that is elsewhere from cycle `AT` on."""
    return lambda cycle: height_mm if cycle >= AT else 0.0


def alarm_of(loop: Any, cycles: int = 20) -> Alarm:
    """Follow a surface until an alarm comes up."""
    loop.control.set_surface(0.0)
    loop.say(Command.ON)
    with pytest.raises(Alarm) as caught:
        loop.run(cycles)
    assert loop.control.state is State.ERROR
    return caught.value


@pytest.mark.provokes(70329, 7, owner="axis Z", change_um_s=6000.0, limit_um_s=5000.0)
@pytest.mark.provokes(310018, 7, owner="axis Z", change_um_s=6000.0, limit_um_s=5000.0)
@pytest.mark.parametrize(("alarm_id", "is_newer"), [(70329, False), (310018, True)])
def test_a_sensor_value_that_changes_too_fast(
    make_loop: Callable[..., Any],
    alarm_id: int,
    is_newer: bool,
) -> None:
    loop = make_loop(step_of(0.006), max_change_mm_s=5.0, is_newer=is_newer)
    assert alarm_of(loop).id == alarm_id
    assert loop.cycle == AT + 1


@pytest.mark.provokes(70330, 7, owner="axis Z", value_mm=2.5, limit_mm=2.0)
@pytest.mark.provokes(310019, 7, owner="axis Z", value_mm=2.5, limit_mm=2.0)
@pytest.mark.parametrize(("alarm_id", "is_newer"), [(70330, False), (310019, True)])
def test_a_sensor_beyond_its_upper_end(
    make_loop: Callable[..., Any],
    alarm_id: int,
    is_newer: bool,
) -> None:
    loop = make_loop(step_of(2.5), max_pos_mm=2.3, tolerance_mm=0.3, is_newer=is_newer)
    assert alarm_of(loop).id == alarm_id
    assert loop.cycle == AT + 1
    assert loop.control.offset_mm == 0.0


@pytest.mark.provokes(70576, 7, owner="axis Z", value_mm=-2.5, limit_mm=-2.0)
@pytest.mark.provokes(310020, 7, owner="axis Z", value_mm=-2.5, limit_mm=-2.0)
@pytest.mark.parametrize(("alarm_id", "is_newer"), [(70576, False), (310020, True)])
def test_a_sensor_beyond_its_lower_end(
    make_loop: Callable[..., Any],
    alarm_id: int,
    is_newer: bool,
) -> None:
    loop = make_loop(step_of(-2.5), min_pos_mm=-2.3, tolerance_mm=0.3, is_newer=is_newer)
    assert alarm_of(loop).id == alarm_id
    assert loop.cycle == AT + 1


@pytest.mark.provokes(70331, 7, owner="axis Z", deviation_mm=2.5, limit_mm=2.0, offset_mm=2.0)
@pytest.mark.provokes(310017, 7, owner="axis Z", deviation_mm=2.5, limit_mm=2.0, offset_mm=2.0)
@pytest.mark.parametrize(("alarm_id", "is_newer"), [(70331, False), (310017, True)])
def test_an_offset_beyond_its_limit_is_clamped_and_told(
    make_loop: Callable[..., Any],
    alarm_id: int,
    is_newer: bool,
) -> None:
    loop = make_loop(step_of(2.5), max_deviation_mm=2.0, is_newer=is_newer)
    assert alarm_of(loop).id == alarm_id
    assert loop.cycle == AT + 1
    assert (loop.control.offset_mm, loop.control.step_mm) == (2.0, 2.0)
    loop.run(3)
    assert (loop.control.offset_mm, loop.control.step_mm) == (2.0, 0.0)


@pytest.mark.provokes(70329, 7, owner="axis Z", change_um_s=166667.0, limit_um_s=5000.0)
def test_a_rapid_motion_is_faster_than_the_default_believes(make_loop: Callable[..., Any]) -> None:
    """10 m/min are 0.167 mm per cycle: P-AXIS-00417 = 5000 counts um/s, not 0.1 um per cycle."""
    loop = make_loop(max_change_mm_s=5.0)
    loop.control.set_surface(0.0)
    loop.say(Command.ON).run(3)
    loop.program_mm = 0.166667
    with pytest.raises(Alarm):
        loop.run(1)
    assert loop.cycle == 4


@pytest.mark.provokes(900312, 7, owner="axis Z")
def test_an_absolute_sensor_has_its_zero(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="900312"):
        make_loop(has_absolute_sensor=True).control.reference(1.0)


@pytest.mark.provokes(900313, 7, owner="axis Z", current="FREEZE")
def test_the_zero_does_not_move_under_the_control(make_loop: Callable[..., Any]) -> None:
    with pytest.raises(Alarm, match="900313"):
        make_loop().lead_to(State.FREEZE).control.reference(1.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_in_error_nothing_moves_and_the_objects_show_it(
    make_loop: Callable[..., Any], sign: float
) -> None:
    """The offset was on its way when the sensor left its range: no step, and none is asked for."""
    loop = make_loop(lambda k: sign * (0.01 * k if k < AT else 100.0), kp=0.5)
    loop.control.set_surface(0.0)
    loop.say(Command.ON).run(AT)
    offset_mm = loop.control.offset_mm
    assert loop.control.step_mm != 0.0 != loop.control.delta_mm
    with pytest.raises(Alarm):
        loop.run(1)
    control = loop.control
    assert (control.step_mm, control.delta_mm, control.offset_mm) == (0.0, 0.0, offset_mm)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_offset_that_runs_out_goes_on_from_rest_after_a_hold(
    make_loop: Callable[..., Any], sign: float
) -> None:
    """100 mm/s2 change the step by 1e-4 mm in a cycle, also after it was held; at last it is 0."""
    loop = make_loop(lambda _k: sign, kp=0.5, a_max_mm_s2=100.0, v_max_mm_s=10.0)
    loop.control.set_surface(0.0)
    loop.say(Command.ON).run(500).say(Command.OFF).run(30)
    assert abs(loop.control.step_mm) > 2e-3
    loop.is_held = True
    offset_mm = loop.control.offset_mm
    assert set(loop.run(3).offsets_mm[-3:]) == {offset_mm}
    loop.is_held = False
    for cycle in (1, 2, 3):
        step_mm = abs(loop.run(1).control.step_mm)
        assert step_mm == pytest.approx(cycle * 1e-4, rel=1e-6)
    loop.run(2000)
    assert (loop.control.offset_mm, loop.control.state) == (0.0, State.INACTIVE)
