"""A run cycle by cycle: how long it waits for a check, what an abort leaves, dead times."""

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage, next_alarm

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.dead_time import DeadTime
from axisrig.kernel.measuring.run import (
    CHECK_CYCLES_MAX,
    PROOF_CYCLES_MAX,
    MeasuringRun,
    Order,
    RunState,
)


def test_what_a_latch_is_checked_with_may_take_as_long_as_an_sdo() -> None:
    port = FakeLatch(is_prepared=False)
    stage = Stage(port)
    stage.cycle()
    port.is_armed = True
    alarm, cycles = next_alarm(stage, 2 * CHECK_CYCLES_MAX)
    assert (alarm.id, cycles, alarm.values["cycles"]) == (
        900083, CHECK_CYCLES_MAX + 1, CHECK_CYCLES_MAX,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("value", "confirms", "alarm_id", "most"),
    [(None, True, 900001, PROOF_CYCLES_MAX), (7.0, False, 900083, CHECK_CYCLES_MAX)],
)
def test_a_value_is_waited_for_as_long_as_its_proof_may_take(
    value: float | None, confirms: bool, alarm_id: int, most: int
) -> None:
    port = FakeLatch(confirms=confirms)
    stage = Stage(port).move()
    port.latch(value)
    stage.cycle()
    alarm, cycles = next_alarm(stage, 2 * CHECK_CYCLES_MAX, standing=True)
    assert (alarm.id, alarm.values["cycles"]) == (alarm_id, most)
    assert cycles == most + 1


def test_of_two_values_that_are_late_the_one_without_any_proof_is_named() -> None:
    first, second = FakeLatch("X", confirms=False), FakeLatch("Y")
    stage = Stage(first, second).move()
    first.latch(1.0)
    second.latch(None)
    stage.cycle()
    alarm, _ = next_alarm(stage, 2 * CHECK_CYCLES_MAX, standing=True)
    assert (alarm.id, alarm.values["axis"]) == (900001, "Y")


@pytest.mark.parametrize("is_done", [True, False])
def test_an_abort_drops_what_some_axes_have_and_leaves_a_result(is_done: bool) -> None:
    first, second = FakeLatch("X"), FakeLatch("Y", confirms=is_done)
    stage = Stage(first, second).move()
    first.latch(1.0)
    second.latch(2.0)
    stage.cycles(3, standing=True)
    assert stage.run.is_done is is_done
    assert stage.run.record.latched_mm["X"] == 1.0
    stage.run.abort()
    assert (stage.run.state, stage.run.record.has_signal) == (RunState.DONE, is_done)
    assert stage.run.record.latched_mm == ({"X": 1.0, "Y": 2.0} if is_done else {})
    assert {port.orders[-1] for port in stage.ports} == {"disarm"}


@pytest.mark.parametrize("goes_on", [True, False])
def test_a_signal_brakes_once_or_not_at_all(goes_on: bool) -> None:
    port = FakeLatch()
    stage = Stage(port)
    stage.run = MeasuringRun([port], "N20", 0, False, goes_on=goes_on)
    stage.move()
    port.latch(3.0)
    stage.cycles(4)
    stage.cycles(2, standing=True)
    assert stage.orders.count(Order.BRAKE) == (0 if goes_on else 1)
    assert (stage.run.record.goes_on, stage.run.record.signal_ns) == (goes_on, 3 * MS)
    assert (stage.run.is_done, stage.run.record.latched_mm) == (True, {"Z": 3.0})


@pytest.mark.parametrize(
    ("value_mm", "speed_mm", "lags_mm", "latched_mm", "alarm_ids"),
    [
        (5.0, 0.5, (0.0, 0.0), {"Z": 4.0}, []),
        (-5.0, -0.5, (0.0, 0.0), {"Z": -4.0}, []),
        (0.75, 0.5, (0.0, 0.0), {}, [900520]),
        (0.75, 0.5, (0.25, 0.0), {"Z": -0.25}, []),
        (0.75, 0.5, (-0.25, 0.0), {"Z": -0.25}, []),
        (0.75, 0.5, (0.0, 9.0), {}, [900520]),
        (-0.75, -0.5, (0.0, 0.0), {}, [900520]),
        (0.75, 0.0, (0.0, 0.0), {"Z": 0.75}, []),
        (0.75, -0.0005, (0.0, 0.0), {"Z": 0.751}, []),
        (-0.75, 0.0005, (0.0, 0.0), {"Z": -0.751}, []),
        (-0.25, 0.5, (0.0, 0.0), {}, [900520]),
    ],
)
def test_a_value_is_led_back_as_far_as_the_axis_was_in_its_block(
    value_mm: float, speed_mm: float, lags_mm: tuple[float, float], latched_mm: dict[str, float],
    alarm_ids: list[int],
) -> None:  # fmt: skip
    """Two cycles at the speed of the latch, mm in each; the signal's cycle gives the lag.

    An axis that stands or swings back as it settles was where it is, whatever way it has come.
    """
    warned: list[int] = []
    lag, later = lags_mm
    now = [lag]
    dead = DeadTime("Z", 2.0, 0.0, 0.001, lambda _mm: 0.0, lambda: now[0])
    port = FakeLatch(latched_speed_mm=speed_mm)
    stage = Stage(port)
    stage.run = MeasuringRun(
        [port], "N20", 0, False, dead_times={"Z": dead}, warn=lambda alarm: warned.append(alarm.id)
    )
    stage.move()
    port.latch(value_mm)
    stage.cycle()
    now[0] = later
    stage.cycles(2, standing=True)
    assert (stage.run.is_done, stage.run.record.latched_mm, warned) == (True, latched_mm, alarm_ids)


def test_a_value_that_is_dropped_is_no_signal_where_one_is_wanted() -> None:
    dead = DeadTime("Z", 2.0, 0.0, 0.001, lambda _mm: 0.0, lambda: 0.0)
    port = FakeLatch(latched_speed_mm=0.5)
    stage = Stage(port)
    stage.run = MeasuringRun([port], "N20", 0, True, dead_times={"Z": dead})
    stage.move()
    port.latch(0.75)
    with pytest.raises(Alarm) as caught:
        stage.cycles(3, standing=True)
    assert (caught.value.id, caught.value.values["axis"]) == (900004, "Z")


def test_a_value_keeps_its_doubt() -> None:
    first, second = FakeLatch("X", doubt_mm=0.02), FakeLatch("Y")
    stage = Stage(first, second).move()
    first.latch(1.0)
    second.latch(2.0)
    stage.cycles(2, standing=True)
    assert (stage.run.is_done, stage.run.record.doubt_mm) == (True, {"X": 0.02})
