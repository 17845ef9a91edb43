"""Independent axes: each has its own profile and its own run, beside the path."""

from collections.abc import Callable
from itertools import pairwise
from math import ceil
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant

Make = Callable[..., Any]
MS, S = 1_000_000, 1_000_000_000
A_MM_S2 = 1000.0
INCREMENT_MM = 10 / 2**20


def alone(axis: str, target_mm: float, number: int = 1, **speed: Any) -> canon.IndependentMove:
    block = Block(number, number * 10, f"N{number * 10}")
    return canon.IndependentMove(block, axis, target_mm, **speed)


def at_targets(*axes: str) -> canon.WaitIndependent:
    return canon.WaitIndependent(Block(8, 80, "N80"), axes)


def trapezoid(distance: float, v: float, t: float) -> float:
    """Path after t of a motion with ramps of A_MM_S2 that reaches its speed."""
    ramp_s, whole_s = v / A_MM_S2, distance / v + v / A_MM_S2
    if t < ramp_s:
        return A_MM_S2 * t * t / 2
    if t < whole_s - ramp_s:
        return v * (t - ramp_s / 2)
    left = max(whole_s - t, 0.0)
    return distance - A_MM_S2 * left * left / 2


def course(bench: Any, axis: str) -> list[float]:
    """Set positions from the last one before the motion on."""
    values: list[float] = bench.set_mm(axis)
    first = next(n for n, value in enumerate(values) if value != values[0])
    return values[first - 1 :]


def arrival(values: list[float]) -> int:
    """Cycles from the begin of a motion to its end."""
    return next(n for n, value in enumerate(values) if value == values[-1])


