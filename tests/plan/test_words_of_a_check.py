"""One sentence for each way in which a check or a run can end, on both sides of its limits."""

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.sentences import check_sentence, run_sentence, short_number
from axisrig.bench.plan.verdict import Verdict


def sentence(cells: Mapping[str, str]) -> str:
    return check_sentence(CheckRow.read(cells))


def sentence_of_run(verdict: Verdict, error: str | None, rows: Sequence[Mapping[str, str]]) -> str:
    return run_sentence(verdict, error, [CheckRow.read(cells) for cells in rows])


def said(metric: str = "latch_mm", **cells: str) -> str:
    return sentence({"metric": metric, "unit": "mm", **cells})


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        # An only value, on either side of it
        ({"value": "3.5", "lower": "3", "upper": "3", "verdict": "fail"},
         "latch_mm is 0.5 mm above 3 mm, the only value allowed"),
        ({"value": "2.5", "lower": "3", "upper": "3", "verdict": "fail"},
         "latch_mm is 0.5 mm below 3 mm, the only value allowed"),
        # The nearest of two limits, on either side of it
        ({"value": "2", "lower": "1", "upper": "9", "verdict": "marginal", "uncertainty": "0.6"},
         "latch_mm is 1 mm above its lower limit 1 mm, less than twice its uncertainty of 0.6 mm"),
        ({"value": "8", "lower": "1", "upper": "9", "verdict": "inconclusive", "uncertainty": "2"},
         "latch_mm is 1 mm below its upper limit 9 mm, within its uncertainty of 2 mm"),
        ({"value": "0", "lower": "1", "upper": "9", "verdict": "fail"},
         "latch_mm is 1 mm below its lower limit 1 mm"),
        ({"value": "9.25", "lower": "1", "upper": "9", "verdict": "fail"},
         "latch_mm is 0.25 mm above its upper limit 9 mm"),
        ({"value": "9", "upper": "9", "verdict": "fail"},
         "latch_mm is on its upper limit 9 mm, which is outside"),
        ({"value": "1", "lower": "1", "verdict": "inconclusive"},
         "latch_mm is on its lower limit 1 mm, and its uncertainty is unknown"),
        ({"value": "5", "lower": "1", "upper": "9", "verdict": "pass"},
         "latch_mm is 5 mm, inside its limits"),
        # Written as they are up to nine signs, else with seven digits
        ({"value": "1.2345678", "upper": "9", "verdict": "pass"},
         "latch_mm is 1.2345678 mm, inside its limits"),
        ({"value": "1.23456789", "upper": "9", "verdict": "pass"},
         "latch_mm is 1.234568 mm, inside its limits"),
        # Without limits
        ({"value": "3", "check": "!= 3", "verdict": "fail"}, "latch_mm is 3 mm, which is excluded"),
        ({"value": "3.05", "check": "!= 3", "verdict": "inconclusive", "uncertainty": "0.1"},
         "latch_mm is 3.05 mm, too near to 3, which is excluded, within its uncertainty of"
         " 0.1 mm"),
        ({"value": "4", "check": "!= 3", "verdict": "pass"}, "latch_mm is 4 mm, as asked for"),
        ({"value": "FREE", "check": "<= 3", "verdict": "fail"},
         "latch_mm is FREE, which is no number: asked for <= 3"),
        ({"value": "4", "check": "about 3", "verdict": "fail"},
         "latch_mm is 4 mm, asked for about 3"),
        ({"value": "4", "verdict": "fail"}, "latch_mm is 4 mm"),
        ({"value": "nan", "upper": "3", "check": "<= 3", "verdict": "fail"},
         "latch_mm is nan, which is no number: asked for <= 3"),
        # Without a value
        ({"verdict": "fail", "note": "met nothing"}, "latch_mm has no value: met nothing"),
        ({"verdict": "error"}, "latch_mm could not be judged"),
        ({"verdict": "inconclusive"}, "latch_mm is not available here"),
        ({"verdict": "aborted"}, "latch_mm was not reached"),
    ],
)  # fmt: skip
def test_a_check_has_its_sentence(cells: dict[str, str], words: str) -> None:
    assert said(**cells) == words


