"""How a signal dies away or grows, whatever its sign, and with noise at one of its ends."""

import numpy as np
import pytest

from axisrig.bench.judge.distance.decay import growth_of

K = np.arange(120)
NOISE = 1e-3


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("factor", [0.9, 0.97, 1.02])
def test_a_signal_below_zero_grows_as_one_above_it(factor: float, sign: float) -> None:
    values = sign * factor ** (K - 60.0)
    found = growth_of(values, 1e-6)
    assert found is not None
    assert found.factor == pytest.approx(factor, abs=1e-6)
    beyond = np.flatnonzero(np.abs(values) > 6e-6)
    assert found.values == beyond[-1] + 1


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("rows", [slice(0, 30), slice(90, 120)])
def test_the_growth_of_a_signal_that_is_noisy_at_one_end_is_right_within_its_doubt(
    rows: slice, seed: int
) -> None:
    """Three quarters without the noise show the pole itself; the doubt is twice what differs."""
    values = 0.5 * 0.99**K
    values[rows] += NOISE * np.random.default_rng(seed).standard_normal(30)
    found = growth_of(values, NOISE)
    assert found is not None
    assert found.values == len(K)
    assert abs(found.factor - 0.99) <= found.uncertainty / 2.0
    # Noise at one end tilts ln|x| by no more than its share there, over all values
    assert found.uncertainty < NOISE / (0.5 * 0.99 ** K[-1]) / len(K)
