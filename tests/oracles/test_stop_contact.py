"""The contact between two SYNCs, against motions whose contact is known."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.contact import (
    ROWS_BEFORE,
    StopPath,
    first_contact,
    penetrations,
)

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
@pytest.mark.long
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


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(places, speeds, stiff)
@example(0.02, 1.0, 1e5)  # on a row
def test_without_stiffness_the_free_motion_tells_the_instant(
    contact_s: float, speed_mm_s: float, k_over_m: float
) -> None:
    times, position, velocity = rows(contact_s, speed_mm_s, k_over_m)
    stop = StopPath.at_rest(0.0, 1, len(times))
    found = first_contact(times, position, velocity, stop, None)
    assert found is not None
    assert abs(found.time_ns - contact_s * 1e9) <= found.uncertainty_ns < 10.0


def ramped(
    contact_s: float, speed_mm_s: float, acceleration_mm_s2: float, k_over_m: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `rows`, but the axis still accelerates when it touches; it has begun at rest."""
    times, position, velocity = rows(contact_s, speed_mm_s, k_over_m)
    since = np.minimum(ROWS * STEP_S - contact_s, 0.0)
    begin = -speed_mm_s / acceleration_mm_s2 if acceleration_mm_s2 > 0.0 else -math.inf
    led = np.maximum(since, begin)
    position = position + speed_mm_s * (led - since) + acceleration_mm_s2 * led**2 / 2
    velocity = np.where(since < begin, 0.0, velocity + acceleration_mm_s2 * since)
    return times, position, velocity


@settings(max_examples=200, deadline=None)
@given(places, speeds, stiff, st.floats(-1000.0, 1000.0))
@example(0.02, 4.0, 1e5, 900.0)  # from rest four rows before
@pytest.mark.long
def test_the_acceleration_before_the_contact_is_in_the_bound(
    contact_s: float, speed_mm_s: float, k_over_m: float, slope: float
) -> None:
    """The rows that the acceleration is taken of lie within the ramp."""
    assume(slope * (ROWS_BEFORE + 2) * STEP_S < speed_mm_s)
    times, position, velocity = ramped(contact_s, speed_mm_s, slope, k_over_m)
    stop = StopPath.at_rest(0.0, 1, len(times))
    found = first_contact(times, position, velocity, stop, None)
    assert found is not None
    if position[found.row] < 0.0 < velocity[found.row]:
        assert abs(found.time_ns - contact_s * 1e9) <= found.uncertainty_ns


@pytest.mark.parametrize("knows", [True, False])
@pytest.mark.parametrize("contact_s", [0.0161, 0.0165])
def test_a_contact_that_lets_go_between_two_rows_is_the_first_one(
    contact_s: float, knows: bool
) -> None:
    """Touch, half a period of the spring, off again with the speed of before; back 10 ms later."""
    speed_mm_s, rate = 20.0, math.pi / 3e-4
    times, position, velocity = rows(contact_s, speed_mm_s, rate**2)
    off_s = contact_s + math.pi / rate
    since = ROWS * STEP_S - off_s
    back = np.where(since < 10e-3, -speed_mm_s * since, speed_mm_s * (since - 20e-3))
    position = np.where(since > 0.0, back, position)
    velocity = np.where(since > 0.0, np.where(since < 10e-3, -speed_mm_s, speed_mm_s), velocity)
    peak_n = np.where(math.ceil(contact_s / STEP_S) == ROWS, 5000.0, 0.0)
    assert position[np.argmax(peak_n)] < 0.0, "open again at the row"
    stop = StopPath.at_rest(0.0, 1, len(times))
    found = first_contact(times, position, velocity, stop, rate**2 if knows else None, peak_n)
    assert found is not None
    assert found.row == 16
    assert abs(found.time_ns - contact_s * 1e9) <= found.uncertainty_ns < 10.0
    unseen = first_contact(times, position, velocity, stop, None)
    assert unseen is not None
    assert unseen.time_ns > contact_s * 1e9 + 19e6, "by the rows alone it is the second one"


