"""Parts of a run that closed forms are about: control on, surface at constant speed, and so on."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from axisrig.bench.judge.distance.decay import growth_of
from axisrig.bench.judge.distance.plant import NO_PLANT, surface_mm
from axisrig.bench.judge.distance.times import Unbroken
from axisrig.bench.judge.distance.truth import FOLLOWING, DistanceTruth, Flags
from axisrig.bench.oracles.distance.acting import Acting
from axisrig.bench.oracles.distance.following import settling_cycles
from axisrig.bench.oracles.distance.lists import Listed
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

JUDGED_SHARE = 0.2
"""Last share of a steady stretch that is judged."""
SETTLED_SHARE = 1e-3
"""What may be left of the transient when the judged share begins."""
_EVEN_MM = 2e-7
# Of a surface below an inclined tool, for what its axes leave: least, and share of its way
_INCLINED_MM, _INCLINED = 1e-5, 0.01
_LEAST_REST, _DIGITS = 30, 7
# A loop that is excited all the time shows how it grows or dies away only so far from 1
_SURE, _SURE_AT_LEAST = 2.0, 1e-3
EXCITED = "something excites the offset all the time, and it neither grows nor dies away"
NEVER_ON = "distance control was never on"
_RESTS = 6.0  # steps of so many increments of the sensor, with kp 0.1 at least, are rest
_RINGS = 0.9
"""What is left of the steps of an earlier half in a limit cycle, at least."""


@dataclass(frozen=True)
class Stretch:
    """Rows begin .. end - 1 in which the control follows in one mode by one law.

    listed: what acts, as the list would say it. is_dry_run: nothing is put out.
    """

    begin: int
    end: int
    mode: str
    listed: Listed
    is_dry_run: bool = False

    @property
    def kp(self) -> float:
        """The proportional part that acts."""
        return self.listed.control.kp

    @property
    def rows(self) -> slice:
        """For signals."""
        return slice(self.begin, self.end)

    @property
    def judged(self) -> slice:
        """Its last fifth."""
        return slice(self.end - max(int((self.end - self.begin) * JUDGED_SHARE), 1), self.end)


def compared(truth: DistanceTruth) -> list[Stretch]:
    """Return the unbroken times of one law in which the sensor was followed, dry runs too.

    A law begins where the control was switched on, and where a word of the program or a CNC object
    changes what acts. The row in which the program switches on belongs to what it begins.
    """
    found: list[Stretch] = []
    for time in truth.states:
        if time.value in FOLLOWING:
            found += _by_law(truth, time)
    return found


def _by_law(truth: DistanceTruth, time: Unbroken) -> Iterator[Stretch]:
    begin, acting = time.begin, truth.acting_in(min(time.begin + 1, time.end - 1))
    for one in truth.acting:
        is_other = (one.listed, one.is_dry_run) != (acting.listed, acting.is_dry_run)
        if time.begin + 1 < one.row < time.end and (one.begins or is_other):
            yield _stretch(truth, begin, one.row, time.value, acting)
            begin, acting = one.row, one
    yield _stretch(truth, begin, time.end, time.value, acting)


def _stretch(truth: DistanceTruth, begin: int, end: int, state: int, acting: Acting) -> Stretch:
    mode = truth.mode_in(state, acting.listed)
    return Stretch(begin, end, mode, acting.listed, acting.is_dry_run)


def active(truth: DistanceTruth) -> list[Stretch]:
    """Return those of them that put out an offset, in order."""
    return [stretch for stretch in compared(truth) if not stretch.is_dry_run]


def last_active(truth: DistanceTruth) -> Stretch:
    """Return the last of them; raises NoClosedFormError when the control was never on."""
    found = active(truth)
    if not found:
        raise NoClosedFormError(NEVER_ON)
    return found[-1]


def last_on(truth: DistanceTruth) -> list[Stretch]:
    """Return those of the last unbroken time with the control on, one for each law it followed."""
    found = [last_active(truth)]
    for stretch in reversed(active(truth)):
        if stretch.end == found[0].begin:
            found.insert(0, stretch)
    return found


def of_last_filter(truth: DistanceTruth) -> list[Stretch]:
    """Return the stretches, of dry runs too, that have the filter of the last one.

    Raises NoClosedFormError when the control was never on.
    """
    found = compared(truth)
    if not found:
        raise NoClosedFormError(NEVER_ON)
    last = truth.smoothing(found[-1].listed)
    return [one for one in found if truth.smoothing(one.listed).is_same(last)]


def runs_of(flags: Flags) -> list[tuple[int, int]]:
    """Return begin and end of every unbroken time in which a flag is up."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def steady(truth: DistanceTruth) -> tuple[Stretch, float]:
    """Return where the surface rises with constant speed under the control, and that speed (mm/s).

    The longest such stretch of one law and one set value, not held; where the surface never moves
    so, the longest in which it is at rest. Raises NoClosedFormError.
    """
    if not truth.has_surface:
        raise NoClosedFormError(NO_PLANT)
    best: tuple[Stretch, float] | None = None
    for stretch in active(truth):
        # Row begin still has the step into the stretch
        rows = slice(stretch.begin, stretch.end)
        inside = np.diff(truth.gathered(surface_mm, rows))
        is_even = np.abs(np.diff(inside, prepend=inside[:1])) <= _EVEN_MM
        for first, last in runs_of(is_even & ~is_disturbed(truth, stretch)):
            begin = stretch.begin + 1
            part = replace(stretch, begin=begin + first, end=begin + last)
            per_cycle = float(np.median(inside[first:last]))
            speed = 0.0 if abs(per_cycle) <= _EVEN_MM else per_cycle / truth.period_s
            if best is None or _rank(part, speed) > _rank(*best):
                best = part, speed
    if best is None or best[0].end - best[0].begin < 10:
        raise NoClosedFormError(
            "the surface was never at rest and never rose evenly under the control"
        )
    return best


