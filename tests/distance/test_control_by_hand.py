"""A control cycle by cycle by hand: when it begins anew, and what goes on as it was."""

from typing import Any

import pytest

from axisrig.kernel.distance import (
    DistanceCommand,
    DistanceControl,
    DistanceLaw,
    DistanceSettings,
    DistanceState,
    Reading,
    Source,
    StepLimiter,
)
from axisrig.kernel.distance.controller import Controller
from axisrig.kernel.distance.limiter import AxesAllow, Limiter
from axisrig.kernel.distance.supervision import Silence, range_alarm
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

ON, CONST, OFF, FREEZE = (
    DistanceCommand.ON, DistanceCommand.ON_CONST_DIST, DistanceCommand.OFF, DistanceCommand.FREEZE,
)  # fmt: skip
CLAMPED = DistanceLaw(limiter=StepLimiter.CLAMP)


def control_of(**changes: Any) -> DistanceControl:
    """A control whose limits nothing reaches but what a test changes, with both set values 0."""
    wanted: dict[str, Any] = {
        "n_cycles": 1, "filter_type": "MOVING_AVERAGE", "v_max_mm_s": 1e6, "a_max_mm_s2": 1e9,
        "max_deviation_mm": 1e3, "max_change_mm_s": 1e6, "min_pos_mm": -50.0, "max_pos_mm": 50.0,
        "law": CLAMPED,
    } | changes  # fmt: skip
    control = DistanceControl("axis Z", DistanceSettings().replaced(**wanted), MS)
    control.set_surface(0.0)
    control.set_distance(0.0)
    return control


def see(control: DistanceControl, *sensors_mm: float, **more: Any) -> list[float]:
    """Let the tool stand at 0 while the sensor gives these values; return the filtered ones."""
    found = []
    for sensor_mm in sensors_mm:
        control.step(Reading(sensor_mm, 0.0, 0.0, **more))
        found.append(control.filtered_mm)
    return found


def say(control: DistanceControl, command: DistanceCommand, **words: bool) -> None:
    control.command(command, Source.NC, **words)


# Parameters


@pytest.mark.parametrize("way", [(), (ON, FREEZE)])
def test_what_an_object_has_asked_for_acts_from_the_next_on(way: tuple[Any, ...]) -> None:
    control = control_of(kp=0.5)
    for command in way:
        say(control, command)
    control.request("kp", 0.25)
    see(control, 1.0)
    assert (control.settings.kp, control.requested("kp")) == (0.5, 0.25)
    say(control, ON)
    assert (control.settings.kp, control.requested("kp")) == (0.25, None)
    control.program(kp=0.125)
    say(control, FREEZE)
    say(control, ON)
    assert control.settings.kp == 0.125


def test_what_an_object_asks_for_while_it_follows_waits() -> None:
    control = control_of(kp=0.5)
    say(control, ON)
    control.request("kp", 0.25)
    say(control, ON)
    assert (control.settings.kp, control.requested("kp")) == (0.5, 0.25)


def test_on_behind_a_dry_run_begins_anew() -> None:
    control = control_of(kp=0.5)
    say(control, ON, dry_run=True)
    control.request("kp", 0.25)
    see(control, 1.0, 2.0)
    assert control.offset_mm == 0.0
    say(control, ON)
    assert control.settings.kp == 0.25
    see(control, 2.0)
    assert control.offset_mm == 0.5


def test_what_the_program_says_later_counts_more_than_what_an_object_has_asked_for() -> None:
    control = control_of(kp=0.5)
    control.request("kp", 0.25)
    control.request("tn_s", 2.0)
    control.program(kp=0.75)
    assert (control.requested("kp"), control.requested("tn_s")) == (None, 2.0)
    say(control, ON)
    assert (control.settings.kp, control.settings.tn_s) == (0.75, 2.0)


# Filters


def test_another_filter_goes_on_from_what_the_one_before_has_given() -> None:
    """Mean of one value, then of four: three of them are the last result."""
    control = control_of(kp=0.0)
    say(control, ON)
    assert see(control, 1.0, 2.0) == [1.0, 2.0]
    control.program(n_cycles=4)
    assert see(control, 6.0, 6.0, 6.0, 6.0) == [3.0, 4.0, 5.0, 6.0]


