"""What the terminal says below the table: overload of a segment, alarms, what had to fail."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results.writer import CaseResult, no_values
from axisrig.bench.campaign.talk import FEW
from axisrig.bench.campaign.verdict_table import counts_line, show_verdicts
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.expectation import NOT_MET
from axisrig.bench.plan.verdict import Verdict


def result(run: str, *values: float, buses: Any = (), alarms: Any = (), **more: Any) -> CaseResult:
    """A run with a check `<= 1` for each value."""
    checks = [
        judge(parse_check(f"lag_mm_max:{axis}", "<= 1", ""), value, 0.0, "")
        for axis, value in zip("XYZ", values, strict=False)
    ]
    facts: Any = SimpleNamespace(buses=buses, alarms=alarms, messages=())
    verdict = max((check.verdict for check in checks), default=Verdict.PASS)
    case = case_of(run, **more)
    return CaseResult(case, verdict, checks, facts=facts)


def alarm(number: int, is_further: bool = False) -> Any:
    return SimpleNamespace(id=number, text=f"ID {number} text", is_further=is_further)


def bus(segment: str, overload: str, *waiting: tuple[str, float]) -> Any:
    waits = [SimpleNamespace(name=name, worst_us=worst) for name, worst in waiting]
    return SimpleNamespace(segment=segment, overload=overload, load_pct=101.26,
                           load_1ms_pct=120.04, waiting=waits)  # fmt: skip


@pytest.fixture
def lines(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the lines below the table for these results, without the rest."""
    monkeypatch.setattr("axisrig.bench.campaign.results.writer.log_lines", lambda _: [])

    def shown(*results: CaseResult) -> list[str]:
        show_verdicts(results)
        return [line for line in capsys.readouterr().out.splitlines() if line.startswith("p-")]

    return shown


def test_an_overloaded_segment_is_named_whatever_the_verdict(lines: Any) -> None:
    """The first of what waited waited longest; a segment with room says nothing."""
    buses = (bus("can1", "last TPDO after SYNC", ("pdo", 231.4), ("sdo", 30.0)), bus("can2", ""),
             bus("can3", "two frames"))  # fmt: skip
    assert lines(result("a", 0.5, buses=buses)) == [
        "p-a: segment can1 is overloaded: last TPDO after SYNC; load 101.3 %, worst ms 120.0 %,"
        " pdo waited 231 us",
        "p-a: segment can3 is overloaded: two frames; load 101.3 %, worst ms 120.0 %",
    ]


def test_what_did_not_pass_comes_with_the_alarms_that_are_its_cause(lines: Any) -> None:
    """Not with those that came up while axes stopped; nothing of a run that passed."""
    alarms = (alarm(50059), alarm(70331, is_further=True))
    found = lines(result("a", 0.5, 3.0, 2.0, alarms=alarms), result("b", 0.5, alarms=alarms))
    assert [line.partition(" above")[0] for line in found] == [
        "p-a: fail: lag_mm_max:Y is 2 mm", "p-a: fail: lag_mm_max:Z is 1 mm", "p-a: ID 50059 text",
    ]  # fmt: skip


def test_a_check_that_had_to_fail_and_did_not_is_a_cause(lines: Any) -> None:
    """One that failed as expected is listed as failed, and not as unmet."""
    one = result("a", 0.5, 3.0, expected=("lag_mm_max:X", "lag_mm_max:Y"))
    failed, unmet = lines(one)
    assert failed.startswith("p-a: fail: lag_mm_max:Y is 2 mm above its upper limit")
    assert unmet.startswith(f"p-a: lag_mm_max:X {NOT_MET}: ")


def test_an_error_is_the_cause_with_what_was_printed_until_then(lines: Any) -> None:
    broken = no_values(case_of("a"), Verdict.ERROR, "it broke")
    broken.log += ["first line", "second line"]
    assert lines(broken) == ["p-a: it broke", "p-a: first line", "p-a: second line"]


def test_the_table_counts_checks_and_what_it_leaves_out(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("axisrig.bench.campaign.results.writer.log_lines", lambda _: [])
    monkeypatch.setenv("COLUMNS", "160")
    good = [result(f"g{n}", 0.5, case=f"g{n}") for n in range(FEW)]
    show_verdicts([*good, result("bad", 0.5, 3.0, 0.5, alarms=(alarm(50059), alarm(70331, True)))])
    text = capsys.readouterr().out
    row = next(line for line in text.splitlines() if "p-bad" in line)
    assert [cell.strip() for cell in row.strip("│ ").split("│")][1:3] == ["p-bad", "2/3"]
    assert "50059" in row
    assert "70331" not in row
    assert f"{FEW} more passed; -v shows each one" in text


def test_verdicts_are_counted_from_the_best_with_the_time() -> None:
    assert counts_line([Verdict.FAIL, Verdict.PASS, Verdict.PASS]) == "2 pass, 1 fail"
    assert counts_line([Verdict.ERROR], 3725.0) == "1 error in 1 h 02 min"
    assert counts_line([], 59.6) == "nothing ran in 1 min 00 s"
    assert counts_line([Verdict.PASS], 3599.4) == "1 pass in 59 min 59 s"
