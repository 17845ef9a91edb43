"""Types 2 to 5 on drives with closed forms: speed, stroke, what the signal ends, what it costs."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import dist, exp, sqrt
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., Any]

MS = 1_000_000
INCREMENT_MM = 10 / 2**20


def _top_speed_mm_s(bench: Any, axis: str) -> float:
    places = bench.set_mm(axis)
    return max(abs(b - a) for a, b in pairwise(places)) * 1e3


@pytest.mark.long
@pytest.mark.parametrize("feed_mm_min", [60.0, 6000.0, None])
def test_type_2_goes_at_the_speed_of_the_parameter_list(
    channel_bench: Make, words: Any, feed_mm_min: float | None
) -> None:
    """P-AXIS-00215 is 10 mm/s here, whatever F says."""
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
    bench.run([words.probe(1, feed_mm_min, 2, Z=110.0), words.wait(1), words.end()])
    assert _top_speed_mm_s(bench, "Z") == pytest.approx(10.0)
    assert bench.channel.records[0].latched_mm["Z"] == pytest.approx(120.0, abs=INCREMENT_MM)


@pytest.mark.long
def test_type_2_always_wants_a_signal(channel_bench: Make, words: Any) -> None:
    for allowed in (None, False):
        bench = channel_bench(words.axis("Z", start_mm=130.0))
        run = words.probe(1, None, 2, error_no_signal=allowed, Z=128.0)
        bench.run([run, words.wait(1), words.end()])
        assert bench.alarm_ids == [900004]
        assert bench.final_mm("Z") == 128.0


@pytest.mark.long
@pytest.mark.parametrize(("kind", "end_mm"), [(1, 128.0), (2, 126.0), (5, 128.0)])
def test_p_axis_00114_lengthens_type_2_only(
    channel_bench: Make, words: Any, kind: int, end_mm: float
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, old_offset_mm=2.0))
    bench.run([words.probe(1, 600.0, kind, Z=128.0), words.wait(1), words.end()])
    assert bench.final_mm("Z") == pytest.approx(end_mm, abs=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("kind", [1, 3, 4])
def test_err_no_signal_of_meas_wins_over_p_chan_00176(
    channel_bench: Make, words: Any, kind: int
) -> None:
    """P-CHAN-00176 is about type 1 alone (FCT-C4 8.2.1), ERR_NO_SIGNAL about each of the three."""
    for parameter, programmed, alarms in (
        (False, None, []),
        (True, None, [900004] if kind == 1 else []),
        (False, True, [900004]),
        (True, False, []),
    ):
        settings = ChannelSettings(error_no_signal=parameter)
        bench = channel_bench(words.axis("Z", start_mm=130.0), settings=settings)
        run = words.probe(1, 600.0, kind, error_no_signal=programmed, Z=129.0)
        bench.run([run, words.wait(1), words.end()])
        assert bench.alarm_ids == alarms


@pytest.mark.long
def test_type_3_goes_on_to_its_target_without_braking(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, probing_offset_mm=2.0), plane_mm=120.0)
    bench.run([words.probe(1, 600.0, 3, goes_on=True, Z=110.0), words.wait(1), words.end()])
    record = bench.channel.records[0]
    assert record.latched_mm["Z"] == pytest.approx(120.0, abs=INCREMENT_MM)
    assert bench.final_mm("Z") == 110.0  # and no overtravel (P-AXIS-00467)
    assert record.signal_ns is not None
    behind = [sample.set_mm[0] for sample in bench.samples if sample.time_ns >= record.signal_ns]
    steps = [a - b for a, b in pairwise(behind[:401])]
    assert steps == pytest.approx([0.01] * 400)


@pytest.mark.long
def test_type_3_without_g106_brakes_as_type_1(channel_bench: Make, words: Any) -> None:
    ends = []
    for kind in (1, 3):
        bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
        bench.run([words.probe(1, 600.0, kind, Z=110.0), words.wait(1), words.end()])
        ends.append((bench.final_mm("Z"), bench.channel.records[0].latched_mm["Z"]))
    assert ends[0] == ends[1]
    assert ends[0][0] > 119.0


def test_type_3_without_signal_is_at_its_target(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0))
    bench.run([words.probe(1, 600.0, 3, goes_on=True, Z=128.0), words.wait(1), words.end()])
    assert (bench.final_mm("Z"), bench.alarm_ids) == (128.0, [])
    assert not bench.channel.measurement_ok("Z")


@pytest.mark.long
@pytest.mark.parametrize(("named", "speed_mm_s"), [("Y", 5.0), ("Z", 20.0)])
def test_type_2_has_the_speed_of_the_axis_of_its_block_whatever_else_the_path_moves(
    channel_bench: Make, words: Any, named: str, speed_mm_s: float
) -> None:
    """P-AXIS-00215: 5 and 20 mm/s; as under a kinematic the path moves more than is programmed."""
    bench = channel_bench(words.axis("Y", measuring_mm_s=5.0), words.axis("Z", measuring_mm_s=20.0))
    block = words.probe(1, None, 2, Y=1.2, Z=1.6)
    run = replace(block, programmed_axes=(named,), measuring_axes=(named,))
    bench.run([run, words.wait(1), words.end()])
    steps = [dist(a.set_mm, b.set_mm) for a, b in pairwise(bench.samples)]
    assert max(steps) == pytest.approx(speed_mm_s * 1e-3, abs=1e-9)


# Stroke of the probe, P-AXIS-00086


@pytest.mark.long
@pytest.mark.parametrize("kind", [2, 4])
@pytest.mark.provokes(900222, 1, axis="Z", stroke_mm="0.1")
def test_types_2_and_4_are_slow_enough_for_the_stroke(
    channel_bench: Make, words: Any, kind: int
) -> None:
    """0.1 mm at 1000 mm/s2: sqrt(2 * 1000 * 0.1) = 14.142 mm/s; then braking takes 0.1 mm."""
    v = sqrt(2 * 1000.0 * 0.1)
    bench = channel_bench(
        words.axis("Z", start_mm=130.0, stroke_mm=0.1, measuring_mm_s=50.0), plane_mm=120.0
    )
    bench.run([words.probe(1, 3000.0, kind, Z=110.0), words.wait(1), words.end()])
    assert _top_speed_mm_s(bench, "Z") == pytest.approx(v)
    (warning,) = bench.channel.alarms
    assert (warning.id, warning.entry.reaction_class, warning.ends_program) == (900222, 1, False)
    assert warning.values == {
        "axis": "Z",
        "speed_mm_min": "3000",
        "stroke_mm": "0.1",
        "corrected_mm_min": f"{v * 60:.9g}",
    }
    record = bench.channel.records[0]
    at_brake_mm = next(
        before.set_mm[0]
        for before, sample in zip(bench.samples, bench.samples[1:], strict=False)
        if sample.time_ns == record.signal_ns
    )
    assert at_brake_mm - bench.final_mm("Z") == pytest.approx(0.1, abs=1e-9)


@pytest.mark.long
def test_900222_names_the_speed_that_was_programmed(channel_bench: Make, words: Any) -> None:
    """F60000 on an axis of 500 mm/s: the user looks for 60000, not for 30000."""
    bench = channel_bench(words.axis("Z", start_mm=130.0, stroke_mm=0.1), plane_mm=120.0)
    bench.run([words.probe(1, 60000.0, 4, Z=110.0), words.wait(1), words.end()])
    (warning,) = bench.channel.alarms
    assert (warning.id, warning.values["speed_mm_min"]) == (900222, "60000")


@pytest.mark.long
def test_a_speed_within_the_stroke_stays_as_it_is(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, stroke_mm=0.1), plane_mm=120.0)
    bench.run([words.probe(1, 848.0, 4, Z=110.0), words.wait(1), words.end()])
    assert bench.alarm_ids == []
    assert _top_speed_mm_s(bench, "Z") == pytest.approx(848.0 / 60)


@pytest.mark.long
@pytest.mark.parametrize("kind", [1, 3, 5])
def test_other_types_know_no_stroke(channel_bench: Make, words: Any, kind: int) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, stroke_mm=0.0), plane_mm=120.0)
    bench.run([words.probe(1, 3000.0, kind, Z=110.0), words.wait(1), words.end()])
    assert bench.alarm_ids == []
    assert _top_speed_mm_s(bench, "Z") == pytest.approx(50.0)


@pytest.mark.provokes(900224, 4, axis="Z", type=4)
def test_900224_a_probe_without_stroke_cannot_be_kept_to_it(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, stroke_mm=0.0))
    bench.run([words.probe(1, 3000.0, 4, Z=110.0), words.wait(1), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (
        900224,
        4,
        {"axis": "Z", "type": 4},
    )
    assert bench.final_mm("Z") == pytest.approx(130.0, abs=INCREMENT_MM)


# Who may measure


@pytest.mark.provokes(50059, 4, axis="Y")
def test_50059_for_an_axis_that_is_named_and_stands(channel_bench: Make, words: Any) -> None:
    """All programmed axes must be released. Source: programming manual 206171147."""
    bench = channel_bench(words.axis("Y", may_measure=False), words.axis("Z", start_mm=130.0))
    run = canon.MeasuringRun(Block(1, 10, "N10"), {"Z": 110.0}, ("Y", "Z"), ("Z",), 600.0, 1)
    bench.run([run, words.wait(1), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (50059, 4, {"axis": "Y"})


# Preparation


def test_prepared_axes_are_forgotten_by_homing_exchange_and_program_end(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=130.0))
    bench.run([words.prepare(1, "Y", "Z"), words.move(2, 600.0, Z=129.0), words.end()])
    measurement = bench.channel.measurement
    assert measurement.prepared == set()  # program end
    measurement.prepared.update(("Y", "Z"))
    measurement.forget_prepared("X")  # was not prepared
    assert measurement.prepared == {"Y", "Z"}
    measurement.forget_prepared("Y")
    assert measurement.prepared == set()


def test_50059_for_the_preparation_of_an_axis_that_does_not_measure(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", may_measure=False))
    bench.run([words.prepare(1, "Z"), words.end()])
    assert bench.alarm_ids == [50059]


# Dead time of the probe, P-AXIS-00487


@pytest.mark.long
def test_a_measured_value_is_led_back_by_v_t(channel_bench: Make, words: Any) -> None:
    """10 mm/s for 10 ms: 0.1 mm; the axis comes from above."""
    bench = channel_bench(words.axis("Z", start_mm=130.0, delay_ns=10 * MS), plane_mm=120.0)
    bench.run([words.probe(1, 600.0, Z=110.0), words.wait(1), words.end()])
    value_mm = bench.channel.records[0].latched_mm["Z"]
    assert value_mm == pytest.approx(120.1, abs=21 * INCREMENT_MM)


# 100 ms after the begin: v (t - v/2a - 1/Kv) = 10 (0.1 - 0.005 - 0.025) = 0.70 mm on the way
@pytest.mark.parametrize(("delay_ms", "is_possible"), [(95, True), (200, False)])
def test_a_value_is_not_led_back_before_its_block(
    channel_bench: Make, words: Any, delay_ms: int, is_possible: bool
) -> None:
    """The touch is in the block as long as the dead time is not longer than the axis has moved."""
    axis = words.axis("Z", start_mm=130.0, delay_ns=delay_ms * MS)
    bench = channel_bench(axis, plane_mm=129.3)
    bench.run([words.probe(1, 600.0, Z=110.0), words.wait(1), words.end()])
    measured_mm = bench.channel.measured_acs_mm("Z")
    if is_possible:
        assert bench.alarm_ids == []
        missing_mm_s = 10.0 * exp(
            -90.0 / 25.0
        )  # of the speed, 90 ms after the ramp with 1/Kv 25 ms
        missing_mm = missing_mm_s * delay_ms / 1e3
        assert measured_mm == pytest.approx(129.3 + 10.0 * delay_ms / 1e3, abs=missing_mm)
    else:
        assert bench.alarm_ids == [900520]
        assert measured_mm is None


def test_where_a_signal_is_wanted_a_value_that_is_refused_is_none(
    channel_bench: Make, words: Any
) -> None:
    axis = words.axis("Z", start_mm=130.0, delay_ns=200 * MS)
    bench = channel_bench(axis, plane_mm=129.3)
    run = words.probe(1, 600.0, error_no_signal=True, Z=110.0)
    bench.run([run, words.wait(1), words.end()])
    assert bench.alarm_ids == [900520, 900004]
    assert bench.channel.measured_acs_mm("Z") is None


@pytest.mark.long
def test_the_share_of_an_axis_in_the_path_counts(channel_bench: Make, words: Any) -> None:
    """X moves by 0.6 of a path whose slopes are those of both axes; only Z has the long time."""
    x = words.axis("X", start_mm=0.0, delay_ns=50 * MS)
    z = words.axis("Z", start_mm=130.0, delay_ns=400 * MS)
    bench = channel_bench(x, z, plane_mm=129.3)
    bench.run([words.probe(1, 600.0, X=15.0, Z=110.0), words.wait(1), words.end()])
    assert bench.alarm_ids == [900520]
    assert bench.channel.measured_acs_mm("X") is not None
    assert bench.channel.measured_acs_mm("Z") is None


@pytest.mark.long
def test_inside_a_ramp_half_a_t_squared_is_left(channel_bench: Make, words: Any) -> None:
    """From 300 mm/s at 1000 mm/s2 to the target 50 mm; 2.5 mm before it the axis has 71 mm/s.

    The axis follows with 1/Kv = 25 ms and has the acceleration of its demand by then; what is
    left is 1000 * 0.01^2 / 2 = 0.05 mm, against where the axis was 10 ms before the edge.
    """
    bench = channel_bench(words.axis("Z", start_mm=230.0, delay_ns=10 * MS), plane_mm=52.5)
    bench.run([words.probe(1, 18000.0, Z=50.0), words.wait(1), words.end()])
    was_mm = bench.axes["Z"].position_at(bench.edge_ns() - 10 * MS) * 1e3
    residual_mm = bench.channel.records[0].latched_mm["Z"] - was_mm
    assert residual_mm == pytest.approx(-0.05, abs=0.001)
