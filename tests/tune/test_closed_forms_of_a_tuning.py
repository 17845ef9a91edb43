"""The small numbers that a suggestion of `tune` is made of, each by its closed form."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune import distance as tuning
from axisrig.bench.tools.tune.advice import (
    KP_MAX,
    OVERSHOOT,
    SENSITIVITY_MAX,
    _calmest,
    _rounded_down,
    _two_digits,
    _with_integral,
    cycles_in_words,
    quality,
)
from axisrig.bench.tools.tune.distance import (
    BOTH_ENCODERS,
    CONST_DIST,
    SET_POS,
    DeadTime,
    _check_sensor,
    _closed_limit,
    _first_jump,
    _first_shown_ns,
    _loop,
    _paths,
)
from axisrig.bench.tools.tune.identify import Path, identify, renewal_cycles
from axisrig.bench.tools.tune.loop import Law, Loop, both_encoders, const_dist, set_pos, trimmed
from axisrig.bench.tools.tune.measure import Signals
from axisrig.kernel.distance import Derivative, DerivativeOf
from axisrig.kernel.distance.filters import FilterSettings
from axisrig.kernel.errors import UserError

# --- numbers


@pytest.mark.parametrize(
    ("value", "down", "near"),
    [(0.259, 0.25, 0.26), (0.25, 0.25, 0.25), (1.99, 1.9, 2.0), (0.0999, 0.099, 0.1),
     (0.1, 0.1, 0.1), (12.9, 12.0, 13.0)],
)  # fmt: skip
def test_two_digits(value: float, down: float, near: float) -> None:
    assert _rounded_down(value) == pytest.approx(down)
    assert _two_digits(value) == pytest.approx(near)


def test_one_cycle_and_several() -> None:
    assert [cycles_in_words(n) for n in (0, 1, 2)] == ["0 cycles", "1 cycle", "2 cycles"]


@pytest.mark.parametrize("kp", [0.1, 0.4, 1.3])
def test_the_quality_of_a_loop_without_dead_cycle(kp: float) -> None:
    """The error after k cycles is (1 - kp)^k: rise, area 1/kp or 1/(2 - kp), one step past it."""
    loop = Loop(1e-3, const_dist(np.ones(1), np.array([0.0, 1.0])), np.ones(1))
    got = quality(loop, Law(kp))
    error = (1 - kp) ** np.arange(200)
    assert got.rise_cycles == int(np.argmax(error <= 0.1))
    assert got.area_cycles == pytest.approx(np.abs(error).sum())
    assert got.overshoot == pytest.approx(max(kp - 1, 0))
    assert got.gain_margin == pytest.approx(2 / kp)
    assert got.noise_gain == pytest.approx(math.sqrt(kp / (2 - kp)))


@pytest.mark.parametrize("kp", [0.0005, 0.002])
def test_a_step_that_is_never_reached_is_not_passed(kp: float) -> None:
    """1 - (1 - kp)^n after n cycles is below 1, also after the 20 000 that are looked at."""
    found = quality(Loop(1e-3, const_dist(np.ones(1), np.array([0.0, 1.0])), np.ones(1)), Law(kp))
    assert found.overshoot == 0.0
    assert found.rise_cycles == pytest.approx(np.log(0.1) / np.log(1 - kp), abs=1.0)


def test_where_an_answer_begins_settles_and_has_its_centre() -> None:
    """Steps to 4 %, 5 %, 97 %, 98 % and the whole of 2."""
    path = Path(2 * np.diff([0, 0, 0.04, 0.05, 0.97, 0.98, 1.0]), 0.0, 0.0)
    assert (path.first_cycle, path.settled_cycle) == (2, 4)
    assert path.gain == pytest.approx(2.0)
    assert path.mean_cycle == pytest.approx(1 * 0.04 + 2 * 0.01 + 3 * 0.92 + 4 * 0.01 + 5 * 0.02)
    assert not path.is_dead_time
    for rest, is_dead in ((0.009, True), (0.011, False)):
        answer = np.array([0.0, 0.0, 1.0 - rest, rest])
        assert Path(answer, 0.0, 0.0).is_dead_time is is_dead


@pytest.mark.parametrize("every", [1, 2, 5])
def test_every_how_many_cycles_a_signal_is_new(every: int) -> None:
    offset = np.concatenate([np.zeros(50), np.cumsum(np.ones(300)) * 0.01])
    signal = offset[(np.arange(350) // every) * every]
    assert renewal_cycles(offset, signal, 50) == every


def answer(gain: float, settled: int) -> Path:
    """An answer of this gain, of which a half is there in cycle 2 and all in `settled`."""
    return Path(gain * (np.eye(1, 1000, 2)[0] + np.eye(1, 1000, settled)[0]) / 2, 0.0, 0.0)


@pytest.mark.parametrize(
    ("short", "tried"),
    [
        (answer(1.0, 239), [300]),
        (answer(1.0, 240), [300, 1000]),  # 0.8 of 300 cycles: it may not be over
        (answer(1.019, 100), [300]),
        (answer(1.021, 100), [300, 1000]),
        (answer(0.979, 100), [300, 1000]),
    ],
)
def test_an_answer_that_is_not_over_or_not_whole_is_measured_longer(
    short: Path, tried: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The surface is where the axis and its sensor say at the end of the rest: 30.05 - 2.05."""
    found = {300: short, 1000: answer(0.5, 990)}
    asked: list[tuple[float, float, int]] = []

    def steps(_bench: Any, surface_mm: float, step_mm: float, steps: Any) -> Any:
        asked.append((surface_mm, step_mm, steps.cycles))
        return SimpleNamespace(signals=steps.cycles)

    monkeypatch.setattr(tuning, "surface_steps", steps)
    monkeypatch.setattr(tuning, "_identified", lambda _, cycles: (found[cycles], short))
    lifted = np.repeat([0.0, 0.05], 300)
    rest = Signals(*(np.zeros(600),) * 3, actual_mm=30 + lifted, distance_mm=2.1 - lifted)
    run, path, actual = _paths(SimpleNamespace(), rest, 0.05, 1e-3)  # type: ignore[arg-type]
    assert [cycles for _, _, cycles in asked] == tried
    assert asked[0][:2] == pytest.approx((28.0, 0.05))
    assert (run.signals, path, actual) == (tried[-1], found[tried[-1]], short)


