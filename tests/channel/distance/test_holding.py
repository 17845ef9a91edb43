"""What freezes the offset and what does not (FCT-M3 2 and 5; domain: freeze rules)."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceState
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

RISE_NS = 200 * MS
RATE_MM_S = 2.0
Make = Callable[..., Any]


def rising(time_ns: int) -> float:
    """A surface that rises by 1 mm within 0.5 s."""
    return min(max(0.0, (time_ns - RISE_NS) / 1e9 * RATE_MM_S), 1.0)


def on(say: Any) -> Any:
    return say.command("on", set_pos_mm=0.0)


def held_from_to(made: Any, set_hold: Callable[[Any, bool], None], begin: int, end: int) -> None:
    plc = made.channel.plc
    made.at({begin: lambda: set_hold(plc, True), end: lambda: set_hold(plc, False)})


def of_axis(plc: Any, is_on: bool) -> None:
    plc.axis["Z"].feedhold = is_on


def by_override(plc: Any, is_on: bool) -> None:
    plc.axis["Z"].override_permille = 0 if is_on else 1000


def of_path(plc: Any, is_on: bool) -> None:
    plc.feedhold = is_on


@pytest.mark.long
@pytest.mark.parametrize("hold", [of_axis, by_override])
@pytest.mark.parametrize("is_optimized", [True, False])
def test_feedhold_and_override_0_of_the_axis_freeze_the_offset_to_the_bit(
    distance_bench: Make, say: Any, hold: Callable[[Any, bool], None], is_optimized: bool
) -> None:
    made = distance_bench(rising, is_optimized=is_optimized)
    held_from_to(made, hold, 300, 450)
    made.run(on(say), say.dwell(900))
    seen = made.seen
    frozen = seen.offset_mm[300:450]
    assert seen.offset_mm[298] < seen.offset_mm[299] == frozen[0]
    assert set(frozen) == {seen.offset_mm[299]}
    assert 0.1 < frozen[0] < 0.9
    # what was on its way goes out a cycle later without optimized scheduling, then nothing moves
    assert set(seen.sent_mm[301:450]) == {say.start_mm + frozen[0]}
    assert set(seen.state[1:]) == {DistanceState.ACTIVE}
    assert seen.offset_mm[-1] == pytest.approx(1.0, abs=1e-4)


def in_g4(say: Any) -> list[canon.Command]:
    return [on(say), say.dwell(900)]


def in_m_wait(say: Any) -> list[canon.Command]:
    return [on(say), canon.TechnologyFunction(Block(2, 20, "N20 M50"), "M", 50), say.dwell(1)]


@pytest.mark.long
@pytest.mark.parametrize("program", [in_g4, in_m_wait])
def test_dwell_and_m_wait_do_not_freeze_it(
    distance_bench: Make, say: Any, program: Callable[[Any], list[canon.Command]]
) -> None:
    made = distance_bench(rising)
    made.channel.plc.acknowledged_later = frozenset({"M50"})
    made.at({900: made.channel.plc.acknowledge})
    made.run(*program(say))
    assert made.seen.offset_mm[100] == 0.0
    assert made.seen.offset_mm[895] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.long
def test_feedhold_of_the_path_does_not_freeze_it(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(rising)
    held_from_to(made, of_path, 100, 900)
    made.run(on(say), words.move(3, 60.0, Z=say.start_mm + 0.3))
    seen = made.seen
    assert len(set(seen.interpolated_mm[200:899])) == 1  # the path stands
    assert seen.interpolated_mm[899] < say.start_mm + 0.3
    assert seen.offset_mm[895] == pytest.approx(1.0, abs=1e-4)
    assert seen.interpolated_mm[-1] == say.start_mm + 0.3  # and goes on to its end


# The path and axes beside it


@pytest.mark.long
@pytest.mark.parametrize("hold", [of_axis, by_override])
def test_a_held_axis_holds_the_path_that_moves_it(
    distance_bench: Make, say: Any, words: Any, hold: Callable[[Any, bool], None]
) -> None:
    made = distance_bench(more=(words.axis("X"),))
    held_from_to(made, hold, 50, 350)
    made.run(words.move(1, 600.0, X=2.0, Z=say.start_mm + 1.0))
    x = made.bench.set_mm("X")
    start = next(k for k, s in enumerate(made.bench.samples) if s.time_ns == made.seen.time_ns[0])
    assert len(set(x[start + 100 : start + 349])) == 1
    assert 0.0 < x[start + 200] < 2.0
    assert x[-1] == 2.0
    assert made.seen.interpolated_mm[-1] == say.start_mm + 1.0
    assert made.alarm_ids == []


@pytest.mark.long
def test_it_does_not_hold_a_path_of_other_axes_but_the_next_one_that_moves_it(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(more=(words.axis("X"),))
    held_from_to(made, of_axis, 20, 1000)
    made.run(words.move(1, 600.0, X=2.0), words.move(2, 600.0, X=3.0, Z=say.start_mm + 1.0))
    x = made.bench.set_mm("X")
    start = next(k for k, s in enumerate(made.bench.samples) if s.time_ns == made.seen.time_ns[0])
    assert set(x[start + 500 : start + 999]) == {2.0}
    assert x[start + 1005] > 2.0
    assert x[-1] == 3.0
    # the first path lasts as long as without a hold: 2 mm at 10 mm/s and 1000 mm/s2
    assert x[start + 215] == 2.0


@pytest.mark.long
def test_an_axis_beside_the_path_is_held_by_itself(
    distance_bench: Make, say: Any, words: Any
) -> None:
    made = distance_bench(more=(words.axis("X"),))
    held_from_to(made, of_axis, 50, 350)
    made.run(
        canon.IndependentMove(Block(1, 10, "N10"), "Z", say.start_mm + 1.0, feed_mm_min=300.0),
        words.move(2, 600.0, X=2.0),
        canon.WaitIndependent(Block(3, 30, "N30"), ("Z",)),
    )
    z = made.seen.interpolated_mm
    assert len(set(z[80:349])) == 1
    assert say.start_mm < z[200] < say.start_mm + 1.0
    assert z[-1] == say.start_mm + 1.0
    x = made.bench.set_mm("X")
    start = next(k for k, s in enumerate(made.bench.samples) if s.time_ns == made.seen.time_ns[0])
    assert x[start + 220] == 2.0  # the path went on
