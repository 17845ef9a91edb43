"""What became of a check in one sentence: each expectation is reckoned by hand from its row."""

from collections.abc import Mapping, Sequence

import pytest

from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.checks import judge, parse_check, value_text
from axisrig.bench.plan.sentences import alike_sentence, check_sentence, run_sentence, short_number
from axisrig.bench.plan.verdict import Verdict


def sentence(cells: Mapping[str, str]) -> str:
    return check_sentence(CheckRow.read(cells))


def sentence_of_run(verdict: Verdict, error: str | None, rows: Sequence[Mapping[str, str]]) -> str:
    return run_sentence(verdict, error, [CheckRow.read(cells) for cells in rows])


def row(
    metric: str, condition: str, value: object, u: float = 0.0, note: str = ""
) -> dict[str, str]:
    """A row as the bench writes it: the verdict is that of the bench, not of this test."""
    check = parse_check(metric, condition, "a.csv:2")
    result = judge(check, value, u, note)  # type: ignore[arg-type]
    limits = {"lower": check.condition.lower, "upper": check.condition.upper}
    return {
        "metric": metric,
        "check": condition,
        "value": value_text(result.value),
        "unit": check.unit,
        **{side: "" if limit is None else repr(limit) for side, limit in limits.items()},
        "uncertainty": repr(u),
        "verdict": result.verdict.word,
        "note": note,
    }


