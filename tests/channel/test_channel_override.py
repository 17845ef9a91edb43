"""Overrides of the PLC side in a channel: which of them act on which motion.

Speeds of paths along two axes are in 3-4-5; every ramp has 1000 mm/s².
"""

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.channel.path.settings import OverrideMode
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS

Make = Callable[..., ChannelBench]


def speeds_mm_s(bench: ChannelBench, axis: str) -> list[float]:
    """Way from cycle to cycle by its time, to a nanometre per second."""
    return [round((b - a) / 1e-3, 6) for a, b in pairwise(bench.set_mm(axis))]


def run(bench: ChannelBench, *commands: canon.Command, path: int = 1000, **axes: int) -> None:
    plc = bench.channel.plc
    plc.override_permille = path
    for axis, permille in axes.items():
        plc.axis[axis].override_permille = permille
    bench.run([*commands, canon.EndOfProgram(Block(99, 990, "N990 M30"))])


@pytest.mark.parametrize(
    ("overrides", "expected_mm_s"),
    [
        ({}, 50.0),
        ({"path": 500}, 25.0),
        ({"path": 10}, 0.5),
        ({"Y": 300}, 15.0),
        ({"Y": 300, "Z": 200}, 10.0),  # the smallest one of the axes that move
        ({"path": 500, "Z": 200}, 5.0),  # times that of the path
        ({"path": 1500}, 50.0),  # P-CHAN-00056 as it is
    ],
)
@pytest.mark.long(but=1)
def test_the_feed_of_a_path_is_scaled(
    channel_bench: Make, words: Any, overrides: dict[str, int], expected_mm_s: float
) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    far = 0.2 * expected_mm_s + 5.0
    run(bench, words.move(1, 3000.0, Y=0.6 * far, Z=0.8 * far), **overrides)
    assert max(speeds_mm_s(bench, "Y")) == pytest.approx(0.6 * expected_mm_s, abs=2e-6)
    assert max(speeds_mm_s(bench, "Z")) == pytest.approx(0.8 * expected_mm_s, abs=2e-6)
    assert (bench.final_mm("Y"), bench.final_mm("Z")) == (0.6 * far, 0.8 * far)


@pytest.mark.long
def test_the_override_of_an_axis_that_does_not_move_changes_not_a_bit(
    channel_bench: Make, words: Any
) -> None:
    ways = []
    for overrides in ({}, {"Y": 100}):
        bench = channel_bench(words.axis("Y"), words.axis("Z"))
        run(bench, words.move(1, 3000.0, Z=10.0), **overrides)
        ways.append(bench.set_mm("Z"))
    assert ways[0] == ways[1]


@pytest.mark.long
def test_above_100_percent_the_limits_of_the_axes_hold(channel_bench: Make, words: Any) -> None:
    settings = ChannelSettings(override_max_permille=1800)
    bench = channel_bench(words.axis("Z", speed_max_mm_s=80.0), settings=settings)
    run(bench, words.move(1, 2400.0, Z=40.0), words.move(2, 3000.0, Z=80.0), path=2000)
    speeds = speeds_mm_s(bench, "Z")
    half = len(speeds) // 2
    assert (max(speeds[:half]), max(speeds[half:])) == (72.0, 80.0)


