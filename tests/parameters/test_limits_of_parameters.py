"""The limits of every parameter, and what becomes of a value beside them."""

import csv
from importlib import resources
from typing import Any

import pytest

from axisrig.kernel import parameters
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import INTEGER_RANGES, KINDS, Origin, Parameter, table

HERE = Origin("some.lst", 4, 3)
ROWS = [row for kind in KINDS for row in table(kind).parameters]
NUMBERS = [row for row in ROWS if row.type != "STRING"]


def written_rows() -> dict[tuple[str, str], dict[str, str]]:
    """The tables as they are written, by kind and path."""
    found = {}
    for each in resources.files(parameters).joinpath("tables").iterdir():
        if each.name.endswith(".csv"):
            for row in csv.DictReader(each.read_text(encoding="utf-8").splitlines()):
                found[row["kind"], row["path"]] = row
    return found


WRITTEN = written_rows()


def refused(row: Parameter, text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        row.accept(text, HERE)
    error = caught.value
    assert (error.file, error.line, error.column, error.value) == ("some.lst", 4, 3, text)
    assert str(error.allowed) == row.allowed
    return error


def limits(row: Parameter) -> tuple[float | None, float | None, bool]:
    """Least and largest value as the table has them, and whether the least is none itself."""
    cells = WRITTEN[row.kind, row.path]
    low, high = INTEGER_RANGES.get(row.type, (None, None))
    least, is_open = cells["min"].removeprefix(">"), cells["min"].startswith(">")
    return float(least) if least else low, float(cells["max"]) if cells["max"] else high, is_open


def step(row: Parameter, value: float) -> float:
    """How far beside a limit the next value is."""
    return 1.0 if row.type in INTEGER_RANGES else max(abs(value), 1.0) * 1e-9


def shown(row: Parameter, value: float) -> str:
    return str(round(value)) if row.type in INTEGER_RANGES else repr(value)


def test_a_number_may_be_each_of_its_limits_and_nothing_beside_them() -> None:
    """A limit with `>` is none itself; what has a list of values takes these alone."""
    for row in NUMBERS:
        if row.values:
            continue
        low, high, is_open = limits(row)
        for limit, outwards in ((low, -1), (high, 1)):
            if limit is None:
                continue
            beside = outwards * step(row, limit)
            taken, outside = limit, limit + beside
            if is_open and limit == low:
                taken, outside = limit - beside, limit
            assert row.accept(shown(row, taken), HERE) == pytest.approx(taken), row.path
            error = refused(row, shown(row, outside))
            assert error.message == f"value of {row.label} is outside its range"


def test_a_value_of_a_list_of_values_is_one_of_them() -> None:
    for row in ROWS:
        for value in row.values:
            assert row.is_within(row.accept(value, HERE)), row.path
        if row.values and row.type == "STRING":
            refused(row, "NO_SUCH_WORD")
            assert row.is_within(row.default), row.path
            assert row.allowed == ", ".join(row.values)
        elif row.values:
            assert not row.is_within(float(max(map(float, row.values))) + 1.0), row.path


ABOVE_0 = {
    # path: what 0 becomes, the largest value, the range in words
    ("axis", "kenngr.dist_ctrl[i].kp"): (0.001, 2.0, "above 0.0, up to 2.0"),
    ("channel", "dist_ctrl[i].kp"): (0.001, 2.0, "above 0.0, up to 2.0"),
}


def test_which_parameters_have_to_be_above_their_limit() -> None:
    """P-AXIS-00759, P-AXIS-00784, P-CHAN-00821 and P-CHAN-00827: gains and shares of a filter."""
    found = {row.number for row in ROWS if row.is_open}
    assert found == {"P-AXIS-00759", "P-AXIS-00784", "P-CHAN-00821", "P-CHAN-00827"}
    assert {row.minimum for row in ROWS if row.is_open} == {0.0}


@pytest.mark.parametrize(("kind", "path"), ABOVE_0)
def test_a_gain_of_0_is_no_gain(kind: Any, path: str) -> None:
    low, high, allowed = ABOVE_0[kind, path]
    row = table(kind).row(path)
    assert row is not None
    assert row.allowed == allowed
    for value, is_within, becomes in (
        (0.0, False, low), (-1.0, False, low), (1e-9, True, None), (high, True, None),
        (high + 1e-9, False, high), (100.0, False, high),
    ):  # fmt: skip
        assert row.is_within(value) is is_within, value
        if not is_within:
            assert row.corrected(value) == becomes, value
    refused(row, "0")


def test_what_is_corrected_becomes_the_nearer_limit_or_what_the_table_has() -> None:
    for row in NUMBERS:
        fix = row.correction
        if fix is None or row.values:
            continue
        low, high, is_open = limits(row)
        if high is not None:
            above = high + step(row, high)
            expected = above if fix.is_kept else high
            assert row.corrected(above) == pytest.approx(expected, rel=1e-12), row.path
        if low is not None:
            below = low - step(row, low)
            if fix.is_kept:
                assert row.corrected(below) == below
            elif fix.is_above_only:
                assert row.corrected(below) is None, row.path
            elif fix.low is not None:
                assert row.corrected(below) == fix.low, row.path
            else:
                assert not is_open
                assert row.corrected(below) == low, row.path


def test_what_has_no_correction_stays_refused() -> None:
    for row in ROWS:
        if row.correction is None:
            assert row.corrected(1e300) is None
            assert row.corrected("word") is None


@pytest.mark.parametrize(
    ("text", "types"),
    [
        ("ten", ("BOOL", "UNS16", "SGN32", "REAL64")), ("1.5", ("BOOL", "UNS16", "SGN32")),
        ("1,5", ("REAL64", "SGN32")), ("", ("REAL64", "UNS32")),
    ],
)  # fmt: skip
def test_what_is_no_number_of_the_type_is_refused_with_its_type(
    text: str, types: tuple[str, ...]
) -> None:
    for name in types:
        row = next(row for row in ROWS if row.type == name)
        error = refused(row, text)
        assert error.message == f"{row.label} takes a value of type {name}"
