"""Impulse responses found again from signals with and without noise."""

import numpy as np
import pytest

from axisrig.bench.tools.tune.identify import Floats, Path, _rounding_mm, identify

BEGIN, STEP_MM = 100, 0.1
SLOW = np.concatenate([np.zeros(3), 0.05 * 0.95 ** np.arange(297)])
RINGING = np.concatenate(
    [np.zeros(2), 0.1 * 0.9 ** np.arange(298) * (1 + 0.8 * np.sin(0.7 * np.arange(298)))]
)


def _identified(answer: Floats, sigma_mm: float) -> Path:
    steps = np.tile(np.repeat([STEP_MM, 0.0], 400), 3)
    offset = np.zeros(BEGIN + len(steps))
    for k, target in enumerate(steps, BEGIN):
        offset[k] = offset[k - 1] + 0.2 * (target - offset[k - 1])
    noise = np.random.default_rng(5).normal(0.0, sigma_mm, len(offset))
    return identify(offset, 7.0 + np.convolve(answer, offset)[: len(offset)] + noise, BEGIN, 300)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("cycles", [1, 2, 7])
@pytest.mark.parametrize("sigma_mm", [0.0, 1e-5, 1e-3])
def test_a_dead_time_is_found_as_one(cycles: int, sigma_mm: float) -> None:
    path = _identified(np.eye(1, 300, cycles)[0], sigma_mm)
    assert path.is_dead_time
    assert (path.first_cycle, path.settled_cycle) == (cycles, cycles)
    # The place of rest is known to sigma/sqrt(BEGIN), and the steps stand half of the time
    uncertainty = 3 * sigma_mm / BEGIN**0.5 / (STEP_MM / 2)
    assert path.gain == pytest.approx(1.0, abs=uncertainty + 1e-9)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("answer", [SLOW, RINGING], ids=["slow", "ringing"])
@pytest.mark.parametrize(("sigma_mm", "error"), [(0.0, 1e-6), (1e-5, 2e-3), (1e-3, 0.06)])
def test_step_answer_of_a_drive_is_found(answer: Floats, sigma_mm: float, error: float) -> None:
    path = _identified(answer, sigma_mm)
    assert not path.is_dead_time
    assert np.abs(np.cumsum(path.impulses - answer)).max() < error
    assert path.misfit_mm == pytest.approx(sigma_mm, rel=0.1, abs=1e-7)


@pytest.mark.long
def test_centre_and_gain_of_a_slow_path() -> None:
    path = _identified(SLOW, 0.0)
    assert path.mean_cycle == pytest.approx(float(np.arange(300) @ SLOW / SLOW.sum()), rel=1e-4)
    assert path.gain == pytest.approx(SLOW.sum(), rel=1e-6)


@pytest.mark.parametrize("before_mm", [0.4, -3.0])
def test_an_offset_that_was_there_before_is_no_part_of_the_answer(before_mm: float) -> None:
    """The axis rests with an offset from an earlier control; what counts is how it moves on."""
    steps = np.repeat([0.0, STEP_MM, 0.0, 2 * STEP_MM], 30)
    late = np.concatenate([np.zeros(3), steps[:-3]])
    for offset_mm in (0.0, before_mm):
        path = identify(steps + offset_mm, 7.0 + late, 30, 20)
        assert path.impulses == pytest.approx(np.eye(1, 20, 3)[0], abs=1e-6)


NOISE_MM = np.tile([1e-3, -1e-3], 15)
"""Standard deviation 1 um around its mean of 0; the last one is a whole of it off."""


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_signal_rests_at_the_mean_of_what_it_was_and_not_where_it_was_last(sign: float) -> None:
    """With the last value in its place the gain would be a hundredth off: 1 um of 0.1 mm."""
    steps = np.repeat([0.0, STEP_MM, 2 * STEP_MM, STEP_MM], 30)
    late = np.concatenate([np.zeros(3), steps[:-3]])
    rest = np.concatenate([sign * NOISE_MM, np.zeros(90)])
    path = identify(steps, 7.0 + late + rest, 30, 20)
    assert path.impulses == pytest.approx(np.eye(1, 20, 3)[0], abs=1e-6)


def test_noise_at_rest_and_what_an_answer_leaves_are_two_numbers() -> None:
    """1 um at rest; in motion 3 um, which no answer explains."""
    steps = np.repeat([0.0, STEP_MM, 2 * STEP_MM, STEP_MM], 30)
    late = np.concatenate([np.zeros(3), steps[:-3]])
    noise = np.concatenate([NOISE_MM, 3 * NOISE_MM, -3 * NOISE_MM, 3 * NOISE_MM])
    path = identify(steps, 7.0 + late + noise, 30, 20)
    assert path.sigma_mm == pytest.approx(1e-3)
    assert path.misfit_mm == pytest.approx(3e-3, rel=0.02)  # 1 of 90 rows goes into the gain
    assert path.renewal_cycles == 1


@pytest.mark.parametrize("increment_mm", [1e-5, 2e-3])
def test_two_roundings_are_the_least_noise_of_a_signal(increment_mm: float) -> None:
    """Set position and encoder are rounded on their own, each by q/sqrt(12): q/sqrt(6) together.

    The increment is the smallest change, whatever larger ones and last bits there are.
    """
    draws = np.random.default_rng(3).uniform(-50.0, 50.0, (2, 20_000))
    off = np.std((draws - np.round(draws)).sum(axis=0)) * increment_mm
    places = np.array([700, 700, 701, 701, 699, 720, 720, 719.999_999_999_9])
    assert _rounding_mm(places * increment_mm) == pytest.approx(off, rel=0.02)
    assert _rounding_mm(places * increment_mm) == pytest.approx(increment_mm / 6**0.5)
    assert _rounding_mm(np.full(9, 7.0)) == 0.0