def test_a_filter_that_would_give_the_same_is_none() -> None:
    """What a moving mean does not look at leaves it the values that it has."""
    control = control_of(kp=0.0, n_cycles=4)
    say(control, ON)
    see(control, 0.0, 0.0, 0.0, 4.0)
    control.program(low_pass_filter_fg_f0=77.0)
    assert see(control, 4.0) == [2.0]


def test_a_new_filter_begins_with_its_first_value() -> None:
    control = control_of(kp=0.0, n_cycles=4)
    say(control, ON)
    assert see(control, 8.0, 0.0) == [8.0, 6.0]
    say(control, OFF)
    assert see(control, 9.0) == [0.0]
    say(control, ON)
    assert see(control, 4.0, 0.0) == [4.0, 3.0]
    say(control, FREEZE)
    say(control, ON)
    assert see(control, 0.0) == [2.0]
    say(control, FREEZE)
    say(control, CONST)
    assert see(control, -1.0) == [1.0]


# The controller


def test_what_it_has_summed_up_is_gone_when_it_begins_anew() -> None:
    """kp (e + sum T/Tn e), T/Tn = 0.5; the offset is part of the error and held at 0 here."""
    control = control_of(kp=1.0, tn_s=0.002)
    say(control, ON)
    deltas = []
    for _ in range(3):
        control.offset_mm = 0.0
        see(control, 1.0)
        deltas.append(control.delta_mm)
    say(control, FREEZE)
    say(control, ON)
    control.offset_mm = 0.0
    see(control, 1.0)
    assert [*deltas, control.delta_mm] == [1.5, 2.0, 2.5, 1.5]


@pytest.mark.parametrize(
    ("is_dry", "is_held", "deltas_mm", "offset_mm"),
    [
        (False, False, [1.5, -0.25, -0.125], 1.125), (False, True, [1.5] * 3, 0.0),
        (True, False, [1.5] * 3, 0.0), (True, True, [1.5] * 3, 0.0),
    ],
)  # fmt: skip
def test_what_cannot_move_sums_up_nothing(
    is_dry: bool, is_held: bool, deltas_mm: list[float], offset_mm: float
) -> None:
    """e + 0.5 sum e. In motion e is 1, -0.5 and -0.25 with sums 1, 0.5 and 0.25."""
    control = control_of(kp=1.0, tn_s=0.002)
    say(control, ON, dry_run=is_dry)
    found_mm = []
    for _ in range(3):
        see(control, 1.0, is_held=is_held)
        found_mm.append(control.delta_mm)
    assert (found_mm, control.offset_mm) == (deltas_mm, offset_mm)


# What is watched


def test_a_jump_counts_between_two_cycles_that_follow() -> None:
    """5 mm/s is 5 um per cycle; what lies before ON may be of another sensor."""
    control = control_of(kp=0.0, max_change_mm_s=5.0)
    see(control, 0.0, 9.0, 0.0)
    say(control, ON)
    see(control, 4.0, 4.004)
    say(control, FREEZE)
    see(control, 4.1)
    say(control, ON)
    see(control, 4.1)
    with pytest.raises(Alarm) as caught:
        see(control, 4.106)
    assert (caught.value.id, control.state) == (70329, DistanceState.ERROR)


def test_a_held_axis_watches_nothing() -> None:
    control = control_of(kp=0.0, max_change_mm_s=5.0)
    say(control, ON)
    see(control, 0.0)
    silence = Silence("SECOND_ENCODER", 9.0, 3.0)
    see(control, 40.0, 60.0, is_held=True, silence=silence)
    assert control.state is DistanceState.ACTIVE
    with pytest.raises(Alarm) as caught:
        see(control, 60.0, silence=silence)
    assert caught.value.id == 900314


@pytest.mark.parametrize(
    ("sign", "sensor_mm", "alarm_id"),
    [
        (1, 3.5, None), (1, 3.501, 310019), (1, -1.5, None), (1, -1.501, 310020),
        (-1, -3.5, None), (-1, -3.501, 310019), (-1, 1.5, None), (-1, 1.501, 310020),
    ],
)  # fmt: skip
def test_a_value_is_inside_limits_less_their_tolerance(
    sign: int, sensor_mm: float, alarm_id: int | None
) -> None:
    settings = DistanceSettings(
        min_pos_mm=-2.0, max_pos_mm=4.0, tolerance_mm=0.5, sensor_sign=sign, is_newer=True
    )
    alarm = range_alarm("axis Z", sensor_mm, settings)
    assert (alarm and alarm.id) == alarm_id
    control = DistanceControl("axis Z", settings, MS)
    see(control, 7.0)
    control.reference(7.0)
    if alarm_id is None:
        control.check_position(7.0 + sensor_mm)
    else:
        with pytest.raises(Alarm):
            control.check_position(7.0 + sensor_mm)


