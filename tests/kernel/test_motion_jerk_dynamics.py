"""Which parameters make a slope with ramps: the first table of FCT-C4 2.1, row by row; weights."""

import csv
import itertools
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import axisrig.kernel.motion
from axisrig.kernel.channel.path.programmed import ProgrammedDynamics
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.course import State, Weights
from axisrig.kernel.motion.curves import Arc
from axisrig.kernel.motion.dynamics import (
    CHANNEL_SETTINGS,
    Dynamics,
    Motion,
    arc_dynamics,
    axis_slopes,
    path_dynamics,
)
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import MS

TRAPEZ, SIN2 = Shape.TRAPEZ, Shape.SIN2
BLOCK = Block(1, 10, "N10")
# Every parameter another value, so that the values show which parameters act; ms in the names
VALUES = {
    "slope_profil.a_beschl": 101, "slope_profil.a_brems": 102, "slope_profil.a_grenz": 104,
    "slope_profil.a_feedh": 153, "slope_profil.tr_beschl_zu": 196_000,
    "slope_profil.tr_beschl_ab": 195_000, "slope_profil.tr_brems_zu": 198_000,
    "slope_profil.tr_brems_ab": 197_000, "slope_profil.tr_grenz": 200_000,
    "slope_profil.tr_feedh": 81_000, "dynamik.tr_min": 1000, "dynamik.tr_geom": 199_000,
}  # fmt: skip


def axis(**more: int) -> ParameterSet:
    parameters = ParameterSet("axis")
    changed = {name.replace("__", "."): value for name, value in more.items()}
    for name, value in (VALUES | changed).items():
        parameters.set(f"getriebe[0].{name}", str(value), "test")
    return parameters


def channel(std_dynamic: int = 0, mode: int = 0, curr_limit: int = 0, **more: int) -> ParameterSet:
    parameters = ParameterSet("channel")
    for name, value in zip(CHANNEL_SETTINGS, (std_dynamic, mode, curr_limit), strict=True):
        parameters.set(name, str(value), "test")
    for name, value in more.items():
        parameters.set(f"prog_start.slope.{name}", str(value), "test")
    return parameters


def slope(a: float, rise_ms: float, fall_ms: float) -> tuple[float, float, float]:
    return a, rise_ms / 1000.0, fall_ms / 1000.0


def values_of(found: object) -> tuple[float, float, float]:
    assert isinstance(found, JerkSlope)
    return found.a_mm_s2, found.rise_s, found.fall_s


RAPID, HOLD = slope(104, 200, 200), slope(153, 81, 81)
FEED_A, FEED_D = slope(101, 196, 195), slope(102, 198, 197)


@pytest.mark.parametrize(
    ("settings", "acceleration", "deceleration", "on_signal"),
    [
        ((0, 0, 0), RAPID, RAPID, RAPID),
        ((0, 0, 1), RAPID, RAPID, HOLD),
        ((0, 1, 0), RAPID, RAPID, RAPID),
        ((0, 1, 1), RAPID, RAPID, RAPID),
        *((row, FEED_A, FEED_D, HOLD) for row in itertools.product((1,), (0, 1), (0, 1))),
    ],
)
def test_a_measurement_run_with_ramps(
    settings: tuple[int, int, int],
    acceleration: tuple[float, ...],
    deceleration: tuple[float, ...],
    on_signal: tuple[float, ...],
) -> None:
    found = axis_slopes(axis(), channel(*settings), Motion.MEASURING, SIN2)
    assert values_of(found.acceleration) == acceleration
    assert values_of(found.deceleration) == deceleration
    assert values_of(found.stop_deceleration) == on_signal
    assert isinstance(found.acceleration, JerkSlope)
    assert found.acceleration.shape is SIN2


def test_feed_rapid_and_feedhold_with_ramps() -> None:
    feed = axis_slopes(axis(), channel(0, 0, 1), Motion.FEED, TRAPEZ)
    rapid = axis_slopes(axis(), channel(0, 0, 0), Motion.RAPID, TRAPEZ)
    assert [values_of(s) for s in (feed.acceleration, feed.deceleration)] == [FEED_A, FEED_D]
    assert values_of(feed.feedhold) == values_of(feed.stop_deceleration) == HOLD
    assert [values_of(s) for s in (rapid.acceleration, rapid.deceleration)] == [RAPID, RAPID]
    assert rapid.feedhold is None


