"""What a state of a path with ramps leads on to: its ramps to the end, and the same path again."""

import math

import pytest

from axisrig.kernel.motion.course import Ramp, State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_profile import JerkProfile
from axisrig.kernel.motion.jerk_ramps import Shape

LENGTH_MM = 40.0
SAME_MM, SAME_MM_S = 1e-9, 1e-9
"""What rounding may leave of a path of 40 mm that is planned anew some hundred times."""
LOOKS = 40
"""Steps of Simpson's rule in a ramp. Its error in the speed is T da pi^3/360 (1/80)^4 with SIN2:
1e-7 mm/s for a ramp of 60 ms to or from 800 mm/s², and less than as many mm in a path of 0.8 s.
"""


def planned(shape: Shape, feed_mm_s: float) -> tuple[JerkSlope, JerkSlope, JerkProfile]:
    """Unequal ramps; at 200 mm/s the path is too short for the feed."""
    up = JerkSlope(1000.0, 0.05, 0.03, shape)
    down = JerkSlope(800.0, 0.02, 0.06, shape)
    return up, down, up.plan(LENGTH_MM, feed_mm_s, down)


def acceleration(ramp: Ramp, t_s: float, shape: Shape) -> float:
    """Straight, or a squared sine over the whole of the ramp."""
    share = (ramp.begun_s + t_s) / ramp.duration_s
    if shape is Shape.SIN2:
        share = math.sin(0.5 * math.pi * share) ** 2
    return ramp.from_mm_s2 + (ramp.to_mm_s2 - ramp.from_mm_s2) * share


def led_on(state: State, shape: Shape) -> tuple[float, float, float]:
    """Path, speed and time after the ramps of a state, by Simpson's rule of the acceleration."""
    path_mm, speed_mm_s, time_s = state.path_mm, state.speed_mm_s, 0.0
    for ramp in state.left:
        rest_s = ramp.duration_s - ramp.begun_s
        step_s = rest_s / LOOKS
        for k in range(LOOKS):
            a0, a1, a2 = (acceleration(ramp, (k + x) * step_s, shape) for x in (0.0, 0.5, 1.0))
            path_mm += step_s * (speed_mm_s + step_s * (a0 + 2.0 * a1) / 6.0)
            speed_mm_s += step_s * (a0 + 4.0 * a1 + a2) / 6.0
        time_s += rest_s
    return path_mm, speed_mm_s, time_s


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("feed_mm_s", [60.0, 200.0])
def test_the_ramps_that_are_left_lead_to_the_end(shape: Shape, feed_mm_s: float) -> None:
    """At the begin of each ramp, inside, and of a path that was planned anew inside of one."""
    up, down, path = planned(shape, feed_mm_s)
    inside = [phase.start_s + 0.3 * (phase.end_s - phase.start_s) for phase in path.phases]
    for begin_s in (0.0, *inside):
        anew = up.rest(path.state(begin_s), LENGTH_MM, feed_mm_s, down)
        assert anew.duration_s == pytest.approx(path.duration_s - begin_s, abs=1e-12)
        for phase in anew.phases:
            for share in (0.0, 0.6):
                t_s = phase.start_s + share * (phase.end_s - phase.start_s)
                state = anew.state(t_s)
                path_mm, speed_mm_s, time_s = led_on(state, shape)
                assert time_s == pytest.approx(anew.duration_s - t_s, abs=1e-12), (begin_s, t_s)
                assert path_mm == pytest.approx(LENGTH_MM, abs=1e-7), (begin_s, t_s)
                assert speed_mm_s == pytest.approx(0.0, abs=1e-7), (begin_s, t_s)
                first = state.left[0]
                assert state.a_mm_s2 == pytest.approx(acceleration(first, 0.0, shape), abs=1e-6)


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("feed_mm_s", [60.0, 200.0])
@pytest.mark.parametrize("step_s", [0.0117, 0.004, 0.002])
def test_a_path_that_is_planned_anew_again_and_again_stays_the_same(
    shape: Shape, feed_mm_s: float, step_s: float
) -> None:
    """Also inside its ramps: one of SIN2 goes on, and none begins anew in its place."""
    up, down, path = planned(shape, feed_mm_s)
    anew, cycle = path, 0
    while (cycle + 1) * step_s < path.duration_s:
        cycle += 1
        anew = up.rest(anew.state(step_s), LENGTH_MM, feed_mm_s, down)
        for later_s in (0.0, 0.003, 0.05):
            place_mm, speed_mm_s = anew.at(later_s)
            expected_mm, expected_mm_s = path.at(cycle * step_s + later_s)
            assert abs(place_mm - expected_mm) < SAME_MM, (cycle, later_s)
            assert abs(speed_mm_s - expected_mm_s) < SAME_MM_S, (cycle, later_s)


@pytest.mark.parametrize("shape", Shape)
def test_a_brake_in_the_run_up_gains_no_more_than_the_acceleration_does_as_it_falls(
    shape: Shape,
) -> None:
    """At 60 ms it has 1000 (0.06 - 0.05/2) = 35 mm/s; ramps of 50 ms add 25, unless 45 is most.

    Looked at every 0.4 ms: 0.2 ms beside the peak a jerk of 50 m/s³ leaves 1e-3 mm/s of it.
    """
    slope = JerkSlope(1000.0, 0.05, 0.05, shape)
    path = slope.plan(100.0, 200.0, slope)
    for fastest_mm_s, highest_mm_s in ((math.inf, 60.0), (45.0, 45.0), (80.0, 60.0)):
        stop = path.brake(0.06, slope, fastest_mm_s)
        speeds = [stop.at(k * stop.duration_s / 400)[1] for k in range(400)]
        assert speeds[0] == pytest.approx(35.0)
        assert max(speeds) == pytest.approx(highest_mm_s, abs=1e-3)
        assert max(speeds) <= highest_mm_s + 1e-9
        assert stop.at(0.0)[0] == pytest.approx(path.at(0.06)[0])
