"""What the refusal of a series, of a choice of cases, of a statistic or of a table shows."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.test_values_of_rows import refused

from axisrig.bench.plan import series
from axisrig.bench.plan.select import only
from axisrig.bench.plan.series import FORMS
from axisrig.bench.plan.statistic_checks import parse_any_check
from axisrig.bench.plan.table import read_table
from axisrig.kernel.errors import UserError

LIST = "`axisrig metrics` lists them all"


@pytest.mark.parametrize(
    ("cell", "message", "allowed", "hint"),
    [
        ("1 .. 3 step 1 mm", "the range cannot be read", FORMS, None),
        ("1 .. 3", "a range of values needs a step", None,
         "1 .. 3 step ...; without it it is a condition, which belongs in check:"),
        ("1 .. 3 step 0", "the step does not lead from the first value", None, None),
        ("1 .. 3 step -1", "the step does not lead from the first value", None, None),
        ("1 .. 4 step 2", "the range does not end with a whole step", None,
         "the last step before it ends at 3"),
        ("0 .. 1 step 1e-5", "100001 runs are more than 100000", None, None),
        ("1 .. 1e30000 step 1", "1E+30000 runs are more than 100000", None, None),
        ("log(0, 1, 3)", "the ends of log(...) are two different numbers above 0", None, None),
        ("log(2, 2, 3)", "the ends of log(...) are two different numbers above 0", None, None),
        ("log(1, 2, 1)", "log(...) needs a whole number of values, 2 or more", None, None),
        ("log(1, 2, 2.5)", "log(...) needs a whole number of values, 2 or more", None, None),
        ("boundary(0, 1, 0.6)", "boundary(first, last, step) needs a step above 0", None, None),
        ("boundary(0, 1, 0)", "boundary(first, last, step) needs a step above 0", None, None),
    ],
)  # fmt: skip
def test_a_series_that_cannot_be_shows_its_cell(
    cell: str, message: str, allowed: str | None, hint: str | None
) -> None:
    error = refused({"plc:V.E.A": cell})
    assert error.message.startswith(message)
    assert (error.value, error.allowed, error.hint) == (cell, allowed, hint)
    assert error.column == 4


def test_a_range_may_have_as_many_values_as_a_plan_has_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(series, "RUNS_MAX", 3)
    error = refused({"plc:V.E.A": "1 .. 4 step 1"})
    assert error.message.startswith("4 runs are more than 3")
    assert error.value == "1 .. 4 step 1"
    monkeypatch.setattr(series, "RUNS_MAX", 4)
    from_log = refused({"plc:V.E.A": "log(1, 2, 5)"})
    assert from_log.value == "log(1, 2, 5)"


def case(run: str) -> Any:
    name, _, _ = run.partition("-")
    return SimpleNamespace(case=name, run=run, title="", tags=frozenset(), inputs={})


@pytest.mark.parametrize(
    ("expression", "message", "allowed"),
    [
        ("c-9", "-k 'c-9' has to name one case, 0 fit", "a-1, a-2, b-1"),
        ("a", "-k 'a' has to name one case, 2 fit", "a-1, a-2"),
        ("a and (", "-k 'a and (' cannot be read at", "words, and, or, not, brackets"),
    ],
)
def test_who_has_to_choose_one_case_is_shown_those_that_fit_or_all(
    expression: str, message: str, allowed: str
) -> None:
    with pytest.raises(UserError) as caught:
        only([case("a-1"), case("a-2"), case("b-1")], expression)
    assert caught.value.message.startswith(message)
    found = caught.value.allowed
    assert (found if isinstance(found, str) else ", ".join(map(str, found or ()))) == allowed


@pytest.mark.parametrize(
    ("metric", "message", "value"),
    [
        ("maen(latch_error_um)", "unknown statistic", "maen"),
        ("mean(alarms)", "a statistic needs a metric that is a number", "alarms"),
    ],
)
def test_a_statistic_that_is_none_is_shown_with_where_they_are_listed(
    metric: str, message: str, value: str
) -> None:
    with pytest.raises(UserError) as caught:
        parse_any_check(metric, "<= 1", "")
    assert (caught.value.message, caught.value.value, caught.value.hint) == (message, value, LIST)


def test_a_table_that_is_none_is_shown_with_its_kind(tmp_path: Path) -> None:
    (tmp_path / "p.txt").touch()
    (tmp_path / "p.xlsx").write_bytes(b"no workbook")
    with pytest.raises(UserError, match="not a table") as caught:
        read_table(tmp_path / "p.txt")
    assert (caught.value.file, caught.value.value) == (str(tmp_path / "p.txt"), ".txt")
    assert ".csv" in str(caught.value.allowed)
    with pytest.raises(UserError, match="the workbook cannot be read") as caught:
        read_table(tmp_path / "p.xlsx")
    assert caught.value.file == str(tmp_path / "p.xlsx")
    assert caught.value.hint
    with pytest.raises(UserError, match="there is no such file") as caught:
        read_table(tmp_path / "p.csv")
    assert caught.value.file == str(tmp_path / "p.csv")
    assert caught.value.hint == f"looked in {tmp_path}"
