"""Which runs `axisrig tune distance` makes: how large its steps are, and how long they last."""

from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune import distance
from axisrig.bench.tools.tune.distance import DeadTime, tune
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.measure import REST_CYCLES, Signals, Steps

BENCH: Any = SimpleNamespace(rig=File("rig.toml"), axis="Z", variable=None)


def rested(rest_mm: float = 2.0, sigma_mm: float = 0.0) -> Signals:
    """At 100 mm, then lifted to 100.05 mm; noise up and down in turns."""
    place = np.repeat([100.0, 100.05], 2 * REST_CYCLES)
    noise = sigma_mm * np.where(np.arange(len(place)) % 2, 1.0, -1.0)
    nothing = np.zeros(len(place))
    return Signals(nothing, nothing, place, place, rest_mm + place - 100.0 + noise)


def answer(settled: int, gain: float = 1.0) -> Path:
    """A pulse after so many cycles."""
    return Path(gain * np.eye(1, 1000, settled)[0], 0.0, 0.0)


@pytest.mark.parametrize(
    ("paths", "lengths"),
    [
        ([answer(3)], [(6, 300)]), ([answer(239)], [(6, 300)]),
        ([answer(240), answer(240)], [(6, 300), (4, 1000)]),  # four fifths: not over yet
        ([answer(3, 1.021), answer(3)], [(6, 300), (4, 1000)]),
        ([answer(3, 0.981)], [(6, 300)]),
        ([answer(3, 0.5), answer(3, 0.5)], [(6, 300), (4, 1000)]),  # and it is left at that
    ],
)  # fmt: skip
def test_an_answer_that_is_not_over_is_measured_once_more_for_longer(
    paths: list[Path], lengths: list[tuple[int, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Around the surface: where the axis is less its distance, 98 mm."""
    runs: list[Any] = []

    def surface_steps(bench: Any, surface_mm: float, step_mm: float, steps: Steps) -> Any:
        assert (bench, step_mm, steps.period_s) == (BENCH, 0.1, 2e-3)
        assert surface_mm == pytest.approx(98.0)
        runs.append((steps.count, steps.cycles))
        return SimpleNamespace(signals=len(runs) - 1)

    actual = answer(1)

    def identified(place: int, cycles: int) -> tuple[Path, Path]:
        assert cycles == runs[place][1]
        return paths[place], actual

    monkeypatch.setattr(distance, "surface_steps", surface_steps)
    monkeypatch.setattr(distance, "_identified", identified)
    run, found, driven = distance._paths(BENCH, rested(), 0.1, 2e-3)
    assert runs == lengths
    assert (run.signals, found, driven) == (len(lengths) - 1, paths[-1], actual)


@pytest.mark.parametrize(
    ("asked_mm", "sigma_mm", "step_mm"),
    [(None, 0.0, 0.05), (None, 0.0004, 0.05), (None, 0.002, 0.2), (None, 0.01, 0.5),
     (0.02, 0.002, 0.02), (0.7, 0.0, 0.7)],
)  # fmt: skip
def test_steps_are_a_hundred_times_the_noise_within_limits_or_as_asked(
    asked_mm: float | None, sigma_mm: float, step_mm: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """0.05 mm at least and 0.5 mm at most; the axis is lifted by 0.05 mm to look at the sensor."""
    rig = SimpleNamespace(
        cycle=SimpleNamespace(period_us=2000), distance=SimpleNamespace(law="choices")
    )
    bench: Any = SimpleNamespace(
        rig=File("rig.toml"), axis="Z", variable=None,
        settings=lambda: SimpleNamespace(rig=rig, axis={"Z": "list"}),
    )  # fmt: skip
    asked: list[Any] = []

    def at_rest(*words: Any) -> Signals:
        asked.append(words)
        return rested(2.5, sigma_mm)

    def paths(*words: Any) -> Any:
        asked.append((words[0], *words[2:]))
        return "run", answer(3), answer(2)

    dead = DeadTime(1, 2, 1, None)
    monkeypatch.setattr(distance, "at_rest", at_rest)
    monkeypatch.setattr(distance, "_paths", paths)
    monkeypatch.setattr(distance.Configured, "read", lambda *words: words)
    monkeypatch.setattr(distance, "_dead_time", lambda *_, is_encoder: (dead, is_encoder))
    monkeypatch.setattr(distance, "_modes", lambda *words: [words])
    monkeypatch.setattr(distance, "_tried", lambda found: (found.step_mm, found.trial))
    found: Any = tune(bench, asked_mm)
    assert asked[0] == (bench, 0.05, 2e-3)
    assert asked[1] == (bench, pytest.approx(step_mm), 2e-3)
    assert (found.step_mm, found.rest_mm) == pytest.approx((step_mm, 2.5))
    assert (found.period_s, found.configured) == (2e-3, ("list", 2_000_000, "choices"))
    assert found.dead_time == (dead, True)
    (words,) = found.modes
    assert (words[0], words[3:]) == (found.configured, ((dead, True), 2e-3))
    assert found.trial == (pytest.approx(step_mm), None)
