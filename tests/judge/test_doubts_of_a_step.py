"""How well the motion inside a step is known: behind a straight one, beside a place that jumps.

Of a jump J of the acceleration the place may be off by J h^2/60 and the speed by J h/18, h: the
length of a step. Jumps one after the other: `test_motion_at_jumps.py`.
"""

import numpy as np
import pytest

from axisrig.bench.judge.observed.motion import Motion, motion
from axisrig.kernel.time.clock import MS

PLACE, SPEED = 1 / 60, 1 / 18
by_step = pytest.mark.parametrize("step_ns", [MS, 4 * MS])
both_ways = pytest.mark.parametrize("side", [1.0, -1.0])


def parabolas(accelerations: list[float], step_ns: int, begin_mm_s: float = 50.0) -> Motion:
    """Each step has its own acceleration, mm/s2."""
    h = step_ns * 1e-9
    speeds = begin_mm_s + np.cumsum([0.0, *accelerations]) * h
    ways = (speeds[:-1] + speeds[1:]) / 2.0 * h
    times_ns = np.arange(len(speeds)) * step_ns
    return motion(times_ns, np.cumsum([100.0, *ways]), speeds)


@by_step
def test_a_straight_step_says_nothing_of_what_comes_after_it(step_ns: int) -> None:
    """A slow start and a stronger jump at its end: the end counts, however even it was before."""
    h = step_ns * 1e-9
    found = parabolas([0.0, 0.0, 300.0, -4200.0, -4200.0], step_ns)
    assert found.doubts_mm[:3] == pytest.approx([0.0, 0.0, PLACE * 4500.0 * h**2], rel=1e-6)
    assert found.doubts_mm_s[:3] == pytest.approx([0.0, 0.0, SPEED * 4500.0 * h], rel=1e-6)


@both_ways
@by_step
def test_a_place_beside_its_neighbours_is_four_times_its_distance_in_doubt(
    step_ns: int, side: float
) -> None:
    """One SYNC is d beside an even motion: 4 d x 0.15/3 of place and 4 d/h x 0.75/3 of speed.

    In the steps on both sides of it; all others are straight and known.
    """
    d, h, rows = 0.01, step_ns * 1e-9, 9
    x = 100.0 + 30.0 * h * np.arange(rows)
    x[4] += side * d
    found = motion(np.arange(rows) * step_ns, x, np.full(rows, 30.0))
    beside = np.isin(np.arange(rows - 1), [3, 4])
    assert found.doubts_mm == pytest.approx(np.where(beside, d / 5, 0.0), abs=1e-12)
    assert found.doubts_mm_s == pytest.approx(np.where(beside, d / h, 0.0), abs=1e-9)


@pytest.mark.parametrize("rows", [1, 2])
def test_of_less_than_three_rows_the_whole_change_of_the_speed_counts(rows: int) -> None:
    """10 mm/s more in 4 ms: 40 um, and of speed 0.75 over 0.15 times the change."""
    times_ns, speeds = np.array([0, 4 * MS])[:rows], np.array([20.0, 30.0])[:rows]
    found = motion(times_ns, np.array([0.0, 0.1])[:rows], speeds)
    assert found.doubts_mm == pytest.approx([0.040] * (rows - 1))
    assert found.doubts_mm_s == pytest.approx([5.0 * 10.0] * (rows - 1))


@pytest.mark.parametrize(
    ("time_ns", "place_mm", "speed_mm_s", "is_between"),
    [
        (0, 100.0, 50.0, False),
        (4 * MS, 100.2016, 50.8, False),
        (6 * MS, 100.3036, 51.2, True),
        (20 * MS, 101.04, 54.0, False),
    ],
)
def test_a_state_at_a_sync_is_known_and_one_between_has_the_doubt_of_its_step(
    time_ns: int, place_mm: float, speed_mm_s: float, is_between: bool
) -> None:
    """200 mm/s2 from 50 mm/s on, with one jump of 3000 mm/s2 against it at the end."""
    found = parabolas([200.0] * 5 + [-2800.0] * 2, 4 * MS)
    doubts_mm = np.arange(1.0, 8.0)
    own = Motion(found.times_ns, found.position_mm, found.speed_mm_s, doubts_mm, 10 * doubts_mm)
    state = own.at(time_ns)
    assert state is not None
    assert state[:2] == pytest.approx((place_mm, speed_mm_s))
    assert state[2:] == ((2.0, 20.0) if is_between else (0.0, 0.0))


def test_before_the_first_and_behind_the_last_sync_there_is_no_state() -> None:
    found = parabolas([200.0] * 3, 4 * MS)
    assert [found.at(time_ns) is None for time_ns in (-1, 0, 12 * MS, 12 * MS + 1)] == [
        *(True, False, False, True)
    ]
    empty = motion(np.array([], np.int64), np.array([]), np.array([]))
    assert empty.at(0) is None
