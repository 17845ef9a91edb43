"""The verdict of a run from its checks, and from whether the operator has stopped it."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import STOPPED, of_facts
from axisrig.bench.judge.topics import judged
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord

MS = 1_000_000
PASS, FAIL = ("duration_s", "0.004 .. 0.006"), ("duration_s", "<= 0.004")
UNRECORDED = ("velocity_mm_s_max:Z", "<= 1")  # its signal was not recorded


@pytest.mark.parametrize(
    ("checks", "alone", "stopped"),
    [
        ([PASS], Verdict.PASS, Verdict.ABORTED),
        ([PASS, FAIL], Verdict.FAIL, Verdict.ABORTED),
        ([FAIL, PASS], Verdict.FAIL, Verdict.ABORTED),
        ([PASS, UNRECORDED], Verdict.ERROR, Verdict.ERROR),
        ([UNRECORDED, FAIL], Verdict.ERROR, Verdict.ERROR),
    ],
)
def test_a_stopped_run_is_aborted_whatever_its_checks_say_unless_one_is_in_error(
    checks: Sequence[tuple[str, str]], alone: Verdict, stopped: Verdict
) -> None:
    series = kept(pa.table({"time_ns": np.arange(6) * MS}))
    axes = {"Z": AxisRecord("can1", 1, 10_000.0)}
    asked = [parse_check(name, condition, "here") for name, condition in checks]
    for is_stopped, verdict in ((False, alone), (True, stopped)):
        found, results = judged(Observed(facts(is_stopped=is_stopped, axes=axes), series), asked)
        assert found is verdict
        assert len(results) == len(checks)


def test_a_run_that_was_stopped_is_called_so_whatever_it_left_undone() -> None:
    for of, words in (
        ({}, None),
        ({"unfinished": "a plant fell"}, "a plant fell"),
        ({"is_stopped": True}, STOPPED),
        ({"is_stopped": True, "unfinished": "a plant fell"}, STOPPED),
    ):
        assert of_facts(facts(**of)).error == words  # type: ignore[arg-type]
