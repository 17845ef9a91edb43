"""Noise through the filter of a loop, two digits of a Tn, and what a measuring run keeps."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.tune.test_picture_of_tuning import Axes, tuned

from axisrig.bench.tools.tune.advice import _with_integral, cycles_in_words
from axisrig.bench.tools.tune.loop import Law, Loop
from axisrig.bench.tools.tune.measure import _Log
from axisrig.bench.tools.tune.picture import _bode

T_S = 1e-3


@pytest.mark.parametrize("kp", [0.1, 0.5, 1.2])
def test_the_noise_of_an_offset_is_what_the_filter_leaves_of_that_of_the_sensor(kp: float) -> None:
    """o(k) = a o(k-1) - kp F n(k), a = 1 - kp, with an offset that is there in the next cycle.

    Without a filter kp/sqrt(1 - a^2); the mean of two values makes sqrt(kp/2) of it, whatever the
    path does to the offset alone.
    """
    path = np.array([0.0, 1.0])
    plain = Loop(T_S, path, np.array([1.0])).noise_gain(Law(kp))
    assert plain == pytest.approx(math.sqrt(kp / (2.0 - kp)))
    assert Loop(T_S, path, np.array([0.5, 0.5])).noise_gain(Law(kp)) == pytest.approx(
        math.sqrt(kp / 2.0)
    )
    # Noise that comes later is as large
    assert Loop(T_S, path, np.array([0.0, 0.0, 1.0])).noise_gain(Law(kp)) == pytest.approx(plain)


@pytest.mark.parametrize(
    ("calm_from_s", "tn_s"),
    [(0.0, 0.02), (0.021, 0.025), (0.11, 0.13), (0.14, 0.16), (1.3, 1.3), (1.31, 1.6), (19.0, 20.0),
     (20.1, None)],
)  # fmt: skip
def test_the_shortest_calm_tn_has_two_digits(calm_from_s: float, tn_s: float | None) -> None:
    """20 cycles of 1 ms to 20000, ten for each decade: 0.02, 0.025 .. 0.13, 0.16 .. 20 s."""

    def step_answer(law: Law, cycles: int) -> Any:
        return np.array([0.0, 1.0 if law.tn_s >= calm_from_s else 1.2, 1.0])[:cycles]

    loop: Any = SimpleNamespace(
        period_s=T_S, is_stable=lambda _: True, sensitivity_peak=lambda _: 1.5,
        step_answer=step_answer,
    )  # fmt: skip
    found = _with_integral(loop, Law(0.3, 0.0, 0.004))
    assert found == (None if tn_s is None else Law(0.3, tn_s, 0.004))


@pytest.mark.parametrize(
    ("peak", "overshoot", "is_stable", "is_taken"),
    [
        (2.0, 1.1, True, True), (2.0001, 1.1, True, False), (2.0, 1.1001, True, False),
        (2.0, 1.1, False, False),
    ],
)  # fmt: skip
def test_a_tn_is_calm_by_its_peak_its_step_and_its_stability(
    peak: float, overshoot: float, is_stable: bool, is_taken: bool
) -> None:
    """Ms 2 and 10 % at most."""
    loop: Any = SimpleNamespace(
        period_s=T_S, is_stable=lambda _: is_stable, sensitivity_peak=lambda _: peak,
        step_answer=lambda *_: np.array([0.0, overshoot, 1.0]),
    )  # fmt: skip
    assert (_with_integral(loop, Law(0.3)) is not None) is is_taken


@pytest.mark.parametrize(("count", "words"), [(0, "0 cycles"), (1, "1 cycle"), (2, "2 cycles")])
def test_cycles_have_their_plural(count: int, words: str) -> None:
    assert cycles_in_words(count) == words


@pytest.mark.parametrize("is_distance", [True, False])
def test_each_cycle_with_a_sensor_value_is_kept_also_one_at_zero(is_distance: bool) -> None:
    """The distance is the negative of the sensor value; without a set value there is NaN."""
    log = _Log("Z", is_distance)
    for sensor_mm, set_dist_mm, set_pos_mm in (
        (None, 1.0, 2.0), (-3.0, 1.0, 2.0), (0.0, None, 4.0), (0.5, 5.0, None), (None, 6.0, 6.0),
    ):  # fmt: skip
        control = SimpleNamespace(set_dist_mm=set_dist_mm, set_pos_mm=set_pos_mm, offset_mm=0.1)
        axes = {
            "X": SimpleNamespace(sensor_mm=9.0, control=None),
            "Z": SimpleNamespace(sensor_mm=sensor_mm, control=control),
        }
        links = [SimpleNamespace(name=n, set_mm=place, actual_mm=place + 0.25)
                 for n, place in (("X", 8.0), ("Z", 7.0))]  # fmt: skip
        channel: Any = SimpleNamespace(distance=SimpleNamespace(axes=axes), links=links)
        log(channel)
    found = log.signals()
    assert list(found.distance_mm) == [3.0, 0.0, -0.5]
    wanted = [1.0, math.nan, 5.0] if is_distance else [2.0, 4.0, math.nan]
    np.testing.assert_array_equal(found.wanted_mm, wanted)
    assert {*found.set_mm} == {7.0}
    assert {*found.actual_mm} == {7.25}
    assert {*found.offset_mm} == {0.1}


@pytest.mark.parametrize("cycles", [1, 4, 9])
def test_the_phase_of_an_open_loop_goes_on_falling_with_its_dead_time(cycles: int) -> None:
    """L = kp q^-n/(1 - q^-1) as configured: -90 degrees + w/2 - n w, without a jump at -180."""
    made = tuned()
    late = Loop(T_S, np.eye(1, cycles + 1, cycles)[0], np.array([1.0]))
    made = replace(made, modes=tuple(replace(mode, loop=late) for mode in made.modes))
    gain, phase = Axes(), Axes()
    _bode(gain, phase, made)
    angles = 2 * np.pi * phase.lines[0][1] * T_S
    assert phase.lines[0][2] == pytest.approx(-90.0 + np.degrees(angles) * (0.5 - cycles))