def is_disturbed(truth: DistanceTruth, stretch: Stretch) -> Flags:
    """Return for each row but the first whether another set value acts, or the offset is held."""
    column = "set_pos_mm" if stretch.mode == SET_POS else "set_dist_mm"
    wanted = truth.gathered(lambda some: some.wanted_mm(column), stretch.rows)
    is_held = truth.gathered(lambda some: some["distance_held"], stretch.rows) == 1
    is_other = np.diff(wanted) != 0.0
    is_other[:1] = False  # what the stretch has begun with
    disturbed: Flags = is_other | is_held[1:]
    return disturbed


def _rank(part: Stretch, speed_mm_s: float) -> tuple[bool, int]:
    length = part.end - part.begin
    return (speed_mm_s != 0.0 and length >= 20, length)


def must_settle(loop: Loop, part: Stretch) -> None:
    """Raise NoClosedFormError when the transient is not over in the judged share."""
    if growth(loop, part.kp) >= 1.0:
        raise NoClosedFormError("the loop is not stable")
    before = (part.end - part.begin) * (1.0 - JUDGED_SHARE)
    needed = settling_cycles(loop, part.kp, SETTLED_SHARE) + loop.smoothing.delay_cycles * 2
    if before < needed:
        raise NoClosedFormError(
            f"the transient needs {needed:.0f} cycles, the surface was even for {before:.0f} before"
        )


def must_not_clamp(truth: DistanceTruth, part: Stretch) -> None:
    """Raise NoClosedFormError when v_max or a_max hold the offset back in the judged share."""
    limits = part.listed.limits
    steps = truth.gathered(lambda some: np.abs(some["step_mm"] - some["delta_mm"]), part.judged)
    if len(steps) and float(np.max(steps)) > 1e-9:
        raise NoClosedFormError(f"the offset is limited (v_max {limits.v_mm_s:g} mm/s, a_max)")


