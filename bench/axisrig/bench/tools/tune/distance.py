"""Tuning of distance control: from runs of a rig to what holds for each mode of its loop."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from axisrig.bench.oracles.distance.stability import mean_limit, surface_limit
from axisrig.bench.record.series import Telegrams
from axisrig.bench.tools.tune.advice import Advice, advise
from axisrig.bench.tools.tune.identify import Path, identify, renewal_cycles
from axisrig.bench.tools.tune.loop import (
    Floats,
    Law,
    Loop,
    both_encoders,
    const_dist,
    set_pos,
    trimmed,
    without_offset,
)
from axisrig.bench.tools.tune.measure import (
    REST_CYCLES,
    Bench,
    Run,
    Signals,
    Steps,
    at_rest,
    distance_step,
    surface_steps,
)
from axisrig.kernel.distance import Derivative, DerivativeOf, DistanceLaw, DistanceSettings
from axisrig.kernel.distance.filters import FilterSettings, filter_kinds, make_filter
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.values import ParameterSet
from axisrig.kernel.time.clock import US, TimeNs, ns_to_seconds

CONST_DIST, BOTH_ENCODERS, SET_POS = "CONST_DIST", "CONST_DIST, both encoders", "SET_POS"
STEP_MM, STEP_MAX_MM, STEPS_OF_NOISE = 0.05, 0.5, 100.0
# (cycles between two steps and of the answer, number of steps); the next one when it is not over
_LENGTHS = ((300, 6), (1000, 4))
_OVER = 0.8
_GAIN_ERROR = 0.02
_SIGN_ERROR = 0.3
_PULSE_CYCLES = 4000
_SIGMAS_SEEN = 6.0


@dataclass(frozen=True)
class Configured:
    """What the list of the axis says: law, filter, both encoders; its impulse response.

    choices: of the rig, [distance].
    """

    law: Law
    filter: FilterSettings
    impulses: Floats
    uses_both: bool
    choices: DistanceLaw

    @classmethod
    def read(
        cls, parameters: ParameterSet, period_ns: TimeNs, choices: DistanceLaw
    ) -> "Configured":
        """Read it; the law in s."""
        listed = DistanceSettings.read(parameters)
        settings = listed.filter
        made = make_filter(settings.kind, settings, period_ns)
        made.restart(0.0)
        impulses = np.array([made.step(float(k == 0)) for k in range(_PULSE_CYCLES)])
        law = Law(listed.kp, listed.tn_s, listed.tv_s)
        return cls(law, settings, impulses, listed.both_encoders, choices)


@dataclass(frozen=True)
class DeadTime:
    """Of the loop, in cycles.

    reaction: from the cycle that computes an offset to the one that sends it. way: from there to
    the cycle that reads a sensor value with it, at the latest. renewal: every how many cycles the
    sensor value is new. way_ns: from frame to frame, None where the sensor is no second encoder of
    a drive.
    """

    reaction: int
    way: int
    renewal: int
    way_ns: TimeNs | None

    @property
    def dead(self) -> int:
        """Return n; a loop without dead time has a way of one cycle."""
        return self.reaction + self.way - 1


@dataclass(frozen=True)
class Mode:
    """What holds for one mode.

    stable_kp: with the configured I and D parts. closed_limit: largest stable kp of a P controller
    in closed form, None where there is none.
    """

    name: str
    loop: Loop
    stable_kp: tuple[float, float]
    is_stable: bool
    closed_limit: float | None
    advice: Advice | None


@dataclass(frozen=True)
class Trial:
    """A step of SET_DIST with the suggested law: what came and what was predicted, share of it.

    misfit_mm: standard deviation of the difference.
    """

    law: Law
    seen: Floats
    predicted: Floats
    misfit_mm: float


@dataclass(frozen=True)
class Tuning:
    """Everything that was found.

    rest_mm: distance at the begin. step_mm: of the set values. trial: with the suggested law.
    """

    bench: Bench
    period_s: float
    configured: Configured
    rest_mm: float
    step_mm: float
    distance: Path
    actual: Path
    dead_time: DeadTime
    modes: tuple[Mode, ...]
    trial: Trial | None = None

    @property
    def chosen(self) -> Mode:
        """The mode of CONST_DIST that the list asks for."""
        name = BOTH_ENCODERS if self.configured.uses_both else CONST_DIST
        return next(mode for mode in self.modes if mode.name == name)


def tune(bench: Bench, step_mm: float | None = None) -> Tuning:
    """Measure, identify and judge. step_mm: of the set values; None: by the noise.

    Raises UserError when the rig cannot be measured.
    """
    settings = bench.settings()
    period_ns = settings.rig.cycle.period_us * US
    period_s = ns_to_seconds(period_ns)
    configured = Configured.read(settings.axis[bench.axis], period_ns, settings.rig.distance.law)
    rest = at_rest(bench, STEP_MM, period_s)
    sigma_mm = _check_sensor(bench, rest)
    chosen_mm = step_mm or min(max(STEP_MM, STEPS_OF_NOISE * sigma_mm), STEP_MAX_MM)
    run, distance, actual = _paths(bench, rest, chosen_mm, period_s)
    dead_time = _dead_time(run, distance, is_encoder=bench.variable is None)
    modes = tuple(_modes(configured, distance, actual, dead_time, period_s))
    rest_mm = float(np.mean(rest.distance_mm[:REST_CYCLES]))
    found = Tuning(
        bench, period_s, configured, rest_mm, chosen_mm, distance, actual, dead_time, modes
    )
    return replace(found, trial=_tried(found))


def _check_sensor(bench: Bench, rest: Signals) -> float:
    """Return the noise of the distance at rest, mm. Raises UserError for a wrong sign or scale."""
    ends = [slice(0, REST_CYCLES), slice(-REST_CYCLES // 2, None)]
    began_mm, ended_mm = (np.mean(rest.distance_mm[part]) for part in ends)
    first_mm, last_mm = (np.mean(rest.actual_mm[part]) for part in ends)
    sigma_mm = float(np.std(rest.distance_mm[: REST_CYCLES // 2]))
    ratio = float((ended_mm - began_mm) / (last_mm - first_mm))
    if abs(ratio - 1) > _SIGN_ERROR + _SIGMAS_SEEN * sigma_mm / STEP_MM / REST_CYCLES**0.5:
        moved = f"the axis moved by {last_mm - first_mm:.4f} mm up, the sensor value by"
        raise UserError(
            f"{moved} {began_mm - ended_mm:.4f} mm; they have to be opposite and equal",
            file=bench.rig,
            hint="sign: P-AXIS-00230 (lr_hw[1].vz_istw); scale: P-AXIS-00422 and 00423; or the"
            " sensor does not see the surface where the axis starts",
        )
    return sigma_mm


def _paths(bench: Bench, rest: Signals, step_mm: float, period_s: float) -> tuple[Run, Path, Path]:
    """Answers of distance and actual position to the offset, long enough to be over."""
    surface = rest.actual_mm[-REST_CYCLES // 2 :] - rest.distance_mm[-REST_CYCLES // 2 :]
    for cycles, count in _LENGTHS:
        run = surface_steps(bench, float(np.mean(surface)), step_mm, Steps(count, cycles, period_s))
        found = _identified(run.signals, cycles)
        if found[0].settled_cycle < _OVER * cycles and abs(found[0].gain - 1) < _GAIN_ERROR:
            break
    return run, found[0], found[1]


def _identified(signals: Signals, cycles: int) -> tuple[Path, Path]:
    """Answers of distance and actual position; the distance with the oldest value it may have."""
    begin = int(np.argmax(signals.offset_mm != 0)) - REST_CYCLES // 2
    offset_mm, distance_mm = signals.offset_mm[begin:], signals.distance_mm[begin:]
    rest = REST_CYCLES // 2
    actual = identify(offset_mm, signals.actual_mm[begin:], rest, cycles)
    renewal = renewal_cycles(offset_mm, distance_mm, rest)
    if renewal == 1:
        return identify(offset_mm, distance_mm, rest, cycles), actual
    changed = np.flatnonzero(np.diff(distance_mm)) + 1
    phase = int(np.argmax(np.bincount(changed % renewal)))
    fresh = np.arange(len(distance_mm)) % renewal == phase
    path = identify(offset_mm, distance_mm, rest, cycles, fresh)
    oldest = np.concatenate([np.zeros(renewal - 1), path.impulses])
    return replace(path, impulses=oldest, renewal_cycles=renewal), actual


def _dead_time(run: Run, distance: Path, *, is_encoder: bool) -> DeadTime:
    """Cycles from the log of the control, time from the frames."""
    signals = run.signals
    computed = _first_jump(signals.offset_mm)
    reaction = _first_jump(signals.set_mm) - computed
    way_ns = None
    if is_encoder and len(run.sensor.frame_ns):
        place = _first_jump(run.targets.increments.astype(np.float64))
        sent_ns = int(run.targets.frame_ns[place])
        way_ns = _first_shown_ns(run.sensor, sent_ns) - sent_ns
    way = distance.first_cycle - reaction
    return DeadTime(reaction, way, distance.renewal_cycles, way_ns)


def _first_jump(values: Floats) -> int:
    """Index of the first value that differs from the one before by half of what any does."""
    changes = np.abs(np.diff(values))
    return 1 + int(np.argmax(changes >= changes.max() / 2))


def _first_shown_ns(sensor: Telegrams, from_ns: TimeNs) -> TimeNs:
    """Instant of the first sensor value that has left its place of rest by more than its noise."""
    is_before = sensor.frame_ns <= from_ns
    before = sensor.increments[is_before][-REST_CYCLES:]
    middle, noise = float(np.mean(before)), float(np.std(before))
    has_left = np.abs(sensor.increments - middle) > _SIGMAS_SEEN * noise + 1
    return int(sensor.frame_ns[has_left & ~is_before][0])


def _modes(
    configured: Configured, distance: Path, actual: Path, dead_time: DeadTime, period_s: float
) -> Iterator[Mode]:
    """Judge each mode with the filter of the list."""
    filtering, law = configured.impulses, configured.law
    moved, driven = distance.impulses, actual.impulses
    feedbacks = {
        CONST_DIST: const_dist(filtering, moved),
        BOTH_ENCODERS: both_encoders(filtering, moved, driven, dead_time.reaction),
        SET_POS: set_pos(filtering, moved, driven),
    }
    for name, feedback in feedbacks.items():
        loop = _loop(name, configured, feedback, period_s)
        stable_kp = loop.stable_kp(law.tn_s, law.tv_s)
        closed = _closed_limit(name, configured, distance, actual, dead_time)
        yield Mode(name, loop, stable_kp, loop.is_stable(law), closed, advise(loop))


def _loop(name: str, configured: Configured, feedback: Floats, period_s: float) -> Loop:
    """Return a loop under the law that the rig has chosen."""
    choices = configured.choices
    of_error, is_surface = choices.derivative_of is DerivativeOf.ERROR, name == SET_POS
    looked_at = None if of_error or not is_surface else without_offset(feedback)
    return Loop(
        period_s,
        feedback,
        trimmed(configured.impulses),
        looked_at,
        steps_with_set_value=of_error or is_surface,
        is_per_cycle=choices.derivative is Derivative.PER_CYCLE,
    )


def _closed_limit(
    name: str, configured: Configured, distance: Path, actual: Path, dead_time: DeadTime
) -> float | None:
    """Largest stable kp of a P controller in closed form, for ideal drives and means."""
    is_mean = filter_kinds()[configured.filter.kind].model == "mean"
    if not is_mean or not distance.is_dead_time or not actual.is_dead_time:
        return None
    count = max(configured.filter.n_cycles, 1)
    if name == CONST_DIST:
        return mean_limit(count, dead_time.dead)
    if distance.first_cycle != actual.first_cycle:
        return None
    if name == SET_POS:
        return surface_limit(dead_time.dead, 0)
    return mean_limit(count, dead_time.reaction)


def _tried(found: Tuning) -> Trial | None:
    """Step the distance with the suggested law, and predict what comes."""
    mode = found.chosen
    if mode.advice is None:
        return None
    law = mode.advice.law
    cycles = max(_LENGTHS[0][0], 3 * mode.advice.quality.rise_cycles)
    steps = Steps(1, cycles, found.period_s)
    signals = distance_step(found.bench, law, found.rest_mm, found.step_mm, steps).signals
    # From nothing to a set value and back again there is no difference (NaN)
    began = int(np.flatnonzero(np.abs(np.diff(signals.wanted_mm)) > found.step_mm / 2)[0]) + 1
    place_mm = float(np.mean(signals.distance_mm[began - REST_CYCLES // 2 : began]))
    seen = (signals.distance_mm[began + 1 : began + cycles] - place_mm) / found.step_mm
    offset = mode.loop.offset_answer(law, len(seen))
    predicted = np.convolve(offset, found.distance.impulses)[: len(seen)]
    return Trial(law, seen, predicted, float(np.std(seen - predicted)) * found.step_mm)
