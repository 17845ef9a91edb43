"""Which rows of a large plan have their machine built before the first run."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.preparing import WHOLE_MAX, built_first
from axisrig.bench.plan.plan import read_plan

PLAN = Path(__file__).parents[2] / "testplans" / "distance_3d.csv"


@pytest.mark.long
def test_of_a_large_plan_with_metrics_of_its_own_the_first_row_of_each_kind() -> None:
    cases = read_plan(PLAN).cases
    assert len(cases) > WHOLE_MAX
    assert any(case.module is not None for case in cases)
    first = built_first(cases)
    assert first[0] == 0
    assert 1 < len(first) <= WHOLE_MAX
