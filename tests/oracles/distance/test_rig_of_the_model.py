"""What is around the own model of distance control: way, age of the sensor, drive, increments.

With kp = 0 the offset stays 0: the axis goes where the program goes, 0.1 mm a cycle, and the sensor
sees it above a surface.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.bench.oracles.distance.model import Course, Law, Rig, Signal, simulate

ROWS = 30
K = np.arange(ROWS)
PROGRAM_MM = 5.0 + 0.1 * K
SURFACE_MM = np.where(K < 12, 0.0, 0.7)
PERIOD_NS = 1_000_000


def still(rig: Rig, noise_mm: Signal | None = None, program_mm: Signal = PROGRAM_MM) -> Course:
    law = Law(CONST_DIST, Control(0.0), PERIOD_NS)
    return simulate(law, rig, SURFACE_MM, program_mm, 2.0, noise_mm)


def later(values: Signal, cycles: int) -> Signal:
    """Values so many cycles ago; before the first one it was there too."""
    return values[np.maximum(K - cycles, 0)]


@pytest.mark.parametrize("way", [1, 2, 3, 5])
@pytest.mark.parametrize("reaction", [0, 1])
def test_an_axis_is_where_it_was_sent_so_many_cycles_ago(way: int, reaction: int) -> None:
    """The program is known in advance: only the offset reacts later."""
    course = still(Rig(reaction, way))
    assert course.actual_mm == pytest.approx(later(PROGRAM_MM, way))
    assert course.gap_mm == pytest.approx(later(PROGRAM_MM, way) - SURFACE_MM)
    assert course.sensor_mm == pytest.approx(-course.gap_mm)
    assert not course.offset_mm.any()


@pytest.mark.parametrize("age", [0, 1, 2, 4])
def test_an_older_sensor_gives_the_gap_of_an_earlier_sync(age: int) -> None:
    course = still(Rig(skew_cycles=age))
    gap = later(PROGRAM_MM, 2) - SURFACE_MM
    assert course.gap_mm == pytest.approx(gap)
    assert course.sensor_mm == pytest.approx(-later(gap, age))
    assert course.actual_mm == pytest.approx(later(PROGRAM_MM, 2))


@pytest.mark.parametrize(("way", "newer"), [(2, 1), (3, 1), (3, 2)])
def test_a_newer_sensor_sees_what_the_motor_encoder_shows_later(way: int, newer: int) -> None:
    course = still(Rig(way_cycles=way, skew_cycles=-newer))
    gap = later(PROGRAM_MM, way - newer) - SURFACE_MM
    assert course.gap_mm == pytest.approx(gap)
    assert course.sensor_mm == pytest.approx(-gap)
    assert course.actual_mm == pytest.approx(later(PROGRAM_MM, way))


@pytest.mark.parametrize("increment_mm", [0.0, 0.25, 0.03])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_sensor_gives_whole_increments_of_what_it_sees_with_its_noise(
    increment_mm: float, sign: int
) -> None:
    """Of the gap with the noise, whichever way it counts."""
    noise = 0.011 * (-1.0) ** K
    course = still(Rig(increment_mm=increment_mm, sign=sign), noise)
    wanted = later(PROGRAM_MM, 2) - SURFACE_MM + noise
    assert course.gap_mm == pytest.approx(wanted - noise)  # the gap itself has none
    if not increment_mm:
        assert course.sensor_mm == pytest.approx(-sign * wanted)
        return
    counts = course.sensor_mm / increment_mm
    assert counts == pytest.approx(np.round(counts), abs=1e-9)
    assert np.max(np.abs(course.sensor_mm + sign * wanted)) <= increment_mm / 2 + 1e-9
    assert np.ptp(course.sensor_mm) > increment_mm


@pytest.mark.parametrize("lag_ms", [0.3, 1.0, 8.0])
def test_a_drive_with_a_lag_is_behind_a_ramp_by_its_way_in_the_lag(lag_ms: float) -> None:
    """y = u - v tau (1 - exp(-t/tau)), u = v t from the cycle on in which the ramp is sent."""
    course = still(Rig(way_cycles=1, lag_s=lag_ms * 1e-3))
    time_ms = np.maximum(K - 1.0, 0.0)
    behind = 0.1 * lag_ms * (1.0 - np.exp(-time_ms / lag_ms))
    assert course.actual_mm == pytest.approx(later(PROGRAM_MM, 1) - behind)


@pytest.mark.parametrize("lag_ms", [0.5, 3.0])
def test_a_drive_with_a_lag_comes_to_rest_where_it_was_sent(lag_ms: float) -> None:
    """A ramp of one cycle to 6 mm: what is left falls by exp(-T/tau) in each one after it."""
    course = still(Rig(way_cycles=1, lag_s=lag_ms * 1e-3), None, np.where(K < 3, 5.0, 6.0))
    left = 6.0 - course.actual_mm
    first = lag_ms * (1.0 - math.exp(-1.0 / lag_ms))
    assert left[:4] == pytest.approx(1.0)
    assert left[4] == pytest.approx(first)
    assert left[5:15] == pytest.approx(first * np.exp(-np.arange(1, 11) / lag_ms))


@pytest.mark.parametrize("reaction", [0, 1])
@pytest.mark.parametrize("way", [1, 2, 4])
def test_an_offset_is_reached_after_reaction_and_way(reaction: int, way: int) -> None:
    """The distance is half of the error away from the first cycle on, and kp makes it whole."""
    law = Law(CONST_DIST, Control(1.0), PERIOD_NS)
    rows = reaction + way + 1
    course = simulate(law, Rig(reaction, way), np.zeros(rows), 1.0, 1.5)
    assert course.error_mm == pytest.approx([0.5] * (rows - 1) + [0.0])
    assert course.actual_mm == pytest.approx([1.0] * (rows - 1) + [1.5])
    assert course.offset_mm[0] == pytest.approx(0.5)


def test_an_axis_begins_with_the_offset_that_it_has() -> None:
    """Where a control goes on after another one: program and offset together."""
    law = replace(Law(CONST_DIST, Control(0.0), PERIOD_NS), offset_mm=0.4)
    course = simulate(law, Rig(1, 2), np.zeros(5), 1.0, 1.4)
    assert course.actual_mm == pytest.approx([1.4] * 5)
    assert course.offset_mm == pytest.approx([0.4] * 5)
    assert course.error_mm == pytest.approx([0.0] * 5, abs=1e-12)
