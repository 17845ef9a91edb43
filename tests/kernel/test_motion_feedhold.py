"""Feedhold of a path: it stops on it and goes on along it to the same end, by closed forms."""

import math
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.motion.course import Ramp, State
from axisrig.kernel.motion.curves import Arc, Line
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.feed import Feed
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope, plan
from axisrig.kernel.time.clock import MS

OWN, WEAK = Slope(1000.0, 1000.0, 1000.0), Slope(500.0, 500.0, 1000.0)
LENGTH_MM, FEED_MM_S = 100.0, 50.0


class Held:
    """A straight path of 100 mm at 50 mm/s and 1000 mm/s²; one cycle per `run`, held or not."""

    def __init__(self, slope: Slope = WEAK, length_mm: float = LENGTH_MM) -> None:
        self.path, self.slope = Interpolator("Z", MS), slope
        profile = plan(length_mm, FEED_MM_S, OWN, OWN)
        self.path.follow(Line((0.0,), (length_mm,)), profile)
        self.travelled_mm = [0.0]

    def run(self, cycles: int) -> float:
        for _ in range(cycles):
            self.path.advance()
            self.travelled_mm.append(self.path.path_travelled_mm)
        return self.travelled_mm[-1]

    def hold(self) -> None:
        self.path.is_held = True
        self.path.feedhold(self.slope, OWN)

    def release(self) -> None:
        self.path.is_held = False
        self.path.go_on(FEED_MM_S, OWN, OWN)

    def run_out(self) -> int:
        cycles = 0
        while not self.path.is_standing and cycles < 10_000:
            self.run(1)
            cycles += 1
        return cycles


def test_at_constant_speed_it_stops_by_the_feedhold_ramp_and_goes_on_to_the_end() -> None:
    """After 0.2 s 8.75 mm at 50 mm/s; v²/2a = 2.5 mm and v/a = 0.1 s; then 88.75 mm from rest."""
    held = Held()
    assert held.run(200) == pytest.approx(8.75, abs=1e-12)
    held.hold()
    assert held.run(50) == pytest.approx(8.75 + 50 * 0.05 - 250 * 0.05**2, abs=1e-12)
    assert held.run(50) == pytest.approx(11.25, abs=1e-12)
    assert held.run(500) == held.travelled_mm[300]
    assert held.path.speed_mm_s == 0.0
    assert not held.path.is_standing  # the move has not ended
    held.release()
    assert held.run_out() == pytest.approx((88.75 / 50 + 0.05) / 1e-3, abs=1)
    assert held.path.positions_mm == (LENGTH_MM,)


@pytest.mark.parametrize(("own", "way_mm"), [(WEAK, 2.5), (None, 1.25)])
def test_every_hold_stops_the_path_by_the_ramp_of_the_feedhold(
    own: Slope | None, way_mm: float
) -> None:
    """v^2/2a with 500 mm/s2, without a ramp of its own with the 1000 of the motion, each time."""
    path = Interpolator("Z", MS)
    path.follow(Line((0.0,), (LENGTH_MM,)), plan(LENGTH_MM, FEED_MM_S, OWN, OWN))
    feed = Feed(FEED_MM_S, Dynamics(OWN, OWN, OWN, 100.0, own))
    for _ in range(3):
        for _ in range(300):
            path.advance()
            feed.lead(path, 1.0, is_held=False)
        assert path.speed_mm_s == pytest.approx(FEED_MM_S)
        begin_mm = path.path_travelled_mm
        for _ in range(150):
            feed.lead(path, 1.0, is_held=True)
            path.advance()
        assert path.speed_mm_s == 0.0
        assert path.path_travelled_mm - begin_mm == pytest.approx(way_mm, abs=1e-9)


def test_while_the_path_still_gains_speed() -> None:
    """After 0.03 s 0.45 mm at 30 mm/s; 500 mm/s²: 0.9 mm more in 0.06 s."""
    held = Held()
    held.run(30)
    held.hold()
    assert held.run(59) < held.run(1)
    assert held.run(1) == pytest.approx(0.45 + 0.9, abs=1e-12)


def test_while_the_path_brakes_into_its_end_a_weaker_feedhold_changes_nothing() -> None:
    """It stands at the end at the instant of the profile, 2.05 s; no position differs."""
    free, held = Held(), Held()
    free.run(2100)
    held.run(2020)
    held.hold()
    held.run(80)
    assert held.travelled_mm == pytest.approx(free.travelled_mm, abs=1e-9)
    assert held.travelled_mm.index(LENGTH_MM) == free.travelled_mm.index(LENGTH_MM)
    assert held.path.is_standing


def test_while_the_path_brakes_into_its_end_a_stronger_feedhold_stops_before_it() -> None:
    """20 ms before its end the path has 20 mm/s and 0.2 mm left; 4000 mm/s² need 0.05 mm."""
    held = Held(Slope(4000.0, 4000.0, 1000.0))
    held.run(2030)
    held.hold()
    assert held.run(10) == pytest.approx(LENGTH_MM - 0.15, abs=1e-9)
    held.release()
    # a triangle of 0.15 mm: 2 sqrt(s / a)
    assert held.run_out() == pytest.approx(2 * math.sqrt(0.15 / 1000) / 1e-3, abs=1)
    assert held.path.positions_mm == (LENGTH_MM,)


