"""Alarms of the control itself, and the words that look at its sensor."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.bench.bus.can.faults import Drop
from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
LIMITS = {"min_pos_mm": -12.0, "max_pos_mm": -8.0}


def stepping(mm: float) -> Callable[[int], float]:
    """A surface that moves at 200.3 ms, between two SYNCs."""
    return lambda time_ns: mm if time_ns >= 200 * MS + 300_000 else 0.0


@pytest.mark.parametrize("is_optimized", [True, False])
@pytest.mark.provokes(70331, 7, owner="axis Z")
def test_an_alarm_of_the_control_holds_the_offset_and_halts_the_axis(
    distance_bench: Make, say: Any, words: Any, is_optimized: bool
) -> None:
    """The axis moves on the path with X when its offset gets to max_deviation."""
    made = distance_bench(
        stepping(3.0), more=(words.axis("X"),), is_optimized=is_optimized, max_deviation_mm=1.0,
        kp=0.5, v_max_mm_s=100.0,
    )  # fmt: skip
    made.run(say.command("on", set_pos_mm=0.0), words.move(2, 600.0, X=50.0, Z=say.start_mm + 20.0))
    assert made.alarm_ids == [70331]
    seen, channel = made.seen, made.channel
    failed = seen.state.index(DistanceState.ERROR)
    assert channel.alarm_ns == [seen.time_ns[failed]]
    assert set(seen.state[failed:]) == {DistanceState.ERROR}
    assert set(seen.offset_mm[failed:]) == {1.0}
    # the set position of Z brakes, X stops on the path, and nothing is left behind
    speed = seen.interpolated_mm[failed - 1] - seen.interpolated_mm[failed - 2]
    assert speed > 1e-3
    assert seen.interpolated_mm[-1] - seen.interpolated_mm[-2] < 1e-3
    assert seen.sent_mm[-1] == seen.interpolated_mm[-1] + 1.0
    x = made.bench.set_mm("X")
    assert x[-1] - x[-2] < 1e-3
    assert x[-1] < 50.0


@pytest.mark.parametrize(
    ("alarm_id", "height_mm"),
    [
        pytest.param(70330, 2.5, marks=pytest.mark.provokes(70330, 7, owner="axis Z")),
        pytest.param(70576, -2.5, marks=pytest.mark.provokes(70576, 7, owner="axis Z")),
    ],
)
def test_the_cycle_that_receives_the_value_raises_the_alarm(
    distance_bench: Make, say: Any, alarm_id: int, height_mm: float
) -> None:
    made = distance_bench(stepping(height_mm), **LIMITS)
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(400))
    assert made.alarm_ids == [alarm_id]
    assert made.channel.alarm_ns == [201 * MS + 620_000]
    assert set(made.seen.offset_mm) == {0.0}


@pytest.mark.long
@pytest.mark.provokes(70330, 7, owner="axis Z")
def test_another_axis_fails_and_so_does_this_one_while_it_stops(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """What comes up while the axes stop is told besides."""
    made = distance_bench(stepping(2.5), more=(words.axis("X", a_mm_s2=50.0),), **LIMITS)

    jumped = []

    def jump() -> None:
        """10 ms before the surface moves, however long the start-up was."""
        if not jumped and made.channel._clock.now_ns >= 190 * MS:
            jumped.append(True)
            made.bench.axes["X"].droop_m += 0.02

    made.channel.plc.join(PlcParticipant(jump))
    made.run(say.command("on", set_pos_mm=0.0), words.move(2, 600.0, X=200.0))
    assert made.alarm_ids == [900029]
    assert [alarm.id for alarm in made.channel.further_alarms] == [70330]


def test_nothing_is_commanded_while_the_axes_stop(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(more=(words.axis("X", a_mm_s2=50.0),))
    unit = made.channel.plc.axis["Z"].distance

    def jump() -> None:
        made.bench.axes["X"].droop_m += 0.02

    def ask() -> None:
        unit.enable_w = unit.command_semaphor_rw = True
        unit.command_w.transition, unit.command_w.set_pos_mm = DistanceCommand.ON, 0.0

    made.at({100: jump, 150: ask})
    made.run(words.move(2, 600.0, X=200.0))
    assert unit.command_semaphor_rw
    assert set(made.seen.state) == {DistanceState.INACTIVE}


# CHECK_POS and REF


@pytest.mark.parametrize(
    ("height_mm", "alarms"),
    [
        (0.0, []),
        (1.9, []),
        pytest.param(2.1, [70330], marks=pytest.mark.provokes(70330, 7, owner="axis Z")),
        pytest.param(-2.1, [70576], marks=pytest.mark.provokes(70576, 7, owner="axis Z")),
    ],
)
def test_check_pos_looks_at_the_sensor_without_switching_on(
    distance_bench: Make, say: Any, height_mm: float, alarms: list[int]
) -> None:
    made = distance_bench(lambda _t: height_mm, **LIMITS)
    made.run(say.dwell(10), say.command("check"), say.dwell(10))
    assert made.alarm_ids == alarms
    assert set(made.seen.state) == {DistanceState.INACTIVE}


def test_ref_makes_the_present_sensor_value_0(distance_bench: Make, say: Any) -> None:
    """Gap 10 mm is 0 from then on: a distance of 1 mm is one of 11 mm."""
    made = distance_bench()
    made.run(
        say.dwell(10), say.command("ref"), say.command("on_const", set_dist_mm=1.0), say.dwell(200)
    )
    assert made.seen.actual_mm[-1] == pytest.approx(say.start_mm + 1.0, abs=2 / say.per_mm)


def test_ref_waits_for_values_of_a_variable_that_has_just_been_chosen(
    distance_bench: Make, say: Any
) -> None:
    """The axis has no second encoder, so that nothing was measured before. A mean of 4 values."""
    made = distance_bench(spec={"height_mm": None}, n_cycles=4)
    plc, noise_um = made.channel.plc, [300, -100, 0, -200]
    plc.values["GAP"] = 0.0
    turns: list[int] = []

    def read() -> None:
        turns.append(0)
        plc.values["GAP"] = -2e4 + 10 * noise_um[len(turns) % 4]

    plc.inputs.append(read)
    chosen = say.command(sensor_source="VARIABLE", sensor_variable="V.E.GAP")
    made.run(say.dwell(10), chosen, say.command("ref"), say.dwell(5))
    assert made.control.zero_mm == pytest.approx(-2.0, abs=1e-9)


@pytest.mark.provokes(310029, 7, owner="axis Z", source="SECOND_ENCODER")
@pytest.mark.parametrize("word", ["check", "ref"])
def test_without_a_sensor_there_is_nothing_to_look_at(
    distance_bench: Make, say: Any, word: str
) -> None:
    made = distance_bench(spec={"height_mm": None})
    made.run(say.command(word))
    assert made.alarm_ids == [310029]


@pytest.mark.long
@pytest.mark.provokes(900006, 7, axis="X")
def test_a_silent_drive_of_another_axis_does_not_blind_it_while_the_axes_stop(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """The telegrams of X stay out from 300 ms on; X brakes slowly, the tool follows."""
    made = distance_bench(
        lambda time_ns: time_ns / 1e9, more=(words.axis("X", a_mm_s2=25.0),), kp=0.5
    )
    silent_ns = 300 * MS
    made.bench.segment.add_fault(
        lambda frame, _port, _attempt: (
            Drop()
            if frame.arbitration_id == 0x181 and made.bench.scheduler.now_ns > silent_ns
            else None
        )
    )
    made.run(say.command("on", set_pos_mm=0.0), words.move(2, 600.0, X=200.0))
    assert made.alarm_ids == [900006]
    steps = [b - a for a, b in pairwise(made.seen.offset_mm[100:])]
    assert steps == pytest.approx([1e-3] * len(steps), abs=2.5e-5)
    assert len(steps) > 400  # far behind the alarm


def test_a_command_of_the_plc_at_the_start_acts_in_the_first_cycle(
    distance_bench: Make, say: Any
) -> None:
    made = distance_bench()
    unit = made.channel.plc.axis["Z"].distance

    def ask() -> None:
        unit.enable_w = unit.command_semaphor_rw = True
        unit.command_w.transition, unit.command_w.set_pos_mm = DistanceCommand.ON, 0.0

    made.at({0: ask})
    made.run(say.dwell(20))
    assert set(made.seen.state) == {DistanceState.ACTIVE}


@pytest.mark.provokes(
    900501,
    7,
    owner="axis Z",
    what="2999 mm/s, 2.999e+06 mm/s2",
    allowed="100 mm/s and 1000 mm/s2",
)
def test_an_offset_that_passes_its_own_limits_is_not_sent(distance_bench: Make, say: Any) -> None:
    """The limiter is made to believe in a last step of 3 mm: its next one is 1 um less."""
    made = distance_bench(stepping(0.1), v_max_mm_s=100.0, a_max_mm_s2=1000.0)
    made.at({100: lambda: setattr(made.control._limiter, "step_mm", 3.0)})
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(400))
    assert made.alarm_ids == [900501]
    seen = made.seen
    assert seen.state[-1] is DistanceState.ERROR
    assert set(seen.offset_mm) == {0.0}
    assert max(abs(b - a) for a, b in pairwise(seen.sent_mm)) == 0.0
