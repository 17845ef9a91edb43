"""Parts of a run that closed forms are about: control on, surface at constant speed, and so on."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from axisrig.bench.judge.distance.truth import DistanceTruth, Flags
from axisrig.bench.oracles.distance.following import settling_cycles
from axisrig.bench.oracles.distance.loop import Loop, growth
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

JUDGED_SHARE = 0.2
"""Last share of a steady stretch that is judged."""
SETTLED_SHARE = 1e-3
"""What may be left of the transient when the judged share begins."""
_EVEN_MM = 2e-7


@dataclass(frozen=True)
class Stretch:
    """Rows begin .. end - 1 in which the control follows in one mode."""

    begin: int
    end: int
    mode: str

    @property
    def rows(self) -> slice:
        """For signals."""
        return slice(self.begin, self.end)

    @property
    def judged(self) -> slice:
        """Its last fifth."""
        return slice(self.end - max(int((self.end - self.begin) * JUDGED_SHARE), 1), self.end)


def active(truth: DistanceTruth) -> list[Stretch]:
    """Return the unbroken times in which the control followed, in order."""
    found = []
    for begin, end in runs_of(truth.is_active):
        cuts = np.flatnonzero(np.diff(truth.state[begin:end])) + 1 + begin
        edges = [begin, *cuts.tolist(), end]
        for first, last in itertools.pairwise(edges):
            found.append(Stretch(first, last, truth.mode_in(first)))
    return found


def last_active(truth: DistanceTruth) -> Stretch:
    """Return the last one; raises NoClosedFormError when the control was never on."""
    found = active(truth)
    if not found:
        raise NoClosedFormError("distance control was never on")
    return found[-1]


def runs_of(flags: Flags) -> list[tuple[int, int]]:
    """Return begin and end of every unbroken time in which a flag is up."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def steady(truth: DistanceTruth) -> tuple[Stretch, float]:
    """Return where the surface rises with constant speed under the control, and that speed (mm/s).

    The longest such stretch; where the surface never moves so, the longest in which it is at rest.
    Raises NoClosedFormError.
    """
    surface = truth.surface_mm
    if surface is None:
        raise NoClosedFormError("no plant gives the distance")
    rise = np.diff(surface, prepend=surface[:1])
    best: tuple[Stretch, float] | None = None
    for stretch in active(truth):
        # Row begin still has the step into the stretch
        inside = rise[stretch.begin + 1 : stretch.end]
        is_even = np.abs(np.diff(inside, prepend=inside[:1])) <= _EVEN_MM
        for first, last in runs_of(is_even):
            part = Stretch(stretch.begin + 1 + first, stretch.begin + 1 + last, stretch.mode)
            per_cycle = float(np.median(rise[part.rows]))
            speed = 0.0 if abs(per_cycle) <= _EVEN_MM else per_cycle / truth.period_s
            if best is None or _rank(part, speed) > _rank(*best):
                best = part, speed
    if best is None or best[0].end - best[0].begin < 10:
        raise NoClosedFormError(
            "the surface was never at rest and never rose evenly under the control"
        )
    return best


def _rank(part: Stretch, speed_mm_s: float) -> tuple[bool, int]:
    length = part.end - part.begin
    return (speed_mm_s != 0.0 and length >= 20, length)


def must_settle(loop: Loop, kp: float, part: Stretch) -> None:
    """Raise NoClosedFormError when the transient is not over in the judged share."""
    if growth(loop, kp) >= 1.0:
        raise NoClosedFormError("the loop is not stable")
    before = (part.end - part.begin) * (1.0 - JUDGED_SHARE)
    needed = settling_cycles(loop, kp, SETTLED_SHARE) + loop.smoothing.delay_cycles * 2
    if before < needed:
        raise NoClosedFormError(
            f"the transient needs {needed:.0f} cycles, the surface was even for {before:.0f} before"
        )


def must_not_clamp(truth: DistanceTruth, part: Stretch) -> None:
    """Raise NoClosedFormError when v_max or a_max hold the offset back in the judged share."""
    limits = truth.listed.limits
    steps = truth["step_mm"][part.judged]
    if len(steps) and float(np.max(np.abs(steps - truth["delta_mm"][part.judged]))) > 1e-9:
        raise NoClosedFormError(f"the offset is clamped (v_max {limits.v_mm_s:g} mm/s, a_max)")


