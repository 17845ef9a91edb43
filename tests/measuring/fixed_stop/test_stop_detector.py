"""The criteria of one axis against closed forms and against brute force over the whole history."""

from collections.abc import Sequence
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.measuring.fixed_stop.detector import StopDetector
from axisrig.kernel.measuring.fixed_stop.record import Criteria

MS = 1_000_000
LAG, BOTH_MS = 1.0, 50


def cycles(
    criteria: Criteria,
    lags: Sequence[float],
    places: Sequence[float] | None = None,
    *,
    period_ns: int = MS,
    armed_from: int = 0,
) -> tuple[int | None, StopDetector]:
    """Number of the cycle in which all criteria hold first, and the detector then."""
    detector = StopDetector(criteria)
    places = places or [0.0] * len(lags)
    for k, (lag_mm, place_mm) in enumerate(zip(lags, places, strict=True)):
        detector.take(k * period_ns, lag_mm, place_mm, is_armed=k >= armed_from)
        if k >= armed_from and detector.is_fulfilled(window_decides=True):
            return k, detector
    return None, detector


def test_the_lag_must_exceed_its_limit() -> None:
    at_limit = cycles(Criteria(LAG, None, 0), [LAG] * 100)
    beyond = cycles(Criteria(LAG, None, 0), [LAG + 1e-9] * 100)
    assert (at_limit[0], beyond[0]) == (None, 0)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_lag_of_either_sign_counts(sign: int) -> None:
    found, detector = cycles(Criteria(LAG, None, 50 * MS), [sign * 2.0] * 100)
    assert (found, detector.beyond_ns) == (50, 0)


def test_one_cycle_below_the_limit_starts_the_time_anew() -> None:
    """P-AXIS-00332: the lag drops in the last cycle before the end of the time."""
    lags = [2.0] * 49 + [0.9] + [2.0] * 200
    found, detector = cycles(Criteria(LAG, None, 49 * MS), lags)
    assert (found, detector.beyond_ns) == (50 + 49, 50 * MS)


def test_the_lag_counts_from_the_arming_on() -> None:
    found, detector = cycles(Criteria(LAG, None, 50 * MS), [2.0] * 200, armed_from=30)
    assert (found, detector.beyond_ns) == (80, 30 * MS)


@pytest.mark.parametrize(
    ("time_ns", "found"), [(50 * MS, 50), (50 * MS + 1, 51), (49 * MS + 1, 50), (1, 1), (0, 0)]
)
def test_a_time_between_two_cycles_is_rounded_up(time_ns: int, found: int) -> None:
    assert cycles(Criteria(LAG, None, time_ns), [2.0] * 200)[0] == found


@pytest.mark.parametrize("feed_mm_s", [1.0, 10.0, 50.0])
@pytest.mark.parametrize("limit_mm", [0.5, 1.5])
def test_lag_of_an_axis_against_a_stop(feed_mm_s: float, limit_mm: float) -> None:
    """Lag grows from e0 by v t from the contact on: t_det = t_c + (L - e0) / v + tau."""
    e0_mm, contact_s, time_s = 0.2, 0.1234, 0.05
    lags = [e0_mm + max(0.0, feed_mm_s * (k / 1e3 - contact_s)) for k in range(4000)]
    found, _ = cycles(Criteria(limit_mm, None, 50 * MS), lags)
    expected_s = contact_s + (limit_mm - e0_mm) / feed_mm_s + time_s
    assert found is not None
    assert 0 <= found / 1e3 - expected_s < 1e-3 + 1e-9


@pytest.mark.parametrize("feed_mm_s", [1.0, 10.0, 50.0])
@pytest.mark.parametrize("window_mm", [0.001, 0.04])
def test_window_of_an_axis_against_a_stop(feed_mm_s: float, window_mm: float) -> None:
    """t_det = t_c + tau - W / v: so much of the last way before the contact is forgiven."""
    contact_s, time_s = 0.4321, 0.05
    places = [feed_mm_s * min(k / 1e3, contact_s) for k in range(1000)]
    found, detector = cycles(
        Criteria(None, window_mm, 50 * MS), [0.0] * 1000, places, armed_from=300
    )
    assert found is not None
    assert 0 <= found / 1e3 - (contact_s + time_s - window_mm / feed_mm_s) < 1e-3 + 1e-9
    assert detector.window_ns == found * MS


def test_the_record_has_the_begin_of_the_last_unbroken_times() -> None:
    """Both hold from cycle 5 on and again from cycle 12 on, after one cycle of something else."""
    detector = StopDetector(Criteria(LAG, 0.5, 2 * MS))
    places = [float(min(k, 3)) for k in range(11)] + [9.0] + [3.0] * 10
    lags = [0.0] * 5 + [2.0] * 6 + [0.0] + [2.0] * 10
    for k, (lag_mm, place_mm) in enumerate(zip(lags, places, strict=True)):
        detector.take(k * MS, lag_mm, place_mm, is_armed=True)
        if k == 10:
            assert (detector.beyond_ns, detector.window_ns) == (5 * MS, 5 * MS)
    assert (detector.beyond_ns, detector.window_ns) == (12 * MS, 14 * MS)


def test_the_window_slides() -> None:
    """In blocks of 50 cycles the last whole one behind the contact would end at 150."""
    places = [0.1 * min(k, 70) for k in range(300)]
    assert cycles(Criteria(None, 0.0, 50 * MS), [0.0] * 300, places, armed_from=60)[0] == 120


