"""Slow, short, negative and mixed motions: each is what its formula says, and none is special."""

import math

import pytest

from axisrig.kernel.motion.curves import Arc, Line, moved_axes
from axisrig.kernel.motion.dynamics import Dynamics, arc_dynamics, path_dynamics
from axisrig.kernel.motion.feed import Feed
from axisrig.kernel.motion.guard import AxisLimits, SetpointGuard
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope, plan, plan_rest
from axisrig.kernel.motion.ramp import Ramp
from axisrig.kernel.motion.timed import speed_for
from axisrig.kernel.time.clock import MS

T_S = 1e-3


def flat(a_mm_s2: float) -> Slope:
    return Slope(a_mm_s2, a_mm_s2, 1e6)


@pytest.mark.parametrize("left_mm", [1.2, 0.75, 0.1])
def test_what_cannot_stop_any_more_brakes_evenly_into_its_end(left_mm: float) -> None:
    """50 mm/s and 1000 mm/s² take 1.25 mm: v²/2s, of a harder hold that was let go so late."""
    path = plan_rest(3.0, 3.0 + left_mm, 80.0, flat(1000.0), flat(1000.0), 50.0)
    a = 50.0**2 / (2.0 * left_mm)
    assert path.duration_s == pytest.approx(50.0 / a)
    for share in (0.0, 0.3, 0.7):
        t_s = share * path.duration_s
        assert path.at(t_s) == pytest.approx((3.0 + 50.0 * t_s - 0.5 * a * t_s**2, 50.0 - a * t_s))
    assert path.at(path.duration_s) == (3.0 + left_mm, 0.0)