def test_a_feedhold_that_would_go_past_the_end_brakes_as_the_path_would() -> None:
    """2 mm before the end at 50 mm/s: 500 mm/s² need 2.5 mm, the path's own 1000 need 1.25 mm."""
    held = Held()
    held.run(1985)
    before_mm = held.travelled_mm[-1]
    assert LENGTH_MM - before_mm == pytest.approx(2.0, abs=1e-9)
    held.hold()
    assert held.run(50) == pytest.approx(before_mm + 1.25, abs=1e-9)
    held.release()
    held.run_out()
    assert held.path.positions_mm == (LENGTH_MM,)


def test_released_before_it_stands_it_goes_on_from_the_speed_that_is_left() -> None:
    """50 ms of 500 mm/s² leave 25 mm/s; with 1000 mm/s² 0.025 s later it is as fast as before."""
    held = Held()
    held.run(200)
    held.hold()
    begin_mm = held.run(50)
    held.release()
    assert held.path.speed_mm_s == pytest.approx(25.0, abs=1e-9)
    assert held.run(25) == pytest.approx(begin_mm + (50**2 - 25**2) / 2000, abs=1e-9)
    assert held.path.speed_mm_s == pytest.approx(50.0, abs=1e-9)
    held.run_out()
    assert held.path.positions_mm == (LENGTH_MM,)


def test_a_path_that_begins_while_held_waits_at_its_start() -> None:
    held = Held()
    waiting = Interpolator("Z", MS)
    waiting.is_held = True
    waiting.feedhold(WEAK, OWN)  # nothing moves
    waiting.follow(Line((0.0,), (LENGTH_MM,)), plan(LENGTH_MM, FEED_MM_S, OWN, OWN))
    assert [waiting.advance() for _ in range(5)] == [(0.0,)] * 5
    assert not waiting.is_standing
    waiting.is_held = False
    waiting.go_on(FEED_MM_S, OWN, OWN)
    while not waiting.is_standing:
        waiting.advance()
        held.run(1)
        assert waiting.path_travelled_mm == held.travelled_mm[-1]
    assert held.path.is_standing


@pytest.mark.parametrize("later", [10, 200])  # on the ramp of the feedhold, in standstill
def test_the_distance_to_go_may_be_deleted_in_feedhold(later: int) -> None:
    """The signal of a measurement run brakes by its own ramp; nothing is left to go on with."""
    held = Held()
    held.run(200)
    held.hold()
    held.run(later)
    speed, place_mm = held.path.speed_mm_s, held.travelled_mm[-1]
    held.path.brake(OWN)
    held.run_out()
    assert held.travelled_mm[-1] == pytest.approx(place_mm + speed**2 / 2000, abs=1e-9)
    held.release()
    assert held.run(100) == held.travelled_mm[-1]
    assert held.path.is_standing


def test_a_feedhold_changes_nothing_about_a_path_that_is_braked_for_good() -> None:
    held = Held()
    held.run(200)
    held.path.brake(OWN)
    held.run(10)
    held.hold()
    assert held.run_out() == 40
    assert held.travelled_mm[-1] == pytest.approx(8.75 + 1.25, abs=1e-9)


@pytest.mark.parametrize("then", ["hold", "go on", "both"])
def test_a_harder_hold_and_its_end_leave_a_brake_for_good_alone(then: str) -> None:
    """v^2/2a with 500 mm/s2 and 100 cycles, though a feedhold would stop with 1000."""
    held = Held(OWN)
    held.run(200)
    held.path.brake(WEAK)
    held.run(10)
    if then != "go on":
        held.hold()
    held.run(10)
    if then != "hold":
        held.release()
    assert held.run_out() == 80
    assert held.travelled_mm[-1] == pytest.approx(8.75 + 2.5, abs=1e-9)


def test_an_arc_stops_and_goes_on_on_its_circle() -> None:
    """Three quarters of a circle of 20 mm: every point 20 mm from the centre, and the same end."""
    arc = Arc((20.0, 0.0), (0.0, -20.0), (0.0, 0.0), (0.0, 1.0), 1.5 * math.pi)
    path = Interpolator("XY", MS)
    path.follow(arc, plan(arc.length_mm, FEED_MM_S, OWN, OWN))
    for cycle in range(10_000):
        if cycle == 500:
            path.is_held = True
            path.feedhold(WEAK, OWN)
        if cycle == 1000:
            # 0.5 s: 1.25 mm of ramp and 22.5 mm; 2.5 mm of feedhold
            angle = (1.25 + 22.5 + 2.5) / 20.0
            assert path.positions_mm == pytest.approx((20 * math.cos(angle), 20 * math.sin(angle)))
            path.is_held = False
            path.go_on(FEED_MM_S, OWN, OWN)
        assert math.hypot(*path.advance()) == pytest.approx(20.0, abs=1e-9)
        if path.is_standing:
            break
    assert path.positions_mm == arc.end_mm


