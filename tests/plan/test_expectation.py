"""`expect = fail:<metric>...`."""

from collections.abc import Callable
from itertools import product
from pathlib import Path

import pytest

from axisrig.bench.plan.checks import CheckResult, parse_check
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig,expect,check:latch_mm:Z,check:overtravel_mm"
ROW = "probe.nc,machine.toml"


@pytest.mark.parametrize(
    ("cell", "metrics"),
    [
        ("fail:latch_mm:Z", ("latch_mm:Z",)),
        ("fail:latch_mm:Z overtravel_mm", ("latch_mm:Z", "overtravel_mm")),
        ("fail:overtravel_mm fail:alarms", ("overtravel_mm", "alarms")),
    ],
)
def test_what_may_be_expected(write_plan: PlanWriter, cell: str, metrics: tuple[str, ...]) -> None:
    (case,) = read_plan(write_plan(f"{HEAD}\na,{ROW},{cell},3,4\n")).cases
    assert case.expected == metrics


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("error", "cannot be expected"),
        ("aborted", "cannot be expected"),
        ("fail", "cannot be expected"),
        ("fail:", "no such check"),
        ("fail:latch_mm", "did you mean: latch_mm:Z"),
        ("fail:standstill_mm", "no such check"),
    ],
)
def test_what_may_not(write_plan: PlanWriter, cell: str, words: str) -> None:
    with pytest.raises(UserError, match=words) as caught:
        read_plan(write_plan(f"{HEAD}\na,{ROW},{cell},3,4\n"))
    assert (caught.value.line, caught.value.column) == (2, 4)


def test_exactly_the_expected_checks_must_fail() -> None:
    """Every combination of verdicts of three checks against every expectation of two."""
    metrics = ("latch_mm:Z", "overtravel_mm", "alarms")
    checks = [parse_check(m, c, "") for m, c in zip(metrics, ("3", "4", "none"), strict=True)]
    for verdicts in product(Verdict, repeat=3):
        found = [
            CheckResult(check, None, 0.0, verdict, "why")
            for check, verdict in zip(checks, verdicts, strict=True)
        ]
        run = worst(verdicts)
        assert met((), run, found) == (run, found)
        for expected in (metrics[:1], metrics[:2]):
            verdict, noted = met(expected, run, found)
            others = verdicts[len(expected) :]
            all_failed = all(v is Verdict.FAIL for v in verdicts[: len(expected)])
            if run >= Verdict.ABORTED:
                assert verdict is run
            elif all_failed and Verdict.FAIL not in others:
                assert verdict is worst(others)
            else:
                assert verdict is Verdict.FAIL
            assert [item.verdict for item in noted] == list(verdicts)
            if run < Verdict.ABORTED and not all_failed:
                assert any("and did not" in item.note for item in noted)
