"""A row of `results.csv`."""

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult, value_text


def check_row(case: Case, item: CheckResult) -> list[str]:
    """Return the cells of a check, as `RESULT_COLUMNS` and `NOTE` name them."""
    condition = item.check.condition
    return [
        case.plan,
        case.case,
        case.run,
        condition.text,
        item.check.metric,
        value_text(item.value),
        item.check.unit,
        value_text(condition.lower),
        value_text(condition.upper),
        repr(float(item.uncertainty)),
        item.verdict.word,
        item.check.reference,
        item.note,
    ]