def test_without_rows_before_it_the_contact_is_known_to_a_cycle() -> None:
    times, position, velocity = rows(0.0105, 10.0, 1e5)
    begin = slice(9, None)
    peak_n = np.where(ROWS[begin] == 11, 100.0, 0.0)
    stop = StopPath.at_rest(0.0, 1, len(ROWS[begin]))
    found = first_contact(times[begin], position[begin], velocity[begin], stop, None, peak_n)
    assert found is not None
    assert found.row == 1
    assert found.uncertainty_ns == pytest.approx(STEP_S * 1e9, abs=2.0)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("way_mm_s", [-5.0, 5.0])
def test_a_stop_that_moves_is_met_where_it_is_then(way_mm_s: float, direction: int) -> None:
    """10 (t - 0.0201) = 0.05 + v t: earlier where it comes towards the axis."""
    times = (np.arange(80) * 1_000_000).astype(np.int64)
    seconds = times * 1e-9
    at = direction * (0.05 + way_mm_s * seconds)
    stop = StopPath(at, np.full(len(times), direction * way_mm_s), direction)
    free = direction * 10.0 * (seconds - 0.0201)
    found = first_contact(times, free, np.full(len(times), direction * 10.0), stop, 1e5)
    assert found is not None
    contact_s = 0.251 / (10.0 - way_mm_s)
    assert abs(found.time_ns - contact_s * 1e9) < 10.0
    assert found.position_mm == pytest.approx(direction * (0.05 + way_mm_s * contact_s), abs=1e-7)
    assert found.speed_mm_s == pytest.approx(10.0 - way_mm_s)


def test_no_contact_where_the_gap_stays_open_or_was_closed_before() -> None:
    times, position, velocity = rows(0.0201, 10.0, 1e5)
    for place in (5.0, -50.0):
        stop = StopPath.at_rest(place, 1, len(times))
        assert first_contact(times, position, velocity, stop, 1e5) is None
    deep = penetrations(StopPath.at_rest(-50.0, 1, len(times)), position)
    assert np.all(deep > 0.0)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_gap_that_closes_before_the_motion_of_before_would_close_it(direction: int) -> None:
    """10 mm/s would close 0.012 mm in 1.2 ms; it is closed after 1 ms: 0.2 ms in doubt."""
    gap = np.array([0.042, 0.032, 0.022, 0.012, -0.001])
    times = (np.arange(5) * 1_000_000).astype(np.int64)
    stop = StopPath.at_rest(5.0, direction, 5)
    velocity = np.full(5, direction * 10.0)
    found = first_contact(times, 5.0 - direction * gap, velocity, stop, None)
    assert found is not None
    assert (found.row, found.speed_mm_s) == (3, 10.0)
    assert found.time_ns == pytest.approx(4e6, abs=1.0)
    assert found.uncertainty_ns == pytest.approx(0.2e6 + 1.0)


def test_a_way_that_would_take_more_than_two_rows_says_nothing_of_the_instant() -> None:
    """At 10 mm/s 0.0201 mm take 2.01 ms and 0.0199 mm 1.99 ms, but they were gone in 1 ms."""
    times = (np.arange(5) * 1_000_000).astype(np.int64)
    stop, velocity = StopPath.at_rest(0.0, 1, 5), np.full(5, 10.0)
    for way_mm, doubt_ms in ((0.0201, 1.0), (0.0199, 0.99)):
        gap = np.array([way_mm + 0.03, way_mm + 0.02, way_mm + 0.01, way_mm, 0.0])
        found = first_contact(times, -gap, velocity, stop, None)
        assert found is not None
        assert found.time_ns == pytest.approx(4e6, abs=1.0)
        assert found.uncertainty_ns == pytest.approx(doubt_ms * 1e6 + 1.0)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("contact_s", [0.0161, 0.0165, 0.0169])
def test_the_speed_of_a_contact_is_that_of_the_row_before_the_stop_brakes_the_axis(
    contact_s: float, direction: int
) -> None:
    """The spring has taken some of 30 mm/s in the row after the contact, and more in the next."""
    speed_mm_s, k_over_m = 30.0, 5e5
    times, position, velocity = rows(contact_s, speed_mm_s, k_over_m)
    assert velocity[18] < velocity[17] < velocity[16] == speed_mm_s
    stop = StopPath.at_rest(-40.0, direction, len(times))
    places, speeds = -40.0 + direction * position, direction * velocity
    for stiffness in (k_over_m, None):
        found = first_contact(times, places, speeds, stop, stiffness)
        assert found is not None
        assert (found.row, found.speed_mm_s, found.position_mm) == (16, speed_mm_s, -40.0)