@pytest.mark.parametrize("motion", Motion)
@pytest.mark.parametrize("shape", Shape)
def test_an_acceleration_falls_in_its_own_time_before_the_motion_brakes(
    motion: Motion, shape: Shape
) -> None:
    """195 ms of 101 mm/s2 (200 of 104); a signal and a feedhold let it fall as they build up."""
    found = axis_slopes(axis(), channel(0, 0, 1), motion, shape)
    slopes = (found.deceleration, found.stop_deceleration, found.feedhold)
    own = 0.195 / 101.0 if motion is Motion.FEED else 0.2 / 104.0
    expected = (own, 0.081 / 153.0, 0.081 / 153.0)
    for one, per_acceleration in zip(slopes, expected, strict=True):
        assert isinstance(one, JerkSlope)
        assert one.releasing_s3_mm == pytest.approx(per_acceleration)


def test_0_of_the_feedhold_values_is_the_rapid_value() -> None:
    for name, expected in (
        ("slope_profil__a_feedh", slope(104, 81, 81)),
        ("slope_profil__tr_feedh", slope(153, 200, 200)),
    ):
        found = axis_slopes(axis(**{name: 0}), channel(0, 0, 1), Motion.FEED, TRAPEZ)
        assert values_of(found.feedhold) == expected


def test_the_least_ramp_time_and_the_largest_acceleration() -> None:
    """P-AXIS-00201 raises, P-AXIS-00008 lowers where a list has it; its default 1000 does not."""
    limited = axis(dynamik__tr_min=196_500, dynamik__a_max=101, slope_profil__a_beschl=5000)
    found = axis_slopes(limited, channel(), Motion.FEED, TRAPEZ)
    assert values_of(found.acceleration) == slope(101, 196.5, 196.5)
    free = axis_slopes(axis(slope_profil__a_beschl=5000), channel(), Motion.FEED, TRAPEZ)
    assert values_of(free.acceleration) == slope(5000, 196, 195)


def test_constant_ramp_time_is_for_the_values_of_feed_blocks() -> None:
    """P-CHAN-00349; not where P-AXIS-00004 acts, nor in a feedhold."""
    of = {
        motion: axis_slopes(axis(), channel(0, 0, 1, mode_ramp_time=1), motion, TRAPEZ)
        for motion in Motion
    }
    kept = {
        (motion, name)
        for motion, dynamics in of.items()
        for name in ("acceleration", "deceleration", "stop_deceleration", "feedhold")
        if getattr(dynamics, name).keeps_time
    }
    assert kept == {(Motion.FEED, "acceleration"), (Motion.FEED, "deceleration")}
    std = axis_slopes(axis(), channel(1, 0, 0, mode_ramp_time=1), Motion.MEASURING, TRAPEZ)
    assert getattr(std.acceleration, "keeps_time") is True  # noqa: B009 - of a JerkSlope


def test_the_tables_name_the_same_slopes() -> None:
    folder = Path(axisrig.kernel.motion.__path__[0])
    names = []
    for table in ("slopes.csv", "jerk_slopes.csv"):
        with (folder / table).open(encoding="utf-8", newline="") as file:
            names.append([row["slope"] for row in csv.DictReader(file)])
    assert names[0] == names[1]


# Several axes


def of(a: float, ramp_s: float, speed: float = 100.0) -> Dynamics:
    ramped = JerkSlope(a, ramp_s, ramp_s)
    return Dynamics(ramped, ramped, ramped, speed)


def test_along_a_path_the_smallest_acceleration_and_the_smallest_jerk_count() -> None:
    """Shares 0.6 and 0.8: 1000/0.6 and 2000/0.8 mm/s²; jerks 50000/0.6 and 25000/0.8 mm/s³."""
    path = path_dynamics([of(1000.0, 0.02), of(2000.0, 0.08)], [3.0, -4.0])
    found = path.acceleration
    assert isinstance(found, JerkSlope)
    assert found.a_mm_s2 == pytest.approx(1000.0 / 0.6)
    assert found.a_mm_s2 / found.rise_s == pytest.approx(25_000.0 / 0.8)
    assert found.rise_s == pytest.approx(1000.0 / 0.6 / (25_000.0 / 0.8))


