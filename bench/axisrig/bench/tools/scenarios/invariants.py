"""What holds in every run, whatever was done to it (`invariants.csv`).

Each is a function of what a scenario left (`Left`): it returns what is wrong, in words, or nothing.
Truths are the plant's, limits those of the lists, edges of states those of the tables; nothing of
channel, motion or drives is asked.
"""

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.distance.truth import ERROR, FOLLOWING, FREEZE, INACTIVE, TURNING_OFF
from axisrig.bench.judge.latch.sources import source_error_um
from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.edges import edges_of
from axisrig.bench.record.facts import AlarmRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Signal
from axisrig.bench.record.signal_sources import AT_SIGNAL, HELD, STAMPED
from axisrig.bench.tools.scenarios.brought import predicted_mm
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.limits import lists_of, offset_lists_of
from axisrig.bench.tools.scenarios.machines import EVERY, machines
from axisrig.bench.tools.scenarios.states import wrong_steps
from axisrig.bench.tools.scenarios.stopping import stop_ns
from axisrig.kernel.time.clock import MS, S

INCREMENTS_MAX = 1.0
"""Rounding of the encoder and of the published number."""
REST_MM = 0.01
"""How far a load may creep in 50 ms: friction lets it creep by a micrometre, while the lowest feed
goes 0.25 mm."""
ROUNDING_MM = 1e-9


@dataclass(frozen=True)
class Invariant:
    """A row of `invariants.csv`. machines: which it is about."""

    name: str
    holds: str
    source: str
    machines: tuple[str, ...]
    function: Callable[[Left], str]


@cache
def invariants() -> tuple[Invariant, ...]:
    """Read the table, in its order."""
    text = resources.files(__package__).joinpath("invariants.csv").read_text(encoding="utf-8")
    return tuple(
        Invariant(
            row["name"],
            row["holds"],
            row["source"],
            _machines(row["machines"]),
            globals()[row["function"]],
        )
        for row in csv.DictReader(text.splitlines())
    )


def _machines(cell: str) -> tuple[str, ...]:
    """Read `every`, `every but A B`, or the names of machines."""
    words = cell.split()
    if words[0] != EVERY:
        return tuple(words)
    return tuple(name for name in machines() if name not in words[2:])


def broken(left: Left) -> Iterator[tuple[str, str]]:
    """Yield the invariants that do not hold, each with what is wrong."""
    for invariant in invariants():
        if left.machine.name in invariant.machines and invariant.name not in left.hidden:
            wrong = invariant.function(left)
            if wrong:
                yield invariant.name, wrong


def ending(left: Left) -> AlarmRecord | None:
    """Return the first alarm that ends the program."""
    alarms = [alarm for alarm in left.facts.alarms if not alarm.is_further]
    return next((alarm for alarm in alarms if alarm.ends_program), None)


# Values


def values_of(left: Left) -> Iterator[tuple[int, str, float]]:
    """Yield every value reported as good: number of its run, axis, mm.

    What the program has printed, then what the channel has published.
    """
    runs = left.facts.runs
    for message in left.facts.messages:
        if message.block in left.machine.prints and message.values:
            place = left.machine.prints.index(message.block)
            yield place, runs[place].axes[0], message.values[0]
    for number, run in enumerate(runs):
        if run.end_ns is not None:
            for axis, value_mm in run.latched_mm.items():
                yield number, axis, value_mm


def value(left: Left) -> str:
    """A measured value is the position of an edge within its run; without an edge none is there."""
    return _wrong(left, at_stop=False)


def found_stop(left: Left) -> str:
    """A run to a fixed stop finds one where the load is at it."""
    return _wrong(left, at_stop=True)


def _wrong(left: Left, *, at_stop: bool) -> str:
    """Say which value is wrong first, of the runs to a fixed stop or of all others."""
    for number, axis, value_mm in values_of(left):
        if (left.facts.runs[number].fixed_stop is not None) is at_stop:
            wrong = wrong_value(left, number, axis, value_mm)
            if wrong and not is_unknowable(left, number, axis):
                return f"run {number + 1}: axis {axis} {value_mm:.6f} mm {wrong}"
    return ""


