"""REF: the zero is what the filter gives, so that the noise of one value does not stay in it.

The closed form is the noise gain of a filter, root of the sum of its squared weights: 1/sqrt(N)
for the mean of N values.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.distance import DistanceCommand, Reading
from axisrig.kernel.distance.control import STANDING_MAX
from axisrig.kernel.distance.filters import FilterSettings, filter_kinds, make_filter, memory_cycles
from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
NOISE_MM, GAP_MM, RUNS = 0.005, 2.0, 400


def zeros_mm(make_loop: Make, **settings: Any) -> np.ndarray:
    """Zero of many controls that begin at the noisy gap and refer as soon as they may."""
    rng, found = np.random.default_rng(5), []
    for _ in range(RUNS):
        control = make_loop(**settings).control
        sensor_mm = 0.0
        while True:
            sensor_mm = -GAP_MM + float(rng.normal(0.0, NOISE_MM))
            control.step(Reading(sensor_mm, 0.0, 0.0))
            if control.may_reference():
                break
        control.reference(sensor_mm)
        control.step(Reading(0.0, 0.0, 0.0))
        found.append(-control.sensor_mm)
    return np.array(found)


@pytest.mark.parametrize("count", [1, 4, 16])
@pytest.mark.long
def test_the_zero_has_the_noise_gain_of_the_mean(make_loop: Make, count: int) -> None:
    zeros = zeros_mm(make_loop, n_cycles=count)
    assert np.mean(zeros) == pytest.approx(-GAP_MM, abs=5 * NOISE_MM / math.sqrt(count * RUNS))
    # Of 400 values a standard deviation is known to 1/sqrt(800), 3.5 %: four of them
    assert np.std(zeros) == pytest.approx(NOISE_MM / math.sqrt(count), rel=0.14)


@pytest.mark.long
def test_the_zero_has_the_noise_gain_of_exponential_weights(make_loop: Make) -> None:
    weights = 0.2 * 0.8 ** np.arange(20)
    gain = math.sqrt(float(np.sum((weights / weights.sum()) ** 2)))
    zeros = zeros_mm(make_loop, filter_type="EXPO_MEAN", n_cycles=20, smoothing_factor=0.2)
    assert np.std(zeros) == pytest.approx(NOISE_MM * gain, rel=0.14)


@pytest.mark.parametrize("kind", sorted(filter_kinds()))
def test_a_quiet_sensor_is_exactly_0_after_ref_whatever_the_filter(
    make_loop: Make, kind: str
) -> None:
    """A filter has the gain 1, and what was before the first value was equal to it."""
    control = make_loop(filter_type=kind, n_cycles=6).control
    while not control.may_reference():
        control.step(Reading(-GAP_MM, 0.0, 0.0))
    control.reference(-GAP_MM)
    control.step(Reading(-GAP_MM, 0.0, 0.0))
    assert control.sensor_mm == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("count", [1, 4, 30])
def test_ref_waits_for_as_many_values_as_the_filter_remembers(make_loop: Make, count: int) -> None:
    control = make_loop(n_cycles=count).control
    waited = 0
    while not control.may_reference():
        control.step(Reading(-GAP_MM, 0.0, 0.0))
        waited += 1
    assert waited == count


def test_ref_with_a_filter_that_forgets_late_waits_for_1000_values(make_loop: Make) -> None:
    """0.1 Hz has its time constant at 1.6 s: REF of it ends all the same."""
    slow = {"low_pass_filter_order": 1, "low_pass_filter_fg_f0": 0.1}
    control = make_loop(filter_type="LOWPASS", **slow).control
    waited = 0
    while not control.may_reference():
        control.step(Reading(-GAP_MM, 0.0, 0.0))
        waited += 1
        assert waited <= STANDING_MAX
    assert waited == STANDING_MAX


def test_values_from_a_motion_do_not_count(make_loop: Make) -> None:
    """The sensor value falls while the axis is sent upwards; it stands 4 cycles at the end."""
    control = make_loop(n_cycles=4).control
    for cycle in range(20):
        place_mm = min(cycle, 16) * 0.1
        control.step(Reading(-place_mm, place_mm, place_mm))
        assert control.may_reference() is (cycle == 19)
    control.reference(-1.6)
    control.step(Reading(0.0, 0.0, 0.0))
    assert control.sensor_mm == 1.6


def test_before_a_surface_is_known_the_sensor_counts_for_ref_as_it_does_after(
    make_loop: Make,
) -> None:
    """A control of the channel without a mode only listens; twice, from the zero before."""
    control = make_loop(n_cycles=4).control
    for zero_mm in (-3.0, 1.25):
        control.forget_readings()
        for cycle in range(4):
            assert not control.may_reference()
            control.listen(zero_mm + 0.01 * cycle)
        assert control.may_reference()
        assert control.has_read
        control.reference(zero_mm)
        control.listen(zero_mm + 0.5)
        # The mean of 0, 10, 20, 30 um over the first value
        assert control.sensor_mm == pytest.approx(0.485)
        assert control.distance_mm == pytest.approx(-0.485)


def test_what_refuses_ref_does_not_wait(make_loop: Make) -> None:
    loop = make_loop(n_cycles=30)
    loop.control.set_surface(0.0)
    loop.say(DistanceCommand.ON)
    assert loop.control.may_reference()
    control = make_loop(filter_type="EXPO_MEAN", smoothing_factor=0.0).control
    assert control.may_reference()
    with pytest.raises(Alarm, match="ID 310003"):
        control.reference(0.0)


def test_a_low_pass_is_waited_for_until_a_hundredth_of_the_old_value_is_left() -> None:
    """One stage: (1 - g)/(1 + g) is left of an old value in each cycle, g = tan(pi f0 T)."""
    settings = FilterSettings("LOWPASS", low_pass_filter_order=1, low_pass_filter_fg_f0=25.0)
    slope = math.tan(math.pi * 25.0 * 1e-3)
    left = (1.0 - slope) / (1.0 + slope)
    expected = math.log(0.01) / math.log(left)
    made = make_filter("LOWPASS", settings, 1_000_000)
    assert memory_cycles(made) == pytest.approx(expected, abs=1.5)


@pytest.mark.parametrize(
    "settings",
    [
        FilterSettings("MOVING_AVERAGE", n_cycles=7),
        FilterSettings("EXPO_MEAN", n_cycles=20, smoothing_factor=0.3),
        FilterSettings("KALMAN_MA", n_cycles=4, kalman_sigma=1000.0),  # it passes 0 and comes back
        FilterSettings("KALMAN_MA", n_cycles=20, kalman_sigma=2000.0),
        FilterSettings("KALMAN_EXPO", 10, 0.3, 2000.0),
        FilterSettings("LOWPASS", low_pass_filter_order=4, low_pass_filter_fg_f0=25.0),
        FilterSettings("LOWPASS", low_pass_filter_order=0),
    ],
    ids=lambda settings: f"{settings.kind} {settings.n_cycles} {settings.low_pass_filter_order}",
)
def test_a_filter_has_forgotten_from_where_no_value_shows_a_hundredth_any_more(
    settings: FilterSettings,
) -> None:
    count = memory_cycles(make_filter(settings.kind, settings, 1_000_000))
    made = make_filter(settings.kind, settings, 1_000_000)
    made.restart(1.0)
    left = [abs(made.step(0.0)) for _ in range(400)]
    assert max(left[count - 1 :]) <= 0.01
    assert count == 1 or left[count - 2] > 0.01
