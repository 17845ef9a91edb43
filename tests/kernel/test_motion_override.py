"""An override of the feed: the set speed follows within the acceleration, by closed forms."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.motion.curves import Arc, Line
from axisrig.kernel.motion.dynamics import Dynamics, arc_dynamics
from axisrig.kernel.motion.feed import Feed
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.profile import Slope, plan, plan_rest
from axisrig.kernel.time.clock import MS

UP, DOWN = Slope(1000.0, 1000.0, 1000.0), Slope(2000.0, 2000.0, 1000.0)
FASTEST, FEED, LENGTH, T = 80.0, 50.0, 100.0, 1e-3
DYNAMICS = Dynamics(UP, DOWN, DOWN, FASTEST)


class Led:
    """A straight path of 100 mm at 50 mm/s, 1000 mm/s² up and 2000 down; `run` gives overrides."""

    def __init__(self, share: float = 1.0, feed_mm_s: float = FEED) -> None:
        self.path = Interpolator("Z", MS)
        self.feed = Feed(feed_mm_s, DYNAMICS, share)
        self.path.follow(Line((0.0,), (LENGTH,)), plan(LENGTH, self.feed.speed_mm_s, UP, DOWN))
        self.travelled_mm = [0.0]
        self.speeds_mm_s = [0.0]

    def run(self, cycles: int, share: float | Callable[[int], float] = 1.0) -> float:
        for cycle in range(cycles):
            now = share if isinstance(share, float) else share(cycle)
            self.feed.lead(self.path, now, is_held=now == 0.0)
            self.path.advance()
            self.travelled_mm.append(self.path.path_travelled_mm)
            self.speeds_mm_s.append(self.path.speed_mm_s)
        return self.travelled_mm[-1]

    def run_out(self, share: float = 1.0) -> int:
        cycles = 0
        while not self.path.is_standing:
            self.run(1, share)
            cycles += 1
        return cycles


def test_100_percent_is_bit_by_bit_the_path_without_an_override() -> None:
    free, led = Interpolator("Z", MS), Led()
    free.follow(Line((0.0,), (LENGTH,)), plan(LENGTH, FEED, UP, DOWN))
    positions = [free.advance() for _ in range(2100)]
    led.run(2100)
    assert [(mm,) for mm in led.travelled_mm[1:]] == positions


def test_a_smaller_override_brakes_with_the_deceleration_of_the_path() -> None:
    """From 50 to 25 mm/s at 2000 mm/s²: 12.5 ms and (50² - 25²)/2d = 0.46875 mm."""
    led = Led()
    begin_mm = led.run(200)
    led.run(12, 0.5)
    assert led.speeds_mm_s[-1] == pytest.approx(50.0 - 2000 * 0.012, abs=1e-9)
    led.run(88, 0.5)
    assert led.speeds_mm_s[-1] == 25.0
    way_mm = (50.0**2 - 25.0**2) / 4000 + 25.0 * (0.1 - 0.0125)
    assert led.travelled_mm[-1] - begin_mm == pytest.approx(way_mm, abs=1e-9)
    led.run_out(0.5)
    assert led.path.positions_mm == (LENGTH,)


def test_a_larger_override_gains_speed_with_the_acceleration_up_to_what_the_axis_may() -> None:
    """From 50 to 80 mm/s, which is all that there is at 200 %: 30 ms and (80² - 50²)/2a."""
    led = Led()
    begin_mm = led.run(200)
    led.run(100, 2.0)
    assert max(led.speeds_mm_s) == FASTEST
    way_mm = (80.0**2 - 50.0**2) / 2000 + 80.0 * 0.07
    assert led.travelled_mm[-1] - begin_mm == pytest.approx(way_mm, abs=1e-9)
    led.run_out(2.0)
    assert led.path.positions_mm == (LENGTH,)


def test_a_path_that_begins_under_an_override_has_its_speed() -> None:
    """t = s/v + v/2a + v/2d at v = 10 mm/s."""
    led = Led(0.2)
    expected_s = LENGTH / 10 + 10 / 2000 + 10 / 4000
    assert led.run_out(0.2) == math.ceil(expected_s / T - 1e-9)
    assert max(led.speeds_mm_s) == 10.0


def test_behind_an_even_course_the_speed_is_that_of_the_override() -> None:
    """From 100 to 50 % within 100 ms: 0.25 mm/s in each cycle, no more than the path may do."""
    led = Led()
    led.run(200)
    led.run(101, lambda cycle: 1.0 - 0.5 * cycle / 100)
    expected = [50.0 - 0.25 * cycle for cycle in range(101)]
    assert led.speeds_mm_s[-101:] == pytest.approx(expected, abs=1e-9)


def test_a_course_that_is_steeper_than_the_ramp_is_followed_by_the_ramp() -> None:
    led = Led()
    led.run(200)
    led.run(6, lambda cycle: 1.0 - 0.18 * cycle)
    assert led.speeds_mm_s[-5:] == pytest.approx([50.0 - 2.0 * k for k in range(1, 6)], abs=1e-9)


def test_in_the_ramp_into_the_end_only_a_smaller_override_counts_that_the_ramp_has_above_it() -> (
    None
):
    """With 2 mm/s left in the last ms no override changes anything."""
    free, led = Led(), Led()
    cycles = free.run_out()
    led.run(cycles - 2)
    led.run_out(0.5)
    assert led.travelled_mm == pytest.approx(free.travelled_mm, abs=1e-9)


def test_a_stop_deletes_the_distance_to_go_whatever_the_override_does() -> None:
    led = Led()
    led.run(200)
    led.path.brake(DOWN)
    end_mm = led.travelled_mm[-1] + 50.0**2 / 4000
    led.run(10, 0.1)
    led.run(30, 2.0)
    assert led.path.is_standing
    assert led.travelled_mm[-1] == pytest.approx(end_mm, abs=1e-9)


def test_both_steps_of_a_slope_act_on_the_way_down() -> None:
    """Above 20 mm/s with 500, below with 1000 mm/s²: from 50 to 10 in 60 and 10 ms."""
    steps = Slope(1000.0, 500.0, 20.0)
    rest = plan_rest(0.0, LENGTH, 10.0, UP, steps, 50.0)
    assert rest.at(0.060) == pytest.approx(((50**2 - 20**2) / 1000, 20.0))
    assert rest.at(0.070) == pytest.approx(((50**2 - 20**2) / 1000 + (20**2 - 10**2) / 2000, 10.0))
    assert rest.at(rest.duration_s) == (LENGTH, 0.0)


def test_a_hold_that_is_let_go_too_near_the_end_brakes_no_harder_than_it_did() -> None:
    """A hold with 2000 mm/s2 that ends while 40 mm/s need 1.6 mm with 500, and 0.5 mm are left.

    40²/(2 x 0.5) = 1600 mm/s2; the path stood for 36 ms and went on as if nothing had been.
    """
    weak, hold = Slope(500.0, 500.0, 1000.0), Slope(2000.0, 2000.0, 1000.0)
    assert hold.distance_mm(40.0) < 0.5 < weak.distance_mm(40.0)
    rest = plan_rest(10.0, 10.5, FEED, UP, weak, 40.0)
    assert rest.duration_s == pytest.approx(2.0 * 0.5 / 40.0)
    assert rest.at(0.0) == (10.0, 40.0)
    assert rest.at(0.0125) == pytest.approx((10.375, 20.0))
    assert rest.at(rest.duration_s) == (10.5, 0.0)


@given(
    st.lists(
        st.tuples(st.integers(1, 60), st.sampled_from([0.0, 0.01, 0.3, 0.5, 0.99, 1.0, 1.4, 2.0])),
        max_size=12,
    )
)
@pytest.mark.long
def test_no_course_of_an_override_exceeds_speed_or_acceleration(
    course: Sequence[tuple[int, float]],
) -> None:
    led = Led()
    for cycles, share in course:
        led.run(cycles, share)
    led.run_out()
    assert led.path.positions_mm == (LENGTH,)
    assert max(led.speeds_mm_s) <= FASTEST
    for before, after in pairwise(led.speeds_mm_s):
        assert -2000 * T - 1e-9 <= after - before <= 1000 * T + 1e-9
    ways = [after - before for before, after in pairwise(led.travelled_mm)]
    assert min(ways) >= 0.0
    for before, after in pairwise(ways):
        assert -2000 * T * T - 1e-9 <= after - before <= 1000 * T * T + 1e-9


def test_an_arc_keeps_the_axes_within_their_acceleration_at_the_largest_override() -> None:
    """At twice the feed the ramps get what the centripetal part leaves: dynamics planned for it."""
    arc = Arc((0.0, 0.0), (0.0, 0.0), (20.0, 0.0), (0.0, 1.0), 2 * math.pi)
    axes = [Dynamics(UP, UP, UP, 500.0)] * 2
    dynamics = arc_dynamics(axes, arc, 2 * 50.0)
    feed = Feed(50.0, dynamics)
    path = Interpolator("XY", MS)
    profile = plan(arc.length_mm, 50.0, dynamics.acceleration, dynamics.deceleration)
    path.follow(arc, profile)
    places = [path.positions_mm]
    while not path.is_standing:
        feed.lead(path, 2.0 if len(places) % 400 < 200 else 0.5, is_held=False)
        places.append(path.advance())
    assert max(math.dist(a, b) for a, b in pairwise(places)) / T == pytest.approx(100.0, abs=0.1)
    for axis in range(2):
        ways = [b[axis] - a[axis] for a, b in pairwise(places)]
        assert max(abs(b - a) for a, b in pairwise(ways)) <= 1000.0 * T * T * (1 + 1e-6)
