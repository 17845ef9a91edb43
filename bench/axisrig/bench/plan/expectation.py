"""`expect = fail:<metric>...`: checks that must fail, for a row that shows that a limit is felt."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from axisrig.bench.plan.checks import Check, CheckResult
from axisrig.bench.plan.table import Cell
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.kernel.errors import nearest

_FORM = "fail:<metric>, several separated by blanks"
_HEAD = "fail:"
_WORD = re.compile(r"(?:[^\s,;(]|\([^()]*\)?)+")
EXPECTED = "was expected to fail"
NOT_MET = "was expected to fail, and did not"


def parse_expectation(cell: Cell, checks: Iterable[Check]) -> tuple[str, ...]:
    """Return the metrics that must fail.

    checks: of the row. Raises UserError for another form, and for a metric without a check.
    """
    words = _WORD.findall(cell.text) or [""]
    if not words[0].startswith(_HEAD):
        raise cell.place.error(
            "this cannot be expected",
            value=cell.text,
            allowed=_FORM,
            hint="error and aborted say nothing about the thing under test",
        )
    metrics = tuple(dict.fromkeys(word.removeprefix(_HEAD) for word in words))
    known = [check.metric for check in checks]
    for metric in metrics:
        if metric not in known:
            raise cell.place.error(
                "the row has no such check",
                value=metric or cell.text,
                allowed=nearest(metric, known) or known,
            )
    return metrics


def met(
    expected: Sequence[str], verdict: Verdict, checks: Sequence[CheckResult]
) -> tuple[Verdict, list[CheckResult]]:
    """Judge a run by what was expected of it: the verdict, and the checks with their notes.

    expected: metrics that must fail, exactly these. A run that met it has the verdict of its other
    checks; one that did not, fails. `error` and `aborted` stay.
    """
    if not expected or verdict >= Verdict.ABORTED:
        return verdict, list(checks)
    failed = {item.check.metric for item in checks if item.verdict is Verdict.FAIL}
    noted = [_noted(item, item.check.metric in expected) for item in checks]
    if failed != set(expected):
        return Verdict.FAIL, noted
    others = [item.verdict for item in checks if item.check.metric not in expected]
    return worst([Verdict.PASS, *others]), noted


def _noted(item: CheckResult, is_expected: bool) -> CheckResult:
    if not is_expected:
        return item
    note = EXPECTED if item.verdict is Verdict.FAIL else NOT_MET
    return replace(item, note=f"{note}; {item.note}" if item.note else note)
