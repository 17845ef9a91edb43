"""The table of verdicts: which runs are one row, and which of them it names."""

import itertools
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.talk import FEW, Talk
from axisrig.bench.campaign.verdict_table import _grouped, _worst, show_unjudged, show_verdicts
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.verdict import Verdict


def result(
    run: str,
    value: float | None = 3.0,
    metric: str = "latch_error_um:Z",
    verdict: Verdict | None = None,
    error: str = "",
    alarms: tuple[str, ...] = (),
    **of_case: Any,
) -> CaseResult:
    """A run whose check asks for -1 .. 1 um, and one that passes."""
    checks = [
        judge(parse_check("lag_mm_max:Z", "<= 1", ""), 0.5, 0.0, ""),
        judge(parse_check(metric, "-1 .. 1", ""), value, 0.0, ""),
    ]
    facts: Any = SimpleNamespace(
        alarms=[SimpleNamespace(text=text, id=text, is_further=False) for text in alarms],
        buses=(),
    )
    case = case_of(run, **{"case": "one", **of_case})
    found = verdict or max(check.verdict for check in checks)
    return CaseResult(case, found, [] if error else checks, error=error, facts=facts)


PARTS: dict[str, dict[str, Any]] = {
    "plan": {"plan": "q"},
    "case": {"case": "other"},
    "verdict": {"verdict": Verdict.ABORTED},
    "metric": {"metric": "latch_error_um:X"},
    "side of the limit": {"value": -3.0},
    "no value": {"value": None},
    "error": {"error": "something else", "verdict": Verdict.FAIL},
    "alarm": {"alarms": ("ID 70331",)},
}


def test_runs_of_one_case_that_fail_alike_are_one_row() -> None:
    """Each part of what makes them alike parts them."""
    alike = [result(f"r{number}", 2.0 + number) for number in range(3)]
    assert [len(group) for group in _grouped(alike)] == [3]
    for name, changes in PARTS.items():
        groups = _grouped([*alike, result("x", **changes)])
        assert [len(group) for group in groups] == [3, 1], name
    errors = [result(f"e{n}", error=text, verdict=Verdict.ERROR) for n, text in enumerate("aba")]
    assert [[one.case.run for one in group] for group in _grouped(errors)] == [
        ["p-e0", "p-e2"], ["p-e1"]
    ]  # fmt: skip
    each = [result(f"x{place}", **changes) for place, changes in enumerate(PARTS.values())]
    assert len(_grouped([*each, *each])) == len(PARTS)


@pytest.mark.parametrize("values", list(itertools.permutations((2.0, 5.0, 3.0))))
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_row_names_the_run_that_is_furthest_beyond_its_limit(
    values: tuple[float, ...], side: float
) -> None:
    found = _worst([result(f"r{value:g}", side * value) for value in values])
    assert found.case.run == "p-r5"


def many(*more: CaseResult) -> list[CaseResult]:
    return [*(result(f"good{n}", 0.5, case=f"g{n}") for n in range(FEW + 1)), *more]


def test_of_many_runs_what_did_not_pass_is_printed_and_of_few_each(
    capsys: pytest.CaptureFixture[str],
) -> None:
    bad = [result("bad1", 2.0), result("bad2", 7.0), result("bad3", 3.0)]

    def printed(results: list[CaseResult], talk: Talk = Talk.SHORT) -> str:
        show_verdicts(results, talk)
        return capsys.readouterr().out

    short = printed(many(*bad))
    assert "p-bad2 (+ 2)" in short
    assert "p-bad2 and 2 more runs of its case: fail: " in short
    assert "p-bad1" not in short
    assert "good" not in short
    whole = printed(many(*bad), Talk.ALL)
    assert all(f"p-bad{n}" in whole and f"p-good{n}" in whole for n in (1, 2, 3))
    assert all(f"p-bad{n}: fail: " in whole for n in (1, 2, 3))
    assert "p-good1: " not in whole
    assert "(+" not in whole
    assert printed(many(*bad), Talk.NONE) == ""
    assert printed(many()) == ""
    few = printed([result("good", 0.5), *bad])
    assert all(run in few for run in ("p-good", "p-bad1", "p-bad2", "p-bad3"))


