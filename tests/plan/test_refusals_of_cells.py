"""What the refusal of a cell shows: the cell or its value, what is allowed, what to write."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.plan.test_values_of_rows import refused

from axisrig.bench.plan.expansion import FORMS
from axisrig.bench.plan.info import parse_info
from axisrig.bench.plan.plan import read_plan, selected
from axisrig.kernel.errors import UserError

A, B = "plc:V.E.A", "plc:V.E.B"
BRACKETS = "then the first limit goes with the first value; [[ writes a bracket"


@pytest.mark.parametrize(
    ("cells", "message", "value", "allowed", "hint"),
    [
        ({A: "log(1, 2)"}, "log needs 3 numbers", "log(1, 2)", FORMS, None),
        ({A: "uniform"} | {B: "normal(1, x)"}, "normal needs 2 numbers", "normal(1, x)", FORMS,
         None),
        ({A: "normal(1, -0.5)"}, "the standard deviation is negative", "normal(1, -0.5)", None,
         None),
        ({A: "lhs(2, 2)"}, "the lower limit is not below", "lhs(2, 2)", None, None),
        ({A: "normal(1e999, 1)"}, "the number is too large", "normal(1e999, 1)", None, None),
        ({A: "x[1 | 2"}, "the list is not closed", "x[1 | 2", None, "[[ writes a bracket"),
        ({A: "x[ | ]"}, "the list is empty", "x[ | ]", FORMS, None),
        ({A: "[1 | | 2]"}, "a value of the list is missing", "[1 | | 2]", None,
         "- leaves the cell empty"),
        ({A: "[1 | log(1, 2, 3)]"}, "a list holds plain values", "log(1, 2, 3)", FORMS, None),
        ({A: "[1 | 2 | 1]"}, "a value is twice in the list", "1", None, None),
        ({A: "pairwise(5)"}, "pairwise(...) holds several values", "pairwise(5)",
         "pairwise(a | b), pairwise(300 .. 3000 step 300), pairwise(boundary(300, 3000, 1))",
         None),
        ({A: "[1 | 2]", B: "pairwise(3 | 4)", "expand": "zip"}, "with `zip` the first values",
         "pairwise(3 | 4)", None, "leave `expand` empty, or write a list in brackets"),
        ({A: "[1 | 2]", B: "[3 | 4 | 5]", "expand": "zip"}, "the list has 3 values and that of",
         "[3 | 4 | 5]", None, "with `zip` all lists of a row have the same length"),
        ({A: "[1 | 2]", "expand": "zap"}, "lists cannot go together like this", "zap",
         "product, zip", None),
        ({A: "[1 | 2]", "check:min": "[< 1 | < 2]"}, "a list in a condition needs `zip`",
         "[< 1 | < 2]", None, BRACKETS),
        ({A: "1", "check:min": "[< 1 | < 2]", "expand": "zip"},
         "the list of a condition goes with a list of values", "[< 1 | < 2]", None, None),
    ],
)  # fmt: skip
def test_a_cell_that_cannot_be_expanded_shows_itself_and_what_can(
    cells: dict[str, str], message: str, value: str, allowed: Any, hint: str | None
) -> None:
    error = refused(cells)
    assert error.message.startswith(message)
    assert (error.value, error.hint) == (value, hint)
    shown = ", ".join(allowed) if isinstance(allowed, list | tuple) else allowed
    found = error.allowed
    assert (", ".join(found) if isinstance(found, list | tuple) else found) == shown
    assert (str(error.file), error.line) == ("p.csv", 2)


@pytest.mark.parametrize(
    ("cell", "samples", "seed", "message", "value", "hint"),
    [
        ("5", 3, "1", "no cell of the row is lhs(...) or sobol(...)", "3", None),
        ("lhs(0, 1)", None, "1", "need the columns samples and seed", "lhs(0, 1)",
         "samples is missing"),
        ("sobol(0, 1)", 3, "", "need the columns samples and seed", "sobol(0, 1)",
         "seed is missing"),
        ("lhs(0, 1)", 3, "1 2", "the seed is one number", "1 2", None),
    ],
)  # fmt: skip
def test_points_need_their_number_and_their_seed(
    cell: str, samples: int | None, seed: str, message: str, value: str, hint: str | None
) -> None:
    cells = {A: cell, "samples": str(samples or ""), "seed": seed}
    error = refused(cells, samples=samples, seed=seed)
    assert message in error.message
    assert (error.value, error.hint) == (value, hint)


@pytest.mark.parametrize("text", ["device", "Device=1", "device=", "device= ", "=1", "1a=2"])
def test_a_fact_of_the_command_line_is_shown_with_good_ones(text: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_info(["serial=1", text])
    assert (caught.value.value, caught.value.hint) == (
        text, "--info device=axis-z --info serial=0042",
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    return tmp_path


def plan_of(folder: Path, *lines: str) -> Path:
    path = folder / "p.csv"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


def test_an_expression_that_fits_no_case_is_shown_with_where_they_are_listed(folder: Path) -> None:
    path = plan_of(folder, "case,program,rig,check:alarms", "a,a.nc,r.toml,none")
    with pytest.raises(UserError, match="no case fits") as caught:
        selected(read_plan(path), "b")
    assert caught.value.value == "b"
    assert caught.value.hint == f"axisrig check {path} -v lists the cases"
    assert selected(read_plan(path), "b", may_be_none=True).cases == ()


@pytest.mark.parametrize(
    ("head", "row", "message", "hint"),
    [
        ("check:cpk(latch_error_um)", ">= 1.33", "the row has no limits for latch_error_um",
         "fill its cell in check:latch_error_um, or write"),
        ("plc:V.E.F,check:slope(latch_error_um; plc:V.E.F)", "600,<= 1",
         "all runs of the case have one value of plc:V.E.F",
         "give the cell several values, as [300 | 600 | 1200]"),
    ],
)  # fmt: skip
def test_a_statistic_that_cannot_be_says_what_to_write(
    folder: Path, head: str, row: str, message: str, hint: str
) -> None:
    path = plan_of(folder, f"case,program,rig,repeats,{head}", f"a,a.nc,r.toml,3,{row}")
    with pytest.raises(UserError) as caught:
        read_plan(path)
    assert caught.value.message.startswith(message)
    assert str(caught.value.hint).startswith(hint)
    assert (caught.value.file, caught.value.line) == (str(path), 2)


@pytest.mark.parametrize(
    ("module", "name", "message", "shown"),
    [
        ("def mine(r): ...", "own.py", "the module has no metric",
         ("p.csv", 2, "own.py", None, "def metric_<name>(recording): ...")),
        ("\ndef metric_alarms(r): ...", "own.py", "axisrig has a metric of this name",
         ("own.py", 2, "alarms", None, None)),
        ("x = 1\ndef metric_mine(r)", "own.py", "the module cannot be read: expected ':'",
         ("own.py", 2, None, None, None)),
        ("def metric_mine(r): ...", "somewhere", "no Python file, and no entry point",
         ("p.csv", 2, "somewhere", "a file *.py",
          "entry points are those of the group axisrig.metrics")),
    ],
)  # fmt: skip
def test_a_module_of_own_metrics_that_cannot_be_is_shown_at_its_place(
    folder: Path, module: str, name: str, message: str,
    shown: tuple[str, int, str | None, str | None, str | None],
) -> None:  # fmt: skip
    """In the module where it is about a line of it, else in the plan."""
    (folder / "own.py").write_text(module, encoding="utf-8")
    path = plan_of(folder, "case,program,rig,module,check:alarms", f"a,a.nc,r.toml,{name},none")
    with pytest.raises(UserError) as caught:
        read_plan(path)
    error = caught.value
    assert error.message.startswith(message)
    assert (Path(str(error.file)).name, error.line) == shown[:2]
    assert (error.value, error.allowed, error.hint) == shown[2:]


@pytest.mark.parametrize("column", [A, B])
@pytest.mark.parametrize("is_set", [False, True])
def test_the_error_of_a_case_has_all_of_its_parts_wherever_its_value_comes_from(
    folder: Path, column: str, is_set: bool
) -> None:
    """A value of the command line has no place in the plan."""
    path = plan_of(folder, f"case,program,rig,{A},{B},check:alarms", "a,a.nc,r.toml,1,2,none")
    (case,) = read_plan(path).cases
    case = replace(case, overridden=frozenset({column} if is_set else ()))
    error = case.error("not so", column, value="x", allowed="1 to 3", hint="write 2")
    assert (error.value, error.allowed, error.hint) == ("x", "1 to 3", "write 2")
    if is_set:
        assert error.message == f"--set {column}={case.inputs[column]}: not so"
        assert (error.file, error.line, error.column) == (None, None, None)
    else:
        assert error.message.startswith("not so (case 'a', column ")
        assert (error.file, error.line, error.column) == (str(path), 2, 4 + (column == B))