@dataclass(frozen=True)
class Envelope:
    """How the steps of the offset grow or die away: factor per cycle, over so many cycles."""

    growth: float
    cycles: int
    note: str


def envelope(truth: DistanceTruth, stretch: Stretch) -> Envelope:
    """Measure the factor by which the steps of the offset change per cycle.

    From the last event (surface, set value, start) on, as far as no clamp acts and the steps are
    above some increments of the sensor. Raises NoClosedFormError.
    """
    steps = np.abs(truth["step_mm"])
    begin = _last_event(truth, stretch)
    asked = np.abs(truth["delta_mm"])
    clamped = np.flatnonzero(np.abs(steps - asked)[begin : stretch.end] > 1e-9)
    if len(clamped) and clamped[-1] >= stretch.end - begin - 40:
        first = int(clamped[0])
        if first < 30:
            return Envelope(math.inf, 0, "the clamps act all the time: a limit cycle")
        end = begin + first
    else:
        begin += int(clamped[-1]) + 1 if len(clamped) else 0
        end = stretch.end
    floor = 6.0 * truth.listed.mm_per_increment * max(truth.listed.control.kp, 0.1)
    above = np.flatnonzero(steps[begin:end] > floor)
    if not len(above):
        return Envelope(0.0, 0, "nothing moves")
    # A filter and the dead cycles have to fill first
    first = begin + int(truth.listed.control.count) + truth.dead.dead + 3
    end = begin + int(above[-1]) + 1
    if end - first < 24:
        return Envelope(0.0, end - begin, f"died away within {end - begin} cycles")
    return Envelope(_slope(steps[first:end]), end - first, "largest steps of both halves")


def _slope(steps: Signal) -> float:
    half = len(steps) // 2
    early, late = steps[:half], steps[half : 2 * half]
    at_early, at_late = int(np.argmax(early)), half + int(np.argmax(late))
    ratio = float(late[at_late - half] / early[at_early])
    return float(ratio ** (1.0 / max(at_late - at_early, 1)))


def _last_event(truth: DistanceTruth, stretch: Stretch) -> int:
    surface = truth.surface_mm
    events = [stretch.begin]
    if surface is not None:
        moved = np.flatnonzero(np.abs(np.diff(surface[stretch.rows])) > _EVEN_MM)
        events += [stretch.begin + int(moved[-1]) + 1] if len(moved) else []
    for name in ("set_pos_mm", "set_dist_mm"):
        values = truth[name][stretch.rows]
        if np.isnan(values).any():
            continue  # not set
        changed = np.flatnonzero(np.diff(values) != 0.0)
        events += [stretch.begin + int(changed[-1]) + 1] if len(changed) else []
    last = max(events)
    # A surface that moves all the time has no last event
    return last if last < stretch.end - 30 else stretch.begin


def sine_parts(values: Signal, period_s: float) -> tuple[float, float, complex]:
    """Return frequency (Hz), mean and complex amplitude of a sine; raises NoClosedFormError."""
    centred = values - float(np.mean(values))
    up = np.flatnonzero((centred[:-1] < 0.0) & (centred[1:] >= 0.0))
    if len(up) < 3:
        raise NoClosedFormError("fewer than two periods of a sine")
    crossings = up - centred[up] / (centred[up + 1] - centred[up])
    frequency = (len(crossings) - 1) / float(crossings[-1] - crossings[0]) / period_s
    mean, amplitude = fitted(values, frequency, period_s)
    return frequency, mean, amplitude


def fitted(values: Signal, frequency_hz: float, period_s: float) -> tuple[float, complex]:
    """Return mean and complex amplitude of a sine of known frequency by least squares."""
    phase = 2.0 * math.pi * frequency_hz * period_s * np.arange(len(values))
    columns = np.stack([np.ones(len(values)), np.cos(phase), np.sin(phase)], axis=1)
    (mean, cosine, sine), *_ = np.linalg.lstsq(columns, values, rcond=None)
    return float(mean), complex(cosine, -sine)
