"""Which check speaks for a run, and numbers and alarms in its sentence: computed by hand."""

from collections.abc import Sequence

import pytest

from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.sentences import (
    check_sentence,
    decisive_check,
    reach,
    result_sentence,
    run_sentence,
    short_number,
)
from axisrig.bench.plan.verdict import Verdict, worst

LATCH, LAG, LOST = "latch_error_um", "lag_mm_max", "error_frames"
GOOD = (LAG, "<= 0.5", 0.25, 0.0)
CLOSE = (LAG, "<= 0.5", 0.493, 0.005)  # 0.007 inside: more than one, less than two of 0.005
OPEN = (LAG, "<= 0.5", 0.498, 0.005)
BAD = (LATCH, ">= 1.0", 0.9814, 0.0)
WORSE = (LOST, "<= 0", 7.0, 0.0)
OF_BAD = "latch_error_um is 0.0186 um below its lower limit 1.0 um"


def judged(
    asked: Sequence[tuple[str, str, float, float]], expected: Sequence[str] = ()
) -> tuple[Verdict, list[CheckRow]]:
    """Verdict and checks of a run, as the bench judges it."""
    results = [judge(parse_check(name, text, ""), value, u) for name, text, value, u in asked]
    verdict, noted = met(expected, worst([one.verdict for one in results]), results)
    return verdict, [CheckRow.of(one) for one in noted]


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ([GOOD, CLOSE, BAD], OF_BAD),  # what is only just inside is no further failure
        ([OPEN, BAD], OF_BAD),
        ([BAD, OPEN, WORSE], f"{OF_BAD}, and 1 more check"),
        ([CLOSE, GOOD], "lag_mm_max is 0.007 mm below its upper limit 0.5 mm,"
                        " less than twice its uncertainty of 0.005 mm"),
        ([GOOD], "lag_mm_max is 0.25 mm, inside its limits"),
        ([GOOD, GOOD, GOOD], "lag_mm_max is 0.25 mm, inside its limits, and 2 more checks"),
    ],
)  # fmt: skip
def test_only_checks_of_the_same_verdict_are_further_ones(
    asked: Sequence[tuple[str, str, float, float]], sentence: str
) -> None:
    verdict, rows = judged(asked)
    assert run_sentence(verdict, None, rows) == sentence


@pytest.mark.parametrize(
    ("asked", "expected", "speaks"),
    [
        # All that had to fail did: the others speak
        ([BAD, GOOD], [LATCH], LAG),
        # One that had to fail did not
        ([GOOD, BAD], [LAG, LATCH], LAG),
        ([GOOD], [LAG], LAG),
        ([BAD, GOOD, CLOSE], [LATCH, LAG], LAG),
        # Beside it another one failed that nobody expected
        ([GOOD, BAD], [LAG], LATCH),
        ([BAD, GOOD, WORSE], [LATCH, LAG], LATCH),
    ],
)
def test_a_check_that_had_to_fail_speaks_where_nothing_else_has_failed(
    asked: Sequence[tuple[str, str, float, float]], expected: Sequence[str], speaks: str
) -> None:
    verdict, rows = judged(asked, expected)
    row = decisive_check(verdict, rows)
    assert row is not None
    assert row.metric == speaks


def test_of_several_checks_that_had_to_fail_and_did_not_the_first_one_speaks() -> None:
    passing = (LOST, "<= 0", 0.0, 0.0)
    verdict, rows = judged([passing, GOOD, BAD], [LOST, LAG, LATCH])
    assert verdict is Verdict.FAIL
    assert run_sentence(verdict, None, rows) == f"{LOST} was expected to fail, and did not"
    verdict, rows = judged([GOOD, passing, BAD], [LOST, LAG, LATCH])
    assert run_sentence(verdict, None, rows) == f"{LAG} was expected to fail, and did not"


def test_the_note_of_a_check_that_had_to_fail_is_no_part_of_the_sentence() -> None:
    result = judge(parse_check(LAG, "<= 0.5", ""), 0.25, 0.0, "of 3 axes")
    verdict, (noted,) = met([LAG], Verdict.PASS, [result])
    assert noted.note == "was expected to fail, and did not; of 3 axes"
    row = CheckRow.of(noted)
    assert run_sentence(verdict, None, [row]) == f"{LAG} was expected to fail, and did not"


@pytest.mark.parametrize(
    ("verdict", "words"),
    [
        (Verdict.ERROR, "latch_mm could not be judged: no trace"),
        (Verdict.ABORTED, "the operator stopped it"),
    ],
)
def test_with_values_the_check_that_has_the_verdict_speaks_and_else_the_reason(
    verdict: Verdict, words: str
) -> None:
    """A run that was broken off and has values of what came before."""
    rows = [
        CheckRow(LAG, "<= 0.5", "0.25", "mm", "", "0.5", "0.0", "pass"),
        CheckRow("latch_mm", "<= 3", verdict="error", note="no trace"),
    ]
    assert run_sentence(verdict, "the operator stopped it", rows) == words
    missing = [CheckRow("latch_mm", "<= 3", verdict=verdict.word, note="no trace")]
    begin = "" if verdict is Verdict.ABORTED else "no verdict: "
    assert run_sentence(verdict, "the operator stopped it", missing) == (
        f"{begin}the operator stopped it"
    )


