"""Rows that search: bisection against a known limit, and what such a row may not be."""

import math
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.searching import run_search
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.plan.searching import PROBES_MAX, Bracket, Search, bisect
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]
HEAD = "case,program,rig,search:plc:V.E.FEED,check:latch_error_um"
ROW = "a,probe.nc,machine.toml,{},<= 1"
SEARCHES = (
    "case,program,rig,search:plc:V.E.FEED,check:latch_error_um,check:search_good,check:search_bad\n"
    "a,probe.nc,machine.toml,200 .. 3000 to 200,<= 1,>= 1,>= 1\n"
)


def searched(search: Search, holds: Callable[[Decimal], bool]) -> tuple[Bracket, list[str]]:
    """Carry a search out; what it found and what it tried."""
    steps, tried = bisect(search), []
    value = next(steps)
    while True:
        tried.append(value)
        try:
            value = steps.send(holds(Decimal(value)))
        except StopIteration as end:
            return end.value, tried


@pytest.mark.long
@given(
    st.integers(-(10**6), 10**6),
    st.integers(2, 10**6),
    st.integers(1, 1000),
    st.integers(0, 4),
    st.integers(0, 999),
    st.booleans(),
)
def test_the_limit_is_between_good_and_bad(
    first: int, span: int, width: int, decimals: int, per_mille: int, is_falling: bool
) -> None:
    step = Decimal(1).scaleb(-decimals)
    width = min(width, span - 1)
    last = first + span
    ends = (last, first) if is_falling else (first, last)
    search = Search("plc:V.E.FEED", "", *ends, width, step)
    limit = (first + Decimal(per_mille * span) / 1000) * step
    found, tried = searched(search, lambda value: value <= limit)
    assert found.good is not None
    assert found.bad is not None
    assert Decimal(found.good) <= limit < Decimal(found.bad)
    assert 0 < Decimal(found.bad) - Decimal(found.good) <= width * step
    # The count that halving needs, from the logarithm
    assert len(tried) <= search.probes_max <= 2 + math.ceil(math.log2(span / width)) + 1
    assert tried[:2] == [search.value(end) for end in ends]
    assert len(set(tried)) == len(tried)
    assert all(min(ends) * step <= Decimal(value) <= max(ends) * step for value in tried)


@pytest.mark.parametrize(("holds", "words"), [(True, "both ends"), (False, "neither end")])
def test_a_limit_outside_the_range_is_said(holds: bool, words: str) -> None:
    search = Search("plc:V.E.FEED", "300 .. 3000 to 10", 300, 3000, 10, Decimal(1))
    found, tried = searched(search, lambda _: holds)
    assert (found.good, found.bad, tried) == (None, None, ["300", "3000"])
    assert words in found.reason
    assert "plc:V.E.FEED = 300 .. 3000 to 10" in found.reason


@pytest.mark.parametrize(
    ("verdict", "good"),
    [
        (Verdict.PASS, "1400"),
        (Verdict.MARGINAL, "1400"),
        (Verdict.INCONCLUSIVE, "600"),
        (Verdict.FAIL, "600"),
    ],
)
def test_a_probe_holds_that_passes_or_is_marginal(
    write_plan: PlanWriter, verdict: Verdict, good: str
) -> None:
    """Passes to 600, then the verdict to 1400, then fails: inconclusive does not hold."""
    (case,) = read_plan(write_plan(SEARCHES)).cases

    def probe(one: Case) -> CaseResult:
        value = float(one.inputs["plc:V.E.FEED"])
        of_value = Verdict.PASS if value <= 600 else verdict if value <= 1400 else Verdict.FAIL
        return CaseResult(one, of_value, [])

    found = {check.check.name: check.value for check in run_search(case, probe).checks}
    good_value, bad_value = (found[name] for name in ("search_good", "search_bad"))
    assert isinstance(good_value, float)
    assert isinstance(bad_value, float)
    assert good_value <= float(good) < bad_value <= good_value + 200


@pytest.mark.parametrize("verdict", [Verdict.ABORTED, Verdict.ERROR])
def test_a_probe_without_a_verdict_ends_the_search(
    write_plan: PlanWriter, verdict: Verdict
) -> None:
    (case,) = read_plan(write_plan(SEARCHES)).cases
    result = run_search(case, lambda one: CaseResult(one, verdict, []))
    assert (result.verdict, len(result.probes)) == (verdict, 1)


def test_values_have_the_decimals_of_the_cell(write_plan: PlanWriter) -> None:
    (case,) = read_plan(write_plan(f"{HEAD}\n{ROW.format('0.5 .. 3 to 0.25')}\n")).cases
    assert case.search is not None
    _, tried = searched(case.search, lambda value: value < 2)
    assert tried == ["0.50", "3.00", "1.75", "2.37", "2.06", "1.90"]
    probe = probe_of(case, 3, "1.75")
    assert (probe.run, probe.inputs) == ("probing-a-s03", {"plc:V.E.FEED": "1.75"})
    assert (probe.seed, probe.probe_of) == (case.seed, case.run)
    # What is wrong with a value that was tried is an error of the cell that searches it
    wrong, of_row = probe.error("odd", "plc:V.E.FEED"), case.error("odd", "search:plc:V.E.FEED")
    assert (wrong.line, wrong.column) == (of_row.line, of_row.column) == (2, 4)
    assert "column 'search:plc:V.E.FEED'" in str(wrong)
    assert [check.metric for check in probe.checks] == ["latch_error_um", "alarms"]
    assert [check.metric for check in case.checks] == ["search_good", "search_bad"]


