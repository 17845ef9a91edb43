"""What axes may do together: of each kind of slope the weaker one, never that of another kind."""

import math
from dataclasses import fields, replace
from typing import Any

import pytest

from axisrig.kernel.motion.course import AnySlope, Weights
from axisrig.kernel.motion.dynamics import Dynamics, each_slope, together, weakest
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope

SLOPES = ("acceleration", "deceleration", "stop_deceleration", "feedhold")
NUMBERS = ("speed_max_mm_s", "contour_mm_s3", "highest_mm_s2")


def linear(a_mm_s2: float) -> Slope:
    return Slope(a_mm_s2, a_mm_s2, 100.0)


def ramped(a_mm_s2: float) -> JerkSlope:
    """Jerk 20 times the acceleration, up and down."""
    return JerkSlope(a_mm_s2, 0.05, 0.05)


KINDS = pytest.mark.parametrize("kind", [linear, ramped])


def axis(kind: Any, base: float) -> Dynamics:
    """Each slope and each number has a value of its own: the base and 1 to 7 more."""
    slopes = [kind(base + 10.0 * k) for k in range(1, 5)]
    return Dynamics(*slopes[:3], base + 5.0, slopes[3], base + 6.0, base + 7.0)


@KINDS
@pytest.mark.parametrize("name", [*SLOPES, *NUMBERS])
@pytest.mark.parametrize("is_first", [True, False])
def test_the_weaker_of_two_axes_counts_in_each_value_for_itself(
    kind: Any, name: str, is_first: bool
) -> None:
    """One axis is weak in one value and strong in all others."""
    strong = axis(kind, 1000.0)
    value = kind(3.0) if name in SLOPES else 3.0
    weak = replace(axis(kind, 2000.0), **{name: value})
    both = weak.weaker(strong) if is_first else strong.weaker(weak)
    for field in fields(Dynamics):
        found, expected = getattr(both, field.name), getattr(strong, field.name)
        if field.name == name:
            expected = value
        if field.name in SLOPES:
            found, expected = found.least_mm_s2, expected.least_mm_s2
        assert found == expected, field.name


@KINDS
def test_an_axis_without_a_feedhold_of_its_own_holds_with_its_deceleration(kind: Any) -> None:
    """Not with what a signal brakes with, nor with its acceleration; without any there is none."""
    holds = axis(kind, 1000.0)
    bare = replace(
        axis(kind, 2000.0), feedhold=None, deceleration=kind(700.0),
        acceleration=kind(300.0), stop_deceleration=kind(400.0),
    )  # fmt: skip
    together_ = holds.weaker(bare).feedhold
    assert together_ is not None
    assert together_.least_mm_s2 == 700.0
    assert bare.weaker(replace(holds, feedhold=None)).feedhold is None


JERKS = ("a_mm_s2", "rise", "fall", "release")


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("name", JERKS)
@pytest.mark.parametrize("is_first", [True, False])
def test_the_smaller_acceleration_and_the_smaller_jerk_of_each_ramp_count(
    name: str, shape: Shape, is_first: bool
) -> None:
    """A jerk is the acceleration over its ramp time; 50 000 of all but the weak one."""
    times = {"rise": 0.02, "fall": 0.02, "release": 0.02}
    strong = JerkSlope(1000.0, 0.02, 0.02, shape, release_s=0.02)
    if name == "a_mm_s2":
        weak = JerkSlope(500.0, 0.01, 0.01, shape, release_s=0.01)
    else:
        times[name] = 0.08
        weak = JerkSlope(
            1000.0, times["rise"], times["fall"], shape, release_s=times["release"]
        )  # fmt: skip
    both = weak.weaker(strong) if is_first else strong.weaker(weak)
    a = 500.0 if name == "a_mm_s2" else 1000.0
    assert (both.a_mm_s2, both.shape) == (a, shape)
    jerks = {
        "rise": 1.0 / both.rising_s3_mm,
        "fall": 1.0 / both.falling_s3_mm,
        "release": 1.0 / both.releasing_s3_mm,
    }
    expected = dict.fromkeys(jerks, 50_000.0)
    if name != "a_mm_s2":
        expected[name] = 12_500.0
    assert jerks == pytest.approx(expected)


@pytest.mark.parametrize("shape", Shape)
def test_along_a_path_acceleration_and_jerk_grow_by_the_same_share(shape: Shape) -> None:
    """An axis that moves by 0.4 of the path: 2.5 times both; its ramp times stay."""
    found = JerkSlope(1000.0, 0.02, 0.04, shape, release_s=0.03).along(0.4)
    assert found.a_mm_s2 == pytest.approx(2500.0)
    assert (found.rise_s, found.fall_s) == (0.02, 0.04)
    flat = JerkSlope(1000.0, 0.02, 0.04, shape, release_s=0.03).flat(250.0, 9.0)
    assert (flat.a_mm_s2, flat.shape) == (250.0, shape)
    assert (flat.rise_s, flat.fall_s) == pytest.approx((0.005, 0.01))
    assert flat.releasing_s3_mm == pytest.approx(3e-5)