def test_noise_of_the_rest_is_that_of_the_signal() -> None:
    offset = np.concatenate([np.zeros(100), np.tile(np.repeat([1.0, 0.0], 50), 2)])
    signal = np.roll(offset, 2) + np.where(np.arange(300) % 2, 1e-3, -1e-3)
    path = identify(offset, signal, 100, 30)
    assert path.sigma_mm == pytest.approx(1e-3)
    assert (path.is_dead_time, path.first_cycle) == (True, 2)


def test_the_first_jump_and_the_first_value_that_shows_it() -> None:
    assert _first_jump(np.array([0.0, 0.1, 0.1, 1.0, 1.0, 3.1])) == 5
    assert _first_jump(np.array([0.0, 0.1, 0.1, -1.1, -1.1, 1.2])) == 3
    frames = np.arange(10) * 1000
    values = np.array([100, 101, 100, 101, 100, 101, 103, 104, 120, 120])
    sensor: Any = SimpleNamespace(frame_ns=frames, increments=values)
    # 100.5 +- (6 * 0.5 + 1): 104 is within, 120 is not
    assert _first_shown_ns(sensor, 5000) == 8000


@pytest.mark.parametrize(("count", "like"), [(0, 1), (1, 1), (4, 4)])
def test_a_mean_of_no_value_is_that_of_one(count: int, like: int) -> None:
    """P-AXIS-00413 may be 0: the filter then gives what it takes."""
    path = Path(np.eye(1, 20, 3)[0], 0.0, 0.0)
    found = []
    for values in (count, like):
        settings: Any = SimpleNamespace(
            filter=FilterSettings(kind="MOVING_AVERAGE", n_cycles=values)
        )
        for name in (CONST_DIST, BOTH_ENCODERS):
            found.append(_closed_limit(name, settings, path, path, DeadTime(1, 2, 1, None)))
    assert None not in found
    assert found[:2] == found[2:]


