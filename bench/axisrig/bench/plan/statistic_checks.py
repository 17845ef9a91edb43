"""Checks of statistics: `check:mean(latch_error_um)`, over all values of a case.

A case with one run has its statistics among the checks of that run. A case with several gets a row
of its own in the results, after them: its run is `<plan>-<case>`.
"""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

from axisrig.bench.plan.assignment import find_form, number, parse_column
from axisrig.bench.plan.checks import (
    Check,
    Metric,
    known_metrics,
    parse_check,
    parse_condition,
)
from axisrig.kernel.errors import UserError, nearest

LAST = "last"
"""Argument: of each run the last measurement run alone, as a plain metric judges it."""
EACH = "each"
"""Argument: of each run by itself, also where the case has several."""
RUN, TOUCH = "run", "touch"
"""Columns that every case has: the number of the run, and of the touch within it, from 1."""

_CALL = re.compile(r"(?P<name>\w+)\s*\((?P<arguments>.*)\)")
_HINT = "`axisrig metrics` lists them all"


@dataclass(frozen=True)
class Statistic:
    """One row of `statistics.csv`.

    arguments: their kinds in order, in brackets where one may be left out. unit: "metric" that of
    the metric, "metric/column" for each unit of the column, "metric/value" for each value, else
    itself. least: values that it needs. few: below this the result is marked as a small sample.
    formula, uncertainty, meaning, source: in words.
    """

    name: str
    arguments: tuple[str, ...]
    unit: str
    least: int
    few: int
    formula: str
    uncertainty: str
    meaning: str
    source: str

    @property
    def form(self) -> str:
        """How a header asks for it."""
        return f"{self.name}({'; '.join(self.arguments)})"


@cache
def known_statistics() -> Mapping[str, Statistic]:
    """Read `statistics.csv`, keyed by name."""
    text = resources.files(__package__).joinpath("statistics.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return {
        row["name"]: Statistic(
            **{key: row[key] for key in row if key not in ("arguments", "least", "few")},
            arguments=tuple(word.strip() for word in row["arguments"].split(";")),
            least=int(row["least"]),
            few=int(row["few"]),
        )
        for row in rows
    }


@dataclass(frozen=True)
class StatisticCheck(Check):
    """A condition on a statistic of a metric.

    of: the metric, with a condition that nobody judges. sides: what else each value needs, metrics
    as checks and columns by their header, in the order of the arguments. limits: of cp and cpk.
    tolerance: of cg and cgk, of spread_p the stated spread. is_last: of each run the last
    measurement run alone. is_each: over the measurement runs of one run, among its checks.
    """

    of: Check | None = None
    sides: tuple[Check | str, ...] = ()
    limits: tuple[float | None, float | None] | None = None
    tolerance: float | None = None
    is_last: bool = False
    is_each: bool = False

    @property
    def name(self) -> str:
        """The name of the statistic with that of its metric, without axis."""
        return f"{self.statistic.name}({self.metric_check.name})"

    @property
    def statistic(self) -> Statistic:
        """The row of `statistics.csv`."""
        return known_statistics()[self.metric.partition("(")[0].strip()]

    @property
    def metric_check(self) -> Check:
        """The metric that the statistic is of."""
        assert self.of is not None
        return self.of

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns that it needs."""
        return tuple(side for side in self.sides if isinstance(side, str))


def parse_any_check(
    metric: str, condition: str, reference: str, own: Mapping[str, Metric] | None = None
) -> Check:
    """Read a `check:` column whose header is a metric, or a statistic of one.

    own: metrics of the user, by name.
    Raises UserError as `parse_check` does, for an unknown statistic, and for arguments that it
    cannot have.
    """
    match = _CALL.fullmatch(metric.strip())
    if match is None:
        return parse_check(metric, condition, reference, own)
    statistic = known_statistics().get(match["name"])
    if statistic is None:
        close = nearest(match["name"], known_statistics())
        allowed = close or known_statistics()
        raise UserError("unknown statistic", value=match["name"], allowed=allowed, hint=_HINT)
    words = [word.strip() for word in match["arguments"].split(";")]
    over = words.pop() if len(words) > 1 and words[-1] in (LAST, EACH) else ""
    fewest = sum(not kind.startswith("[") for kind in statistic.arguments)
    if not fewest <= len(words) <= len(statistic.arguments) or not all(words):
        raise UserError("not the arguments of the statistic", value=metric, allowed=statistic.form)
    of = _metric(words[0], reference, own)
    check = StatisticCheck(
        metric.strip(), parse_condition(condition, "number"), reference, of.axis, of.block,
        of=of, is_last=over == LAST, is_each=over == EACH,
    )  # fmt: skip
    for kind, word in zip(statistic.arguments[1:], words[1:], strict=False):
        check = _with_argument(check, kind.strip("[]"), word, reference)
    return replace(check, defined=_definition(check))


def _metric(word: str, reference: str, own: Mapping[str, Metric] | None = None) -> Check:
    """Read a metric without a condition. Raises UserError for one that is no number."""
    definition = known_metrics().get(word.partition(":")[0])
    if definition is not None and definition.type not in ("number", "any"):
        raise UserError("a statistic needs a metric that is a number", value=word, hint=_HINT)
    return parse_check(word, "== 0", reference, own)


def _with_argument(check: StatisticCheck, kind: str, word: str, reference: str) -> StatisticCheck:
    """Put one argument after the metric into a check."""
    if kind == "limits":
        condition = parse_condition(word, "number")
        if condition.kind != "range" or condition.lower == condition.upper:
            raise UserError("not limits", value=word, allowed="-0.5 .. 0.5, <= 0.5, >= -0.5")
        return replace(check, limits=(condition.lower, condition.upper))
    if kind in ("tolerance", "spread"):
        tolerance = number(kind, word)
        if tolerance <= 0.0:
            raise UserError(f"the {kind} is not positive", value=word, allowed="a number above 0")
        return replace(check, tolerance=tolerance)
    if kind == "truth":
        truth = _metric(word, reference)
        if truth.unit != check.metric_check.unit:
            raise UserError(
                "the two metrics have different units",
                value=f"{check.metric_check.unit} and {truth.unit}",
            )
        return replace(check, sides=(*check.sides, truth))
    form = find_form(word)
    if word in (RUN, TOUCH) or (form is not None and form.is_input):
        return replace(check, sides=(*check.sides, word))
    if kind == "column" and word.partition(":")[0] in known_metrics():
        return replace(check, sides=(*check.sides, _metric(word, reference)))
    raise UserError(
        "neither an input column nor a metric" if kind == "column" else "not an input column",
        value=word,
        allowed=f"a column of the plan such as plc:V.E.FEED, {RUN}, {TOUCH}",
    )


def _definition(check: StatisticCheck) -> Metric:
    """Make the definition that checks carry, as a row of `metrics.csv` would give it."""
    row, of = check.statistic, check.metric_check
    unit = {
        "metric": of.unit,
        "metric/value": f"{of.unit or 1}/value",
        "metric/column": f"{of.unit or 1}/{_unit_of(check.sides[0]) if check.sides else 1}",
    }.get(row.unit, row.unit)
    needs = of.definition.needs
    return Metric(check.metric, "run", "number", unit, "", needs, "", "", row.meaning, row.source)


def _unit_of(side: Check | str) -> str:
    """Return the unit of a column, its header in brackets where it has none."""
    if isinstance(side, Check):
        return side.unit or f"({side.metric})"
    if side in (RUN, TOUCH):
        return side
    return parse_column(side, "0").unit or f"({side})"
