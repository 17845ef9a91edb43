"""Lines of the terminal: each run that did not pass, overloaded buses, counts of verdicts."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.verdict_table import (
    _causes,
    _excess,
    _overload,
    counts_line,
    show_verdicts,
)
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.expectation import NOT_MET
from axisrig.bench.plan.verdict import Verdict


def checked(metric: str, condition: str, value: float | None) -> Any:
    return judge(parse_check(metric, condition, ""), value, 0.0, "")


def result(*checks: Any, verdict: str = "fail", facts: Any = None, **more: Any) -> CaseResult:
    expected = more.pop("expected", ())
    case = case_of("r", expected=expected)
    return CaseResult(case, Verdict.of(verdict), list(checks), facts=facts, **more)


def alarms(*texts: tuple[str, bool]) -> Any:
    return SimpleNamespace(
        alarms=[SimpleNamespace(text=text, is_further=is_further) for text, is_further in texts]
    )


GOOD = checked("lag_mm_max:Z", "<= 1", 0.5)
BAD = checked("latch_error_um:Z", "-1 .. 1", 3.0)


def test_each_check_that_failed_and_each_alarm_has_a_line() -> None:
    """Not what passed, and not what came up while the axes were stopping."""
    found = _causes(result(GOOD, BAD, facts=alarms(("ID 1: a", False), ("ID 2: b", True))))
    assert len(found) == 2
    assert found[0].startswith("fail: latch_error_um:Z ")
    assert found[1] == "ID 1: a"


@pytest.mark.parametrize("verdict", ["pass", "marginal"])
def test_of_a_run_that_passed_nothing_is_reported(verdict: str) -> None:
    assert _causes(result(BAD, verdict=verdict, facts=alarms(("ID 1", False)))) == []


def test_what_had_to_fail_and_did_not_is_a_cause() -> None:
    found = _causes(result(GOOD, BAD, expected=("lag_mm_max:Z", "latch_error_um:Z")))
    (missed,) = [line for line in found if NOT_MET in line]
    assert missed.startswith(f"lag_mm_max:Z {NOT_MET}")


def test_an_error_comes_with_what_was_printed_before_it() -> None:
    """What a run with a recording has printed is in the recording."""
    log = ["one", "two"]
    assert _causes(result(verdict="error", error="broken", log=log)) == ["broken", *log]
    kept = result(BAD, verdict="error", error="broken", log=log, facts=alarms(("ID 1", False)))
    assert _causes(kept) == ["broken"]
    assert _causes(result(BAD, log=log))[1:] == log


@pytest.mark.parametrize(
    ("condition", "value", "by"),
    [("-1 .. 1", 3.0, 2.0), ("-1 .. 1", -4.0, -3.0), ("-1 .. 1", 1.0, 0.0), ("-1 .. 1", -1.0, 0.0),
     ("<= 0", 0.5, 0.5), (">= 0", -0.5, -0.5), (">= 0", 9.0, 0.0), ("<= 1", None, 0.0)],
)  # fmt: skip
def test_how_far_a_value_is_beyond_its_limits(
    condition: str, value: float | None, by: float
) -> None:
    assert _excess(checked("latch_error_um:Z", condition, value)) == by


def test_an_overloaded_segment_says_what_waited_longest() -> None:
    wait = [
        SimpleNamespace(name="Z.TPDO1", worst_us=123.6),
        SimpleNamespace(name="b", worst_us=9.0),
    ]
    bus: Any = SimpleNamespace(segment="can1", overload="8 frames", load_pct=71.25,
                               load_1ms_pct=101.0, waiting=wait)  # fmt: skip
    words = "segment can1 is overloaded: 8 frames; load 71.2 %, worst ms 101.0 %"
    assert _overload(bus) == f"{words}, Z.TPDO1 waited 124 us"
    bus.waiting = []
    assert _overload(bus) == words


@pytest.mark.parametrize(
    ("words", "spent_s", "line"),
    [
        ("fail pass pass error", None, "2 pass, 1 fail, 1 error"),
        ("marginal inconclusive aborted", 3661.0,
         "1 marginal, 1 inconclusive, 1 aborted in 1 h 01 min"),
        ("", None, "nothing ran"),
        ("pass", 61.0, "1 pass in 1 min 01 s"),
        ("", 0.0, "nothing ran in 0 s"),
    ],
)  # fmt: skip
def test_results_are_counted_in_the_order_of_their_rank(
    words: str, spent_s: float | None, line: str
) -> None:
    assert counts_line((Verdict.of(word) for word in words.split()), spent_s) == line


def test_each_overloaded_segment_of_a_run_has_a_line_before_its_causes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def bus(segment: str, overload: str) -> Any:
        return SimpleNamespace(segment=segment, overload=overload, load_pct=50.0,
                               load_1ms_pct=90.0, waiting=[])  # fmt: skip

    facts = SimpleNamespace(buses=[bus("can1", "8 frames"), bus("can2", ""), bus("can3", "x")],
                            alarms=[])  # fmt: skip
    good = SimpleNamespace(buses=[bus("can4", "9 frames")], alarms=[])
    show_verdicts([result(BAD, facts=facts), result(GOOD, verdict="pass", facts=good), result(BAD)])
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("p-r: ")]
    load = "load 50.0 %, worst ms 90.0 %"
    assert lines[:2] == [
        f"p-r: segment can1 is overloaded: 8 frames; {load}",
        f"p-r: segment can3 is overloaded: x; {load}",
    ]
    assert lines[2].startswith("p-r: fail: latch_error_um:Z is ")
    assert lines[3] == f"p-r: segment can4 is overloaded: 9 frames; {load}"
    assert lines[4] == lines[2]


@pytest.mark.parametrize(
    ("value", "u", "verdict"),
    [(0.5, 0.0, Verdict.PASS), (0.8, 0.15, Verdict.MARGINAL), (1.0, 0.15, Verdict.INCONCLUSIVE),
     (3.0, 0.15, Verdict.FAIL), (None, 0.0, Verdict.FAIL)],
)  # fmt: skip
def test_a_check_that_had_to_fail_is_missed_by_every_other_verdict(
    value: float | None, u: float, verdict: Verdict
) -> None:
    """One that is within its uncertainty of the limit has not failed either."""
    check: Any = judge(parse_check("lag_mm_max:Z", "<= 1", ""), value, u, "")
    assert check.verdict is verdict
    found = _causes(result(check, expected=("lag_mm_max:Z",)))
    is_missed = any(line.startswith(f"lag_mm_max:Z {NOT_MET}: ") for line in found)
    assert is_missed is (verdict is not Verdict.FAIL)