@pytest.mark.parametrize(
    ("metric", "condition", "value", "u", "verdict", "said"),
    [
        ("latch_error_um", ">= 1.0", 0.9814, 0.0, "fail",
         "latch_error_um is 0.0186 um below its lower limit 1.0 um"),
        ("latch_error_um:Z", "-0.2 .. 0.2", 0.31, 0.03, "fail",
         "latch_error_um:Z is 0.11 um above its upper limit 0.2 um"),
        ("latch_error_um", "-0.0400 +- 0.0095", -0.2384185791015625, 0.0, "fail",
         "latch_error_um is 0.189 um below its lower limit -0.0495 um"),
        ("lag_mm_max", "< 0.5", 0.5, 0.0, "fail",
         "lag_mm_max is on its upper limit 0.5 mm, which is outside"),
        ("lag_mm_max", "<= 0.5", 0.502, 0.005, "inconclusive",
         "lag_mm_max is 0.002 mm above its upper limit 0.5 mm, within its uncertainty of 0.005 mm"),
        ("lag_mm_max", "<= 0.5", 0.498, 0.005, "inconclusive",
         "lag_mm_max is 0.002 mm below its upper limit 0.5 mm, within its uncertainty of 0.005 mm"),
        ("lag_mm_max", "<= 0.5", 0.5, 0.005, "inconclusive",
         "lag_mm_max is on its upper limit 0.5 mm, within its uncertainty of 0.005 mm"),
        ("lag_mm_max", "<= 0.5", 0.4, float("inf"), "inconclusive",
         "lag_mm_max is 0.1 mm below its upper limit 0.5 mm, and its uncertainty is unknown"),
        ("lag_mm_max", "0.1 .. 0.5", 0.107, 0.004, "marginal",
         "lag_mm_max is 0.007 mm above its lower limit 0.1 mm, less than twice its uncertainty"
         " of 0.004 mm"),
        ("lag_mm_max", "<= 0.5", 0.25, 0.0, "pass", "lag_mm_max is 0.25 mm, inside its limits"),
        ("found_without_contact", "== 0", 1.0, 0.0, "fail",
         "found_without_contact is 1 above 0.0, the only value allowed"),
        ("latch_mm:Z", "== 40", 39.5, 0.0, "fail",
         "latch_mm:Z is 0.5 mm below 40.0 mm, the only value allowed"),
        ("latch_mm:Z", "== 40", 39.5, 0.6, "inconclusive",
         "latch_mm:Z is 0.5 mm below its lower limit 40.0 mm, within its uncertainty of 0.6 mm"),
        ("latch_mm:Z", "!= 40", 40.0, 0.0, "fail", "latch_mm:Z is 40.0 mm, which is excluded"),
        ("latch_mm:Z", "!= 40", 40.001, 0.01, "inconclusive",
         "latch_mm:Z is 40.001 mm, too near to 40, which is excluded, within its"
         " uncertainty of 0.01 mm"),
        ("msg:N30", "== TRUE", "FALSE", 0.0, "fail", "msg:N30 is FALSE, not TRUE"),
        ("msg:N30", "!= TRUE", "TRUE", 0.0, "fail", "msg:N30 is TRUE, which is excluded"),
        ("msg:N30", "<= 5", "late", 0.0, "fail",
         "msg:N30 is late, which is no number: asked for <= 5"),
        ("distance_state_end", "ACTIVE", "ERROR", 0.0, "fail",
         "distance_state_end is ERROR, not ACTIVE"),
        ("distance_state_end", "ACTIVE", "ACTIVE", 0.0, "pass",
         "distance_state_end is ACTIVE, as asked for"),
        ("alarms", "none", [50052], 0.0, "fail", "alarm 50052 came up, none was expected"),
        ("alarms", "none", [50052, 70332], 0.0, "fail",
         "alarms 50052 and 70332 came up, none was expected"),
        ("alarms", "50059", [], 0.0, "fail", "alarm 50059 did not come up, nor any other"),
        ("alarms", "50059", [50052], 0.0, "fail",
         "alarm 50059 did not come up; alarm 50052 came up, not expected"),
        ("alarms", "50059 50052", [50052, 50059], 0.0, "fail",
         "alarms 50052 and 50059 came up in another order than 50059 50052"),
        ("alarms", "50059 50059", [50059], 0.0, "fail", "alarm 50059 did not come up"),
        ("alarms", "!= none", [], 0.0, "fail", "no alarm came up, which is excluded"),
        ("alarms", "!= 50059", [50059], 0.0, "fail", "alarm 50059 came up, which is excluded"),
        ("alarms", "contains 50052", [70332], 0.0, "fail", "alarm 50052 did not come up"),
        ("alarms", "one of 50052 70332", [50059, 70332], 0.0, "fail",
         "alarm 50059 came up, expected was 50052 or 70332"),
        ("alarms", "one of 50052 70332", [], 0.0, "fail",
         "no alarm came up, expected was 50052 or 70332"),
        ("alarms", "none", [], 0.0, "pass", "no alarm came up"),
        ("further_alarms", "none", [50052], 0.0, "fail",
         "further_alarms: alarm 50052 came up, none was expected"),
        # Twins name one cause: 310017 is the newer number of 70331 (errors.csv)
        ("alarms", "310017 50052", [70331], 0.0, "fail", "alarm 50052 did not come up"),
    ],
)  # fmt: skip
def test_a_check_says_what_it_found(
    metric: str, condition: str, value: object, u: float, verdict: str, said: str
) -> None:
    found = row(metric, condition, value, u)
    assert found["verdict"] == verdict
    assert sentence(found) == said


@pytest.mark.parametrize(
    ("verdict", "said"),
    [
        ("fail", "latch_mm has no value: the probe was actuated"),
        ("error", "latch_mm could not be judged: the probe was actuated"),
        ("inconclusive", "latch_mm is not available here: the probe was actuated"),
        ("aborted", "latch_mm was not reached: the probe was actuated"),
    ],
)
def test_a_missing_value_says_why(verdict: str, said: str) -> None:
    found = row("latch_mm", "40 +- 1", None, note="the probe was actuated") | {"verdict": verdict}
    assert sentence(found) == said
    assert sentence(found | {"note": ""}) == said.partition(":")[0]


def test_alarms_that_could_not_be_judged_are_not_called_none() -> None:
    found = row("alarms", "none", []) | {"verdict": "error", "note": "the bench ended"}
    assert sentence(found) == "alarms could not be judged: the bench ended"


def test_rows_of_another_tool_need_the_metric_alone() -> None:
    assert sentence({"metric": "torque"}) == "torque has no value"
    assert sentence({"metric": "torque", "value": "7", "verdict": "fail"}) == "torque is 7"
    own = {"metric": "torque", "value": "7", "check": "soft", "verdict": "fail"}
    assert sentence(own) == "torque is 7, not soft"
    limited = {"metric": "torque", "value": "7", "upper": "5", "unit": "N.m", "verdict": "fail"}
    assert sentence(limited) == "torque is 2 N.m above its upper limit 5 N.m"


