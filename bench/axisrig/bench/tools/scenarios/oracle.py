"""Judges what a scenario left by the invariants of every run."""

from dataclasses import dataclass, field
from enum import StrEnum

from axisrig.bench.tools.scenarios.invariants import (
    broken,
    ending,
    is_unknowable,
    values_of,
    wrong_value,
)
from axisrig.bench.tools.scenarios.left import Left


class Result(StrEnum):
    """What a scenario showed; the last three are defects."""

    GOOD = "every value right, no alarm above a warning"
    ALARM = "alarm"
    UNKNOWABLE = "a value is wrong as no control can know"
    NO_TRUTH = "the plant cannot say what happened"
    BROKEN = "AN INVARIANT DOES NOT HOLD"
    HANG = "program does not end"
    EXCEPTION = "exception"


DEFECTS = (Result.BROKEN, Result.HANG, Result.EXCEPTION)


@dataclass
class Judgement:
    """alarms: in their order. right: number of values that are true. broken: names of invariants
    that do not hold; note: of a defect. frames: hash of what was sent until the program ended.
    """

    result: Result
    alarms: list[int] = field(default_factory=list)
    right: int = 0
    note: str = ""
    broken: tuple[str, ...] = ()
    frames: str = ""


def judge(left: Left) -> Judgement:
    """Judge a run that has come to its end."""
    alarms = [alarm.id for alarm in left.facts.alarms if not alarm.is_further]
    values = list(values_of(left))
    wrong = [each for each in values if wrong_value(left, *each)]
    right = len(values) - len(wrong)
    found = list(broken(left))
    frames = left.facts.frame_log_sha256
    if found:
        names, note = tuple(name for name, _ in found), "; ".join(f"{n}: {w}" for n, w in found)
        return Judgement(Result.BROKEN, alarms, right, note, names, frames)
    is_judged = "value" not in left.hidden
    if is_judged and any(is_unknowable(left, number, axis) for number, axis, _ in wrong):
        result = Result.UNKNOWABLE
    else:
        result = Result.GOOD if ending(left) is None else Result.ALARM
    return Judgement(result, alarms, right, frames=frames)
