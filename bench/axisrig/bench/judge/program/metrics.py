"""The metrics of a whole program: alarms, duration, buses, lags, printed values."""

from collections.abc import Callable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from axisrig.bench.judge.observed.motion import (
    INSIDE,
    Largest,
    doubts_before,
    fastest,
    largest,
    together,
)
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.plan.checks import Check
from axisrig.bench.record.series import Signal

DELAY = "antr.nbr_delay_cycles"
"""P-AXIS-00191."""

PROGRAM_METRICS: dict[str, MetricFunction] = {}


def printed(observed: Observed, check: Check) -> Observation:
    """Return a number that a block of the program has printed with `#MSG`."""
    assert check.block is not None
    number, index = check.block
    values = [
        value
        for message in observed.facts.messages
        if f"N{message.block}" == number
        for value in message.values
    ]
    if len(values) < index:
        return Observation(None, note=f"block {number} printed {len(values)} number(s)")
    unproved = " ".join(a for a, record in observed.axes.items() if record.unproved_latches)
    note = f"the program has measured with unproved latches of {unproved}" if unproved else ""
    return Observation(values[index - 1], note=note)


def _of_program(function: MetricFunction) -> MetricFunction:
    """Register a metric of the whole program under the name of its function."""
    PROGRAM_METRICS[function.__name__] = function
    return function


# The whole program


@_of_program
def alarms(observed: Observed, _axis: str | None) -> Observation:
    """IDs of the alarms in their order."""
    return Observation([a.id for a in observed.facts.alarms if not a.is_further])


@_of_program
def further_alarms(observed: Observed, _axis: str | None) -> Observation:
    """IDs of what came up while the axes were already stopping."""
    return Observation([a.id for a in observed.facts.alarms if a.is_further])


@_of_program
def duration_s(observed: Observed, _axis: str | None) -> Observation:
    """Simulated time from the first enabled cycle to the end of the program."""
    start_ns = observed.facts.start_ns
    if start_ns is None:
        return Observation(None, note="the drives were never enabled")
    return Observation((observed.facts.end_ns - start_ns) / 1e9)


@_of_program
def bus_load_pct(observed: Observed, _axis: str | None) -> Observation:
    """Load over the whole run, of the segment that has most."""
    return Observation(max(bus.load_pct for bus in observed.facts.buses))


@_of_program
def bus_load_100ms_pct_max(observed: Observed, _axis: str | None) -> Observation:
    """Load in the worst window of 100 ms of any segment."""
    return Observation(max(bus.load_100ms_pct for bus in observed.facts.buses))


@_of_program
def bus_load_1ms_pct_max(observed: Observed, _axis: str | None) -> Observation:
    """Load in the worst window of 1 ms of any segment."""
    return Observation(max(bus.load_1ms_pct for bus in observed.facts.buses))


@_of_program
def error_frames(observed: Observed, _axis: str | None) -> Observation:
    """Error frames on all segments."""
    return Observation(sum(bus.error_frames for bus in observed.facts.buses))


@_of_program
def queueing_us_max(observed: Observed, axis: str | None) -> Observation:
    """Longest wait of a frame for the bus, of one axis or of all."""
    waits = [w for bus in observed.facts.buses for w in bus.waiting if axis in (None, w.axis)]
    if not waits:
        lines = ", ".join(bus.segment for bus in observed.facts.buses if bus.line is not None)
        note = f"nothing waits on EtherCAT ({lines}): its master alone sends" if lines else ""
        return Observation(None, note=note or "nothing was sent")
    longest = max(waits, key=lambda wait: wait.worst_us)
    return Observation(longest.worst_us, note=longest.name)