def test_the_window_looks_at_its_two_ends() -> None:
    """An axis that swings with a period of min_time is where it was: 00778 is a mean speed."""
    places = [0.5 if k % 50 == 25 else 0.0 for k in range(120)]
    assert cycles(Criteria(None, 0.0, 50 * MS), [0.0] * 120, places, armed_from=60)[0] == 60


def test_the_window_looks_back_behind_the_arming() -> None:
    standing = cycles(Criteria(None, 0.001, 50 * MS), [0.0] * 100, armed_from=10)
    assert standing[0] == 10
    moving = [0.01 * k for k in range(100)]
    assert cycles(Criteria(None, 0.001, 50 * MS), [0.0] * 100, moving, armed_from=10)[0] is None


@pytest.mark.parametrize(("window_mm", "found"), [(1.25, 20), (1.2, 40)])
def test_ramp_up_until_the_path_that_the_window_needs(window_mm: float, found: int) -> None:
    """From rest with a: a window W counts while a tau (t - tau/2) <= W for t >= tau.

    a 1000 mm/s2, tau 50 ms: at t = tau the axis is 1.25 mm on its way; armed in cycle 20 and 40.
    """
    places = [500.0 * (k / 1e3) ** 2 for k in range(200)]
    criteria = Criteria(None, window_mm, 50 * MS)
    assert cycles(criteria, [0.0] * 200, places, armed_from=found)[0] == found
    late = 51 if window_mm == 1.25 else 50
    assert cycles(criteria, [0.0] * 200, places, armed_from=late)[0] is None


def test_of_both_criteria_the_later_decides() -> None:
    both = Criteria(LAG, 0.01, 50 * MS)
    stands_at_100 = [float(min(k, 100)) for k in range(400)]
    lag_first = [2.0] * 400
    window_first = [2.0 if k >= 200 else 0.0 for k in range(400)]
    assert cycles(both, lag_first, stands_at_100, armed_from=1)[0] == 150
    assert cycles(both, window_first, stands_at_100, armed_from=1)[0] == 250


def test_without_a_criterion_nothing_is_ever_found() -> None:
    assert cycles(Criteria(None, None, 50 * MS), [9.0] * 200)[0] is None


def test_a_window_counts_only_when_it_may() -> None:
    for criteria, found in (
        (Criteria(None, 1.0, MS), False),
        (Criteria(LAG, 1.0, MS), False),
        (Criteria(LAG, None, MS), True),
    ):
        detector = StopDetector(criteria)
        for k in range(3):
            detector.take(k * MS, 2.0, 0.0, is_armed=True)
        assert detector.is_fulfilled(window_decides=False) is found
        assert detector.is_fulfilled(window_decides=True)


# Against brute force

LAGS = st.lists(st.sampled_from([-1.5, -1.0, 0.0, 0.999, 1.0, 1.001, 3.0]), min_size=1, max_size=60)
STEPS = st.lists(st.integers(-3, 3), min_size=60, max_size=60)


@given(
    lags=LAGS,
    steps=STEPS,
    time_us=st.integers(0, 12_000),
    period_us=st.sampled_from([250, 1000, 2000]),
    armed_from=st.integers(0, 30),
    window=st.one_of(st.none(), st.integers(0, 4)),
    limit=st.one_of(st.none(), st.just(LAG)),
)
@pytest.mark.long
def test_every_history_is_judged_as_by_brute_force(
    lags: list[float],
    steps: list[int],
    time_us: int,
    period_us: int,
    armed_from: int,
    window: int | None,
    limit: float | None,
) -> None:
    """Positions are whole numbers, so that no rounding decides."""
    places = [float(sum(steps[:k])) for k in range(len(lags))]
    n = ceil(time_us / period_us)
    judged_window = None if window is None or not time_us else float(window)

    def holds(k: int) -> bool:
        if limit is None and judged_window is None:
            return False
        begin = k - n
        if limit is not None and (
            begin < armed_from or any(abs(lag) <= limit for lag in lags[begin : k + 1])
        ):
            return False
        return judged_window is None or abs(places[k] - places[max(0, begin)]) <= judged_window

    expected = next((k for k in range(armed_from, len(lags)) if holds(k)), None)
    criteria = Criteria(limit, judged_window, time_us * 1000)
    found, _ = cycles(criteria, lags, places, period_ns=period_us * 1000, armed_from=armed_from)
    assert found == expected


# At rest


@pytest.mark.parametrize(
    ("criteria", "lag_mm", "is_held_off", "comes"),
    [
        (Criteria(LAG, None, MS), 1.1, True, True),
        (Criteria(LAG, None, MS), -1.1, True, True),
        (Criteria(LAG, None, MS), 1.0, True, False),
        (Criteria(LAG, 0.1, MS), 0.5, True, False),
        (Criteria(LAG, 0.1, MS), 1.1, True, True),
        (Criteria(LAG, 0.1, MS), 1.1, False, False),
        (Criteria(None, 0.1, MS), 0.5, True, True),
        (Criteria(None, 0.1, MS), 0.5, False, False),
        (Criteria(None, None, MS), 9.0, True, False),
    ],
)
def test_what_an_axis_at_rest_may_still_fulfil(
    criteria: Criteria, lag_mm: float, is_held_off: bool, comes: bool
) -> None:
    assert StopDetector(criteria).may_still_come(lag_mm, is_held_off=is_held_off) is comes


def test_the_largest_lag_is_one_of_either_sign_behind_the_arming() -> None:
    _, detector = cycles(Criteria(9.0, None, MS), [5.0, 0.5, -3.0, 1.0], armed_from=1)
    assert detector.largest_lag_mm == 3.0
