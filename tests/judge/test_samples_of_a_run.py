"""What a run gives to statistics of its case where some of its signals were not recorded."""

from itertools import permutations

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import judged, sampled
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord
from axisrig.kernel.time.clock import MS

RUN = Observed(
    facts(axes={"Z": AxisRecord("can1", 1, 10_000.0)}),
    kept(pa.table({"time_ns": np.arange(6) * MS})),
)
KNOWN, UNRECORDED, OTHER = (
    "mean(duration_s)", "mean(velocity_mm_s_max:Z)", "spread(duration_s)",
)  # fmt: skip


def asked(metric: str) -> StatisticCheck:
    check = parse_any_check(metric, "-1 .. 1", "here")
    assert isinstance(check, StatisticCheck)
    return check


@pytest.mark.parametrize("names", list(permutations((KNOWN, UNRECORDED, OTHER))))
def test_a_signal_that_was_not_recorded_costs_its_own_statistic_alone(
    names: tuple[str, ...],
) -> None:
    found = sampled(RUN, [asked(name) for name in names])
    assert list(found) == [name for name in names if name != UNRECORDED]
    for readings in found.values():
        assert [each.metric.value for each in readings] == [pytest.approx(0.005)]


def test_a_check_whose_signal_was_not_recorded_is_in_error_with_the_name_of_the_signal() -> None:
    checks = [
        parse_any_check(*of, "here")
        for of in (("duration_s", "<= 1"), ("velocity_mm_s_max:Z", "<= 1"), ("duration_s", "> 1"))
    ]
    verdict, results = judged(RUN, checks)
    assert verdict is Verdict.ERROR
    assert [one.verdict for one in results] == [Verdict.PASS, Verdict.ERROR, Verdict.FAIL]
    assert "Z." in results[1].note