def test_an_axis_that_gains_speed_meets_its_stop_with_the_speed_of_the_row_before() -> None:
    """4000 mm/s2 from rest at 10 ms: 24 mm/s in the row at 16 ms, 28 mm/s one later."""
    times = (ROWS * 1_000_000).astype(np.int64)
    since = np.maximum(ROWS * STEP_S - 0.010, 0.0)
    place, speed = 2000.0 * since**2, 4000.0 * since
    for direction in (1, -1):
        stop = StopPath.at_rest(direction * 0.08, direction, len(times))
        found = first_contact(times, direction * place, direction * speed, stop, None)
        assert found is not None
        assert found.row == 16
        assert found.speed_mm_s == pytest.approx(24.0)
        # 0.08 mm after 6.325 ms; 24 mm/s would take 0.333 ms for what is left, 28 less
        assert abs(found.time_ns - (10e6 + 1e9 * math.sqrt(0.08 / 2000.0))) <= found.uncertainty_ns


def test_what_the_acceleration_before_the_contact_leaves_in_doubt() -> None:
    """Two accelerations a, a brake first: the larger size counts, 2 g/(v + sqrt(v^2 - 2 a g)).

    The gap is 0.005 mm at 10 mm/s; the rows before lost 2 and gained 1 mm/s in a millisecond.
    """
    times = (np.arange(6) * 1_000_000).astype(np.int64)
    speeds = np.array([11.0, 11.0, 11.0, 9.0, 10.0, 10.0])
    gaps = np.array([0.045, 0.034, 0.023, 0.013, 0.005, -0.004])
    for direction in (1, -1):
        stop = StopPath.at_rest(0.0, direction, 6)
        found = first_contact(times, -direction * gaps, direction * speeds, stop, None)
        assert found is not None
        assert found.row == 4
        assert found.time_ns == pytest.approx(4e6 + 0.5e6)
        late_s = 2 * 0.005 / (10.0 + math.sqrt(100.0 - 2 * 2000.0 * 0.005)) - 0.005 / 10.0
        assert found.uncertainty_ns == pytest.approx(late_s * 1e9 + 1.0)


@pytest.mark.parametrize(("brake_mm_s2", "is_known"), [(6249.0, True), (6251.0, False)])
@pytest.mark.parametrize("gains", [1.0, -1.0])
def test_an_acceleration_that_could_stop_the_axis_before_its_stop_leaves_the_whole_row_in_doubt(
    brake_mm_s2: float, is_known: bool, gains: float
) -> None:
    """10 mm/s come to rest in 0.008 mm with v^2/2s = 6250 mm/s2; either sign was there."""
    times = (np.arange(5) * 1_000_000).astype(np.int64)
    speeds = np.array([10.0, 10.0, 10.0 + gains * brake_mm_s2 * 1e-3, 10.0, 10.0])
    gaps = np.array([0.038, 0.028, 0.018, 0.008, -0.002])
    found = first_contact(times, -gaps, speeds, StopPath.at_rest(0.0, 1, 5), None)
    assert found is not None
    assert found.time_ns == pytest.approx(3.8e6)
    assert found.uncertainty_ns < 0.8e6 if is_known else found.uncertainty_ns == 1e6 + 1.0


def test_a_stiff_stop_leaves_a_bend_in_doubt_by_its_jerk() -> None:
    """Its force begins with J = k v (1 + a v)/m, a v below 1: at v a time of 2 k/m h^3/192."""
    times, position, velocity = rows(0.0165, 10.0, 1e6)
    begin = slice(16, None)  # no rows before: the free motion knows nothing
    stop = StopPath.at_rest(0.0, 1, len(times[begin]))
    found = first_contact(times[begin], position[begin], velocity[begin], stop, 1e6)
    assert found is not None
    assert found.row == 0
    assert found.uncertainty_ns == pytest.approx(2 * 1e6 * 1e-9 / 192 * 1e9 + 1.0)
    assert abs(found.time_ns - 0.0165e9) <= found.uncertainty_ns
    soft = first_contact(times[begin], position[begin], velocity[begin], stop, 1e9)
    assert soft is not None
    assert soft.uncertainty_ns == pytest.approx(1e6 + 1.0), "never more than the row"
