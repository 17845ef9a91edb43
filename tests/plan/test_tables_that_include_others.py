"""Tables included in a plan: mistakes in them, or in the row that includes them, and where."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig"
ROW = "probe.nc,machine.toml"


@pytest.fixture
def place(write_plan: PlanWriter, tmp_path: Path) -> Path:
    write_plan("")
    (tmp_path / "parts").mkdir()
    return tmp_path


def write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


def mistakes_of(path: Path) -> list[UserError]:
    with pytest.raises(UserError) as caught:
        read_plan(path)
    return [caught.value, *caught.value.further]


@pytest.mark.parametrize("cell", ["", "-"])
def test_a_row_that_includes_nothing_says_where_the_table_belongs(place: Path, cell: str) -> None:
    """The rows below it are read all the same."""
    path = write(place / "p.csv", HEAD, f"include,{cell},machine.toml", f"b,{ROW}", "c,none.nc,-")
    first, second, third = mistakes_of(path)
    assert first.message.startswith("the table to include is missing")
    assert (first.line, first.column, first.hint) == (2, 1, "its path belongs in 'program'")
    assert [(one.line, one.column) for one in (second, third)] == [(4, 2), (4, 3)]


def test_each_mistake_of_an_included_table_names_the_row_that_includes_it(place: Path) -> None:
    """Also where the table has no rows to read: two of them are too short."""
    table = place / "parts" / "t.csv"
    write(table, HEAD, "a,../probe.nc", "b,../probe.nc,../machine.toml", "c")
    path = write(place / "p.csv", HEAD, f"x,{ROW}", "include,parts/t.csv,")
    found = mistakes_of(path)
    assert [(one.file, one.line) for one in found] == [(str(table), 2), (str(table), 4)]
    assert [one.message for one in found] == [
        "the row has 2 cells and the header 3 (included by p.csv:3)",
        "the row has 1 cell and the header 3 (included by p.csv:3)",
    ]
    assert len({one.hint for one in found}) == 1
    assert found[0].hint is not None


def test_mistakes_of_the_plan_come_before_those_of_its_tables(place: Path) -> None:
    """Each table by line and column, whichever row has included it first."""
    for name in ("b", "a"):
        write(place / "parts" / f"{name}.csv", "case,program,seed", "x y,../probe.nc,-1")
    path = write(
        place / "p.csv", HEAD, "include,parts/b.csv,machine.toml", "include,parts/a.csv,-",
        "w w,probe.nc,machine.toml",
    )  # fmt: skip
    found = [(Path(str(one.file)).name, one.line, one.column) for one in mistakes_of(path)]
    assert found == [
        ("p.csv", 4, 1),
        ("a.csv", 1, None),  # nothing gives it a rig
        *(("a.csv", 2, 1), ("a.csv", 2, 3), ("b.csv", 2, 1), ("b.csv", 2, 3)),
    ]


def test_a_circle_of_several_tables_is_refused_where_it_closes(place: Path) -> None:
    parts = place / "parts"
    write(parts / "a.csv", HEAD, "include,b.csv,")
    write(parts / "b.csv", HEAD, "include,../p.csv,")
    path = write(place / "p.csv", HEAD, "include,parts/a.csv,")
    (error,) = mistakes_of(path)
    assert error.message.startswith("the table includes itself")
    assert (error.file, error.line, error.column) == (str(parts / "b.csv"), 2, 2)
    assert error.value == "../p.csv"
    assert "included by a.csv:2, included by p.csv:2" in error.message


def test_a_table_that_is_included_twice_is_no_circle(place: Path) -> None:
    write(place / "parts" / "t.csv", "case,program", "x,../probe.nc")
    line = "include,parts/t.csv,machine.toml"
    (error,) = mistakes_of(write(place / "p.csv", HEAD, line, line))
    assert error.message.startswith("the case makes the same run as line 2 (")


def test_files_of_an_included_table_are_named_by_the_shortest_way(place: Path) -> None:
    """From the folder of the table; a plan keeps what its own cell says."""
    write(place / "parts" / "t.csv", HEAD, "a,../parts/../probe.nc,../machine.toml")
    path = write(place / "p.csv", HEAD, "include,parts/t.csv,", f"b,parts/../{ROW}")
    a, b = read_plan(path).cases
    assert (a.program, a.rig) == (place / "probe.nc", place / "machine.toml")
    assert str(b.program) == str(place / "parts" / ".." / "probe.nc")
    assert (a.folder, a.file) == (place, place / "parts" / "t.csv")


def test_a_file_that_is_missing_is_named_as_its_cell_has_it(place: Path) -> None:
    write(place / "parts" / "t.csv", HEAD, "a,prob.nc,../machine.toml")
    (place / "parts" / "probe.nc").touch()
    (error,) = mistakes_of(write(place / "p.csv", HEAD, "include,parts/t.csv,"))
    assert error.message.startswith("there is no such program file")
    assert (error.value, error.line, error.column) == ("prob.nc", 2, 2)
    assert "probe.nc" in str(error.hint)


def test_defaults_of_a_table_end_with_it_and_begin_with_those_of_its_row(place: Path) -> None:
    """A row `*` replaces the one before it, and not what the row that includes gives."""
    write(
        place / "parts" / "t.csv",
        "case,program,set:Z.a,set:Z.b,set:Z.c", "w,../probe.nc,,,", "*,,1,2,", "x,../probe.nc,,,",
        "*,,,3,", "y,../probe.nc,,,", "z,../probe.nc,-,-,-",
    )  # fmt: skip
    path = write(
        place / "p.csv", f"{HEAD},set:Z.a,set:Z.b,set:Z.c",
        "include,parts/t.csv,machine.toml,7,8,9", f"last,{ROW},,,",
    )  # fmt: skip
    found = {case.case: "".join(case.inputs.values()) for case in read_plan(path).cases}
    assert found == {"w": "789", "x": "129", "y": "739", "z": "", "last": ""}


@pytest.mark.parametrize(
    ("column", "cell", "allowed"),
    [
        ("inputs", "set:Z.a", "COLUMN=VALUE"),
        ("inputs", "set:Z.a = ", "COLUMN=VALUE"),
        ("checks", "lag_mm_max:Z", "METRIC=CONDITION"),
        ("checks", "lag_mm_max:Z=", "METRIC=CONDITION"),
    ],
)
def test_an_assignment_without_a_value_shows_its_form(
    place: Path, column: str, cell: str, allowed: str
) -> None:
    (error,) = mistakes_of(write(place / "p.csv", f"{HEAD},{column}", f"a,{ROW},{cell}"))
    assert error.message.startswith("the assignment has no value")
    assert (error.value, error.allowed) == (cell.strip(), allowed)
    assert (error.line, error.column) == (2, 4)


@pytest.mark.parametrize(
    ("column", "cell", "named", "allowed"),
    [
        ("inputs", "V.E.B=1", "V.E.B", "plc:V.E.B"),
        ("inputs", "sett:Z.a=1", "sett:Z.a", "set:Z.a"),
        ("inputs", "title=1", "title", None),
        ("inputs", "check:lag_mm_max:Z=1", "check:lag_mm_max:Z", None),
    ],
)
def test_what_cannot_be_assigned_names_what_may_be_meant(
    place: Path, column: str, cell: str, named: str, allowed: str | None
) -> None:
    """Where nothing is near, all that can: no column of another kind is among them."""
    (error,) = mistakes_of(write(place / "p.csv", f"{HEAD},{column}", f"a,{ROW},{cell}"))
    assert error.message.startswith(f"the column cannot be assigned in {column}")
    assert error.value == named
    if allowed is not None:
        assert error.allowed == allowed
    else:
        assert "set:<axis>.<path>" in str(error.allowed)
        assert "check:" not in str(error.allowed)
        assert "title" not in str(error.allowed)


@pytest.mark.parametrize("cell", ["set:Z.a=1 ;;", "set:Z.a=1 ;;\nset:Z.b=2", "\nset:Z.a=1\n\n"])
def test_nothing_between_two_separators_is_no_assignment(place: Path, cell: str) -> None:
    path = write(place / "p.csv", f"{HEAD},inputs", f'a,{ROW},"{cell}"')
    wanted = {"set:Z.a": "1"} | ({"set:Z.b": "2"} if "Z.b" in cell else {})
    assert read_plan(path).cases[0].inputs == wanted


def test_a_dash_in_inputs_empties_what_inputs_gave_and_nothing_else(place: Path) -> None:
    path = write(
        place / "p.csv", f"{HEAD},set:Z.c,inputs,checks",
        f"*,{ROW},5,set:Z.a=1 ;; set:Z.b=2,lag_mm_max:Z <= 1",
        "a,,,,-,", "b,,,-,,-", "c,,,,set:Z.b=-,",
    )  # fmt: skip
    a, b, c = read_plan(path).cases
    assert (a.inputs, b.inputs) == ({"set:Z.c": "5"}, {"set:Z.a": "1", "set:Z.b": "2"})
    assert c.inputs == {"set:Z.c": "5", "set:Z.a": "1"}
    asked = [[check.metric for check in case.checks] for case in (a, b, c)]
    assert asked == [["lag_mm_max:Z", "alarms"], ["alarms"], ["lag_mm_max:Z", "alarms"]]


def test_a_column_that_is_missing_says_what_it_holds(place: Path) -> None:
    found = mistakes_of(write(place / "p.csv", "# words", "case,title", "a,x"))
    texts = {one.message: one.hint for one in found}
    assert set(texts) == {"column 'program' is missing", "column 'rig' is missing"}
    assert all(one.line == 2 for one in found)
    for message, hint in texts.items():
        assert hint is not None
        assert hint.startswith("it holds the ")
        assert message.split("'")[1] in hint.lower()
