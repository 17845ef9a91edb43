"""`search:<column>` = `300 .. 3000 to 10`: the value of an input at which a row begins to fail.

Both ends are tried first. Where one holds and the other does not, the interval between them is
halved until it is no wider than asked for. Each value is tried by a run of its own, a probe; the
other checks of the row say whether it holds. The row itself has the metrics `search_good` and
`search_bad`, the two values between which the limit is.
"""

import re
from collections.abc import Generator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.checks import Check, Metric, parse_condition
from axisrig.bench.plan.statistic_checks import parse_any_check
from axisrig.bench.plan.table import Cell
from axisrig.kernel.errors import UserError

HEAD = "search:"
PROBES_MAX = 40
GOOD, BAD = "search_good", "search_bad"
"""Metrics of a row that searches: the value nearest to the limit that holds, that does not."""

_NUMBER = r"[+-]?\d+(?:\.\d*)?|[+-]?\.\d+"
_FORM = re.compile(rf"({_NUMBER})\s*\.\.\s*({_NUMBER})\s+to\s+({_NUMBER})")
_EXAMPLE = "300 .. 3000 to 10"
_DIGITS_MAX = 12
_MEANING = {
    GOOD: "value of the searched column that holds, nearest to the limit",
    BAD: "value of the searched column that does not hold, nearest to the limit",
}


@dataclass(frozen=True)
class Search:
    """What a row searches.

    column: input column. text: the cell. first, last, width: in steps of the last decimal that the
    cell has, `step`. checks: what each probe has to fulfil.
    """

    column: str
    text: str
    first: int
    last: int
    width: int
    step: Decimal
    checks: tuple[Check, ...] = ()

    def value(self, steps: int) -> str:
        """Write a value as a cell would hold it."""
        return f"{steps * self.step:f}"

    @property
    def probes_max(self) -> int:
        """How many probes it can take at most."""
        count, wide = 2, abs(self.last - self.first)
        while wide > self.width:
            count, wide = count + 1, wide - wide // 2
        return count


@dataclass(frozen=True)
class Bracket:
    """What a search has found: two values as cells; None where both ends hold, or neither."""

    good: str | None
    bad: str | None
    reason: str = ""


def parse_search(column: str, cell: Cell, others: Mapping[str, object]) -> Search:
    """Read a cell of a column `search:...`.

    others: the columns of the row. Raises UserError with the place of the cell for a column that
    is no input or that the row sets as well, and for a text that is no search.
    """
    searched = column.removeprefix(HEAD)
    try:
        parse_column(searched, "0")
    except UserError as error:
        raise cell.place.error_from(error) from None
    if searched in others:
        raise cell.place.error(f"the row sets {searched}, and searches it", value=cell.text)
    match = _FORM.fullmatch(cell.text)
    if match is None:
        raise cell.place.error("the search cannot be read", value=cell.text, allowed=_EXAMPLE)
    numbers = [Decimal(text) for text in match.groups()]
    decimals = max(0, *(-int(number.as_tuple().exponent) for number in numbers))
    step = Decimal(1).scaleb(-decimals)
    first, last, width = (int(number / step) for number in numbers)
    if max(len(str(abs(number))) for number in (first, last)) > _DIGITS_MAX:
        raise cell.place.error(f"more than {_DIGITS_MAX} digits", value=cell.text)
    if first == last or width <= 0 or width >= abs(last - first):
        raise cell.place.error(
            "the width is above 0 and less than the range", value=cell.text, allowed=_EXAMPLE
        )
    search = Search(searched, cell.text, first, last, width, step)
    if search.probes_max > PROBES_MAX:
        raise cell.place.error(
            f"the search takes {search.probes_max} runs, more than {PROBES_MAX}",
            value=cell.text,
            hint="make the range smaller or the width larger",
        )
    return search


def parse_row_check(
    metric: str,
    condition: str,
    reference: str,
    own: Mapping[str, Metric] | None,
    *,
    is_searching: bool,
) -> Check:
    """Read a `check:` column of a row: of a metric, a statistic, or of what the row searches.

    Raises UserError as `parse_any_check` does, and for `search_good` in a row without a search.
    """
    if metric not in (GOOD, BAD):
        return parse_any_check(metric, condition, reference, own)
    if not is_searching:
        raise UserError(
            "the row searches nothing", value=metric, hint=f"it needs a column {HEAD}<column>"
        )
    return check_of_search(metric, condition, reference)


def check_of_search(metric: str, condition: str, reference: str) -> Check:
    """Read a check of `search_good` or `search_bad`. Raises UserError for a bad condition."""
    defined = Metric(metric, "run", "number", "", "", "", "", "", _MEANING[metric], "bisection")
    return Check(metric, parse_condition(condition, "number"), reference, defined=defined)


def bisect(search: Search) -> Generator[str, bool, Bracket]:
    """Yield the values to try, as cells; send whether each holds."""
    holds_first = yield search.value(search.first)
    holds_last = yield search.value(search.last)
    if holds_first == holds_last:
        what = "both ends of the search hold" if holds_first else "neither end of the search holds"
        return Bracket(None, None, f"{what}: {search.column} = {search.text}")
    good, bad = (search.first, search.last)[:: 1 if holds_first else -1]
    while abs(good - bad) > search.width:
        middle = (good + bad) // 2
        if (yield search.value(middle)):
            good = middle
        else:
            bad = middle
    return Bracket(search.value(good), search.value(bad))
