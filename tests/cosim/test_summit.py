"""The largest value between rows: the summit of a polynomial through those around it."""

import math
from collections import deque
from collections.abc import Callable, Sequence

import pytest

from axisrig.kernel.cosim.plant.curves import peak

STEP_NS = 50_000


def found(times_ns: Sequence[int], value: Callable[[float], float]) -> float:
    rows = deque([0.0, value(time_ns * 1e-9)] for time_ns in times_ns)
    return peak(deque(times_ns), rows, 1, times_ns[0], times_ns[-1])


@pytest.mark.parametrize(
    "times_ns", [range(-50_000, 160_000, STEP_NS), (0, 48_000, 50_000, 98_000, 148_000)]
)
def test_a_polynomial_of_degree_4_has_its_own_summit(times_ns: Sequence[int]) -> None:
    """f = 7 - (s - 1)^2 (1 + (s - 1)/3 + (s - 1)^2/7) with s = t / 60 us: 7 at 60 us."""

    def value(time_s: float) -> float:
        s = time_s / 60e-6 - 1.0
        return 7.0 - s * s * (1.0 + s / 3.0 + s * s / 7.0)

    assert found(times_ns, value) == pytest.approx(7.0, abs=1e-12)


@pytest.mark.parametrize("shift", range(0, 10))
def test_a_swing_with_decay_is_met_within_the_bound(shift: int) -> None:
    """exp(-a t) sin(w t): its fifth derivative is (a^2 + w^2)^(5/2) at most."""
    a, w = 400.0, 700.0

    def value(time_s: float) -> float:
        return math.exp(-a * time_s) * math.sin(w * time_s)

    begin_ns = 100_000 + shift * STEP_NS // 10
    most = value(math.atan2(w, a) / w)
    bound = 0.0303 * (STEP_NS * 1e-9) ** 5 * (a * a + w * w) ** 2.5
    assert bound < 1e-7 * most
    times_ns = range(begin_ns, begin_ns + 60 * STEP_NS, STEP_NS)
    assert found(times_ns, value) == pytest.approx(most, abs=bound)


def test_no_summit_reaches_over_the_begin_or_the_end_of_a_contact() -> None:
    """A contact of 4 rows between rows of 0: 1 - (s - 1)^2/4 of s = 0.2, 1.2, 2.2, 2.9."""

    def value(s: float) -> float:
        return max(0.0, 1.0 - (s - 1.1) ** 2 / 4.0) if 0.0 < s < 3.0 else 0.0

    places = (-1.8, -0.8, 0.2, 1.2, 2.2, 2.9, 3.9, 4.9)
    times_ns = [round(1e6 + place * 1e5) for place in places]
    rows = deque([value(place)] for place in places)
    assert peak(deque(times_ns), rows, 0, times_ns[0], times_ns[-1]) == pytest.approx(1.0)


def test_a_level_force_is_its_own_summit_and_no_row_has_none() -> None:
    times_ns = list(range(0, 400_000, STEP_NS))
    assert found(times_ns, lambda _: 3.0) == 3.0
    assert found(times_ns, lambda time_s: 1.0 + time_s) == pytest.approx(1.00035)
    assert peak(deque(times_ns), deque([1.0] for _ in times_ns), 0, 500_000, 600_000) == 0.0
