"""The speed at which a motion takes a given time."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.motion.profile import Slope, plan
from axisrig.kernel.motion.timed import speed_for

SLOPE = Slope(1000.0, 1000.0, 1000.0)


@pytest.mark.long
@given(distance=st.floats(0.01, 1e4), slower=st.floats(1.01, 1e3))
def test_the_motion_takes_the_time(distance: float, slower: float) -> None:
    time_s = plan(distance, 500.0, SLOPE, SLOPE).duration_s * slower
    speed = speed_for(distance, time_s, SLOPE, SLOPE, 500.0)
    assert distance / speed + speed / 1000.0 == pytest.approx(time_s, rel=1e-9)


def test_what_cannot_be_done_in_time_is_done_as_fast_as_possible() -> None:
    assert speed_for(10.0, 0.01, SLOPE, SLOPE, 500.0) == 500.0


@pytest.mark.parametrize(
    ("one", "other", "weaker"),
    [
        ((100.0, 400.0, 10.0), (300.0, 200.0, 20.0), (100.0, 200.0, 10.0)),
        ((200.0, 400.0, 10.0), (150.0, 500.0, 20.0), (150.0, 150.0, 10.0)),  # low up to 20 mm/s
        ((200.0, 100.0, 10.0), (150.0, 500.0, 20.0), (150.0, 100.0, 10.0)),
        ((200.0, 400.0, 20.0), (300.0, 500.0, 20.0), (200.0, 400.0, 20.0)),
    ],
)
def test_the_weaker_of_two_slopes_at_every_speed(
    one: tuple[float, ...], other: tuple[float, ...], weaker: tuple[float, ...]
) -> None:
    """Above its smaller change-over speed both steps of the other slope limit."""
    for first, second in ((one, other), (other, one)):
        assert Slope(*first).weaker(Slope(*second)) == Slope(*weaker)
