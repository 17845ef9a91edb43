"""Suggestions of `tune` from loops whose numbers are written down, and signals with increments."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune import advice as advising
from axisrig.bench.tools.tune.advice import (
    _calmest,
    _is_calm,
    _rounded_down,
    _with_derivative,
    _with_integral,
    quality,
)
from axisrig.bench.tools.tune.distance import (
    BOTH_ENCODERS,
    SET_POS,
    DeadTime,
    _closed_limit,
    _identified,
)
from axisrig.bench.tools.tune.identify import Path, identify, renewal_cycles
from axisrig.bench.tools.tune.loop import Law, Loop, const_dist
from axisrig.bench.tools.tune.measure import Signals, _Log
from axisrig.kernel.distance.filters import FilterSettings

# Numbers of a list


@pytest.mark.parametrize("power", range(-4, 2))
def test_a_number_of_two_digits_stays_as_it_is(power: int) -> None:
    """0.29 is a little less than 29 hundredths in binary: it does not become 0.28."""
    for digits in range(10, 100):
        value = float(f"{digits}e{power - 1}")
        assert _rounded_down(value) == pytest.approx(value, rel=1e-12)
        assert _rounded_down(value * 1.0001) == pytest.approx(value, rel=1e-12)
        below = (digits - 1 if digits > 10 else 9.9) * 10.0 ** (power - 1)
        assert _rounded_down(value * 0.9999) == pytest.approx(below, rel=1e-12)


# The largest kp that is calm


def loop_of(
    *,
    limit: Callable[[float], float] = lambda _: 1.6,
    peak: Callable[[Law], float] = lambda _: 1.5,
    highest: Callable[[Law], float] = lambda _: 1.0,
    is_stable: Callable[[Law], bool] = lambda _: True,
    **more: Any,
) -> Any:
    """limit: the largest stable kp by Tv. peak: Ms. highest: of a step answer."""
    asked: list[Law] = []

    def answer(law: Law, cycles: int) -> Any:
        asked.append(law)
        return np.array([0.0, 0.5, 0.95, highest(law), 1.0] + [1.0] * min(cycles, 10))

    given = {
        "stable_kp": lambda _tn_s=0.0, tv_s=0.0: (0.0, limit(tv_s)),
        "sensitivity_peak": peak, "is_stable": is_stable, "step_answer": answer,
        "noise_gain": lambda law: 1.0 + law.kp, "feedback": np.ones(3), "period_s": 2e-3,
        "unit_s": 2e-3, "asked": asked,
    }  # fmt: skip
    return SimpleNamespace(**(given | more))


@pytest.mark.parametrize(
    ("limits", "tv_s", "kp"),
    [
        ({0.0: 0.5, 0.004: 1.6}, 0.004, 1.6),
        ({0.0: 0.5, 0.004: 1.6}, 0.0, 0.5),
        ({0.0: 1.6, 0.004: 0.5}, 0.004, 0.5),
        ({0.0: float("inf")}, 0.0, 2.0),
        ({0.0: 3.7}, 0.0, 2.0),
        ({0.0: 1.99}, 0.0, 1.9),
        ({0.0: 0.0, 0.004: 1.6}, 0.0, None),
        ({0.0: 1.6, 0.004: 0.0}, 0.004, None),
    ],
)
def test_where_all_is_calm_kp_is_as_large_as_the_loop_and_the_list_allow(
    limits: dict[float, float], tv_s: float, kp: float | None
) -> None:
    """The limit is that with the same derivative time; P-AXIS-00759 allows 2."""
    found = _calmest(loop_of(limit=lambda tv_s: limits[tv_s]), tv_s)
    assert found == (None if kp is None else Law(kp, 0.0, tv_s))


@pytest.mark.parametrize(
    ("calm", "kp"), [(0.259, 0.25), (0.2501, 0.25), (0.0999, 0.099), (1.59, 1.5), (1.2e-4, 9.7e-5)]
)
def test_the_largest_calm_kp_is_rounded_down(calm: float, kp: float) -> None:
    """Never to more than is calm; the least that is tried is 1.6 halved 14 times, 9.77e-5."""
    found = _calmest(loop_of(highest=lambda law: 1.0 if law.kp <= calm else 1.5), 0.0)
    assert found == Law(kp, 0.0, 0.0)


def test_a_loop_that_is_never_calm_has_no_law() -> None:
    assert _calmest(loop_of(highest=lambda _: 1.5), 0.0) is None


@pytest.mark.parametrize(
    ("given", "calm"),
    [
        ({}, True),
        ({"peak": lambda _: 2.0}, True),
        ({"peak": lambda _: 2.001}, False),
        ({"highest": lambda _: 1.02}, True),
        ({"highest": lambda _: 1.0201}, False),
        ({"is_stable": lambda _: False}, False),
        ({"peak": lambda _: 2.001, "highest": lambda _: 1.0201}, False),
    ],
)
def test_a_law_is_calm_by_its_peak_and_by_its_step(given: dict[str, Any], calm: bool) -> None:
    assert _is_calm(loop_of(**given), Law(0.3)) is calm


def test_the_quality_is_that_of_the_law_with_all_its_parts() -> None:
    """Ms and noise of P, I and D part together; the margin of kp with the same Tn and Tv."""
    law = Law(0.4, 0.5, 0.006)
    loop = loop_of(
        peak=lambda law: 1.0 + law.kp + law.tn_s + law.tv_s,
        stable_kp=lambda tn_s, tv_s: (0.1, 1.0 + tn_s + 10 * tv_s),
        noise_gain=lambda law: law.kp * law.tn_s * law.tv_s,
        highest=lambda law: 1.0 + law.tv_s,
    )
    found = quality(loop, law)
    assert found.sensitivity == pytest.approx(1.906)
    assert found.noise_gain == pytest.approx(0.4 * 0.5 * 0.006)
    assert found.gain_margin == pytest.approx(1.56 / 0.4)
    assert (found.overshoot, found.rise_cycles) == (pytest.approx(0.006), 2)
    assert loop.asked == [law]


# The parts beside it


@pytest.mark.parametrize("unit_s", [2e-3, 1.0])
def test_tn_is_counted_in_cycles_whatever_the_derivative_is_counted_in(unit_s: float) -> None:
    """20 cycles of 2 ms are the shortest that is tried; the derivative part stays."""
    law = Law(0.3, 0.0, 0.004)
    assert _with_integral(loop_of(unit_s=unit_s), law) == Law(0.3, 0.04, 0.004)
    later = _with_integral(loop_of(unit_s=unit_s, is_stable=lambda law: law.tn_s > 1.0), law)
    assert later is not None
    assert 1.0 < later.tn_s <= 1.3  # each is a quarter longer than the one before
    assert _with_integral(loop_of(is_stable=lambda _: False), law) is None


@pytest.mark.parametrize(
    ("given", "there"),
    [
        ({"highest": lambda _: 1.1}, True),
        ({"highest": lambda _: 1.1001}, False),
        ({"peak": lambda _: 2.0}, True),
        ({"peak": lambda _: 2.001}, False),
    ],
)
def test_with_an_integral_part_a_tenth_is_passed_at_most(
    given: dict[str, Any], there: bool
) -> None:
    assert (_with_integral(loop_of(**given), Law(0.3)) is not None) is there


@pytest.mark.parametrize(
    ("area", "noise", "pays"),
    [(0.75, 1.5, True), (0.7501, 1.5, False), (0.75, 1.501, False), (0.5, 0.9, True)],
)
def test_a_derivative_time_pays_with_three_quarters_of_the_error_and_half_more_noise(
    monkeypatch: pytest.MonkeyPatch, area: float, noise: float, pays: bool
) -> None:
    """Half a cycle of 2 ms is the first; others of this loop have no law."""
    plain, faster = Law(0.2), Law(0.3, 0.0, 1e-3)
    laws = {1e-3: faster}
    monkeypatch.setattr(advising, "_calmest", lambda _, tv_s: laws.get(tv_s))
    monkeypatch.setattr(
        advising, "quality",
        lambda _, law: SimpleNamespace(area_cycles=40.0 * (area if law.tv_s else 1.0)),
    )  # fmt: skip
    loop = loop_of(noise_gain=lambda law: 0.3 * (noise if law.tv_s else 1.0))
    assert list(_with_derivative(loop, plain)) == ([faster] if pays else [])


def test_no_derivative_time_is_tried_that_the_list_may_not_have(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """P-AXIS-00765 allows 2: where it counts in cycles that is a half, one and two of them."""
    tried: list[float] = []
    monkeypatch.setattr(advising, "_calmest", lambda _, tv_s: tried.append(tv_s))
    monkeypatch.setattr(advising, "quality", lambda *_: SimpleNamespace(area_cycles=1.0))
    assert list(_with_derivative(loop_of(unit_s=1.0), Law(0.2))) == []
    assert tried == [0.5, 1.0, 2.0]
    tried.clear()
    assert list(_with_derivative(loop_of(), Law(0.2))) == []
    assert tried == pytest.approx([2e-3 * n for n in (0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32)])


# Closed forms


@pytest.mark.parametrize("name", [BOTH_ENCODERS, SET_POS])
@pytest.mark.parametrize(("distance", "actual"), [(3, 2), (2, 3), (4, 2), (2, 4)])
def test_a_sensor_that_is_sooner_or_later_than_the_motor_has_no_closed_form(
    name: str, distance: int, actual: int
) -> None:
    settings: Any = SimpleNamespace(filter=FilterSettings(kind="MOVING_AVERAGE", n_cycles=1))
    paths = [Path(np.eye(1, 20, cycle)[0], 0.0, 0.0) for cycle in (distance, actual)]
    assert _closed_limit(name, settings, *paths, DeadTime(1, 2, 1, None)) is None
    alike = _closed_limit(name, settings, paths[0], paths[0], DeadTime(1, 2, 1, None))
    assert alike is not None


# Ranges of kp


def is_stable(kp: float, dead: int, count: int, integral: float, rate: float) -> bool:
    """By the zeros x = 1/z of (1 - x)^2 + kp x^(1 + n) mean(x) C (1 - x).

    C (1 - x) = (1 - x) + i + r (1 - x)^2, with i = T/Tn and r = Tv/T.
    """
    back = np.polynomial.Polynomial([1.0, -1.0])
    path = np.polynomial.Polynomial([0.0] * (dead + 1) + [1.0])
    mean = np.polynomial.Polynomial([1.0 / count] * count)
    whole = back**2 + kp * path * mean * (back + integral + rate * back**2)
    return bool(np.abs(whole.roots()).min() > 1.0)


@pytest.mark.parametrize(
    ("dead", "count", "integral", "rate"),
    [(1, 1, 2.0, 2.0), (1, 2, 1.0, 2.0), (1, 2, 2.0, 5.0), (0, 4, 1.0, 2.0), (2, 1, 1.0, 5.0),
     (1, 4, 0.5, 2.0)],
)  # fmt: skip
def test_a_loop_may_be_stable_from_a_kp_on_and_up_to_another(
    dead: int, count: int, integral: float, rate: float
) -> None:
    """With a short Tn and a Tv: a kp below it lets the error swing, as one above it does."""
    loop = Loop(1e-3, const_dist(np.full(count, 1 / count), np.eye(1, dead + 2, dead + 1)[0]),
                np.ones(1))  # fmt: skip
    low, high = loop.stable_kp(1e-3 / integral, rate * 1e-3)
    assert 0.0 < low < high < 1.0
    for kp, stable in (
        (0.5 * low, False), (0.99 * low, False), (1.01 * low, True), ((low + high) / 2, True),
        (0.99 * high, True), (1.01 * high, False), (1.5 * high, False),
    ):  # fmt: skip
        assert is_stable(kp, dead, count, integral, rate) is stable
        assert loop.is_stable(Law(kp, 1e-3 / integral, rate * 1e-3)) is stable


@pytest.mark.parametrize("law", [Law(0.3), Law(0.3, 0.0, 2e-3), Law(0.2, 0.5, 1e-3)])
def test_every_part_acts_on_a_step_of_the_surface_whatever_acts_on_a_set_value(law: Law) -> None:
    """Where the D part takes the change of the feedback alone, only the set value passes by it."""
    path = np.array([0.0, 0.0, 1.0])
    with_it, without = (
        Loop(1e-3, path, np.ones(1), steps_with_set_value=steps) for steps in (True, False)
    )
    assert without.step_answer(law, 60) == pytest.approx(with_it.step_answer(law, 60))
    of_set = [each.offset_answer(law, 60)[0] for each in (with_it, without)]
    integral = 1e-3 / law.tn_s if law.tn_s else 0.0
    assert of_set == pytest.approx(
        [law.kp * (1 + integral + law.tv_s / 1e-3), law.kp * (1 + integral)]
    )


# Signals in increments


def moved(step_mm: float = 0.1, cycles: int = 60, count: int = 4) -> Any:
    """An offset at rest for 50 cycles, then steps up and down that it takes by a fifth a cycle."""
    offset = np.zeros(50 + cycles * count)
    for cycle in range(50, len(offset)):
        target = step_mm * (1 - (cycle - 50) // cycles % 2)
        offset[cycle] = offset[cycle - 1] + 0.2 * (target - offset[cycle - 1])
    return offset


def rounded(values: Any, increment_mm: float) -> Any:
    return np.round(values / increment_mm) * increment_mm


@pytest.mark.parametrize("increment_mm", [1e-3, 2e-3, 5e-3])
@pytest.mark.parametrize(("late", "gain"), [(1, 1.0), (3, 1.0), (6, 1.0), (3, 0.8), (3, 1.25)])
def test_a_dead_time_is_one_whatever_the_increments_of_the_sensor(
    increment_mm: float, late: int, gain: float
) -> None:
    """At rest they make no scatter: the rounding is in what moves."""
    offset = moved()
    signal = rounded(gain * np.concatenate([np.zeros(late), offset[:-late]]), increment_mm)
    path = identify(offset, 7.0 + signal, 50, 40)
    assert path.sigma_mm == pytest.approx(0.0, abs=1e-12)
    assert path.first_cycle == late
    assert np.count_nonzero(np.abs(path.impulses) > 1e-9) == 1
    assert path.gain == pytest.approx(gain, abs=0.02)
    assert path.misfit_mm < increment_mm


@pytest.mark.parametrize("every", [1, 2, 3, 4, 5, 7])
@pytest.mark.parametrize("increment_mm", [0.0, 1e-3, 4e-3])
def test_a_sensor_is_new_as_often_as_it_changes_while_much_moves(
    every: int, increment_mm: float
) -> None:
    """Where an offset comes to rest its last moves are below an increment: they say nothing."""
    offset = np.zeros(2050)
    for cycle in range(50, len(offset)):
        target = 4.0 * (1 - (cycle - 50) // 400 % 2)
        offset[cycle] = offset[cycle - 1] + 0.05 * (target - offset[cycle - 1])
    signal = offset[(np.arange(len(offset)) // every) * every]
    if increment_mm:
        signal = rounded(signal, increment_mm)
    assert renewal_cycles(offset, signal, 50) == every


@pytest.mark.parametrize("gain", [0.5, 0.9, 1.1, 2.0, -1.0])
@pytest.mark.parametrize("late", [1, 4])
def test_a_dead_time_has_its_gain(gain: float, late: int) -> None:
    """A sensor whose resolution is not that of the list, or whose sign is the other one."""
    offset = moved()
    signal = 3.0 + gain * np.concatenate([np.zeros(late), offset[:-late]])
    path = identify(offset, signal, 50, 40)
    assert path.impulses == pytest.approx(gain * np.eye(1, 40, late)[0], abs=1e-9)
    assert path.gain == pytest.approx(gain)
    assert path.misfit_mm == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("renewal", [2, 3, 4])
@pytest.mark.parametrize("flicker", [1, 2, 3])
def test_a_sensor_is_new_in_the_cycles_in_which_most_of_its_changes_come(
    renewal: int, flicker: int
) -> None:
    """Not in that of its first change: an increment that flickers once while all is at rest."""
    offset = np.concatenate([np.zeros(150), moved(cycles=48, count=8)])
    cycles = np.arange(len(offset))
    sensor = np.concatenate([np.zeros(3), offset[:-3]])
    distance = 2.0 + sensor[(cycles // renewal) * renewal]
    # A change in another cycle than those in which it is new, gone with the next new one
    at = 120 // renewal * renewal + flicker % renewal
    distance[at : (at // renewal + 1) * renewal] += 1e-5 * (flicker % renewal > 0)
    signals = Signals(offset * 0, offset, offset, 30.0 + offset, distance)
    found, _ = _identified(signals, 40)
    assert found.renewal_cycles == renewal
    assert found.first_cycle == 3 + renewal - 1
    assert found.gain == pytest.approx(1.0, abs=1e-3)


def test_a_control_that_got_no_distance_has_five_empty_signals() -> None:
    found = _Log("Z", False).signals()
    lengths = [len(values) for values in vars(found).values()]
    assert lengths == [0] * 5
