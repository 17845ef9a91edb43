"""Filters of the sensor value against closed forms and against scipy."""

import itertools

import numpy as np
import pytest
from scipy import signal

from axisrig.bench.oracles.distance import filters as oracle
from axisrig.kernel.distance.filters import Filter, FilterSettings, filter_kinds, make_filter
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.values import ParameterSet
from axisrig.kernel.time.clock import MS

T_S, SIGMA_PER_MM = 1e-3, 1e4
COUNTS, FACTORS, SIGMAS = (
    (1, 2, 4, 10, 20, 30, 99),
    (0.05, 0.3, 0.7, 1.0),
    (0.0, 100.0, 1000.0, 2e4),
)
ORDERS, FREQUENCIES = range(7), (10.0, 25.0, 50.0, 200.0, 250.0, 400.0)


def _cases() -> list[tuple[FilterSettings, oracle.Character]]:
    cases = []
    for n in COUNTS:
        for kind in ("DEFAULT", "MOVING_AVERAGE"):
            cases.append((FilterSettings(kind, n_cycles=n), oracle.moving_average(n)))
    for n, a in itertools.product(COUNTS, FACTORS):
        settings = FilterSettings("EXPO_MEAN", n_cycles=n, smoothing_factor=a)
        cases.append((settings, oracle.exponential_mean(n, a)))
    for n, sigma in itertools.product(COUNTS, SIGMAS):
        settings = FilterSettings("KALMAN_MA", n_cycles=n, kalman_sigma=sigma)
        cases.append((settings, oracle.kalman_mean(n, sigma / SIGMA_PER_MM)))
        for a in FACTORS:
            settings = FilterSettings("KALMAN_EXPO", n, a, sigma)
            cases.append((settings, oracle.kalman_exponential(n, a, sigma / SIGMA_PER_MM)))
    for order, f0 in itertools.product(ORDERS, FREQUENCIES):
        settings = FilterSettings("LOWPASS", low_pass_filter_order=order, low_pass_filter_fg_f0=f0)
        cases.append((settings, oracle.low_pass(order, f0, T_S)))
    return cases


CASES = _cases()


def _made(settings: FilterSettings) -> Filter:
    return make_filter(settings.kind, settings, 1 * MS, "Z")


def _run(settings: FilterSettings, values: np.ndarray, start: float = 0.0) -> np.ndarray:
    made = _made(settings)
    made.restart(start)
    return np.array([made.step(float(value)) for value in values])


def _impulse(settings: FilterSettings, length: int = 3000) -> np.ndarray:
    return _run(settings, np.eye(1, length)[0])


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("settings", "character"), CASES, ids=str)
def test_delay_behind_a_ramp_and_noise_gain(
    settings: FilterSettings, character: oracle.Character
) -> None:
    ramp = np.arange(3000) * 0.01
    lag_cycles = (ramp - _run(settings, ramp))[-1] / 0.01
    assert lag_cycles == pytest.approx(character.delay_cycles, abs=1e-8)
    energy = float(np.sum(_impulse(settings) ** 2))
    assert energy**0.5 == pytest.approx(character.noise_gain, rel=1e-9)


def test_filters_are_one_where_they_give_the_same_values() -> None:
    """A control keeps the filter that it has then, and takes the other one else (FCT-M3 4).

    A mean of two has the same weight of the newest value as an exponential one, others after it.
    """
    newest_half = [
        FilterSettings("MOVING_AVERAGE", n_cycles=2),
        *(FilterSettings("EXPO_MEAN", n, 0.5) for n in (58, 60)),
    ]
    few = [one for one, _ in CASES if one.n_cycles <= 4 and one.kind != "LOWPASS"]
    seen: dict[bytes, set[tuple[float, ...]]] = {}
    for settings in [*newest_half, *few]:
        seen.setdefault(_impulse(settings, 70).tobytes(), set()).add(_made(settings).character)
    assert len(seen) > 20
    assert max(map(len, seen.values())) == 1, "the same values, and not one filter"
    known = [character for (character,) in seen.values()]
    assert len({*known}) == len(known), "one filter, and other values"


@pytest.mark.parametrize("kind", filter_kinds())
def test_white_noise_comes_out_with_the_noise_gain(kind: str) -> None:
    settings, character = next(
        (s, c) for s, c in CASES if s.kind == kind and 0 < c.noise_gain < 0.8
    )
    noise = np.random.default_rng(7).normal(0.0, 1.0, 20_000)
    assert np.std(_run(settings, noise)[500:]) == pytest.approx(character.noise_gain, rel=0.05)


@pytest.mark.parametrize(("settings", "_"), CASES, ids=str)
def test_a_constant_comes_out_bit_by_bit(settings: FilterSettings, _: object) -> None:
    for value in (1 / 3, -27.4438, 1e-7, 123456.789):
        assert set(_run(settings, np.full(250, value), value)) == {value}


