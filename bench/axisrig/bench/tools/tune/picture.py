"""The picture of `axisrig tune distance`: step answers, and Bode diagrams of the loop."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt

from axisrig.bench.tools.tune.distance import Tuning
from axisrig.bench.tools.tune.loop import Floats, Law
from axisrig.kernel.errors import UserError

SUFFIXES = (".svg", ".png", ".pdf")
_GAIN_MIN = 1e-3
STYLE: Any = {"svg.hashsalt": "axisrig", "svg.fonttype": "none", "font.size": 9}


def kind_of(target: Path) -> Path:
    """Refuse a picture of a kind that cannot be written."""
    if target.suffix.lower() not in SUFFIXES:
        raise UserError("no kind of picture", value=str(target), allowed=SUFFIXES)
    return target


def draw(found: Tuning, target: Path) -> None:
    """Write the picture; the suffix says its kind (svg, png, pdf)."""
    mpl.use("agg")
    with mpl.rc_context(STYLE):
        figure = plt.figure(figsize=(9, 6.5), layout="constrained")
        grid = figure.add_gridspec(2, 2)
        _path(figure.add_subplot(grid[0, 0]), found)
        _steps(figure.add_subplot(grid[1, 0]), found)
        gain = figure.add_subplot(grid[0, 1])
        _bode(gain, figure.add_subplot(grid[1, 1], sharex=gain), found)
        figure.suptitle(f"{found.chosen.name}, axis {found.bench.axis} of {found.bench.rig.name}")
        try:
            figure.savefig(target, metadata={"Date": None} if target.suffix == ".svg" else None)
        finally:
            plt.close(figure)


def _path(axes: Any, found: Tuning) -> None:
    """From a step of the offset to the distance and the motor."""
    cycles = np.arange(max(12, min(3 * found.distance.settled_cycle + 3, 400)))
    for path, label, line in ((found.distance, "distance", "-"), (found.actual, "motor", "--")):
        answer = np.cumsum(path.impulses)
        values = answer[np.minimum(cycles, len(answer) - 1)]
        axes.step(cycles * found.period_s * 1e3, values, line, where="post", label=label)
    axes.set_title("answer to a step of the offset")
    axes.set_xlabel("ms since the cycle that computed it")
    axes.set_ylabel("share of the step")
    _finish(axes)


def _steps(axes: Any, found: Tuning) -> None:
    """The closed loop after a step of the set value."""
    mode, configured = found.chosen, found.configured.law
    length = 60 if found.trial is None else len(found.trial.seen)
    if found.trial is not None:
        shown = 6 * mode.advice.quality.rise_cycles if mode.advice else length
        length = max(30, min(length, shown))
        times = _times(found, length)
        axes.plot(
            times, found.trial.seen[:length], ".", ms=4, label=f"kp {found.trial.law.kp:g}, run"
        )
        axes.plot(times, found.trial.predicted[:length], label="predicted")
    offset = mode.loop.offset_answer(configured, length)
    answer = np.convolve(offset, found.distance.impulses)[:length]
    state = "" if mode.is_stable else ", unstable"
    axes.plot(_times(found, length), answer, ":", label=f"as configured{state}")
    axes.set_ylim(-0.5, 2.0)
    axes.set_title("distance after a step of the set value")
    axes.set_xlabel("ms")
    axes.set_ylabel("share of the step")
    _finish(axes)


def _times(found: Tuning, length: int) -> Floats:
    return np.arange(length, dtype=np.float64) * found.period_s * 1e3


def _bode(gain: Any, phase: Any, found: Tuning) -> None:
    """Open loop over the frequency, for the configured and the suggested law."""
    mode = found.chosen
    laws: list[tuple[str, Law]] = [("as configured", found.configured.law)]
    if mode.advice is not None:
        laws.append(("suggested", mode.advice.law))
    angles = np.geomspace(1e-3, np.pi, 600)
    frequencies_hz = angles / (2 * np.pi * found.period_s)
    for label, law in laws:
        response = mode.loop.open_loop(law, angles)
        gain.loglog(frequencies_hz, np.abs(response), label=f"{label}, kp {law.kp:g}")
        phase.semilogx(frequencies_hz, np.degrees(np.unwrap(np.angle(response))), label=label)
    gain.axhline(1.0, color="grey", linewidth=0.8)
    phase.axhline(-180.0, color="grey", linewidth=0.8)
    gain.set_ylim(bottom=_GAIN_MIN)
    phase.set_ylim(-450, 0)
    gain.set_title("open loop: stable while the phase is above -180 where the gain is 1")
    gain.title.set_fontsize(8)
    gain.set_ylabel("gain")
    phase.set_ylabel("phase, degrees")
    phase.set_xlabel("Hz")
    _finish(gain)
    _finish(phase)


def _finish(axes: Any) -> None:
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
