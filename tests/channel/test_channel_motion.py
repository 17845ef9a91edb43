"""What blocks do in time on the channel: arcs, dwell times, exact stops, programmed stops."""

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS


def block(number: int) -> Block:
    return Block(number, number * 10, f"N{number * 10}")


def circle(radius: float, feed: float, angle: float = math.tau) -> canon.ArcMove:
    """Counter-clockwise around (0, 0), from (radius, 0) where the axes stand."""
    target = {"X": radius * math.cos(angle), "Y": radius * math.sin(angle)}
    if angle == math.tau:
        target = {"X": radius, "Y": 0.0}
    return canon.ArcMove(block(1), target, {"X": 0.0, "Y": 0.0}, {"X": 0.0, "Y": 1.0}, angle, feed)


def two_axes(channel_bench: Any, words: Any, **options: Any) -> Any:
    return channel_bench(words.axis("X", start_mm=5.0), words.axis("Y"), **options)


@pytest.mark.long
def test_set_positions_of_a_circle_lie_on_it(channel_bench: Any, words: Any) -> None:
    bench = two_axes(channel_bench, words).run([circle(5.0, 1200.0), words.end()])
    assert bench.alarm_ids == []
    points = list(zip(bench.set_mm("X"), bench.set_mm("Y"), strict=True))
    assert min(x for x, _ in points) == pytest.approx(-5.0, abs=1e-3)
    # The drive tells where it stands in increments of 9.5 nm: that is where the circle begins.
    for x, y in points:
        assert math.hypot(x, y) == pytest.approx(5.0, abs=1e-5)
    assert points[-1] == (5.0, 0.0)
    assert max(math.dist(a, b) for a, b in pairwise(points)) <= 20.0 * 1e-3 * (1 + 1e-9)


@pytest.mark.long
def test_feed_on_a_small_circle_is_what_the_axes_allow(channel_bench: Any, words: Any) -> None:
    """r = 5 mm, 1000 mm/s²: no faster than sqrt(5 * 1000 / sqrt 2) = 59.5 mm/s of 100."""
    bench = two_axes(channel_bench, words).run([circle(5.0, 6000.0), words.end()])
    points = list(zip(bench.set_mm("X"), bench.set_mm("Y"), strict=True))
    fastest = max(math.dist(a, b) for a, b in pairwise(points)) / 1e-3
    assert fastest == pytest.approx(math.sqrt(5000 / math.sqrt(2)), rel=1e-3)


@pytest.mark.long
def test_an_alarm_brakes_on_the_circle(channel_bench: Any, words: Any) -> None:
    bench = two_axes(channel_bench, words)
    bench.prepare([circle(5.0, 1200.0), words.end()])
    moving = bench.scheduler.run_while(
        lambda: bench.channel.interpolator.path_travelled_mm < 8.0, 10**10
    )
    assert moving
    bench.channel.stop(Alarm(900070))
    bench.finish()
    points = list(zip(bench.set_mm("X"), bench.set_mm("Y"), strict=True))
    for x, y in points:
        assert math.hypot(x, y) == pytest.approx(5.0, abs=1e-5)
    # 20 mm/s at 1000 mm/s², of which the circle takes 20² / 5: 0.2 mm of arc and a little more
    stopped = math.atan2(points[-1][1], points[-1][0]) * 5.0
    low_mm = 8.0 + 200.0 / math.sqrt(1000.0**2 - 80.0**2)
    assert low_mm - 1e-4 <= stopped <= low_mm + 20.0 * 1e-3 + 1e-4


def test_circle_beyond_what_a_drive_can_be_told_is_refused(channel_bench: Any, words: Any) -> None:
    """The end is in reach, the far side of the circle is not: 900012 before anything moves."""
    far = 12_000.0
    command = canon.ArcMove(
        block(1), {"X": 5.0, "Y": 0.0}, {"X": 5.0 + far, "Y": 0.0}, {"X": 0.0, "Y": 1.0},
        math.tau, 1000.0,
    )  # fmt: skip
    bench = two_axes(channel_bench, words).run([command, words.end()])
    assert bench.alarm_ids == [900012]
    assert set(bench.set_mm("Y")) == {0.0}


@pytest.mark.long
@pytest.mark.parametrize(
    ("duration_ns", "cycles"),
    [(0, 0), (1, 1), (MS, 1), (MS + 1, 2), (71 * MS, 71), (70_400_000, 71)],
)
def test_dwell_is_whole_cycles_and_no_less_than_the_time(
    channel_bench: Any, words: Any, duration_ns: int, cycles: int
) -> None:
    """The set position stands for n = ceil(time / cycle) cycles more than without the dwell."""

    def standing(commands: list[canon.Command]) -> int:
        bench = channel_bench(words.axis("X")).run(commands)
        begun = next(k for k, x in enumerate(bench.set_mm("X")) if x == 1.0)
        return next(k for k, x in enumerate(bench.set_mm("X")) if x > 1.0) - begun

    moves = [words.move(1, 600.0, X=1.0), words.move(3, 600.0, X=2.0), words.end()]
    without = standing(moves)
    moves.insert(1, canon.Dwell(block(2), duration_ns))
    assert standing(moves) - without == cycles


