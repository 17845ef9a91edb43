"""The largest pole of what nothing excites: signals of known poles, and loops walked by hand."""

import math
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance.decay import growth_of
from axisrig.bench.oracles.errors import NoClosedFormError

K = np.arange(200)
NOISE = 1e-6


def rounded(values: np.ndarray) -> np.ndarray:
    """To the increments of a sensor, so that its rounding is about NOISE."""
    step = NOISE * math.sqrt(12.0)
    return np.round(values / step) * step


SIGNALS = {
    "one that swings": (0.01 * 0.985**K * np.cos(0.4 * K), 0.985),
    "slow and small beside fast and large": (0.05 * 0.8**K - 0.002 * 0.98**K, 0.98),
    "growing below a large transient": (0.05 * 0.9**K + 1e-4 * 1.01**K * np.cos(2.9 * K), 1.01),
    "from one side to the other": (0.01 * (-0.97) ** K, 0.97),
    "two equal poles": (0.01 * (1 + 0.1 * K) * 0.95**K, 0.95),
}


@pytest.mark.parametrize(("values", "largest"), SIGNALS.values(), ids=SIGNALS)
def test_the_largest_pole_of_a_signal(values: np.ndarray, largest: float) -> None:
    found = growth_of(rounded(values), NOISE)
    assert found is not None
    assert found.factor == pytest.approx(largest, abs=0.02 * abs(largest - 1.0) + 1e-4)
    assert abs(found.factor - largest) <= 5.0 * found.uncertainty


def steps(kp: float, g: float, r: float, count: int, n: int) -> np.ndarray:
    """Steps of the offset in CONST_DIST after the surface has stepped by 0.3 mm, by the formulas.

    o += kp (e + g sum e + r (e - e before)), e = -mean of the distances, which see o n + 1 later.
    """
    offsets, errors, total = [0.0] * (n + 1), [0.0], 0.0
    heights = np.zeros(600)
    heights[1:] = 0.3
    seen = [0.0] * count
    found = []
    for k in range(len(heights)):
        gap = round((offsets[-1 - n] - heights[k]) * 1e5) / 1e5
        seen = [gap, *seen[:-1]]
        error = -sum(seen) / count
        total += error
        found.append(kp * (error + g * total + r * (error - errors[-1])))
        errors.append(error)
        offsets.append(offsets[-1] + found[-1])
    return np.array(found)


def largest_pole(kp: float, g: float, r: float, count: int, n: int) -> float:
    """Of (1 - q)^2 + kp (1 - q + g + r (1 - q)^2) q^(n + 1) mean(q) = 0; without I part g 0."""
    q: Any = np.polynomial.Polynomial([0.0, 1.0])
    mean = sum((q**k for k in range(1, count)), np.polynomial.Polynomial([1.0])) / count
    control = (1 - q) * (1 + r * (1 - q)) + g
    whole = (1 - q) * ((1 - q) ** 2 + kp * control * q ** (n + 1) * mean)
    whole, _ = divmod(whole, 1 - q) if g else divmod(whole, (1 - q) ** 2)
    return float(max(1.0 / abs(root) for root in whole.roots()))


@pytest.mark.long(but=2)
@pytest.mark.parametrize("r", [10.0, 0.0, 0.5, 2.0])
@pytest.mark.parametrize("g", [0.02, 0.0])
@pytest.mark.parametrize(("kp", "count", "n"), [(0.05, 1, 1), (0.05, 4, 1), (0.1, 20, 2)])
def test_a_loop_with_integral_and_derivative(
    kp: float, g: float, r: float, count: int, n: int
) -> None:
    """Largest steps of two halves missed it by half of its distance from 1."""
    first = count + n + 3
    noise = 1e-5 * kp * (1.0 + r * math.sqrt(2.0) / count)
    found = growth_of(steps(kp, g, r, count, n)[first:], noise)
    largest = largest_pole(kp, g, r, count, n)
    assert found is not None
    assert found.factor == pytest.approx(largest, abs=0.05 * abs(largest - 1.0) + 3e-4)
    assert (found.factor < 1.0) == (largest < 1.0)


def test_what_is_excited_all_the_time_shows_nothing() -> None:
    noise = np.random.default_rng(7).normal(0.0, 1e-3, 300)
    with pytest.raises(NoClosedFormError, match="excites"):
        growth_of(noise, NOISE)


def test_what_is_within_the_noise_shows_nothing() -> None:
    assert growth_of(rounded(1e-6 * 0.99**K), NOISE) is None
    assert growth_of(np.zeros(0), NOISE) is None


@pytest.mark.long(but=1)
@pytest.mark.parametrize("values", [values for values, _ in SIGNALS.values()], ids=SIGNALS)
def test_its_doubt_is_how_far_both_ends_of_the_signal_differ(values: np.ndarray) -> None:
    """What is above 6 times the noise counts, to its last value; twice the larger difference."""
    values = rounded(values)
    count = int(np.flatnonzero(np.abs(values) > 6.0 * NOISE)[-1]) + 1
    quarter = count // 4
    found, first, last = (
        growth_of(part, NOISE) for part in (values, values[: count - quarter], values[quarter:])
    )
    assert found is not None
    assert first is not None
    assert last is not None
    assert (found.values, last.values) == (count, count - quarter)
    doubts = [abs(found.factor - one.factor) for one in (first, last)]
    assert found.uncertainty == pytest.approx(2.0 * max(doubts) + 1e-6)
    assert found.uncertainty > 1e-6


@pytest.mark.parametrize("rest", [1, 40, 400])
def test_what_rests_behind_a_signal_changes_nothing(rest: int) -> None:
    """Only what is above the noise counts, for the pole and for its doubt."""
    values = rounded(0.01 * 0.9 ** K[:60] * np.cos(0.4 * K[:60]))
    assert growth_of(np.concatenate([values, np.zeros(rest)]), NOISE) == growth_of(values, NOISE)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("begin", "pole"), [(1e-7, 1.05), (1e-7, -1.05), (1e-8, 1.08)])
def test_what_grows_out_of_the_noise_is_seen(begin: float, pole: float, sign: float) -> None:
    """It begins far below one increment."""
    found = growth_of(rounded(sign * begin * pole**K), NOISE)
    assert found is not None
    assert found.factor == pytest.approx(abs(pole), abs=1e-3)
    assert found.values == len(K)