@pytest.mark.parametrize(
    ("value", "check", "words"),
    [
        ("", "none", "no alarm came up"),
        ("50059", "none", "alarm 50059 came up, none was expected"),
        ("50059 50052", "none", "alarms 50059 and 50052 came up, none was expected"),
        ("50059 50052 50055", "none", "alarms 50059, 50052 and 50055 came up, none was expected"),
        ("", "50059", "alarm 50059 did not come up, nor any other"),
        ("50052", "50059", "alarm 50059 did not come up; alarm 50052 came up, not expected"),
        ("50059 50059", "50059", "alarm 50059 came up, not expected"),
        ("50052 50059", "50059 50052",
         "alarms 50052 and 50059 came up in another order than 50059 50052"),
        ("50059", "!= 50059", "alarm 50059 came up, which is excluded"),
        ("50059", "contains 50052", "alarm 50052 did not come up"),
        ("50059 50055 50055", "one of 50059 50052",
         "alarms 50055 and 50055 came up, expected was 50059 or 50052"),
        ("", "one of 50059 50052", "no alarm came up, expected was 50059 or 50052"),
        # Each that is allowed may come any number of times, by either ID of its family
        ("50059 50059 50055", "one of 50059 50052",
         "alarm 50055 came up, expected was 50059 or 50052"),
        ("50055 50059 50052 50059 50052", "one of 50059 50052",
         "alarm 50055 came up, expected was 50059 or 50052"),
        ("70331 310017 70331 50055", "one of 310017 50052",
         "alarm 50055 came up, expected was 310017 or 50052"),
        ("50059 50059 50055", "one of none 50059",
         "alarm 50055 came up, expected was none or 50059"),
        # Where each is asked for as often as it is written, every one more is too many
        ("50059 50059 50055", "50059", "alarms 50059 and 50055 came up, not expected"),
        ("70331 310017", "310017", "alarm 310017 came up, not expected"),
        ("50059 50059", "50059 50059 50059", "alarm 50059 did not come up"),
        ("50059 50055", "contains 50059 50059", "alarm 50059 did not come up"),
        ("70331 50055", "contains 310017 50052", "alarm 50052 did not come up"),
        ("50059", "about", "alarm 50059 came up"),
    ],
)  # fmt: skip
def test_alarms_have_their_sentence(value: str, check: str, words: str) -> None:
    verdict = "pass" if words == "no alarm came up" else "fail"
    row = {"metric": "alarms", "value": value, "check": check, "verdict": verdict}
    assert sentence(row) == words
    further = sentence({**row, "metric": "further_alarms"})
    assert further == f"further_alarms: {words}"


def test_a_word_against_a_word() -> None:
    row = {"metric": "detection_criterion", "value": "lag", "check": "== window"}
    assert sentence({**row, "verdict": "fail"}) == "detection_criterion is lag, not window"
    row["check"] = "!= lag"
    assert sentence({**row, "verdict": "fail"}) == ("detection_criterion is lag, which is excluded")
    row["verdict"] = "inconclusive"  # a word is what it is
    assert sentence(row) == "detection_criterion is lag, which is excluded"


def row(metric: str, verdict: str, note: str = "", value: str = "5") -> dict[str, str]:
    return {"metric": metric, "value": value, "upper": "3", "unit": "mm", "verdict": verdict,
            "note": note, "check": "<= 3", "uncertainty": "0"}  # fmt: skip


BAD = "latch_mm is 2 mm above its upper limit 3 mm"
EXPECTED, NOT_MET = "was expected to fail", "was expected to fail, and did not"


@pytest.mark.parametrize(
    ("verdict", "error", "checks", "words"),
    [
        (Verdict.FAIL, None, [row("contact_mm", "pass"), row("latch_mm", "fail")], BAD),
        (Verdict.FAIL, None, [row("latch_mm", "fail")] * 2, f"{BAD}, and 1 more check"),
        (Verdict.FAIL, None, [row("latch_mm", "fail")] * 3, f"{BAD}, and 2 more checks"),
        (Verdict.FAIL, None, [row("contact_mm", "pass")], "no check is fail"),
        (Verdict.FAIL, None, [], "no check"),
        (Verdict.ERROR, "it broke", [], "no verdict: it broke"),
        (Verdict.ABORTED, "stopped", [], "stopped"),
        (Verdict.ERROR, "it broke", [row("latch_mm", "error", value="")], "no verdict: it broke"),
        (Verdict.ABORTED, "stopped", [row("contact_mm", "pass")], "stopped"),
        # What had to fail and did not, beside what failed as expected
        (Verdict.FAIL, None,
         [row("contact_mm", "fail", EXPECTED), row("latch_mm", "pass", NOT_MET)],
         f"latch_mm {NOT_MET}"),
        (Verdict.FAIL, None, [row("latch_mm", "fail"), row("contact_mm", "pass", NOT_MET)],
         BAD),
        (Verdict.FAIL, None, [row("contact_mm", "pass", f"{NOT_MET}; why")],
         f"contact_mm {NOT_MET}"),
        (Verdict.MARGINAL, None, [row("latch_mm", "marginal"), row("contact_mm", "pass", NOT_MET)],
         f"{BAD}, less than twice its uncertainty of 0 mm"),
    ],
)  # fmt: skip
def test_a_run_is_said_by_what_gave_it_its_verdict(
    verdict: Verdict, error: str | None, checks: list[dict[str, str]], words: str
) -> None:
    assert sentence_of_run(verdict, error, checks) == words


@pytest.mark.parametrize(
    ("number", "digits", "text"),
    [
        (1234567.0, 3, "1230000"), (-1234567.0, 3, "-1230000"), (9.99e14, 3, "999000000000000"),
        (1e15, 3, "1e+15"), (-1e15, 3, "-1e+15"), (1e-7, 3, "0.0000001"), (9e-8, 3, "9e-08"),
        (0.5, 3, "0.5"), (0.0, 3, "0"), (-1e-5, 3, "-0.00001"),
    ],
)  # fmt: skip
def test_a_number_has_no_exponent_where_it_stays_short(
    number: float, digits: int, text: str
) -> None:
    assert short_number(number, digits) == text


def test_a_metric_that_the_table_does_not_have_is_taken_as_it_is() -> None:
    cells: dict[str, Any] = {"value": "TRUE", "check": "== FALSE", "verdict": "fail", "unit": ""}
    assert said("of_another_tool", **cells) == "of_another_tool is TRUE, not FALSE"
