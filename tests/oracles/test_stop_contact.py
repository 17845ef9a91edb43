"""The contact between two SYNCs, against motions whose contact is known."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.oracles.fixed_stop.contact import StopPath, first_contact, penetrations

STEP_S = 1e-3
ROWS = np.arange(40)


def rows(
    contact_s: float, speed_mm_s: float, k_over_m: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, position and velocity of a mass that runs onto a spring at 0 mm."""
    rate = math.sqrt(k_over_m)
    since = ROWS * STEP_S - contact_s
    inside = since > 0.0
    swing = np.clip(rate * since, 0.0, None)
    position = np.where(inside, speed_mm_s / rate * np.sin(swing), speed_mm_s * since)
    velocity = np.where(inside, speed_mm_s * np.cos(swing), speed_mm_s)
    return (ROWS * 1_000_000).astype(np.int64), position, velocity


speeds, places = st.floats(0.5, 50.0), st.floats(0.0101, 0.0299)
stiff = st.floats(1e5, 5e6)  # 20 N/um on 200 kg to 500 N/um on 100 kg


@settings(max_examples=300, deadline=None)
@given(places, speeds, stiff, st.sampled_from([1, -1]))
def test_contact_within_the_stated_bound(
    contact_s: float, speed_mm_s: float, k_over_m: float, direction: int
) -> None:
    times, position, velocity = rows(contact_s, speed_mm_s, k_over_m)
    stop = StopPath.at_rest(100.0, direction, len(times))
    found = first_contact(times, 100.0 + direction * position, direction * velocity, stop, k_over_m)
    assert found is not None
    assert abs(found.time_ns - contact_s * 1e9) <= found.uncertainty_ns
    assert found.speed_mm_s == np.float64(speed_mm_s)
    assert found.position_mm == 100.0


@settings(max_examples=200, deadline=None)
@given(places, speeds, stiff)
def test_without_stiffness_the_bend_of_the_motion_bounds_the_error(
    contact_s: float, speed_mm_s: float, k_over_m: float
) -> None:
    times, position, velocity = rows(contact_s, speed_mm_s, k_over_m)
    stop = StopPath.at_rest(0.0, 1, len(times))
    found = first_contact(times, position, velocity, stop, None)
    assert found is not None
    assert abs(found.time_ns - contact_s * 1e9) <= found.uncertainty_ns


def test_a_stop_that_comes_towards_the_axis_is_met_earlier() -> None:
    times, position, velocity = rows(0.0201, 10.0, 1e5)
    seconds = times * 1e-9
    stop = StopPath(0.05 - 5.0 * seconds, np.full(len(times), -5.0), 1)
    found = first_contact(times, position, velocity, stop, 1e5)
    assert found is not None
    # 10 (t - 0.0201) = 0.05 - 5 t
    assert abs(found.time_ns - 0.251 / 15.0 * 1e9) < 10.0
    assert found.speed_mm_s == np.float64(15.0)


def test_no_contact_where_the_gap_stays_open_or_was_closed_before() -> None:
    times, position, velocity = rows(0.0201, 10.0, 1e5)
    for place in (5.0, -50.0):
        stop = StopPath.at_rest(place, 1, len(times))
        assert first_contact(times, position, velocity, stop, 1e5) is None
    deep = penetrations(StopPath.at_rest(-50.0, 1, len(times)), position)
    assert np.all(deep > 0.0)
