"""Rows whose cells stand for several values: what goes together, in which order, with edges."""

import re
from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path

import pytest
from scipy.stats import qmc

from axisrig.bench.plan import expansion
from axisrig.bench.plan.composition import MeantRow
from axisrig.bench.plan.expansion import Variant, draw, variants
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.table import Cell, Place
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]


def of_row(
    cells: Mapping[str, str], *, repeats: int = 1, samples: int | None = None, seed: str = ""
) -> tuple[int, list[Variant]]:
    """How many runs a row stands for, and these; cells by column, conditions in `check:`."""
    places = {
        column: Place(Path("p.csv"), 2, number, column) for number, column in enumerate(cells, 4)
    }
    known = {column: Cell(text, places[column]) for column, text in cells.items()}
    row = MeantRow(Place(Path("p.csv"), 2, 1, "case"), known)
    checks = [column for column in cells if column.startswith("check:")]
    inputs = [c for c in cells if c not in (*checks, "expand", "samples", "seed")]
    count, made = variants(row, inputs, checks, repeats=repeats, samples=samples, seed=seed)
    return count, list(made)


def texts(cells: Mapping[str, str]) -> list[tuple[str, ...]]:
    """The cells of each run, in the order of the columns."""
    count, found = of_row(cells)
    assert count == len(found)
    columns = [column for column in cells if column != "expand"]
    return [tuple(one.texts.get(column, "") for column in columns) for one in found]


def refused(cells: Mapping[str, str], **more: object) -> UserError:
    with pytest.raises(UserError) as caught:
        of_row(cells, **more)  # type: ignore[arg-type]
    return caught.value


# Single cells


@pytest.mark.parametrize(
    ("cell", "values"),
    [
        ("log(8, 1, 4)", ["8", "4", "2", "1"]),
        ("log(1, 8, 2)", ["1", "8"]),
        ("3 .. 1 step -1", ["3", "2", "1"]),
        ("boundary(0, 2, 1)", ["0", "1", "2"]),  # the step fits in twice: the middle comes once
        ("boundary(0, 3, 1)", ["0", "1", "1.5", "2", "3"]),
        ("boundary(-5, 5, 5)", ["-5", "0", "5"]),
        ("boundary(0, 10, 0.25)", ["0", "0.25", "5", "9.75", "10"]),
        ("1e10 .. 3e10 step 1e10", ["10000000000", "20000000000", "30000000000"]),
        ("1e11 .. 2e11 step 1e11", ["1E+11", "2E+11"]),
        ("1e-10 .. 2e-10 step 1e-10", ["0.0000000001", "0.0000000002"]),
        ("1e-11 .. 2e-11 step 1e-11", ["1E-11", "2E-11"]),
        ("-1 .. 1 step 1", ["-1", "0", "1"]),
        ("a[[b[1 | 2]c[[", ["a[b1c[", "a[b2c["]),
        ("[-]", [""]),
        ("-[1 | 2]", ["-1", "-2"]),
    ],
)
def test_ends_and_steps_of_a_series_are_as_they_are_written(cell: str, values: list[str]) -> None:
    assert texts({"plc:V.E.A": cell}) == [(value,) for value in values]


@pytest.mark.parametrize(
    ("cell", "message", "value", "hint"),
    [
        ("[300; 600 | 900]", "a list has bars between its values", "[300; 600 | 900]",
         "several values are a list with bars: [300 | 600]"),
        ("[1;2;3]", "a list has bars between its values", "[1;2;3]",
         "several values are a list with bars: [1 | 2 | 3]"),
        ("pairwise(a[b]c)", "pairwise(...) holds several values", "pairwise(a[b]c)", None),
        ("pairwise([1 | 2])", "a list holds plain values", "[1", None),
        ("normal(0, 1e999)", "the number is too large", "normal(0, 1e999)", None),
        ("lhs(5, 1)", "the lower limit is not below the upper one", "lhs(5, 1)", None),
        ("boundary(0, 1.9, 1)", "boundary(first, last, step) needs a step above 0",
         "boundary(0, 1.9, 1)", None),
        ("boundary(0, 4, 0)", "boundary(first, last, step) needs a step above 0",
         "boundary(0, 4, 0)", None),
        ("boundary(4, 0, 1)", "boundary(first, last, step) needs a step above 0",
         "boundary(4, 0, 1)", None),
        ("log(-1, 4, 3)", "the ends of log(...) are two different numbers above 0",
         "log(-1, 4, 3)", None),
        ("log(1, 4, 2.5)", "log(...) needs a whole number of values", "log(1, 4, 2.5)", None),
        ("5 .. 1 step -3", "the range does not end with a whole step", "5 .. 1 step -3",
         "the last step before it ends at 2"),
        ("log(1, x, 3)", "log needs 3 numbers", "log(1, x, 3)", None),
        ("lhs(1, 2, 3)", "lhs needs 2 numbers", "lhs(1, 2, 3)", None),
    ],
)  # fmt: skip
def test_a_cell_that_cannot_be_meant_names_what_is_wrong(
    cell: str, message: str, value: str, hint: str | None
) -> None:
    error = refused({"plc:V.E.A": cell})
    assert error.message.startswith(message)
    assert (error.value, error.hint, error.line, error.column) == (value, hint, 2, 4)


