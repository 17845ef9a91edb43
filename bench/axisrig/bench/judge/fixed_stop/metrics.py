"""The metrics of measurement runs to a fixed stop.

Of several runs the last one counts, for an axis the last in which it takes part; where a false
trigger or a force would hide in an earlier one, the worst of all. They compare with the plant's
truth and with the closed forms of `bench/axisrig/bench/oracles/fixed_stop`.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from axisrig.bench.judge.fixed_stop.run import StopRun, stop_run, stop_runs
from axisrig.bench.judge.fixed_stop.truth import PLANT_MM, AxisTruth
from axisrig.bench.judge.observed.motion import INSIDE, Largest, farthest, state_at
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed, takes_part
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.record.series import Signal
from axisrig.kernel.time.clock import MS

STOP_METRICS: dict[str, MetricFunction] = {}

NOT_FOLLOWED = (
    "along the motion of the plant the criteria never hold; what counts as rest after the end of"
    " the block is unknown to this oracle"
)
INTEGRATED = "steps of the integration of the plant"
BESIDE = "the force goes on beyond the first or last SYNC of the run"
NO_FORCE = "the FMU of the axis gives no force at the stop (stop_force in docs/rigs.md)"


def _last_run(observed: Observed, axis: str | None) -> StopRun | str:
    """Return the run that counts when it went to a fixed stop, else why there is none."""
    record = observed.last_run(axis)
    if record is None:
        return "the program made no measurement run"
    if record.fixed_stop is None:
        return "the last measurement run did not go to a fixed stop (measuring type 7)"
    return stop_run(observed, record)


def _of_run(
    function: Callable[[StopRun, str | None], Observation],
) -> Callable[[StopRun, str | None], Observation]:
    """Register a metric of the last run; the axis is the one that was asked for."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        run = _last_run(observed, axis)
        return Observation(None, note=run) if isinstance(run, str) else function(run, axis)

    STOP_METRICS[function.__name__] = metric
    return function


def _of_axis(
    function: Callable[[StopRun, AxisTruth], Observation],
) -> Callable[[StopRun, AxisTruth], Observation]:
    """Register a metric of one axis: without a name the one that detected or met its stop."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        run = _last_run(observed, axis)
        if isinstance(run, str):
            return Observation(None, note=run)
        name = axis or run.main_axis()
        truth = run.truths.get(name or "")
        if truth is None:
            return Observation(None, note=f"no truth of axis {name} in this run")
        return function(run, truth)

    STOP_METRICS[function.__name__] = metric
    return function


def _runs_of(observed: Observed, axis: str | None) -> list[StopRun]:
    """Return the runs to a fixed stop in which an axis takes part, without a name all."""
    return [r for r in stop_runs(observed) if axis is None or takes_part(r.record, axis)]


def _of_every_run(
    function: Callable[[StopRun, str | None], Observation],
) -> Callable[[StopRun, str | None], Observation]:
    """Register the largest number of all runs; one that is not known leaves it open."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        runs = _runs_of(observed, axis)
        if not runs:
            of_axis = f" of axis {axis}" if axis else ""
            note = f"the program made no measurement run{of_axis} to a fixed stop"
            return Observation(None, note=note)
        seen = [function(run, axis) for run in runs]
        unknown = next((each for each in seen if each.value is None), None)
        if unknown is not None or len(runs) == 1:
            return unknown or seen[0]
        sizes = [float(str(each.value)) for each in seen]
        worst = sizes.index(max(sizes))
        axes = " ".join(runs[worst].record.axes)
        note = f"fixed stop {runs[worst].number} of {len(stop_runs(observed))}, axis {axes}"
        return replace(seen[worst], note=note)

    STOP_METRICS[function.__name__] = metric
    return function


def _force(run: StopRun, axis: str | None, rows_of: Callable[[AxisTruth], slice]) -> Observation:
    """Return the largest force in some rows, of one axis, or of all without a name."""
    truths = [truth for name, truth in run.truths.items() if axis in (None, name)]
    found = [(truth.stop_force_max_n(rows_of(truth)), truth) for truth in truths]
    known = [(force, truth) for force, truth in found if force is not None]
    if not known:
        return Observation(None, note=NO_FORCE)
    largest_n, truth = max(known, key=lambda each: each[0])
    beside_n = truth.force_beside_n(rows_of(truth))
    words = BESIDE if beside_n > 0.0 else INTEGRATED if largest_n > 0.0 else ""
    return Observation(largest_n, truth.peak_doubt_n(largest_n) + beside_n, words)