def test_a_path_without_a_rest_is_at_its_end() -> None:
    path = plan_rest(5.0, 5.0, 80.0, flat(1000.0), flat(1000.0), 0.0)
    assert (path.start_mm, path.end_mm, path.duration_s) == (5.0, 5.0, 0.0)
    assert path.at(0.0) == (5.0, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_axes_that_a_line_moves_in_either_direction_are_moved(sign: float) -> None:
    assert moved_axes(Line((1.0, 2.0, 3.0), (1.0, 2.0 + sign, 3.0))) == {1}
    assert moved_axes(Line((1.0, 2.0, 3.0), (1.0 - sign, 2.0 + sign, 3.0))) == {0, 1}
    assert moved_axes(Line((1.0,), (1.0,))) == frozenset()


@pytest.mark.parametrize("skew", [0.1, -0.1])
def test_a_tangent_that_is_not_at_right_angles_is_refused_on_either_side(skew: float) -> None:
    tangent = (skew, math.sqrt(1.0 - skew * skew))
    with pytest.raises(ValueError, match="right angles"):
        Arc((1.0, 0.0), (0.0, 1.0), (0.0, 0.0), tangent, math.pi / 2)


@pytest.mark.parametrize("velocity_mm_s", [0.5, -0.5, 0.01, 30.0])
def test_an_axis_that_stops_by_itself_brakes_however_slow_it_is(velocity_mm_s: float) -> None:
    """v²/2a in the time v/a, with 10 mm/s²; then it stands."""
    ramp = Ramp(7.0, velocity_mm_s, flat(10.0), MS)
    assert not ramp.is_standing
    places = [ramp.advance() for _ in range(int(abs(velocity_mm_s) / 10.0 / T_S) + 2)]
    way_mm = math.copysign(velocity_mm_s**2 / 20.0, velocity_mm_s)
    assert places[-1] == pytest.approx(7.0 + way_mm, abs=1e-12)
    assert ramp.is_standing
    assert [ramp.advance() for _ in range(3)] == [places[-1]] * 3


@pytest.mark.parametrize(("up", "down"), [(1000.0, 250.0), (250.0, 1000.0)])
@pytest.mark.parametrize("over_s", [-0.001, 0.0, 0.001, 0.5])
def test_a_time_is_kept_with_both_ramps(up: float, down: float, over_s: float) -> None:
    """At the fastest 100 mm/s, 60 mm take 60/v + v/2 (1/up + 1/down)."""
    slopes = flat(up), flat(down)
    half = 0.5 * (1.0 / up + 1.0 / down)
    least_s = 0.6 + 100.0 * half
    speed = speed_for(60.0, least_s + over_s, *slopes, 100.0)
    if over_s <= 0.0:
        assert speed == 100.0
        return
    assert 60.0 / speed + speed * half == pytest.approx(least_s + over_s, rel=1e-12)
    assert speed < 100.0


@pytest.mark.parametrize("shape", Shape)
def test_a_hold_that_goes_on_brakes_once(shape: Shape) -> None:
    """In every cycle it is held; the way is v²/2a + v t/2, as of one plan."""
    slope = JerkSlope(1000.0, 0.04, 0.04, shape)
    path = Interpolator("Z", MS)
    path.follow(Line((0.0,), (100.0,)), slope.plan(100.0, 50.0, slope))
    feed = Feed(50.0, Dynamics(slope, slope, slope, 100.0))
    for _ in range(300):
        feed.lead(path, 1.0, is_held=False)
        path.advance()
    begin_mm = path.path_travelled_mm
    steps = []
    for _ in range(100):
        feed.lead(path, 1.0, is_held=True)
        before_mm = path.path_travelled_mm
        path.advance()
        steps.append(path.path_travelled_mm - before_mm)
    assert path.path_travelled_mm - begin_mm == pytest.approx(50.0**2 / 2000.0 + 1.0, abs=1e-9)
    assert steps[90:] == [0.0] * 10  # v/a + t
    assert min(steps[:90]) > 0.0


def test_an_axis_that_is_led_beside_a_path_that_is_held_leaves_the_path_as_it_is() -> None:
    """It stands on its way and has not ended; X goes on to its end after the hold."""
    path = Interpolator("XY", MS)
    path.follow(Line((0.0, 5.0), (10.0, 5.0)), plan(10.0, 50.0, flat(1000.0), flat(1000.0)))
    for _ in range(60):
        path.advance()
    path.feedhold(flat(1000.0), flat(1000.0))
    for _ in range(60):
        path.advance()
    held_mm = path.positions_mm[0]
    assert 0.0 < held_mm < 9.0
    path.lead(1, 7.5)
    assert path.positions_mm == (held_mm, 7.5)
    path.go_on(50.0, flat(1000.0), flat(1000.0))
    for _ in range(400):
        path.advance()
    assert path.is_standing
    assert path.positions_mm == (10.0, 7.5)


@pytest.mark.parametrize("off_mm", [0.01, -0.01])
def test_a_profile_that_is_longer_or_shorter_than_its_path_is_refused(off_mm: float) -> None:
    path = Interpolator("Z", MS)
    with pytest.raises(ValueError, match="profile of"):
        path.follow(Line((0.0,), (5.0,)), plan(5.0 + off_mm, 10.0, flat(100.0), flat(100.0)))
    path.follow(Line((0.0,), (5.0,)), plan(5.0, 10.0, flat(100.0), flat(100.0)))


@pytest.mark.parametrize("with_hold", ["X", "Y", "XY", ""])
def test_an_axis_without_a_feedhold_of_its_own_holds_with_its_deceleration(with_hold: str) -> None:
    """Along 3-4-5: limits over 0.6 and 0.8; the smaller one counts."""
    hold = {"X": 120.0, "Y": 90.0}
    brakes = {"X": 60.0, "Y": 80.0}
    axes = [
        Dynamics(
            flat(1000.0), flat(brakes[name]), flat(500.0), 100.0,
            flat(hold[name]) if name in with_hold else None,
        )
        for name in "XY"
    ]  # fmt: skip
    found = path_dynamics(axes, (3.0, 4.0)).feedhold
    if not with_hold:
        assert found is None
        return
    assert found is not None
    per_axis = {name: hold[name] if name in with_hold else brakes[name] for name in "XY"}
    expected = min(per_axis["X"] / 0.6, per_axis["Y"] / 0.8)
    assert found.least_mm_s2 == pytest.approx(expected)


@pytest.mark.parametrize("rise_mm", [0.0, 3.0, -3.0, 8.0])
def test_an_axis_of_an_arc_that_also_goes_along_keeps_to_its_acceleration(rise_mm: float) -> None:
    """sqrt((u k A)² + (v² k² A)²) + u |g| is the limit of the weakest axis, at u along the path."""
    arc = Arc((10.0, 0.0), (-10.0 + rise_mm, 0.0), (0.0, 0.0), (0.0, 1.0), math.pi)
    weak, strong = (Dynamics(flat(a), flat(a), flat(a), 1e6) for a in (500.0, 1e9))
    feed_mm_s = 50.0
    u = arc_dynamics([weak, strong], arc, feed_mm_s).acceleration.least_mm_s2
    k, climb = math.pi / arc.length_mm, abs(rise_mm) / arc.length_mm
    reached = math.hypot(u * k * 10.0, feed_mm_s**2 * k * k * 10.0) + u * climb
    assert reached == pytest.approx(500.0, rel=1e-9)


def test_the_guard_names_each_axis_with_its_speed_and_acceleration() -> None:
    """1 mm in a cycle of 2 ms from rest: 500 mm/s and 250000 mm/s²; -0.5 mm is half of it back."""
    limits = [AxisLimits(n, v, a, 0.001) for n, v, a in (("X", 100.0, 1e3), ("Y", 200.0, 2e3))]
    guard = SetpointGuard([*limits, AxisLimits("Z", 1e6, 1e9, 0.001)], 2 * MS)
    guard.put_all((1.0, 2.0, 3.0))
    alarm = guard.judge((2.0, 1.5, 4.0))
    assert alarm is not None
    assert alarm.values["axis"] == "X Y"
    assert alarm.values["what"] == (
        "X 500 mm/s, 250000 mm/s2 with 100 mm/s and 1000 mm/s2 allowed; "
        "Y -250 mm/s, -125000 mm/s2 with 200 mm/s and 2000 mm/s2 allowed"
    )
    assert guard.judge((1.0, 2.0, 3.0)) is None  # the last legal ones go on counting
