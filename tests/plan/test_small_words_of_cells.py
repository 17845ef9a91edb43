"""Cells that are nearly right, and what is written once: searches, expectations, hints, columns."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from axisrig.bench.plan.assignment import column_forms, find_form, meant_columns
from axisrig.bench.plan.checks import parse_condition
from axisrig.bench.plan.expectation import parse_expectation
from axisrig.bench.plan.hints import condition_hint, several_hint
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.searching import parse_search
from axisrig.bench.plan.sheets import read_parquet
from axisrig.bench.plan.table import Cell, Place
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]
PLACE = Place(Path("p.csv"), 2, 4, "search:plc:V.E.A")


def cell(text: str) -> Cell:
    return Cell(text, PLACE)


# A search


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        ("100000000000 .. 999999999999 to 99999999999", True),  # 12 digits each
        ("-999999999999 .. -100000000000 to 99999999999", True),  # a sign is no digit
        ("-99999999999.9 .. 99999999999.9 to 99999999999", True),
        ("0 .. 1000000000000 to 100000000000", False),
        ("-1000000000000 .. 0 to 100000000000", False),
        ("0 .. 100000000000.00 to 10000000000", False),
    ],
)
def test_a_search_has_twelve_digits_whatever_its_signs_are(text: str, fits: bool) -> None:
    if fits:
        search = parse_search("search:plc:V.E.A", cell(text), {})
        assert float(search.value(search.first)) == float(text.split(" ", maxsplit=1)[0])
        return
    with pytest.raises(UserError, match="more than 12 digits"):
        parse_search("search:plc:V.E.A", cell(text), {})


# An expectation


@pytest.mark.parametrize(
    ("text", "metrics"),
    [
        ("fail:latch_error_um", ("latch_error_um",)),
        ("fail:latch_error_um fail:latch_error_um", ("latch_error_um",)),
        ("fail:lag_mm_max:Z latch_error_um lag_mm_max:Z", ("lag_mm_max:Z", "latch_error_um")),
        ("fail:latch_error_um, lag_mm_max:Z; latch_error_um", ("latch_error_um", "lag_mm_max:Z")),
    ],
)
def test_a_metric_that_is_expected_twice_is_expected_once(
    text: str, metrics: tuple[str, ...]
) -> None:
    checks: Any = [type("Check", (), {"metric": name}) for name in
                   ("lag_mm_max:Z", "latch_error_um")]  # fmt: skip
    assert parse_expectation(cell(text), checks) == metrics


# Conditions in other notations


@pytest.mark.parametrize("word", ["true", "True", "TRUE", "false", "False", "fALSE"])
def test_a_truth_value_is_written_as_a_comparison(word: str) -> None:
    assert condition_hint(word) == f"write == {word.upper()}"
    with pytest.raises(UserError) as caught:
        parse_condition(word, "number")
    assert caught.value.hint == f"write == {word.upper()}"


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("≤ 0.5", "write <= 0.5"),
        ("=< 0.5", "write <= 0.5"),
        ("≥3", "write >= 3"),
        ("=> 3", "write >= 3"),
        ("≠ 3", "write != 3"),
        ("<> 3", "write != 3"),
        ("1 … 2", "write 1 .. 2"),
        ("1...2", "write 1 .. 2"),
        ("<= \N{EN DASH}5", "write <= -5"),
        ("\N{MINUS SIGN}1 .. 2", "write -1 .. 2"),
        ("<= 0,5", "a decimal point, not a comma"),
        ("<= 0.5", None),
        ("truth", None),
    ],
)
def test_signs_of_other_notations_have_their_own(text: str, hint: str | None) -> None:
    assert condition_hint(text) == hint


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("300:3000:300", "300 .. 3000 step 300"),
        ("300:300:3000", "300 .. 3000 step 300"),
        ("3000:300:-300", "3000 .. 300 step -300"),
        ("0:1:0.3", "300 .. 3000 step 300"),  # no whole steps: an example
        ("5:5:1", "300 .. 3000 step 300"),
        ("1 2 3", "[1 | 2 | 3]"),
        ("1;2", "[1 | 2]"),
        ("-1.5/+2e3", "[-1.5 | +2e3]"),
        ("1", None),
        ("1 two", None),
    ],
)
def test_several_numbers_in_a_cell_are_a_range_or_a_list(text: str, hint: str | None) -> None:
    """A hint for a range leads from its first value to its last one in whole steps."""
    found = several_hint(text)
    assert found is None if hint is None else found is not None and found.endswith(hint)


# Columns


@pytest.mark.parametrize("name", ["V.E.FEED", "v.e.feed", "V.e.Feed"])
def test_a_variable_without_its_kind_is_of_the_plc_in_any_letters(name: str) -> None:
    assert list(meant_columns(name, column_forms())) == [f"plc:{name}"]


@pytest.mark.parametrize("name", ["Z.kenngr.measure.edge", "X.lr_param.kv"])
def test_a_parameter_without_its_kind_is_set(name: str) -> None:
    assert find_form(f"set:{name}") is not None
    assert list(meant_columns(name, column_forms())) == [f"set:{name}"]


# Parquet


def test_numbers_of_a_parquet_file_are_written_as_a_cell_would_have_them(tmp_path: Path) -> None:
    """Whole ones up to 2^53 without a point; beyond that a float has no units any more."""
    values = [1.0, -0.5, 600.0, 2.0**53 - 1, -(2.0**53) + 1, 2.0**53, 1e300, math.nan]
    path = tmp_path / "p.parquet"
    pd.DataFrame({"case": [str(n) for n in range(len(values))], "x": values}).to_parquet(path)
    found = [row[1] for row in read_parquet(path)]
    assert found == [
        "x", "1", "-0.5", "600", "9007199254740991", "-9007199254740991",
        repr(2.0**53), "1e+300", "",
    ]  # fmt: skip


def test_what_has_no_value_in_a_parquet_file_is_empty(tmp_path: Path) -> None:
    path = tmp_path / "p.parquet"
    frame = pd.DataFrame({
        "case": ["a", None, " b "],
        "n": pd.array([1, None, 3], dtype="Int64"),
        "t": pd.to_datetime(pd.Series(["2026-01-02", None, "2026-01-03"])),
        "flag": np.array([True, False, True]),
    })  # fmt: skip
    frame.to_parquet(path)
    rows = read_parquet(path)
    assert rows[0] == ["case", "n", "t", "flag"]
    assert [row[0] for row in rows[1:]] == ["a", "", "b"]
    assert [row[1] for row in rows[1:]] == ["1", "", "3"]
    assert [bool(row[2]) for row in rows[1:]] == [True, False, True]
    assert [row[3] for row in rows[1:]] == ["True", "False", "True"]


# A plan


def test_a_search_of_a_negative_range_is_read_in_a_plan(write_plan: PlanWriter) -> None:
    head = "case,program,rig,search:plc:V.E.A,check:lag_mm_max:Z,check:search_good"
    path = write_plan(f"{head}\na,probe.nc,machine.toml,-5 .. -25 to 4,<= 1,\n")
    (case,) = read_plan(path).cases
    assert case.search is not None
    assert [case.search.value(end) for end in (case.search.first, case.search.last)] == [
        "-5", "-25",
    ]  # fmt: skip
    # 20 wide: 10, 5, 3 and then 3 is within 4; two ends before
    assert case.search.probes_max == 2 + 3
    good, bad = case.checks[:2]
    assert (good.metric, bad.metric) == ("search_good", "search_bad")
    assert good.condition.text == bad.condition.text == "-25 .. -5"
