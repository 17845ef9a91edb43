"""What a report shows of the runs of a case, from rows alone."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from scipy import stats

from axisrig.bench.judge.statistics.summary import CaseStatistics, ValueApart, statistics_data

FEED = "plc:V.E.FEED"
VALUES = (0.4, 0.1, -0.2, 0.3, 0.0, 0.2)

Rows = list[dict[str, str]]


def rows(values: Sequence[object], **columns: Sequence[str]) -> tuple[Rows, Rows]:
    """Rows of `results.csv` and `cases.csv` of the runs of one case."""
    cases = [
        {"plan": "p", "case": "a", "run": f"p-a-{n}", "frame_log_sha256": f"f{n}"}
        | {name: texts[n] for name, texts in columns.items()}
        for n in range(len(values))
    ]
    checks = [
        {"plan": "p", "case": "a", "run": f"p-a-{n}", "metric": "latch_error_um", "unit": "um",
         "value": str(value), "lower": "-1.0", "upper": "1.0", "verdict": "pass"}
        for n, value in enumerate(values)
    ]  # fmt: skip
    return checks, cases


def only(found: Sequence[CaseStatistics]) -> CaseStatistics:
    (entry,) = found
    return entry


def test_a_metric_of_several_runs_is_summed_up() -> None:
    entry = only(statistics_data(*rows(VALUES)))
    s = stats.tstd(VALUES)
    assert (entry.plan, entry.case, entry.metric, entry.unit) == ("p", "a", "latch_error_um", "um")
    found = entry.found
    assert (found.n, found.is_small, found.lower, found.upper) == (6, True, -1.0, 1.0)
    assert found.limits == [-1.0, 1.0]
    assert found.mean
    assert found.spread
    assert found.cpk
    assert found.mean.value == pytest.approx(0.8 / 6)
    assert found.spread.value == pytest.approx(s)
    assert found.cpk.value == pytest.approx((1 - 0.8 / 6) / (3 * s))
    assert found.normality_p == pytest.approx(stats.shapiro(VALUES).pvalue, rel=1e-6)
    assert entry.inputs == {}


@pytest.mark.parametrize(
    ("frames", "feeds", "equal"),
    [
        ("ff", "11", ["p-a-1"]),
        ("ff", "12", []),  # of other inputs the same frames say something
        ("fg", "11", []),
        ("", "11", []),  # not known
    ],
)
def test_runs_are_equal_by_their_frames_and_inputs(
    frames: str, feeds: str, equal: list[str]
) -> None:
    checks, cases = rows((1.0, 2.0, 3.0), **{FEED: [*feeds, "3"]})
    for place, case in enumerate(cases[:2]):
        case["frame_log_sha256"] = frames[place : place + 1]
    entry = only(statistics_data(checks, cases))
    assert (entry.equal, entry.found.n) == (equal, 3 - len(equal))


def test_equal_and_missing_runs_are_named_and_not_counted() -> None:
    checks, cases = rows((*VALUES, 0.4, ""))
    cases[6]["frame_log_sha256"] = cases[0]["frame_log_sha256"]
    entry = only(statistics_data(checks, cases))
    assert (entry.found.n, entry.equal, entry.missing) == (6, ["p-a-6"], ["p-a-7"])


@pytest.mark.parametrize("verdict", ["aborted", "error"])
def test_a_run_that_did_not_end_gives_no_value(verdict: str) -> None:
    """What it has measured until then is in its row, 99 um."""
    checks, cases = rows((*VALUES, 99.0))
    checks[6]["verdict"] = verdict
    entry = only(statistics_data(checks, cases))
    assert (entry.found.n, entry.missing) == (6, ["p-a-6"])
    checks[6]["verdict"] = "inconclusive"
    assert only(statistics_data(checks, cases)).found.n == 7


def test_columns_that_the_runs_vary_have_slope_and_share() -> None:
    feeds = ["300", "300", "600", "600", "900", "900"]
    values = [1.0, 1.2, 2.0, 2.2, 3.0, 3.2]
    entry = only(statistics_data(*rows(values, **{FEED: feeds, "set:Z.edge": ["POS"] * 6})))
    assert list(entry.inputs) == [FEED]
    feed = entry.inputs[FEED]
    assert feed.slope
    assert feed.slope.value == pytest.approx(1.0 / 300.0)
    assert feed.places == [300.0, 300.0, 600.0, 600.0, 900.0, 900.0]
    groups = stats.f_oneway(values[:2], values[2:4], values[4:]).statistic  # F = S/2 : (1-S)/3
    share = feed.share
    assert share
    assert share / 2 / ((1 - share) / 3) == pytest.approx(groups)


def test_texts_single_runs_and_rows_of_statistics_are_left_out() -> None:
    assert statistics_data(*rows(["FREE", "FREE"])) == []
    assert statistics_data(*rows([1.0])) == []
    checks, cases = rows([1.0, 2.0])
    cases[1]["runs"] = "3"
    assert statistics_data(checks, cases) == []


def test_a_run_that_the_plan_has_no_more_does_not_count() -> None:
    """It was made under another row: its value and its limits say nothing about this one."""
    checks, cases = rows((*VALUES, 40.0))
    checks[6]["upper"] = "99.0"
    cases[6]["in_plan"] = "no"
    entry = only(statistics_data(checks, cases))
    assert (entry.found.n, entry.missing, entry.found.upper) == (6, [], 1.0)
    assert [run for run, _ in entry.found.values] == [f"p-a-{n}" for n in range(6)]


def test_rows_of_another_tool_need_few_columns() -> None:
    cases = [{"run": "x1", "case": "x"}, {"run": "x2", "case": "x"}]
    checks = [
        {"run": "x1", "metric": "gap", "value": "1"},
        {"run": "x2", "metric": "gap", "value": "3"},
    ]
    entry = only(statistics_data(checks, cases))
    assert entry.found.mean
    assert (entry.found.mean.value, entry.found.cpk, entry.found.outlier) == (2.0, None, None)


@pytest.mark.parametrize("first", ["", "nan", "0.1"])
def test_a_run_repeats_an_earlier_one_whatever_became_of_its_value(first: str) -> None:
    """As a statistic of the plan counts them: the second of two equal runs says nothing new."""
    values = (first, 0.2, 0.3, 0.4)
    entry = only(statistics_data(*rows(values, frame_log_sha256="aabc", **{FEED: "1111"})))
    assert list(entry.equal) == ["p-a-1"]
    counted = [name for name, _ in entry.found.values]
    assert counted == [*(["p-a-0"] if first == "0.1" else []), "p-a-2", "p-a-3"]
    assert list(entry.missing) == ([] if first == "0.1" else ["p-a-0"])


@pytest.mark.parametrize("place", [0, 1, 2])
@pytest.mark.parametrize("word", ["FREE", "1 mm", "none", "0x10"])
def test_a_metric_that_is_a_word_in_one_run_has_no_statistics(word: str, place: int) -> None:
    """The numbers beside it are of a state, such as that of a control; other metrics stay."""
    values: list[object] = [1.0, 2.0, 3.0]
    values[place] = word
    checks, cases = rows(values)
    assert statistics_data(checks, cases) == []
    other = [{**row, "metric": "lag_mm_max", "value": "5"} for row in checks]
    assert only(statistics_data([*checks, *other], cases)).metric == "lag_mm_max"


@pytest.mark.parametrize(
    ("changed", "count"),
    [({"verdict": "error"}, 2), ({"verdict": "aborted"}, 2), ({"value": ""}, 2),
     ({"value": "nan"}, 2), ({"value": "inf"}, 2), ({"value": "-inf"}, 2), ({"value": "1e3"}, 3),
     ({"value": "-0"}, 3), ({"verdict": "fail"}, 3)],
)  # fmt: skip
def test_only_numbers_of_runs_that_ended_count(changed: dict[str, str], count: int) -> None:
    checks, cases = rows([1.0, 2.0, 3.0])
    checks[1].update(changed)
    entry = only(statistics_data(checks, cases))
    assert entry.found.n == count
    assert entry.missing == ([] if count == 3 else ["p-a-1"])


def test_a_word_of_a_run_that_broke_off_or_left_the_plan_hides_nothing() -> None:
    checks, cases = rows([1.0, 2.0, "FREE", "FREE"])
    checks[2]["verdict"] = "error"
    cases[3]["in_plan"] = "no"
    assert only(statistics_data(checks, cases)).found.n == 2


def test_a_metric_without_any_number_has_no_statistics() -> None:
    assert statistics_data(*rows(["nan", "", "inf"])) == []


@pytest.mark.parametrize(
    ("lower", "upper", "limits"),
    [
        (("0", "0", "0"), ("2", "3", "2"), (0.0, None)),
        (("-1", "-1", "-2"), ("2", "2", "2"), (None, 2.0)),
        (("-inf",) * 3, ("inf",) * 3, (None, None)),
        (("",) * 3, ("5", "5", ""), (None, None)),
        (("x",) * 3, ("1e2",) * 3, (None, 100.0)),
    ],
)
def test_a_limit_is_one_where_all_runs_have_it(
    lower: tuple[str, ...], upper: tuple[str, ...], limits: tuple[float | None, float | None]
) -> None:
    checks, cases = rows([1.0, 2.0, 3.0])
    for row, low, high in zip(checks, lower, upper, strict=True):
        row.update(lower=low, upper=high)
    found = only(statistics_data(checks, cases)).found
    assert (found.lower, found.upper) == limits


def test_inputs_that_are_texts_have_a_share_and_no_slope() -> None:
    """One text among numbers makes texts of all; what is no input of a plan is left out."""
    entry = only(statistics_data(*rows(
        [1.0, 1.0, 3.0, 3.0],
        **{FEED: ["1", "1", "fast", "fast"], "set:Z.edge": ["POS", "POS", "NEG", "NEG"],
           "title": ["a", "b", "c", "d"], "other:x": ["1", "2", "3", "4"]},
    )))  # fmt: skip
    assert list(entry.inputs) == [FEED, "set:Z.edge"]
    for column, texts in ((FEED, ["1", "1", "fast", "fast"]), ("set:Z.edge", None)):
        found = entry.inputs[column]
        assert (found.slope, found.intercept, found.share) == (None, None, pytest.approx(1.0))
        assert texts is None or found.places == texts


def test_statistics_are_of_each_plan_case_and_metric() -> None:
    """In the order of the rows; a run of another plan with the same case is another sample."""
    checks, cases = rows([1.0, 2.0])
    others = [
        [{**row, "run": row["run"].replace("p-a", name), "plan": plan, "case": case}
         for row in table]
        for plan, case, name in (("q", "a", "q-a"), ("p", "b", "p-b"))
        for table in (checks, cases)
    ]  # fmt: skip
    more = [{**row, "metric": "lag_mm_max", "unit": "mm"} for row in checks]
    found = statistics_data(
        [*others[2], *checks, *more, *others[0]], [*cases, *others[1], *others[3]]
    )
    assert [(each.plan, each.case, each.metric, each.unit) for each in found] == [
        ("p", "b", "latch_error_um", "um"), ("p", "a", "latch_error_um", "um"),
        ("p", "a", "lag_mm_max", "mm"), ("q", "a", "latch_error_um", "um"),
    ]  # fmt: skip
    assert {each.found.n for each in found} == {2}


@pytest.mark.parametrize(("ratio", "is_apart"), [(0.0, False), (1.0, False), (1.0001, True)])
def test_a_value_is_apart_beyond_the_limit_of_its_test(ratio: float, is_apart: bool) -> None:
    assert ValueApart("p-a", ratio).is_apart is is_apart


@pytest.mark.parametrize("metrics", [("latch_mm:X", "latch_mm:Z"), ("latch_mm", "latch_mm:Z")])
def test_the_same_metric_of_two_axes_has_its_own_statistics(metrics: Sequence[str]) -> None:
    checks: list[dict[str, str]] = []
    for place, metric in enumerate(metrics):
        of_axis, cases = rows([10.0 * place + n for n in range(4)])
        checks += [{**row, "metric": metric, "unit": f"u{place}"} for row in of_axis]
    found = {entry.metric: entry for entry in statistics_data(checks, cases)}
    assert list(found) == list(metrics)
    for place, metric in enumerate(metrics):
        mean: Any = found[metric].found.mean
        assert mean.value == pytest.approx(10.0 * place + 1.5)
        assert (found[metric].unit, found[metric].found.n) == (f"u{place}", 4)


def test_a_case_keeps_to_its_own_plan() -> None:
    """Two plans have a case of the same name."""
    checks, cases = rows([1.0, 2.0, 3.0, 4.0])
    other = [{**row, "plan": "q", "run": row["run"].replace("p-", "q-")} for row in cases]
    of_other = [
        {**row, "plan": "q", "run": row["run"].replace("p-", "q-"), "value": "7.0"}
        for row in checks
    ]
    found = statistics_data([*checks, *of_other], [*cases, *other])
    assert [(entry.plan, entry.found.n) for entry in found] == [("p", 4), ("q", 4)]
    assert replace(found[0], plan="q") != found[1]