def test_no_axis_of_an_oblique_path_exceeds_its_jerk() -> None:
    axes = [of(1000.0, 0.02), of(2000.0, 0.08)]
    path = path_dynamics(axes, [3.0, -4.0])
    profile = path.acceleration.plan(50.0, 60.0, path.deceleration)
    assert isinstance(profile.duration_s, float)
    step = 1e-4
    a = [profile.state(k * step).a_mm_s2 for k in range(int(profile.duration_s / step))]
    jerk = max(abs(y - x) / step for x, y in itertools.pairwise(a))
    assert max(map(abs, a)) * 0.6 <= 1000.0 * (1 + 1e-9)
    assert jerk * 0.6 <= 50_000.0 * (1 + 1e-6)
    assert jerk * 0.8 <= 25_000.0 * (1 + 1e-6)


def arc(radius: float) -> Arc:
    return Arc((0.0, 0.0), (2 * radius, 0.0), (radius, 0.0), (0.0, 1.0), math.pi)


def test_a_curve_makes_no_larger_jerk_than_the_geometrical_ramp_time_allows() -> None:
    """v³/r² = a/t_geom: 1000 mm/s², 10 ms and 5 mm give (100000 x 25)^(1/3) = 135.7 mm/s.

    The centripetal acceleration allows sqrt(1000 / sqrt 2 x 5) = 59.5 mm/s, 100 ms 63.0 mm/s.
    """
    axes = [of(1000.0, 0.02, 500.0)] * 2
    for time_s, expected in ((0.01, 59.4604), (0.1, 59.4604), (1.0, (1000.0 * 25.0) ** (1 / 3))):
        limited = [
            Dynamics(*[d.acceleration] * 3, d.speed_max_mm_s, None, 1000.0 / time_s) for d in axes
        ]
        found = arc_dynamics(limited, arc(5.0)).speed_max_mm_s
        assert found == pytest.approx(expected, rel=1e-5)


def test_an_arc_has_the_jerk_of_its_axes_along_the_path() -> None:
    found = arc_dynamics([of(1000.0, 0.02)] * 2, arc(50.0), 10.0).acceleration
    assert isinstance(found, JerkSlope)
    assert found.a_mm_s2 / found.rise_s == pytest.approx(50_000.0)


# The interpolator


def test_set_positions_come_from_the_profile_at_whole_cycles() -> None:
    ramped = JerkSlope(1000.0, 0.0123, 0.0234, SIN2)
    profile = ramped.plan(7.7, 33.0, ramped)
    path = Interpolator(("X",), MS)
    path.start({"X": 1.3}, {"X": 9.0}, profile)
    for cycle in range(1, 500):
        expected = 9.0 if cycle * 1e-3 >= profile.duration_s else 1.3 + profile.at(cycle / 1e3)[0]
        assert path.advance()[0] == pytest.approx(expected, abs=1e-12)
    assert path.positions_mm == (9.0,)


# What a program chooses


def programmed(**more: int) -> tuple[ProgrammedDynamics, AxisSettings]:
    std = more.pop("meas_use_std_dynamic", 0)
    of_channel = channel(std, **more)
    settings = ChannelSettings.read(of_channel, start_after_ns=None, optional_stop=False)
    wide = axis(dynamik__a_max=1000, slope_profil__a_beschl=400, slope_profil__a_brems=400)
    return ProgrammedDynamics(settings), AxisSettings.read("X", wide, of_channel)


def weigh(chosen: ProgrammedDynamics, what: str, share: float) -> None:
    chosen.weigh(canon.DynamicWeights(BLOCK, what, {"X": share}))


def test_the_profile_of_the_list_until_another_is_chosen_and_again_after_the_program() -> None:
    chosen, x = programmed(profile=2)
    assert chosen.dynamics(x, Motion.FEED) == x.jerk_limited[SIN2][Motion.FEED]
    chosen.choose(canon.SlopeChoice(BLOCK, "STEP"))
    assert chosen.dynamics(x, Motion.FEED) == x.dynamics[Motion.FEED]
    chosen.choose(canon.SlopeChoice(BLOCK, "TRAPEZ"))
    assert chosen.dynamics(x, Motion.RAPID) == x.jerk_limited[TRAPEZ][Motion.RAPID]
    chosen.choose(canon.SlopeChoice(BLOCK, None))
    assert chosen.dynamics(x, Motion.FEED) == x.jerk_limited[SIN2][Motion.FEED]
    chosen.choose(canon.SlopeChoice(BLOCK, "STEP"))
    weigh(chosen, "acceleration", 0.5)
    chosen.begin()
    assert chosen.dynamics(x, Motion.FEED) == x.jerk_limited[SIN2][Motion.FEED]
    weigh(chosen, "ramp_time", 2.0)  # of the next program, which has no other weights
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(400, 392, 390)