def _of_axes(largest: Callable[[Observed, str], Largest | None]) -> MetricFunction:
    """Return the metric that is the largest of an axis, or of all, up to the end of the program."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        if not len(observed):
            return Observation(None, note="the program ended before its first cycle")
        found = [largest(observed, each) for each in ([axis] if axis else observed.axes)]
        known = together(found)
        assert known is not None, "there are rows"
        return Observation(known.value, known.doubt, INSIDE if known.doubt else "")

    return metric


def _rows(observed: Observed) -> slice:
    return slice(observed.index_at(observed.facts.end_ns) + 1)


def _cnc_lag(observed: Observed, axis: str) -> Largest | None:
    """Return the largest lag as the CNC judges it: before s(k) is made d = 0 counts as 1.

    The column has s(k) in it then; 0 is the lag of an axis that its drive leads. Where the CNC
    closes the position loop it judges what its controller has computed, with s(k) in it.
    """
    of_axis = observed.axes[axis]
    is_of_loop = any("speed" in telegram.fields for telegram in of_axis.telegrams)
    is_zero = of_axis.written.get(DELAY) == 0 and not is_of_loop
    found = [0.0]
    for part in observed.parts(_rows(observed), before=1):
        lag_mm = part.observed.column(axis, "cnc_lag_mm", part.inside)
        if is_zero:
            rows = slice(max(part.inside.start - 1, 0), part.inside.stop)
            set_mm = part.observed.column(axis, "set_mm", rows)
            made_mm = np.diff(set_mm, prepend=set_mm[: 1 - (part.inside.start - rows.start)])
            lag_mm = np.where(lag_mm == 0.0, 0.0, lag_mm - made_mm)
        found.append(float(np.max(np.abs(lag_mm))))
    return Largest(max(found), 0.0)


_OF_ROUNDING = (70.0 / 12.0) ** 0.5
"""Standard deviation of a fourth difference of whole increments: weights 1, 4, 6, 4, 1 of 1/12."""


def _drive_lag(observed: Observed, axis: str) -> Largest | None:
    """Return the largest lag in the drive; between two SYNCs the motor is a cubic (`lag.py`).

    Its doubt is read from the positions of the encoder around each step: 1/16 of their fourth
    difference and of what rounding makes of that. A jump of the acceleration puts it off by 0.4 of
    that at most, a vibration of up to half a period in a step by 0.9; a screw that swings faster by
    more (`tests/study`). What its demand does at every SYNC is in the load as well; what its
    corners make alike in each step, which no SYNC shows, counts as `motion.py` has it.
    """
    found = []
    for part in observed.parts(_rows(observed)):
        values = part.observed.column(axis, "drive_lag_peak_mm", part.inside)
        first, last = part.begin, part.begin + len(values)
        around = slice(max(first - 3, 0), min(last + 3, len(observed)))
        fourth = np.abs(np.diff(observed.column(axis, "actual_mm", around), 4))
        fourth[fourth > 0.0] += _OF_ROUNDING / observed.axes[axis].increments_per_mm
        # Each is of five rows; the four that have both ends of a step count for it
        of_steps = sliding_window_view(np.pad(fourth, 4), 4).max(axis=1)[first - around.start :]
        doubts_mm = np.maximum(
            of_steps[: len(values)] / 16.0, doubts_before(observed, axis, first, last)
        )
        found.append(largest(values, doubts_mm))
    return together(found)


PROGRAM_METRICS["lag_mm_max"] = _of_axes(_cnc_lag)
PROGRAM_METRICS["drive_lag_mm_max"] = _of_axes(_drive_lag)
PROGRAM_METRICS["velocity_mm_s_max"] = _of_axes(
    lambda observed, axis: fastest(observed, axis, 0, observed.facts.end_ns)
)


def _of_set_positions(name: str, order: int, chosen: Callable[[Signal, Signal], Signal]) -> None:
    """Register the largest of what is chosen of a difference of the set positions.

    order: 2 = acceleration, 3 = jerk, over whole cycles. chosen: gives values to compare, from the
    difference and the speed beside it. Inside a cycle the motion may do more; a part that lasts
    `order` cycles is read exactly.
    """

    def largest(observed: Observed, axis: str | None) -> Observation:
        start_ns, timing = observed.facts.start_ns, observed.facts.timing
        if start_ns is None:
            return Observation(None, note="the drives were never enabled")
        rows, period_s = observed.between(start_ns, observed.facts.end_ns), timing.period_ns / 1e9
        found = [0.0]
        for each in [axis] if axis else list(observed.axes):
            for part in observed.parts(rows, before=order):
                first = max(part.inside.start - order, 0)
                set_mm = part.observed.column(each, "set_mm", slice(first, part.inside.stop))
                values = np.diff(set_mm, order) / period_s**order
                speed = np.diff(set_mm)
                beside = speed[: len(values)] + speed[len(speed) - len(values) :]
                if len(values):
                    found.append(float(np.max(chosen(values, beside))))
        return Observation(max(found))

    PROGRAM_METRICS[name] = largest


_of_set_positions("set_acceleration_mm_s2_max", 2, lambda a, v: a * np.sign(v))
_of_set_positions("set_deceleration_mm_s2_max", 2, lambda a, v: -a * np.sign(v))
_of_set_positions("set_jerk_mm_s3_max", 3, lambda j, _v: np.abs(j))
