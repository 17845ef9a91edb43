"""Tables that somebody wrote by hand, or another tool: the fewest columns give a report."""

from html import unescape
from pathlib import Path

import pytest
from tests.reports.pages import opened, whole

from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report

CASES = "run,verdict,temperature_c\nhinge-cold,fail,-20\nhinge-warm,pass,25"
RESULTS = (
    "run,metric,value,unit,upper,verdict\n"
    "hinge-cold,torque,7.25,N.m,5,fail\n"
    "hinge-warm,torque,4,N.m,5,pass"
)


def written(folder: Path, cases: str = CASES, results: str = RESULTS) -> Path:
    (folder / "cases.csv").write_text(cases, encoding="utf-8")
    (folder / "results.csv").write_text(results, encoding="utf-8")
    return folder


@pytest.mark.long
def test_results_of_another_tool_are_shown(tmp_path: Path) -> None:
    """The last rows have no end of line: they count."""
    path = build_report(written(tmp_path))
    page = unescape(whole(path))
    assert "torque is 2.25 N.m above its upper limit 5 N.m" in page
    assert "1 of 2 failed; all 2 ran" in page
    assert "1 check passed" in page
    assert "temperature_c=-20" in page
    assert list(opened(path)) == ["hinge-cold", "hinge-warm"]
    assert "axisrig replay" not in page


@pytest.mark.long
def test_the_fewest_columns_are_enough(tmp_path: Path) -> None:
    page = whole(
        build_report(written(tmp_path, "run,verdict\na,fail\n", "run,metric,verdict\na,x,fail\n"))
    )
    assert "x has no value" in page


@pytest.mark.long
def test_a_check_that_failed_as_expected_does_not_count_as_passed(tmp_path: Path) -> None:
    rows = "run,metric,verdict,note\na,x,pass,\na,y,fail,was expected to fail\n"
    page = whole(build_report(written(tmp_path, "run,verdict\na,pass\n", rows)))
    assert "1 check passed, 1 failed as expected" in page


@pytest.mark.long
def test_runs_without_any_check_are_shown(tmp_path: Path) -> None:
    page = whole(build_report(written(tmp_path, "run,verdict\na,pass\n", "run,metric,verdict\n")))
    assert "0 checks passed" in page


@pytest.mark.parametrize(
    ("cases", "results", "said"),
    [
        ("run\na\n", RESULTS, "the column verdict is missing"),
        ("run,verdict\na,PASS\n", RESULTS, "verdict 'PASS' is no verdict"),
        ("run,verdict\na b,pass\n", RESULTS, "run 'a b' is no run id"),
        (CASES, "run,verdict\nhinge-cold,fail\n", "the column metric is missing"),
    ],
)
def test_what_is_missing_is_named_with_what_is_needed(
    tmp_path: Path, cases: str, results: str, said: str
) -> None:
    with pytest.raises(UserError, match=said) as caught:
        build_report(written(tmp_path, cases, results))
    assert "verdicts: pass, marginal" in str(caught.value)