def test_an_offset_ends_at_its_limit_and_begins_anew_from_rest() -> None:
    control = control_of(kp=1.0, max_deviation_mm=0.75)
    say(control, ON)
    see(control, 0.5)
    with pytest.raises(Alarm) as caught:
        see(control, 2.0)
    assert (caught.value.id, control.offset_mm, control.step_mm) == (70331, 0.75, 0.25)
    see(control, 2.0)
    assert (control.offset_mm, control.step_mm, control.state) == (0.75, 0.0, DistanceState.ERROR)


# The law of the distance


@pytest.mark.parametrize(
    ("both", "shorter_mm", "command", "feedback_mm"),
    [
        (False, 0.0, CONST, 3.0), (True, 0.0, CONST, 2.75), (False, 0.5, CONST, 3.5),
        (True, 0.5, CONST, 3.25), (True, 0.5, ON, 7.0),
    ],
)  # fmt: skip
def test_the_distance_is_less_by_lag_and_by_what_an_inclined_tool_is_nearer(
    both: bool, shorter_mm: float, command: DistanceCommand, feedback_mm: float
) -> None:
    """The sensor gives -3 mm at 10 mm, 0.25 mm above where the axis was sent."""
    control = control_of(kp=0.0, both_encoders=both)
    say(control, command)
    control.step(Reading(-3.0, 10.0, 9.75, shorter_mm=shorter_mm))
    assert control.feedback_mm == pytest.approx(feedback_mm)


# The limits of the offset


def test_what_is_left_of_a_cycle_after_a_stop_builds_up_the_way_down() -> None:
    """10 um of change per cycle up, 5 um down: from +4 um a cycle brakes by 0.4 of itself."""
    settings = DistanceSettings(
        v_max_mm_s=1e3, a_max_mm_s2=1e4, a_weight_down_permille=500, law=CLAMPED
    )
    limiter = Limiter(MS)
    limiter.step_mm = 0.004
    assert limiter.limit(-1.0, -1.0, settings) == pytest.approx(-0.003)
    assert limiter.limit(-1.0, -1.0, settings) == pytest.approx(-0.008)
    assert limiter.limit(1.0, 1.0, settings) == pytest.approx(0.002)


@pytest.mark.parametrize(
    ("override", "axes", "up_mm", "down_mm"),
    [
        (1.0, AxesAllow(), 0.008, -0.004), (0.5, AxesAllow(), 0.004, -0.002),
        (0.5, AxesAllow(6.0), 0.003, -0.0015), (1.0, AxesAllow(6.0, 1e3), 0.001, -0.001),
    ],
)  # fmt: skip
def test_an_override_scales_the_speed_that_the_axes_leave(
    override: float, axes: AxesAllow, up_mm: float, down_mm: float
) -> None:
    settings = DistanceSettings(
        v_max_mm_s=8.0, a_max_mm_s2=1e5, v_weight_down_permille=500, law=CLAMPED
    )
    for wanted, step_mm in ((1.0, up_mm), (-1.0, down_mm)):
        found = Limiter(MS).limit(wanted, wanted, settings, override, axes)
        assert found == pytest.approx(step_mm)
    assert Limiter(MS).run_out(1.0, settings, override, axes) == pytest.approx(down_mm)


def test_an_adaptive_acceleration_is_never_above_the_largest() -> None:
    settings = DistanceSettings(
        a_max_mm_s2=100.0, a_min_mm_s2=500.0, is_adaptive=True, v_max_mm_s=1e3, law=CLAMPED
    )
    steps = [Limiter(MS).limit(1.0, error, settings) for error in (0.0, 0.3, 9.0)]
    assert steps == pytest.approx([1e-4] * 3)


def test_a_slope_cuts_a_step_towards_the_error_alone() -> None:
    """10 um per cycle²: 10 um from the error one step of 10 um can still stop there."""
    settings = DistanceSettings(v_max_mm_s=1e3, a_max_mm_s2=1e4)
    for sign in (1.0, -1.0):
        limiter = Limiter(MS)
        limiter.step_mm = sign * 0.05
        assert limiter.limit(sign, sign * 0.01, settings) == pytest.approx(sign * 0.04)
        limiter.step_mm = -sign * 0.05
        assert limiter.limit(-sign, sign * 0.01, settings) == pytest.approx(-sign * 0.06)


