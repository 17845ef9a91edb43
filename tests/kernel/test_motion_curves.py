"""Arcs: points against the analytic circle, limits of the axes against samples of the motion."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.motion.curves import Arc, Line, moved_axes, swing
from axisrig.kernel.motion.dynamics import Dynamics, arc_dynamics
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.profile import Slope, plan
from axisrig.kernel.time.clock import MS

NM = 1e-6


def in_plane(radius: float, begin: float, angle: float, sign: float, height: float = 0.0) -> Arc:
    """An arc in X and Y around (3, -7), seen from +Z; Z climbs along."""
    end = begin + sign * angle
    return Arc(
        start_mm=(3.0 + radius * math.cos(begin), -7.0 + radius * math.sin(begin), 2.0),
        end_mm=(3.0 + radius * math.cos(end), -7.0 + radius * math.sin(end), 2.0 + height),
        centre_mm=(3.0, -7.0, 2.0),
        tangent=(-sign * math.sin(begin), sign * math.cos(begin), 0.0),
        angle_rad=angle,
    )


# Radii of parts and of nearly straight arcs, angles up to several turns
radii = st.floats(0.01, 1e4)
angles = st.floats(0.01, 20.0)
begins = st.floats(-math.pi, math.pi)
signs = st.sampled_from([1.0, -1.0])


def test_quarter_circle_by_hand() -> None:
    """From (10, 0) counter-clockwise to (0, 10); after a third of the way at 30 degrees."""
    arc = Arc((10.0, 0.0), (0.0, 10.0), (0.0, 0.0), (0.0, 1.0), math.pi / 2)
    assert arc.length_mm == pytest.approx(5 * math.pi, abs=1e-12)
    assert arc.at(arc.length_mm / 3) == pytest.approx((math.sqrt(75.0), 5.0), abs=1e-12)
    assert arc.at(0.0) == (10.0, 0.0)
    assert arc.at(arc.length_mm) == pytest.approx((0.0, 10.0), abs=1e-12)


def test_full_circle_comes_back() -> None:
    arc = Arc((10.0, 0.0), (10.0, 0.0), (0.0, 0.0), (0.0, -1.0), math.tau)
    assert arc.length_mm == pytest.approx(20 * math.pi)
    assert arc.at(arc.length_mm / 4) == pytest.approx((0.0, -10.0), abs=1e-12)
    assert arc.at(arc.length_mm * 3 / 4) == pytest.approx((0.0, 10.0), abs=1e-12)


@given(radii, begins, angles, signs)
@pytest.mark.long
def test_every_point_lies_on_the_circle_and_steps_are_equal(
    radius: float, begin: float, angle: float, sign: float
) -> None:
    arc = in_plane(radius, begin, angle, sign)
    points = [arc.at(arc.length_mm * k / 100) for k in range(101)]
    for x, y, z in points:
        assert math.hypot(x - 3.0, y + 7.0) == pytest.approx(radius, abs=NM)
        assert z == 2.0
    # A chord of the angle w is 2 r sin(w/2) long.
    chord = 2 * radius * math.sin(angle / 200)
    assert [math.dist(a, b) for a, b in pairwise(points)] == pytest.approx([chord] * 100, abs=NM)
    assert points[-1] == pytest.approx(arc.end_mm, abs=NM)


def test_helix_climbs_in_proportion_to_the_angle() -> None:
    """Half a turn of radius 4 that climbs 3 pi: 5 pi long."""
    arc = in_plane(4.0, 0.0, math.pi, 1.0, 3 * math.pi)
    assert arc.length_mm == pytest.approx(5 * math.pi)
    x, y, z = arc.at(arc.length_mm / 2)
    assert (x, y, z) == pytest.approx((3.0, -3.0, 2.0 + 1.5 * math.pi))


def test_circle_in_an_inclined_plane() -> None:
    """Around the diagonal of the cube: every point is as far from the centre, and in the plane."""
    radius = math.sqrt(6.0)
    start, tangent = (2.0, -1.0, -1.0), (0.0, 1 / math.sqrt(2), -1 / math.sqrt(2))
    arc = Arc(start, start, (0.0, 0.0, 0.0), tangent, math.tau)
    for k in range(50):
        point = arc.at(arc.length_mm * k / 50)
        assert math.hypot(*point) == pytest.approx(radius, abs=1e-12)
        assert sum(point) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("tangent", "angle", "message"),
    [
        ((0.0, 1.0), 0.0, "no arc"),
        ((0.0, 1.0), -1.0, "no arc"),
        ((0.0, 0.5), 1.0, "no unit vector"),
        ((0.6, 0.8), 1.0, "right angles"),
    ],
)
def test_what_is_no_arc(tangent: tuple[float, float], angle: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Arc((1.0, 0.0), (0.0, 1.0), (0.0, 0.0), tangent, angle)


@pytest.mark.long
@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(0.01, 20))
def test_swing_bounds_every_sample(cosine: float, sine: float, angle: float) -> None:
    samples = [cosine * math.cos(t) + sine * math.sin(t) for t in _range(angle)]
    low, high = swing(cosine, sine, angle)
    assert low <= min(samples) + 1e-9
    assert high >= max(samples) - 1e-9
    finest = math.hypot(cosine, sine) * (angle / 2000) ** 2
    assert low >= min(samples) - finest - 1e-9
    assert high <= max(samples) + finest + 1e-9


def _range(angle: float) -> list[float]:
    return [angle * k / 2000 for k in range(2001)]


@pytest.mark.long
@given(radii, begins, angles, signs, st.floats(-50, 50))
def test_box_holds_the_path(
    radius: float, begin: float, angle: float, sign: float, height: float
) -> None:
    arc = in_plane(radius, begin, angle, sign, height)
    low, high = arc.box_mm()
    for k in range(101):
        for below, at, above in zip(low, arc.at(arc.length_mm * k / 100), high, strict=True):
            assert below - NM <= at <= above + NM


@pytest.mark.parametrize("height", [4.0, -4.0, 0.0])
@pytest.mark.parametrize(
    ("begin_deg", "sign", "x", "y"),
    [
        (0.0, 1.0, (0.0, 10.0), (0.0, 10.0)),
        (0.0, -1.0, (0.0, 10.0), (-10.0, 0.0)),
        (180.0, 1.0, (-10.0, 0.0), (-10.0, 0.0)),
        (45.0, 1.0, (-10.0 / math.sqrt(2.0), 10.0 / math.sqrt(2.0)), (10.0 / math.sqrt(2.0), 10.0)),
        (
            -45.0,
            1.0,
            (10.0 / math.sqrt(2.0), 10.0),
            (-10.0 / math.sqrt(2.0), 10.0 / math.sqrt(2.0)),
        ),
    ],
)
def test_box_of_a_quarter_of_a_helix_is_no_larger_than_its_path(
    height: float, begin_deg: float, sign: float, x: tuple[float, ...], y: tuple[float, ...]
) -> None:
    """Radius 10 about (3, -7), from Z 2 up or down: a target beyond a switch would be refused."""
    low, high = in_plane(10.0, math.radians(begin_deg), math.pi / 2.0, sign, height).box_mm()
    z = sorted((2.0, 2.0 + height))
    assert low == pytest.approx((3.0 + x[0], -7.0 + y[0], z[0]), abs=NM)
    assert high == pytest.approx((3.0 + x[1], -7.0 + y[1], z[1]), abs=NM)


# --- what the axes allow ---------------------------------------------------------------------


def axis(speed: float, up: float, down: float | None = None, stop: float | None = None) -> Dynamics:
    slopes = [Slope(a, a, speed) for a in (up, down or up, stop or up)]
    return Dynamics(*slopes, speed)


def test_speed_in_a_small_circle_is_limited_by_the_centripetal_acceleration() -> None:
    """r = 5 mm, 1000 mm/s²: v² / r = 1000 / sqrt 2, so that 707 mm/s² are left for the ramps."""
    arc = in_plane(5.0, 0.3, math.tau, 1.0)
    found = arc_dynamics([axis(500.0, 1000.0)] * 3, arc)
    assert found.speed_max_mm_s == pytest.approx(math.sqrt(5 * 1000 / math.sqrt(2)))
    assert found.acceleration.a_low_mm_s2 == pytest.approx(1000 / math.sqrt(2))


@pytest.mark.parametrize("steps", [(1000.0, 250.0), (250.0, 1000.0)])
def test_of_a_slope_with_two_steps_the_smaller_one_counts_on_an_arc(
    steps: tuple[float, float],
) -> None:
    """r = 5 mm, 250 mm/s² of both: v² / r = 250 / sqrt 2."""
    slope = Slope(*steps, 50.0)
    found = arc_dynamics(
        [Dynamics(slope, slope, slope, 500.0)] * 3, in_plane(5.0, 0.3, math.tau, 1.0)
    )
    assert found.speed_max_mm_s == pytest.approx(math.sqrt(5 * 250 / math.sqrt(2)))


def test_slow_feed_leaves_nearly_all_acceleration_for_the_ramps() -> None:
    """v = 10 mm/s on r = 50 mm takes 2 mm/s²: sqrt(1000² - 2²) are left."""
    arc = in_plane(50.0, 0.3, math.tau, 1.0)
    found = arc_dynamics([axis(500.0, 1000.0)] * 3, arc, 10.0)
    assert found.acceleration.a_low_mm_s2 == pytest.approx(math.sqrt(1000.0**2 - 2.0**2))


def test_axis_that_hardly_moves_hardly_limits() -> None:
    """A degree of arc along X: Y, ten times slower, gets to sin 1 degree of the path speed."""
    arc = in_plane(1e4, -math.pi / 2, math.radians(1.0), 1.0)
    found = arc_dynamics([axis(100.0, 1000.0), axis(10.0, 1000.0), axis(1.0, 1.0)], arc)
    assert found.speed_max_mm_s == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("begin_deg", "sign", "shares"),
    [
        (0.0, 1.0, (0.5, 1.0)),  # X turns at the begin of the arc, Y is fastest there
        (0.0, -1.0, (0.5, 1.0)),
        (90.0, 1.0, (1.0, 0.5)),
        (180.0, -1.0, (0.5, 1.0)),
        (60.0, 1.0, (1.0, 0.5)),  # it ends where X is fastest
        (75.0, 1.0, (1.0, math.cos(math.radians(75.0)))),  # X is fastest in the middle
    ],
)
@pytest.mark.parametrize("height", [0.0, 4.0, -4.0])
def test_each_axis_limits_an_arc_by_its_share_at_its_fastest_place(
    begin_deg: float, sign: float, shares: tuple[float, float], height: float
) -> None:
    """30 degrees, 3 mm long in its plane: 3/5 of the shares are left where Z climbs by 4 mm."""
    angle = math.pi / 6.0
    arc = in_plane(3.0 / angle, math.radians(begin_deg), angle, sign, height)
    flat, climb = (0.6, 0.8) if height else (1.0, 0.0)
    for moved, share in ((0, flat * shares[0]), (1, flat * shares[1]), (2, climb)):
        speeds = [10.0 if at == moved else 1e4 for at in range(3)]
        found = arc_dynamics([axis(speed, 1e12) for speed in speeds], arc).speed_max_mm_s
        expected = [1e4 / (flat * max(shares)), 1e4 / climb if climb else math.inf]
        expected.append(10.0 / share if share else math.inf)
        assert found == pytest.approx(min(expected), rel=1e-9), moved


def test_each_slope_of_an_arc_has_the_axis_that_decides_it() -> None:
    """A turn with shares of 0.6, 0.6 and 0.8, so slowly that nothing goes into the curve.

    Y has no feedhold of its own: its deceleration counts there.
    """
    slopes = ((600.0, 900.0, 660.0, 780.0), (720.0, 630.0, 690.0, None), (960.0, 920.0, 760.0, 1e3))
    axes = [
        Dynamics(
            *[Slope(a, a, 50.0) for a in (up, down, stop)],
            400.0,
            None if hold is None else Slope(hold, hold, 50.0),
        )
        for up, down, stop, hold in slopes
    ]
    arc = in_plane(3.0 / math.tau, 0.3, math.tau, 1.0, 4.0)
    found = arc_dynamics(axes, arc, 1e-3)
    assert found.feedhold is not None
    expected = (600.0 / 0.6, 630.0 / 0.6, 760.0 / 0.8, 630.0 / 0.6)
    of_path = (found.acceleration, found.deceleration, found.stop_deceleration, found.feedhold)
    for one, a_mm_s2 in zip(of_path, expected, strict=True):
        assert (one.least_mm_s2, one.most_mm_s2) == pytest.approx((a_mm_s2, a_mm_s2), rel=1e-9)


@pytest.mark.parametrize("slowest", [0, 1, 2])
def test_the_least_jerk_of_the_axes_is_that_of_an_arc(slowest: int) -> None:
    """a/t of an axis by its share; Y and Z with other ramps up and down than X."""
    ramps = [(0.01, 0.02), (0.02, 0.01), (0.015, 0.005)]
    ramps[slowest] = (0.2, 0.4)
    axes = [Dynamics(*[JerkSlope(1200.0, *each)] * 3, 400.0) for each in ramps]
    found = arc_dynamics(axes, in_plane(3.0 / math.tau, 0.3, math.tau, 1.0, 4.0), 1e-3).acceleration
    assert isinstance(found, JerkSlope)
    share = (0.6, 0.6, 0.8)[slowest]
    assert found.a_mm_s2 == pytest.approx(1200.0 / 0.8)
    assert found.a_mm_s2 / found.rise_s == pytest.approx(1200.0 / 0.2 / share)
    assert found.a_mm_s2 / found.fall_s == pytest.approx(1200.0 / 0.4 / share)


AXES = st.builds(axis, st.floats(5, 500), *[st.floats(100, 5000)] * 3)


@pytest.mark.long
@given(
    st.lists(AXES, min_size=3, max_size=3),
    st.floats(0.5, 500.0),
    begins,
    angles,
    signs,
    st.floats(-20.0, 20.0),
    st.floats(1.0, 400.0),
)
def test_no_axis_exceeds_what_it_may_anywhere(
    axes: list[Dynamics],
    radius: float,
    begin: float,
    angle: float,
    sign: float,
    height: float,
    feed: float,
) -> None:
    """Speed and acceleration of each axis by the chain rule, sampled over ramp, cruise and ramp."""
    arc = in_plane(radius, begin, angle, sign, height)
    path = arc_dynamics(axes, arc, feed)
    profile = plan(
        arc.length_mm, min(feed, path.speed_max_mm_s), path.acceleration, path.deceleration
    )
    for segment in profile.segments:
        for k in range(21):
            t = segment.start_s + (segment.end_s - segment.start_s) * k / 20
            travelled, v = profile.at(t)
            speeds, accelerations = _derived(
                radius, begin, angle, sign, height, travelled, v, segment.a_mm_s2
            )
            for one, v_axis, a_axis in zip(axes, speeds, accelerations, strict=True):
                allowed = one.acceleration if segment.a_mm_s2 >= 0 else one.deceleration
                assert abs(v_axis) <= one.speed_max_mm_s * (1 + 1e-9)
                assert abs(a_axis) <= allowed.a_low_mm_s2 * (1 + 1e-9)


def _derived(
    radius: float,
    begin: float,
    angle: float,
    sign: float,
    height: float,
    travelled: float,
    v: float,
    a: float,
) -> tuple[list[float], list[float]]:
    """Speed and acceleration of X, Y, Z at a point: d/dt of r cos(begin + sign k s) and so on."""
    length = math.hypot(radius * angle, height)
    k = angle / length
    at = begin + sign * k * travelled
    first = [-sign * k * radius * math.sin(at), sign * k * radius * math.cos(at), height / length]
    second = [-k * k * radius * math.cos(at), -k * k * radius * math.sin(at), 0.0]
    return [d * v for d in first], [d * a + dd * v * v for d, dd in zip(first, second, strict=True)]


@given(st.lists(AXES, min_size=3, max_size=3), radii, begins, angles, signs, st.floats(1.0, 400.0))
@pytest.mark.long
def test_a_stop_on_the_arc_keeps_to_the_stop_deceleration(
    axes: list[Dynamics], radius: float, begin: float, angle: float, sign: float, feed: float
) -> None:
    arc = in_plane(radius, begin, angle, sign)
    path = arc_dynamics(axes, arc, feed)
    v = min(feed, path.speed_max_mm_s)
    for k in range(41):
        _, accelerations = _derived(
            radius, begin, angle, sign, 0.0, arc.length_mm * k / 40, v,
            -path.stop_deceleration.a_low_mm_s2,
        )  # fmt: skip
        for one, a_axis in zip(axes, accelerations, strict=True):
            assert abs(a_axis) <= one.stop_deceleration.a_low_mm_s2 * (1 + 1e-9)


# --- executed --------------------------------------------------------------------------------


def executed(arc: Arc, feed: float, brake_after: int | None = None) -> Interpolator:
    interpolator = Interpolator("XYZ", MS)
    slope = Slope(1000.0, 1000.0, 1000.0)
    interpolator.hold(arc.start_mm)
    interpolator.follow(arc, plan(arc.length_mm, feed, slope, slope))
    for _ in range(brake_after or 0):
        interpolator.advance()
    if brake_after:
        interpolator.brake(slope)
    return interpolator


def course(interpolator: Interpolator) -> list[tuple[float, ...]]:
    points = []
    while not interpolator.is_standing:
        points.append(interpolator.advance())
    return points


@pytest.mark.long
def test_set_positions_lie_on_the_circle_at_constant_speed_and_end_at_the_target() -> None:
    """r = 50 mm at 2 m/min: 9.4 s of circle, chords of 33.3 um in the cruise."""
    arc = in_plane(50.0, 1.0, math.tau, -1.0)
    points = course(executed(arc, 2000.0 / 60.0))
    assert points[-1] == arc.end_mm
    for x, y, _ in points:
        assert math.hypot(x - 3.0, y + 7.0) == pytest.approx(50.0, abs=NM)
    ramp_cycles = 34  # 33.3 mm/s at 1000 mm/s²
    cruise = points[ramp_cycles : -ramp_cycles - 1]  # the ramp begins within a cycle
    chord = 2 * 50.0 * math.sin(2000.0 / 60.0 * 0.001 / 50.0 / 2)
    assert [math.dist(a, b) for a, b in pairwise(cruise)] == pytest.approx(
        [chord] * (len(cruise) - 1), abs=1e-9
    )
    assert len(points) == math.ceil(1000 * (50 * math.tau / (2000 / 60) + 2000 / 60 / 1000))


def test_braking_stays_on_the_circle() -> None:
    """50 mm/s at 1000 mm/s²: the way of the stop is 1.25 mm of arc."""
    arc = in_plane(20.0, 0.0, math.tau, 1.0)
    interpolator = executed(arc, 50.0, brake_after=700)
    at_brake_mm = interpolator.path_travelled_mm
    points = course(interpolator)
    assert interpolator.path_travelled_mm == pytest.approx(at_brake_mm + 1.25)
    for x, y, _ in points:
        assert math.hypot(x - 3.0, y + 7.0) == pytest.approx(20.0, abs=NM)
    assert points[-1] == pytest.approx(arc.at(at_brake_mm + 1.25), abs=NM)


def test_a_line_goes_on_behind_its_end() -> None:
    line = Line((0.0, 1.0), (3.0, 5.0))
    assert line.length_mm == 5.0
    assert line.at(10.0) == pytest.approx((6.0, 9.0))


def test_an_axis_beside_the_path_stays_where_it_is_put() -> None:
    arc = in_plane(20.0, 0.0, math.pi, 1.0)
    for path in (arc, Line((0.0, 1.0, 2.0), (3.0, 5.0, 2.0))):
        moved = path.with_axis(2, 9.0)
        assert moved.length_mm == pytest.approx(path.length_mm)
        x, y, z = moved.at(1.5)
        assert (x, y) == pytest.approx(path.at(1.5)[:2])
        assert z == moved.end_mm[2] == 9.0


@pytest.mark.parametrize(
    ("curve", "moved"),
    [
        (Line((0.0, 1.0, 2.0), (0.0, 1.0, 2.5)), {2}),
        (Line((0.0, 1.0, 2.0), (0.0, 1.0, 2.0)), set()),
        # A full circle from a place where one axis is at its turn and the other one fastest
        (in_plane(5.0, 0.0, math.tau, 1.0), {0, 1}),
        (in_plane(5.0, math.pi / 2, math.tau, -1.0), {0, 1}),
        (in_plane(5.0, 0.3, 2.0 * math.tau, 1.0, height=4.0), {0, 1, 2}),
        (in_plane(5.0, 0.0, math.pi, 1.0), {0, 1}),  # Y ends where it began
    ],
)
def test_an_axis_that_comes_back_on_a_curve_has_moved(curve: Line | Arc, moved: set[int]) -> None:
    assert moved_axes(curve) == moved