def _known_force(truth: AxisTruth, force_n: float) -> Observation:
    return Observation(force_n, truth.force_doubt_n(force_n), INTEGRATED if force_n > 0.0 else "")


# When


_UNKNOWN_SIDE = (
    "the plant of axis {axis} gives a force at its stop, and no stop_direction: on which side it is"
    " nobody knows"
)


@_of_run
def contact_to_detection_ms(run: StopRun, axis: str | None) -> Observation:
    """From the contact that lasts at the detection, of the detecting axis without a name."""
    name = axis or run.stop.detected_by
    if run.stop.detected_ns is None or name is None:
        return Observation(None, note="no stop was found")
    lasting = run.lasting(name)
    if lasting is None and name in run.truths and not run.truths[name].tells_stop:
        return Observation(None, note=_UNKNOWN_SIDE.format(axis=name))
    if lasting is None:
        return Observation(None, note=f"axis {name} had no contact before")
    contact = lasting.contact
    if contact is None:
        return Observation(None, note=f"axis {name} had lost its contact: {lasting.lost_text}")
    known = "location of the contact between two SYNCs"
    return Observation(
        (run.stop.detected_ns - contact.time_ns) / 1e6,
        contact.uncertainty_ns / 1e6,
        f"{lasting.lost_text}; {known}" if lasting.lost_text else known,
    )


@_of_run
def detection_error_ms(run: StopRun, _axis: str | None) -> Observation:
    """Detection less the closed form."""
    if run.stop.detected_ns is None:
        return Observation(None, note="no stop was found")
    _, instant = run.detection
    if instant.time_ns is None:
        return Observation(None, note=f"no closed form: {instant.note}")
    error_ms = (run.stop.detected_ns - instant.time_ns) / 1e6
    return Observation(error_ms, instant.doubt_ns / 1e6, instant.note)


@_of_run
def detection_followed_error_ms(run: StopRun, _axis: str | None) -> Observation:
    """Detection less the cycle in which the criteria hold along the plant's motion."""
    if run.stop.detected_ns is None:
        return Observation(None, note="no stop was found")
    if run.followed_ns is None:
        return Observation(None, note=NOT_FOLLOWED)
    return Observation((run.stop.detected_ns - run.followed_ns) / 1e6)


@_of_run
def detection_criterion(run: StopRun, _axis: str | None) -> Observation:
    """The criterion that came true last."""
    return Observation(run.deciding_criterion() or "none")


@_of_every_run
def found_without_contact(run: StopRun, _axis: str | None) -> Observation:
    """Whether a stop was found in free motion."""
    stop = run.stop
    if stop.detected_ns is None or stop.detected_by is None:
        return Observation(0, note="no stop was found")
    if stop.detected_by not in run.truths:
        return Observation(None, note=f"no truth of axis {stop.detected_by} in a run")
    if not run.truths[stop.detected_by].tells_stop:
        return Observation(None, note=_UNKNOWN_SIDE.format(axis=stop.detected_by))
    lasting = run.lasting(stop.detected_by)
    return Observation(int(lasting is None or lasting.contact is None))


@_of_run
def relax_ms(run: StopRun, _axis: str | None) -> Observation:
    """Duration of the relaxing motion."""
    if run.stop.relax_begin_ns is None or run.stop.relax_end_ns is None:
        return Observation(None, note="the run made no relaxing motion")
    return Observation((run.stop.relax_end_ns - run.stop.relax_begin_ns) / 1e6)


# Where and how hard


