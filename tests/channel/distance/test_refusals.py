"""What the channel refuses, and the control unit of the PLC side."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., Any]


def unit_of(made: Any, axis: str = "Z") -> Any:
    return made.channel.plc.axis[axis].distance


def order(made: Any, transition: DistanceCommand | None, axis: str = "Z", **values: float) -> None:
    """Give a command as the PLC side does."""
    unit = unit_of(made, axis)
    assert not unit.command_semaphor_rw
    unit.enable_w = True
    unit.command_w.transition = transition
    unit.command_w.set_pos_mm = values.get("set_pos_mm")
    unit.command_w.set_dist_mm = values.get("set_dist_mm")
    unit.command_semaphor_rw = True


# The control unit


def test_the_plc_commands_in_its_turn_and_the_kernel_takes_it_in_the_same_cycle(
    distance_bench: Make, say: Any
) -> None:
    made = distance_bench(lambda _t: 0.5, kp=0.5)
    made.at({50: lambda: order(made, DistanceCommand.ON, set_pos_mm=0.0)})
    semaphores: list[bool] = []
    made.channel.observers.append(lambda _c: semaphores.append(unit_of(made).command_semaphor_rw))
    made.run(say.dwell(200))
    assert made.seen.state[49:51] == [DistanceState.INACTIVE, DistanceState.ACTIVE]
    assert made.seen.offset_mm[49:51] == pytest.approx([0.0, 0.25], abs=1e-4)
    assert not any(semaphores)
    assert unit_of(made).state_r.source is Source.PLC


def test_a_command_waits_until_the_plc_is_enabled(distance_bench: Make, say: Any) -> None:
    made = distance_bench()
    unit = unit_of(made)

    def ask() -> None:
        order(made, DistanceCommand.ON, set_pos_mm=0.0)
        unit.enable_w = False

    def enable() -> None:
        unit.enable_w = True

    made.at({50: ask, 80: enable})
    made.run(say.dwell(200))
    assert made.seen.state.index(DistanceState.ACTIVE) == 80


@pytest.mark.long
def test_the_plc_may_change_the_distance_in_every_cycle(distance_bench: Make, say: Any) -> None:
    """SET_DIST falls by 2 um a cycle; the gap lags v T / kp behind, before the update."""
    made = distance_bench(kp=0.25)
    begin, rate_mm = 100, 0.002

    def turn(cycle: int) -> Callable[[], None]:
        wanted = say.start_mm - rate_mm * max(0, cycle - begin)
        return lambda: order(made, None, set_dist_mm=wanted)

    made.at({cycle: turn(cycle) for cycle in range(60, 500)})
    made.run(say.command("on_const", set_dist_mm=say.start_mm), say.dwell(480))
    steps = [b - a for a, b in pairwise(made.seen.offset_mm[300:401])]
    assert steps == pytest.approx([-rate_mm] * 100, abs=2 / say.per_mm)
    wanted = say.start_mm - rate_mm * 300
    gap = -made.seen.sensor_mm[400]
    assert gap - wanted == pytest.approx(rate_mm / 0.25, abs=3 / say.per_mm)


# Not released


@pytest.mark.parametrize("is_plc", [False, True])
@pytest.mark.provokes(70336, 7, owner="axis X")
def test_an_axis_that_is_not_released(
    distance_bench: Make, say: Any, words: Any, is_plc: bool
) -> None:
    made = distance_bench(more=(words.axis("X"),))
    if is_plc:
        made.at({50: lambda: order(made, DistanceCommand.ON, "X", set_pos_mm=0.0)})
        made.run(say.dwell(200))
        assert made.seen.time_ns[-1] - made.seen.time_ns[0] < 80e6
    else:
        made.run(say.command("on", "X", set_pos_mm=0.0))
    assert made.alarm_ids == [70336]


@pytest.mark.provokes(310015, 7, owner="axis X")
def test_of_two_families_of_ids_the_list_decides(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(more=(words.axis("X", tells_newer_ids=True),))
    made.run(say.command("freeze", "X"))
    assert made.alarm_ids == [310015]


# Sensors


@pytest.mark.parametrize("name", [None, "V.E.MISSING"])
@pytest.mark.provokes(310027, 7, owner="axis Z")
def test_a_variable_that_is_none(distance_bench: Make, say: Any, name: str | None) -> None:
    made = distance_bench()
    made.run(say.command(sensor_source="VARIABLE", sensor_variable=name))
    assert made.alarm_ids == [310027]


@pytest.mark.provokes(310028, 7, owner="axis Z", current="SECOND_ENCODER")
def test_another_source_while_the_control_is_on(distance_bench: Make, say: Any) -> None:
    made = distance_bench()
    made.channel.plc.values["SENSOR"] = 0.0
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(20),
        say.command(sensor_source="VARIABLE", sensor_variable="V.E.SENSOR"),
    )  # fmt: skip
    assert made.alarm_ids == [310028]


def test_the_same_source_again_is_no_change(distance_bench: Make, say: Any) -> None:
    made = distance_bench()
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(20),
        say.command(sensor_source="SECOND_ENCODER"), say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == []


@pytest.mark.parametrize("asks", [True, False])
@pytest.mark.provokes(310029, 7, owner="axis Z", source="SECOND_ENCODER")
def test_no_second_encoder(distance_bench: Make, say: Any, asks: bool) -> None:
    made = distance_bench(spec={"height_mm": None})
    source = say.command(sensor_source="SECOND_ENCODER")
    made.run(source if asks else say.command("on", set_pos_mm=0.0))
    assert made.alarm_ids == [310029]


# Measurement runs


def _run_of(words: Any, *, beside: bool) -> canon.Command:
    """A run of Z on the path, or of the axis by itself."""
    if beside:
        block = Block(3, 30, "N30")
        return canon.IndependentMove(block, "Z", 4.0, feed_mm_min=600.0, measuring_type=1)
    run: canon.Command = words.probe(3, 600.0, Z=4.0)
    return run


@pytest.mark.provokes(900521, 7, axis="Z", owner="axis Z")
@pytest.mark.parametrize("beside", [False, True])
def test_no_run_begins_on_an_axis_whose_control_is_on(
    distance_bench: Make, say: Any, words: Any, beside: bool
) -> None:
    made = distance_bench(options={"plane_mm": 5.0})
    run = _run_of(words, beside=beside)
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(20), run)
    assert made.alarm_ids == [900521]
    assert set(made.seen.interpolated_mm) == {say.start_mm}


@pytest.mark.long
def test_frozen_or_on_another_axis_it_does_not_keep_an_axis_from_measuring(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(lambda _t: 0.5, options={"plane_mm": 5.0})
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(100), say.command("freeze"),
        words.probe(3, 600.0, Z=4.0), say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == []
    (record,) = made.channel.records
    assert record.latched_mm["Z"] == pytest.approx(5.0, abs=2 / say.per_mm)


@pytest.mark.provokes(70521, 7, owner="axis Z")
@pytest.mark.parametrize("beside", [False, True])
def test_it_is_not_switched_on_while_its_axis_measures(
    distance_bench: Make, say: Any, words: Any, beside: bool
) -> None:
    made = distance_bench(options={"plane_mm": 5.0})
    run = _run_of(words, beside=beside)
    made.at({100: lambda: order(made, DistanceCommand.ON, set_pos_mm=0.0)})
    made.run(run, say.dwell(500))
    assert made.alarm_ids == [70521]
    assert set(made.seen.offset_mm) == {0.0}


@pytest.mark.provokes(310005, 7, owner="axis Z")
def test_an_axis_with_the_newer_structure_tells_the_newer_id(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(options={"plane_mm": 5.0}, is_newer=True)
    made.at({100: lambda: order(made, DistanceCommand.ON, set_pos_mm=0.0)})
    made.run(words.probe(3, 600.0, Z=4.0), say.dwell(500))
    assert made.alarm_ids == [310005]