@pytest.mark.parametrize(
    ("name", "configured", "distance", "actual", "limit"),
    [
        (CONST_DIST, "MOVING_AVERAGE", 3, 3, "mean of dead"),
        (CONST_DIST, "MOVING_AVERAGE", 3, 2, "mean of dead"),
        (BOTH_ENCODERS, "MOVING_AVERAGE", 3, 3, "mean of reaction"),
        (BOTH_ENCODERS, "MOVING_AVERAGE", 3, 2, None),
        (SET_POS, "MOVING_AVERAGE", 3, 3, "surface"),
        (SET_POS, "MOVING_AVERAGE", 3, 2, None),
        (CONST_DIST, "LOWPASS", 3, 3, None),
    ],
)
def test_where_a_closed_form_holds(
    name: str, configured: str, distance: int, actual: int, limit: str | None
) -> None:
    """With n = 2 dead cycles and the mean of one value kp < 2 cos(n pi/(2n + 1)), FCT-M3's law."""
    settings: Any = SimpleNamespace(filter=FilterSettings(kind=configured, n_cycles=1))
    paths = [Path(np.eye(1, 20, cycle)[0], 0.0, 0.0) for cycle in (distance, actual)]
    got = _closed_limit(name, settings, *paths, DeadTime(1, 2, 1, None))
    cycles: Mapping[str, int] = {"mean of dead": 2, "mean of reaction": 1, "surface": 0}
    if limit is None:
        assert got is None
    elif limit == "surface":
        assert got == pytest.approx(2.0)
    else:
        n = cycles[limit]
        assert got == pytest.approx(2 * math.sin(math.pi / (2 * (2 * n + 1))))
    slow = Path(np.array([0.0, 0.5, 0.5]), 0.0, 0.0)
    assert _closed_limit(name, settings, slow, paths[1], DeadTime(1, 2, 1, None)) is None
    assert _closed_limit(name, settings, paths[0], slow, DeadTime(1, 2, 1, None)) is None


def test_feedbacks_of_the_modes() -> None:
    """What the control sees of an offset; the drive is 2 cycles late and the sensor 3."""
    drive, sensor = np.eye(1, 3, 2)[0], np.eye(1, 4, 3)[0]
    assert const_dist(np.ones(1), sensor).tolist() == [0, 0, 0, 1]
    # d - (Z_act - Z_com): the set position of the cycle before, one later with a reaction of one
    assert both_encoders(np.ones(1), sensor, drive).tolist() == [0, 1, -1, 1]
    assert both_encoders(np.ones(1), sensor, drive, 1).tolist() == [0, 0, 0, 1]
    # o of the cycle before less (actual - distance)
    assert set_pos(np.ones(1), sensor, drive).tolist() == [0, 1, -1, 1]
    assert set_pos(np.array([0.5, 0.5]), drive, drive).tolist() == [0, 1]
    assert trimmed(np.array([0.0, 1.0, 1e-13])).tolist() == [0, 1]
    assert trimmed(np.zeros(3)).tolist() == [0]


# --- a suggestion


def dead(cycles: int, gain: float = 1.0) -> Loop:
    """A pure dead time without a filter."""
    return Loop(1e-3, gain * np.eye(1, cycles + 2, cycles + 1)[0], np.ones(1))


def is_calm(loop: Loop, law: Law) -> bool:
    answer = loop.step_answer(law, 3000)
    return bool(answer.max() <= 1 + OVERSHOOT) and loop.sensitivity_peak(law) <= SENSITIVITY_MAX


@pytest.mark.long
def test_kp_is_the_largest_that_is_calm_and_that_the_list_may_have() -> None:
    """P-AXIS-00759 allows 2; else the next of two digits passes a step or has a larger Ms."""
    assert _calmest(dead(0, 0.1), 0.0) == Law(KP_MAX)
    assert _calmest(dead(0, 0.5), 0.0) == Law(2.0)
    assert _calmest(dead(0, -1.0), 0.0) is None
    for cycles in (1, 2):
        law = _calmest(dead(cycles), 0.0)
        assert law is not None
        assert is_calm(dead(cycles), law)
        assert not is_calm(dead(cycles), Law(law.kp + 0.01))


