"""A sensor value that stands between: against the loop with polynomials, and walked by hand."""

from itertools import product

import numpy as np
import pytest

from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.model import first_order_drive
from axisrig.bench.oracles.distance.sample_hold import held_growth, held_limit
from axisrig.bench.oracles.distance.smoothing import cascade, exponential, moving_average, none

MS = 1_000_000


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
def test_with_every_value_it_is_the_loop_of_the_polynomials(mode: str) -> None:
    filters = (none(), moving_average(4), exponential(0.7, 4), cascade(2, 50.0, 1e-3))
    drives = (none(), first_order_drive(0.01, MS))
    controllers = ((0.0, 0.0), (0.01, 0.0), (0.0, 2.0), (0.02, 0.5))
    cycles = ((1, 0), (1, 2), (3, 0), (3, 2), (2, -1))  # -1: newer than the position
    for (n, s), smooth, drive, (g, r) in product(cycles, filters, drives, controllers):
        loop = Loop(mode, n, smooth, n - 1, s, g, r, drive)
        for kp in (0.05, 0.4, 1.2):
            assert held_growth(loop, 1, kp) == pytest.approx(growth(loop, kp), rel=0, abs=1e-6)


def left_after(kp: float, every: int, cycles: int) -> float:
    """CONST_DIST, two dead cycles, no filter, written out: the largest offset at the end."""
    offsets, held = [1.0, 1.0, 1.0], 0.0
    for k in range(cycles):
        if k % every == 0:
            held = offsets[-3]
        offsets.append(offsets[-1] - kp * held)
    return float(np.max(np.abs(offsets[-10:])))


@pytest.mark.parametrize("every", [2, 3, 4])
def test_the_limit_parts_loops_that_die_away_from_those_that_grow(every: int) -> None:
    limit = held_limit(Loop(CONST_DIST, 2), every)
    assert left_after(0.95 * limit, every, 4000) < 1e-6
    assert left_after(1.05 * limit, every, 4000) > 1e6


def test_a_longer_wait_for_a_value_is_never_better() -> None:
    for mode in (CONST_DIST, BOTH):
        loop = Loop(mode, 2, moving_average(4), 1)
        found = [held_limit(loop, every) for every in (1, 2, 3, 4)]
        assert found == sorted(found, reverse=True)


@pytest.mark.parametrize("of_error", [True, False])
@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
@pytest.mark.parametrize(("dead", "sent"), [(0, 0), (0, 2), (1, 3), (2, 0), (3, 1)])
def test_with_every_value_it_is_the_loop_of_any_derivative_and_of_any_age_of_z_com(
    mode: str, dead: int, sent: int, of_error: bool
) -> None:
    """Also where Z_com is older than what the sensor shows, and with the D part of the error."""
    for r in (0.0, 1.5):
        loop = Loop(mode, dead, moving_average(2), sent, 0, 0.01, r, of_error=of_error)
        for kp in (0.05, 0.4):
            assert held_growth(loop, 1, kp) == pytest.approx(growth(loop, kp), rel=0, abs=1e-6)


@pytest.mark.parametrize("every", [1, 2, 3, 5])
@pytest.mark.parametrize("kp", [0.05, 0.15, 0.35, 0.9])
def test_what_is_left_of_an_error_is_that_of_a_cycle(every: int, kp: float) -> None:
    """Without dead cycles N steps of kp times one value: 1 - N kp is left after N cycles."""
    found = held_growth(Loop(CONST_DIST, 0), every, kp)
    assert found == pytest.approx(abs(1.0 - every * kp) ** (1.0 / every), abs=1e-9)


@pytest.mark.parametrize("every", [1, 2, 3, 5])
def test_without_dead_cycles_a_value_lasts_for_two_of_its_errors(every: int) -> None:
    """|1 - N kp| = 1 at kp = 2/N; of the wrong sign no kp is stable."""
    assert held_limit(Loop(CONST_DIST, 0), every) == pytest.approx(2.0 / every, rel=1e-6)
    assert held_limit(Loop(CONST_DIST, 0, sign=-1), every) == 0.0
