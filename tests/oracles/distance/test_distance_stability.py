"""Limits of kp: closed forms against poles, poles against the model walked cycle by cycle."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles.distance.closed_forms import (
    aperiodic_limit,
    butterworth,
    exponential_limit,
    p_limit,
    pd_limit,
    pi_limit,
)

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth, poles
from axisrig.bench.oracles.distance.model import Law, Rig, first_order_drive, simulate
from axisrig.bench.oracles.distance.smoothing import (
    Smoothing,
    cascade,
    exponential,
    moving_average,
    none,
)
from axisrig.bench.oracles.distance.stability import closed_limit, is_stable, kp_limit, mean_limit

PERIOD_NS = 1_000_000
FILTERS = {
    "none": none(),
    "mean 4": moving_average(4),
    "mean 20": moving_average(20),
    "expo": exponential(0.3, 10),
    "cascade": cascade(3, 60.0, 1e-3),
    "butterworth": butterworth(2, 60.0, 1e-3),
}


@pytest.mark.parametrize(
    ("dead", "limit", "aperiodic"),
    [
        (0, 2.0, 1.0),
        (1, 1.0, 0.25),
        (2, 0.618, 0.148),
        (3, 0.445, 0.105),
        (4, 0.347, 0.082),
        (5, 0.285, None),
        (6, 0.241, None),
    ],
)
def test_p_control(dead: int, limit: float, aperiodic: float | None) -> None:
    """Published numbers, and the poles: the edge at the limit, a double pole where it swings."""
    loop = Loop(CONST_DIST, dead)
    assert p_limit(dead) == pytest.approx(limit, abs=5e-4)
    assert kp_limit(loop) == pytest.approx(p_limit(dead), rel=1e-7)
    assert (
        kp_limit(Loop(CONST_DIST, dead)) == kp_limit(loop) != kp_limit(Loop(CONST_DIST, dead + 1))
    )
    if aperiodic is not None:
        assert aperiodic_limit(dead) == pytest.approx(aperiodic, abs=5e-4)
    dominant = max(poles(loop, aperiodic_limit(dead) * 0.999), key=abs, default=0j)
    assert abs(dominant.imag) < 1e-9
    if dead:
        dominant = max(poles(loop, aperiodic_limit(dead) * 1.001), key=abs)
        assert abs(dominant.imag) > 1e-3


@pytest.mark.long
@given(count=st.integers(1, 30), dead=st.integers(0, 8))
@settings(max_examples=40, deadline=None)
def test_mean_in_the_loop(count: int, dead: int) -> None:
    limit = kp_limit(Loop(CONST_DIST, dead, moving_average(count)))
    assert limit == pytest.approx(mean_limit(count, dead), rel=1e-6)


def test_a_mean_of_one_is_no_filter() -> None:
    assert [mean_limit(1, n) for n in range(6)] == pytest.approx([p_limit(n) for n in range(6)])


@pytest.mark.long
@given(alpha=st.floats(0.7, 1.0))
@settings(max_examples=20, deadline=None)
def test_endless_exponential_mean(alpha: float) -> None:
    assert kp_limit(Loop(CONST_DIST, 0, exponential(alpha))) == pytest.approx(
        exponential_limit(alpha), rel=1e-6
    )


@pytest.mark.long
@given(part=st.floats(0.01, 12.0))
@settings(max_examples=20, deadline=None)
def test_pd_and_pi_control(part: float) -> None:
    assert kp_limit(Loop(CONST_DIST, 0, derivative=part)) == pytest.approx(pd_limit(part), rel=1e-6)
    slow = part / 100.0
    assert kp_limit(Loop(CONST_DIST, 0, integral=slow)) == pytest.approx(pi_limit(slow), rel=1e-6)


@pytest.mark.parametrize("dead", range(4))
@pytest.mark.parametrize("smoothing", FILTERS.values(), ids=FILTERS)
def test_surface_without_skew_is_stable_up_to_two(dead: int, smoothing: Smoothing) -> None:
    """The motion of the axis cancels in motor + sensor: pole 1 - kp beside those of the filter."""
    loop = Loop(SET_POS, dead, smoothing)
    assert kp_limit(loop) == pytest.approx(2.0, rel=1e-6)
    assert closed_limit(loop, 4) == 2.0
    assert growth(loop, 0.4) >= 0.6 - 1e-12


def test_surface_with_a_skew() -> None:
    """A sensor one cycle older than the motor encoder, one dead cycle: 2/3."""
    loop = Loop(SET_POS, 1, skew_cycles=1)
    assert kp_limit(loop) == pytest.approx(2.0 / 3.0, rel=1e-6)
    assert closed_limit(loop) == pytest.approx(2.0 / 3.0)
    assert is_stable(loop, 0.66)
    assert not is_stable(loop, 0.67)


def test_both_encoders_take_the_drive_out_of_the_loop() -> None:
    slow = first_order_drive(10e-3, PERIOD_NS)
    loop = Loop(BOTH, 1, drive=slow)
    assert growth(loop, 0.3) == pytest.approx(max(0.7, math.exp(-0.1)))
    assert kp_limit(loop) == pytest.approx(2.0, rel=1e-6)
    assert kp_limit(Loop(BOTH, 2, sent_cycles=1)) == pytest.approx(p_limit(1), rel=1e-6)
    assert kp_limit(Loop(CONST_DIST, 1, drive=slow)) < 0.7


def test_the_settings_of_the_manual() -> None:
    """kp 0.3 with a mean of 20 needs D; the default kp 1.0 with a mean of 4 no dead cycle."""
    assert growth(Loop(CONST_DIST, 0, moving_average(20)), 0.3) == pytest.approx(1.0075, abs=1e-4)
    with_d = [kp_limit(Loop(CONST_DIST, n, moving_average(20), derivative=10.0)) for n in range(4)]
    assert with_d == pytest.approx([0.522, 0.317, 0.233, 0.189], abs=1e-3)
    assert is_stable(Loop(CONST_DIST, 0, moving_average(4)), 1.0)
    assert not is_stable(Loop(CONST_DIST, 1, moving_average(4)), 1.0)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
@pytest.mark.parametrize("smoothing", [FILTERS["none"], FILTERS["mean 4"], FILTERS["cascade"]])
@pytest.mark.parametrize(("reaction", "skew"), [(0, 0), (1, 2)])
@pytest.mark.parametrize(("tn_s", "tv_s"), [(0.0, 0.0), (0.5, 0.0005)])
def test_the_model_grows_where_a_pole_is_outside(
    mode: str, smoothing: Smoothing, reaction: int, skew: int, tn_s: float, tv_s: float
) -> None:
    """3 % below the limit a step dies away, 3 % above it grows, as fast as the pole says."""
    loop = Loop(
        mode,
        1 + reaction,
        smoothing,
        sent_cycles=reaction,
        skew_cycles=skew,
        integral=1e-3 / tn_s if tn_s else 0.0,
        derivative=tv_s / 1e-3,
    )
    limit = min(kp_limit(loop), 4.0)
    for share in (0.97, 1.03):
        kp = limit * share
        rate = growth(loop, kp)
        count = min(int(40 / abs(math.log(rate))) + 400, 12000)
        law = Law(mode, Control(kp, tn_s, tv_s), PERIOD_NS, smoothing=smoothing)
        surface = np.where(np.arange(count) < 60, 0.0, 1e-3)
        course = simulate(
            law, Rig(reaction, skew_cycles=skew), surface, 5.0, 0.0 if mode == SET_POS else 5.0
        )
        size = np.abs(course.step_mm)
        third = count // 3
        first, last = float(np.max(size[third : 2 * third])), float(np.max(size[2 * third :]))
        if first > 1e-11 and last > 1e-11:
            assert math.log(last / first) / third == pytest.approx(
                math.log(rate), rel=0.2, abs=2e-4
            )
        else:
            assert rate < 1.0


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
def test_a_wrong_sign_is_never_stable(mode: str) -> None:
    for kp in (0.01, 0.2, 1.0):
        assert growth(Loop(mode, 1, sign=-1), kp) > 1.0
    assert kp_limit(Loop(mode, 1, sign=-1)) == 0.0
    assert growth(Loop(CONST_DIST, 0, sign=-1), 0.2) == pytest.approx(1.2)