@dataclass(frozen=True)
class Envelope:
    """How the steps of the offset grow or die away: factor per cycle, its uncertainty, a note.

    count: cycles in which it is seen.
    """

    growth: float
    uncertainty: float
    note: str
    count: int = 0

    @property
    def stability(self) -> str:
        """Say stable or unstable; empty where the uncertainty leaves it open.

        Steps that are what they were at the begin have not died away.
        """
        if self.growth + self.uncertainty < 1.0:
            return "stable"
        least = max(self.growth - self.uncertainty, 0.0)
        return "unstable" if least >= 1.0 or least**self.count >= _RINGS else ""


def envelope(truth: DistanceTruth, stretch: Stretch) -> Envelope:
    """Measure the factor by which the steps of the offset change per cycle.

    From the last event (surface, set value, start, end of a hold, motion of the program) on, as far
    as no limit acts and the steps are above the increments of the sensor. Raises NoClosedFormError
    where nothing moved, and where something excites a loop all the time that neither grows nor dies
    away.
    """
    last = _last_event(truth, stretch)
    is_excited = last >= stretch.end - _LEAST_REST
    begin = stretch.begin if is_excited else last
    clamped = _where(truth, slice(begin, stretch.end), _is_clamped)
    end = stretch.end
    if clamped is not None and clamped.last - begin >= stretch.end - begin - 40:
        if clamped.first - begin < _LEAST_REST:
            return _limited(truth, stretch, begin)
        end = clamped.first
    elif clamped is not None:
        begin = clamped.last + 1
    noise_mm = _rounding_mm(truth, stretch)
    moved = _where(truth, slice(begin, end), lambda some: np.abs(some["step_mm"]) > noise_mm)
    if moved is None and clamped is not None:
        return Envelope(0.0, 0.0, f"at rest {end - begin} cycles after the limits acted")
    if moved is None:
        raise NoClosedFormError("nothing moved: what nothing excites shows no stability")
    # A filter and the dead cycles have to fill first
    first = begin + int(stretch.listed.control.count) + truth.dead.dead + 3
    steps = truth.gathered(lambda some: some["step_mm"], slice(min(first, end), end))
    found = growth_of(steps, noise_mm)
    if found is None:
        return Envelope(0.0, 0.0, f"died away within {end - begin} cycles")
    if is_excited and abs(found.factor - 1.0) <= max(_SURE * found.uncertainty, _SURE_AT_LEAST):
        raise NoClosedFormError(EXCITED)
    note = f"largest pole of {found.values} steps"
    return Envelope(round(found.factor, _DIGITS), found.uncertainty, note, found.values)


def _rounding_mm(truth: DistanceTruth, stretch: Stretch) -> float:
    """Return what an increment of the sensor makes of a step: P part, and D part by the filter.

    A filter lowers noise; the rounding of a slow signal is none, so that the P part has it whole.
    """
    loop = truth.loop(stretch.mode, stretch.listed)
    smooth, gain = loop.smoothing, 1.0
    if loop.derivative:
        changes = replace(smooth, numerator=np.convolve(smooth.numerator, [1.0, -1.0]))
        gain += loop.derivative * changes.noise_gain
    return truth.increment_mm * stretch.kp * gain


def _limited(truth: DistanceTruth, stretch: Stretch, begin: int) -> Envelope:
    """Say what becomes of steps that limits hold all the time: they ring, or die away in a slope.

    A slope acts on each step towards the error that is larger than the error itself, also of a loop
    that comes to rest.
    """
    if stretch.listed.control.is_sloped:
        # What follows the motion to the surface: the second half, and that in halves
        begin += (stretch.end - begin) // 2
        half = (stretch.end - begin) // 2
        at_early, early = _largest_step(truth, slice(begin, begin + half))
        at_late, late = _largest_step(truth, slice(begin + half, begin + 2 * half))
        if early <= _RESTS * truth.increment_mm * max(stretch.kp, 0.1):
            return Envelope(0.0, 0.0, "died away before the last half")
        if late < _RINGS * early:
            factor = (late / early) ** (1.0 / max(at_late - at_early, 1))
            note = "largest steps of the last two quarters, in which the slope acts"
            return Envelope(factor, (1.0 - factor) / 3.0, note)
    return Envelope(math.inf, 0.0, "the limits act all the time: a limit cycle")


