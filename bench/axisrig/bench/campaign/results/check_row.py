"""A row of `results.csv`."""

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult
from axisrig.bench.plan.sentences import result_cells


def check_row(case: Case, item: CheckResult) -> dict[str, str]:
    """Return the cells of a check by the names of `RESULT_COLUMNS` and `NOTE`."""
    own = {"plan": case.plan, "case": case.case, "run": case.run}
    return own | result_cells(item) | {"reference": item.check.reference}