@pytest.mark.long
def test_a_measuring_run_keeps_within_the_stroke_of_its_probe_at_200_percent(
    channel_bench: Make, words: Any
) -> None:
    """Type 2: a stroke of 2 mm and 1000 mm/s² allow v²/2a <= 2 mm, 63.2 mm/s; 2 * 40 is more."""
    axis = words.axis("Z", measuring_mm_s=40.0, stroke_mm=2.0)
    bench = channel_bench(axis, settings=ChannelSettings(override_max_permille=2000))
    run(bench, words.probe(1, None, 2, error_no_signal=False, Z=40.0), path=2000)
    assert max(speeds_mm_s(bench, "Z")) == pytest.approx((2 * 1000 * 2.0) ** 0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("mode", "expected_mm_s"),
    [(OverrideMode.CHANNEL, 25.0), (OverrideMode.LEAST, 15.0), (OverrideMode.AXIS, 15.0)],
)
@pytest.mark.long(but=1)
def test_which_override_acts_on_an_axis_beside_the_path(
    channel_bench: Make, words: Any, mode: OverrideMode, expected_mm_s: float
) -> None:
    """P-AXIS-00491: that of the channel, 50 %, the smaller one, or that of the axis, 30 %."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", override_mode=mode))
    beside = canon.IndependentMove(Block(1, 10, "N10"), "Z", 20.0, feed_mm_min=3000.0)
    wait = canon.WaitIndependent(Block(2, 20, "N20"), ("Z",))
    run(bench, beside, wait, path=500, Z=300)
    assert max(speeds_mm_s(bench, "Z")) == pytest.approx(expected_mm_s, abs=2e-6)
    assert bench.final_mm("Z") == 20.0


@pytest.mark.long
@pytest.mark.parametrize("mode", [OverrideMode.CHANNEL, OverrideMode.LEAST, OverrideMode.AXIS])
@pytest.mark.parametrize(("released", "expected_mm_s"), [(1000, 50.0), (1200, 60.0)])
def test_p_chan_00056_bounds_the_override_of_an_axis_beside_the_path_too(
    channel_bench: Make, words: Any, mode: OverrideMode, released: int, expected_mm_s: float
) -> None:
    """150 % of the channel; the axis has 100 %, which is the smaller one and that of the axis."""
    settings = ChannelSettings(override_max_permille=released)
    bench = channel_bench(words.axis("Z", override_mode=mode), settings=settings)
    beside = canon.IndependentMove(Block(1, 10, "N10"), "Z", 20.0, feed_mm_min=3000.0)
    run(bench, beside, canon.WaitIndependent(Block(2, 20, "N20"), ("Z",)), path=1500)
    if mode is not OverrideMode.CHANNEL:
        expected_mm_s = 50.0
    assert max(speeds_mm_s(bench, "Z")) == pytest.approx(expected_mm_s, abs=2e-6)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("mode", list(OverrideMode))
def test_an_axis_beside_the_path_goes_on_while_the_path_is_held(
    channel_bench: Make, words: Any, mode: OverrideMode
) -> None:
    """The feedhold of the channel is one of its path; an axis has its own."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", override_mode=mode))
    plc, turns = bench.channel.plc, iter(range(10**6))

    def turn() -> None:
        plc.feedhold = 100 <= next(turns) < 300

    plc.join(PlcParticipant(turn))
    bench.run([BESIDE, words.move(1, 3000.0, Y=10.0), ARRIVED, words.end()])
    first = next(k for k, speed in enumerate(speeds_mm_s(bench, "Y")) if speed)
    held = slice(first + 160, first + 290)  # the path has braked by then
    assert set(speeds_mm_s(bench, "Y")[held]) == {0.0}
    assert set(speeds_mm_s(bench, "Z")[held]) == {50.0}
    assert (bench.final_mm("Y"), bench.final_mm("Z")) == (10.0, 40.0)


def in_turns(bench: ChannelBench, course: Callable[[int], Mapping[str, int]]) -> None:
    """Let the overrides of the path ("") and of axes be those of a course, by the cycle."""
    plc, turns = bench.channel.plc, iter(range(10**6))

    def turn() -> None:
        now = {"": 1000, **course(next(turns))}
        plc.override_permille = now.pop("")
        for axis, permille in now.items():
            plc.axis[axis].override_permille = permille

    plc.join(PlcParticipant(turn))


BESIDE = canon.IndependentMove(Block(1, 10, "N10"), "Z", 40.0, feed_mm_min=3000.0)
ARRIVED = canon.WaitIndependent(Block(2, 20, "N20"), ("Z",))


