"""Samples of runs, and the judgement of a statistic over them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed, takes_part
from axisrig.bench.judge.statistics.functions import FUNCTIONS, Collected
from axisrig.bench.plan.checks import Check, CheckResult, judge
from axisrig.bench.plan.statistic_checks import RUN, TOUCH, StatisticCheck
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.statistics.reach import unreached
from axisrig.kernel.errors import UserError

Observe = Callable[[Observed, Check], Observation]
_NAMED_MAX = 3


@dataclass(frozen=True)
class Reading:
    """One value of a metric. touch: number of the measurement run, from 1.

    sides: metrics that are wanted beside it, in their order.
    """

    touch: int
    metric: Observation
    sides: tuple[Observation, ...] = ()


@dataclass(frozen=True)
class RunSample:
    """What one run gives to a statistic.

    readings: one per measurement run, or one. missing: why it gives none. inputs: input columns of
    the run. frames: hash of its frames; two runs with equal inputs and equal frames are one.
    """

    run: str
    readings: tuple[Reading, ...] = ()
    missing: str = ""
    inputs: Mapping[str, str] = field(default_factory=dict)
    frames: str = ""


def readings(observed: Observed, check: StatisticCheck, observe: Observe) -> tuple[Reading, ...]:
    """Return the values that a run gives to a statistic.

    A metric that judges the last measurement run is asked of each one that the program has made, of
    an axis of those in which it takes part; any other metric, and with `last`, once.
    """
    of = check.metric_check
    numbers = [
        number
        for number, run in enumerate(observed.facts.runs)
        if of.axis is None or takes_part(run, of.axis)
    ]
    if of.definition.judged != "last" or check.is_last or not numbers:
        return (_reading(1, observed, check, observe),)
    found = []
    for touch, number in enumerate(numbers, start=1):
        part = observed.until_run(number)
        found.append(_reading(touch, part, check, observe))
        part.forget()
    return tuple(found)


def _reading(touch: int, part: Observed, check: StatisticCheck, observe: Observe) -> Reading:
    sides = [side for side in check.sides if isinstance(side, Check)]
    return Reading(
        touch, observe(part, check.metric_check), tuple(observe(part, side) for side in sides)
    )


NOT_RANDOM = (
    "nothing in the row is random: repeats differ where an input draws from the seed, such as"
    " drive:<drive>.input_jitter_us, a noise of the plant or normal(mean, s)"
)
"""What to do where repeats are equal."""


def judge_statistic(check: StatisticCheck, samples: Sequence[RunSample]) -> CheckResult:
    """Judge a statistic over the runs of its case.

    inconclusive: a run gives no values (it is missing, aborted or in error), there are too few, too
    few for the limit of a test, or the statistic is undefined for them (no spread). fail: a run did
    not deliver its metric.
    """
    missing = [f"{sample.run} {sample.missing}" for sample in samples if sample.missing]
    if missing:
        named = ", ".join(missing[:_NAMED_MAX]) + (", ..." if len(missing) > _NAMED_MAX else "")
        return _open(check, f"without values of {len(missing)} of {len(samples)} runs: {named}")
    counted, equal = _distinct(samples)
    found = [(sample, reading) for sample in counted for reading in sample.readings]
    for sample, reading in found:
        for seen in (reading.metric, *reading.sides):
            if not isinstance(seen.value, Real) or isinstance(seen.value, bool):
                place = f"{sample.run}, touch {reading.touch}" if sample.run else ""
                place = place or f"touch {reading.touch}"
                note = f"{place}: {seen.note or 'no number'}"
                return judge(check, None, note=note, is_hidden=seen.is_hidden)
    n, row = len(found), check.statistic
    words = _counted(n, len(samples), equal)
    if n < row.least:
        hint = f"; {NOT_RANDOM}" if equal else ""
        return _open(check, f"{words}; {row.name} needs {row.least} values{hint}")
    beyond = _out_of_reach(check, n)
    if beyond:
        return _open(check, f"{words}; {beyond}")
    try:
        result = FUNCTIONS[row.name](_collect(check, samples, found))
    except UserError as error:
        return _open(check, f"{words}; {error.message}")
    small = f"small sample (fewer than {row.few})" if n < row.few else ""
    note = "; ".join(text for text in (words, small, result.words) if text)
    return judge(check, result.value, result.uncertainty, note)


def counted_values(samples: Sequence[RunSample]) -> tuple[list[str], list[float], list[str]]:
    """Return what counts of the values of runs: their names, the values, and equal runs.

    names: run and touch. equal: ids of runs that repeat an earlier one exactly. Values that are no
    finite numbers are left out.
    """
    counted, equal = _distinct(samples)
    names: list[str] = []
    values: list[float] = []
    for sample in counted:
        for reading in sample.readings:
            value = reading.metric.value
            if isinstance(value, Real) and math.isfinite(value):
                names.append(f"{sample.run}, touch {reading.touch}")
                values.append(float(value))
    return names, values, equal


def _out_of_reach(check: StatisticCheck, n: int) -> str:
    """Say which limit of a test n values cannot get to: it holds, or not, whatever they are."""
    condition = check.condition
    limits = [limit for limit in (condition.lower, condition.upper) if limit is not None]
    found = (unreached(check.statistic.name, n, limit) for limit in limits)
    return next((words for words in found if words), "")


def _open(check: StatisticCheck, note: str) -> CheckResult:
    return CheckResult(check, None, 0.0, Verdict.INCONCLUSIVE, note)


def _counted(n: int, runs: int, equal: Sequence[str]) -> str:
    text = f"n = {n}"
    if runs > 1:
        text += f" from {runs - len(equal)} of {runs} runs"
    if equal:
        named = ", ".join(equal[:_NAMED_MAX]) + (", ..." if len(equal) > _NAMED_MAX else "")
        text += f"; same frames as an earlier run, not counted: {named}"
    return text


def _distinct(samples: Sequence[RunSample]) -> tuple[list[RunSample], list[str]]:
    """Return the runs that count, and the ids of those that repeat an earlier one exactly."""
    seen: set[tuple[object, ...]] = set()
    counted, equal = [], []
    for sample in samples:
        key = (sample.frames, *sorted(sample.inputs.items()))
        if sample.frames and key in seen:
            equal.append(sample.run)
            continue
        seen.add(key)
        counted.append(sample)
    return counted, equal


def _collect(
    check: StatisticCheck,
    samples: Sequence[RunSample],
    found: Sequence[tuple[RunSample, Reading]],
) -> Collected:
    """Put the values in order, with what the statistic needs beside them."""
    places = {sample.run: place for place, sample in enumerate(samples, start=1)}
    sides: list[list[float | str]] = []
    metrics = 0
    for side in check.sides:
        if isinstance(side, Check):
            sides.append([_number(reading.sides[metrics]) for _, reading in found])
            metrics += 1
        elif side == RUN:
            sides.append([str(places[sample.run]) for sample, _ in found])
        elif side == TOUCH:
            sides.append([str(reading.touch) for _, reading in found])
        else:
            sides.append([sample.inputs.get(side, "nan") for sample, _ in found])
    return Collected(
        check,
        [_number(reading.metric) for _, reading in found],
        max((reading.metric.uncertainty for _, reading in found), default=0.0),
        sides,
        max((side.uncertainty for _, reading in found for side in reading.sides), default=0.0),
    )


def _number(seen: Observation) -> float:
    assert isinstance(seen.value, Real)
    return float(seen.value)
