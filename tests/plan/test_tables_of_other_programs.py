"""Tables as other programs write them: titles, separators, merged cells, bytes, units."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.plan.test_workbooks import merged, row, xlsx

from axisrig.bench.plan.assignment import (
    parse_assignment,
    parse_column,
)
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.table import read_table
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = ("case", "program", "rig", "check:lag_mm_max:Z")
CASE = ("a", "probe.nc", "machine.toml", "1")


def refused(path: Path) -> UserError:
    with pytest.raises(UserError) as caught:
        read_table(path)
    return caught.value


# Titles and headers


@pytest.mark.parametrize(
    ("text", "line", "below", "value"),
    [
        ("Probe plan\ncase,program,rig\na,b,c\n", 1, 2, "Probe plan"),
        (",Probe plan,\ncase,program,rig\na,b,c\n", 1, 2, "Probe plan"),
        ("\n\n,,v2\n\ncase,program,rig\na,b,c\n", 3, 5, "v2"),
        ("# words\nProbe plan,\ncase,program,rig\na,b,c\n", 2, 3, "Probe plan"),
        ('"# words\nand more"\n"Probe\nplan",\n\ncase,program,rig\na,b,c\n', 3, 6, "Probe\nplan"),
        # Rows of another length than the title are no mistakes of their own
        ("Probe plan\nof,Monday\ncase,program,rig\na,b\nc,d,e,f\n", 1, 3, "Probe plan"),
    ],
)
def test_a_title_above_the_header_is_named_and_nothing_else(
    write_plan: PlanWriter, text: str, line: int, below: int, value: str
) -> None:
    error = refused(write_plan(text))
    assert error.message.startswith(f"row {line} is no header; that with 'case' is in row {below}")
    assert (error.line, error.value, error.further) == (line, value, ())


@pytest.mark.parametrize("word", ["Case", "CASE", "cAse"])
def test_a_header_in_other_letters_is_one_with_a_wrong_word(
    write_plan: PlanWriter, word: str
) -> None:
    """It is no title, even where a row below it has the word."""
    path = write_plan(f"{word},program,rig,title\na,probe.nc,machine.toml,x\ncase,b,c,d\n")
    assert list(read_table(path).columns) == [word, "program", "rig", "title"]
    with pytest.raises(UserError, match="unknown column") as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.column, caught.value.allowed) == (1, 1, "case")


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("# one, two, three, four, five\ncase;program;rig\na;b;c\n", ["case", "program", "rig"]),
        ("# one; two; three; four\ncase,program,rig\na,b,c\n", ["case", "program", "rig"]),
        ('\n# a ; b; c; d\ncase,"x; y ;z",rig\na,b,c\n', ["case", "x; y ;z", "rig"]),
        ('"# a, b, c";"x, y, z, w"\n"case";"program";"rig"\n', ["case", "program", "rig"]),
        ('" # a; b; c; d"\n"case","program","rig"\n', ["case", "program", "rig"]),
        ("case;note:a,b,c\na;b,x,y\n", ["case;note:a", "b", "c"]),  # what gives more cells
        ("case\na\n", ["case"]),
    ],
)
def test_the_separator_is_that_of_the_first_line_that_is_no_comment(
    write_plan: PlanWriter, text: str, columns: list[str]
) -> None:
    assert list(read_table(write_plan(text)).columns) == columns


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("case,program,rig\na,b\n", 2, "the row has 2 cells and the header 3"),
        ("case,program,rig\na,b,c,d\n", 2, "the row has 4 cells and the header 3"),
        ("case,program,rig,,\na,b,c\n", None, None),  # as many as there are names
        ("case,program,rig,,\na,b,c,,\n", None, None),
        ("case,program,rig,,\na,b,c,,,\n", 2, "the row has 6 cells and the header 5"),
        ("case,program,rig,,\na,b\n", 2, "the row has 2 cells and the header 3"),
        ('case,program,rig\n"a\n\nb",c,d\ne\n', 5, "the row has 1 cell and the header 3"),
        ("case,program,rig\n# a\n\n#,b\na,b,c\n", None, None),
    ],
)
def test_a_row_has_a_cell_for_each_name_and_no_more_than_the_header(
    write_plan: PlanWriter, text: str, line: int | None, message: str | None
) -> None:
    path = write_plan(text)
    if message is None:
        assert list(read_table(path).columns) == ["case", "program", "rig"]
        return
    error = refused(path)
    assert (error.line, error.message, error.further) == (line, message, ())


@pytest.mark.parametrize(
    ("reference", "is_refused"),
    [
        ("D2:F2", True),  # it begins in the last column and ends beside the table
        ("E2:F2", False),
        ("A3:A9", True),
        ("A4:A9", False),
        ("C1:C2", True),
    ],
)
def test_merged_cells_count_where_any_of_them_is_in_the_table(
    tmp_path: Path, reference: str, is_refused: bool
) -> None:
    path = xlsx(
        tmp_path / "p.xlsx", ("plan", row(*HEAD) + row(*CASE) + row("b", *CASE[1:])),
        after=merged(reference),
    )  # fmt: skip
    if is_refused:
        assert refused(path).message.startswith(f"cells {reference} are merged")
    else:
        assert len(read_table(path).rows) == 2


def test_each_range_of_merged_cells_is_a_mistake(tmp_path: Path) -> None:
    lines = row(*HEAD) + row(*CASE) + row("b", *CASE[1:])
    error = refused(xlsx(tmp_path / "p.xlsx", ("plan", lines), after=merged("C2:C3", "A2:B2")))
    found = [(one.line, one.column) for one in (error, *error.further)]
    assert found == [(2, 3), (2, 1)]


@pytest.mark.parametrize(
    ("text", "line"),
    [(b"case,program\n\xff,b\n", 2), (b"case,\xff\n", 1), (b"case\na\nb\n\xff", 4),
     (b"case\n\xe4\n\xf6\n", 2)],
)  # fmt: skip
def test_bytes_that_are_no_text_are_named_by_their_line(
    tmp_path: Path, text: bytes, line: int
) -> None:
    path = tmp_path / "p.csv"
    path.write_bytes(text)
    error = refused(path)
    assert (error.message, error.line) == ("the file is not UTF-8", line)
    assert error.hint == "save it as CSV UTF-8"


# Units and words


@pytest.mark.parametrize(
    ("text", "si"),
    [
        # As a reader reckons: 5e-6 of a float is 4.9999999999999996e-06
        ("plant:p.x_um=5", 5e-06), ("plant:p.x_mm=0.3", 0.0003), ("plant:p.x_um=0.7", 7e-07),
        ("plant:p.t_ns=3", 3e-09), ("plant:p.x_mm=-1.1", -0.0011),
        ("plant:p.share_percent=7", 0.07),
        ("plant:p.c_n_um=2", 2e6), ("plant:p.f_kn=1.5", 1500.0), ("plant:p.x=5", 5.0),
    ],
)  # fmt: skip
def test_a_value_in_its_unit_is_the_decimal_number_in_si(text: str, si: float) -> None:
    assert parse_assignment(text).si() == si


@pytest.mark.parametrize(
    ("column", "allowed"),
    [
        ("V.E.FEED", "plc:V.E.FEED"),
        ("v.e.feed", "plc:v.e.feed"),
        ("Z.kenngr.measure.edge", "set:Z.kenngr.measure.edge"),
        ("plant.p.x_mm", "plant:p.x_mm"),
        ("plc;V.E.FEED", "plc:V.E.FEED"),
        ("ste/Z.kenngr.a", "set:Z.kenngr.a"),
    ],
)
def test_a_column_without_its_kind_or_with_another_sign_is_named_with_it(
    column: str, allowed: str
) -> None:
    with pytest.raises(UserError, match="not an input column") as caught:
        parse_assignment(f"{column}=1")
    assert caught.value.allowed == allowed
    assert parse_column(allowed, "1").column == allowed


@pytest.mark.parametrize("text", [" set:Z.a = 5 ", "set:Z.a=5", "set:Z.a =  5"])
def test_blanks_around_column_and_value_are_none_of_them(text: str) -> None:
    found = parse_assignment(text)
    assert (found.column, found.value) == ("set:Z.a", "5")


@pytest.mark.parametrize(
    ("column", "name", "unit"),
    [("plant:p.speed_mm_s", "speed", "mm_s"), ("plant:p.a_n_s_m", "a", "n_s_m"),
     ("plant:p.s_s", "s", "s"), ("plant:p.mm", "mm", ""), ("plant:p.x_y_um", "x_y", "um")],
)  # fmt: skip
def test_the_longest_unit_at_the_end_of_a_variable_is_its_unit(
    column: str, name: str, unit: str
) -> None:
    found = parse_column(column, "1")
    assert (found.name, found.unit) == (name, unit)
