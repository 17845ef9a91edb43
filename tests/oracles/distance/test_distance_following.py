"""Errors on ramps and sines, steps, clamps, filters: closed forms against the model."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal
from tests.oracles.distance.closed_forms import (
    acceleration_error_mm,
    butterworth,
    cycle_change_um,
    fastest_step_s,
    flank_um_s,
    left_of_step,
    offset_noise_gain,
    p_sine_gain,
)

from axisrig.bench.oracles.distance import filters
from axisrig.bench.oracles.distance.following import (
    ramp_error_mm,
    ramp_lag_mm,
    settling_cycles,
    sine_gain,
)
from axisrig.bench.oracles.distance.limits import (
    adaptive_mm_s2,
    downwards,
    lowest_step_mm,
    overshoot_mm,
)
from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.model import Law, Rig, first_order_drive, simulate
from axisrig.bench.oracles.distance.smoothing import (
    Smoothing,
    cascade,
    exponential,
    kalman,
    moving_average,
    none,
)

PERIOD_NS = 1_000_000
T = 1e-3
SMOOTH = [none(), moving_average(4), exponential(0.5, 8), cascade(2, 100.0, T)]


def limited(v: float, a: float, deviation: float = math.inf) -> Limits:
    return Limits(v, a, deviation, math.inf, -math.inf, math.inf)


@pytest.mark.parametrize(
    "smoothing",
    [*SMOOTH, exponential(0.05), cascade(8, 5.0, T), butterworth(4, 50.0, T)],
    ids=lambda s: s.name,
)
def test_the_noise_gain_is_that_of_the_impulse_response_of_scipy(smoothing: Smoothing) -> None:
    impulse = np.zeros(4000)
    impulse[0] = 1.0
    answer = signal.lfilter(smoothing.numerator, smoothing.denominator, impulse)
    assert smoothing.noise_gain == pytest.approx(float(np.sqrt(np.sum(answer**2))), rel=1e-12)


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
@pytest.mark.parametrize("smoothing", SMOOTH, ids=lambda s: s.name)
@pytest.mark.parametrize("reaction", [0, 1])
@pytest.mark.parametrize("lag_s", [0.0, 2e-3])
def test_ramp(mode: str, smoothing: Smoothing, reaction: int, lag_s: float) -> None:
    """Loop error before the update v T/kp in every mode; the tool is later by what the loop
    does not see.
    """
    speed, kp, count = 10.0, 0.05, 2500
    loop = Loop(
        mode,
        1 + reaction,
        smoothing,
        sent_cycles=reaction,
        drive=first_order_drive(lag_s, PERIOD_NS) if lag_s else none(),
    )
    surface = speed * T * np.arange(count, dtype=np.float64)
    law = Law(mode, Control(kp), PERIOD_NS, smoothing=smoothing)
    wanted = 0.0 if mode == SET_POS else 5.0
    course = simulate(law, Rig(reaction, lag_s=lag_s), surface, 5.0, wanted)
    assert course.error_mm[-1] == pytest.approx(ramp_error_mm(speed, kp, PERIOD_NS), rel=1e-6)
    behind = 5.0 - course.gap_mm[-1]
    assert behind == pytest.approx(ramp_lag_mm(loop, speed, kp, PERIOD_NS), rel=1e-6)


def test_ramp_of_the_domain_notes() -> None:
    """10 mm/s, kp 0.2, a mean of 4, the offset is held two cycles after its cycle: 75 um."""
    loop = Loop(SET_POS, 1, moving_average(4))
    assert ramp_lag_mm(loop, 10.0, 0.2, PERIOD_NS) == pytest.approx(0.075)


def test_pi_control_on_ramp_and_parabola() -> None:
    kp, tn, acceleration = 0.2, 0.1, 5.0
    time = T * np.arange(4000, dtype=np.float64)
    for surface, expected in (
        (10.0 * time, 0.0),
        (acceleration * time**2 / 2, acceleration_error_mm(acceleration, kp, tn, PERIOD_NS)),
    ):
        law = Law(CONST_DIST, Control(kp, tn), PERIOD_NS)
        course = simulate(law, Rig(), surface, 5.0, 5.0)
        assert course.error_mm[-1] == pytest.approx(expected, rel=5e-3, abs=1e-6)


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
@pytest.mark.parametrize("smoothing", SMOOTH, ids=lambda s: s.name)
@pytest.mark.parametrize("frequency_hz", [2.0, 10.0, 25.0])
def test_sine(mode: str, smoothing: Smoothing, frequency_hz: float) -> None:
    kp, count = 0.1, 4000
    loop = Loop(mode, 1, smoothing)
    surface = np.sin(2 * math.pi * frequency_hz * T * np.arange(count))
    law = Law(mode, Control(kp), PERIOD_NS, smoothing=smoothing)
    course = simulate(law, Rig(), surface, 5.0, 0.0 if mode == SET_POS else 5.0)
    tail = course.gap_mm[-2000:] - 5.0
    gain = math.sqrt(2.0 * float(np.mean(tail**2)))
    assert gain == pytest.approx(sine_gain(loop, kp, frequency_hz, PERIOD_NS), rel=1e-3)


@pytest.mark.parametrize("mode", [BOTH, SET_POS])
@pytest.mark.parametrize(("skew", "late"), [(1, 0), (3, 0), (-1, 1)])
def test_sine_of_a_loop_whose_reading_is_older_or_newer_than_its_position(
    mode: str, skew: int, late: int
) -> None:
    kp, frequency_hz, count = 0.1, 10.0, 3000
    surface = np.sin(2 * math.pi * frequency_hz * T * np.arange(count))
    law = Law(mode, Control(kp), PERIOD_NS, smoothing=none())
    rig = Rig(way_cycles=2 + late, skew_cycles=skew)
    course = simulate(law, rig, surface, 5.0, 0.0 if mode == SET_POS else 5.0)
    gain = math.sqrt(2.0 * float(np.mean((course.gap_mm[-2000:] - 5.0) ** 2)))
    loop = Loop(mode, 1 + late, none(), skew_cycles=skew)
    assert gain == pytest.approx(sine_gain(loop, kp, frequency_hz, PERIOD_NS), rel=1e-3)


@pytest.mark.parametrize(
    ("mode", "filtered_mm", "error_mm"),
    # The gap is 2 mm, the axis 0.3 mm past its set position: with both encoders the loop keeps
    # the gap that there would be at the set position
    [(CONST_DIST, 2.0, 3.0), (BOTH, 1.7, 3.3), (SET_POS, 10.3 - 2.0 - 5.0, 3.3)],
)
def test_what_the_model_reads_while_nothing_moves(
    mode: str, filtered_mm: float, error_mm: float
) -> None:
    law = Law(mode, Control(0.2), PERIOD_NS, smoothing=none())
    law.listen(-2.0, 10.3, 10.0, 5.0)
    assert (law.filtered_mm, law.error_mm) == pytest.approx((filtered_mm, error_mm))
    assert law.offset_mm == 0.0


def test_sine_of_a_loop_without_dead_time() -> None:
    loop = Loop(CONST_DIST, 0)
    for frequency_hz in (1.0, 50.0, 499.0):
        omega_t = 2 * math.pi * frequency_hz * T
        assert sine_gain(loop, 0.4, frequency_hz, PERIOD_NS) == pytest.approx(
            p_sine_gain(omega_t, 0.4)
        )
    assert p_sine_gain(math.pi, 0.4) == pytest.approx(2 / (2 - 0.4))


@pytest.mark.long
@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
@pytest.mark.parametrize("smoothing", SMOOTH[:3], ids=lambda s: s.name)
def test_noise_of_the_offset(mode: str, smoothing: Smoothing) -> None:
    kp, count = 0.2, 60_000
    noise = 1e-3 * np.random.default_rng(5).standard_normal(count)
    law = Law(mode, Control(kp), PERIOD_NS, smoothing=smoothing)
    wanted = 0.0 if mode == SET_POS else 5.0
    course = simulate(law, Rig(), np.zeros(count), 5.0, wanted, noise)
    expected = offset_noise_gain(Loop(mode, 1, smoothing), kp)
    assert np.std(course.offset_mm[200:]) * 1e3 == pytest.approx(expected, rel=0.03)


def test_noise_of_a_surface_at_kp_1_is_that_of_the_filter() -> None:
    loop = Loop(SET_POS, 1, moving_average(16))
    assert offset_noise_gain(loop, 1.0) == pytest.approx(0.25)


@pytest.mark.parametrize("kp", [0.2, 0.5, 1.0, 1.5])
def test_step_of_a_loop_without_dead_time(kp: float) -> None:
    """Surface mode: what is left is (1 - kp)^k, nothing at all after one cycle at kp 1."""
    law = Law(SET_POS, Control(kp), PERIOD_NS)
    course = simulate(law, Rig(), np.full(50, 1.0), 5.0, 0.0)
    left = [left_of_step(kp, k) for k in range(50)]
    assert course.error_mm == pytest.approx(left, abs=1e-12)


def test_settling_is_what_the_slowest_pole_leaves() -> None:
    loop, kp = Loop(CONST_DIST, 1), 0.2
    law = Law(CONST_DIST, Control(kp), PERIOD_NS)
    course = simulate(law, Rig(), np.full(200, 1.0), 5.0, 5.0)
    beyond = np.flatnonzero(np.abs(course.error_mm) > 1e-3)
    assert int(beyond[-1]) == pytest.approx(settling_cycles(loop, kp, 1e-3), abs=5)
    assert settling_cycles(loop, 1.1, 1e-3) == math.inf
    assert settling_cycles(Loop(SET_POS, 1), 1.0, 1e-3) == 0.0


def test_overshoot_behind_clamps() -> None:
    """Sample set of the manual: 10 mm/s, 100 mm/s2, kp 0.3, 1 ms: 0.47 mm."""
    assert overshoot_mm(0.3, PERIOD_NS, 10.0, 100.0) == pytest.approx(0.467, abs=1e-3)
    assert overshoot_mm(0.3, PERIOD_NS, 0.33, 100.0) == 0.0
    law = Law(SET_POS, Control(0.3, limiter="clamp"), PERIOD_NS, limited(10.0, 100.0))
    course = simulate(law, Rig(), np.full(3000, 2.8), 5.0, 0.0)
    beyond = float(np.max(course.offset_mm)) - 2.8
    # One cycle of the way of a step, since the law is sampled
    assert beyond == pytest.approx(overshoot_mm(0.3, PERIOD_NS, 10.0, 100.0), abs=10.0 * T)


def test_fastest_step() -> None:
    assert fastest_step_s(2.8, 10.0, 100.0) == pytest.approx(0.38)
    assert fastest_step_s(0.5, 10.0, 100.0) == pytest.approx(2 * math.sqrt(0.005))
    assert fastest_step_s(1.0, 10.0, 100.0) == pytest.approx(0.2)


def test_clamps_hold_to_the_last_digit() -> None:
    law = Law(SET_POS, Control(0.3), PERIOD_NS, limited(10.0, 100.0, 2.0))
    course = simulate(law, Rig(), np.full(1000, 2.8), 5.0, 0.0)
    assert np.max(np.abs(course.step_mm)) == pytest.approx(10.0 * T)
    assert np.max(course.offset_mm) == 2.0
    until = int(np.argmax(course.offset_mm)) - 1
    assert np.max(np.abs(np.diff(course.step_mm[:until]))) == pytest.approx(100.0 * T * T)


def test_weights_and_adaptive_acceleration() -> None:
    assert downwards(10.0, 0) == 10.0
    assert downwards(10.0, 400) == 4.0
    assert [adaptive_mm_s2(e, 100.0, 500.0, 0.1, 0.5) for e in (0.05, 0.3, -0.3, 2.0)] == (
        pytest.approx([100.0, 300.0, 300.0, 500.0])
    )


def test_only_the_way_down_is_weighted() -> None:
    assert lowest_step_mm(3.0, 1.0, 500) == 2.0
    assert lowest_step_mm(1.0, 1.0, 500) == 0.0
    assert lowest_step_mm(0.0, 1.0, 500) == -0.5
    assert lowest_step_mm(-1.0, 1.0, 500) == -1.5
    assert lowest_step_mm(0.5, 1.0, 500) == -0.25
    assert lowest_step_mm(0.5, 1.0, 0) == -0.5


def test_flank() -> None:
    """2.8 mm over 5 mm at 6 m/min and 1 ms: 560 units of 0.1 um in a cycle."""
    rate = flank_um_s(2.8, 5.0, 6000.0)
    assert rate == pytest.approx(56_000.0)
    assert cycle_change_um(rate, PERIOD_NS) == pytest.approx(56.0)


@given(
    alpha=st.floats(0.05, 0.95),
    count=st.integers(1, 40),
    sigma=st.sampled_from([0.0, 0.05, 0.2]),
    order=st.integers(0, 6),
    corner_hz=st.floats(10.0, 450.0),
)
@settings(max_examples=60, deadline=None)
def test_what_a_filter_does_to_a_loop_has_its_delay_and_noise(
    alpha: float, count: int, sigma: float, order: int, corner_hz: float
) -> None:
    """The polynomials against the closed forms of delay and noise gain."""
    mean, weighted = moving_average(count), exponential(alpha, count)
    pairs = [
        (mean, filters.moving_average(count)),
        (weighted, filters.exponential_mean(count, alpha)),
        (cascade(order, corner_hz, T), filters.low_pass(order, corner_hz, T)),
        (kalman(mean, sigma), filters.kalman_mean(count, sigma)),
        (kalman(weighted, sigma), filters.kalman_exponential(count, alpha, sigma)),
    ]
    for smoothing, character in pairs:
        assert smoothing.delay_cycles == pytest.approx(character.delay_cycles, rel=1e-6, abs=1e-7)
        assert smoothing.noise_gain == pytest.approx(character.noise_gain, rel=1e-6)


def test_filters_on_a_ramp_and_in_noise() -> None:
    assert moving_average(20).delay_cycles == pytest.approx(9.5)
    assert moving_average(16).noise_gain == pytest.approx(0.25)
    endless = exponential(0.3)
    assert endless.delay_cycles == pytest.approx(0.7 / 0.3)
    assert endless.noise_gain**2 == pytest.approx(0.3 / 1.7)
    for smoothing in (butterworth(3, 50.0, T), cascade(3, 50.0, T)):
        ramp = signal.lfilter(smoothing.numerator, smoothing.denominator, np.arange(3000.0))
        assert 2999.0 - ramp[-1] == pytest.approx(smoothing.delay_cycles, rel=1e-6)
    sharp = 1.0 / (2.0 * math.tan(math.pi * 50 * T) * math.sin(math.pi / 6))
    assert butterworth(3, 50.0, T).delay_cycles == pytest.approx(sharp)
    gain = abs(cascade(4, 60.0, T).response(np.array([2 * math.pi * 60 * T]))[0])
    assert gain == pytest.approx(0.25)


def test_filters_are_the_same_by_what_they_do_and_not_by_their_names() -> None:
    """A mean of one value does nothing; a low-pass is named by its order alone."""
    same = [none(), moving_average(1), exponential(1.0, 1)]
    others = [moving_average(2), exponential(0.5), exponential(0.25), cascade(2, 100.0, T),
              cascade(2, 90.0, T), cascade(3, 100.0, T)]  # fmt: skip
    assert all(one.is_same(two) for one in same for two in same)
    for place, one in enumerate(others):
        assert not one.is_same(none())
        assert [one.is_same(two) for two in others] == [n == place for n in range(len(others))]


@pytest.mark.parametrize("frequency_hz", [2.0, 40.0])
@pytest.mark.parametrize("integral", [0.0, 0.02])
@pytest.mark.parametrize(("derivative", "of_error"), [(0.0, True), (0.5, True), (0.5, False)])
@pytest.mark.parametrize("dead", [0, 2])
def test_a_sine_of_the_surface_is_followed_in_set_pos_as_a_walk_shows(
    frequency_hz: float, integral: float, derivative: float, of_error: bool, dead: int
) -> None:
    """e = z(k) - o(k - 1), o grows by kp (e + g sum e + r (d - d before)), d the error or z.

    At the SYNC the tool is at o(k - 1 - n); of the dead cycles nothing comes back to the loop.
    """
    kp, rows = 0.2, 3000
    phase = 2.0 * math.pi * frequency_hz * T * np.arange(rows)
    surface = np.sin(phase)
    offsets, total, before = np.zeros(rows), 0.0, 0.0
    for k in range(1, rows):
        error = surface[k] - offsets[k - 1]
        total += error
        looked_at = error if of_error else surface[k]
        step = error + integral * total + derivative * (looked_at - before)
        offsets[k], before = offsets[k - 1] + kp * step, looked_at
    late = np.concatenate([np.zeros(1 + dead), offsets[: rows - 1 - dead]])
    last = slice(rows - 1000, None)
    waves = np.stack([np.cos(phase[last]), np.sin(phase[last])], axis=1)
    parts, *_ = np.linalg.lstsq(waves, (surface - late)[last], rcond=None)
    loop = Loop(SET_POS, dead, integral=integral, derivative=derivative, of_error=of_error)
    found = sine_gain(loop, kp, frequency_hz, PERIOD_NS)
    assert found == pytest.approx(float(np.hypot(*parts)), rel=1e-6)
