"""What a command, a hold and a fault leave of a distance control in the very cycle, by hand."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import (
    DistanceCommand,
    DistanceSettings,
    DistanceState,
    Reading,
    Source,
)
from axisrig.kernel.distance.filters import FilterSettings, make_filter
from axisrig.kernel.distance.filters.build import OF_AXIS, OF_CHANNEL, parameter_row
from axisrig.kernel.distance.filters.weighted import (
    exponential_weights,
    kalman_weights,
    prediction_weights,
)
from axisrig.kernel.distance.limiter import AxesAllow
from axisrig.kernel.distance.objects import accept, objects
from axisrig.kernel.distance.supervision import Silence, deviation_alarm
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
ON, OFF, FREEZE = DistanceCommand.ON, DistanceCommand.OFF, DistanceCommand.FREEZE


@pytest.mark.parametrize("state", [DistanceState.ACTIVE, DistanceState.FREEZE])
def test_who_commands_off_is_the_source_while_the_offset_still_runs_out(
    make_loop: Make, state: DistanceState
) -> None:
    loop = make_loop(lambda _k: 1.0, v_max_mm_s=10.0).lead_to(state)
    assert loop.control.source is Source.NC
    loop.say(OFF, source=Source.PLC)
    assert loop.control.state is DistanceState.TURNING_OFF
    assert loop.control.source is Source.PLC
    loop.run(1)
    assert loop.control.source is Source.PLC


def test_an_offset_that_an_error_of_the_axis_left_runs_out_by_off(make_loop: Make) -> None:
    """The table has INACTIVE for it, which is where it ends."""
    loop = make_loop(lambda _k: 1.0, v_max_mm_s=10.0).lead_to(DistanceState.ACTIVE)
    loop.control.switch_off_kept()
    assert loop.control.state is DistanceState.INACTIVE
    assert loop.control.offset_mm != 0.0
    loop.say(OFF, source=Source.PLC)
    assert (loop.control.state, loop.control.source) == (DistanceState.TURNING_OFF, Source.PLC)


def test_off_without_an_offset_takes_a_cycle_where_the_control_was_on(make_loop: Make) -> None:
    loop = make_loop()
    loop.control.set_surface(0.0)
    loop.say(ON).run(2).say(OFF)
    assert loop.control.state is DistanceState.TURNING_OFF
    loop.run(1)
    assert loop.control.state is DistanceState.INACTIVE


def moving(make_loop: Make, **changes: Any) -> Any:
    """It follows a surface that is far away: 0.05, 0.1, 0.15 mm in the first three cycles."""
    loop = make_loop(lambda _k: 10.0, a_max_mm_s2=5e4, **changes)
    loop.control.set_surface(0.0)
    loop.say(ON).run(3)
    assert loop.steps_mm == pytest.approx([0.05, 0.1, 0.15])
    return loop


def test_a_freeze_stops_at_once_and_on_in_the_same_cycle_begins_from_rest(make_loop: Make) -> None:
    loop = moving(make_loop).say(FREEZE)
    assert loop.control.step_mm == 0.0
    loop.say(ON).run(2)
    assert loop.steps_mm[3:] == pytest.approx([0.05, 0.1])


def test_a_hold_shows_no_step_and_ends_with_one_from_rest(make_loop: Make) -> None:
    loop = moving(make_loop)
    loop.is_held = True
    loop.run(2)
    loop.is_held = False
    loop.run(2)
    assert loop.steps_mm[3:] == pytest.approx([0.0, 0.0, 0.05, 0.1])


def test_a_hold_of_an_offset_that_runs_out_ends_with_a_step_from_rest(make_loop: Make) -> None:
    loop = moving(make_loop).say(FREEZE).say(OFF).run(2)
    loop.is_held = True
    loop.run(1)
    loop.is_held = False
    loop.run(1)
    assert loop.steps_mm[3:] == pytest.approx([-0.05, -0.1, 0.0, -0.05])


def test_what_runs_out_asks_for_the_whole_offset_back(make_loop: Make) -> None:
    """delta is what the control asks for before its limits."""
    loop = moving(make_loop)
    offset_mm = loop.control.offset_mm
    loop.say(FREEZE).say(OFF).run(1)
    assert loop.control.delta_mm == -offset_mm
    negative = make_loop(lambda _k: -10.0, a_max_mm_s2=5e4)
    negative.control.set_surface(0.0)
    negative.say(ON).run(3).say(FREEZE).say(OFF).run(1)
    assert negative.control.delta_mm == offset_mm


@pytest.mark.parametrize(
    ("axes", "step_mm"),
    [(AxesAllow(), 0.1), (AxesAllow(20.0), 0.02), (AxesAllow(1e3, 1e4), 0.01)],
)
def test_an_offset_runs_out_within_what_its_axes_allow(
    make_loop: Make, axes: AxesAllow, step_mm: float
) -> None:
    """v_max 100 mm/s of the list, or 20 of the axes; from rest 10 m/s2 of them, in 1 ms."""
    loop = make_loop(lambda _k: 1.0, v_max_mm_s=100.0)
    loop.control.set_surface(0.0)
    loop.say(ON).run(5).say(FREEZE).run(1).say(OFF)
    before_mm = loop.control.offset_mm
    loop.control.step(Reading(0.5, 0.5, 0.5, axes=axes))
    assert before_mm - loop.control.offset_mm == pytest.approx(step_mm)


def test_a_fault_of_the_owner_leaves_neither_a_step_nor_a_demand(make_loop: Make) -> None:
    loop = moving(make_loop)
    assert loop.control.delta_mm != 0.0
    with pytest.raises(Alarm):
        loop.control.fail(Alarm(900463, owner="axis Z", angle_deg=86.0, limit_deg=85.0))
    assert (loop.control.delta_mm, loop.control.step_mm) == (0.0, 0.0)
    assert loop.control.state is DistanceState.ERROR


# ---- values


def test_a_filter_that_a_program_puts_in_before_the_first_value_begins_with_it(
    make_loop: Make,
) -> None:
    """ON and another filter in one cycle: the first value comes out as it is."""
    loop = make_loop(lambda _k: 3.0, kp=0.0, n_cycles=4)
    loop.control.set_surface(0.0)
    loop.say(ON)
    loop.control.program(filter_type="EXPO_MEAN", n_cycles=10)
    loop.run(1)
    assert loop.control.filtered_mm == pytest.approx(3.0)


def test_an_object_that_there_is_not_is_refused_when_it_is_asked_for(make_loop: Make) -> None:
    control = make_loop().control
    with pytest.raises(TypeError):
        control.request("kpp", 1.0)
    assert control.requested("kpp") is None
    control.request("kp", 0.25)
    assert control.requested("kp") == 0.25


@pytest.mark.parametrize(("first", "then"), [(20, 3), (3, 20)])
def test_a_reference_waits_for_the_filter_of_now(make_loop: Make, first: int, then: int) -> None:
    loop = make_loop(n_cycles=first)
    loop.run(5)
    assert loop.control.may_reference() is (first < 5)
    loop.control.program(n_cycles=then)
    for _ in range(2):
        assert loop.control.may_reference() is (then < 5)


def test_a_filter_may_be_replaced_as_a_whole_with_parts_of_it() -> None:
    settings = DistanceSettings().replaced(filter=FilterSettings("LOWPASS", 7), n_cycles=9)
    assert (settings.filter.kind, settings.filter.n_cycles) == ("LOWPASS", 9)
    again = settings.replaced(filter_type="DEFAULT", kp=0.5)
    assert (again.filter.kind, again.filter.n_cycles, again.kp) == ("DEFAULT", 9, 0.5)


@pytest.mark.parametrize("f0_hz", [0.0, 25.0, 500.0, 1e4])
def test_a_low_pass_of_order_0_is_none_whatever_its_frequency(f0_hz: float) -> None:
    """P-AXIS-00507: 0 switches it off."""
    settings = FilterSettings("LOWPASS", low_pass_filter_order=0, low_pass_filter_fg_f0=f0_hz)
    smooth = make_filter("LOWPASS", settings, MS)
    smooth.restart(0.0)
    assert [smooth.step(value) for value in (1.0, -3.0, 7.0)] == [1.0, -3.0, 7.0]


@pytest.mark.parametrize("count", [0, 1])
def test_a_mean_of_one_value_is_that_value_and_its_prediction_the_line_of_the_last_two(
    count: int,
) -> None:
    assert exponential_weights(count, 0.3) == [1.0]
    assert prediction_weights([1.0]) == [2.0, -1.0]
    weights = kalman_weights([1.0], 0.1)
    line = [5.0 - 0.25 * k for k in range(len(weights))]  # newest first
    assert sum(w * s for w, s in zip(weights, line, strict=True)) == pytest.approx(5.0)


@pytest.mark.parametrize("name", ["n_cycles", "smoothing_factor", "kalman_sigma"])
def test_a_range_is_that_of_the_list_which_has_the_control(name: str) -> None:
    of_axis, of_channel = parameter_row(OF_AXIS, name), parameter_row(OF_CHANNEL, name)
    assert of_axis.number.startswith("P-AXIS-")
    assert of_channel.number.startswith("P-CHAN-")


# ---- words


def test_what_can_be_written_is_named_without_the_rest() -> None:
    name = next(item.name for item in objects().values() if not item.is_writable)
    with pytest.raises(UserError) as refused:
        accept(name, "1", Origin("a.csv", 1, 1))
    allowed = str(refused.value.allowed).split(", ")
    assert allowed == [item.name for item in objects().values() if item.is_writable]
    assert name not in allowed


@pytest.mark.parametrize("wanted_mm", [5.25, -5.25])
def test_an_offset_beyond_its_limit_is_named_with_its_sign(wanted_mm: float) -> None:
    settings = DistanceSettings(max_deviation_mm=5.0, is_newer=True)
    held_mm = 5.0 if wanted_mm > 0 else -5.0
    alarm = deviation_alarm("axis Z", wanted_mm, held_mm, settings)
    assert alarm is not None
    values = (alarm.values["deviation_mm"], alarm.values["limit_mm"], alarm.values["offset_mm"])
    assert values == (wanted_mm, 5.0, held_mm)


def test_a_silence_is_named_in_parts_of_a_ms() -> None:
    alarm = Silence("SECOND_ENCODER", 3.25, 2.5).alarm("axis Z", DistanceSettings())
    assert (alarm.values["age_ms"], alarm.values["limit_ms"]) == ("3.25", "2.5")


def test_a_filter_that_a_program_chooses_is_of_its_own_kind(make_loop: Make) -> None:
    """From a mean of 4 to an exponential one of 2 with half of the newest: (2 s + s before) / 3."""
    loop = make_loop(lambda k: 3.0 * (k >= 6), kp=0.0, n_cycles=4)
    loop.control.set_surface(0.0)
    loop.say(ON).run(5)
    loop.control.program(filter_type="EXPO_MEAN", n_cycles=2, smoothing_factor=0.5)
    loop.run(2)
    assert loop.control.filtered_mm == pytest.approx(2.0)  # weights 1/2 and 1/4 of 3/4
    loop.run(1)
    assert loop.control.filtered_mm == pytest.approx(3.0)


def test_what_is_asked_for_of_a_filter_is_found_by_its_name(make_loop: Make) -> None:
    control = make_loop().control
    assert control.requested("filter_type") is None
    control.request("filter_type", "LOWPASS")
    control.request("n_cycles", 7)
    assert (control.requested("filter_type"), control.requested("n_cycles")) == ("LOWPASS", 7)


@pytest.mark.parametrize("override", [0.25, 0.5, 1.0])
def test_an_override_leaves_the_acceleration_of_a_run_out(make_loop: Make, override: float) -> None:
    """1 mm at 1000 mm/s² is over before v_max, whatever share of it acts: 2 sqrt(s/a) = 63.2 ms.

    The first and the last step may each take a cycle of 1 ms more or less.
    """
    loop = make_loop(lambda _k: 1.0, kp=0.5)
    loop.control.set_surface(0.0)
    loop.say(ON).run(30).say(FREEZE)
    loop.control.program(a_max_mm_s2=1000.0, v_max_mm_s=400.0)
    loop.override = override
    loop.say(OFF)
    steps = 0
    while loop.control.state is DistanceState.TURNING_OFF:
        loop.run(1)
        steps += 1
    assert steps == pytest.approx(63.2, abs=2)