def wrong_value(left: Left, number: int, axis: str, value_mm: float) -> str:
    """Say what is wrong with a value of a run, empty when nothing is."""
    run = left.facts.runs[number]
    source = run.sources.get(axis, "")
    if run.fixed_stop is not None:
        return _wrong_at_stop(left, run, axis)
    if source in (*AT_SIGNAL, STAMPED, HELD):
        return _wrong_at_plc(left, number, axis)
    start_ns = run.start_ns if run.start_ns is not None else run.begin_ns
    end_ns = run.end_ns if run.end_ns is not None else left.facts.end_ns
    record = left.facts.axes[axis]
    watched = edges_of(
        left.facts.edges,
        axis=axis,
        begin_ns=start_ns,
        end_ns=end_ns,
        level=record.written.get("kenngr.measure.edge", "POS") == "POS",
        probe=record.signals.get(f"probe_{run.inputs.get(axis)}"),
    )
    inside = [row.latch_motor_mm for row in watched if row.latch_motor_mm is not None]
    if not inside:
        return "without an edge of the probe"
    true_mm = inside[0] - (Observed(left.facts, left.series).zero_mm(axis, run) or 0.0)
    off = (value_mm - true_mm) * (record.latch_per_mm or record.increments_per_mm)
    if abs(off) > INCREMENTS_MAX:
        return f"where {true_mm:.6f} mm are true: off by {off:.1f} increments"
    return ""


def _seen_by_plc(left: Left, number: int) -> Observed:
    """Look at a run with the edges that a wire has passed: what a PLC samples or stamps."""
    probes = {
        name: probe if probe.passed is None else replace(probe, edges=probe.passed)
        for name, probe in left.facts.probes.items()
    }
    return Observed(replace(left.facts, probes=probes), left.series).until_run(number)


def _wrong_at_plc(left: Left, number: int, axis: str) -> str:
    """Compare with the closed form of the chain; one that gives no value only asks for an edge."""
    observed = _seen_by_plc(left, number)
    seen = touch(observed, axis)
    if seen is None or seen.edge_ns is None:
        return "without an edge of the probe"
    found = source_error_um(observed, seen, axis)
    if not isinstance(found.value, float):
        return ""
    allowed_um = (found.uncertainty or 0.0) + _increment_um(left, axis)
    if abs(found.value) > allowed_um:
        return f"is off by {found.value:.4f} um with {allowed_um:.4f} um allowed"
    return ""


def _increment_um(left: Left, axis: str) -> float:
    return 1e3 * INCREMENTS_MAX / left.facts.axes[axis].increments_per_mm


def is_unknowable(left: Left, number: int, axis: str) -> bool:
    """Whether a wrong value is what any control gets from what its segments brought (`brought`).

    Only of a signal at the PLC: a drive proves its latch beside the cycle.
    """
    run = left.facts.runs[number]
    at_plc = run.sources.get(axis, "") in (*AT_SIGNAL, STAMPED)
    observed = _seen_by_plc(left, number)
    seen = touch(observed, axis)
    value_mm = run.latched_mm.get(axis)
    if left.received is None or not at_plc or seen is None or value_mm is None:
        return False
    value_mm += observed.zero_mm(axis, run) or 0.0
    doubt_um = 1e3 * (run.doubt_mm or {}).get(axis, 0.0)
    allowed_um = _increment_um(left, axis) + doubt_um
    return any(
        abs(value_mm - each_mm) * 1e3 <= allowed_um
        for each_mm in predicted_mm(observed, left.received, seen, axis)
    )


def _wrong_at_stop(left: Left, run: MeasurementRun, axis: str) -> str:
    """A stop is found where the load is at it: the plant's stop pushes at the SYNC before."""
    stop = run.fixed_stop
    assert stop is not None
    observed = Observed(left.facts, left.series)
    if stop.detected_ns is None or not observed.has(axis, "stop_force_n"):
        return ""
    force_n = observed.value(axis, "stop_force_n", observed.index_at(stop.detected_ns))
    return "without a stop" if force_n == 0.0 else ""


# Motion after an alarm


def stops(left: Left) -> str:
    """The set positions stand as soon as the lists let them after what ends the program."""
    alarm = ending(left)
    if alarm is None:
        return ""
    places = {axis: _led(left, axis) for axis in left.facts.axes}
    stood_ns = alarm.time_ns
    for times_ns, set_mm in places.values():
        moving = times_ns[1:][np.diff(set_mm) != 0.0]
        stood_ns = max(stood_ns, int(moving[-1]) if len(moving) else 0)
    took_ns = stood_ns - alarm.time_ns
    paths = {axis: _without_offset(left, axis) for axis in left.facts.axes}
    allowed_ns = max(stop_ns(left.facts, alarm.time_ns, each) for each in (places, paths))
    if took_ns > allowed_ns:
        took, allowed = (f"{each / MS:.1f} ms" for each in (took_ns, allowed_ns))
        return f"{took} after alarm {alarm.id}, {allowed} allowed"
    return ""


