"""From the edge to the braking set position, to the nanosecond; path and target of a run.

v: feed, a: deceleration, T: period, t_k: first SYNC delivery not before the latch instant.
At t_k the demand of the drive is s(k-2), since SYNC k gives it s(k-1), reached at SYNC k+1. The
cycle behind SYNC k brakes from s(k-1) on, so with n buffer cycles the interpolation ends
v (t_k - t_edge + (1 + n) T) + v^2/2a behind the demand at the edge.
"""

from bisect import bisect_left
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings

Make = Callable[..., Any]
MS, S = 1_000_000, 1_000_000_000
T_S = 1e-3
INCREMENT_MM = 10 / 2**20
A_MM_S2 = 1000.0
# Three encoder increments: set position and its start are rounded, the demand follows both
TOLERANCE_MM = 3 * INCREMENT_MM


def _overtravel_mm(bench: Any) -> float:
    """How far the interpolation ends behind the demand at the edge; Z moves down."""
    over_mm: float = bench.axes["Z"].demand_at(bench.edge_ns()) * 1e3 - bench.final_mm("Z")
    return over_mm


def _probe_down(channel_bench: Make, words: Any, feed_mm_s: float, **options: Any) -> Any:
    bench = channel_bench(words.axis("Z", start_mm=130.0, a_mm_s2=A_MM_S2), **options)
    return bench.run([words.probe(1, feed_mm_s * 60, Z=60.0), words.wait(1), words.end()])


@pytest.mark.parametrize("input_delay_ns", [0, 4_000, 300_000])
@pytest.mark.parametrize("plane_mm", [110.0, 110.0061, 110.0137])
@pytest.mark.long(but=1)
def test_the_demand_runs_on_as_far_as_is_stated(
    channel_bench: Make, words: Any, plane_mm: float, input_delay_ns: int
) -> None:
    v = 20.0
    bench = _probe_down(channel_bench, words, v, plane_mm=plane_mm, input_delay_ns=input_delay_ns)
    assert bench.alarm_ids == []
    over_mm = _overtravel_mm(bench)
    latch_ns = bench.edge_ns() + input_delay_ns

    braking_mm = v**2 / (2 * A_MM_S2)
    least_mm = v * (input_delay_ns / S + T_S) + braking_mm
    assert least_mm - TOLERANCE_MM <= over_mm <= least_mm + v * T_S + TOLERANCE_MM

    syncs = bench.sync_ns()
    sync_ns = syncs[bisect_left(syncs, latch_ns)]
    exact_mm = v * ((sync_ns - bench.edge_ns()) / S + T_S) + braking_mm
    assert over_mm == pytest.approx(exact_mm, abs=TOLERANCE_MM)


@pytest.mark.long
def test_the_cycle_behind_the_first_sync_brakes_and_no_earlier_one(
    channel_bench: Make, words: Any
) -> None:
    v = 20.0
    bench = _probe_down(channel_bench, words, v, plane_mm=110.0)
    syncs = bench.sync_ns()
    sync_ns = syncs[bisect_left(syncs, bench.edge_ns())]
    (record,) = bench.channel.records
    assert 0 < record.signal_ns - sync_ns < MS

    moved = [(b.time_ns, a.set_mm[0] - b.set_mm[0]) for a, b in pairwise(bench.samples)]
    before = [step for time_ns, step in moved if time_ns < record.signal_ns][-5:]
    assert before == pytest.approx([v * T_S] * 5)
    behind = [step for time_ns, step in moved if time_ns >= record.signal_ns][:5]
    # Constant deceleration: the steps shrink by a T^2, the first one by half of it
    expected = [v * T_S - (k + 0.5) * A_MM_S2 * T_S**2 for k in range(5)]
    assert behind == pytest.approx(expected, abs=1e-9)


@pytest.mark.long
def test_the_latched_value_is_the_encoder_at_the_edge(channel_bench: Make, words: Any) -> None:
    bench = _probe_down(channel_bench, words, 20.0, plane_mm=110.0)
    (record,) = bench.channel.records
    assert record.latched_mm["Z"] == pytest.approx(110.0, abs=INCREMENT_MM)
    assert bench.channel.measurement_ok("Z")
    assert bench.channel.measured_acs_mm("Z") == record.latched_mm["Z"]


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [1, 4])
def test_each_buffer_cycle_adds_v_t(channel_bench: Make, words: Any, buffer_cycles: int) -> None:
    v = 20.0
    without = _probe_down(channel_bench, words, v, plane_mm=110.0)
    with_buffer = _probe_down(channel_bench, words, v, plane_mm=110.0, buffer_cycles=buffer_cycles)
    # Everything behind the buffer happens n periods later, so the edge has the same phase
    later_ns = with_buffer.edge_ns() - without.edge_ns()
    assert later_ns % MS in (0, 1, MS - 1)
    more_mm = _overtravel_mm(with_buffer) - _overtravel_mm(without)
    assert more_mm == pytest.approx(buffer_cycles * v * T_S, abs=TOLERANCE_MM)


# Path of a run