@pytest.mark.parametrize("n", [2, 4, 20, 99])
def test_moving_average_is_that_of_scipy(n: int) -> None:
    values = np.random.default_rng(n).normal(5.0, 1.0, 400)
    expected = signal.lfilter(np.full(n, 1 / n), 1, values - values[0]) + values[0]
    settings = FilterSettings("MOVING_AVERAGE", n_cycles=n)
    assert _run(settings, values, values[0]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(("n", "a"), [(3, 0.5), (30, 0.3), (99, 0.05)])
def test_exponential_mean_is_that_of_scipy(n: int, a: float) -> None:
    values = np.random.default_rng(n).normal(5.0, 1.0, 400)
    weights = signal.windows.exponential(n, 0, -1 / np.log(1 - a), sym=False)
    expected = signal.lfilter(weights / weights.sum(), 1, values)
    settings = FilterSettings("EXPO_MEAN", n_cycles=n, smoothing_factor=a)
    assert _run(settings, values)[n:] == pytest.approx(expected[n:], abs=1e-12)


@pytest.mark.parametrize(
    ("order", "f0"), [pair for pair in itertools.product(ORDERS, FREQUENCIES) if pair[0]]
)
def test_low_pass_is_that_of_scipy(order: int, f0: float) -> None:
    """One stage is a Butterworth filter of order 1, which is bilinear and bent to f0."""
    stage = signal.butter(1, f0, fs=1 / T_S, output="sos")
    values = np.random.default_rng(order).normal(5.0, 1.0, 400)
    settings = FilterSettings("LOWPASS", low_pass_filter_order=order, low_pass_filter_fg_f0=f0)
    expected = signal.sosfilt(np.repeat(stage, order, axis=0), values)
    assert _run(settings, values) == pytest.approx(expected, abs=1e-11)


@pytest.mark.long
def test_roll_off_is_20_db_per_decade_and_order() -> None:
    for order in range(1, 7):
        settings = FilterSettings("LOWPASS", low_pass_filter_order=order, low_pass_filter_fg_f0=1.0)
        _, response = signal.freqz(_impulse(settings, 6000), worN=[5.0, 50.0], fs=1 / T_S)
        fall_db = 20 * np.log10(abs(response[0]) / abs(response[1]))
        assert fall_db == pytest.approx(order * 20, rel=0.03)


@pytest.mark.parametrize("f0", [10.0, 50.0, 250.0])
def test_low_pass_never_swings(f0: float) -> None:
    """Up to a quarter of the cycle rate, from which on the pole of a stage is negative."""
    settings = FilterSettings("LOWPASS", low_pass_filter_order=6, low_pass_filter_fg_f0=f0)
    assert np.cumsum(_impulse(settings)).max() <= 1 + 1e-12


def _swing(settings: FilterSettings) -> float:
    """Area by which the answer to a step passes it, in step heights times cycles."""
    return float(np.clip(np.cumsum(_impulse(settings)) - 1, 0, None).sum())


def _half_way(settings: FilterSettings) -> int:
    return int(np.argmax(np.cumsum(_impulse(settings)) >= 0.5))


@pytest.mark.parametrize("kind", ["KALMAN_MA", "KALMAN_EXPO"])
@pytest.mark.parametrize("sigma", [1000.0, 2000.0, 20_000.0])
class TestKalman:
    """What FCT-M3 4.4 and 4.5 say of both Kalman filters."""

    def _of(self, kind: str, sigma: float, n: int, a: float = 0.1) -> FilterSettings:
        return FilterSettings(kind, n_cycles=n, smoothing_factor=a, kalman_sigma=sigma)

    def test_reacts_sooner_than_its_mean(self, kind: str, sigma: float) -> None:
        mean = "MOVING_AVERAGE" if kind == "KALMAN_MA" else "EXPO_MEAN"
        for n in (10, 20, 50):
            settings = self._of(kind, sigma, n)
            plain = FilterSettings(mean, n_cycles=n, smoothing_factor=0.1)
            assert _half_way(settings) < _half_way(plain)

    def test_more_values_smooth_better_and_swing_more(self, kind: str, sigma: float) -> None:
        all_n = [self._of(kind, sigma, n) for n in (2, 4, 10, 20, 50)]
        swings = [_swing(settings) for settings in all_n]
        noise = [float(np.sum(_impulse(settings) ** 2)) for settings in all_n]
        assert swings == sorted(swings)
        assert noise == sorted(noise, reverse=True)

    def test_a_small_sigma_gives_the_raw_values(self, kind: str, sigma: float) -> None:
        values = np.random.default_rng(3).normal(0.0, 1.0, 200)
        errors = [
            float(np.abs(_run(self._of(kind, sigma * share, 20), values) - values).max())
            for share in (1.0, 0.1, 0.001, 0.0)
        ]
        assert errors == sorted(errors, reverse=True)
        assert errors[-1] == 0.0


@pytest.mark.long
def test_a_greater_share_of_the_newest_value_swings_less() -> None:
    all_a = [FilterSettings("KALMAN_EXPO", 30, a) for a in (0.05, 0.1, 0.3, 0.5, 0.7)]
    swings = [_swing(settings) for settings in all_a]
    noise = [float(np.sum(_impulse(settings) ** 2)) for settings in all_a]
    assert swings == sorted(swings, reverse=True)
    assert noise == sorted(noise)


@pytest.mark.provokes(310001, 7, owner="Z", code=2, order=4, f0_hz=500.0, cycle_us=1000.0)
def test_a_low_pass_at_half_the_cycle_rate_is_refused() -> None:
    with pytest.raises(Alarm) as alarm:
        _made(FilterSettings("LOWPASS", low_pass_filter_fg_f0=500.0))
    assert (alarm.value.id, alarm.value.values["code"]) == (310001, 2)
    _made(FilterSettings("LOWPASS", low_pass_filter_fg_f0=499.999))


@pytest.mark.parametrize(("order", "f0_hz", "code"), [(7, 25.0, 1), (-1, 25.0, 1), (4, 0.0, 3)])
def test_low_passes_that_cannot_be(order: int, f0_hz: float, code: int) -> None:
    settings = FilterSettings("LOWPASS", low_pass_filter_order=order, low_pass_filter_fg_f0=f0_hz)
    with pytest.raises(Alarm) as alarm:
        _made(settings)
    assert (alarm.value.id, alarm.value.values["code"]) == (310001, code)


@pytest.mark.provokes(310003, 7, owner="Z", code=1, filter="MEDIAN")
def test_an_unknown_filter_is_refused() -> None:
    with pytest.raises(Alarm) as alarm:
        _made(FilterSettings("MEDIAN"))
    assert (alarm.value.id, alarm.value.values["code"]) == (310003, 1)


@pytest.mark.parametrize(
    ("settings", "code"),
    [
        (FilterSettings("MOVING_AVERAGE", n_cycles=100), 2),
        (FilterSettings("DEFAULT", n_cycles=-1), 2),
        (FilterSettings("EXPO_MEAN", smoothing_factor=0.0), 3),
        (FilterSettings("EXPO_MEAN", smoothing_factor=1.1), 3),
        (FilterSettings("KALMAN_MA", kalman_sigma=-1.0), 4),
    ],
)
def test_filters_that_cannot_be(settings: FilterSettings, code: int) -> None:
    with pytest.raises(Alarm) as alarm:
        _made(settings)
    assert (alarm.value.id, alarm.value.values["code"]) == (310003, code)


def test_what_a_filter_does_not_use_may_be_anything() -> None:
    _made(FilterSettings("MOVING_AVERAGE", smoothing_factor=7.0, low_pass_filter_order=9))


@pytest.mark.parametrize("prefix", ["kenngr.dist_ctrl[0].", "kenngr.distc."])
def test_settings_come_from_the_list(prefix: str) -> None:
    parameters = ParameterSet("axis")
    assert FilterSettings.read(parameters, "kenngr.dist_ctrl[0].") == FilterSettings()
    for name, text in {
        "filter_type": "KALMAN_EXPO",
        "n_cycles": "12",
        "smoothing_factor": "0.25",
        "kalman_sigma": "350.5",
        "low_pass_filter_order": "2",
        "low_pass_filter_fg_f0": "40",
    }.items():
        parameters.load(f"{prefix}{name}", text, Origin("axis.lst"))
    assert FilterSettings.read(parameters, "kenngr.dist_ctrl[0].") == FilterSettings(
        "KALMAN_EXPO", 12, 0.25, 350.5, 2, 40.0
    )


@pytest.mark.parametrize(
    ("kind", "expected"), [(None, "LOWPASS"), ("DEFAULT", "LOWPASS"), ("EXPO_MEAN", "EXPO_MEAN")]
)
def test_the_older_switch_chooses_the_low_pass(kind: str | None, expected: str) -> None:
    parameters = ParameterSet("axis")
    parameters.load("kenngr.distc.low_pass_filter_enable", "1", Origin("axis.lst"))
    if kind:
        parameters.load("kenngr.distc.filter_type", kind, Origin("axis.lst"))
    assert FilterSettings.read(parameters, "kenngr.dist_ctrl[0].").kind == expected


def test_the_channel_names_them_the_same_way() -> None:
    assert FilterSettings.read(ParameterSet("channel"), "dist_ctrl[0].").kind == "DEFAULT"