@pytest.mark.parametrize("is_beside", [False, True])
@pytest.mark.parametrize("permille", [0, 300])
@pytest.mark.long(but=1)
def test_an_override_acts_in_the_cycle_in_which_the_plc_side_gives_it(
    channel_bench: Make, words: Any, permille: int, is_beside: bool
) -> None:
    """At 50 mm/s: the way of this cycle is the first one with 1000 mm/s2, on the path or beside."""
    bench = channel_bench(words.axis("Z", override_mode=OverrideMode.AXIS))
    changed: list[int] = []

    def course(cycle: int) -> Mapping[str, int]:
        if cycle == 400:
            changed.append(len(bench.samples))
        return {"Z": permille if 400 <= cycle < 900 else 1000}

    in_turns(bench, course)
    commands = [BESIDE, ARRIVED] if is_beside else [words.move(1, 3000.0, Z=40.0)]
    bench.run([*commands, canon.EndOfProgram(Block(99, 990, "N990 M30"))])
    (at,) = changed
    speeds = speeds_mm_s(bench, "Z")  # speeds[n]: from sample n to the next one
    assert speeds[at - 2 : at + 1] == pytest.approx([50.0, 49.5, 48.5], abs=1e-5)
    assert min(speeds[at : at + 300]) == pytest.approx(50.0 * permille / 1000, abs=1e-5)
    assert bench.final_mm("Z") == 40.0


@pytest.mark.long
@pytest.mark.parametrize("is_beside", [False, True])
def test_a_motion_that_begins_at_override_0_waits_where_it_is(
    channel_bench: Make, words: Any, is_beside: bool
) -> None:
    """Nothing moves in the first 300 cycles, by an increment; then with 50 % to the target."""
    bench = channel_bench(words.axis("Z", override_mode=OverrideMode.AXIS))
    until: list[int] = []

    def course(cycle: int) -> Mapping[str, int]:
        if cycle == 300:
            until.append(len(bench.samples))
        return {"Z": 0 if cycle < 300 else 500}

    in_turns(bench, course)
    commands = [BESIDE, ARRIVED] if is_beside else [words.move(1, 3000.0, Z=40.0)]
    bench.run([*commands, canon.EndOfProgram(Block(99, 990, "N990 M30"))])
    assert set(bench.set_mm("Z")[: until[0]]) == {0.0}
    assert max(speeds_mm_s(bench, "Z")) == pytest.approx(25.0, abs=2e-6)
    assert bench.final_mm("Z") == 40.0