@pytest.mark.long
def test_two_axes_begin_in_one_cycle_and_each_arrives_in_its_own_time(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Y"))
    orders = [alone("X", 10.0, feed_mm_min=600.0), alone("Y", -10.0, feed_mm_min=1200.0)]
    bench.run([*orders, at_targets("X", "Y"), words.end()])
    x, y = course(bench, "X"), course(bench, "Y")
    assert len(x) == len(y)
    assert x == pytest.approx([trapezoid(10, 10, k * 1e-3) for k in range(len(x))], abs=1e-9)
    assert y == pytest.approx([-trapezoid(10, 20, k * 1e-3) for k in range(len(y))], abs=1e-9)
    assert (arrival(x), arrival(y)) == (1010, 520)  # d/v + v/a


@pytest.mark.long
def test_an_axis_moves_beside_the_path_and_neither_bends_the_other(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Y"))
    path = [words.move(2, 600.0, Y=2.0), words.move(3, 600.0, Y=0.0)]
    bench.run([alone("X", 10.0, feed_mm_min=600.0), *path, words.end()])
    x, y = course(bench, "X"), course(bench, "Y")
    assert x == pytest.approx([trapezoid(10, 10, k * 1e-3) for k in range(len(x))], abs=1e-9)
    expected = [trapezoid(2, 10, k * 1e-3) for k in range(211)]
    assert y[:211] == pytest.approx(expected, abs=1e-9)
    assert y[211:422] == pytest.approx([2.0 - e for e in expected], abs=1e-9)
    assert (bench.final_mm("X"), bench.final_mm("Y")) == (10.0, 0.0)


@pytest.mark.long
def test_what_waits_for_an_axis_begins_when_it_is_there(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Y"))
    program = [alone("X", 10.0, feed_mm_min=600.0), at_targets("X"), words.move(2, 600.0, Y=2.0)]
    bench.run([*program, words.end()])
    x, y = bench.set_mm("X"), bench.set_mm("Y")
    there = next(n for n, value in enumerate(x) if value == 10.0)
    begin = next(n for n, value in enumerate(y) if value != 0.0)
    assert begin == there + 1


@pytest.mark.long
def test_the_end_of_the_program_waits_for_every_axis(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Y"))
    bench.run([alone("X", 10.0, feed_mm_min=600.0), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("X") == 10.0


@pytest.mark.parametrize("time_s", [0.5, 1.0, 7.0])
@pytest.mark.long(but=1)
def test_time_is_that_of_the_whole_motion(channel_bench: Make, words: Any, time_s: float) -> None:
    bench = channel_bench(words.axis("X"))
    bench.run([alone("X", 10.0, time_s=time_s), words.end()])
    assert arrival(course(bench, "X")) == ceil(round(time_s * 1e3, 6))


def test_a_time_that_cannot_be_kept_gives_the_fastest_motion(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("X"))
    bench.run([alone("X", 10.0, time_s=0.01), words.end()])
    assert arrival(course(bench, "X")) == 200  # 2 sqrt(d/a)


@pytest.mark.long
def test_weights_of_speed_and_acceleration(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X", speed_max_mm_s=100.0), words.axis("Y"))
    slow = alone("X", 40.0, speed_share=0.5)
    soft = alone("Y", 40.0, feed_mm_min=1200.0, acceleration_share=0.25)
    bench.run([slow, soft, words.end()])
    assert arrival(course(bench, "X")) == 850  # 40/50 + 50/1000
    assert arrival(course(bench, "Y")) == 2080  # 40/20 + 20/250


@pytest.mark.long
def test_rapid_traverse_has_the_speed_of_the_axis(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X", speed_max_mm_s=100.0))
    bench.run([alone("X", 40.0), words.end()])
    assert arrival(course(bench, "X")) == 500  # 40/100 + 100/1000


@pytest.mark.long
def test_an_alarm_stops_every_axis_with_its_own_ramp(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Z", start_mm=130.0), plane_mm=140.0)
    run = words.probe(3, 600.0, Z=110.0)  # 50052: the probe is deflected
    path = [words.move(2, 600.0, Z=129.0), run, words.wait(3), words.end()]
    bench.run([alone("X", 50.0, feed_mm_min=1200.0), *path])
    assert bench.alarm_ids == [50052]
    x = bench.set_mm("X")
    assert 0.0 < x[-1] < 50.0
    steps = [b - a for a, b in pairwise(x)]
    assert min(steps) >= 0.0
    full = max(n for n, step in enumerate(steps) if abs(step - 0.02) < 1e-9)
    assert x[-1] - x[full + 1] == pytest.approx(20.0**2 / (2 * A_MM_S2), abs=1e-9)


@pytest.mark.long
def test_a_block_that_cannot_be_decoded_stops_axes_that_are_under_way(
    channel_bench: Make, words: Any
) -> None:
    """Class 2: the path ends its blocks; what moves beside it stops with its own ramp."""

    def program() -> Any:
        yield alone("X", 100.0, feed_mm_min=600.0)
        yield words.move(2, 600.0, Y=2.0)
        raise Alarm(900108, place="N30")

    bench = channel_bench(words.axis("X"), words.axis("Y"))
    bench.run(program())
    assert bench.alarm_ids == [900108]
    assert bench.final_mm("Y") == 2.0
    x = bench.set_mm("X")
    assert 2.0 < x[-1] < 3.0
    steps = [b - a for a, b in pairwise(x)]
    full = max(n for n, step in enumerate(steps) if abs(step - 0.01) < 1e-9)
    assert x[-1] - x[full + 1] == pytest.approx(10.0**2 / (2 * A_MM_S2), abs=1e-9)


# Measuring


@pytest.mark.long
def test_an_axis_measures_while_another_moves(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Z", start_mm=130.0), plane_mm=120.0)
    measuring = alone("Z", 110.0, feed_mm_min=600.0, measuring_type=1)
    bench.run([alone("X", 30.0, feed_mm_min=600.0), measuring, at_targets("X", "Z"), words.end()])
    assert bench.alarm_ids == []
    (record,) = bench.channel.records
    latched_mm = bench.axes["Z"].position_at(bench.edge_ns()) * 1e3
    assert record.latched_mm["Z"] == pytest.approx(latched_mm, abs=INCREMENT_MM)
    assert bench.channel.measured_acs_mm("Z") == record.latched_mm["Z"]
    assert 110.0 < bench.final_mm("Z") < 120.0
    assert bench.final_mm("X") == 30.0


@pytest.mark.long
def test_the_path_measures_while_an_axis_moves_alone(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Z", start_mm=130.0), plane_mm=120.0)
    order = alone("X", 30.0, feed_mm_min=600.0)
    bench.run([order, words.probe(2, 600.0, Z=110.0), words.wait(2), words.end()])
    assert bench.alarm_ids == []
    (record,) = bench.channel.records
    latched_mm = bench.axes["Z"].position_at(bench.edge_ns()) * 1e3
    assert record.latched_mm["Z"] == pytest.approx(latched_mm, abs=INCREMENT_MM)
    assert record.end_ns is not None
    assert next(s.set_mm[0] for s in bench.samples if s.time_ns >= record.end_ns) < 30.0
    assert bench.final_mm("X") == 30.0


@pytest.mark.long
def test_a_run_goes_as_far_behind_its_target_as_it_may(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, probing_offset_mm=2.0), plane_mm=100.0)
    bench.run([alone("Z", 120.0, feed_mm_min=600.0, measuring_type=1), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == 118.0
    assert bench.channel.measured_acs_mm("Z") is None


@pytest.mark.long
def test_type_2_wants_a_signal(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=100.0)
    bench.run([alone("Z", 120.0, 4, feed_mm_min=600.0, measuring_type=2), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values) == (900004, {"axis": "Z"})
    assert "N40" in str(alarm)


@pytest.mark.provokes(50664, 4, axis="Z")
def test_50664_when_the_probe_of_the_axis_does_not_get_ready(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
    bench.links[0].arm = lambda: None  # the latch control word never goes out
    bench.run([alone("Z", 110.0, 4, feed_mm_min=600.0, measuring_type=1), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values) == (50664, {"axis": "Z"})
    assert alarm.entry.reaction_class == 4
    assert "N40" in str(alarm)
    assert set(bench.set_mm("Z")[5:]) == {bench.set_mm("Z")[-1]}


@pytest.mark.long
def test_50664_when_the_probe_of_the_axis_is_switched_off_on_the_way(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=100.0)
    channel, link = bench.channel, bench.links[0]

    def switch_off() -> None:
        if link.actual_mm < 125.0:
            link.disarm()

    channel.plc.join(PlcParticipant(switch_off))
    bench.run([alone("Z", 110.0, 4, feed_mm_min=600.0, measuring_type=1), words.end()])
    (alarm,) = channel.alarms
    assert (alarm.id, alarm.values) == (50664, {"axis": "Z"})
    assert "N40" in str(alarm)


@pytest.mark.long
def test_a_wait_is_for_the_axes_that_it_names(channel_bench: Make, words: Any) -> None:
    """X is under way to 6, Y to 2 mm; the path begins when Y is there and leads it on."""
    bench = channel_bench(words.axis("X"), words.axis("Y"))
    orders = [alone("X", 6.0, feed_mm_min=600.0), alone("Y", 2.0, feed_mm_min=600.0)]
    bench.run([*orders, at_targets("Y"), words.move(9, 600.0, Y=1.0), words.end()])
    y = bench.set_mm("Y")
    there = y.index(2.0)
    assert y[there + 2] < 2.0
    assert bench.set_mm("X")[there] < 3.0
    assert (bench.final_mm("X"), bench.final_mm("Y")) == (6.0, 1.0)


def test_50059_and_900103_and_900012(channel_bench: Make, words: Any) -> None:
    for order, alarm_id in (
        (alone("X", 10.0, feed_mm_min=600.0, measuring_type=1), 50059),
        (alone("Z", 130.0, feed_mm_min=600.0, measuring_type=1), 900103),
        (alone("Z", 1e9, feed_mm_min=600.0), 900012),
    ):
        bench = channel_bench(
            words.axis("X", may_measure=False), words.axis("Z", start_mm=130.0), plane_mm=120.0
        )
        assert bench.run([order, words.end()]).alarm_ids == [alarm_id]


@pytest.mark.long
def test_a_buffer_lets_the_axis_run_on_by_its_cycles(channel_bench: Make, words: Any) -> None:
    """5 cycles at 10 mm/s: the edge is met 5 ms later, and braking acts 5 ms later."""
    ends = []
    for buffer_cycles in (0, 5):
        bench = channel_bench(
            words.axis("Z", start_mm=130.0), plane_mm=120.0, buffer_cycles=buffer_cycles
        )
        order = alone("Z", 100.0, feed_mm_min=600.0, measuring_type=1)
        bench.run([order, at_targets("Z"), words.end()])
        assert bench.alarm_ids == []
        ends.append(bench.final_mm("Z"))
    assert ends[0] - ends[1] == pytest.approx(5 * 1e-3 * 10.0, abs=1e-9)