@pytest.mark.parametrize("verdict", list(Verdict))
def test_of_many_runs_one_is_printed_that_neither_passed_nor_is_marginal(
    verdict: Verdict, capsys: pytest.CaptureFixture[str]
) -> None:
    """A marginal value is within its limits; it stands in the count below."""
    show_verdicts(many(result("one", 0.5, verdict=verdict)))
    is_printed = verdict not in (Verdict.PASS, Verdict.MARGINAL)
    assert ("p-one" in capsys.readouterr().out) is is_printed


def test_a_row_counts_its_runs_and_the_checks_that_passed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two checks one passed; the second run that failed alike is in the same row."""
    monkeypatch.setenv("COLUMNS", "160")
    bad = [result("bad1", 2.0, alarms=("50059",)), result("bad2", 7.0, alarms=("50059",))]
    show_verdicts(many(*bad))
    text = capsys.readouterr().out
    row = next(line for line in text.splitlines() if "p-bad2" in line)
    cells = [cell.strip() for cell in row.strip("│ ").split("│")]
    assert (cells[1:3], cells[-1]) == (["p-bad2 (+ 1)", "1/2"], "50059")


@pytest.mark.parametrize(
    ("left", "words"),
    [
        ([], ""),
        (["a"], "judges a\n"),
        (["a", "b", "c"], "judges a, b, c\n"),
        (["a", "b", "c", "d", "e"], "judges a, b, c and 2 more\n"),
    ],
)
def test_recordings_that_no_row_judges_are_named(
    capsys: pytest.CaptureFixture[str], left: list[str], words: str
) -> None:
    show_unjudged(left)
    assert capsys.readouterr().err.removeprefix("no row of the plan ") == words


@pytest.mark.parametrize("count", [1, 2, 3])
def test_below_the_table_stand_as_many_runs_as_passed(
    capsys: pytest.CaptureFixture[str], count: int
) -> None:
    """Runs that are in one row have not passed: of 21 + count runs 21 have, in whatever rows."""
    alike = [result(f"bad{n}", 2.0 + n) for n in range(count)]
    apart = [result(f"bad{n}", 2.0 + n, case=f"b{n}") for n in range(count)]
    for bad in (alike, apart):
        show_verdicts(many(*bad))
        assert f"{FEW + 1} more passed; -v shows each one" in map(
            str.strip, capsys.readouterr().out.splitlines()
        )
    show_verdicts(many(*alike), Talk.ALL)
    assert "more passed" not in capsys.readouterr().out


def test_twenty_results_are_few_and_one_more_are_many(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for count, is_each in ((19, True), (20, True), (21, False)):
        show_verdicts([result(f"good{n}", 0.5, case=f"g{n}") for n in range(count)])
        out = capsys.readouterr().out
        assert [f"p-good{n} " in out for n in range(count)] == [is_each] * count
    for count in (0, 20, 21):
        assert [Talk.NONE.of(count), Talk.ALL.of(count)] == [Talk.NONE, Talk.ALL]


def test_a_run_with_little_room_names_its_check_where_each_run_is_shown(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """0.1 um below its limit is more than 0.06 um and less than twice that."""
    found = result("close", 0.9)
    found.checks = [
        found.checks[0],
        judge(parse_check("latch_error_um:Z", "<= 1", ""), 0.9, 0.06, ""),
    ]
    found.verdict = max(check.verdict for check in found.checks)
    assert found.verdict is Verdict.MARGINAL
    show_verdicts(many(found), Talk.ALL)
    (row,) = [line for line in capsys.readouterr().out.splitlines() if "p-close" in line]
    assert "latch_error_um" in row
    assert "1/2" in row
    show_verdicts(many(found), Talk.SHORT)
    assert "p-close" not in capsys.readouterr().out
