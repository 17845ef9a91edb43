"""What became of a check or a run, in one sentence: for report, terminal and pytest.

Of stored results and those of other tools the words are the same as of a run that has just ended.
"""

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from typing import NamedTuple

from axisrig.bench.plan.check_row import CheckRow, decimal
from axisrig.bench.plan.checks import (
    CheckResult,
    Condition,
    known_metrics,
    parse_condition,
)
from axisrig.bench.plan.expectation import NOT_MET
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError, same_cause

_DIGITS = 3
_ALARMS = "alarms"
_SIDES = {"lower": ("below", "above"), "upper": ("above", "below")}


def check_sentence(row: CheckRow) -> str:
    """Say what a check found, without a full stop. Distances have three digits."""
    kind = _type(row.metric)
    if not row.value and (kind != _ALARMS or row.verdict == "error"):
        return _without_value(row)
    if kind == _ALARMS:
        return _alarms(row)
    number, limits = decimal(row.value), _limits(row)
    if number is not None and any(limit is not None for limit in limits.values()):
        return _between(row, number, limits)
    return _compared(row, number)


def _limits(row: CheckRow) -> Mapping[str, Decimal | None]:
    """The limits by their sides."""
    return {"lower": decimal(row.lower), "upper": decimal(row.upper)}


def run_sentence(verdict: Verdict, error: str | None, checks: Sequence[CheckRow]) -> str:
    """Say why a run has its verdict: by its error, or else by the first check that has it.

    error: why it ended without being judged.
    """
    if error and not any(row.value for row in checks):
        return error if verdict is Verdict.ABORTED else f"no verdict: {error}"
    row = decisive_check(verdict, checks)
    if row is None:
        return error or (f"no check is {verdict.word}" if checks else "no check")
    if row.has_missed:
        return f"{row.metric} {NOT_MET}"
    more = sum(one.verdict == verdict.word for one in checks) - 1
    besides = f", and {more} more check{'s' if more > 1 else ''}" if more else ""
    return f"{check_sentence(row)}{besides}"


def decisive_check(verdict: Verdict, checks: Sequence[CheckRow]) -> CheckRow | None:
    """Return the check that a run has its verdict from, None without any.

    It is the first one with this verdict, or a check that had to fail and did not.
    """
    own = [row for row in checks if row.verdict == verdict.word]
    missed = [row for row in checks if row.has_missed]
    if missed and verdict is Verdict.FAIL and len(own) <= _expected(checks):
        return missed[0]
    return own[0] if own else None


class Reach(NamedTuple):
    """Where a number is at its nearest limit. side: of the limit, lower or upper. room: how far it
    is inside, negative outside; both in the unit of the metric.
    """

    side: str
    limit: Decimal
    room: Decimal


def reach(row: CheckRow) -> Reach | None:
    """Return where the value of a check is, None without number or limit."""
    number = decimal(row.value)
    return None if number is None else _nearest(number, _limits(row))


def _nearest(number: Decimal, limits: Mapping[str, Decimal | None]) -> Reach | None:
    sides = [
        Reach(side, limit, number - limit if side == "lower" else limit - number)
        for side, limit in limits.items()
        if limit is not None
    ]
    return min(sides, key=lambda one: one.room, default=None)


def alike_sentence(rows: Sequence[CheckRow]) -> str:
    """Say what rows of one metric have in common that are on the same side of their limits."""
    places = [known for row in rows if (known := reach(row)) is not None]
    if len(places) < len(rows) or not places:
        return check_sentence(rows[0])
    metric, unit, side = rows[0].metric, rows[0].unit, places[0].side
    limits = {one.limit for one in places}
    name = f"its {side} limit"
    name += f" {_with_unit(_number(places[0].limit), unit)}" if len(limits) == 1 else ""
    if rows[0].verdict == Verdict.INCONCLUSIVE.word:
        return f"{metric} is within its uncertainty of {name}"
    return f"{metric} is {_SIDES[side][0]} {name}"


def result_sentence(result: CheckResult) -> str:
    """Say the same of a check that has just been judged."""
    return check_sentence(CheckRow.of(result))


def _expected(checks: Sequence[CheckRow]) -> int:
    """How many checks failed as expected."""
    return sum(
        row.verdict == Verdict.FAIL.word and row.had_to_fail and not row.has_missed
        for row in checks
    )


def _type(metric: str) -> str:
    """The type of a metric (`metrics.csv`); of one that the table does not have `any`."""
    known = known_metrics().get(metric.partition(":")[0])
    return known.type if known else (_ALARMS if metric == _ALARMS else "any")


def _without_value(row: CheckRow) -> str:
    said = {
        "error": "could not be judged",
        "inconclusive": "is not available here",
        "aborted": "was not reached",
    }.get(row.verdict, "has no value")
    return f"{row.metric} {said}" + (f": {row.note}" if row.note else "")


# ---- numbers