def rests(left: Left) -> str:
    """No load moves any more 300 ms after an alarm has ended the program."""
    far = {axis: way for axis, way in left.crept_mm.items() if way > REST_MM}
    return ", ".join(f"{axis} {way:.4f} mm in 50 ms" for axis, way in far.items())


# Limits of set positions


def _led(left: Left, axis: str, name: str = "set_mm") -> tuple[Signal, Signal]:
    """Return instants, ns, and a column of an axis while the channel leads it, shape (n,).

    From the second cycle on: what is before is where the drive is.
    """
    observed = Observed(left.facts, left.series)
    if left.facts.start_ns is None or not observed.has(axis, name):
        return np.empty(0), np.empty(0)
    rows = observed.between(left.facts.start_ns, left.facts.sim_ns)
    return observed.instants(rows).astype(float), observed.column(axis, name, rows)


def _without_offset(left: Left, axis: str) -> tuple[Signal, Signal]:
    """Return instants, ns, and set positions without the offset of distance control, shape (n,).

    An offset that goes against the path hides the speed that both have to lose. The set position of
    a row has what 3D control superposes in that row, and the offset of its own control of the row
    before (tests/faults/test_offsets_in_the_trace.py).
    """
    times_ns, set_mm = _led(left, axis)
    _, superposed_mm = _led(left, axis, "superposed_mm")
    _, offset_mm = _led(left, axis, "offset_mm")
    if len(superposed_mm):
        set_mm = set_mm - superposed_mm
    if len(offset_mm):
        set_mm = set_mm - np.concatenate((offset_mm[:1], offset_mm[:-1]))
    return times_ns, set_mm


def _beyond(left: Left, derivative: int, what: str, unit: str) -> str:
    """Compare a derivative of the set positions with what the lists allow."""
    period_s = left.facts.timing.period_ns / S
    offsets = offset_lists_of(left.facts)
    for axis, record in left.facts.axes.items():
        allowed = lists_of(record).rate(derivative)
        beside = [offsets[name] for name in (axis, CHANNEL) if name in offsets]
        times_ns, set_mm = _led(left, axis)
        rate = np.abs(np.diff(set_mm, derivative)) / period_s**derivative
        if allowed is None or not len(rate):
            continue
        if derivative == 2:
            fastest_mm_s = sum(each.speed_mm_s or 0.0 for each in beside)
            rate = rate - _held(left, axis) * fastest_mm_s / period_s
        allowed += sum(each.rate(derivative) or 0.0 for each in beside)
        worst = int(np.argmax(rate))
        slack_mm = derivative / record.increments_per_mm + ROUNDING_MM
        if rate[worst] > allowed + slack_mm / period_s**derivative:
            at_ms = times_ns[worst] / 1e6
            return f"axis {axis}: {what} {rate[worst]:.6g} {unit} at {at_ms:.3f} ms, {allowed:g}"
    return ""


def _held(left: Left, axis: str) -> npt.NDArray[np.bool_]:
    """Return in which second differences of an axis an offset of distance control may stop at once.

    FREEZE, ERROR, a feedhold of the axis and what switches off and leaves the offset hold it from
    a cycle on, from whatever speed (docs/ambiguities.md): within the three rows or in the one
    before, which is still sent. It loses no more than its speed, P-AXIS-00415. Shape (n - 2,).
    """
    found = np.zeros(max(len(_led(left, axis)[1]) - 2, 0), np.bool_)
    for name in (axis, CHANNEL):
        times_ns, state = _led(left, name, "distance_state")
        if not len(state):
            continue
        _, held = _led(left, name, "distance_held")
        begins = _is_held_from(left, times_ns, state)
        if len(held):
            begins |= np.diff(held) > 0
        found |= begins[1:] | begins[:-1]
        found[1:] |= begins[:-2]
    return found