@pytest.mark.long
def test_without_exact_stop_the_next_block_begins_where_the_set_position_stands(
    channel_bench: Any, words: Any
) -> None:
    bench = channel_bench(words.axis("X", kv=20.0)).run(
        [words.move(1, 600.0, X=1.0), words.move(2, 600.0, X=2.0), words.end()]
    )
    course = bench.set_mm("X")
    at = course.index(1.0)
    assert course[at + 1] > 1.0


@pytest.mark.long
def test_exact_stop_waits_for_the_window(channel_bench: Any, words: Any) -> None:
    """Kv 20, 10 mm/s: 0.5 mm of lag decays into 1 um in ln(500) / 20 = 0.31 s, less the ramp."""
    window_mm, kv = 0.001, 20.0
    bench = channel_bench(words.axis("X", kv=kv, window_mm=window_mm)).run(
        [
            words.move(1, 600.0, X=1.0),
            canon.ExactStop(block(1)),
            words.move(2, 600.0, X=2.0),
            words.end(),
        ]
    )
    course = bench.set_mm("X")
    leaves = next(k for k, x in enumerate(course) if x > 1.0)
    time_ns = bench.samples[leaves].time_ns
    stood_ns = bench.samples[course.index(1.0)].time_ns
    assert 1.0 - bench.axes["X"].position_at(time_ns) * 1e3 <= window_mm
    assert (time_ns - stood_ns) / 1e9 == pytest.approx(math.log(0.45 / window_mm) / kv, abs=0.03)


@pytest.mark.long
def test_programmed_stop_lasts_until_the_operator_starts(channel_bench: Any, words: Any) -> None:
    settings = ChannelSettings(start_after_ns=250 * MS)
    bench = channel_bench(words.axis("X"), settings=settings)
    bench.run(
        [
            words.move(1, 600.0, X=1.0),
            canon.ProgramStop(block(2), optional=False),
            words.message(3, "on", synchronous=True),
            words.end(),
        ]
    )
    (stop_ns, command, _), (start_ns, _, is_start) = bench.channel.plc.events
    assert is_start
    assert command.block.number == 20
    assert start_ns - stop_ns == 250 * MS
    assert bench.messages == [(start_ns, "on")]
    assert bench.alarm_ids == []


def test_a_stop_lasts_a_cycle_at_least(channel_bench: Any, words: Any) -> None:
    bench = channel_bench(words.axis("X"), settings=ChannelSettings(start_after_ns=0))
    stops = [canon.ProgramStop(block(n), optional=False) for n in (1, 2, 3)]
    bench.run([*stops, words.end()])
    events = bench.channel.plc.events
    pairs = zip(events[::2], events[1::2], strict=True)
    assert [start.time_ns - stop.time_ns for stop, start in pairs] == [MS] * 3


@pytest.mark.provokes(900170, 2, word="M0")
def test_programmed_stop_without_an_operator_ends_the_program(
    channel_bench: Any, words: Any
) -> None:
    bench = channel_bench(words.axis("X")).run(
        [canon.ProgramStop(block(1), optional=False), words.move(2, 600.0, X=1.0), words.end()]
    )
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (900170, 2, {"word": "M0"})
    assert "N10" in str(alarm)
    assert "plc:start_ms" in str(alarm)
    assert set(bench.set_mm("X")) == {0.0}


@pytest.mark.parametrize(("on", "alarms"), [(False, []), (True, [900170])])
def test_optional_stop_acts_only_when_it_is_switched_on(
    channel_bench: Any, words: Any, on: bool, alarms: list[int]
) -> None:
    bench = channel_bench(words.axis("X"), settings=ChannelSettings(optional_stop=on))
    bench.run([canon.ProgramStop(block(1), optional=True), words.end()])
    assert bench.alarm_ids == alarms


def test_technology_functions_are_told_in_order_and_cost_no_time(
    channel_bench: Any, words: Any
) -> None:
    functions = [canon.TechnologyFunction(block(n), letter, n) for n, letter in enumerate("MHT")]
    bench = channel_bench(words.axis("X")).run([*functions, words.end()])
    assert [event.command for event in bench.channel.plc.events] == functions
    assert len({event.time_ns for event in bench.channel.plc.events}) == 1


@pytest.mark.parametrize("target_mm", [10_000.0001, 10_000.0002, 9_999.9999, -0.0001])
def test_a_tenth_of_a_micrometre_over_ten_metres_reaches_the_drive(
    channel_bench: Any, words: Any, target_mm: float
) -> None:
    """What is sent is the whole increment next to the programmed number: 2^20 for 10 mm."""
    start_mm = float(round(target_mm))
    bench = channel_bench(words.axis("X", start_mm=start_mm, window_mm=0.01)).run(
        [words.move(1, 600.0, X=target_mm), words.end()]
    )
    assert bench.alarm_ids == []
    assert bench.final_mm("X") == target_mm
    last = [data for _, can_id, data in bench.frames if can_id == 0x201][-1]
    increments = round(Fraction(repr(target_mm)) * 2**20 / 10)
    assert int.from_bytes(last[2:6], "little", signed=True) == increments