def _between(row: CheckRow, value: Decimal, limits: Mapping[str, Decimal | None]) -> str:
    """A number and its limits: how far it is from the nearest one, on which side."""
    metric, unit, verdict = row.metric, row.unit, row.verdict
    lower, upper = limits["lower"], limits["upper"]
    if verdict == "pass":
        return f"{metric} is {_with_unit(_number(value), unit)}, inside its limits"
    if lower is not None and lower == upper and verdict == "fail":
        far = _distance(value - lower, unit)
        side = "above" if value > lower else "below"
        return (
            f"{metric} is {far} {side} {_with_unit(_number(lower), unit)}, the only value allowed"
        )
    known = _nearest(value, limits)
    assert known is not None
    side, limit, room = known
    name = f"its {side} limit {_with_unit(_number(limit), unit)}"
    if not room:
        place = f"is on {name}"
    else:
        place = f"is {_distance(room, unit)} {_SIDES[side][room > 0]} {name}"
    return f"{metric} {place}{_why(row, verdict, room)}"


def _why(row: CheckRow, verdict: str, room: Decimal) -> str:
    """Why a verdict is not that of the bare number."""
    known = decimal(row.uncertainty)
    spread = "" if known is None else _distance(known, row.unit)
    if verdict == "inconclusive":
        return (
            f", within its uncertainty of {spread}"
            if spread
            else ", and its uncertainty is unknown"
        )
    if verdict == "marginal":
        return f", less than twice its uncertainty of {spread}"
    return ", which is outside" if verdict == "fail" and room >= 0 else ""


def _compared(row: CheckRow, number: Decimal | None) -> str:
    """A text, or a number that has no limits: what it is, and what was asked for."""
    metric, value, asked = row.metric, row.value, row.asked
    shown = value if number is None else _with_unit(_number(number), row.unit)
    condition = _condition(asked, _type(metric))
    if row.verdict == "pass":
        return f"{metric} is {shown}, as asked for"
    if condition is None:
        return f"{metric} is {shown}, asked for {asked}" if asked else f"{metric} is {shown}"
    if condition.kind in {"unequal", "not_text"}:
        excluded = condition.expected[0]
        if row.verdict == "inconclusive" and number is not None:
            why = _why(row, "inconclusive", Decimal(0))
            return f"{metric} is {shown}, too near to {excluded}, which is excluded{why}"
        return f"{metric} is {shown}, which is excluded"
    if condition.kind == "text":
        return f"{metric} is {shown}, not {condition.expected[0]}"
    return f"{metric} is {shown}, which is no number: asked for {asked}"


# ---- alarms


def _alarms(row: CheckRow) -> str:
    """The IDs that came up against those that were asked for; either ID of a family is one."""
    metric, found = row.metric, row.value.split()
    prefix = "" if metric == _ALARMS else f"{metric}: "
    came = f"{_named(found)} came up" if found else "no alarm came up"
    condition = _condition(row.asked, _ALARMS)
    if row.verdict == "pass" or condition is None:
        return f"{prefix}{came}"
    return prefix + _alarms_against(condition, found, came)


def _alarms_against(condition: Condition, found: list[str], came: str) -> str:
    expected = list(condition.expected)
    if condition.kind == "not_alarms":
        return f"{came}, which is excluded"
    if condition.kind == "one_of":
        words = " or ".join(expected)
        extra = list(_without(found, expected, is_once=False))
        return (
            f"{_named(extra or found)} came up, expected was {words}"
            if found
            else (f"no alarm came up, expected was {words}")
        )
    missing = list(_without(expected, found))
    extra = list(_without(found, expected)) if condition.kind == "alarms" else []
    parts = []
    if missing:
        parts.append(f"{_named(missing)} did not come up")
    if extra:
        wanted = "none was expected" if not expected else "not expected"
        parts.append(f"{_named(extra)} came up, {wanted}")
    if not missing and not extra:
        return f"{came} in another order than {' '.join(expected)}"
    if not found and missing:
        return f"{parts[0]}, nor any other"
    return "; ".join(parts)


def _without(ids: Sequence[str], others: Sequence[str], *, is_once: bool = True) -> Iterator[str]:
    """The IDs that the others do not have; is_once: each of the others stands for one."""
    left = [_cause(word) for word in others]
    for word in ids:
        if _cause(word) in left:
            if is_once:
                left.remove(_cause(word))
        else:
            yield word


def _cause(word: str) -> str:
    return str(same_cause(int(word))) if word.isdecimal() else word


def _named(ids: Sequence[str]) -> str:
    """`alarm 1`, `alarms 1 and 2`, `alarms 1, 2 and 3`."""
    if len(ids) == 1:
        return f"alarm {ids[0]}"
    return f"alarms {', '.join(ids[:-1])} and {ids[-1]}"


# ---- words and digits


def _condition(text: str, kind: str) -> Condition | None:
    """The condition of a cell, None for one that this version cannot read."""
    try:
        return parse_condition(text, kind)
    except UserError:
        return None


def _distance(number: Decimal, unit: str) -> str:
    return _with_unit(short_number(abs(float(number)), _DIGITS), unit)


def _number(number: Decimal) -> str:
    """A value or limit: as written where that is short, else with seven digits."""
    text = str(number)
    return text if len(text) <= 9 else short_number(float(number), 7)


def short_number(number: float, digits: int) -> str:
    """Return a number with so many significant digits, without exponent where that stays short."""
    text = f"{number:.{digits}g}"
    if "e" in text and 1e-7 <= abs(number) < 1e15:
        text = f"{Decimal(text):f}"
    return text


def _with_unit(text: str, unit: str) -> str:
    return f"{text} {unit}".rstrip()
