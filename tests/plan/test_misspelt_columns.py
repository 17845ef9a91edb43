"""Columns of a plan that are misspelt, missing or there twice: each is one mistake."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]


def mistakes(path: Path) -> list[UserError]:
    with pytest.raises(UserError) as caught:
        read_plan(path)
    return [caught.value, *caught.value.further]


def places(path: Path) -> list[tuple[str, int | None, int | None]]:
    return [(one.message, one.line, one.column) for one in mistakes(path)]


@pytest.mark.parametrize(
    ("written", "meant", "column"),
    [
        ("csae", "case", 1), ("Case", "case", 1), ("programm", "program", 2),
        ("progam", "program", 2), ("rgi", "rig", 3), ("rigg", "rig", 3),
    ],
)  # fmt: skip
def test_a_misspelt_column_that_each_plan_needs_is_one_mistake(
    write_plan: PlanWriter, written: str, meant: str, column: int
) -> None:
    head = ["case", "program", "rig"]
    head[column - 1] = written
    (error,) = mistakes(write_plan(f"{','.join(head)}\na,probe.nc,machine.toml\n"))
    assert (error.message, error.line, error.column) == ("unknown column", 1, column)
    assert error.value == written
    assert re.search(rf"did you mean: {meant}\b", str(error))


def test_columns_that_are_misspelt_and_others_that_are_missing_come_in_their_order(
    write_plan: PlanWriter,
) -> None:
    path = write_plan("case,progam,Rig\na,probe.nc,machine.toml\n")
    assert places(path) == [("unknown column", 1, 2), ("unknown column", 1, 3)]
    path = write_plan("case,progam\na,probe.nc\n")
    assert places(path) == [("column 'rig' is missing", 1, None), ("unknown column", 1, 2)]


def test_a_column_that_means_nothing_known_stands_for_none_that_is_missing(
    write_plan: PlanWriter,
) -> None:
    """`rig` is not near: both are reported, the header with every column that there is."""
    path = write_plan("case,program,xyzzy\na,probe.nc,machine.toml\n")
    missing, unknown = mistakes(path)
    assert missing.message == "column 'rig' is missing"
    assert missing.hint is not None
    assert "rig file, path relative to the folder of the plan" in missing.hint
    assert (unknown.message, unknown.value) == ("unknown column", "xyzzy")
    assert (unknown.allowed or "").startswith("case, program, rig, title")


def test_a_misspelt_column_beside_the_right_one_hides_nothing(write_plan: PlanWriter) -> None:
    path = write_plan("case,program,rig,rigg\na,probe.nc,machine.toml,x\n")
    assert places(path) == [("unknown column", 1, 4)]


@pytest.mark.parametrize("doubled", ["title", "rig"])
def test_a_column_that_is_there_twice_is_reported_at_the_last_one(
    write_plan: PlanWriter, doubled: str
) -> None:
    path = write_plan(f"case,program,rig,title,{doubled}\na,probe.nc,machine.toml,x,y\n")
    assert places(path) == [("the column is given twice", 1, 5)]


def _including(folder: Path, part: str, head: str = "case,program,rig") -> Path:
    """Write a plan that includes a table: its row fills rig alone."""
    (folder / "part.csv").write_text(part, encoding="utf-8")
    (folder / "main.csv").write_text(f"{head}\ninclude,part.csv,machine.toml\n", encoding="utf-8")
    return folder / "main.csv"


def test_an_included_table_need_not_have_what_its_row_gives(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    write_plan("")
    (case,) = read_plan(_including(tmp_path, "case,program\na,probe.nc\n")).cases
    assert (case.run, case.rig) == ("main-a", tmp_path / "machine.toml")


def test_a_misspelt_column_of_an_included_table_is_one_mistake_with_the_row_that_includes_it(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    write_plan("")
    (error,) = mistakes(_including(tmp_path, "case,progam\na,probe.nc\n"))
    assert error.message == "unknown column (included by main.csv:2)"
    assert (error.file, error.line, error.column) == (str(tmp_path / "part.csv"), 1, 2)
    (error,) = mistakes(_including(tmp_path, "case,title\na,x\n"))
    assert error.message == "column 'program' is missing (included by main.csv:2)"
    assert (error.file, error.line, error.column) == (str(tmp_path / "part.csv"), 1, None)
    (error,) = mistakes(_including(tmp_path, "case,program,title,title\na,probe.nc,x,y\n"))
    assert error.message == "the column is given twice (included by main.csv:2)"


def test_a_row_that_empties_what_the_including_row_gives_lacks_it(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    write_plan("")
    (error,) = mistakes(_including(tmp_path, "case,program,rig\na,probe.nc,-\nb,probe.nc,\n"))
    assert "the value is missing" in error.message
    assert "column 'rig'" in str(error)
    assert (error.line, error.column) == (2, 3)


def test_the_program_of_a_row_that_includes_is_no_default_of_the_table(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    """It names the table."""
    write_plan("")
    (error,) = mistakes(_including(tmp_path, "case,program\na,\n"))
    assert (error.file, error.line, error.column) == (str(tmp_path / "part.csv"), 2, 2)


def test_a_header_comes_after_comments_and_is_named_by_its_own_line(
    write_plan: PlanWriter,
) -> None:
    path = write_plan("# one\n# two\ncase,program,rgi\na,probe.nc,machine.toml\n")
    assert places(path) == [("unknown column", 3, 3)]
    path = write_plan("# one\ncase,program\na,probe.nc\n")
    assert places(path) == [("column 'rig' is missing", 2, None)]


@pytest.mark.parametrize(
    ("metric", "cell", "messages"),
    [
        (
            "latch_eror_um",
            "1 .. 0",
            ["unknown metric", "the lower limit of the condition is above"],
        ),
        ("latch_eror_um", "<= 1", ["unknown metric"]),
        ("nothing_like_it", "<= 1e999", ["unknown metric", "the limit of the condition is too"]),
        ("latch_error_um", "1 .. 0", ["the lower limit of the condition is above"]),
    ],
)
def test_all_that_is_wrong_with_a_check_is_named_at_its_cell(
    write_plan: PlanWriter, metric: str, cell: str, messages: list[str]
) -> None:
    """The metric of the header, and the condition."""
    found = mistakes(
        write_plan(f"case,program,rig,title,check:{metric}\na,probe.nc,machine.toml,t,{cell}\n")
    )
    assert [(one.line, one.column) for one in found] == [(2, 5)] * len(messages)
    assert len(found) == len(messages)
    assert all(one.message.startswith(words) for one, words in zip(found, messages, strict=True))
    assert all(f"(column 'check:{metric}')" in one.message for one in found)
