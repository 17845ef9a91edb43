"""Independent axes keep to what their measuring type says: speed, stroke, missing signal."""

from collections.abc import Callable
from itertools import pairwise
from math import sqrt
from typing import Any

import pytest

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., Any]
INCREMENT_MM = 10 / 2**20


def _run(
    channel_bench: Make,
    words: Any,
    kind: int,
    plane_mm: float | None,
    error_no_signal: bool | None = None,
    **axis: Any,
) -> Any:
    """Z beside the path from 130 to 110 with FEED=3000; the lists say 10 mm/s for type 2."""
    bench = channel_bench(words.axis("Z", start_mm=130.0, **axis), plane_mm=plane_mm)
    block = Block(1, 10, "N10")
    move = canon.IndependentMove(
        block, "Z", 110.0, feed_mm_min=3000.0, measuring_type=kind, error_no_signal=error_no_signal
    )
    bench.run([move, canon.WaitIndependent(block, ("Z",)), words.end()])
    return bench


def _top_speed_mm_s(bench: Any) -> float:
    sent = [sample.sent_mm[0] for sample in bench.samples]
    return max(abs(b - a) for a, b in pairwise(sent)) * 1e3


@pytest.mark.long
@pytest.mark.parametrize(("kind", "v"), [(1, 50.0), (2, 10.0)])
def test_type_2_has_the_speed_of_its_list(
    channel_bench: Make, words: Any, kind: int, v: float
) -> None:
    bench = _run(channel_bench, words, kind, 120.0)
    assert bench.alarm_ids == []
    assert _top_speed_mm_s(bench) == pytest.approx(v, rel=1e-4)
    assert bench.channel.records[0].latched_mm["Z"] == pytest.approx(120.0, abs=INCREMENT_MM)


@pytest.mark.long
def test_type_2_stops_within_the_stroke_of_its_probe(channel_bench: Make, words: Any) -> None:
    """0.02 mm at 1000 mm/s2: sqrt(40) mm/s."""
    bench = _run(channel_bench, words, 2, 120.0, stroke_mm=0.02)
    assert bench.alarm_ids == [900222]
    assert _top_speed_mm_s(bench) == pytest.approx(sqrt(40.0), rel=1e-4)


@pytest.mark.long
@pytest.mark.parametrize(("kind", "holds"), [(2, True), (1, False)])
def test_with_ramps_a_signal_in_the_run_up_leaves_it_within_the_stroke_too(
    channel_bench: Make, words: Any, kind: int, holds: bool
) -> None:
    """1000 mm/s2 with 50 ms of ramps stop from 27.1 mm/s within 1 mm, v sqrt(v t/a).

    At the peak of the acceleration, 0.17 mm from the begin, 13.6 mm/s and 737 mm/s2 would take
    0.83 mm while it falls and 1 mm more. Type 2 leaves room for that, type 1 has no stroke.
    """
    axis = words.axis("Z", start_mm=130.0, kv=1e9, stroke_mm=1.0, measuring_mm_s=100.0)
    bench = channel_bench(axis, plane_mm=129.83)
    block = Block(1, 10, "N10")
    move = canon.IndependentMove(
        block, "Z", 110.0, feed_mm_min=3000.0, measuring_type=kind, slope="TRAPEZ"
    )
    bench.run([move, canon.WaitIndependent(block, ("Z",)), words.end()])
    at_brake_mm = next(
        before.set_mm[0]
        for before, after in pairwise(bench.samples)
        if after.time_ns == bench.channel.records[0].signal_ns
    )
    assert (at_brake_mm - bench.final_mm("Z") <= 1.0 + 1e-6) is holds


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("kind", "programmed", "alarms"),
    [(1, None, []), (1, True, [900004]), (2, None, [900004]), (2, False, [900004])],
)
def test_type_2_always_wants_a_signal_and_type_1_when_meas_says_so(
    channel_bench: Make, words: Any, kind: int, programmed: bool | None, alarms: list[int]
) -> None:
    assert _run(channel_bench, words, kind, None, programmed).alarm_ids == alarms


@pytest.mark.long
def test_a_dead_time_is_led_back_here_too(channel_bench: Make, words: Any) -> None:
    """10 mm/s for 10 ms."""
    bench = _run(channel_bench, words, 2, 120.0, delay_ns=10_000_000)
    value_mm = bench.channel.records[0].latched_mm["Z"]
    assert value_mm == pytest.approx(120.1, abs=21 * INCREMENT_MM)


def test_and_not_before_its_block(channel_bench: Make, words: Any) -> None:
    """3 s at 10 mm/s are 30 mm and the axis has moved 10; type 2 wants a signal."""
    bench = _run(channel_bench, words, 2, 120.0, delay_ns=3_000_000_000)
    assert bench.alarm_ids == [900520, 900004]
    assert bench.channel.measured_acs_mm("Z") is None


@pytest.mark.long
@pytest.mark.parametrize("stop_mm_s2", [500.0, 4000.0])
def test_a_run_beside_the_path_brakes_with_the_deceleration_of_a_stop(
    channel_bench: Make, words: Any, stop_mm_s2: float
) -> None:
    """Its ramps have 1000 mm/s2. At 50 mm/s: v^2 / 2a from the cycle of the signal on."""
    bench = _run(channel_bench, words, 1, 120.0, stop_mm_s2=stop_mm_s2)
    record = bench.channel.records[0]
    at_brake_mm = next(
        before.set_mm[0]
        for before, sample in pairwise(bench.samples)
        if sample.time_ns == record.signal_ns
    )
    way_mm = at_brake_mm - bench.final_mm("Z")
    assert way_mm == pytest.approx(50.0**2 / (2 * stop_mm_s2), abs=1e-9)


@pytest.mark.provokes(900222, 1, axis="Z", speed_mm_min="60000")
@pytest.mark.long
def test_900222_names_the_speed_that_was_programmed(channel_bench: Make, words: Any) -> None:
    """1000 mm/s of the list (P-AXIS-00215), although the axis has 20 mm/s at most."""
    (warning,) = _run(
        channel_bench, words, 2, 120.0, stroke_mm=0.02, speed_max_mm_s=20.0, measuring_mm_s=1000.0
    ).channel.alarms
    assert (warning.id, warning.values["speed_mm_min"]) == (900222, "60000")


@pytest.mark.long
def test_a_feed_beyond_the_axis_is_that_of_the_axis(channel_bench: Make, words: Any) -> None:
    bench = _run(channel_bench, words, 1, 120.0, speed_max_mm_s=20.0)
    assert _top_speed_mm_s(bench) == pytest.approx(20.0, rel=1e-3)
