"""The jerk-limited slope in a channel: who chooses it, feedhold and override inside a ramp.

Every axis has 1000 mm/s² and ramps of 50 ms: a jerk of 20 000 mm/s³. Up to 50 mm/s a ramp has no
constant part: from 0 to v it takes 2 sqrt(v/j) on v sqrt(v/j).
"""

from collections.abc import Callable
from itertools import pairwise
from math import ceil, sqrt
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., ChannelBench]
T_S, JERK = 1e-3, 20_000.0


def slope(number: int, profile: str | None) -> canon.SlopeChoice:
    return canon.SlopeChoice(Block(number, number * 10, ""), profile)


def course(bench: ChannelBench, axis: str) -> list[float]:
    """Set positions from the last one before the motion on."""
    values = bench.set_mm(axis)
    first = next(n for n, value in enumerate(values) if value != values[0])
    return values[first - 1 :]


def arrival(values: list[float], at_mm: float) -> int:
    """Cycles until a place."""
    return next(n for n, value in enumerate(values) if value == at_mm)


def differences(values: list[float], order: int) -> list[float]:
    for _ in range(order):
        values = [(b - a) / T_S for a, b in pairwise(values)]
    return values


def ramped_cycles(way_mm: float, speed: float) -> int:
    return ceil((way_mm / speed + 2.0 * sqrt(speed / JERK)) / T_S)


@pytest.mark.long
def test_a_program_chooses_the_profile_of_the_path_and_the_list_again(
    channel_bench: Make, words: Any
) -> None:
    """10 mm at 10 mm/s: 1.010 s without ramps, 1.0447 s with them, in either shape."""
    bench = channel_bench(words.axis("X"))
    program: list[canon.Command] = [slope(1, "TRAPEZ"), words.move(2, 600.0, X=10.0)]
    program += [slope(3, "SIN2"), words.move(4, 600.0, X=20.0)]
    program += [slope(5, None), words.move(6, 600.0, X=30.0)]
    bench.run([*program, words.end()])
    x = course(bench, "X")
    ends = [arrival(x, at_mm) for at_mm in (10.0, 20.0, 30.0)]
    assert ends == [ramped_cycles(10.0, 10.0), 2 * ramped_cycles(10.0, 10.0), 2 * 1045 + 1010]
    assert max(map(abs, differences(x[:1045], 3))) <= JERK * (1 + 1e-6)
    # The first cycles of TRAPEZ: s = j t³/6
    assert x[1:21] == pytest.approx([JERK * (k * T_S) ** 3 / 6 for k in range(1, 21)], abs=1e-12)


@pytest.mark.long
def test_slope_type_chooses_the_profile_of_an_axis_beside_the_path(
    channel_bench: Make, words: Any
) -> None:
    """Without the keyword P-CHAN-00071 counts, STEP here, whatever #SLOPE says of the path."""
    found = {}
    for profile in ("SIN2", "TRAPEZ", "STEP", None):
        bench = channel_bench(words.axis("X"), words.axis("Z"))
        block = Block(2, 20, "N20")
        alone = canon.IndependentMove(block, "X", 10.0, feed_mm_min=600.0, slope=profile)
        bench.run([slope(1, "TRAPEZ"), alone, words.move(3, 600.0, Z=10.0), words.end()])
        found[profile] = arrival(course(bench, "X"), 10.0)
        assert arrival(course(bench, "Z"), 10.0) == ramped_cycles(10.0, 10.0)
    ramped = ramped_cycles(10.0, 10.0)
    assert found == {"SIN2": ramped, "TRAPEZ": ramped, "STEP": 1010, None: 1010}


@pytest.mark.long
def test_a_time_of_an_axis_with_ramps_is_that_of_the_whole_motion(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("X"))
    block = Block(1, 10, "N10")
    bench.run([canon.IndependentMove(block, "X", 10.0, time_s=0.7, slope="TRAPEZ"), words.end()])
    assert arrival(course(bench, "X"), 10.0) == 700


def at_cycles(bench: ChannelBench, of: dict[int, Callable[[], None]]) -> None:
    """Do something after so many cycles of motion of the last axis."""
    moved = [0]

    def turn(channel: Any) -> None:
        if not channel.path.interpolator.is_standing:
            moved[0] += 1
            of.get(moved[0], lambda: None)()

    bench.channel.observers.append(turn)


@pytest.mark.long
def test_a_feedhold_inside_the_first_ramp(channel_bench: Make, words: Any) -> None:
    """After 20 ms: j t³/6 + 5 j t³/6 while the acceleration falls + j t³ from j t² down.

    That is 2 j t³ = 0.32 mm; later the path goes on to its end.
    """
    bench = channel_bench(words.axis("Z"))
    plc = bench.channel.plc
    at_cycles(
        bench,
        {
            20: lambda: setattr(plc, "feedhold", True),
            21: lambda: setattr(plc, "feedhold", True),
        },
    )
    released = bench.channel.observers
    held = [0]

    def let_go(channel: Any) -> None:
        if plc.feedhold:
            held[0] += 1
            if held[0] == 300:
                plc.feedhold = False

    released.append(let_go)
    bench.run([slope(1, "TRAPEZ"), words.move(2, 1800.0, Z=10.0), words.end()])
    z = course(bench, "Z")
    assert z[150] == z[250] == pytest.approx(2.0 * JERK * 0.02**3, abs=1e-9)
    assert z[-1] == 10.0
    assert max(map(abs, differences(z, 3))) <= JERK * (1 + 1e-6)
    assert max(map(abs, differences(z, 2))) <= 1000.0 * (1 + 1e-9)


@pytest.mark.parametrize("permille", [100, 500, 900])
def test_an_override_inside_a_ramp_keeps_every_limit(
    channel_bench: Make, words: Any, permille: int
) -> None:
    bench = channel_bench(words.axis("Z"))
    plc = bench.channel.plc
    of: dict[int, Callable[[], None]] = {
        30: lambda: setattr(plc, "override_permille", permille),
        150: lambda: setattr(plc, "override_permille", 1000),
    }
    at_cycles(bench, of)
    bench.run([slope(1, "SIN2"), words.move(2, 3600.0, Z=10.0), words.end()])
    z = course(bench, "Z")
    assert z[-1] == 10.0
    assert max(differences(z, 1)) <= 60.0 * (1 + 1e-9)
    assert max(map(abs, differences(z, 2))) <= 1000.0 * (1 + 1e-9)
    assert max(map(abs, differences(z, 3))) <= 1.5708 * JERK * (1 + 1e-6)


@pytest.mark.long
def test_a_signal_stops_with_the_ramps_of_the_stop(channel_bench: Make, words: Any) -> None:
    """20 mm/s; 4000 mm/s² and 10 ms stop on 20 sqrt(20/400000) = 0.1414 mm, the path on 0.632."""
    ways = []
    for own in ((1000.0, 0.05), (4000.0, 0.01)):
        z = words.axis("Z", stop_mm_s2=own[0], ramp_s=(0.05, own[1]), start_mm=20.0)
        bench = channel_bench(z, plane_mm=5.0)
        bench.run([slope(1, "TRAPEZ"), words.probe(2, 1200.0, Z=0.0), words.end()])
        values = course(bench, "Z")
        speed = differences(values, 1)
        last = max(n for n, v in enumerate(speed) if v < -20.0 + 1e-9)
        ways.append(values[last + 1] - values[-1])
    expected = [20.0 * sqrt(20.0 * t / a) for a, t in ((1000.0, 0.05), (4000.0, 0.01))]
    assert ways == pytest.approx(expected, abs=1e-9)