def test_what_a_program_chooses_comes_by_its_commands() -> None:
    """#SLOPE and G130 to G134 are carried out here, at once."""
    chosen, x = programmed(profile=1)
    carried: dict[type, Callable[[Any], None]] = {}
    execution: Any = SimpleNamespace(register=carried.__setitem__)
    chosen.assign(execution)
    carried[canon.DynamicWeights](canon.DynamicWeights(BLOCK, "acceleration", {"X": 0.5}))
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(200, 196, 195)
    carried[canon.SlopeChoice](canon.SlopeChoice(BLOCK, "STEP"))
    assert isinstance(chosen.dynamics(x, Motion.RAPID).acceleration, Slope)


def test_the_hsc_profile_of_a_list_is_refused_when_a_path_begins() -> None:
    of_channel = channel()
    settings = ChannelSettings(slope="HSC")
    x = AxisSettings.read("X", axis(), of_channel)
    with pytest.raises(Alarm, match="HSC") as refused:
        ProgrammedDynamics(settings).dynamics(x, Motion.RAPID)
    assert refused.value.id == 900100


def test_weights_of_feed_blocks() -> None:
    """A half of 400 mm/s², twice the ramp times; G0, and what a signal brakes with, stay."""
    chosen, x = programmed(profile=1)
    weigh(chosen, "acceleration", 0.5)
    weigh(chosen, "ramp_time", 2.0)
    feed = chosen.dynamics(x, Motion.FEED)
    assert values_of(feed.acceleration) == slope(200, 392, 390)
    assert values_of(feed.deceleration) == slope(200, 396, 394)
    plain = x.jerk_limited[TRAPEZ]
    assert feed.stop_deceleration == plain[Motion.FEED].stop_deceleration
    assert chosen.dynamics(x, Motion.RAPID) == plain[Motion.RAPID]
    weigh(chosen, "acceleration", 0.5)  # twice is once
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(200, 392, 390)
    weigh(chosen, "acceleration", 4.0)  # P-AXIS-00008
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(1000, 392, 390)


def test_an_axis_that_leaves_the_channel_has_the_ramp_times_of_its_list_again() -> None:
    """The weight of its acceleration stays, and so do the weights of other axes."""
    chosen, x = programmed(profile=1)
    weigh(chosen, "acceleration", 0.5)
    weigh(chosen, "ramp_time", 2.0)
    chosen.forget_times("Y")
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(200, 392, 390)
    chosen.forget_times("X")
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(200, 196, 195)


def test_weights_act_on_a_measurement_run_with_p_chan_00296_alone() -> None:
    for std in (0, 1):
        chosen, x = programmed(profile=1, meas_use_std_dynamic=std)
        weigh(chosen, "acceleration", 0.5)
        weigh(chosen, "ramp_time", 3.0)
        plain = x.jerk_limited[TRAPEZ][Motion.MEASURING]
        found = chosen.dynamics(x, Motion.MEASURING)
        assert (found == plain) is (std == 0)
        assert found.stop_deceleration == plain.stop_deceleration
        if std:
            assert values_of(found.acceleration) == pytest.approx(slope(200, 588, 585))


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (0, (2.0, 2.0, 2.0, 2.0)),
        (1, (2.0, 1.0, 1.0, 1.0)),
        (2, (1.0, 2.0, 1.0, 1.0)),
        (3, (1.0, 1.0, 2.0, 1.0)),
        (4, (1.0, 1.0, 1.0, 2.0)),
    ],
)
def test_which_ramp_times_are_weighted(mode: int, expected: tuple[float, ...]) -> None:
    """P-CHAN-00073."""
    chosen, x = programmed(profile=1, ramp_time=mode)
    weigh(chosen, "ramp_time", 2.0)
    found, plain = chosen.dynamics(x, Motion.FEED), x.jerk_limited[TRAPEZ][Motion.FEED]
    times = [t for s in (found.acceleration, found.deceleration) for t in values_of(s)[1:]]
    before = [t for s in (plain.acceleration, plain.deceleration) for t in values_of(s)[1:]]
    assert [a / b for a, b in zip(times, before, strict=True)] == pytest.approx(expected)


@pytest.mark.parametrize(("mode", "expected"), [(0, (200, 200)), (1, (200, 400)), (2, (400, 200))])
def test_which_accelerations_are_weighted(mode: int, expected: tuple[int, int]) -> None:
    """P-CHAN-00001."""
    chosen, x = programmed(profile=1, acceleration=mode)
    weigh(chosen, "acceleration", 0.5)
    found = chosen.dynamics(x, Motion.FEED)
    assert (values_of(found.acceleration)[0], values_of(found.deceleration)[0]) == expected