@_of_axis
def latch_force_error_um(run: StopRun, truth: AxisTruth) -> Observation:
    """Published position less x_stop + F(t)/k in the cycle of the detection."""
    latched_mm = run.record.latched_mm.get(truth.name)
    if latched_mm is None or run.stop.detected_ns is None:
        return Observation(None, note=f"no measured value of axis {truth.name}")
    if truth.stop_force_n is None:
        return Observation(None, note=NO_FORCE)
    if truth.stop is None or truth.stop_path is None:
        return Observation(None, note=f"the plant gives no stop of axis {truth.name}")
    row = run.row_at(run.stop.detected_ns)
    force_n = float(truth.stop_force_n[row])
    if force_n <= 0.0:
        return Observation(None, note=f"axis {truth.name} does not touch its stop then")
    expected_mm = truth.pressed_encoder_mm(row)
    increment_um = 1e3 / truth.record.increments_per_mm
    return Observation(
        (latched_mm + truth.zero_mm - expected_mm) * 1e3,
        0.5 * increment_um,
        "rounding of the encoder",
    )


@_of_axis
def stop_force_n(run: StopRun, truth: AxisTruth) -> Observation:
    """Force at the stop in the cycle of the detection."""
    if truth.stop_force_n is None:
        return Observation(None, note=NO_FORCE)
    if run.stop.detected_ns is None:
        return Observation(None, note="no stop was found")
    return _known_force(truth, float(truth.stop_force_n[run.row_at(run.stop.detected_ns)]))


@_of_every_run
def stop_force_n_max(run: StopRun, axis: str | None) -> Observation:
    """Largest force at a stop in a run."""
    return _force(run, axis, lambda _: run.rows)


@_of_axis
def stop_force_end_n(run: StopRun, truth: AxisTruth) -> Observation:
    """Force at the stop when the run is over."""
    if truth.stop_force_n is None:
        return Observation(None, note=NO_FORCE)
    return _known_force(truth, float(truth.stop_force_n[run.row_at(run.end_ns)]))


@_of_axis
def command_overtravel_mm(run: StopRun, truth: AxisTruth) -> Observation:
    """Largest distance of the demand past the latched position."""
    excess_mm = run.command_excess_mm(truth)
    if excess_mm is None:
        return Observation(None, note=f"no measured value of axis {truth.name}")
    uncertainty_mm = 0.5 / truth.record.increments_per_mm + PLANT_MM
    return Observation(excess_mm, uncertainty_mm, "rounding of the encoder")


@_of_axis
def relax_lag_mm(run: StopRun, truth: AxisTruth) -> Observation:
    """Lag in the drive when the relaxing motion has ended."""
    if run.stop.relax_end_ns is None:
        return Observation(None, note="the run made no relaxing motion")
    row = run.row_at(run.stop.relax_end_ns)
    lag_mm = float(truth.course.demand_mm[row] - truth.course.encoder_mm[row])
    return Observation(lag_mm, PLANT_MM, INTEGRATED)


# Behind the run


@_of_axis
def after_run_motion_um(run: StopRun, truth: AxisTruth) -> Observation:
    """Largest true motion while the set value is at rest after the run."""
    rows = _standing_rows(run, truth)
    end_ns = int(truth.times_ns[rows][-1])
    begin_ns = min(max(int(truth.times_ns[rows][0]), run.end_ns), end_ns)
    at_end = state_at(run.observed, truth.name, begin_ns)
    from_mm = float(truth.position_mm[rows][0]) if at_end is None else at_end.position_mm
    far = farthest(run.observed, truth.name, from_mm, begin_ns, end_ns) or Largest(0.0, 0.0)
    words = f"over {(end_ns - begin_ns) / MS:g} ms; {INSIDE}"
    return Observation(far.value * 1e3, (far.doubt + PLANT_MM) * 1e3, words)


@_of_every_run
def after_run_force_n_max(run: StopRun, axis: str | None) -> Observation:
    """Largest force at the stop while the set value is at rest after a run."""
    return _force(run, axis, lambda truth: _standing_rows(run, truth))


def _standing_rows(run: StopRun, truth: AxisTruth) -> slice:
    """Return the rows from the end of the run on in which the set value does not change.

    The first one with another set value is among them: that one was made after its SYNC.
    """
    set_mm: Signal = run.set_mm(truth.name)
    begin = run.row_at(run.end_ns)
    moved = np.flatnonzero(set_mm[begin:] != set_mm[begin])
    return slice(begin, begin + int(moved[0]) + 1 if len(moved) else len(set_mm))
