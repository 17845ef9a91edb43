"""Axis couplings: slaves keep the distance to their master at which they were coupled."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., Any]
S = 1_000_000_000
INCREMENT_MM = 10 / 2**20


def link_on(*pairs: canon.AxisPair, group: int = 1) -> canon.AxisLinkOn:
    return canon.AxisLinkOn(Block(2, 20, "N20"), group, pairs)


def link_off(group: int = 1) -> canon.AxisLinkOff:
    return canon.AxisLinkOff(Block(4, 40, "N40"), group)


GANTRY = canon.AxisPair("X2", "X", (0.3, 0.4))


@pytest.mark.long
def test_a_slave_takes_every_step_of_its_master(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("X2", start_mm=7.0))
    bench.run([link_on(canon.AxisPair("X2", "X")), words.move(3, 600.0, X=10.0), words.end()])
    assert bench.alarm_ids == []
    for x, x2 in zip(bench.set_mm("X"), bench.set_mm("X2"), strict=True):
        assert x2 == pytest.approx(7.0 + x, abs=INCREMENT_MM)
    assert bench.final_mm("X2") == pytest.approx(17.0, abs=INCREMENT_MM)


@pytest.mark.long
def test_a_slave_stands_when_the_coupling_is_off(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("X2"))
    program = [link_on(GANTRY), words.move(3, 600.0, X=5.0), link_off()]
    bench.run([*program, words.move(5, 600.0, X=8.0), words.move(6, 600.0, X2=1.0), words.end()])
    assert bench.alarm_ids == []
    assert (bench.final_mm("X"), bench.final_mm("X2")) == (8.0, 1.0)
    assert max(bench.set_mm("X2")) == 5.0


@pytest.mark.long
def test_the_master_moves_as_the_weaker_of_both_can(channel_bench: Make, words: Any) -> None:
    strong, weak = words.axis("X"), words.axis("X2", a_mm_s2=250.0, speed_max_mm_s=5.0)
    bench = channel_bench(strong, weak)
    bench.run([link_on(GANTRY), words.move(3, 600.0, X=5.0), link_off(), words.end()])
    x = bench.set_mm("X")
    begin = next(n for n, value in enumerate(x) if value != 0.0) - 1
    there = next(n for n, value in enumerate(x) if value == 5.0)
    assert there - begin == 1020  # d/v + v/a = 5/5 + 5/250


@pytest.mark.long
def test_a_slave_measures_nothing_and_brakes_with_its_master(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(
        words.axis("Z2", start_mm=130.0, may_measure=False),
        words.axis("Z", start_mm=130.0),
        plane_mm=120.0,
    )
    pair = canon.AxisPair("Z2", "Z", (1.0, 2.0))
    bench.run([link_on(pair), words.probe(3, 600.0, Z=110.0), words.wait(3), words.end()])
    assert bench.alarm_ids == []
    assert bench.channel.records[0].axes == ("Z",)
    assert 110.0 < bench.final_mm("Z") < 120.0
    assert bench.final_mm("Z2") == pytest.approx(bench.final_mm("Z"), abs=INCREMENT_MM)


@pytest.mark.provokes(900192, 7, axis="X2", master="X", limit_mm="0.3")
@pytest.mark.provokes(900193, 7, axis="X2", master="X", limit_mm="0.4")
@pytest.mark.parametrize(
    ("lost_mm", "alarm_id", "limit"), [(0.35, 900192, "0.3"), (0.45, 900193, "0.4")]
)
@pytest.mark.long
def test_the_limits_watch_the_actual_positions(
    channel_bench: Make, words: Any, lost_mm: float, alarm_id: int, limit: str
) -> None:
    bench = channel_bench(words.axis("X"), words.axis("X2"))
    bench.prepare([link_on(GANTRY), words.move(3, 600.0, X=30.0), words.end()])
    assert bench.scheduler.run_while(
        lambda: not bench.samples or bench.set_mm("X")[-1] < 10.0, 10 * S
    )
    bench.axes["X2"].droop_m = lost_mm / 1e3
    bench.finish()
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class) == (alarm_id, 7)
    assert (alarm.values["axis"], alarm.values["master"]) == ("X2", "X")
    assert alarm.values["limit_mm"] == limit
    # both axes lag by v/Kv behind the same set positions, so that only the loss is left
    assert float(alarm.values["difference_mm"]) == pytest.approx(-lost_mm, abs=0.001)
    assert bench.final_mm("X") < 10.2
    assert bench.final_mm("X2") == pytest.approx(bench.final_mm("X"), abs=INCREMENT_MM)


@pytest.mark.long
def test_a_gantry_is_coupled_when_the_axes_stand(channel_bench: Make, words: Any) -> None:
    """At the end of a block the axis is v/Kv = 0.5 mm behind, more than the limits allow."""
    bench = channel_bench(words.axis("X"), words.axis("X2"))
    bench.run(
        [words.move(1, 1200.0, X=5.0), link_on(GANTRY), words.move(3, 600.0, X=8.0), words.end()]
    )
    assert bench.alarm_ids == []


@pytest.mark.long
def test_a_distance_from_before_is_no_difference(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X", start_mm=100.0), words.axis("X2"))
    bench.run([link_on(GANTRY), words.move(3, 600.0, X=105.0), words.end()])
    assert bench.alarm_ids == []


@pytest.mark.long
def test_without_limits_nothing_is_watched(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("X2"))
    bench.prepare(
        [link_on(canon.AxisPair("X2", "X")), words.move(3, 600.0, X=5.0), link_off(), words.end()]
    )
    assert bench.scheduler.run_while(
        lambda: not bench.samples or bench.set_mm("X")[-1] < 1.0, 10 * S
    )
    bench.axes["X2"].droop_m = 0.0005
    bench.scheduler.run_while(lambda: bench.set_mm("X")[-1] < 4.0, 10 * S)
    bench.axes["X2"].droop_m = 0.0
    bench.finish()
    assert bench.alarm_ids == []
