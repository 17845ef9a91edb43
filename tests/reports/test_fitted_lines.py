"""Lines of the report: which runs are points, which rows a line, and the words beside them."""

import re
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.lines.section import PICTURES_MAX, lines, lines_section


def row(metric: str, value: str, verdict: str = "pass", unit: str = "um") -> dict[str, str]:
    return {"metric": metric, "value": value, "verdict": verdict, "unit": unit, "check": "<= 9",
            "reference": "p.csv:2", "uncertainty": "0.25", "run": "p-a"}  # fmt: skip


def run(name: str, checks: list[dict[str, str]], *, case: str = "a", feed: str = "",
        is_statistic: bool = False, plan: str = "p") -> Any:  # fmt: skip
    cells = {"plan": plan, "case": case, "plc:V.E.FEED": feed}
    read = [CheckRow.read(row) for row in checks]
    return SimpleNamespace(run=name, case=cells, checks=read, is_statistic=is_statistic,
                           verdict=Verdict.PASS)  # fmt: skip


def folder(*runs: Any) -> Any:
    return SimpleNamespace(planned=runs)


OVER = "(latch_error_um; plc:V.E.FEED)"
ASKED = [row(f"slope{OVER}", "0.5", unit="um/(plc:V.E.FEED)"), row(f"intercept{OVER}", "-2")]
POINTS = [
    run("both", [row("mean(latch_error_um; each)", "3"), row("latch_error_um", "9"),
                 row("spread(latch_error_um; each)", "0.5")], feed="300"),
    run("alone", [row("latch_error_um", "4")], feed="600"),
    run("zero", [row("mean(latch_error_um; each)", "0"), row("latch_error_um", "9")], feed="0"),
    run("no feed", [row("latch_error_um", "5")]),
    run("no value", [row("latch_error_um", "")], feed="900"),
    run("other case", [row("latch_error_um", "5")], feed="900", case="b"),
]  # fmt: skip


def test_a_point_is_the_mean_of_a_run_else_its_value() -> None:
    (one,) = lines(folder(*POINTS, run("p-a", ASKED, is_statistic=True)))
    (fitted,) = one.fitted
    assert [(p.run, p.x, p.y, p.spread) for p in fitted.points] == [
        ("both", 300.0, 3.0, 0.5), ("alone", 600.0, 4.0, None), ("zero", 0.0, 0.0, None),
    ]  # fmt: skip
    assert (fitted.slope, fitted.intercept, fitted.name) == (0.5, -2.0, "a")
    assert (one.unit, one.column) == ("um", "plc:V.E.FEED")


def test_a_line_over_another_metric_needs_both() -> None:
    over = "(latch_error_um; contact_velocity_mm_s)"
    asked = [row(f"slope{over}", "0.5"), row(f"intercept{over}", "-2")]
    points = [run("x", [row("latch_error_um", "4"), row("contact_velocity_mm_s", "10")]),
              run("y", [row("latch_error_um", "4")]),
              run("z", [row("contact_velocity_mm_s", "10")])]  # fmt: skip
    (one,) = lines(folder(*points, run("p-a", asked, is_statistic=True)))
    assert [(p.run, p.x, p.y) for p in one.fitted[0].points] == [("x", 10.0, 4.0)]
    assert one.column == "contact_velocity_mm_s"


@pytest.mark.parametrize("verdicts", [("pass", "fail"), ("fail", "pass"), ("marginal", "pass")])
def test_a_line_has_the_worse_verdict_of_its_ends(verdicts: tuple[str, str]) -> None:
    asked = [{**end, "verdict": verdict} for end, verdict in zip(ASKED, verdicts, strict=True)]
    (one,) = lines(folder(*POINTS, run("p-a", asked, is_statistic=True)))
    assert one.fitted[0].verdict.word == max(verdicts, key=("pass", "marginal", "fail").index)


def test_both_ends_are_needed_and_both_need_a_value() -> None:
    for asked in (ASKED[:1], ASKED[1:], [ASKED[0], {**ASKED[1], "value": ""}],
                  [{**ASKED[0], "value": ""}, ASKED[1]],
                  [ASKED[0], row("intercept(latch_error_um; touch)", "1")]):  # fmt: skip
        assert lines(folder(*POINTS, run("p-a", asked, is_statistic=True))) == []


def test_a_picture_and_a_table_say_what_they_are_of() -> None:
    text = lines_section(folder(*POINTS, run("p-a", ASKED, is_statistic=True)))
    assert "<b>p</b>: latch_error_um, µm over plc:V.E.FEED" in text
    assert ">V.E.FEED<" in text
    assert '<a href="#p-a">a</a>' in text
    assert 'scope="col">slope, µm/(plc:V.E.FEED)</th>' in text
    assert 'scope="col">intercept, µm</th>' in text
    assert " 0.5 ± 0.25</td><td>&lt;= 9</td>" in text
    assert "not drawn" not in text


