"""Results come as runs end; a campaign lists them in the order of its plans."""

import random
from collections import Counter
from functools import partial
from pathlib import Path

from axisrig.bench.campaign.campaign import _place
from axisrig.bench.campaign.results.writer import no_values
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

TESTPLANS = Path(__file__).parents[2] / "testplans"


def test_results_are_listed_in_plan_order_each_statistic_after_its_runs() -> None:
    plan = read_plan(TESTPLANS / "statistics.csv")
    assert plan.statistics
    expected, left = [], {row.run: Counter(row.runs) for row in plan.statistics}
    for case in plan.cases:  # as one process gives them
        expected.append(case.run)
        for row in plan.statistics:
            left[row.run] -= Counter([case.run])
            if case.run in row.runs and not left[row.run]:
                expected.append(row.run)
    rows = [*plan.cases, *plan.statistics]
    results = [no_values(row, Verdict.ERROR, "not run") for row in rows]
    random.Random(1).shuffle(results)
    results.sort(key=partial(_place, {case.run: at for at, case in enumerate(plan.cases)}))
    assert [result.case.run for result in results] == expected