def _is_held_from(left: Left, times_ns: Signal, state: Signal) -> npt.NDArray[np.bool_]:
    """Return after which row of its states a distance control holds its offset, shape (n - 1,).

    What runs out comes to rest by itself: it is held where an alarm switches it off.
    """
    before, after = state[:-1], state[1:]
    begins = np.isin(after, (FREEZE, ERROR)) & (before != after)
    begins |= np.isin(before, FOLLOWING) & (after == INACTIVE)
    alarms_ns = np.array([alarm.time_ns for alarm in left.facts.alarms if alarm.ends_program])
    since = times_ns[1:, None] - alarms_ns[None, :]
    near = np.any(np.abs(since) <= 2 * left.facts.timing.period_ns, axis=1)
    found: npt.NDArray[np.bool_] = begins | ((before == TURNING_OFF) & (after == INACTIVE) & near)
    return found


def speed(left: Left) -> str:
    """No set position is faster than P-AXIS-00212, with distance control P-AXIS-00415 on top."""
    return _beyond(left, 1, "speed", "mm/s")


def acceleration(left: Left) -> str:
    """No set position has more than the largest acceleration of its lists, with P-AXIS-00416."""
    return _beyond(left, 2, "acceleration", "mm/s2")


def stroke(left: Left) -> str:
    """A run of type 4 stops within P-AXIS-00086 after the cycle that saw the signal."""
    if left.facts.channel.get("messtyp") != 4:
        return ""
    for run in left.facts.runs:
        if run.signal_ns is None:
            continue
        for axis in run.axes:
            lists = lists_of(left.facts.axes[axis])
            times_ns, set_mm = _led(left, axis)
            end_ns = run.end_ns or left.facts.end_ns
            inside = set_mm[(times_ns >= run.signal_ns) & (times_ns <= end_ns)]
            if lists.stroke_mm is None or not len(inside):
                continue
            way_mm = float(np.max(np.abs(inside - inside[0])))
            if way_mm > lists.stroke_mm + ROUNDING_MM:
                return f"axis {axis}: {way_mm:.4f} mm, stroke {lists.stroke_mm:g} mm"
    return ""


def still(left: Left) -> str:
    """The set position of an axis that is not programmed stays."""
    for axis in left.machine.still:
        _, set_mm = _led(left, axis)
        moved_mm = float(np.ptp(set_mm)) if len(set_mm) else 0.0
        if moved_mm > ROUNDING_MM:
            return f"axis {axis} moves by {moved_mm:.6g} mm"
    return ""


# Distance control


def deviation(left: Left) -> str:
    """The offset of distance control is never beyond P-AXIS-00414."""
    for name, lists in offset_lists_of(left.facts).items():
        _, offset_mm = _led(left, name, "offset_mm")
        most_mm = float(np.max(np.abs(offset_mm))) if len(offset_mm) else 0.0
        if lists.deviation_mm is not None and most_mm > lists.deviation_mm + ROUNDING_MM:
            return f"offset of {name}: {most_mm:.6g} mm, {lists.deviation_mm:g} mm allowed"
    return ""


def blind(left: Left) -> str:
    """Without a value that the lists allow the offset goes no further than its braking takes.

    What OFF runs out goes to 0 whatever the sensor shows: it is watched while a control follows it.
    """
    period_s = left.facts.timing.period_ns / S
    for name, lists in offset_lists_of(left.facts).items():
        _, offset_mm = _led(left, name, "offset_mm")
        _, sensor_mm = _led(left, name, "sensor_mm")
        if not len(offset_mm) or not len(sensor_mm):
            continue
        valid = lists.allows(sensor_mm)
        _, state = _led(left, name, "distance_state")
        for begin, end in _stretches(~valid & (state != TURNING_OFF)):
            first = max(begin - 1, 0)
            v_mm_s = max(0.0, float(offset_mm[max(first - 1, 0)] - offset_mm[first])) / period_s
            allowed_mm = v_mm_s**2 / (2.0 * (lists.a_mm_s2 or np.inf)) + 2.0 * v_mm_s * period_s
            allowed_mm += 2.0 * (lists.a_mm_s2 or 0.0) * period_s**2 + ROUNDING_MM
            way_mm = float(offset_mm[first] - np.min(offset_mm[first:end]))
            if way_mm > allowed_mm:
                return f"offset of {name}: {way_mm:.6g} mm towards it, {allowed_mm:.6g} mm allowed"
    return ""


def _stretches(inside: npt.NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield begin and end of the rows in which something holds without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(inside, np.int8), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


# States


def states(left: Left) -> str:
    """States change along the edges of their tables only."""
    return wrong_steps(left)