def _largest_step(truth: DistanceTruth, rows: slice) -> tuple[int, float]:
    """Return row and size of the first of the largest steps."""
    steps = np.abs(truth.gathered(lambda some: some["step_mm"], rows))
    at = int(np.argmax(steps))
    return rows.start + at, float(steps[at])


def _is_clamped(truth: DistanceTruth) -> Flags:
    clamped: Flags = np.abs(np.abs(truth["step_mm"]) - np.abs(truth["delta_mm"])) > 1e-9
    return clamped


class _Found(NamedTuple):
    """First and last row in which something holds."""

    first: int
    last: int


def _where(
    truth: DistanceTruth, rows: slice, holds: Callable[[DistanceTruth], Flags]
) -> _Found | None:
    """Return where something holds in some rows; None where it never does.

    holds: of a part, which has two rows before those that are asked for.
    """
    first = last = None
    for part, begin, inside in truth.parts(rows, before=2):
        found = np.flatnonzero(holds(part)[inside])
        if len(found):
            first = begin + int(found[0]) if first is None else first
            last = begin + int(found[-1])
    return None if first is None or last is None else _Found(first, last)


def _changes_mm(values: Signal) -> Signal:
    return np.diff(values, prepend=values[:1])


def _last_event(truth: DistanceTruth, stretch: Stretch) -> int:
    # A change in a row is that from the row before; what was before the stretch does not count
    rows, events = slice(stretch.begin + 1, stretch.end), [stretch.begin]
    if truth.has_surface:
        moved = _where(truth, rows, _has_moved)
        events += [moved.last] if moved is not None else []
    column = "set_pos_mm" if stretch.mode == SET_POS else "set_dist_mm"
    changed = _where(truth, rows, lambda part: _changes_mm(part.wanted_mm(column)) != 0.0)
    events += [changed.last] if changed is not None else []
    # The deviation from SET_POS does not see where the program wants the axis, a distance does
    if stretch.mode != SET_POS or truth.sensor_age_cycles:
        led = _where(truth, rows, lambda part: np.abs(_changes_mm(part.program_mm)) > _EVEN_MM)
        events += [led.last] if led is not None else []
    events += [min(held.end, stretch.end) for held in truth.held if held.begin < stretch.end]
    return max(events)


def _has_moved(truth: DistanceTruth) -> Flags:
    """Rows in which the surface is elsewhere than in the row before.

    What an inclined tool sees of it changes with the place of the tool (`gap_gain`); what its axes
    leave of that by their increments is no motion.
    """
    assert truth.gap_true_mm is not None
    tool_mm = _changes_mm(truth["truth_mm"])
    itself_mm = np.abs(truth.gap_gain * tool_mm - _changes_mm(truth.gap_true_mm))
    allowed_mm: Signal | float = _EVEN_MM
    if truth.gap_gain != 1.0:
        allowed_mm = _INCLINED_MM + _INCLINED * np.abs(tool_mm)
    moved: Flags = itself_mm > allowed_mm
    return moved


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


def unknown_poles(truth: DistanceTruth, mode: str) -> str:
    """Say why no closed form knows the poles of the loop in a mode; empty where one does.

    A drive with loops of its own is more than its lag, where the loop goes through it.
    """
    if truth.every > 1:
        return "60E4 does not come with every SYNC"
    has_loops = truth.values is not None and bool(truth.values.get("kv"))
    is_in_loop = mode == CONST_DIST or truth.sensor_age_cycles != 0
    return "the loops of the drive are part of it" if has_loops and is_in_loop else ""