# Several cells


def test_without_lists_a_row_is_one_run_also_where_lists_would_go_together() -> None:
    for expand in ({}, {"expand": "zip"}, {"expand": "product"}):
        count, (one,) = of_row({**expand, "plc:V.E.A": "5", "plc:V.E.B": "-"})
        assert (count, one.label, one.number, dict(one.swept)) == (1, "", 0, {})
        assert (one.texts["plc:V.E.A"], one.texts.get("plc:V.E.B")) == ("5", None)


def test_the_last_column_is_the_fastest_and_lists_in_one_cell_are_as_columns() -> None:
    cells = {"plc:V.E.A": "[1 | 2]-[3 | 4]", "plc:V.E.B": "[a | b]"}
    wanted = [(f"{a}-{b}", c) for a, b, c in product("12", "34", "ab")]
    assert texts(cells) == wanted
    swapped = {column: cells[column] for column in reversed(cells)}
    assert texts(swapped) == [(c, f"{a}-{b}") for c, a, b in product("ab", "12", "34")]


def test_values_of_zip_go_together_in_conditions_and_in_several_lists_of_a_cell() -> None:
    cells = {
        "expand": "zip", "plc:V.E.A": "[1 | 2]/[3 | 4]", "plc:V.E.B": "10 .. 20 step 10",
        "check:lag_mm_max": "<= [0.1 | 0.2]", "check:alarms": "none",
    }  # fmt: skip
    assert texts(cells) == [("1/3", "10", "<= 0.1", "none"), ("2/4", "20", "<= 0.2", "none")]
    _, (first, second) = of_row(cells)
    assert dict(first.swept) == {"plc:V.E.A": "1/3", "plc:V.E.B": "10"}  # no condition
    assert [first.label, second.label] == ["1_3-10", "2_4-20"]


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [
        ("[1 | 2]", "[1 | 2 | 3]", "the list has 3 values and that of plc:V.E.A 2"),
        ("[1 | 2 | 3]", "[1 | 2]", "the list has 2 values and that of plc:V.E.A 3"),
        ("[1 | 2]", "1 .. 5 step 1", "the list has 5 values and that of plc:V.E.A 2"),
    ],
)
def test_lists_that_go_together_are_equally_long(first: str, second: str, words: str) -> None:
    cells = {"expand": "zip", "plc:V.E.A": first, "plc:V.E.B": second}
    error = refused(cells)
    assert error.message.startswith(words)
    assert (error.value, error.column) == (second, 6)
    assert error.hint == "with `zip` all lists of a row have the same length"


def test_a_list_in_an_assignment_is_named_by_it(write_plan: PlanWriter) -> None:
    head = "case,program,rig,expand,inputs,plc:V.E.B"
    text = f"{head}\na,probe.nc,machine.toml,zip,plc:V.E.A=[1 | 2],[1 | 2 | 3]\n"
    with pytest.raises(UserError, match=r"and that of plc:V\.E\.A 2"):
        read_plan(write_plan(text))


def test_pairs_are_beside_other_lists_in_the_order_of_the_columns() -> None:
    """A list between two cells of pairwise(...): its values with each row of pairs."""
    cells = {
        "plc:V.E.A": "pairwise(1 | 2)", "plc:V.E.B": "[x | y]", "plc:V.E.C": "pairwise(7 | 8 | 9)",
    }  # fmt: skip
    found = texts(cells)
    assert len(found) == len(set(found)) == 2 * 6
    assert {(a, c) for a, _, c in found} == set(product("12", "789"))
    assert {(b, a, c) for a, b, c in found} == {(b, *p) for b in "xy" for p in product("12", "789")}


def test_limits_of_runs_count_all_that_multiplies(monkeypatch: pytest.MonkeyPatch) -> None:
    """2 values, 3 points, 4 repeats; the cell with most lists is named."""
    cells = {"plc:V.E.A": "[1 | 2]", "plc:V.E.B": "lhs(0, 1)", "samples": "3", "seed": "1"}
    monkeypatch.setattr(expansion, "RUNS_MAX", 24)
    count, found = of_row(cells, repeats=4, samples=3, seed="1")
    assert count == len(found) == 24
    assert [one.number for one in found] == [*range(1, 13)] * 2
    monkeypatch.setattr(expansion, "RUNS_MAX", 23)
    error = refused(cells, repeats=4, samples=3, seed="1")
    assert error.message.startswith("24 runs are more than ")
    assert (error.value, error.column) == ("[1 | 2]", 4)
    pairs = {"plc:V.E.A": "5", "plc:V.E.B": "[1 | 2][1 | 2 | 3]", "plc:V.E.C": "[1 | 2 | 3 | 4]"}
    assert refused(pairs).value == "[1 | 2][1 | 2 | 3]"