def test_the_linear_slope_is_weighted_too_and_the_geometrical_time_only_on_curves() -> None:
    chosen, x = programmed()
    weigh(chosen, "acceleration", 0.5)
    weigh(chosen, "ramp_time", 0.5)
    plain = x.dynamics[Motion.FEED]
    found = chosen.dynamics(x, Motion.FEED)
    assert found == plain.weighted(Weights(acceleration=0.5, deceleration=0.5))
    assert found.acceleration.least_mm_s2 == plain.acceleration.least_mm_s2 / 2
    chosen.choose(canon.SlopeChoice(BLOCK, "TRAPEZ"))
    weigh(chosen, "contour_time", 4.0)
    contour = x.jerk_limited[TRAPEZ][Motion.FEED].contour_mm_s3
    assert contour == pytest.approx(400.0 / 0.199)
    assert chosen.dynamics(x, Motion.FEED).contour_mm_s3 == pytest.approx(contour / 4.0)


def test_an_axis_that_leaves_the_channel_loses_the_weight_of_its_ramp_times() -> None:
    chosen, x = programmed(profile=1)
    weigh(chosen, "ramp_time", 2.0)
    weigh(chosen, "acceleration", 0.5)
    chosen.forget_times("X")
    assert values_of(chosen.dynamics(x, Motion.FEED).acceleration) == slope(200, 196, 195)


@pytest.mark.parametrize("shape", [TRAPEZ, SIN2])
@pytest.mark.parametrize(
    ("weights", "a_mm_s2", "fall_s"),
    [
        (Weights(), 1000.0, 0.04),
        (Weights(acceleration=0.5), 500.0, 0.04),
        (Weights(fall=3.0), 1000.0, 0.12),
        (Weights(acceleration=0.5, deceleration=2.0, rise=5.0, fall=0.5), 500.0, 0.02),
        (Weights(brake_rise=4.0, brake_fall=4.0), 1000.0, 0.04),
    ],
)
def test_before_a_weighted_motion_brakes_its_acceleration_falls_with_the_weighted_jerk(
    shape: Shape, weights: Weights, a_mm_s2: float, fall_s: float
) -> None:
    """From 30 mm/s and the whole acceleration: it falls in its own weighted time, to 30 + a t/2.

    The ramps of the deceleration, 10 and 20 ms here, and their weights have no part in it.
    """
    up = JerkSlope(1000.0, 0.05, 0.04, shape)
    down = JerkSlope(800.0, 0.01, 0.02, shape).after(up)
    plain = Dynamics(up, down, down, 500.0, None, math.inf, 6000.0)
    weighted = plain.weighted(weights)
    state = State(0.0, 30.0, a_mm_s2)
    for course in (
        weighted.deceleration.stopped(state),
        weighted.acceleration.rest(state, 1000.0, 1.0, weighted.deceleration),
        weighted.deceleration.held(state, 1000.0, weighted.deceleration),
    ):
        after = course.state(fall_s)
        assert after.speed_mm_s == pytest.approx(30.0 + a_mm_s2 * fall_s / 2.0, rel=1e-9)
        assert course.state(0.999 * fall_s).a_mm_s2 > 0.0
        assert course.state(1.01 * fall_s).a_mm_s2 < 0.0


@pytest.mark.parametrize("shape", [TRAPEZ, SIN2])
@pytest.mark.parametrize(
    ("share", "weighted"), [(0.5, 750.0), (1.0, 1500.0), (1.25, 1500.0), (3.0, 1500.0)]
)
def test_no_weight_raises_an_acceleration_with_ramps_above_the_largest_one_nor_lowers_it_to_that(
    shape: Shape, share: float, weighted: float
) -> None:
    """P-AXIS-00008 = 1000: what a list has above it acts as it is; 300 is raised to it at most."""
    high, low = JerkSlope(1500.0, 0.05, 0.04, shape), JerkSlope(300.0, 0.02, 0.03, shape)
    for most, of_low in ((4.0, 1000.0), (2.0, 600.0)):
        up, down = high.weighted(low, Weights(acceleration=share, deceleration=most), 1000.0)
        assert (values_of(up)[0], values_of(down)[0]) == (weighted, of_low)
        up, down = low.weighted(high, Weights(acceleration=most, deceleration=share), 1000.0)
        assert (values_of(up)[0], values_of(down)[0]) == (of_low, weighted)
