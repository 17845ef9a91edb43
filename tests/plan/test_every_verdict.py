"""Each of the six verdicts wherever one is looked at: JUnit, terminal, searches, comparisons."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.stored import Said, StoredResults, StoredRun
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.verdict_table import show_verdicts
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult, parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.searches import searches_section
from axisrig.results.compare.pairs import compare

GOOD = (Verdict.PASS, Verdict.MARGINAL)
NOT_JUDGED = (Verdict.ABORTED, Verdict.ERROR)


def stored(run: str, verdict: Verdict, **cells: str) -> StoredRun:
    case = {
        **{"plan": "p", "case": run, "run": run, "verdict": verdict.word, "sim_s": "1"},
        **{"wall_s": "0.5", "seed": "1", "alarms": "", "frame_log_sha256": run},
        **cells,
    }
    check = {
        **{"metric": "latch_mm", "value": "1.0", "unit": "mm", "check": "<= 2", "note": ""},
        **{"lower": "", "upper": "2", "uncertainty": "0", "verdict": verdict.word},
    }
    return StoredRun(case, [check], None, None, Said(None, (), ()))


def test_a_ci_server_sees_a_failure_an_error_or_nothing(tmp_path: Path) -> None:
    """A run that its plan has no more is skipped, whatever its verdict was."""
    runs = [stored(f"r-{verdict.word}", verdict) for verdict in Verdict]
    runs += [stored(f"old-{verdict.word}", verdict, in_plan="no") for verdict in Verdict]
    (suite,) = ET.parse(write_junit(tmp_path, runs)).getroot()
    counts = {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "12", "failures": "2", "errors": "2", "skipped": "6"}
    tags = {
        case.get("name", ""): [child.tag for child in case if child.tag != "properties"]
        for case in suite
    }
    for verdict in Verdict:
        expected = "error" if verdict in NOT_JUDGED else "failure"
        assert tags[f"r-{verdict.word}"] == ([] if verdict in GOOD else [expected])
        assert tags[f"old-{verdict.word}"] == ["skipped"]


@pytest.mark.parametrize("verdict", list(Verdict))
def test_the_terminal_gives_the_causes_of_what_is_not_good(
    verdict: Verdict, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two checks pass, one has the verdict; its note is written out where it is no good one."""
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    (tmp_path / "p.csv").write_text("case,program,rig\na,a.nc,r.toml\n", encoding="utf-8")
    case: Case
    (case,) = read_plan(tmp_path / "p.csv").cases
    checks = [
        CheckResult(parse_check(metric, "<= 2", ""), 1.0, 0.0, one, "the note")
        for metric, one in (
            *(("latch_mm", Verdict.PASS), ("standstill_mm", verdict)),
            *(("overtravel_mm", Verdict.PASS),),
        )
    ]
    show_verdicts([CaseResult(case, verdict, checks)])
    printed = capsys.readouterr().out
    assert f"{verdict.glyph} {verdict.word}" in printed
    assert ("3/3" if verdict is Verdict.PASS else "2/3") in printed
    causes = [line for line in printed.splitlines() if line.startswith(f"{case.run}: ")]
    named = f"{case.run}: {verdict.word}: standstill_mm is 1 mm below its upper limit 2.0 mm"
    assert len(causes) == (verdict not in GOOD)
    assert all(cause.startswith(named) for cause in causes)


@pytest.mark.parametrize("verdict", [Verdict.ABORTED, Verdict.ERROR])
def test_what_ended_a_run_comes_before_the_checks_that_it_left_open(
    verdict: Verdict, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What was printed until then follows it; without an error the checks are the cause."""
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    (tmp_path / "p.csv").write_text("case,program,rig\na,a.nc,r.toml\n", encoding="utf-8")
    (case,) = read_plan(tmp_path / "p.csv").cases
    open_check = parse_check("standstill_mm", "<= 2", "")
    checks = [CheckResult(open_check, None, 0.0, Verdict.INCONCLUSIVE, "it never stood")]
    result = CaseResult(case, verdict, checks, error="the plant broke", log=["a printed line"])
    show_verdicts([result])
    table, *causes = capsys.readouterr().out.split(f"{case.run}: ")
    assert "the plant broke" in table
    assert "standstill_mm" not in table
    assert [cause.strip() for cause in causes] == ["the plant broke", "a printed line"]
    result.error = None
    show_verdicts([result])
    table, *causes = capsys.readouterr().out.split(f"{case.run}: ")
    assert "standstill_mm" in table
    assert causes[0].startswith("inconclusive: standstill_mm")


def test_a_search_counts_which_of_its_probes_hold() -> None:
    column = "search:plc:V.E.FEED"
    row = stored("p-a", Verdict.PASS, **{column: "1 .. 9 to 1", "runs": "6"})
    probes = [
        stored(f"p-a-s{number}", verdict, probe="p-a", **{"plc:V.E.FEED": str(number)})
        for number, verdict in enumerate(Verdict, start=1)
    ]
    other = [stored("p-b-s1", Verdict.FAIL, probe="p-b", **{"plc:V.E.FEED": "1"})]
    text = searches_section(StoredResults(Path(), [row, *probes, *other], {}))
    assert "6 probes, 2 hold, 4 do not" in text


@pytest.mark.parametrize("before", list(Verdict))
def test_a_comparison_calls_worse_what_fell_in_rank(before: Verdict) -> None:
    """And what is missing or new: every run that is lost, every new one that is not good."""
    for after in Verdict:
        first = StoredResults(Path("a"), [stored("r", before), stored("lost", before)], {})
        second = StoredResults(Path("b"), [stored("r", after), stored("new", after)], {})
        found = compare(first, second)
        (pair,) = [pair for pair in found.pairs if pair.name == "r"]
        assert pair.is_worse == (after > before)
        assert pair.is_changed == (after is not before)
        lines = found.worse()
        changed = f"r: {before.word} -> {after.word}: latch_mm is 1 mm inside its limit"
        assert (changed in lines) == (after > before)
        assert f"lost: is missing, was {before.word}" in lines
        assert (f"new: new, {after.word}" in lines) == (after not in GOOD)


@pytest.mark.parametrize("verdict", list(Verdict))
def test_a_folder_that_lacks_runs_is_aborted_at_best(verdict: Verdict) -> None:
    """Probes, and runs that their plan has no more, are none of it."""
    runs = [stored("r", verdict), stored("s", Verdict.ERROR, probe="r")]
    runs += [stored("old", Verdict.ERROR, in_plan="no")]
    assert StoredResults(Path(), runs, {"runs_planned": 1}).verdict is verdict
    lacking = StoredResults(Path(), runs, {"runs_planned": 2}).verdict
    assert lacking is max(verdict, Verdict.ABORTED)


@pytest.mark.parametrize("verdict", list(Verdict))
def test_a_folder_with_more_runs_than_were_asked_for_lacks_none(verdict: Verdict) -> None:
    results = StoredResults(
        Path(), [stored("r", verdict), stored("s", Verdict.PASS)], {"runs_planned": 1}
    )
    assert results.verdict is max(verdict, Verdict.PASS)
    assert results.missing <= 0