def test_the_metrics_of_the_search_have_the_unit_of_the_column(write_plan: PlanWriter) -> None:
    head = "case,program,rig,search:plant:p.gap_um,check:search_good,check:latch_error_um,expect"
    row = "a,probe.nc,machine.toml,1 .. 9 to 1,> 4,<= 1,fail:search_bad"
    (case,) = read_plan(write_plan(f"{head}\n{row}\n")).cases
    assert [(c.metric, c.condition.text, c.unit) for c in case.checks] == [
        ("search_good", "> 4", "um"),
        ("search_bad", "1 .. 9", "um"),
    ]
    assert case.expected == ("search_bad",)


def test_an_expanded_plan_searches_the_same(write_plan: PlanWriter) -> None:
    head = "case,program,rig,set:Z.a_max,search:plc:V.E.FEED,check:latch_error_um"
    plan = read_plan(write_plan(f"{head}\na,probe.nc,machine.toml,[1 | 2],300 .. 900 to 9,<= 1\n"))
    again = read_plan(write_plan(expanded_text(plan)))
    assert [case.run for case in plan.cases] == ["probing-a-1", "probing-a-2"]
    for one, other in zip(plan.cases, again.cases, strict=True):
        assert one.search is not None
        assert other.search is not None
        assert (one.run, one.seed, one.inputs) == (other.run, other.seed, other.inputs)
        assert one.search.text == other.search.text
        for first, second in ((one, other), (one.search, other.search)):
            asked = [[(c.metric, c.condition) for c in row.checks] for row in (first, second)]
            assert asked[0] == asked[1]


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("300 .. 3000", "the search cannot be read"),
        ("300 .. 3000 step 10", "the search cannot be read"),
        ("300 .. 300 to 10", "the width is above 0 and less than the range"),
        ("300 .. 3000 to 0", "the width is above 0 and less than the range"),
        ("300 .. 3000 to 2700", "the width is above 0 and less than the range"),
        ("0 .. 999999999999 to 1", "the search takes 42 runs, more than 40"),
        ("0 .. 9999999999999 to 1", "more than 12 digits"),
    ],
)
def test_what_cannot_be_searched_is_refused(write_plan: PlanWriter, cell: str, words: str) -> None:
    path = write_plan(f"{HEAD}\n{ROW.format(cell)}\n")
    with pytest.raises(UserError) as caught:
        read_plan(path)
    assert words in caught.value.message
    assert (caught.value.file, caught.value.line) == (str(path), 2)


@pytest.mark.parametrize(
    ("header", "cells", "words"),
    [
        ("search:title", "1 .. 9 to 1", "not an input column"),
        (
            "search:plc:V.E.B,search:plc:V.E.A",
            "1 .. 9 to 1,1 .. 9 to 1",
            "a row searches one value",
        ),
        ("search:plc:V.E.A,plc:V.E.A", "1 .. 9 to 1,5", "the row sets plc:V.E.A, and searches it"),
        ("search:plant:p.x_um,plant:p.x_mm", "1 .. 9 to 1,5", "the row sets this twice"),
        ("check:search_good", "> 3", "the row searches nothing"),
    ],
)
def test_what_excludes_itself_is_refused(
    write_plan: PlanWriter, header: str, cells: str, words: str
) -> None:
    text = f"case,program,rig,{header},check:latch_error_um\na,probe.nc,machine.toml,{cells},<= 1\n"
    with pytest.raises(UserError, match=words):
        read_plan(write_plan(text))


def test_no_case_has_the_id_of_a_probe(write_plan: PlanWriter) -> None:
    rows = f"{ROW.format('1 .. 9 to 1')}\na-s{PROBES_MAX},probe.nc,machine.toml,,<= 1\n"
    with pytest.raises(UserError, match="a probe has this id"):
        read_plan(write_plan(f"{HEAD}\n{rows}"))


def test_the_command_line_does_not_set_what_is_searched(write_plan: PlanWriter) -> None:
    plan = read_plan(write_plan(f"{HEAD}\n{ROW.format('1 .. 9 to 1')}\n"))
    with pytest.raises(UserError, match="several values"):
        plan.with_inputs([parse_assignment("plc:V.E.FEED=3")])


@pytest.mark.parametrize(
    ("cell", "ends", "width"),
    [
        ("1 .. 3 to 0.5", ("1.0", "3.0"), "0.5"),
        ("0.25 .. 3 to 1", ("0.25", "3.00"), "1.00"),
        ("3 .. 0.5 to .125", ("3.000", "0.500"), "0.125"),
        ("-2 .. 10 to 4", ("-2", "10"), "4"),
    ],
)
def test_every_number_of_a_search_has_the_decimals_of_the_finest(
    write_plan: PlanWriter, cell: str, ends: tuple[str, str], width: str
) -> None:
    (case,) = read_plan(write_plan(f"{HEAD}\n{ROW.format(cell)}\n")).cases
    found = case.search
    assert found is not None
    assert (found.value(found.first), found.value(found.last)) == ends
    assert found.value(found.width) == width