def test_the_shortest_tn_with_which_a_step_is_not_passed_by_more_than_a_tenth() -> None:
    """Of 31 between 20 and 20000 cycles, each a quarter longer than the one before."""
    loop = dead(1)
    plain = _calmest(loop, 0.0)
    assert plain is not None
    found = _with_integral(loop, plain)
    assert found is not None
    assert found.kp == plain.kp
    assert loop.step_answer(found, 20_000).max() <= 1.1
    assert loop.sensitivity_peak(found) <= SENSITIVITY_MAX
    shorter = replace(found, tn_s=found.tn_s / 1.2589)
    passes = loop.step_answer(shorter, 20_000).max() > 1.1
    assert passes or loop.sensitivity_peak(shorter) > SENSITIVITY_MAX or not loop.is_stable(shorter)
    assert found.tn_s == pytest.approx(_two_digits(found.tn_s))
    assert 20e-3 <= found.tn_s <= 20.0


# --- what is measured


def rested(moved: float, seen: float, sigma_mm: float = 0.0) -> Signals:
    """At rest, lifted by `moved`, at rest; the sensor value follows by `seen`, with noise."""
    place = np.repeat([0.0, moved], 400)
    noise = sigma_mm * np.where(np.arange(800) % 2, 1.0, -1.0)
    return Signals(np.zeros(800), np.zeros(800), place, place, 2.0 + place * seen + noise)


@pytest.mark.parametrize(
    ("seen", "is_right"),
    [(1.0, True), (1.29, True), (0.71, True), (1.31, False), (0.69, False), (-1.0, False),
     (0.0, False)],
)  # fmt: skip
def test_a_sensor_moves_with_its_axis(seen: float, is_right: bool) -> None:
    bench: Any = SimpleNamespace(rig=File("rig.toml"))
    if is_right:
        assert _check_sensor(bench, rested(0.05, seen)) == pytest.approx(0.0, abs=1e-12)
    else:
        words = f"the axis moved by 0.0500 mm up, the sensor value by {0.0 - 0.05 * seen:.4f} mm"
        with pytest.raises(UserError, match=words):
            _check_sensor(bench, rested(0.05, seen))
    assert _check_sensor(bench, rested(0.05, 1.0, 0.003)) == pytest.approx(0.003)


def test_with_noise_more_is_borne() -> None:
    """0.3 and six sigmas of a mean of 200 over the step of 0.05 mm: 0.02 mm make it 0.47."""
    bench: Any = SimpleNamespace(rig=File("rig.toml"))
    _check_sensor(bench, rested(0.05, 1.46, 0.02))
    with pytest.raises(UserError):
        _check_sensor(bench, rested(0.05, 1.48, 0.02))


@pytest.mark.parametrize("of", list(DerivativeOf))
@pytest.mark.parametrize("per", list(Derivative))
@pytest.mark.parametrize("name", [CONST_DIST, BOTH_ENCODERS, SET_POS])
def test_the_loop_under_the_law_that_the_rig_has_chosen(
    of: DerivativeOf, per: Derivative, name: str
) -> None:
    """Of the error: all alike. Of the feedback: no set value, and no offset of SET_POS."""
    choices = SimpleNamespace(derivative_of=of, derivative=per)
    configured: Any = SimpleNamespace(choices=choices, impulses=np.array([0.5, 0.5, 0.0]))
    feedback = np.array([0.0, 1.0, -1.0, 1.0])
    loop = _loop(name, configured, feedback, 2e-3)
    assert (loop.period_s, loop.noise.tolist()) == (2e-3, [0.5, 0.5])
    assert loop.is_per_cycle is (per is Derivative.PER_CYCLE)
    assert loop.unit_s == (1.0 if per is Derivative.PER_CYCLE else 2e-3)
    is_surface, of_error = name == SET_POS, of is DerivativeOf.ERROR
    assert loop.steps_with_set_value is (of_error or is_surface)
    if is_surface and not of_error:
        assert loop.looked_at is not None
        assert loop.looked_at.tolist() == [0.0, 0.0, -1.0, 1.0]
    else:
        assert loop.looked_at is None
