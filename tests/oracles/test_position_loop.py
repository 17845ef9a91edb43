"""Limits of a position loop in the control against the poles of its difference equation."""

import math

import numpy as np
import pytest

from axisrig.bench.oracles.position_loop import dead_cycles, gain_limit, ramp_lag_mm


def largest_pole(gain: float, dead: int, *, is_held: bool) -> float:
    """The difference equation of the module, largest magnitude of its poles."""
    if is_held:
        poles = np.roots([1.0, -1.0, *[0.0] * (dead - 1), gain] if dead else [1.0, gain - 1.0])
    else:
        poles = np.roots([1.0, -1.0, *[0.0] * (dead - 1), gain / 2, gain / 2] if dead else
                         [1.0, gain / 2 - 1.0, gain / 2])  # fmt: skip
    return float(np.abs(poles).max())


@pytest.mark.parametrize("dead", [0, 1, 2, 3, 7])
@pytest.mark.parametrize("is_held", [True, False])
def test_the_limit_is_where_the_poles_leave_the_unit_circle(dead: int, *, is_held: bool) -> None:
    limit = gain_limit(dead, is_held=is_held)
    assert largest_pole(limit, dead, is_held=is_held) == pytest.approx(1.0, abs=1e-6)
    assert largest_pole(0.99 * limit, dead, is_held=is_held) < 1.0
    assert largest_pole(1.01 * limit, dead, is_held=is_held) > 1.0


def test_limits_of_a_held_speed_with_no_one_and_two_dead_cycles() -> None:
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    found = [gain_limit(dead, is_held=True) for dead in (0, 1, 2)]
    assert found == pytest.approx([2.0, 1.0, golden])


def test_a_speed_loop_counts_as_a_dead_time_which_is_below_its_true_limit() -> None:
    """First order, time constant 2 T, held: x and speed at the ends of cycles, one dead cycle."""
    dead, a = dead_cycles(0, 2_000_000, 1_000_000), math.exp(-0.5)
    assert dead == 3.0
    limit = gain_limit(dead, is_held=True)
    way = 2.0 * (1.0 - a)  # of the present speed in a cycle, T = 1
    true = []
    for gain in (limit, 2.0 * limit):
        # x, v, u: x' = x + way v + (1 - way) u, v' = a v + (1 - a) u, u' = -K x
        matrix = np.array([[1.0, way, 1.0 - way], [0.0, a, 1.0 - a], [-gain, 0.0, 0.0]])
        true.append(float(np.abs(np.linalg.eigvals(matrix)).max()))
    assert true[0] < 1.0 < true[1]


def test_the_lag_of_a_ramp() -> None:
    assert ramp_lag_mm(10.0, 10.0) == 1.0
    assert ramp_lag_mm(10.0, 10.0, 0.7) == pytest.approx(0.3)
    assert ramp_lag_mm(-10.0, 40.0) == -0.25


@pytest.mark.parametrize(
    ("late", "loop_ns", "period_ns", "dead"),
    [(0, 0, 1_000_000, 1.0), (2, 0, 1_000_000, 3.0), (0, 500_000, 1_000_000, 1.5),
     (1, 500_000, 2_000_000, 2.25), (3, 4_000_000, 2_000_000, 6.0)],
)  # fmt: skip
def test_carrier_and_speed_loop_add_to_the_one_cycle_that_is_always_dead(
    late: int, loop_ns: int, period_ns: int, dead: float
) -> None:
    assert dead_cycles(late, loop_ns, period_ns) == dead


@pytest.mark.parametrize("is_held", [True, False])
def test_a_fraction_of_a_dead_cycle_lies_between_the_whole_ones(*, is_held: bool) -> None:
    """The more is dead, the smaller the gain; at the limit the phase of the loop is -180 degrees.

    Held: -w n - w/2 - 90 with 2 sin(w/2) = K T; interpolated: -w n - w - 90 with 2 tan(w/2) = K T.
    """
    found = [gain_limit(dead, is_held=is_held) for dead in (0.0, 0.5, 1.0, 1.5, 2.0)]
    assert found == sorted(found, reverse=True)
    for dead, gain in zip((0.0, 0.5, 1.0, 1.5, 2.0), found, strict=True):
        w = 2.0 * (math.asin(gain / 2.0) if is_held else math.atan(gain / 2.0))
        phase = w * dead + (w / 2.0 if is_held else w) + math.pi / 2.0
        assert phase == pytest.approx(math.pi)


@pytest.mark.parametrize(("share", "lag_mm"), [(0.0, 0.5), (0.25, 0.375), (1.0, 0.0), (1.2, -0.1)])
def test_a_feed_forward_takes_its_share_of_the_lag(share: float, lag_mm: float) -> None:
    """More than the whole leads the axis ahead; 10 mm/s at 20/s, either way."""
    assert ramp_lag_mm(10.0, 20.0, share) == pytest.approx(lag_mm)
    assert ramp_lag_mm(-10.0, 20.0, share) == pytest.approx(-lag_mm)