@pytest.mark.long
@pytest.mark.parametrize("name", ["", "Z"])
def test_an_override_back_at_100_percent_is_taken_each_time(
    channel_bench: Make, words: Any, name: str
) -> None:
    """30 % and 100 % in turns of 100 cycles, of the path and of an axis: 15 and 50 mm/s."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    in_turns(bench, lambda cycle: {name: 300 if cycle // 100 % 2 else 1000})
    bench.run([words.move(1, 3000.0, Z=15.0), words.end()])
    speeds = speeds_mm_s(bench, "Z")
    first = next(k for k, speed in enumerate(speeds) if speed)
    seen = [speeds[first + 100 * k + 75] for k in range(4)]
    assert seen == pytest.approx([50.0, 15.0] * 2, abs=2e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("profile", "after"),
    [
        ("STEP", lambda _k: {"": 300}),
        ("TRAPEZ", lambda _k: {"Z": 1}),
        ("SIN2", lambda k: {"": 1000 - 20 * min(k, 45)}),
        ("SIN2", lambda k: {"": 1000 if k % 2 else 100}),
        ("TRAPEZ", lambda _k: {"": 0}),
    ],
    ids=["step", "axis", "ramp", "to and fro", "hold"],
)
def test_an_override_that_changes_while_the_path_brakes_at_a_signal_leaves_the_brake_alone(
    channel_bench: Make, words: Any, profile: str, after: Callable[[int], Mapping[str, int]]
) -> None:
    """Not a bit of the stop changes; the override is back when the run has ended."""

    def course_of(acts: bool) -> list[float]:
        bench = channel_bench(words.axis("Z", start_mm=12.5), plane_mm=10.0)
        signalled: list[int] = []

        def course(cycle: int) -> Mapping[str, int]:
            run = bench.channel.measurement
            if run.is_active and bench.channel.interpolator._braking:
                signalled.append(cycle)
            brakes = bool(signalled) and cycle <= signalled[0] + 100
            return after(cycle - signalled[0]) if acts and brakes else {"Z": 1000}

        in_turns(bench, course)
        choice = canon.SlopeChoice(Block(1, 10, ""), profile)
        bench.run([choice, words.probe(2, 1800.0, Z=0.0), words.end()])
        assert signalled
        assert bench.alarm_ids == []
        return bench.set_mm("Z")[:350]

    assert course_of(True) == course_of(False)


@pytest.mark.long
def test_an_override_of_0_holds_the_path_until_it_is_above(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    plc = bench.channel.plc
    turns = iter(range(10**6))

    def turn() -> None:
        plc.override_permille = 0 if next(turns) < 300 else 500

    plc.join(PlcParticipant(turn))
    bench.run([words.move(1, 3000.0, Z=10.0), words.end()])
    z = bench.set_mm("Z")
    begin = next(k for k, s in enumerate(bench.samples) if s.time_ns >= bench.channel.start_ns)
    assert set(z[: begin + 300]) == {0.0}
    assert z[begin + 301] > 0.0
    assert max(speeds_mm_s(bench, "Z")) == 25.0
    assert z[-1] == 10.0


HOLDS = ("", "Y", " Y", " ", " Z", "Z", "YZ", " YZ", " Y", "Y", "Z", "")
"""Who is held in turn: a blank is the path, Y does not move, Z does."""


@pytest.mark.parametrize("word", ["feedhold", "override_permille"])
@pytest.mark.long
def test_a_path_is_held_by_itself_and_by_axes_that_it_moves_whatever_else_is_held(
    channel_bench: Make, words: Any, word: str
) -> None:
    """At 10 mm/s and 1000 mm/s² a change of the hold is over after 10 of 20 cycles."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    plc, turns = bench.channel.plc, iter(range(10**6))
    units = {" ": plc, "Y": plc.axis["Y"], "Z": plc.axis["Z"]}

    def turn() -> None:
        held = HOLDS[min(next(turns) // 20, len(HOLDS) - 1)]
        for name, unit in units.items():
            is_on = name in held
            setattr(unit, word, is_on if word == "feedhold" else 1000 * (not is_on))

    plc.join(PlcParticipant(turn))
    bench.run([words.move(1, 600.0, Z=1.5), words.end()])
    speeds = speeds_mm_s(bench, "Z")
    first = next(k for k, speed in enumerate(speeds) if speed)
    seen = [speeds[first + 20 * k + 15] for k in range(len(HOLDS))]
    stands = [" " in held or "Z" in held for held in HOLDS]
    assert seen == [0.0 if held else 10.0 for held in stands]
    changes = [is_on for before, is_on in pairwise(stands) if is_on is not before]
    assert [is_on for _, is_on in bench.channel.path.holds] == changes
    assert bench.final_mm("Z") == 1.5


@pytest.mark.long
def test_the_window_does_not_count_while_an_override_falls(channel_bench: Make, words: Any) -> None:
    """From 10 to 1 mm/s within a second, back behind 0.2 mm: slower than W / tau for 300 ms.

    The start distance of 2 mm counts again from the end of the fall; nothing is found in free air.
    """
    window = FixedStopSettings(window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    axis = words.axis("Z", source="FIXED_STOP", fixed_stop=window)
    bench = channel_bench(axis, settings=ChannelSettings(stop_may_be_missing=True))
    plc, turns = bench.channel.plc, iter(range(10**6))

    def turn() -> None:
        fallen = min(max(next(turns) - 500, 0), 1200)
        plc.override_permille = 1000 - min(fallen, 1000) * 9 // 10 if fallen < 1200 else 1000

    plc.join(PlcParticipant(turn))
    bench.run([words.probe(1, 600.0, 7, Z=30.0), words.wait(2), words.end()])
    assert bench.alarm_ids == []
    assert bench.channel.records[0].latched_mm == {}
    assert min(speeds_mm_s(bench, "Z")[1000:1600]) == 1.0
