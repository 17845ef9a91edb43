"""Interpolator and set point buffer: samples against hand formulas."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.motion.interpolator import Interpolator, SetpointBuffer
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.profile import Slope, plan
from axisrig.kernel.time.clock import MS

SLOPE = Slope(1000.0, 1000.0, 1000.0)


def started(target: dict[str, float], feed: float, cycle_ns: int = MS) -> Interpolator:
    interpolator = Interpolator(("X", "Y", "Z"), cycle_ns)
    length = math.hypot(*target.values())
    interpolator.start({"X": 0.0, "Y": 0.0, "Z": 0.0}, target, plan(length, feed, SLOPE, SLOPE))
    return interpolator


def run(interpolator: Interpolator) -> list[tuple[float, ...]]:
    course = []
    while not interpolator.is_standing:
        course.append(interpolator.advance())
    return course


def test_samples_lie_on_the_profile_at_multiples_of_the_cycle() -> None:
    """Z from 0 to -10 at 50 mm/s and 1000 mm/s²: 0.05 s ramps, 0.15 s at feed, 250 samples."""
    course = run(started({"Z": -10.0}, 50.0))
    assert len(course) == 250
    assert course[0] == pytest.approx((0.0, 0.0, -0.5 * 1000 * 0.001**2))
    assert course[29] == pytest.approx((0.0, 0.0, -0.5 * 1000 * 0.03**2))
    assert course[99] == pytest.approx((0.0, 0.0, -(1.25 + 50 * 0.05)))
    assert course[239] == pytest.approx((0.0, 0.0, -(10 - 0.5 * 1000 * 0.01**2)))
    assert course[-1] == (0.0, 0.0, -10.0)


@given(
    st.dictionaries(st.sampled_from("XYZ"), st.floats(-0.9, 0.9), min_size=1),
    st.floats(5.0, 200.0),
    st.sampled_from([250_000, MS, 3 * MS]),
)
@pytest.mark.long
def test_last_sample_is_exactly_the_target_and_duration_is_rounded_up(
    target: dict[str, float], feed: float, cycle_ns: int
) -> None:
    interpolator = Interpolator("XYZ", cycle_ns)
    interpolator.hold((0.1, -0.2, 0.3))
    target_mm = {axis: value + 1.0 for axis, value in target.items()}
    end = tuple(target_mm.get(axis, at) for axis, at in zip("XYZ", (0.1, -0.2, 0.3), strict=True))
    profile = plan(math.dist((0.1, -0.2, 0.3), end), feed, SLOPE, SLOPE)
    interpolator.start({}, target_mm, profile)
    course = run(interpolator)
    assert course[-1] == end
    assert interpolator.speed_mm_s == 0.0
    assert interpolator.path_travelled_mm == profile.end_mm
    assert len(course) == pytest.approx(profile.duration_s / (cycle_ns * 1e-9), abs=1.0 + 1e-6)
    assert len(course) * cycle_ns * 1e-9 >= profile.duration_s * (1 - 1e-12)
    assert interpolator.advance() == end


def test_path_over_three_axes_is_straight_and_keeps_the_feed() -> None:
    target = (2.0, -3.0, 6.0)  # length 7
    interpolator = started({"X": 2.0, "Y": -3.0, "Z": 6.0}, 100.0)
    course = run(interpolator)
    for position in course:
        share = position[2] / target[2]
        assert position == pytest.approx([share * value for value in target], abs=1e-12)
    speeds = [math.dist(a, b) / 0.001 for a, b in pairwise(course)]
    assert max(speeds) <= math.sqrt(7.0 * 1000.0) + 1e-6  # triangle: v_p² = D·a


@pytest.mark.long
def test_no_drift_over_many_cycles() -> None:
    """Ten minutes at 1 mm/s: sample 600 000 - 1 lies on 599.999 s, not on a sum of cycles."""
    profile = plan(600.0, 1.0, SLOPE, SLOPE)
    interpolator = Interpolator("X", MS)
    interpolator.start({"X": 0.0}, {"X": 600.0}, profile)
    for _ in range(599_999):
        position = interpolator.advance()
    # Full speed since 1 ms: s = v²/2a + v (t - v/a).
    assert position[0] == pytest.approx(0.0005 + 599.998, abs=1e-9)


def test_braking_deletes_the_distance_to_go() -> None:
    """At feed 50 the stop takes v²/2d = 2.5 mm and v/d = 0.1 s at 500 mm/s²."""
    interpolator = started({"Z": -100.0}, 50.0)
    for _ in range(200):
        before = interpolator.advance()
    interpolator.brake(Slope(500.0, 500.0, 1.0))
    first = interpolator.advance()
    assert before[2] - first[2] == pytest.approx(50 * 0.001 - 250 * 0.001**2)
    course = [first, *run(interpolator)]
    assert len(course) == 100
    assert course[-1] == pytest.approx((0.0, 0.0, before[2] - 2.5))
    assert interpolator.path_travelled_mm == pytest.approx(-before[2] + 2.5)
    assert interpolator.advance() == course[-1]


@pytest.mark.parametrize(
    ("fastest_mm_s", "reached_mm_s", "way_mm"),
    [
        (math.inf, 55.0, 1.5 + 2.5 / 3.0 + 55.0**2 / 2000.0 + 55.0 * 0.05 / 2.0),
        (60.0, 55.0, 1.5 + 2.5 / 3.0 + 55.0**2 / 2000.0 + 55.0 * 0.05 / 2.0),
        (40.0, 40.0, 0.6 + 0.4 / 3.0 + 40.0 * math.sqrt(40.0 * 0.05 / 1000.0)),
    ],
)
def test_a_brake_in_the_run_up_does_not_pass_the_fastest_speed(
    fastest_mm_s: float, reached_mm_s: float, way_mm: float
) -> None:
    """At 30 mm/s and 1000 mm/s2 the acceleration falls in 50 ms, or in the 20 ms to 40 mm/s.

    Meanwhile v t + a t^2/3; then v^2/2a + v t_r/2 with v >= a t_r, else v sqrt(v t_r/a).
    """
    slope = JerkSlope(1000.0, 0.05, 0.05)
    interpolator = Interpolator("X", MS)
    interpolator.start({"X": 0.0}, {"X": 200.0}, slope.plan(200.0, 200.0, slope))
    for _ in range(55):
        (here_mm,) = interpolator.advance()
    assert interpolator.speed_mm_s == pytest.approx(30.0)
    interpolator.brake(slope, fastest_mm_s)
    speeds = []
    while not interpolator.is_standing:
        interpolator.advance()
        speeds.append(interpolator.speed_mm_s)
    assert max(speeds) == pytest.approx(reached_mm_s, rel=1e-12)
    assert interpolator.positions_mm[0] - here_mm == pytest.approx(way_mm, rel=1e-12)


def test_next_move_continues_where_braking_ended() -> None:
    interpolator = started({"Z": -100.0}, 50.0)
    for _ in range(200):
        interpolator.advance()
    interpolator.brake(SLOPE)
    end = run(interpolator)[-1]
    target = {"X": 0.1, "Y": -0.7, "Z": 0.3}
    length_mm = math.dist(end, tuple(target.values()))
    interpolator.start({}, target, plan(length_mm, 50.0, SLOPE, SLOPE))
    assert interpolator.advance()[2] > end[2]
    assert run(interpolator)[-1] == (0.1, -0.7, 0.3)


def test_braking_while_standing_changes_nothing() -> None:
    interpolator = started({"Z": 1.0}, 50.0)
    run(interpolator)
    interpolator.brake(SLOPE)
    assert interpolator.is_standing
    assert interpolator.advance() == (0.0, 0.0, 1.0)


@pytest.mark.parametrize("at", [0, 1, 30, 200, 249])
def test_a_cycle_that_is_taken_back_has_never_been(at: int) -> None:
    """What comes after it is what came without it: place, way and speed of every cycle."""
    plain, other = started({"Z": -10.0}, 50.0), started({"Z": -10.0}, 50.0)
    for cycle in range(260):
        plain.advance()
        other.advance()
        if cycle == at:
            before = other.positions_mm, other.path_travelled_mm, other.speed_mm_s
            other.advance()
            other.take_back()
            assert (other.positions_mm, other.path_travelled_mm, other.speed_mm_s) == before
            other.take_back()  # only the last one can be
        assert other.positions_mm == plain.positions_mm
        assert (other.path_travelled_mm, other.speed_mm_s) == (
            *(plain.path_travelled_mm, plain.speed_mm_s),
        )
    assert other.is_standing


def test_starting_is_refused_while_moving_or_with_a_profile_of_another_length() -> None:
    interpolator = started({"Z": 1.0}, 50.0)
    with pytest.raises(ValueError, match="not ended"):
        interpolator.start({}, {"Z": 2.0}, plan(2.0, 50.0, SLOPE, SLOPE))
    with pytest.raises(ValueError, match="not ended"):
        interpolator.hold((0.0, 0.0, 0.0))
    run(interpolator)
    with pytest.raises(ValueError, match=r"path of 1\.0 mm"):
        interpolator.start({}, {"Z": 2.0}, plan(2.0, 50.0, SLOPE, SLOPE))


def test_move_of_no_length_stands_at_once() -> None:
    interpolator = Interpolator("X", MS)
    interpolator.start({"X": 4.0}, {"X": 4.0}, plan(0.0, 1.0, SLOPE, SLOPE))
    assert interpolator.is_standing
    assert interpolator.advance() == (4.0,)


@pytest.mark.parametrize("n_cycles", [0, 1, 3])
def test_buffer_delays_by_n_cycles(n_cycles: int) -> None:
    buffer = SetpointBuffer(n_cycles, (-1.0,))
    out = [buffer.shift((float(k),)) for k in range(6)]
    assert out == [(-1.0,)] * n_cycles + [(float(k),) for k in range(6 - n_cycles)]


def test_buffer_is_settled_when_its_output_has_caught_up() -> None:
    buffer = SetpointBuffer(2, (0.0,))
    assert buffer.is_settled
    settled = [bool(buffer.shift((1.0,))) and buffer.is_settled for _ in range(3)]
    assert settled == [False, False, True]


def test_published_overtravel_with_buffer() -> None:
    """6 m/min, 16 ms until the stop acts, 1 m/s²: v·t + v²/2b = 1.6 + 5 mm behind the signal.

    The 16 ms are 16 cycles of buffer here (SINUMERIK 840C probing manual, no following error).
    """
    interpolator, buffer = started({"X": 1000.0}, 100.0), SetpointBuffer(16, (0.0, 0.0, 0.0))
    for _ in range(500):
        sent = buffer.shift(interpolator.advance())
    at_signal_mm = sent[0]
    interpolator.brake(SLOPE)
    while not (interpolator.is_standing and buffer.is_settled):
        sent = buffer.shift(interpolator.advance())
    assert sent[0] - at_signal_mm == pytest.approx(1.6 + 5.0)


def test_an_axis_can_be_led_while_the_others_move() -> None:
    interpolator = Interpolator(("X", "Y"), MS)
    free = Interpolator(("X", "Y"), MS)
    for path in (interpolator, free):
        path.start({}, {"X": 10.0}, plan(10.0, 100.0, SLOPE, SLOPE))
    for cycle in range(1, 1000):
        interpolator.lead(1, cycle * 0.01)
        assert interpolator.advance() == (free.advance()[0], cycle * 0.01)
    assert interpolator.is_standing
    interpolator.lead(1, -3.0)
    assert interpolator.advance() == (10.0, -3.0)
    # The path that is over is none any more: it begins and ends where the axes are
    assert (interpolator.path.start_mm, interpolator.path.end_mm) == ((10.0, -3.0),) * 2


def test_everything_in_a_buffer_moves_for_one_axis() -> None:
    """What is on its way keeps its course: 0, 1, 2 of the first axis are 10, 11, 12."""
    buffer = SetpointBuffer(2, (0.0, 5.0))
    for place in (0.0, 1.0, 2.0):
        buffer.shift((place, 5.0))
    buffer.move(0, 10.0)
    assert [buffer.shift((13.0, 5.0)) for _ in range(3)] == [(11.0, 5.0), (12.0, 5.0), (13.0, 5.0)]
    assert buffer.is_settled


def test_a_buffer_settles_axis_by_axis_and_one_axis_can_be_put() -> None:
    buffer = SetpointBuffer(2, (0.0, 0.0))
    buffer.shift((0.0, 1.0))
    assert buffer.is_settled_of((0,))
    assert not buffer.is_settled_of((1,))
    buffer.put(1, 7.0)
    assert buffer.is_settled
    assert buffer.shift((0.0, 8.0)) == (0.0, 7.0)


def test_a_buffer_is_not_settled_by_what_comes_back_to_where_it_was() -> None:
    """Of two axes one went out and back within the cycles that are buffered."""
    buffer = SetpointBuffer(2, (0.0, 0.0))
    for place_mm, settled in ((1.0, False), (0.0, False), (0.0, False), (0.0, True)):
        buffer.shift((place_mm, 0.0))
        assert buffer.is_settled is settled
        assert buffer.is_settled_of([0]) is settled
        assert buffer.is_settled_of([0, 1]) is settled
        assert buffer.is_settled_of([1])


@pytest.mark.parametrize(
    ("start", "target", "begin", "end"),
    [
        ({}, {"X": 3.0}, (1.0, -2.0, 5.0), (3.0, -2.0, 5.0)),
        ({"X": 2.0}, {"X": 3.0}, (2.0, -2.0, 5.0), (3.0, -2.0, 5.0)),
        ({"Z": 4.0}, {"X": 3.0}, (1.0, -2.0, 4.0), (3.0, -2.0, 4.0)),
        ({}, {"Y": 2.0, "Z": 8.0}, (1.0, -2.0, 5.0), (1.0, 2.0, 8.0)),
    ],
)
def test_an_axis_that_a_move_does_not_name_stays_where_it_is(
    start: dict[str, float], target: dict[str, float], begin: tuple[float, ...],
    end: tuple[float, ...],
) -> None:  # fmt: skip
    """Once before the move, and where its start says."""
    path = Interpolator("XYZ", MS)
    path.hold((1.0, -2.0, 5.0))
    path.start(start, target, plan(math.dist(begin, end), 50.0, SLOPE, SLOPE))
    assert path.positions_mm == begin
    course = run(path)
    assert course[-1] == end
    for at, (first, last) in enumerate(zip(begin, end, strict=True)):
        assert first != last or {place[at] for place in course} == {first}