def test_pairs_of_the_two_longest_lists_are_counted_wherever_they_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(expansion, "RUNS_MAX", 19)
    cells = {
        "plc:V.E.A": "pairwise(1 | 2)", "plc:V.E.B": "pairwise(1 | 2 | 3 | 4)",
        "plc:V.E.C": "pairwise(1 | 2 | 3 | 4 | 5)",
    }  # fmt: skip
    error = refused(cells)
    assert error.message.startswith("20 runs are more than ")
    assert error.value == "pairwise(1 | 2)"


def test_samples_and_repeats_of_a_point_follow_each_other() -> None:
    cells = {"plc:V.E.A": "sobol(0, 1)", "samples": "2", "seed": "7"}
    _, found = of_row(cells, repeats=2, samples=2, seed="7")
    values = [one.texts["plc:V.E.A"] for one in found]
    assert values[0] == values[1] != values[2] == values[3]
    assert [one.number for one in found] == [1, 2, 3, 4]
    _, (one,) = of_row({**cells, "samples": "1"}, samples=1, seed="7")
    assert one.number == 1  # a single sample is counted too, a single repeat is not
    _, (plain,) = of_row({"plc:V.E.A": "5"})
    assert plain.number == 0


def test_each_sampled_column_has_its_own_place_in_the_points() -> None:
    """In whatever order they are: those of `lhs` are one cube, those of `sobol` one sequence."""
    cells = {
        "plc:V.E.A": "sobol(0, 1)", "plc:V.E.B": "lhs(0, 1)", "plc:V.E.C": "sobol(0, 10)",
        "plc:V.E.D": "lhs(-1, 0)", "samples": "4", "seed": "3",
    }  # fmt: skip
    _, found = of_row(cells, samples=4, seed="3")
    sobol = qmc.Sobol(d=2, seed=3).random(4)
    cube = qmc.LatinHypercube(d=2, seed=3).random(4)
    for point, one in enumerate(found):
        values = [float(one.texts[f"plc:V.E.{name}"]) for name in "ABCD"]
        wanted = [sobol[point, 0], cube[point, 0], 10 * sobol[point, 1], cube[point, 1] - 1]
        assert values == pytest.approx(wanted, abs=5e-10)  # ten digits of a number below 10


@pytest.mark.parametrize(("samples", "seed", "lacks"), [(None, "7", "samples"), (4, "", "seed")])
def test_samples_say_what_they_lack(samples: int | None, seed: str, lacks: str) -> None:
    error = refused({"plc:V.E.A": "lhs(0, 1)"}, samples=samples, seed=seed)
    assert error.message.startswith("lhs(...) and sobol(...) need the columns samples and seed")
    assert (error.hint, error.value) == (f"{lacks} is missing", "lhs(0, 1)")


def test_a_value_that_is_drawn_belongs_to_its_column_and_its_seed() -> None:
    drawn = {(column, seed): draw(column, 10.0, 2.0, seed) for column in "ab" for seed in (1, 2)}
    assert len(set(drawn.values())) == 4
    assert draw("a", 10.0, 2.0, 1) == drawn["a", 1]
    # The same draw of the standard normal distribution, in another place and width. Ten digits
    # of about 10 round by 5e-9: a quarter of that here, and 5e-10 of its own
    z = (float(drawn["a", 1]) - 10.0) / 2.0
    assert float(draw("a", -3.0, 0.5, 1)) == pytest.approx(-3.0 + 0.5 * z, abs=2e-9)


# Ids


def test_labels_that_differ_in_case_alone_or_are_long_get_a_hash_of_columns_and_values() -> None:
    _, found = of_row({"plc:V.E.A": "[Up | up | down]"})
    assert found[2].label == "down"
    assert all(re.fullmatch(r"[Uu]p-[0-9a-f]{8}", one.label) for one in found[:2])
    _, other = of_row({"plc:V.E.B": "[Up | up | down]"})
    assert {one.label for one in found[:2]}.isdisjoint(one.label for one in other[:2])
    exact, longer = "x" * 60, "y" * 61
    _, (short, long) = of_row({"plc:V.E.A": f"[{exact} | {longer}]"})
    assert short.label == exact
    assert re.fullmatch(r"y{40}-[0-9a-f]{8}", long.label)


def test_an_empty_value_has_its_sign_in_the_id() -> None:
    _, (empty, full) = of_row({"plc:V.E.A": "[- | 5]", "plc:V.E.B": "[7]"})
    assert (empty.label, full.label) == ("--7", "5-7")
    assert "plc:V.E.A" not in empty.texts


@pytest.mark.parametrize(
    ("condition", "text"),
    [("== [[done]", "== [done]"), ("== [done]", "== [done]"), ("1 .. 2", "1 .. 2"),
     ("log(1, 2, 3)", "log(1, 2, 3)")],
)  # fmt: skip
def test_a_condition_is_itself_where_nothing_goes_together(condition: str, text: str) -> None:
    _, found = of_row({"plc:V.E.A": "[1 | 2]", "check:msg:N10": condition})
    assert [one.texts["check:msg:N10"] for one in found] == [text, text]