@pytest.mark.parametrize("wider", [0, 1])
def test_a_search_may_take_forty_runs(write_plan: PlanWriter, wider: int) -> None:
    """Both ends, and 38 times half of 2^38."""
    path = write_plan(f"{HEAD}\n{ROW.format(f'0 .. {2**38 + wider} to 1')}\n")
    if wider:
        with pytest.raises(UserError, match="the search takes 41 runs, more than 40"):
            read_plan(path)
        return
    (case,) = read_plan(path).cases
    assert case.search is not None
    _, tried = searched(case.search, lambda value: value < 1)
    assert len(tried) == case.search.probes_max == PROBES_MAX


# What a row that searches says


def reached(case: Case, holds: Callable[[float], bool], column: str = "plc:V.E.FEED") -> CaseResult:
    def probe(one: Case) -> CaseResult:
        value = float(one.inputs[column])
        return CaseResult(one, Verdict.PASS if holds(value) else Verdict.FAIL, [])

    return run_search(case, probe)


def test_each_value_names_the_probe_that_tried_it(write_plan: PlanWriter) -> None:
    """Tried are 200, 3000, 1600, 900, 1250, 1425: the limit 1400 is between the last two."""
    result = reached(read_plan(write_plan(SEARCHES)).cases[0], lambda value: value <= 1400)
    assert [probe.case.run for probe in result.probes] == [
        f"probing-a-s{number:02}" for number in range(1, len(result.probes) + 1)
    ]
    tried = [probe.case.inputs["plc:V.E.FEED"] for probe in result.probes]
    assert tried == ["200", "3000", "1600", "900", "1250", "1425"]
    assert [(check.check.name, check.value, check.note) for check in result.checks] == [
        ("search_good", 1250.0, "pass in probing-a-s05"),
        ("search_bad", 1425.0, "fail in probing-a-s06"),
    ]
    assert (result.case.run, result.verdict) == ("probing-a", Verdict.PASS)


@pytest.mark.parametrize("holds", [True, False])
def test_without_a_limit_both_values_say_why_there_is_none(
    write_plan: PlanWriter, holds: bool
) -> None:
    """Two values were to be delivered and were not: the row fails."""
    result = reached(read_plan(write_plan(SEARCHES)).cases[0], lambda _: holds)
    words = "both ends of the search hold" if holds else "neither end of the search holds"
    assert [(check.value, check.note) for check in result.checks] == [
        (None, f"{words}: plc:V.E.FEED = 200 .. 3000 to 200")
    ] * 2
    assert (result.verdict, len(result.probes)) == (Verdict.FAIL, 2)


@pytest.mark.parametrize(
    ("good", "bad", "expect", "verdict"),
    [
        (">= 1000", "<= 2000", "", Verdict.PASS),
        (">= 2000", "<= 2000", "", Verdict.FAIL),
        (">= 1000", "<= 1000", "", Verdict.FAIL),
        (">= 2000", "<= 2000", "fail:search_good", Verdict.PASS),
        (">= 1000", "<= 2000", "fail:search_good", Verdict.FAIL),
        (">= 2000", "<= 1000", "fail:search_good", Verdict.FAIL),
        (">= 2000", "<= 1000", "fail:search_good fail:search_bad", Verdict.PASS),
    ],
)
def test_the_row_has_the_worst_verdict_of_its_two_values_or_what_it_expects(
    write_plan: PlanWriter, good: str, bad: str, expect: str, verdict: Verdict
) -> None:
    """The limit is between 1250 and 1425."""
    head = f"{HEAD},check:search_good,check:search_bad,expect"
    row = f"{ROW.format('200 .. 3000 to 200')},{good},{bad},{expect}"
    result = reached(read_plan(write_plan(f"{head}\n{row}\n")).cases[0], lambda at: at <= 1400)
    assert result.verdict is verdict


@pytest.mark.parametrize(("error", "why"), [("the FMU has crashed", "the FMU has crashed"),
                                            (None, "aborted")])  # fmt: skip
def test_a_probe_that_says_nothing_is_named_with_its_value_and_its_reason(
    write_plan: PlanWriter, error: str | None, why: str
) -> None:
    """The second one: the probe before it stays with the row."""
    (case,) = read_plan(write_plan(SEARCHES)).cases

    def probe(one: Case) -> CaseResult:
        if one.inputs["plc:V.E.FEED"] == "200":
            return CaseResult(one, Verdict.PASS, [])
        return CaseResult(one, Verdict.ABORTED, [], error=error)

    result = run_search(case, probe)
    assert result.error == f"the probe probing-a-s02 with plc:V.E.FEED = 3000: {why}"
    assert [one.verdict for one in result.probes] == [Verdict.PASS, Verdict.ABORTED]
    assert [check.value for check in result.checks] == [None, None]