@pytest.mark.long
@given(
    st.lists(st.integers(0, 400), min_size=1, max_size=8),
    st.sampled_from([WEAK, OWN, Slope(4000.0, 4000.0, 9.0), Slope(300.0, 2000.0, 20.0)]),
    st.floats(0.001, 30.0),
)
def test_however_often_it_never_goes_back_or_past_and_ends_exactly(
    waits: Sequence[int], slope: Slope, length_mm: float
) -> None:
    held = Held(slope, length_mm)
    for at, cycles in enumerate(waits):
        held.run(cycles)
        if at % 2:
            held.release()
        else:
            held.hold()
    held.release()
    held.run_out()
    assert held.travelled_mm[-1] == length_mm
    assert held.path.positions_mm == (length_mm,)
    steps = [b - a for a, b in pairwise(held.travelled_mm)]
    assert all(step >= 0.0 for step in steps)
    assert all(step <= FEED_MM_S * 1e-3 + 1e-9 for step in steps)
    strongest = max(1000.0, slope.a_low_mm_s2, slope.a_high_mm_s2)
    assert all(abs(b - a) <= strongest * 1e-6 + 1e-9 for a, b in pairwise(steps))


@pytest.mark.parametrize(("hold_s", "fall_s"), [(0.05, 0.02), (0.1, 0.04), (1.0, 0.1)])
def test_a_hold_shortens_the_fall_of_an_acceleration_by_what_is_left_of_it(
    hold_s: float, fall_s: float
) -> None:
    """A fall by 400 of 1000 mm/s² takes 0.4 of the ramp of the hold, and no more than it did.

    A fifth of it is over; its sin² goes on from there, and a fall to 0 from where it ends.
    """
    hold = JerkSlope(1000.0, hold_s, hold_s, Shape.SIN2)

    def fallen(share: float) -> float:
        return math.sin(0.5 * math.pi * share) ** 2

    state = State(0.0, 50.0, 800.0 - 400.0 * fallen(0.2), (Ramp(800.0, 400.0, 0.1, 0.02),))
    held = hold.held(state, 1000.0, JerkSlope(1000.0, 2.0, 2.0, Shape.SIN2))
    for share in (0.2, 0.4, 0.7, 0.999):
        found = held.state((share - 0.2) * fall_s).a_mm_s2
        assert found == pytest.approx(800.0 - 400.0 * fallen(share), abs=1e-6)
    release_s = 0.4 * hold_s
    for share in (0.001, 0.3, 0.9):
        found = held.state(0.8 * fall_s + share * release_s).a_mm_s2
        assert found == pytest.approx(400.0 * (1.0 - fallen(share)), abs=1e-6)


@pytest.mark.parametrize("a_mm_s2", [1000.0, 730.0, 333.3])
def test_a_hold_that_stops_at_the_end_but_for_rounding_ends_the_path(a_mm_s2: float) -> None:
    """A feedhold as hard as the deceleration, in each cycle of the last ramp: nothing is left."""
    slope = Slope(a_mm_s2, a_mm_s2, 1000.0)
    profile = plan(2.0, 47.3, slope, slope)  # too short for its feed
    for begin in range(int(500 * profile.duration_s) + 1, int(1000 * profile.duration_s)):
        path = Interpolator("Z", MS)
        path.follow(Line((0.0,), (2.0,)), profile)
        for _ in range(begin):
            path.advance()
        path.feedhold(slope, slope)
        for _ in range(200):
            path.advance()
        assert path.is_standing, begin
        assert path.positions_mm == (2.0,)


@pytest.mark.parametrize("shape", list(Shape))
def test_a_hold_in_the_run_up_gains_no_more_speed_than_the_path_would(shape: Shape) -> None:
    """Its own ramps are ten times as long: an acceleration that fell in them would pass the feed.

    It falls as the motion has planned it, a²/2 per jerk; then the feedhold brakes.
    """
    up = JerkSlope(1000.0, 0.04, 0.02, shape)
    down = JerkSlope(1000.0, 0.02, 0.02, shape).after(up)
    hold = JerkSlope(500.0, 0.2, 0.2, shape)
    course = up.plan(LENGTH_MM, FEED_MM_S, down)
    for cycle in range(1, 80):
        speed_mm_s = course.at(cycle * 1e-3)[1]
        stop = course.held(cycle * 1e-3, hold, down)
        assert stop.at(stop.duration_s)[1] == 0.0
        gained = max(stop.at(k * 1e-3)[1] for k in range(100))
        assert gained <= FEED_MM_S * (1.0 + 1e-9), cycle
        a_mm_s2 = course.state(cycle * 1e-3).a_mm_s2
        if shape is Shape.TRAPEZ and a_mm_s2 > 0.0:
            assert gained <= speed_mm_s + 0.5 * a_mm_s2**2 * 0.02 / 1000.0 + 1e-9
