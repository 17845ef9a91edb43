"""Each mode of a loop with its own feedback, and the step that tries a law: nothing runs."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.tune.test_findings import ADVICE, found, mode

from axisrig.bench.tools.tune import distance as tuning
from axisrig.bench.tools.tune.distance import (
    BOTH_ENCODERS,
    CONST_DIST,
    SET_POS,
    Configured,
    DeadTime,
    Mode,
)
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law
from axisrig.bench.tools.tune.measure import REST_CYCLES, Run, Signals, Steps
from axisrig.kernel.distance import DistanceLaw

MODES = [CONST_DIST, BOTH_ENCODERS, SET_POS]


def pulse(*values: float) -> Path:
    return Path(np.array(values), 0.0, 0.0)


def judged(
    monkeypatch: pytest.MonkeyPatch, law: Law, filtering: list[float], distance: Path,
    actual: Path, dead: DeadTime,
) -> list[Mode]:  # fmt: skip
    monkeypatch.setattr(tuning, "advise", lambda loop: loop)
    monkeypatch.setattr(tuning, "_closed_limit", lambda name, *_: float(MODES.index(name)))
    settings: Any = None
    listed = Configured(law, settings, np.array(filtering), False, DistanceLaw())
    return list(tuning._modes(listed, distance, actual, dead, 1e-3))


@pytest.mark.parametrize(
    ("reaction", "both"), [(0, [0, 0.5, 0, 0, 0.5]), (2, [0, 0, -0.5, 0.5, 1])]
)
def test_each_mode_sees_an_offset_in_its_own_way(
    reaction: int, both: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A mean of two; the drive is 2 cycles late, the sensor 3, the way a third number.

    d; d - (actual - the one that was sent 1 + reaction before); the offset before less
    (actual - d), all filtered but that offset.
    """
    modes = judged(monkeypatch, Law(0.1), [0.5, 0.5], pulse(0, 0, 0, 1), pulse(0, 0, 1),
                   DeadTime(reaction, 7, 1, None))  # fmt: skip
    assert [each.name for each in modes] == MODES
    feedbacks = [each.loop.feedback.tolist() for each in modes]
    assert feedbacks == [[0, 0, 0, 0.5, 0.5], both, [0, 1, -0.5, 0, 0.5]]
    for place, each in enumerate(modes):
        assert each.loop.noise.tolist() == [0.5, 0.5]
        assert (each.closed_limit, each.loop.period_s) == (float(place), 1e-3)
        advised: Any = each.advice
        assert advised is each.loop


@pytest.mark.parametrize(
    ("tn_s", "tv_s", "limit"), [(0.0, 0.0, 2.0), (0.01, 0.0, 4 / 2.1), (0.0, 2e-4, 2 / 1.4)]
)
def test_a_list_is_judged_with_its_own_parts(
    tn_s: float, tv_s: float, limit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where all is seen in the next cycle (Jury): 4/(2 + T/Tn) with an I part, 2/(1 + 2 Tv/T)
    with a D part; the range of kp does not depend on the kp of the list.
    """
    one = pulse(0, 1)
    for kp, is_stable in ((0.99 * limit, True), (1.01 * limit, False)):
        law = Law(kp, tn_s, tv_s)
        modes = judged(monkeypatch, law, [1.0], one, one, DeadTime(0, 1, 1, None))
        for each in modes[:2]:  # in SET_POS the D part does not look at the offset before
            assert each.stable_kp == (0.0, pytest.approx(limit, rel=1e-4))
            assert each.is_stable is is_stable


STEP_MM, REST_MM, BEGAN = 0.05, 2.5, REST_CYCLES + 20


@pytest.mark.parametrize(("rise", "cycles"), [(10, 300), (100, 300), (150, 450)])
@pytest.mark.parametrize("uses_both", [False, True])
def test_a_law_is_tried_by_a_step_as_long_as_three_rises(
    rise: int, cycles: int, uses_both: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """o(k) = o(k-1) + kp (1 - o(k-1)), seen two cycles later; the run is off by 1 % up and down.

    It is that of the mode the list has chosen; the distance before the step is the place of rest.
    """
    laws = {CONST_DIST: Law(0.25), BOTH_ENCODERS: Law(0.5), SET_POS: Law(0.125)}
    modes = tuple(
        replace(mode(name, 1.0, advice=replace(
            ADVICE, law=laws[name], quality=replace(ADVICE.quality, rise_cycles=rise))))
        for name in MODES
    )  # fmt: skip
    law = laws[BOTH_ENCODERS if uses_both else CONST_DIST]
    offset = 1.0 - (1.0 - law.kp) ** np.arange(1, cycles)
    answer = np.concatenate([[0.0, 0.0], offset])[: cycles - 1]
    errors = 0.01 * (-1.0) ** np.arange(cycles - 1)
    wanted = np.full(BEGAN + cycles + 30, 2.0)
    wanted[:40] = wanted[-10:] = np.nan  # before the control is on and when it is off again
    wanted[BEGAN:-10] += STEP_MM
    distance = np.full(len(wanted), REST_MM)
    distance[: BEGAN - REST_CYCLES // 2] = 77.0
    distance[BEGAN + cycles :] = 99.0
    distance[BEGAN + 1 : BEGAN + cycles] += STEP_MM * (answer + errors)
    asked: list[Any] = []

    def distance_step(*words: Any) -> Run:
        asked.append(words)
        nothing: Any = None
        signals = Signals(wanted, wanted * 0, wanted * 0, wanted * 0, distance)
        return Run(signals, nothing, nothing)

    monkeypatch.setattr(tuning, "distance_step", distance_step)
    made = found(modes=modes, distance=pulse(0, 0, 1))
    configured: Any = SimpleNamespace(**{**vars(made.configured), "uses_both": uses_both})
    made = replace(made, configured=configured)
    trial = tuning._tried(made)
    assert trial is not None
    assert asked == [(made.bench, law, made.rest_mm, STEP_MM, Steps(1, cycles, made.period_s))]
    assert trial.law == law
    assert trial.predicted == pytest.approx(answer)
    assert trial.seen == pytest.approx(answer + errors)
    assert trial.misfit_mm == pytest.approx(0.01 * STEP_MM, rel=1e-4)


def test_without_a_law_that_may_be_suggested_nothing_is_tried() -> None:
    modes = tuple(mode(name, 0.0, advice=None) for name in MODES)
    assert tuning._tried(found(modes=modes)) is None
