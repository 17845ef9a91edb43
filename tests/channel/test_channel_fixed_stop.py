"""Runs to a fixed stop in a channel: drives on a bus, axes of first order that a stop holds."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
INCREMENT_MM = 10 / 2**20
FEED, KV, LAG_DELAY = 600.0, 40.0, 2
LAG = FixedStopSettings(lag_limit_mm=1.0, min_time_ns=50 * MS)
WINDOW = FixedStopSettings(window_mm=0.01, min_time_ns=50 * MS, start_distance_mm=2.0)


def axis(words: Any, name: str = "Z", **more: Any) -> Any:
    given = {"source": "FIXED_STOP", "fixed_stop": LAG} | more
    return words.axis(name, **given)


def measured(bench: Any) -> RunRecord:
    record = bench.channel.records[-1]
    assert isinstance(record, RunRecord)
    return record


def run(bench: Any, words: Any, *before: Any, **target: float) -> RunRecord:
    bench.run([*before, words.probe(2, FEED, 7, **target), words.wait(2), words.end()])
    return measured(bench)


@pytest.mark.long
def test_the_stop_is_found_by_the_lag(channel_bench: Make, words: Any) -> None:
    """Behind the contact the lag is e0 + v (t - t_c), e0 = v / kv + (2 - d) v T."""
    bench = channel_bench(axis(words, stop_mm=10.0))
    record = run(bench, words, Z=30.0)
    stop = record.fixed_stop
    assert stop is not None
    assert bench.alarm_ids == []
    assert record.latched_mm == {"Z": pytest.approx(10.0, abs=INCREMENT_MM)}
    assert bench.channel.measured_acs_mm("Z") == record.latched_mm["Z"]
    assert stop.detected_ns - stop.beyond_ns["Z"] == 50 * MS
    axes = bench.axes["Z"]
    contact_ns = next(
        t for t in range(0, stop.detected_ns, MS // 10) if axes.position_at(t) >= 10.0 / 1e3
    )
    v_mm_s, e0_mm = FEED / 60, FEED / 60 / KV + (2 - LAG_DELAY) * FEED / 60 / 1e3
    expected_ms = contact_ns / MS + (1.0 - e0_mm) / v_mm_s * 1e3 + 50
    assert stop.detected_ns / MS == pytest.approx(expected_ms, abs=2)


@pytest.mark.long
def test_the_axes_end_where_they_are_and_the_program_goes_on_from_there(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, stop_mm=10.0))
    program = [words.probe(2, FEED, 7, Z=30.0), words.wait(2), words.move(3, FEED, Z=9.0)]
    bench.run([*program, words.end()])
    record = measured(bench)
    end_mm = [s.set_mm[0] for s in bench.samples if s.time_ns < record.end_ns][-1]
    assert end_mm == pytest.approx(10.0, abs=INCREMENT_MM)
    assert bench.final_mm("Z") == 9.0


@pytest.mark.long
def test_the_relaxing_motion_has_the_feed_of_the_run(channel_bench: Make, words: Any) -> None:
    """And its ramps: no step is larger than those of the way to the stop, nor changes by more."""
    bench = channel_bench(axis(words, stop_mm=10.0))
    record = run(bench, words, Z=30.0)
    assert record.fixed_stop is not None
    sets = [(s.time_ns, s.set_mm[0]) for s in bench.samples if s.time_ns > record.begin_ns]
    steps = [(t, b - a) for (_, a), (t, b) in pairwise(sets)]
    begin_ns = record.fixed_stop.relax_begin_ns
    back = [step for t, step in steps if t >= begin_ns]
    assert min(back) == pytest.approx(-FEED / 60 / 1e3)
    assert max(back) == 0.0
    changes = [abs(b - a) for a, b in pairwise(back)]
    assert max(changes) <= 1000.0 * 1e-6 * 1.001


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [0, 5])
def test_the_path_brakes_and_stands_before_it_goes_back(
    channel_bench: Make, words: Any, buffer_cycles: int
) -> None:
    """v^2 / 2a with the deceleration of a stop; the buffer delays what leaves it."""
    axis_z = axis(words, stop_mm=10.0, stop_mm_s2=100.0)
    bench = channel_bench(axis_z, buffer_cycles=buffer_cycles)
    stop = run(bench, words, Z=30.0).fixed_stop
    assert stop is not None
    assert (stop.brake_end_ns - stop.detected_ns) / MS == pytest.approx(
        10 / 100 * 1e3 + buffer_cycles, abs=1.01
    )
    furthest_mm = max(bench.set_mm("Z"))
    ahead_mm = 10 / 1e3 * (buffer_cycles + 1)
    assert furthest_mm - stop.set_mm["Z"] == pytest.approx(100 / 200, abs=ahead_mm)
    sent = [s.sent_mm[0] for s in bench.samples if s.time_ns < stop.brake_end_ns]
    assert sent[-1] == pytest.approx(furthest_mm)


@pytest.mark.long
@pytest.mark.parametrize("overtravel_mm", [0.0, 8.0])
def test_a_share_is_of_the_programmed_path(
    channel_bench: Make, words: Any, overtravel_mm: float
) -> None:
    half = replace(LAG, start_per_mille=500)
    spec = axis(words, probing_offset_mm=overtravel_mm, fixed_stop=half, stop_mm=18.0)
    bench = channel_bench(spec)
    record = run(bench, words, Z=20.0)
    assert record.fixed_stop is not None
    assert record.fixed_stop.start_distance_mm == 10.0
    # Only behind the target the lag gets beyond its limit of 1 mm for 50 ms
    assert bool(record.latched_mm) is True


@pytest.mark.long
def test_a_share_on_a_path_of_two_axes_is_of_the_path(channel_bench: Make, words: Any) -> None:
    """3-4-5: 50 % of the path are 5 mm, of its longest axis they were 4."""
    half = replace(LAG, start_per_mille=500)
    specs = (axis(words, "X", fixed_stop=half), axis(words, "Y", fixed_stop=half, stop_mm=7.0))
    record = run(channel_bench(*specs), words, X=6.0, Y=8.0)
    assert record.fixed_stop is not None
    assert record.fixed_stop.start_distance_mm == pytest.approx(5.0)


@pytest.mark.provokes(900036, 7, axis="Z", limit_mm=0.5)
@pytest.mark.long
def test_the_cnc_monitors_no_lag_during_the_run_and_does_before_and_behind_it(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, stop_mm=10.0), lag_limit_mm=0.5)
    program = [words.probe(2, FEED, 7, Z=30.0), words.wait(2), words.move(3, FEED, Z=12.0)]
    bench.run([*program, words.end()])
    assert measured(bench).latched_mm != {}
    assert bench.alarm_ids == [900036]
    assert bench.channel.alarm_ns[0] > measured(bench).end_ns


@pytest.mark.long
def test_x_hits_while_y_is_free(channel_bench: Make, words: Any) -> None:
    """Each comes back to its own place: X to the stop, Y to where it was when X had found it."""
    bench = channel_bench(axis(words, "X", stop_mm=10.0), axis(words, "Y"))
    record = run(bench, words, X=30.0, Y=30.0)
    stop = record.fixed_stop
    assert stop is not None
    assert stop.detected_by == "X"
    assert record.latched_mm["X"] == pytest.approx(10.0, abs=INCREMENT_MM)
    y_mm = bench.axes["Y"].position_at(stop.detected_ns) * 1e3
    # 6064 of the SYNC: one offset and one cycle at most ago
    assert 0 <= y_mm - record.latched_mm["Y"] < 2 * FEED / 60 / 2**0.5 / 1e3 + INCREMENT_MM
    for name in "XY":
        assert bench.final_mm(name) == pytest.approx(record.latched_mm[name], abs=1e-9)


@pytest.mark.long
def test_an_axis_that_the_block_does_not_move_is_none_of_the_run(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, "X", stop_mm=10.0), words.axis("Y"))
    stop = run(bench, words, X=30.0).fixed_stop
    assert stop is not None
    assert stop.detected_by == "X"
    assert stop.criteria.keys() == stop.set_mm.keys() == stop.actual_mm.keys() == {"X"}


@pytest.mark.long
def test_err_no_signal_of_meas_changes_nothing_in_type_7(channel_bench: Make, words: Any) -> None:
    for may_be_missing, alarms in ((False, [900240]), (True, [])):
        settings = ChannelSettings(stop_may_be_missing=may_be_missing)
        bench = channel_bench(axis(words), settings=settings)
        run = words.probe(2, FEED, 7, error_no_signal=may_be_missing, Z=5.0)
        bench.run([run, words.wait(2), words.end()])
        assert bench.alarm_ids == alarms
        assert not bench.channel.measurement_ok("Z")


@pytest.mark.long
@pytest.mark.provokes(900240, 4, axes="Z")
def test_900240_ends_the_program_with_the_monitoring_on_again(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, fixed_stop=WINDOW))
    record = run(bench, words, Z=5.0)
    assert bench.alarm_ids == [900240]
    assert bench.links[0].watches_lag
    assert (record.end_ns, record.latched_mm) == (None, {})
    assert "no lag limit, window 0.01 mm, min_time 50 ms" in str(bench.channel.alarms[0])


@pytest.mark.provokes(900100, 2, word="meas_simu.meas_simu_mode = 1 of axis Z")
def test_a_simulated_probe_in_a_run_to_a_fixed_stop_is_refused(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, simulated=(1, 50_000)))
    bench.run([words.probe(2, FEED, 7, Z=30.0), words.wait(2), words.end()])
    assert (bench.alarm_ids, bench.channel.records) == ([900100], [])


@pytest.mark.long
def test_the_dead_time_of_a_probe_does_not_shift_a_stop(channel_bench: Make, words: Any) -> None:
    """P-AXIS-00487 of 10 ms would lead Y back by 0.07 mm."""
    values = []
    for delay_ns in (0, 10 * MS):
        specs = axis(words, "X", stop_mm=10.0), axis(words, "Y", delay_ns=delay_ns)
        values.append(run(channel_bench(*specs), words, X=30.0, Y=30.0).latched_mm)
    assert values[0] == values[1]


# Who may take part


@pytest.mark.provokes(50059, 4, axis="Z")
def test_50059_for_an_axis_that_is_not_released(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(axis(words, may_measure=False))
    bench.run([words.probe(2, FEED, 7, Z=30.0), words.wait(2), words.end()])
    assert bench.alarm_ids == [50059]


@pytest.mark.provokes(900241, 2, axis="Y", source="DRIVE", type=7)
def test_900241_for_any_axis_with_another_source(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(axis(words, "X"), axis(words, "Y", source="DRIVE"))
    bench.run([words.probe(2, FEED, 7, X=30.0, Y=1.0), words.wait(2), words.end()])
    assert (bench.alarm_ids, bench.channel.records) == ([900241], [])


@pytest.mark.provokes(900242, 2, axis="Z", source="FIXED_STOP", type=3)
def test_900242_for_a_run_that_waits_for_a_probe(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(axis(words))
    bench.run([words.probe(2, FEED, 3, Z=30.0), words.wait(2), words.end()])
    assert (bench.alarm_ids, bench.channel.records) == ([900242], [])


@pytest.mark.long
def test_signal_of_meas_wins_over_the_list_until_its_default(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(axis(words, source="DRIVE", stop_mm=10.0))
    chosen = words.probe_settings(1, "Z", source="FIXED_STOP")
    assert run(bench, words, chosen, Z=30.0).latched_mm != {}
    with pytest.raises(Alarm, match="900241"):  # the list again, behind the end of the program
        bench.channel.measurement.check("Z", 7)


@pytest.mark.provokes(51026, 2, axis="Y", value_permille=1001)
def test_51026_of_any_watched_axis_and_nothing_moves(channel_bench: Make, words: Any) -> None:
    wrong = replace(LAG, start_per_mille=1001)
    bench = channel_bench(axis(words, "X"), axis(words, "Y", fixed_stop=wrong))
    bench.run([words.probe(2, FEED, 7, X=30.0, Y=1.0), words.wait(2), words.end()])
    assert (bench.alarm_ids, bench.channel.records) == ([51026], [])
    assert bench.final_mm("X") == pytest.approx(0.0, abs=INCREMENT_MM)