@pytest.mark.parametrize("count", [PICTURES_MAX, PICTURES_MAX + 2])
def test_more_pictures_than_a_page_holds_are_counted(count: int) -> None:
    metrics = ("latch_error_um", "latch_mm", "contact_mm", "reaction_ms", "duration_s",
               "overtravel_mm", "standstill_mm", "stop_way_mm")  # fmt: skip
    asked = [
        row(f"{name}({metric}; plc:V.E.FEED)", "1")
        for metric in metrics[:count]
        for name in ("slope", "intercept")
    ]
    text = lines_section(folder(*POINTS, run("p-a", asked, is_statistic=True)))
    assert text.count("<svg") == PICTURES_MAX
    assert ("2 more metrics with lines are not drawn" in text) is (count > PICTURES_MAX)
    assert ("more metrics" in text) is (count > PICTURES_MAX)


def test_lines_of_several_axes_are_in_one_picture_with_their_own_points() -> None:
    """The metric is the same; each case has the values of the axis that it asks for."""
    values = {"X": (4.0, 0.5), "Z": (-7.0, -0.25)}
    runs = []
    for axis, (_, slope) in values.items():
        over = f"(latch_error_um:{axis}; plc:V.E.FEED)"
        asked = [row(f"slope{over}", f"{slope}"), row(f"intercept{over}", "1")]
        every = [row(f"latch_error_um:{name}", f"{one}") for name, (one, _) in values.items()]
        runs += [
            run(f"r{axis}", every, case=axis, feed="300"),
            run(f"p-{axis}", asked, case=axis, is_statistic=True),
        ]
    (one,) = lines(folder(*runs))
    assert (one.metric, one.column) == ("latch_error_um", "plc:V.E.FEED")
    found = [(each.name, each.slope, [(p.x, p.y) for p in each.points]) for each in one.fitted]
    assert found == [("X", 0.5, [(300.0, 4.0)]), ("Z", -0.25, [(300.0, -7.0)])]


def test_plans_have_pictures_of_their_own_with_their_own_points() -> None:
    """Cases of one name in two plans are two, whichever came first."""
    runs = []
    for plan, value in (("p", "3"), ("q", "7")):
        runs += [run(f"{plan}-x", [row("latch_error_um", value)], feed="300", plan=plan),
                 run(f"{plan}-a", ASKED, is_statistic=True, plan=plan)]  # fmt: skip
    for turn in (1, -1):
        found = {one.plan: one.fitted for one in lines(folder(*runs[::turn]))}
        assert list(found) == ["p", "q"][::turn]
        assert {plan: [(p.run, p.y) for p in line.points] for plan, (line,) in found.items()} == {
            "p": [("p-x", 3.0)], "q": [("q-x", 7.0)],
        }  # fmt: skip


def test_metrics_and_columns_have_pictures_of_their_own() -> None:
    """Two metrics over one column, and one of them over another column: three pictures."""
    pairs = [("latch_error_um", "plc:V.E.FEED"), ("reaction_ms", "plc:V.E.FEED"),
             ("latch_error_um", "contact_velocity_mm_s")]  # fmt: skip
    asked = [row(f"{end}({metric}; {column})", "1") for metric, column in pairs
             for end in ("slope", "intercept")]  # fmt: skip
    found = lines(folder(*POINTS, run("p-a", asked, is_statistic=True)))
    assert [(one.metric, one.column) for one in found] == pairs


def test_a_row_without_a_case_is_named_by_its_run() -> None:
    (one,) = lines(folder(run("p-7", [row("latch_error_um", "4")], case="", feed="1"),
                          run("p-a", ASKED, case="", is_statistic=True)))  # fmt: skip
    (fitted,) = one.fitted
    assert fitted.name == "p-a"
    assert [point.run for point in fitted.points] == ["p-7"]
    assert '<a href="#p-a">p-a</a>' in lines_section(folder(run("p-a", ASKED, case="",
                                                                is_statistic=True)))  # fmt: skip


def test_a_line_without_points_is_drawn_and_its_rows_are_in_the_table() -> None:
    text = lines_section(folder(run("p-a", ASKED, is_statistic=True)))
    assert text.count("<svg") == 1
    assert text.count('class="ln-line"') == 1
    assert " -2 ± 0.25</td>" in text


@pytest.mark.parametrize("verdicts", [("pass", "fail"), ("fail", "pass"), ("error", "marginal")])
def test_slope_and_intercept_have_their_own_verdicts_in_the_table(
    verdicts: tuple[str, str],
) -> None:
    asked = [{**end, "verdict": verdict} for end, verdict in zip(ASKED, verdicts, strict=True)]
    text = lines_section(folder(*POINTS, run("p-a", asked, is_statistic=True)))
    cells = re.findall(r'<td class="word v-(\w+)">.*?</span>.*?</span> ([-\d.]+) ±', text)
    assert cells == [(verdicts[0], "0.5"), (verdicts[1], "-2")]
