"""Rows, searches, statistics and expectations that are refused: place, value and what helps."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from axisrig.bench.plan import plan as plans
from axisrig.bench.plan.checks import CheckResult, parse_check
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.plan import counted, read_plan
from axisrig.bench.plan.searching import check_of_search
from axisrig.bench.plan.statistic_checks import parse_any_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]
HEAD, ROW = "case,program,rig", "probe.nc,machine.toml"


def mistakes(path: Path) -> list[UserError]:
    with pytest.raises(UserError) as caught:
        read_plan(path)
    return [caught.value, *caught.value.further]


def mistake(write_plan: PlanWriter, head: str, cells: str, name: str = "a") -> UserError:
    (found,) = mistakes(write_plan(f"{HEAD},{head}\n{name},{ROW},{cells}\n"))
    return found


# Searches

SEARCH = "search:plc:V.E.A"


@pytest.mark.parametrize(
    ("cell", "words", "value", "hint"),
    [
        ("1 .. 10 by 1", "the search cannot be read", True, None),
        ("5 .. 5 to 1", "the width is above 0 and less than the range", True, None),
        ("1 .. 10 to 9", "the width is above 0 and less than the range", True, None),
        ("10 .. 1 to 9", "the width is above 0 and less than the range", True, None),
        ("1 .. 10 to 0", "the width is above 0 and less than the range", True, None),
        ("1 .. 10 to -1", "the width is above 0 and less than the range", True, None),
        ("1 .. 1000000000000 to 1000000", "more than 12 digits", True, None),
        ("1000000000000 .. 1 to 1000000", "more than 12 digits", True, None),
        ("0 .. 0.0000000000001 to 0.00000000000001", None, False, None),
        (
            "0 .. 549755813888 to 1",
            "the search takes 41 runs, more than 40",
            True,
            "make the range",
        ),
    ],
)
def test_a_search_that_cannot_be_made_shows_its_cell(
    write_plan: PlanWriter, cell: str, words: str | None, value: bool, hint: str | None
) -> None:
    """2^39 steps take two ends and 39 halvings."""
    if words is None:
        read_plan(write_plan(f"{HEAD},{SEARCH},check:duration_s\na,{ROW},{cell},<= 1\n"))
        return
    error = mistake(write_plan, f"{SEARCH},check:duration_s", f"{cell},<= 1")
    assert words in error.message
    assert (error.line, error.column, error.value) == (2, 4, cell if value else None)
    assert (error.hint or "").startswith(hint or "-" if hint else "")
    if "width" in words or "read" in words:
        assert error.allowed == "300 .. 3000 to 10"


@pytest.mark.parametrize(
    ("cell", "most"),
    [("1 .. 10 to 8", 3), ("10 .. 1 to 8", 3), ("0 .. 274877906944 to 1", 40), ("0 .. 8 to 1", 5)],
)
def test_a_search_takes_its_ends_and_a_halving_each(
    write_plan: PlanWriter, cell: str, most: int
) -> None:
    plan = read_plan(write_plan(f"{HEAD},{SEARCH},check:duration_s\na,{ROW},{cell},<= 1\n"))
    search = plan.cases[0].search
    assert search is not None
    assert search.probes_max == most


def test_only_an_input_that_the_row_does_not_set_is_searched(write_plan: PlanWriter) -> None:
    for column in ("title", "note:who", "plc"):
        error = mistake(write_plan, f"search:{column},check:duration_s", "1 .. 10 to 1,<= 1")
        assert "not an input column" in error.message
        assert (error.line, error.column, error.value) == (2, 4, column)
    error = mistake(write_plan, f"{SEARCH},plc:V.E.A,check:duration_s", "1 .. 10 to 1,3,<= 1")
    assert "the row sets plc:V.E.A, and searches it" in error.message
    assert (error.line, error.column, error.value) == (2, 4, "1 .. 10 to 1")
    two = mistake(write_plan, f"{SEARCH},search:plc:V.E.B,check:duration_s",
                  "1 .. 10 to 1,1 .. 10 to 1,<= 1")  # fmt: skip
    assert "a row searches one value" in two.message
    assert two.column == 5
    lone = mistake(write_plan, "check:search_good", "<= 1")
    assert (lone.value, lone.hint) == ("search_good", "it needs a column search:<column>")


def test_what_a_search_has_found_has_a_meaning() -> None:
    for name, word in (("search_good", " holds"), ("search_bad", "does not hold")):
        found = check_of_search(name, "<= 1", "here").definition
        assert word in found.meaning
        assert (found.name, found.type, found.scope) == (name, "number", "run")


# Statistics


@pytest.mark.parametrize(
    ("metric", "value", "allowed"),
    [
        ("meen(latch_mm)", "meen", "mean"),
        ("mean(latch_mm; 3)", "mean(latch_mm; 3)", "mean(metric)"),
        ("cg(latch_mm)", "cg(latch_mm)", "cg(metric; tolerance)"),
        ("mean()", "mean()", "mean(metric)"),
        ("mean(detection_criterion)", "detection_criterion", None),
        ("cp(latch_mm; 5 .. 5)", "5 .. 5", "-0.5 .. 0.5, <= 0.5, >= -0.5"),
        ("cp(latch_mm; != 5)", "!= 5", "-0.5 .. 0.5, <= 0.5, >= -0.5"),
        ("cg(latch_mm; 0)", "0", "a number above 0"),
        ("spread_p(latch_mm; -1)", "-1", "a number above 0"),
        ("bias(latch_mm; latch_error_um)", "mm and um", None),
        (
            "slope(latch_mm; title)",
            "title",
            "a column of the plan such as plc:V.E.FEED, run, touch",
        ),
        ("share(latch_mm; latch_mm)", "latch_mm", "a column of the plan such as plc:V.E.FEED, run"),
    ],
)
def test_a_statistic_that_cannot_be_asked_for_shows_what_is_wrong(
    metric: str, value: str, allowed: str | None
) -> None:
    with pytest.raises(UserError) as caught:
        parse_any_check(metric, "<= 1", "here")
    assert caught.value.value == value
    assert (caught.value.allowed or "").startswith(allowed or "")
    assert bool(caught.value.allowed) == bool(allowed)


@pytest.mark.parametrize(
    ("metric", "unit"),
    [
        ("cg(latch_mm; 0.5)", ""),
        ("slope(latch_mm; plant:probe.speed_mm_s)", "mm/(mm_s)"),
        ("slope(latch_mm; run)", "mm/run"),
        ("slope(msg:N30; touch)", "1/touch"),
        ("slope(latch_mm; plc:V.E.FEED)", "mm/(plc:V.E.FEED)"),
        ("slope(latch_mm; error_frames)", "mm/(error_frames)"),
        ("slope(latch_mm; reaction_ms)", "mm/ms"),
        ("drift(error_frames)", "1/value"),
        ("drift(latch_mm)", "mm/value"),
    ],
)
def test_a_statistic_has_its_unit(metric: str, unit: str) -> None:
    found = parse_any_check(metric, "<= 1", "here").unit
    assert found == unit or (unit == "mm/(mm_s)" and found == "mm/mm_s")


# Expectations


@pytest.mark.parametrize(
    ("cell", "value", "allowed"),
    [
        ("error", "error", "fail:<metric>, several separated by blanks"),
        (",", ",", "fail:<metric>, several separated by blanks"),
        ("fail:latch_nm", "latch_nm", "latch_mm"),
        ("fail:", "fail:", "latch_mm, alarms"),
        ("fail:latch_mm fail:far_from_all", "far_from_all", "latch_mm, alarms"),
    ],
)
def test_an_expectation_that_cannot_be_met_shows_what_can(
    write_plan: PlanWriter, cell: str, value: str, allowed: str
) -> None:
    error = mistake(write_plan, "expect,check:latch_mm", f'"{cell}",<= 1')
    assert (error.line, error.column, error.value, error.allowed) == (2, 4, value, allowed)
    assert bool(error.hint) == (value in ("error", ","))


def result(metric: str, verdict: Verdict, note: str = "") -> CheckResult:
    return CheckResult(parse_check(metric, "<= 1", "here"), 2.0, 0.0, verdict, note)


def test_what_must_fail_is_noted_beside_what_was_said() -> None:
    checks = [result("latch_mm", Verdict.FAIL, "why"), result("duration_s", Verdict.MARGINAL)]
    verdict, found = met(("latch_mm",), Verdict.FAIL, checks)
    assert verdict is Verdict.MARGINAL
    assert [one.note for one in found] == ["was expected to fail; why", ""]
    verdict, found = met(("latch_mm", "duration_s"), Verdict.FAIL, checks)
    assert verdict is Verdict.FAIL
    assert [one.note for one in found] == [
        "was expected to fail; why", "was expected to fail, and did not",
    ]  # fmt: skip
    for expected, given in (((), Verdict.FAIL), (("latch_mm",), Verdict.ABORTED),
                            (("latch_mm",), Verdict.ERROR)):  # fmt: skip
        assert met(expected, given, checks) == (given, checks)
    verdict, _ = met(("latch_mm",), Verdict.FAIL, checks[:1])
    assert verdict is Verdict.PASS


# Rows


def test_a_wrong_check_that_must_fail_is_one_mistake(write_plan: PlanWriter) -> None:
    error = mistake(write_plan, "check:latch_mm,expect", "about 3,fail:latch_mm")
    assert error.value == "about 3"


def test_a_row_without_a_name_or_a_file_is_one_mistake(write_plan: PlanWriter) -> None:
    for line, column in ((f",{ROW}", 1), ("a,,machine.toml", 2), ("a,probe.nc,", 3)):
        (error,) = mistakes(write_plan(f"{HEAD}\n{line}\n"))
        assert "the value is missing" in error.message
        assert (error.line, error.column) == (2, column)
    (error,) = mistakes(write_plan("case,program\na,probe.nc\nb,probe.nc\n"))
    assert error.message == "column 'rig' is missing"
    assert (error.line, error.column) == (1, None)
    assert error.hint


def test_names_become_file_names(write_plan: PlanWriter, tmp_path: Path) -> None:
    error = mistake(write_plan, "title", "x", name="a b")
    assert (error.line, error.column, error.value) == (2, 1, "a b")
    assert error.allowed is not None
    assert error.allowed.startswith("letters, digits, _ . -; * gives defaults")
    path = write_plan(f"{HEAD}\na,{ROW}\n", name="a plan.csv")
    (error,) = mistakes(path)
    assert (error.file, error.value, error.allowed) == (
        str(path), "a plan", "letters, digits, _ . -",
    )  # fmt: skip


def test_parts_of_a_name_are_short_so_that_the_id_of_a_run_is(write_plan: PlanWriter) -> None:
    """At most 60 signs for plan, case and values each, and a number."""
    stem, name, label = "p" * 60, "n" * 60, "v" * 60
    text = f"{HEAD},plc:V.E.A,repeats\n{name},{ROW},[{label} | w],2\n"
    runs = [case.run for case in read_plan(write_plan(text, name=f"{stem}.csv")).cases]
    assert runs[0] == f"{stem}-{name}-{label}-001"
    for long in (f"{HEAD}\n{name}x,{ROW}\n", text):
        (error,) = mistakes(write_plan(long, name="p.csv" if long is not text else f"{stem}p.csv"))
        assert error.value == (f"{stem}p" if long is text else f"{name}x")


def test_a_run_is_made_once(write_plan: PlanWriter) -> None:
    """File systems that ignore case would let the second one overwrite the first."""
    (error,) = mistakes(write_plan(f"{HEAD}\na,{ROW}\nb,{ROW}\nA,{ROW}\n"))
    assert (error.line, error.value) == (4, "probing-A")
    assert "the case makes the same run as line 2 (" in error.message


def test_a_plan_has_as_many_runs_as_are_allowed(
    write_plan: PlanWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plans, "RUNS_MAX", 3)
    text = f"{HEAD},repeats\na,{ROW},2\nb,{ROW},"
    assert len(read_plan(write_plan(f"{text}1\n")).cases) == 3
    (error,) = mistakes(write_plan(f"{text}2\n"))
    assert (error.line, error.value) == (3, 4)
    assert "the plan has more than 3 runs" in error.message


@pytest.mark.parametrize(
    ("column", "cell", "allowed"),
    [
        ("repeats", "0", "1 to 999"),
        ("repeats", "1000", "1 to 999"),
        ("repeats", "1.5", "1 to 999"),
        ("repeats", "-1", "1 to 999"),
        ("seed", "4294967296", "0 to 4294967295"),
        ("seed", "x", "0 to 4294967295"),
        ("samples", "0", "1 to 100000"),
    ],
)
def test_whole_numbers_are_in_their_range(
    write_plan: PlanWriter, column: str, cell: str, allowed: str
) -> None:
    error = mistake(write_plan, column, cell)
    assert (error.line, error.column, error.value, error.allowed) == (2, 4, cell, allowed)


def test_seeds_count_up_and_begin_again(write_plan: PlanWriter) -> None:
    last = 2**32 - 1
    plan = read_plan(write_plan(f"{HEAD},repeats,seed\na,{ROW},3,{last}\nb,{ROW},1,0\n"))
    assert [case.seed for case in plan.cases] == [last, 0, 1, 0]


def test_a_variable_in_two_units_is_set_twice(write_plan: PlanWriter) -> None:
    head = "plant:p.stroke_mm,plant:p.stroke_um"
    error = mistake(write_plan, head, "1,2")
    assert (error.column, error.value, error.hint) == (
        5, "plant:p.stroke_um", "also plant:p.stroke_mm",
    )  # fmt: skip
    searched = mistake(write_plan, "plant:p.stroke_mm,search:plant:p.stroke_um,check:duration_s",
                       "1,1 .. 10 to 1,<= 1")  # fmt: skip
    assert searched.value == "search:plant:p.stroke_um"
    assert searched.hint == "also plant:p.stroke_mm"


def test_a_cell_with_several_assignments_shows_the_wrong_one(write_plan: PlanWriter) -> None:
    for column, cell, value, allowed in (
        ("inputs", "plc:V.E.A=1 ;; plc:V.E.B", "plc:V.E.B", "COLUMN=VALUE"),
        ("checks", "latch_mm <= 1 ;; duration_s", "duration_s", "METRIC=CONDITION"),
        ("inputs", "plc:V.E.A=1 ;; title=x", "title", None),
        ("inputs", "plc:V.E.A=1 ;; check:latch_mm=3", "check:latch_mm", None),
    ):
        error = mistake(write_plan, column, f'"{cell}"')
        assert (error.line, error.column, error.value) == (2, 4, value)
        assert error.allowed
        assert allowed is None or error.allowed == allowed
        assert allowed is not None or "requirement" not in error.allowed
    twice = mistake(write_plan, "inputs,plc:V.E.A", "plc:V.E.A=1,2")
    assert "plc:V.E.A is given twice" in twice.message
    assert twice.value == "2"
    assert twice.hint is not None
    assert twice.hint.startswith("the other one is in ")


def test_mistakes_are_in_the_order_of_their_places(write_plan: PlanWriter, tmp_path: Path) -> None:
    """Those of the plan first, whatever the name of an included table is."""
    (tmp_path / "a-first.csv").write_text(f"{HEAD},repeats\nx,{ROW},0\n", encoding="utf-8")
    text = f"{HEAD},seed,repeats\ninclude,a-first.csv,,,\nb,{ROW},x,0\nc,gone.nc,machine.toml,,\n"
    found = [
        (Path(one.file or "").name, one.line, one.column) for one in mistakes(write_plan(text))
    ]
    assert found == [("probing.csv", 3, 4), ("probing.csv", 3, 5), ("probing.csv", 4, 2),
                     ("a-first.csv", 2, 4)]  # fmt: skip


def test_a_file_that_is_not_there_says_what_is_near(write_plan: PlanWriter, tmp_path: Path) -> None:
    (near,) = mistakes(write_plan(f"{HEAD}\na,prbe.nc,machine.toml\n"))
    assert (near.value, near.hint) == ("prbe.nc", "near it: probe.nc")
    (far,) = mistakes(write_plan(f"{HEAD}\na,else/where.nc,machine.toml\n"))
    assert far.hint == f"looked in {tmp_path / 'else'}"
    lost = mistakes(write_plan(f"{HEAD}\ninclude,,\n"))
    assert "the table to include is missing" in lost[0].message
    assert lost[0].hint == "its path belongs in 'program'"
    (itself,) = mistakes(write_plan(f"{HEAD}\ninclude,probing.csv,\n"))
    assert "the table includes itself" in itself.message
    assert (itself.line, itself.value) == (2, "probing.csv")


def test_an_empty_plan_has_no_case(write_plan: PlanWriter) -> None:
    path = write_plan(f"{HEAD}\n")
    (error,) = mistakes(path)
    assert (error.message, error.file, error.hint) == (
        "the plan has no case", str(path), "add a row below the header",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("runs", "statistics", "words"),
    [
        (1, 0, "1 run"), (0, 0, "0 runs"), (2, 0, "2 runs"),
        (1, 1, "1 run and 1 row of statistics"),
        (4, 2, "4 runs and 2 rows of statistics"),
    ],
)  # fmt: skip
def test_runs_are_counted_in_words(runs: int, statistics: int, words: str) -> None:
    assert counted(runs, statistics) == words


def test_cells_of_a_parquet_file_are_what_they_were(tmp_path: Path) -> None:
    (tmp_path / "probe.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "machine.toml").write_text("[machine]\n", encoding="utf-8")
    rows = [("a", 1.0, "x", 7), ("b", 0.5, None, None), ("c", float("nan"), " y ", 8),
            ("d", -(2.0**60), "", 9), ("e", 2.0**53 - 1, "z", 10)]  # fmt: skip
    frame = pd.DataFrame(
        [(name, "probe.nc", "machine.toml", a, title, seed) for name, a, title, seed in rows],
        columns=[*HEAD.split(","), "plc:V.E.A", "title", "seed"],
    )
    frame["seed"] = frame["seed"].astype("Int64")
    path = tmp_path / "stored.parquet"
    frame.to_parquet(path)
    cases = read_plan(path).cases
    assert [case.inputs.get("plc:V.E.A") for case in cases] == [
        "1", "0.5", None, repr(-(2.0**60)), str(2**53 - 1),
    ]  # fmt: skip
    assert [case.title for case in cases] == ["x", "", "y", "", "z"]
    assert [case.seed for case in cases][::2] == [7, 8, 10]
    path.write_bytes(b"PAR1 no more")
    (error,) = mistakes(path)
    assert (error.message, error.file) == ("the Parquet file cannot be read", str(path))
    assert error.hint
