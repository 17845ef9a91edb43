"""The own model of distance control, step by step: its controller and its limits.

CONST_DIST without a filter: a sensor value of e - 5 mm at a SET_DIST of 5 mm is an error of e.
Sources: FCT-M3 3, 5 and 7; docs/ambiguities.md, "Distance control". The cycle is 1 ms.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.model import UNLIMITED, Law
from axisrig.kernel.time.clock import MS

SET_MM = 5.0


def law_of(control: Control, limits: Limits = UNLIMITED, **changes: float) -> Law:
    return Law(CONST_DIST, control, MS, limits, **changes)


def with_error(law: Law, error_mm: float) -> float:
    """Walk one cycle with an error, return its step."""
    law.walk(error_mm - SET_MM, 0.0, 0.0, SET_MM)
    return law.step_mm


def steps(law: Law, errors_mm: Sequence[float]) -> list[float]:
    return [with_error(law, error_mm) for error_mm in errors_mm]


# The controller


def test_the_sum_of_errors_grows_by_its_share_of_a_cycle() -> None:
    """Kp 0.2, error 0.1 mm, T/Tn 0.1: each cycle adds a tenth of the error."""
    found = steps(law_of(Control(0.2, tn_s=0.01)), [0.1] * 5)
    assert found == pytest.approx([0.2 * 0.1 * (1.0 + 0.1 * (k + 1)) for k in range(5)])


def test_another_time_of_the_integral_keeps_its_sum() -> None:
    law = law_of(Control(0.2, tn_s=0.01))
    steps(law, [0.1] * 3)
    law.change(Control(0.2, tn_s=0.02), law.smoothing)
    # Three shares of 0.01 mm so far, then 0.005 mm each
    assert steps(law, [0.1] * 2) == pytest.approx([0.2 * (0.1 + 0.035), 0.2 * (0.1 + 0.040)])


def test_an_integral_that_was_off_begins_anew() -> None:
    law = law_of(Control(0.2, tn_s=0.01))
    steps(law, [0.1] * 3)
    law.change(Control(0.2), law.smoothing)
    assert with_error(law, 0.1) == pytest.approx(0.2 * 0.1)
    law.change(Control(0.2, tn_s=0.01), law.smoothing)
    assert with_error(law, 0.1) == pytest.approx(0.2 * (0.1 + 0.01))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    "limits",
    [
        replace(UNLIMITED, v_mm_s=10.0),
        replace(UNLIMITED, a_mm_s2=10_000.0),
        replace(UNLIMITED, deviation_mm=0.01),
    ],
    ids=["speed", "acceleration", "deviation"],
)
def test_what_is_limited_adds_nothing_to_the_sum(limits: Limits, side: float) -> None:
    """0.02 mm are asked for and 0.01 mm are given; the error of that cycle does not count."""
    law = law_of(Control(0.2, tn_s=0.01, limiter="clamp"), limits)
    assert with_error(law, 0.1 * side) == pytest.approx(0.01 * side)
    law.limits = UNLIMITED
    assert with_error(law, 0.01 * side) == pytest.approx(0.2 * (0.01 + 0.001) * side)


@pytest.mark.parametrize(("derivative", "factor"), [("per_second", 4.0), ("per_cycle", 0.004)])
def test_a_change_of_the_error_counts_by_tv(derivative: str, factor: float) -> None:
    """Tv 4 ms over a cycle of 1 ms, or as it is; nothing came before the first cycle."""
    law = law_of(Control(0.5, tv_s=0.004, derivative_of="error", derivative=derivative))
    found = steps(law, [0.1, 0.3, 0.3, 0.2])
    changes = [0.0, 0.2, 0.0, -0.1]
    expected = [
        0.5 * (error + factor * change)
        for error, change in zip([0.1, 0.3, 0.3, 0.2], changes, strict=True)
    ]
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(("derivative_of", "counts"), [("error", 1.0), ("feedback", 0.0)])
def test_a_step_of_the_set_value_is_a_change_of_the_error_and_not_of_the_feedback(
    derivative_of: str, counts: float
) -> None:
    law = law_of(Control(0.5, tv_s=0.002, derivative_of=derivative_of))
    law.walk(-5.0, 0.0, 0.0, 5.0)
    law.walk(-5.0, 0.0, 0.0, 5.4)
    assert law.step_mm == pytest.approx(0.5 * (0.4 + counts * 2.0 * 0.4))


@pytest.mark.parametrize(
    ("mode", "sensor_mm"), [(CONST_DIST, (-5.0, -4.9)), (SET_POS, (-5.0, -4.9))]
)
def test_the_feedback_counts_with_the_sign_that_it_has_in_the_error(
    mode: str, sensor_mm: tuple[float, float]
) -> None:
    """The tool comes 0.1 mm nearer: it has to go up by that, and by its change."""
    law = Law(mode, Control(0.5, tv_s=0.002, derivative_of="feedback"), MS)
    set_mm = 5.0 if mode == CONST_DIST else -5.0
    for value in sensor_mm:
        law.walk(value, 0.0, 0.0, set_mm)
    assert law.step_mm == pytest.approx(0.5 * (0.1 + 2.0 * 0.1))


def test_what_begins_to_follow_again_has_no_sum_no_change_and_no_speed() -> None:
    control = Control(0.2, tn_s=0.01, tv_s=0.002, derivative_of="error", limiter="clamp")
    law = law_of(control, replace(UNLIMITED, a_mm_s2=1e5))
    steps(law, [0.1, 0.2, 0.3])
    offset_mm = law.offset_mm
    law.stand()
    assert law.step_mm == 0.0
    # 0.1 mm of step is what an acceleration of 1e5 mm/s2 allows from rest
    assert with_error(law, 1.0) == pytest.approx(0.1)
    law.stand()
    assert with_error(law, 0.05) == pytest.approx(0.2 * (0.05 + 0.005))
    assert law.offset_mm == pytest.approx(offset_mm + 0.1 + 0.011)


def test_what_is_held_stays_and_its_sum_and_change_go_on() -> None:
    """A change during the hold is none after it; the sum is what it was before."""
    control = Control(0.2, tn_s=0.01, tv_s=0.002, derivative_of="error")
    law = law_of(control)
    steps(law, [0.1, 0.1])
    offset_mm = law.offset_mm
    law.hold(0.3 - SET_MM, 0.0, 0.0, SET_MM)
    assert (law.offset_mm, law.step_mm, law.asked_mm) == (offset_mm, 0.0, offset_mm)
    assert law.error_mm == pytest.approx(0.3)
    assert with_error(law, 0.3) == pytest.approx(0.2 * (0.3 + 0.01 + 0.01 + 0.03))


# Its limits


@pytest.mark.parametrize(
    ("weight", "override", "axes_mm_s", "up_mm", "down_mm"),
    [
        (0.0, 1.0, math.inf, 0.010, 0.010),
        (400.0, 1.0, math.inf, 0.010, 0.004),
        (0.0, 0.5, math.inf, 0.005, 0.005),
        (400.0, 0.5, math.inf, 0.005, 0.002),
        (0.0, 1.0, 6.0, 0.006, 0.006),
        (0.0, 0.5, 6.0, 0.003, 0.003),
        (500.0, 0.5, 6.0, 0.003, 0.0015),
        (0.0, 1.0, 20.0, 0.010, 0.010),
        (0.0, 1.3, math.inf, 0.013, 0.013),
        (0.0, 0.0, math.inf, 0.0, 0.0),
    ],
)
def test_a_step_is_as_large_as_speed_override_and_axes_allow(
    weight: float, override: float, axes_mm_s: float, up_mm: float, down_mm: float
) -> None:
    """10 mm/s; the weight in per mille counts towards the workpiece only."""
    limits = replace(UNLIMITED, v_mm_s=10.0, v_weight=weight)
    for error_mm, expected_mm in ((1.0, up_mm), (-1.0, -down_mm)):
        law = law_of(Control(0.5), limits)
        law.override, law.axes = override, (axes_mm_s, math.inf)
        assert steps(law, [error_mm] * 2) == pytest.approx([expected_mm] * 2)


@pytest.mark.parametrize(
    ("weight", "axes_mm_s2", "up_mm", "down_mm"),
    [
        (0.0, math.inf, 0.001, 0.001),
        (500.0, math.inf, 0.001, 0.0005),
        (0.0, 600.0, 0.0006, 0.0006),
        (500.0, 600.0, 0.0006, 0.0003),
        (0.0, 2000.0, 0.001, 0.001),
    ],
)
def test_steps_change_as_acceleration_and_axes_allow(
    weight: float, axes_mm_s2: float, up_mm: float, down_mm: float
) -> None:
    """1000 mm/s2; an override does not change it."""
    limits = replace(UNLIMITED, a_mm_s2=1000.0, a_weight=weight)
    for error_mm, change_mm in ((1.0, up_mm), (-1.0, -down_mm)):
        law = law_of(Control(0.5, limiter="clamp"), limits)
        law.override, law.axes = 0.5, (math.inf, axes_mm_s2)
        found = steps(law, [error_mm] * 3)
        assert found == pytest.approx([change_mm, 2 * change_mm, 3 * change_mm])


def test_what_brakes_the_way_up_is_not_weighted() -> None:
    """P-AXIS-00534: from 0.003 mm a cycle back to 0 by 0.001 each, then down by half of that."""
    limits = replace(UNLIMITED, a_mm_s2=1000.0, a_weight=500.0)
    law = law_of(Control(0.5, limiter="clamp"), limits)
    steps(law, [1.0] * 3)
    found = steps(law, [-1.0] * 5)
    assert found == pytest.approx([0.002, 0.001, 0.0, -0.0005, -0.001])
    assert steps(law, [1.0] * 2) == pytest.approx([0.0, 0.001])  # what brakes it is an upward one


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("error_mm", "a_mm_s2"), [(0.05, 100.0), (0.1, 100.0), (0.3, 300.0), (0.5, 500.0), (2.0, 500.0)]
)
def test_an_adaptive_acceleration_goes_by_the_error_of_the_cycle(
    error_mm: float, a_mm_s2: float, side: float
) -> None:
    limits = replace(UNLIMITED, a_mm_s2=500.0, adaptive=(100.0, 0.1, 0.5))
    law = law_of(Control(0.5, limiter="clamp"), limits)
    assert with_error(law, side * error_mm) == pytest.approx(side * a_mm_s2 * 1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_offset_ends_at_the_deviation_and_what_was_asked_is_beyond_it(side: float) -> None:
    limits = replace(UNLIMITED, deviation_mm=0.25)
    law = law_of(Control(0.5), limits, offset_mm=0.2 * side)
    assert with_error(law, 0.3 * side) == pytest.approx(0.05 * side)
    assert (law.offset_mm, law.asked_mm) == pytest.approx((0.25 * side, 0.35 * side))
    assert with_error(law, 0.1 * side) == pytest.approx(0.0)
    assert law.asked_mm == pytest.approx(0.30 * side)
    law.hold(0.1 * side - SET_MM, 0.0, 0.0, SET_MM)
    assert law.asked_mm == law.offset_mm == pytest.approx(0.25 * side)  # a hold asks for nothing
    assert with_error(law, -0.1 * side) == pytest.approx(-0.05 * side)
    assert law.asked_mm == law.offset_mm == pytest.approx(0.2 * side)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("way_mm", [0.01, 0.0123, 0.0004])
def test_a_slope_ends_at_the_surface_without_going_past_it(way_mm: float, side: float) -> None:
    """A loop without dead time: kp 1 asks for all of the error, 1000 mm/s2 lets it."""
    law = Law(SET_POS, Control(1.0), MS, replace(UNLIMITED, a_mm_s2=1000.0))
    offsets = np.array([law.walk(side * way_mm, 0.0, 0.0, 0.0) for _ in range(12)]) * side
    assert np.max(offsets) <= way_mm + 1e-12
    assert offsets[-1] == pytest.approx(way_mm, abs=1e-12)
    changes = np.diff(np.diff(offsets, prepend=[0.0, 0.0]))
    assert np.max(np.abs(changes)) <= 0.001 + 1e-12


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_step_away_from_the_error_needs_no_place_to_stop(side: float) -> None:
    """The change of the error asks for 0.8 mm back while 0.05 mm of it are left."""
    control = Control(1.0, tv_s=17.0, derivative="per_cycle", derivative_of="error")
    law = law_of(control, replace(UNLIMITED, a_mm_s2=1e6))
    found = steps(law, [0.1 * side, 0.05 * side])
    assert found == pytest.approx([0.1 * side, (0.05 - 17.0 * 0.05) * side])