def test_a_run_is_told_by_its_first_worst_check() -> None:
    good = row("lag_mm_max", "<= 0.5", 0.25)
    bad = row("latch_error_um", ">= 1.0", 0.9814)
    late = row("alarms", "none", [50052])
    first = "latch_error_um is 0.0186 um below its lower limit 1.0 um"
    assert sentence_of_run(Verdict.FAIL, None, [good, bad]) == first
    assert sentence_of_run(Verdict.FAIL, None, [good, bad, late]) == f"{first}, and 1 more check"
    assert sentence_of_run(Verdict.FAIL, None, [bad, late, late]) == f"{first}, and 2 more checks"


def test_a_run_that_was_not_judged_is_told_by_its_error() -> None:
    empty = [{"metric": "lag_mm_max", "value": "", "verdict": "error"}]
    assert sentence_of_run(Verdict.ERROR, "FMU failed", empty) == "no verdict: FMU failed"
    assert sentence_of_run(Verdict.ABORTED, "stopped with Ctrl-C", empty) == "stopped with Ctrl-C"
    assert sentence_of_run(Verdict.FAIL, None, []) == "no check"
    good = [row("lag_mm_max", "<= 0.5", 0.25)]
    assert (
        sentence_of_run(Verdict.ABORTED, "stopped by the operator", good)
        == "stopped by the operator"
    )


def test_numbers_stay_short_and_plain() -> None:
    assert [short_number(x, 3) for x in (0.0186, 1e-6, 4.44e-13, 123456.0, 0.0)] == [
        "0.0186", "0.000001", "4.44e-13", "123000", "0",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("condition", "values", "u", "said"),
    [
        (">= 1.0", (0.9, 0.7), 0.0, "latch_error_um is below its lower limit 1.0 um"),
        ("<= 1.0", (1.2, 1.7), 0.0, "latch_error_um is above its upper limit 1.0 um"),
        ("-1 .. 1", (-1.5, -9.0), 0.0, "latch_error_um is below its lower limit -1.0 um"),
        ("-1 .. 1", (1.5, 9.0), 0.0, "latch_error_um is above its upper limit 1.0 um"),
        ("<= 1.0", (1.01, 0.99), 0.1,
         "latch_error_um is within its uncertainty of its upper limit 1.0 um"),
        (">= 1.0", (1.01, 0.99), 0.1,
         "latch_error_um is within its uncertainty of its lower limit 1.0 um"),
    ],
)  # fmt: skip
def test_runs_that_fail_alike_have_a_sentence_without_their_values(
    condition: str, values: tuple[float, ...], u: float, said: str
) -> None:
    rows = [CheckRow.read(row("latch_error_um", condition, value, u)) for value in values]
    assert alike_sentence(rows) == said
    assert alike_sentence(rows[::-1]) == said


def test_runs_with_limits_of_their_own_fail_alike_at_none_that_has_a_number() -> None:
    rows = [CheckRow.read(row("lag_mm_max", f"<= {limit}", 5.0)) for limit in (1.0, 2.0)]
    assert alike_sentence(rows) == "lag_mm_max is above its upper limit"
    rows = [CheckRow.read(row("lag_mm_max", f"<= {limit}", limit, 0.1)) for limit in (1.0, 2.0)]
    assert alike_sentence(rows) == "lag_mm_max is within its uncertainty of its upper limit"


@pytest.mark.parametrize("place", [0, 1])
def test_where_one_of_them_has_no_number_the_first_one_speaks_for_all(place: int) -> None:
    rows = [CheckRow.read(row("lag_mm_max", "<= 1", value)) for value in (5.0, 7.0)]
    lacking = CheckRow.read(row("lag_mm_max", "<= 1", None, note="no trace"))
    rows.insert(place, lacking)
    assert alike_sentence(rows) == check_sentence(rows[0])
    words = [CheckRow.read(row("msg:N30", "== TRUE", "FALSE"))] * 2
    assert alike_sentence(words) == "msg:N30 is FALSE, not TRUE"
