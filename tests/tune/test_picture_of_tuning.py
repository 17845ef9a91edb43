"""What the picture of a tuned loop draws: answers at their times, laws over the frequency."""

from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from tests.tune.test_findings import ADVICE, found, mode

from axisrig.bench.tools.tune.distance import BOTH_ENCODERS, CONST_DIST, SET_POS, Trial, Tuning
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law, Loop
from axisrig.bench.tools.tune.picture import _bode, _path, _steps, draw, kind_of
from axisrig.kernel.errors import UserError


class Axes:
    """Keeps what is drawn: kind of line, places, values, label."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, Any, Any, str]] = []
        self.title = self
        self.texts: dict[str, str] = {}
        self.across: list[float] = []

    def _line(self, kind: str) -> Any:
        def draw_line(x: Any, y: Any, *style: str, label: str, **_: Any) -> None:
            self.lines.append((kind, np.array(x), np.array(y), label))

        return draw_line

    def axhline(self, value: float, **_: Any) -> None:
        self.across.append(value)

    def __getattr__(self, name: str) -> Any:
        if name in {"step", "plot", "loglog", "semilogx"}:
            return self._line(name)
        return lambda *words, **_: self.texts.update({name: str(words)})


def drawn(part: Any, tuned: Tuning) -> list[tuple[str, Any, Any, str]]:
    axes = Axes()
    part(axes, tuned)
    return axes.lines


@pytest.mark.parametrize(("delay", "cycles"), [(2, 12), (5, 18), (200, 400)])
def test_the_answer_to_a_step_of_the_offset_is_the_sum_of_its_pulses(
    delay: int, cycles: int
) -> None:
    """0.25 and then 0.75 in cycles of 2 ms; it is drawn three times as long as it takes."""
    pulses = np.zeros(delay + 3)
    pulses[delay - 1 : delay + 1] = 0.25, 0.75
    made = replace(found(), period_s=2e-3, distance=Path(pulses, 0.0, 0.0))
    (kind, ms, values, label), (*_, motor) = drawn(_path, made)
    assert (kind, label, motor) == ("step", "distance", "motor")
    assert len(ms) == cycles
    assert ms[:4] == pytest.approx([0.0, 2.0, 4.0, 6.0])
    assert values[delay - 2 : delay + 2] == pytest.approx([0.0, 0.25, 1.0, 1.0])
    assert values[-1] == pytest.approx(1.0)


def tuned(
    *, is_stable: bool = True, rows: int | None = 100, advised: bool = True, rise: int = 10
) -> Tuning:
    """Of both encoders; a loop with one dead cycle, kp 0.5 as configured."""
    advice = replace(ADVICE, quality=replace(ADVICE.quality, rise_cycles=rise))
    both = mode(BOTH_ENCODERS, 1.0, is_stable=is_stable, advice=advice if advised else None)
    made = found(Law(0.5), modes=(mode(CONST_DIST, 1.0), both, mode(SET_POS, 2.0)))
    ran = None if rows is None else np.linspace(0.0, 1.0, rows)
    trial = None if ran is None else Trial(Law(0.25), ran, ran * 0.9, 0.001)
    configured: Any = made.configured
    configured.uses_both = True
    return replace(made, trial=trial, distance=Path(np.array([1.0]), 0.0, 0.0))


def test_the_step_of_the_set_value_as_it_ran_was_predicted_and_is_configured() -> None:
    """o(k) = o(k-1) + 0.5 (1 - o(k-1)): 0.5, 0.75, 0.875 of the step, a row each ms."""
    lines = drawn(_steps, tuned())
    assert [label for *_, label in lines] == ["kp 0.25, run", "predicted", "as configured"]
    run, predicted, configured = lines
    assert run[1][:3] == pytest.approx([0.0, 1.0, 2.0])
    assert predicted[2] == pytest.approx(run[2] * 0.9)
    assert configured[2][:3] == pytest.approx([0.5, 0.75, 0.875])
    # Six times the rise of 10 cycles of the suggested law
    assert {len(line[1]) for line in lines} == {60}


@pytest.mark.parametrize(
    ("rows", "advised", "rise", "shown"),
    [(100, True, 10, 60), (100, True, 4, 30), (20, True, 4, 30), (50, True, 10, 50),
     (100, False, 10, 100), (None, True, 10, 60)],
)  # fmt: skip
def test_how_much_of_a_step_is_shown(
    rows: int | None, advised: bool, rise: int, shown: int
) -> None:
    """As much as has run, 30 cycles at least."""
    lines = drawn(_steps, tuned(rows=rows, advised=advised, rise=rise))
    assert len(lines[-1][1]) == shown
    if rows is None:
        assert [label for *_, label in lines] == ["as configured"]
    assert drawn(_steps, tuned(is_stable=False))[-1][-1] == "as configured, unstable"


def test_the_open_loop_over_the_frequency() -> None:
    """L = kp q^-1/(1 - q^-1): its amount is kp/(2 sin(w/2)), its phase -90 degrees - w/2."""
    gain, phase = Axes(), Axes()
    _bode(gain, phase, tuned())
    assert [label for *_, label in gain.lines] == ["as configured, kp 0.5", "suggested, kp 0.25"]
    assert [label for *_, label in phase.lines] == ["as configured", "suggested"]
    angles = 2 * np.pi * gain.lines[0][1] * 1e-3
    assert angles[-1] == pytest.approx(np.pi)
    assert gain.lines[0][2] == pytest.approx(0.5 / (2 * np.sin(angles / 2)))
    expected = -90.0 - np.degrees(angles) / 2
    assert phase.lines[0][2] == pytest.approx(expected)
    assert (gain.across, phase.across) == ([1.0], [-180.0])
    alone = Axes()
    _bode(alone, Axes(), tuned(advised=False))
    assert len(alone.lines) == 1


def test_kinds_of_pictures() -> None:
    for name in ("a.svg", "a.PNG", "b/a.pdf"):
        assert kind_of(File(name)) == File(name)
    for name in ("a.txt", "a", "a.svg.gz"):
        with pytest.raises(UserError, match="no kind of picture"):
            kind_of(File(name))


@pytest.mark.long
def test_a_picture_is_the_same_each_time(tmp_path: File) -> None:
    """Without a date in it."""
    for name in ("a.svg", "b.svg"):
        draw(tuned(), tmp_path / name)
    first, second = ((tmp_path / name).read_text(encoding="utf-8") for name in ("a.svg", "b.svg"))
    assert first == second
    assert "CONST_DIST, both encoders, axis Z of rig.toml" in first
    assert "as configured" in first


@pytest.mark.parametrize("cycles", [1, 4, 9])
def test_the_phase_of_an_open_loop_goes_on_falling_with_its_dead_time(cycles: int) -> None:
    """L = kp q^-n/(1 - q^-1) as configured: -90 degrees + w/2 - n w, without a jump at -180."""
    made = tuned()
    late = Loop(1e-3, np.eye(1, cycles + 1, cycles)[0], np.array([1.0]))
    made = replace(made, modes=tuple(replace(mode, loop=late) for mode in made.modes))
    gain, phase = Axes(), Axes()
    _bode(gain, phase, made)
    angles = 2 * np.pi * phase.lines[0][1] * 1e-3
    assert phase.lines[0][2] == pytest.approx(-90.0 + np.degrees(angles) * (0.5 - cycles))
