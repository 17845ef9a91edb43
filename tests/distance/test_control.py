"""Freeze, hold, dry run, end of control, and what parameters do when."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
Command, State = DistanceCommand, DistanceState
T = 0.001
MODES = [(Command.ON, State.ACTIVE), (Command.ON_CONST_DIST, State.ACTIVE_CONST_DIST)]


def moving_surface(k: int) -> float:
    return 0.003 * k


def started(loop: Any, mode: Command = Command.ON) -> Any:
    loop.control.set_surface(0.0)
    loop.control.set_distance(0.0)
    return loop.say(mode)


@pytest.mark.parametrize(("mode", "state"), MODES)
def test_freeze_holds_the_offset_bit_by_bit(make_loop: Make, mode: Command, state: State) -> None:
    loop = started(make_loop(moving_surface, kp=0.3), mode).run(100)
    held = loop.control.offset_mm
    loop.say(Command.FREEZE).run(50)
    assert loop.offsets_mm[-50:] == [held] * 50
    assert loop.steps_mm[-50:] == [0.0] * 50
    assert loop.control.state is State.FREEZE
    loop.say(mode).run(1)
    assert loop.control.state is state
    assert loop.control.offset_mm != held


@pytest.mark.parametrize(("mode", "state"), MODES)
def test_what_rests_asks_for_no_step(make_loop: Make, mode: Command, state: State) -> None:
    """What the PLC and a recording read of the step before the limits is 0 in FREEZE and off."""
    loop = started(make_loop(moving_surface, kp=0.3), mode).run(50)
    assert loop.control.delta_mm != 0.0
    loop.say(Command.FREEZE).run(1)
    assert (loop.control.delta_mm, loop.control.step_mm) == (0.0, 0.0)
    loop.say(mode).run(1)
    assert loop.control.delta_mm != 0.0
    loop.say(Command.OFF).run(5000)
    assert loop.control.state is State.INACTIVE
    assert (loop.control.delta_mm, loop.control.step_mm, loop.control.offset_mm) == (0.0,) * 3


@pytest.mark.parametrize(("mode", "state"), MODES)
def test_a_held_axis_holds_the_offset_bit_by_bit(
    make_loop: Make, mode: Command, state: State
) -> None:
    """Feedhold and override 0 of the axis (FCT-M3 2); the state stays."""
    loop = started(make_loop(moving_surface, kp=0.3, tn_s=0.1), mode).run(100)
    held = loop.control.offset_mm
    loop.is_held = True
    loop.run(50)
    assert loop.offsets_mm[-50:] == [held] * 50
    assert loop.control.state is state
    loop.is_held = False
    assert loop.run(1).control.offset_mm > held


def test_a_held_axis_does_not_run_its_offset_out(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 2.0, v_max_mm_s=10.0)).run(300).say(Command.OFF).run(20)
    held = loop.control.offset_mm
    loop.is_held = True
    assert loop.run(50).offsets_mm[-50:] == [held] * 50
    assert loop.control.state is State.TURNING_OFF
    loop.is_held = False
    assert loop.run(300).control.state is State.INACTIVE


def test_a_held_axis_is_not_supervised_and_is_again_when_it_goes_on(make_loop: Make) -> None:
    loop = started(make_loop(lambda k: 3.0 if k > 5 else 0.0, max_pos_mm=2.0)).run(3)
    loop.is_held = True
    loop.run(10)
    loop.is_held = False
    with pytest.raises(Alarm, match="ID 70330"):
        loop.run(1)


@pytest.mark.parametrize(("mode", "state"), MODES)
@pytest.mark.parametrize("way", ["freeze", "hold"])
def test_control_goes_on_from_rest_within_both_limits(
    make_loop: Make, mode: Command, state: State, way: str
) -> None:
    """A surface that has moved by 2 mm meanwhile: no step, speed from 0 (FCT-M3 10)."""
    v, a = 10.0, 200.0
    loop = make_loop(lambda k: 2.0 if k >= 40 else 0.0, kp=0.3, v_max_mm_s=v, a_max_mm_s2=a)
    started(loop, mode).run(20)
    if way == "freeze":
        loop.say(Command.FREEZE).run(50).say(mode)
    else:
        loop.is_held = True
        loop.run(50)
        loop.is_held = False
    loop.run(400)
    steps = loop.steps_mm[69:]
    assert (steps[0], steps[1]) == (0.0, pytest.approx(a * T * T))
    changes = [after - before for before, after in itertools.pairwise(steps)]
    assert max(map(abs, changes)) <= a * T * T * (1 + 1e-9)
    assert max(map(abs, steps)) == v * T
    assert loop.control.state is state


def test_on_in_the_cycle_behind_an_offset_that_has_run_out_keeps_the_acceleration(
    make_loop: Make,
) -> None:
    v, a = 10.0, 200.0
    loop = make_loop(lambda _k: 0.5, kp=0.3, v_max_mm_s=v, a_max_mm_s2=a)
    started(loop).run(200).say(Command.OFF)
    while loop.control.state is not State.INACTIVE:
        loop.run(1)
    loop.say(Command.ON).run(50)
    changes = [after - before for before, after in itertools.pairwise(loop.steps_mm)]
    assert max(map(abs, changes)) <= a * T * T * (1 + 1e-9)


def test_in_freeze_nothing_is_supervised(make_loop: Make) -> None:
    loop = make_loop(lambda k: 9.0 if k == 10 else 0.0, max_pos_mm=2.0, max_change_mm_s=5.0)
    started(loop).run(5).say(Command.FREEZE).run(20)
    assert loop.control.state is State.FREEZE


def test_while_the_offset_is_run_out_nothing_is_supervised(make_loop: Make) -> None:
    loop = make_loop(lambda k: 9.0 if k > 60 else 0.5, v_max_mm_s=10.0, max_pos_mm=2.0)
    started(loop).run(58).say(Command.OFF).run(100)
    assert (loop.control.state, loop.control.offset_mm) == (State.INACTIVE, 0.0)


def test_the_first_value_of_a_control_that_was_off_has_none_before(make_loop: Make) -> None:
    """It may be of another sensor."""
    loop = make_loop(lambda k: 1.0 if k == 5 else 0.0, max_change_mm_s=5.0, kp=0.001)
    loop.run(5)
    with pytest.raises(Alarm, match="change"):  # the way back is one
        started(loop).run(2)
    assert loop.cycle == 7


def test_exactly_at_the_limits_is_no_error(make_loop: Make) -> None:
    loop = make_loop(
        lambda k: 0.005 * (k % 2) + 1.995, max_pos_mm=2.3, tolerance_mm=0.3, max_change_mm_s=5.0,
        kp=0.001, v_max_mm_s=1e-9,
    )  # fmt: skip
    started(loop).run(50)
    assert loop.control.state is State.ACTIVE


# Dry run


@pytest.mark.parametrize(("mode", "state"), MODES)
def test_a_dry_run_computes_everything_and_moves_nothing(
    make_loop: Make, mode: Command, state: State
) -> None:
    loop = make_loop(lambda k: 0.1 * (k > 3), kp=0.4, n_cycles=2, tn_s=0.01)
    loop.control.set_surface(0.0)
    loop.control.set_distance(0.0)
    loop.say(mode, dry_run=True).run(20)
    control = loop.control
    assert (control.state, control.is_dry_run) == (state, True)
    assert set(loop.offsets_mm) == {0.0}
    assert set(loop.steps_mm) == {0.0}
    assert loop.errors_mm[3:6] == pytest.approx([0.0, 0.05, 0.1])
    # the integral stands, since the error cannot get smaller
    assert control.delta_mm == pytest.approx(0.4 * 0.1 * (1 + 0.001 / 0.01))
    loop.say(mode).run(1)
    assert (control.state, control.is_dry_run) == (state, False)
    assert control.offset_mm > 0


def test_the_programs_of_the_manual_run(make_loop: Make) -> None:
    """%DIST_5: dry run without a set position, parameters, then the other mode (FCT-M3 6)."""
    loop = make_loop(lambda _k: 0.5, max_deviation_mm=3.0)
    control = loop.control
    control.program(filter_type="KALMAN_MA")
    control.program(n_cycles=30, kalman_sigma=1000.0)
    loop.say(Command.ON, dry_run=True).run(10)
    assert control.filtered_mm == pytest.approx(0.5)
    assert (control.error_mm, control.delta_mm) == (0.0, 0.0)
    control.program(kp=0.3, tn_s=0.0, tv_s=0.01)
    control.set_distance(1.0)
    loop.say(Command.ON_CONST_DIST).run(5)
    assert control.state is State.ACTIVE_CONST_DIST
    control.program(filter_type="KALMAN_EXPO", smoothing_factor=0.3)
    loop.run(1).say(Command.OFF).run(3000)
    assert (control.state, control.offset_mm) == (State.INACTIVE, 0.0)


@pytest.mark.parametrize(("mode", "state"), MODES)
def test_a_dry_run_is_supervised_and_over_after_an_error(
    make_loop: Make, mode: Command, state: State
) -> None:
    loop = make_loop(lambda k: 3.0 * (k > 3), max_pos_mm=2.0)
    with pytest.raises(Alarm, match="ID 70330"):
        loop.say(mode, dry_run=True).run(10)
    assert (loop.control.state, loop.control.is_dry_run) == (State.ERROR, False)
    loop.control.set_surface(0.0)
    loop.control.set_distance(0.0)
    for refused in (mode, Command.FREEZE):  # only OFF leads out
        with pytest.raises(Alarm, match="ID 900310"):
            loop.say(refused)
    loop.say(Command.OFF).run(2)
    assert loop.control.state is State.INACTIVE


@pytest.mark.parametrize(("mode", "state"), MODES)
@pytest.mark.parametrize("after", [Command.OFF, Command.FREEZE])
def test_a_dry_run_ends_with_each_command(
    make_loop: Make, mode: Command, state: State, after: Command
) -> None:
    """As FREEZE does (%DIST_5): OFF leads out, FREEZE stays; the next ON moves."""
    loop = make_loop(lambda _k: 0.5)
    loop.control.set_surface(0.0)
    loop.control.set_distance(0.0)
    loop.say(mode, dry_run=True).run(5).say(after).run(2)
    over = State.INACTIVE if after is Command.OFF else State.FREEZE
    assert (loop.control.state, loop.control.is_dry_run) == (over, False)
    loop.say(mode).run(5)
    assert (loop.control.state, loop.control.offset_mm > 0) == (state, True)


def test_a_control_that_is_on_can_go_on_dry(make_loop: Make) -> None:
    loop = started(make_loop(moving_surface, kp=0.3)).run(50)
    held = loop.control.offset_mm
    loop.say(Command.ON, dry_run=True).run(20)
    assert loop.offsets_mm[-20:] == [held] * 20


# The end


@pytest.mark.parametrize("state", State)
def test_off_no_move_hands_the_offset_over(make_loop: Make, state: State) -> None:
    loop = make_loop(lambda _k: 0.001, kp=0.3).lead_to(state)
    loop.say(Command.OFF, no_move=True)
    assert (loop.control.state, loop.control.offset_mm) == (State.INACTIVE, 0.0)
    assert loop.run(3).offsets_mm[-3:] == [0.0] * 3


@pytest.mark.parametrize("state", State)
def test_after_an_error_of_the_axis_the_offset_stays(make_loop: Make, state: State) -> None:
    loop = make_loop(lambda _k: 0.001, kp=0.3).lead_to(state)
    held = loop.control.offset_mm
    loop.control.switch_off_kept()
    assert loop.control.state is State.INACTIVE
    assert loop.run(5).offsets_mm[-5:] == [held] * 5


def test_what_an_error_has_left_is_run_out_by_off(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 1.0, kp=0.3, v_max_mm_s=10.0)).run(50)
    loop.control.switch_off_kept()
    loop.say(Command.OFF).run(1)
    assert loop.control.state is State.TURNING_OFF
    assert loop.run(200).control.offset_mm == 0.0
    loop.say(Command.OFF)
    assert loop.control.state is State.INACTIVE


def test_out_of_an_error_off_leads_back_to_0(make_loop: Make) -> None:
    loop = make_loop(lambda k: 0.5 if k < 20 else 4.0, max_pos_mm=2.0, v_max_mm_s=10.0)
    with pytest.raises(Alarm):
        started(loop).run(50)
    held = loop.control.offset_mm
    assert loop.run(5).offsets_mm[-5:] == [held] * 5
    assert loop.control.state is State.ERROR
    loop.say(Command.OFF, source=Source.PLC).run(200)
    assert (loop.control.state, loop.control.offset_mm) == (State.INACTIVE, 0.0)


def test_set_values_are_forgotten_and_what_is_on_goes_on(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 0.5, kp=0.3)).run(5)
    loop.control.forget_set_values()
    loop.run(100)
    assert loop.control.offset_mm == pytest.approx(0.5)
    loop.say(Command.FREEZE).run(5)
    with pytest.raises(Alarm, match="70335"):
        loop.say(Command.ON)
    with pytest.raises(Alarm, match="900311"):
        loop.say(Command.ON_CONST_DIST)
    loop.say(Command.OFF).run(1000)
    loop.control.forget_set_values()
    assert (loop.control.set_pos_mm, loop.control.set_dist_mm) == (None, None)


# Parameters of the program, sensor


def test_parameters_of_the_program_act_at_once(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 1.0, kp=0.1)).run(1)
    assert loop.control.delta_mm == pytest.approx(0.1)
    loop.control.program(kp=0.5)
    assert loop.run(1).control.delta_mm == pytest.approx(0.5 * 0.9)


def test_another_integral_time_makes_no_step(make_loop: Make) -> None:
    loop = started(make_loop(lambda k: 0.01 * k, kp=0.2, tn_s=0.05)).run(2000)
    before = loop.control.delta_mm
    loop.control.program(tn_s=5.0)
    assert loop.run(1).control.delta_mm == pytest.approx(before, rel=1e-3)


@pytest.mark.parametrize(
    ("sensor_mm", "alarm_id"),
    [(1.9, None), (2.0, None), (2.0001, 70330), (-0.7, None), (-0.7001, 70576)],
)
def test_check_pos(make_loop: Make, sensor_mm: float, alarm_id: int | None) -> None:
    control = make_loop(max_pos_mm=2.3, min_pos_mm=-1.0, tolerance_mm=0.3).control
    if alarm_id is None:
        control.check_position(sensor_mm)
        return
    with pytest.raises(Alarm) as caught:
        control.check_position(sensor_mm)
    assert caught.value.id == alarm_id
    assert control.state is State.INACTIVE


def test_ref_makes_the_present_value_0(make_loop: Make) -> None:
    loop = make_loop(lambda k: 3.0 + 0.25 * (k > 5), kp=1.0, max_pos_mm=2.0)
    with pytest.raises(Alarm, match="ID 70330"):
        loop.control.check_position(3.0)
    loop.control.reference(3.0)
    loop.control.check_position(3.0)
    started(loop).run(5)
    assert (loop.control.sensor_mm, loop.control.offset_mm) == (0.0, 0.0)
    assert loop.run(5).control.offset_mm == pytest.approx(0.25)


def test_what_is_shown_while_it_is_off(make_loop: Make) -> None:
    control = make_loop(lambda _k: 31.0, program_mm=30.0).run(1).control
    assert (control.sensor_mm, control.distance_mm, control.surface_mm) == (1.0, -1.0, 31.0)
    assert (control.offset_mm, control.delta_mm, control.step_mm) == (0.0, 0.0, 0.0)


def test_what_is_not_compared_any_more_is_shown_as_0(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 0.5, kp=0.1)).run(5)
    assert loop.control.error_mm > 0
    loop.say(Command.OFF).run(500)
    assert (loop.control.filtered_mm, loop.control.error_mm) == (0.0, 0.0)


@pytest.mark.parametrize("mode", [Command.ON, Command.ON_CONST_DIST])
def test_an_error_that_stands_while_the_axis_is_held_does_not_wind_the_integral_up(
    make_loop: Make, mode: Command
) -> None:
    """PI, 1 s of feedhold with 1 mm of error: the peak is that of a control without the hold."""

    def peak(held_cycles: int) -> float:
        loop = started(make_loop(lambda k: 1.0 * (k >= 50), kp=0.2, tn_s=0.02), mode).run(50)
        loop.is_held = True
        loop.run(held_cycles)
        loop.is_held = False
        return max(abs(offset) for offset in loop.run(500).offsets_mm)

    assert peak(0) > 1.1  # the second integrator overshoots
    assert peak(1000) == pytest.approx(peak(0), abs=1e-12)
