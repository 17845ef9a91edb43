"""Probes that the CNC simulates (P-AXIS-00112): no drive latches anything."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

Make = Callable[..., Any]


def _run(
    channel_bench: Make, words: Any, mode: int, parameter: int, *, kind: int = 1, **changes: Any
) -> Any:
    """Z from 130 to 110 at 10 mm/s, 0.01 mm in a cycle; no workpiece."""
    bench = channel_bench(words.axis("Z", start_mm=130.0, simulated=(mode, parameter)))
    run = replace(words.probe(1, 600.0, kind, Z=110.0), **changes)
    bench.run([run, words.wait(1), words.end()])
    return bench


def _value(bench: Any) -> float:
    assert bench.alarm_ids == []
    return float(bench.channel.records[0].latched_mm["Z"])


@pytest.mark.long
def test_mode_1_signals_where_the_axis_crosses_a_position(channel_bench: Make, words: Any) -> None:
    bench = _run(channel_bench, words, 1, 1_200_000)
    assert 119.99 - 1e-9 <= _value(bench) <= 120.0
    assert bench.final_mm("Z") == pytest.approx(_value(bench) - 0.05, abs=1e-6)  # v²/2a


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("at_mm", "expected_mm"), [(120.0, 120.0), (109.0, 110.0), (131.0, None)])
def test_mode_1_in_the_positive_direction(
    channel_bench: Make, words: Any, at_mm: float, expected_mm: float | None
) -> None:
    """From 110 to 130: crossed, behind the axis (at once), and beyond the target (never)."""
    axis = words.axis("Z", start_mm=110.0, simulated=(1, round(at_mm * 1e4)))
    bench = channel_bench(axis)
    bench.run([words.probe(1, 600.0, Z=130.0), words.wait(1), words.end()])
    assert bench.alarm_ids == []
    found_mm = bench.channel.measured_acs_mm("Z")
    assert found_mm == (None if expected_mm is None else pytest.approx(expected_mm, abs=0.01))


@pytest.mark.long
def test_mode_1_behind_the_axis_signals_at_once_and_beyond_the_target_never(
    channel_bench: Make, words: Any
) -> None:
    assert _value(_run(channel_bench, words, 1, 1_310_000)) == pytest.approx(130.0, abs=0.01)
    assert not _run(channel_bench, words, 1, 1_090_000).channel.measurement_ok("Z")


@pytest.mark.long
def test_mode_2_signals_after_so_many_cycles(channel_bench: Make, words: Any) -> None:
    """10 ms of ramp are 0.05 mm, then 0.01 mm a cycle: 500 cycles are 4.95 mm."""
    assert _value(_run(channel_bench, words, 2, 500)) == pytest.approx(130 - 4.95, abs=1e-6)


@pytest.mark.long
def test_mode_3_signals_when_less_than_a_share_is_left(channel_bench: Make, words: Any) -> None:
    """A quarter of 20 mm is left at 115."""
    assert 114.99 - 1e-9 <= _value(_run(channel_bench, words, 3, 25)) < 115.0


@pytest.mark.parametrize("mode", [4, 5])
@pytest.mark.long(but=1)
def test_modes_4_and_5_signal_at_the_target(channel_bench: Make, words: Any, mode: int) -> None:
    bench = _run(channel_bench, words, mode, 0)
    assert _value(bench) == bench.final_mm("Z") == 110.0


@pytest.mark.long
def test_simu_offset_shifts_mode_4_along_the_path(channel_bench: Make, words: Any) -> None:
    bench = _run(channel_bench, words, 4, 0, simulated_offset_mm=-3.0)
    assert 112.99 - 1e-9 <= _value(bench) <= 113.0
    beyond = _run(channel_bench, words, 4, 0, simulated_offset_mm=3.0)
    assert not beyond.channel.measurement_ok("Z")


@pytest.mark.long
def test_type_3_goes_on_behind_a_simulated_signal(channel_bench: Make, words: Any) -> None:
    bench = _run(channel_bench, words, 1, 1_200_000, kind=3, goes_on=True)
    assert 119.99 - 1e-9 <= _value(bench) <= 120.0
    assert bench.final_mm("Z") == 110.0


@pytest.mark.provokes(900523, 1, offset_mm="-3")
@pytest.mark.long
@pytest.mark.parametrize("mode", [1, 0, 5])
def test_900523_for_an_offset_that_no_mode_takes(
    channel_bench: Make, words: Any, mode: int
) -> None:
    bench = _run(channel_bench, words, mode, 1_200_000, simulated_offset_mm=-3.0)
    assert bench.alarm_ids == [900523]
    beside = channel_bench(words.axis("Y"), words.axis("Z", start_mm=130.0, simulated=(4, 0)))
    run = replace(words.probe(1, 600.0, Z=110.0), simulated_offset_mm=-3.0)
    beside.run([run, words.wait(1), words.end()])
    assert beside.alarm_ids == []


@pytest.mark.long
@pytest.mark.parametrize("mode", [4, 5])
def test_an_axis_that_is_at_its_target_already_signals_at_once_in_mode_5_alone(
    channel_bench: Make, words: Any, mode: int
) -> None:
    """TF5200 axis parameters 118162699: Y of the block stands where it is sent to."""
    y, z = words.axis("Y"), words.axis("Z", start_mm=130.0, simulated=(mode, 0))
    bench = channel_bench(y, z)
    run = replace(words.probe(1, 600.0, Z=110.0), programmed_axes=("Y", "Z"))
    bench.run([run, words.wait(1), words.end()])
    expected_mm = 130.0 if mode == 5 else 110.0
    assert _value(bench) == pytest.approx(expected_mm, abs=0.01)


@pytest.mark.long
def test_mode_4_waits_for_all_axes_and_mode_5_for_the_first(
    channel_bench: Make, words: Any
) -> None:
    """Both axes of a straight path arrive together; one that has no way is there already."""
    for mode, expected_mm in ((4, 110.0), (5, 110.0)):
        bench = channel_bench(
            words.axis("Y", simulated=(mode, 0)),
            words.axis("Z", start_mm=130.0, simulated=(mode, 0)),
        )
        bench.run([words.probe(1, 600.0, Y=15.0, Z=110.0), words.wait(1), words.end()])
        assert bench.channel.records[0].latched_mm == {"Y": 15.0, "Z": expected_mm}
    bench = channel_bench(
        words.axis("Y", simulated=(5, 0)), words.axis("Z", start_mm=130.0, simulated=(5, 0))
    )
    here = bench.axes["Y"].position_at(0) * 1e3
    bench.run([words.probe(1, 600.0, Y=here, Z=110.0), words.wait(1), words.end()])
    assert bench.channel.records[0].latched_mm["Z"] == pytest.approx(130.0, abs=0.01)