@KINDS
@pytest.mark.parametrize("weak", range(3))
def test_together_the_weakest_of_any_number_counts(kind: Any, weak: int) -> None:
    slopes = [kind(100.0 if place == weak else 900.0) for place in range(3)]
    assert together(slopes).least_mm_s2 == 100.0
    assert together([slopes[weak]]).least_mm_s2 == 100.0


@KINDS
@pytest.mark.parametrize("name", SLOPES)
def test_least_and_largest_acceleration_of_an_axis_are_those_of_any_of_its_slopes(
    kind: Any, name: str
) -> None:
    usual = dict.fromkeys(SLOPES, kind(1000.0))
    weak = Dynamics(speed_max_mm_s=1.0, **{**usual, name: kind(20.0)})
    strong = Dynamics(speed_max_mm_s=1.0, **{**usual, name: kind(5000.0)})
    assert (weakest(weak), weak.most_mm_s2) == (20.0, 1000.0)
    assert (weakest(strong), strong.most_mm_s2) == (1000.0, 5000.0)
    bare = replace(strong, feedhold=None)
    assert bare.most_mm_s2 == (1000.0 if name == "feedhold" else 5000.0)
    assert weakest(bare) == 1000.0


def test_of_a_slope_in_two_steps_the_least_and_the_largest_one_count() -> None:
    one, two = Slope(300.0, 900.0, 50.0), Slope(400.0, 200.0, 50.0)
    found = Dynamics(one, two, one, 1.0)
    assert (weakest(found), found.most_mm_s2) == (200.0, 900.0)


@KINDS
def test_a_path_that_bends_has_each_slope_of_its_axes(kind: Any) -> None:
    """Without a feedhold of its own it holds with its deceleration; never with another slope."""
    of_axis = axis(kind, 1000.0)
    for given, hold in ((of_axis, of_axis.feedhold), (replace(of_axis, feedhold=None), None)):
        found = each_slope(lambda slope_of, given=given: slope_of(given), 12.0)
        wanted: list[AnySlope | None] = [getattr(of_axis, name) for name in SLOPES[:3]]
        assert [getattr(found, name) for name in SLOPES[:3]] == wanted
        assert found.feedhold == (hold or of_axis.deceleration)
        assert found.speed_max_mm_s == 12.0


@KINDS
def test_weights_leave_what_a_signal_and_a_feedhold_brake_with(kind: Any) -> None:
    before = replace(axis(kind, 1000.0), highest_mm_s2=5000.0)
    after = before.weighted(Weights(acceleration=0.5, deceleration=2.0, contour_time=4.0))
    assert after.acceleration.least_mm_s2 == 505.0
    assert after.deceleration.least_mm_s2 == 2040.0
    assert (after.stop_deceleration, after.feedhold) == (before.stop_deceleration, before.feedhold)
    assert after.contour_mm_s3 == pytest.approx(1006.0 / 4.0)
    assert (after.speed_max_mm_s, after.highest_mm_s2) == (1005.0, 5000.0)
    assert before.weighted(Weights()) is before


@pytest.mark.parametrize("stroke_mm", [0.5, 5.0])
def test_within_a_stroke_a_run_is_as_slow_as_its_stop_alone_wants(stroke_mm: float) -> None:
    """sqrt(2 a s) without ramps, by the deceleration on the signal and by no other one."""
    run = Dynamics(linear(2000.0), linear(100.0), linear(800.0), 300.0, linear(50.0))
    found = run.within_stroke(stroke_mm)
    assert found.speed_max_mm_s == pytest.approx(math.sqrt(2.0 * 800.0 * stroke_mm))
    assert (found.acceleration, found.stop_deceleration) == (run.acceleration, linear(800.0))
    assert found.feedhold == linear(50.0)
    slow = replace(run, speed_max_mm_s=7.0, feedhold=None).within_stroke(stroke_mm)
    assert (slow.speed_max_mm_s, slow.feedhold) == (7.0, None)


@pytest.mark.parametrize("shape", Shape)
def test_within_a_stroke_a_feedhold_lets_the_acceleration_fall_as_the_run_does(
    shape: Shape,
) -> None:
    """1000 mm/s² in 40 ms, and not in the 200 ms in which the feedhold builds up."""
    up, stop = JerkSlope(1000.0, 0.02, 0.04, shape), JerkSlope(900.0, 0.03, 0.03, shape)
    hold = JerkSlope(500.0, 0.2, 0.2, shape)
    run = Dynamics(up, up, stop, 300.0, hold)
    found = run.within_stroke(5.0)
    held: Any = found.feedhold
    assert held.releasing_s3_mm == pytest.approx(0.04 / 1000.0)
    assert (held.a_mm_s2, held.rise_s, held.fall_s) == (500.0, 0.2, 0.2)
    led: Any = found.acceleration
    assert (led.stroke.stop, led.stroke.stroke_mm) == (stop, 5.0)
    assert found.speed_max_mm_s == pytest.approx(900 * (-0.015 + math.sqrt(0.015**2 + 10.0 / 900)))
