"""Conditions on metrics: reading them, and judging a value against them with its uncertainty."""

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from functools import cache, lru_cache
from importlib import resources
from numbers import Real

from axisrig.bench.plan.hints import condition_hint
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError, catalogue, nearest, same_cause

Value = float | int | str | Sequence[int] | None
"""What a metric can be: a number, a text, the IDs of alarms in order, or None when missing."""

CONDITION_FORMS = (
    "<= 0.5, < 1, >= 2, > 2, == 70331, != 3, 66.99 .. 67.01, 100 +- 0.001, == TRUE;"
    " for alarms: none, == 50059 50052 (these in this order), contains 50052,"
    " one of 50059 50052 (no other)"
)

UNKNOWN_METRIC = "unknown metric"
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_DECIMAL_COMMA = r"[+-]?\d+,\d+"
_RANGE = re.compile(rf"({_NUMBER})\s*\.\.\s*({_NUMBER})")
_TOLERANCE = re.compile(rf"({_NUMBER})\s*(?:\+-|\+/-|±)\s*({_NUMBER})")
_COMPARISON = re.compile(r"(<=|>=|==|!=|<|>)\s*(.*)", re.DOTALL)
_METRIC = re.compile(r"(?P<name>\w+)(?::(?P<of>\w+)(?:\.(?P<index>[1-9]\d*))?)?")
_BLOCK = re.compile(r"N\d+")


@dataclass(frozen=True)
class Metric:
    """One row of `metrics.csv`.

    scope: "run" (one value), "axis" (`name:X`; without an axis that of the longest
        travel, at a fixed stop the detecting one, for `*_max` the largest of all axes),
        "block" (`name:N30` or `name:N30.2`). type: "number", "text", "alarms" or "any".
    plot: the plot of the report in which limits of the metric are drawn, or empty. needs: "plant"
        or "bus" when only a simulated one has it; empty when the kernel can.
    judged: of several measurement runs the "last" (of the axis, where one is named) or the worst
        of "every" one; empty: the whole program. words: all that a text can be; empty: any.
    linear: of a metric of `rotary_metrics.csv`, its counterpart for linear axes.
    """

    name: str
    scope: str
    type: str
    unit: str
    plot: str
    needs: str
    judged: str
    words: str
    meaning: str
    source: str
    linear: str = ""


@cache
def known_metrics() -> Mapping[str, Metric]:
    """Read `metrics.csv`, with the twins for rotary axes of `rotary_metrics.csv`, keyed by name."""
    known = {row["name"]: Metric(**row) for row in _table("metrics.csv")}
    for row in _table("rotary_metrics.csv"):
        own = known[row["metric"]]
        known[row["name"]] = replace(
            own,
            name=row["name"],
            unit=row["unit"],
            plot=row["plot"],
            meaning=f"{own.name} of a rotary axis: {own.meaning}",
            linear=own.name,
        )
    return known


def rotary_twin(metric: str) -> str | None:
    """Return the counterpart for rotary axes of a metric of linear axes."""
    known = known_metrics().values()
    return next((twin.name for twin in known if twin.linear == metric), None)