@pytest.mark.long
def test_without_signal_the_run_ends_at_the_target(channel_bench: Make, words: Any) -> None:
    bench = _probe_down(channel_bench, words, 50.0)
    assert bench.final_mm("Z") == 60.0
    assert bench.alarm_ids == []
    assert not bench.channel.measurement_ok("Z")


@pytest.mark.provokes(900004, 4, axis="Z")
@pytest.mark.long
def test_without_signal_and_with_p_chan_00176_it_is_an_alarm(
    channel_bench: Make, words: Any
) -> None:
    bench = _probe_down(channel_bench, words, 50.0, settings=ChannelSettings(error_no_signal=True))
    assert bench.alarm_ids == [900004]
    assert "N10" in str(bench.channel.alarms[0])


@pytest.mark.long
def test_p_axis_00467_lengthens_the_path(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, probing_offset_mm=2.0))
    bench.run([words.probe(1, 3000.0, Z=110.0), words.wait(1), words.end()])
    assert bench.final_mm("Z") == pytest.approx(108.0, abs=1e-9)


@pytest.mark.long
def test_a_signal_behind_the_target_still_counts(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, probing_offset_mm=2.0), plane_mm=109.0)
    bench.run([words.probe(1, 600.0, Z=110.0), words.wait(1), words.end()])
    assert bench.channel.records[0].latched_mm["Z"] == pytest.approx(109.0, abs=INCREMENT_MM)
    assert 108.0 < bench.final_mm("Z") < 109.0


@pytest.mark.long
def test_p_axis_00467_of_the_strictest_axis_counts_along_the_path(
    channel_bench: Make, words: Any
) -> None:
    """Y 30 and Z 40 mm; 3 mm of Y are 1/10 of the path, 2 mm of Z 1/20: both go 1/20 further."""
    bench = channel_bench(
        words.axis("Y", probing_offset_mm=3.0), words.axis("Z", probing_offset_mm=2.0)
    )
    bench.run([words.probe(1, 6000.0, Y=30.0, Z=40.0), words.wait(1), words.end()])
    assert bench.final_mm("Y") == pytest.approx(31.5, abs=1e-9)
    assert bench.final_mm("Z") == pytest.approx(42.0, abs=1e-9)


@pytest.mark.long
def test_a_g1_is_not_lengthened(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, probing_offset_mm=2.0))
    bench.run([words.move(1, 3000.0, Z=110.0), words.end()])
    assert bench.final_mm("Z") == 110.0


@pytest.mark.long
def test_two_axes_latch_the_point_where_their_line_meets_the_plane(
    channel_bench: Make, words: Any
) -> None:
    """From (5, 40) to (35, 0): at Z = 16 the line is at Y = 5 + 30 * 24/40 = 23.

    Both loops have one gain, so the axes stay on the line.
    """
    bench = channel_bench(
        words.axis("Y", start_mm=5.0), words.axis("Z", start_mm=40.0), plane_mm=16.0
    )
    bench.run([words.probe(1, 1200.0, Y=35.0, Z=0.0), words.wait(1), words.end()])
    (record,) = bench.channel.records
    assert record.latched_mm["Z"] == pytest.approx(16.0, abs=INCREMENT_MM)
    assert record.latched_mm["Y"] == pytest.approx(23.0, abs=2 * INCREMENT_MM)
    # The stop lies on the line as well
    y_mm, z_mm = bench.final_mm("Y"), bench.final_mm("Z")
    assert (y_mm - 5.0) / 30.0 == pytest.approx((40.0 - z_mm) / 40.0, abs=1e-12)


@pytest.mark.long
def test_the_path_speed_is_the_feed_and_each_axis_has_its_share(
    channel_bench: Make, words: Any
) -> None:
    """A 3-4-5 path at 50 mm/s: Y moves with 30, Z with 40 mm/s."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    bench.run([words.move(1, 3000.0, Y=30.0, Z=40.0), words.end()])
    for axis, speed_mm_s in (("Y", 30.0), ("Z", 40.0)):
        values = bench.set_mm(axis)
        steps = [b - a for a, b in pairwise(values)]
        assert max(steps) / T_S == pytest.approx(speed_mm_s, rel=1e-9)


@pytest.mark.long
def test_a_g1_behind_a_run_starts_where_the_run_stopped(channel_bench: Make, words: Any) -> None:
    """No jump: the set position never moves further in a cycle than the feed allows."""
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=110.0)
    bench.run(
        [
            words.probe(1, 1200.0, Z=60.0),
            words.wait(1),
            words.move(2, 1200.0, Z=120.0),
            words.end(),
        ]
    )
    values = bench.set_mm("Z")
    lowest = values.index(min(values))
    assert 108.0 < values[lowest] < 110.0
    assert values[-1] == 120.0
    steps = [abs(b - a) for a, b in pairwise(values)]
    assert max(steps) <= 20.0 * T_S * (1 + 1e-9)
    rising = values[lowest:]
    # From standstill with a: the first cycles travel a t^2 / 2
    first = next(n for n, value in enumerate(rising) if value > rising[0])
    for k in range(1, 6):
        expected = rising[0] + 0.5 * A_MM_S2 * (k * T_S) ** 2
        assert rising[first + k - 1] == pytest.approx(expected, abs=1e-9)
