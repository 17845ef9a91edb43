"""Second encoder and digital input against closed forms."""

import pytest

ENCODER = "AxisRig.Sensors.SecondEncoder"
TERMINAL = "AxisRig.Sensors.DigitalInput"


def test_encoder_counts_fast_motion_without_events(load):
    """1 m/s and 1 nm: a thousand million counts a second."""
    fmu = load(ENCODER, x_end=1.0, x_rate_start=1.0, x_rate_end=1.0, step_size=1.0, offset=0.1)
    for k in range(1, 11):
        fmu.step_to(k * 0.0123)
        assert fmu.position == pytest.approx(0.1 + k * 0.0123, abs=0.6e-9)
        assert fmu.velocity == pytest.approx(1.0, rel=1e-12)


def test_encoder_tells_whole_counts(load):
    fmu = load(ENCODER, x_start=1.23456e-3, x_end=1.23456e-3, resolution=5e-6)
    assert fmu.position == pytest.approx(1.235e-3, abs=1e-15)


def test_scale_and_periodic_error(load):
    """At a quarter of the signal period the error is its amplitude."""
    at = 5e-6
    fmu = load(ENCODER, x_start=at, x_end=at, periodic_error=0.2e-6, resolution=1e-12)
    assert fmu.position == pytest.approx(at + 0.2e-6, abs=1e-12)
    grown = load(ENCODER, x_start=1.0, x_end=1.0, scale=1 + 11.5e-6)
    assert grown.position - 1.0 == pytest.approx(11.5e-6, abs=1e-9)


def edges(fmu, size, pulses, until):
    """Tell the edges of `pulses` (rise, fall) to a terminal, step by step."""
    for k in range(round(until / size)):
        end = (k + 1) * size
        rises = [r for r, _ in pulses if r <= end]
        falls = [f for _, f in pulses if f <= end]
        fmu.set(
            signal=len(rises) > len(falls),
            rising_time=rises[-1] if rises else 0.0,
            falling_time=falls[-1] if falls else 0.0,
            rising_count=len(rises),
            falling_count=len(falls),
        )
        fmu.step_to(end)
    return fmu


def stamp_ns(fmu, direction):
    return fmu.get(f"stamped_{direction}_seconds") * 10**9 + fmu.get(
        f"stamped_{direction}_nanoseconds"
    )


@pytest.mark.parametrize("size", [0.1e-3, 0.5e-3, 2e-3, 10e-3])
def test_stamps_do_not_depend_on_the_step(load, size):
    """Edges at 12.345678 and 37.654321 ms; 3 us, 20 us and 0.1 ms in the terminal."""
    start = {"rise_delay": 3e-6, "fall_delay": 20e-6, "filter_time": 0.1e-3}
    fmu = load(TERMINAL, clock_seconds=820454400, clock_nanoseconds=5, **start)
    edges(fmu, size, [(0.012345678, 0.037654321)], 0.06)
    epoch = 820454400 * 10**9 + 5
    assert abs(stamp_ns(fmu, "rising") - epoch - 12_448_678) <= 1
    assert abs(stamp_ns(fmu, "falling") - epoch - 37_774_321) <= 1
    assert fmu.stamped_rising_low_word == stamp_ns(fmu, "rising") % 2**32
    assert (fmu.stamped_rising_count, fmu.stamped_falling_count, fmu.level) == (1, 1, False)


def test_pulse_shorter_than_the_filter_leaves_no_stamp(load):
    fmu = edges(load(TERMINAL, filter_time=0.2e-3), 1e-3, [(0.0101, 0.01025)], 0.02)
    assert (fmu.stamped_rising_count, fmu.level) == (0, False)


def test_low_word_wraps_after_4_295_s(load):
    """One edge before and one behind 2^32 ns."""
    fmu = edges(load(TERMINAL), 0.05, [(4.29, 4.293)], 4.3)
    assert fmu.stamped_rising_low_word == pytest.approx(4.29e9, abs=1)
    fmu = edges(load(TERMINAL), 0.05, [(4.3, 4.33)], 4.4)
    assert fmu.stamped_rising_low_word == pytest.approx(4.3e9 - 2**32, abs=1)


def test_single_event_keeps_the_first_edge_until_rearmed(load):
    pulses = [(0.011, 0.012), (0.021, 0.022), (0.031, 0.032)]
    fmu = edges(load(TERMINAL, keep_first=True), 5e-3, pulses[:2], 0.025)
    assert abs(stamp_ns(fmu, "rising") - 11_000_000) <= 1
    last = edges(load(TERMINAL), 5e-3, pulses[:2], 0.025)
    assert abs(stamp_ns(last, "rising") - 21_000_000) <= 1
    fmu.set(rearm=True)
    fmu.set(rising_time=0.031, falling_time=0.032, rising_count=3, falling_count=3)
    fmu.step_to(0.04)
    assert abs(stamp_ns(fmu, "rising") - 31_000_000) <= 1


def test_jitter_stays_within_its_bound_and_repeats(load):
    found = []
    for seed in (1, 1, 2, 3):
        fmu = edges(load(TERMINAL, jitter=5e-6, seed=seed), 1e-3, [(0.0105, 0.015)], 0.02)
        found.append(stamp_ns(fmu, "rising") - 10_500_000)
    assert found[0] == found[1]
    assert len(set(found)) == 3
    assert all(abs(ns) <= 5001 for ns in found)
