"""A check as `results.csv` has it: what is written is what is read, and numbers are numbers."""

import pytest

from axisrig.bench.plan.check_row import CheckRow, decimal, finite, known
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.verdict import Verdict


@pytest.mark.parametrize(
    ("metric", "condition", "value", "limits", "number"),
    [
        ("latch_mm:Z", "40 +- 1", 41.5, (39.0, 41.0), 41.5),
        ("lag_mm_max", "<= -0.5", -0.25, (None, -0.5), -0.25),
        ("lag_mm_max", ">= 1", None, (1.0, None), None),
        ("alarms", "none", [50052, 50059], (None, None), None),
        ("detection_criterion", "== lag", "window", (None, None), None),
    ],
)
def test_what_is_judged_is_what_is_read_again(
    metric: str,
    condition: str,
    value: object,
    limits: tuple[float | None, float | None],
    number: float | None,
) -> None:
    result = judge(parse_check(metric, condition, "p.csv:2"), value, 0.25, "why")  # type: ignore[arg-type]
    row = CheckRow.of(result)
    assert CheckRow.read(row.cells) == row
    assert (row.metric, row.asked, row.outcome) == (metric, condition, result.verdict)
    assert (row.limits, row.number, row.note) == (limits, number, "why")
    assert row.reference == "p.csv:2"


def test_a_row_of_another_tool_needs_its_metric_alone() -> None:
    row = CheckRow.read({"metric": " torque ", "plan": "p", "value": " 7 ", "verdict": "fail"})
    assert row == CheckRow("torque", value="7", verdict="fail")
    assert row.outcome is Verdict.FAIL
    assert (row.number, row.limits) == (7.0, (None, None))


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("1.50", (1.5, 1.5, "1.50")),
        ("-2e-3", (-0.002, -0.002, "-0.002")),
        ("inf", (None, float("inf"), "None")),
        ("nan", (None, None, "None")),
        ("", (None, None, "None")),
        ("50052 50059", (None, None, "None")),
    ],
)
def test_a_text_is_the_number_that_it_is(text: str, numbers: tuple[object, ...]) -> None:
    """What is drawn is finite; a comparison knows what has no end; a sentence keeps the digits."""
    assert (finite(text), known(text), str(decimal(text))) == numbers


def test_what_had_to_fail_says_whether_it_did() -> None:
    for note, expected in (
        ("", (False, False)),
        ("was expected to fail", (True, False)),
        ("was expected to fail, and did not; why", (True, True)),
    ):
        row = CheckRow("m", note=note)
        assert (row.had_to_fail, row.has_missed) == expected