def test_a_run_whose_verdict_no_check_has_says_so() -> None:
    _, rows = judged([GOOD])
    assert run_sentence(Verdict.FAIL, None, rows) == "no check is fail"
    assert run_sentence(Verdict.INCONCLUSIVE, "", rows) == "no check is inconclusive"
    assert run_sentence(Verdict.PASS, None, []) == "no check"


@pytest.mark.parametrize(
    ("value", "lower", "upper", "found"),
    [
        ("3", "0", "10", ("lower", "0", "3")),
        ("7", "0", "10", ("upper", "10", "3")),
        ("5", "0", "10", ("lower", "0", "5")),  # as near to both
        ("-2", "0", "10", ("lower", "0", "-2")),
        ("12.5", "0", "10", ("upper", "10", "-2.5")),
        ("7", "", "10", ("upper", "10", "3")),
        ("7", "1", "", ("lower", "1", "6")),
        ("0.3", "0.1", "", ("lower", "0.1", "0.2")),  # in decimal numbers, not in binary
        ("7", "", "", None),
        ("late", "0", "1", None),
        ("", "0", "1", None),
    ],
)
def test_a_value_is_at_its_nearest_limit(
    value: str, lower: str, upper: str, found: tuple[str, str, str] | None
) -> None:
    known = reach(CheckRow("m", value=value, lower=lower, upper=upper))
    assert (known and (known.side, str(known.limit), str(known.room))) == found


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.25, "0.25 mm"),
        (123.45678, "123.45678 mm"),  # nine signs are short
        (1234.56789, "1234.568 mm"),  # ten are not: seven digits
        (0.123456789, "0.1234568 mm"),
        (-12.3456789, "-12.34568 mm"),
        (98765432.0, "98765430 mm"),
    ],
)
def test_a_value_is_written_as_it_is_where_that_is_short(value: float, shown: str) -> None:
    row = CheckRow.of(judge(parse_check("latch_mm", "-1e9 .. 1e9", ""), value))
    assert check_sentence(row) == f"latch_mm is {shown}, inside its limits"


@pytest.mark.parametrize(
    ("number", "digits", "text"),
    [
        (1e-7, 3, "0.0000001"),
        (9.99e-8, 3, "9.99e-08"),
        (-1.5e-6, 3, "-0.0000015"),
        (123456.0, 7, "123456"),
        (1.25e14, 3, "125000000000000"),
        (1e15, 3, "1e+15"),
        (-2e14, 3, "-200000000000000"),
        (0.00012345, 3, "0.000123"),
    ],
)
def test_an_exponent_comes_where_the_number_would_be_long(
    number: float, digits: int, text: str
) -> None:
    assert short_number(number, digits) == text


@pytest.mark.parametrize(
    ("condition", "found", "sentence"),
    [
        ("one of 50052 70332", [50052, 50052, 50059],
         "alarm 50059 came up, expected was 50052 or 70332"),
        ("none", [50052, 50059, 70332],
         "alarms 50052, 50059 and 70332 came up, none was expected"),
        ("50052 50059 70332", [],
         "alarms 50052, 50059 and 70332 did not come up, nor any other"),
        ("50059", [50059, 50059], "alarm 50059 came up, not expected"),  # the second time
        ("50052 50059", [50059, 70332],
         "alarm 50052 did not come up; alarm 70332 came up, not expected"),
        ("contains 50052 50059", [50059, 70332], "alarm 50052 did not come up"),
        ("!= 50059 50052", [50059, 50052], "alarms 50059 and 50052 came up, which is excluded"),
        ("one of none 50052", [50059], "alarm 50059 came up, expected was none or 50052"),
        ("50059", [50059], "alarm 50059 came up"),
    ],
)  # fmt: skip
def test_alarms_are_counted_each_time_they_come_up(
    condition: str, found: list[int], sentence: str
) -> None:
    result = judge(parse_check("alarms", condition, ""), found)
    assert (result.verdict is Verdict.PASS) is (found == [50059] and condition == "50059")
    assert result_sentence(result) == sentence


@pytest.mark.parametrize(
    ("row", "sentence"),
    [
        # Of another version: a condition that this one cannot read
        (CheckRow("latch_mm", "about 3", "7", "mm", verdict="fail"),
         "latch_mm is 7 mm, asked for about 3"),
        (CheckRow("alarms", "some", "50059", verdict="fail"), "alarm 50059 came up"),
        (CheckRow("alarms", "50059", "", verdict="aborted", note="x"),
         "alarm 50059 did not come up, nor any other"),
        (CheckRow("speed", "", "7", "mm/s", verdict="pass"), "speed is 7 mm/s, as asked for"),
        (CheckRow("speed", "> 9", "7", "mm/s", verdict="aborted"),
         "speed is 7 mm/s, which is no number: asked for > 9"),
    ],
)  # fmt: skip
def test_a_row_that_lacks_its_limits_is_compared_with_what_was_asked_for(
    row: CheckRow, sentence: str
) -> None:
    assert check_sentence(row) == sentence