@pytest.mark.parametrize(
    ("no_move", "state", "offset_mm"),
    [(True, DistanceState.INACTIVE, 0.0), (False, DistanceState.TURNING_OFF, 1.0)],
)
def test_an_offset_that_is_to_move_nothing_is_left_to_its_owner(
    no_move: bool, state: DistanceState, offset_mm: float
) -> None:
    control = control_of(kp=0.5)
    say(control, ON)
    see(control, 2.0)
    say(control, OFF, no_move=no_move)
    assert (control.state, control.offset_mm) == (state, offset_mm)


def test_off_without_an_offset_is_over_at_once_and_forgets_its_comparison() -> None:
    control = control_of(kp=0.0)
    say(control, ON)
    see(control, 2.0)
    say(control, OFF)
    see(control, 2.0)
    assert (control.state, control.filtered_mm) == (DistanceState.INACTIVE, 0.0)
    say(control, OFF)
    assert control.state is DistanceState.INACTIVE


def test_an_offset_runs_out_from_rest_after_an_error() -> None:
    """10 um per cycle²; OFF comes in the cycle after the error."""
    control = control_of(kp=1.0, a_max_mm_s2=1e4, max_pos_mm=9.0)
    say(control, ON)
    see(control, 5.0, 5.0, 5.0)
    assert control.step_mm == pytest.approx(0.03)
    with pytest.raises(Alarm):
        see(control, 9.5)
    say(control, OFF)
    see(control, 9.5)
    assert control.step_mm == pytest.approx(-0.01)


def test_a_reference_is_the_mean_since_the_axis_was_last_sent_anywhere() -> None:
    control = control_of(n_cycles=4)
    for sensor_mm, sent_mm in ((1.0, 0.0), (1.0, 0.0), (7.0, 3.0), (9.0, 3.0)):
        control.step(Reading(sensor_mm, 0.0, sent_mm))
    assert not control.may_reference()
    control.reference(9.0)
    assert control.zero_mm == 7.5  # of 7, 7, 7 and 9
    for _ in range(2):
        control.step(Reading(9.0, 0.0, 3.0))
    assert control.may_reference()


def test_what_a_filter_remembers_is_that_of_the_present_one() -> None:
    control = control_of(n_cycles=2)
    see(control, 1.0)
    assert not control.may_reference()
    see(control, 1.0)
    assert control.may_reference()
    control.program(n_cycles=4)
    assert not control.may_reference()
    see(control, 1.0, 1.0)
    assert control.may_reference()


@pytest.mark.parametrize("command", [ON, CONST])
def test_set_values_that_are_forgotten_are_none_for_the_next_on(command: DistanceCommand) -> None:
    control = control_of()
    say(control, command)
    control.forget_set_values()
    see(control, 0.5)
    assert (control.set_pos_mm, control.set_dist_mm) == (0.0, 0.0)
    say(control, FREEZE)
    with pytest.raises(Alarm) as caught:
        say(control, command)
    assert (caught.value.id, control.state) == (
        70335 if command is ON else 900311, DistanceState.FREEZE,
    )  # fmt: skip
    say(control, command, dry_run=True)
    assert control.is_dry_run


@pytest.mark.parametrize("is_limited", [False, True])
def test_a_program_that_takes_the_integral_time_away_takes_its_part_away(is_limited: bool) -> None:
    """T/Tn = 0.1 of an error of 1 mm in each cycle; with Tn = 0 there is no sum, and none kept."""
    controller = Controller(MS)
    summing = DistanceSettings().replaced(kp=2.0, tn_s=0.01)
    for cycle in (1, 2, 3):
        assert controller.delta_mm(1.0, 1.0, summing) == pytest.approx(2.0 * (1.0 + 0.1 * cycle))
        controller.settle(is_limited=False)
    plain = summing.replaced(tn_s=0.0)
    for _ in range(3):
        assert controller.delta_mm(1.0, 1.0, plain) == pytest.approx(2.0)
        controller.settle(is_limited=is_limited)
    kept = 0.3 if is_limited else 0.0  # a limit keeps the sum as it was
    assert controller.delta_mm(1.0, 1.0, summing) == pytest.approx(2.0 * (1.0 + kept + 0.1))
    controller.restart()
    assert controller.delta_mm(1.0, 1.0, summing) == pytest.approx(2.0 * 1.1)