def _table(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@dataclass(frozen=True)
class Condition:
    """What a metric has to fulfil, as the plan's cell says it.

    text: the cell. kind: "range" (numbers between `lower` and `upper`), "unequal" (any number
        but the one in `expected`), "text", "not_text", "alarms", "not_alarms", "contains",
        "one_of".
    lower, upper: limits in the metric's unit, None = open to that side.
    lower_open, upper_open: the limit itself is outside (`<`, `>`).
    expected: the text, the number of "unequal", or the alarm IDs, as text.
    """

    text: str
    kind: str
    lower: float | None = None
    upper: float | None = None
    lower_open: bool = False
    upper_open: bool = False
    expected: tuple[str, ...] = ()

    def judge(self, value: Value, uncertainty: float = 0.0) -> Verdict:
        """Judge `value`, known to +-`uncertainty` (expanded, in the unit of the value).

        No value (None or NaN) fails: it was to be delivered and was not. When the bench is to
        blame, the runner says `error` instead. Text and alarms pass or fail.
        For numbers the guard band is the uncertainty u itself; with d = distance to the nearest
        limit, positive inside:

            d > 2u        pass
            u < d <= 2u   marginal
            -u <= d <= u  inconclusive
            d < -u        fail

        With u = 0 a value inside or on the limit passes, and any other fails; on the limit of
        `<`, `>` and `!=` it fails. An uncertain number against an equality is inconclusive at
        best: its distance inside is never above zero.
        Raises ValueError for a negative or undefined uncertainty, which is a defect.
        Source: ISO 14253-1 for the rule that the side that judges bears the uncertainty.
        """
        if not uncertainty >= 0.0:
            raise ValueError(f"uncertainty {uncertainty!r}")
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return Verdict.FAIL
        if self.kind in _NUMBER_KINDS:
            number = _as_number(value)
            return Verdict.FAIL if number is None else self._judge_number(number, uncertainty)
        return Verdict.PASS if self._holds(value) else Verdict.FAIL

    def _judge_number(self, value: float, uncertainty: float) -> Verdict:
        distance, excluded = self._distance(value)
        if uncertainty == 0.0:
            inside = distance > 0.0 or (distance == 0.0 and not excluded)
            return Verdict.PASS if inside else Verdict.FAIL
        if distance < -uncertainty:
            return Verdict.FAIL
        if distance <= uncertainty:
            return Verdict.INCONCLUSIVE
        return Verdict.MARGINAL if distance <= 2.0 * uncertainty else Verdict.PASS

    def _distance(self, value: float) -> tuple[float, bool]:
        """Distance to the nearest limit, positive inside, and whether that limit is outside."""
        if self.kind == "unequal":
            return abs(value - float(self.expected[0])), True
        below = (math.inf if self.lower is None else value - self.lower, self.lower_open)
        above = (math.inf if self.upper is None else self.upper - value, self.upper_open)
        return min(below, above, key=lambda side: side[0])

    def _holds(self, value: Value) -> bool:
        if self.kind in {"text", "not_text"}:
            return (str(value) == self.expected[0]) == (self.kind == "text")
        found, expected = _causes(value_text(value).split()), _causes(self.expected)
        if self.kind == "contains":
            return set(expected) <= set(found)
        if self.kind == "one_of":
            return set(found or ["none"]) <= set(expected)
        return (found == expected) == (self.kind == "alarms")


def _causes(ids: Iterable[str]) -> list[str]:
    """Either ID of a family names the same cause."""
    return [str(same_cause(int(word))) if word.isdecimal() else word for word in ids]


_NUMBER_KINDS = frozenset({"range", "unequal"})


def _as_number(value: Value) -> float | None:
    """The value as a number where it is one; a text may hold one (`#MSG` prints text)."""
    if isinstance(value, Real):  # also the scalars of numpy
        return float(value)
    if isinstance(value, str) and re.fullmatch(_NUMBER, value.strip()):
        return float(value)
    return None


def value_text(value: Value) -> str:
    """Write a value for the result files: numbers as repr, alarms with spaces, None as empty."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return " ".join(str(item) for item in value)
    return repr(float(value)) if isinstance(value, float) else str(value)


@lru_cache(maxsize=4096)
def parse_condition(text: str, type_: str = "any") -> Condition:
    """Read the condition of a cell for a metric of `type_` (see `Metric.type`).

    "any" takes an operand that reads as a number for a number, else for a text.
    Raises UserError for anything else than `CONDITION_FORMS`, and for alarm IDs that do not exist.
    """
    stripped = text.strip()
    if type_ == "alarms":
        return _alarm_condition(stripped)
    if type_ != "text":
        condition = _number_condition(stripped)
        if condition is not None:
            return condition
    comparison = _COMPARISON.fullmatch(stripped)
    operator, operand = comparison.groups() if comparison else ("==", stripped)
    undecidable = type_ == "number" or re.fullmatch(_DECIMAL_COMMA, operand)
    if undecidable or operator not in {"==", "!="} or not operand:
        raise _bad_condition(text)
    return Condition(stripped, "text" if operator == "==" else "not_text", expected=(operand,))


def _number_condition(text: str) -> Condition | None:
    """A condition on a number, or None when the text is none."""
    try:
        if match := _RANGE.fullmatch(text):
            return _between(text, Decimal(match[1]), Decimal(match[2]))
        if match := _TOLERANCE.fullmatch(text):
            # Decimal, since 100 + 0.001 in binary is not the 100.001 that the reader expects.
            middle, width = Decimal(match[1]), Decimal(match[2])
            return _between(text, middle - width, middle + width)
    except ArithmeticError as error:  # an exponent that no Decimal has
        raise _too_large(text) from error
    comparison = _COMPARISON.fullmatch(text)
    operator, operand = comparison.groups() if comparison else ("==", text)
    if not re.fullmatch(_NUMBER, operand):
        return None
    limit = _finite(text, float(operand))
    if operator == "!=":
        return Condition(text, "unequal", expected=(operand,))
    lower = limit if operator in {">", ">=", "=="} else None
    upper = limit if operator in {"<", "<=", "=="} else None
    return Condition(text, "range", lower, upper, operator == ">", operator == "<")


def _finite(text: str, limit: float) -> float:
    if not math.isfinite(limit):
        raise _too_large(text)
    return limit


def _too_large(text: str) -> UserError:
    return UserError("the limit of the condition is too large to be a limit", value=text)


def _between(text: str, lower: Decimal, upper: Decimal) -> Condition:
    if lower > upper:
        raise UserError(
            "the lower limit of the condition is above the upper one",
            value=text,
            hint="write the smaller number first; a tolerance is positive",
        )
    return Condition(text, "range", _finite(text, float(lower)), _finite(text, float(upper)))


def _alarm_condition(text: str) -> Condition:
    """`none`, one or more IDs in order, with `==`, `!=` or `contains` before them; `one of`.

    `one of`: at least one alarm came up, or none where that word is among them, and no other.
    """
    if match := re.fullmatch(r"one of\s+((?:(?:none|\d+)\s*\b)+)", text):
        words = tuple(match[1].split())
        _known_ids(word for word in words if word != "none")
        return Condition(text, "one_of", expected=words)
    match = re.fullmatch(r"(==|!=|contains\b)?\s*(.*)", text, re.DOTALL)
    assert match is not None
    operator, operand = match[1] or "==", match[2]
    ids = () if operand in {"", "none"} else tuple(operand.split())
    if not all(item.isdecimal() for item in ids) or (operator == "contains" and not ids):
        raise _bad_condition(text)
    _known_ids(ids)
    kind = {"==": "alarms", "!=": "not_alarms", "contains": "contains"}[operator]
    return Condition(text, kind, expected=ids)


def _known_ids(ids: Iterable[str]) -> None:
    """Raise UserError for an ID that no alarm has: `!=` would hold for ever."""
    for word in ids:
        if word.lstrip("0") not in (known := _ids_in_text()):
            allowed, hint = nearest(word, known) or None, "`axisrig errors` lists them all"
            raise UserError("no alarm has this ID", value=word, allowed=allowed, hint=hint)


@cache
def _ids_in_text() -> frozenset[str]:
    return frozenset(map(str, catalogue()))


def _bad_condition(text: str) -> UserError:
    hint = condition_hint(text)
    return UserError("not a condition", value=text, allowed=CONDITION_FORMS, hint=hint)


@dataclass(frozen=True)
class Check:
    """A condition on a metric, as one cell of a plan asks for it.

    metric: the metric as written, e.g. `latch_error_um:X`. reference: where the limit comes
    from, e.g. `probing.csv:3`. axis: of a per-axis metric, else None. block: NC block and number
    (from 1) of a `msg` metric, else None. defined: a metric that `metrics.csv` does not have.
    """

    metric: str
    condition: Condition
    reference: str
    axis: str | None = field(default=None, compare=False)
    block: tuple[str, int] | None = field(default=None, compare=False)
    defined: Metric | None = field(default=None, compare=False)

    @property
    def name(self) -> str:
        """The name of the metric without axis or block."""
        return self.metric.partition(":")[0]

    @property
    def definition(self) -> Metric:
        """The row of `metrics.csv`, or what was given in its place."""
        return self.defined or known_metrics()[self.name]

    @property
    def unit(self) -> str:
        """The unit of value, limits and uncertainty; empty for text, alarms and `msg`."""
        return self.definition.unit


def plot_limits(check: Check) -> list[dict[str, object]]:
    """Return limits that a plot can show: of a metric that is a value of a plotted signal."""
    limits = [v for v in (check.condition.lower, check.condition.upper) if v is not None]
    if not check.definition.plot:
        return []
    if check.name.endswith("_max"):  # a magnitude: the signal may reach the limit on both sides
        limits += [-v for v in limits]
    return [
        {"plot": check.definition.plot, "axis": check.axis, "value": v, "label": check.metric}
        for v in dict.fromkeys(limits)
    ]


def parse_check(
    metric: str, condition: str, reference: str, own: Mapping[str, Metric] | None = None
) -> Check:
    """Read a `check:` column: the metric in its header and the condition in its cell.

    own: metrics of the user, by name.
    Raises UserError for an unknown metric, with the nearest names, and for a bad condition.
    """
    match = _METRIC.fullmatch(metric)
    known = {**known_metrics(), **own} if own else known_metrics()
    definition = known.get(match["name"] if match else metric)
    if match is None or definition is None:
        raise _unknown_metric(metric, condition, known)
    axis, block = _subject(metric, definition, match)
    wanted = parse_condition(condition, definition.type)
    if definition.words:
        _check_word(wanted.expected[0], definition)
    defined = definition if own and definition.name in own else None
    return Check(metric, wanted, reference, axis, block, defined)


def _unknown_metric(metric: str, condition: str, known: Mapping[str, Metric]) -> UserError:
    """Make the error of a metric that nobody knows, and of a condition that fits none near it."""
    close = nearest(metric.partition(":")[0], known)
    hint = "`axisrig metrics` lists them all"
    error = UserError(UNKNOWN_METRIC, value=metric, allowed=close or known, hint=hint)
    try:
        parse_condition(condition, known[close[0]].type if close else "any")
    except UserError as further:
        error.further = (further,)
    return error


def _check_word(word: str, definition: Metric) -> None:
    """Raise UserError for a word that the metric never says: `!=` would hold for ever."""
    words = definition.words.split()
    if word not in words:
        close = nearest(word, words)
        hint = f"did you mean {close[0]}?" if close else None
        raise UserError(f"{definition.name} never says this", value=word, allowed=words, hint=hint)


def _subject(
    metric: str, definition: Metric, match: re.Match[str]
) -> tuple[str | None, tuple[str, int] | None]:
    """Axis or block of a metric. Raises UserError when the name does not fit the scope."""
    of, index = match["of"], match["index"]
    if definition.scope == "block":
        if of is None or not _BLOCK.fullmatch(of):
            raise UserError(
                "the metric needs the number of an NC block",
                value=metric,
                allowed=(f"{definition.name}:N30", f"{definition.name}:N30.2"),
            )
        return None, (of, int(index or 1))
    if index is not None or (definition.scope == "run" and of is not None):
        allowed = [definition.name]
        if definition.scope == "axis":
            allowed.append(f"{definition.name}:X")
        raise UserError("the metric cannot be asked for like this", value=metric, allowed=allowed)
    return of, None


@dataclass(frozen=True)
class CheckResult:
    """A check with the value it found.

    value: in the unit of the check, None when there is none. uncertainty: expanded, same unit.
    note: why there is no value, or what the uncertainty is made of.
    """

    check: Check
    value: Value
    uncertainty: float
    verdict: Verdict
    note: str = ""


def judge(
    check: Check,
    value: Value,
    uncertainty: float = 0.0,
    note: str = "",
    *,
    is_hidden: bool = False,
) -> CheckResult:
    """Judge `value` +- `uncertainty` (unit of the check) by the condition of `check`.

    is_hidden: the value is not available here, so a missing one is inconclusive and no failure.
    """
    verdict = check.condition.judge(value, uncertainty)
    if is_hidden and value is None:
        verdict = Verdict.INCONCLUSIVE
    return CheckResult(check, value, uncertainty, verdict, note)
