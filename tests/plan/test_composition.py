"""Defaults, included tables, assignments in one cell, comments, and all mistakes at once."""

import re
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.sheets import read_parquet
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig"
ROW = "probe.nc,machine.toml"


def _inputs(cases: tuple[Case, ...]) -> dict[str, dict[str, str]]:
    return {case.case: dict(case.inputs) for case in cases}


def _checks(case: Case) -> dict[str, str]:
    return {check.metric: check.condition.text for check in case.checks}


def test_defaults_last_until_the_next_ones(write_plan: PlanWriter) -> None:
    plan = read_plan(
        write_plan(
            f"{HEAD},tags,set:Z.a,set:Z.b,check:latch_mm:Z\n"
            f"first,{ROW},,,,\n"
            f"*,{ROW},demo,1,2,<= 3\n"
            "second,,,,,,\n"
            "third,,,other,5,-,-\n"
            f"*,{ROW},,,7,\n"
            "fourth,,,,,,\n"
        )
    )
    assert _inputs(plan.cases) == {
        "first": {},
        "second": {"set:Z.a": "1", "set:Z.b": "2"},
        "third": {"set:Z.a": "5"},
        "fourth": {"set:Z.b": "7"},
    }
    assert [case.tags for case in plan.cases] == [(), ("demo",), ("other",), ()]
    assert [case.run for case in plan.cases][1] == "probing-second"
    assert [_checks(case).get("latch_mm:Z") for case in plan.cases] == [None, "<= 3", None, None]
    assert plan.cases[1].checks[0].reference == "probing.csv:3"


def test_cells_with_several_assignments(write_plan: PlanWriter) -> None:
    plan = read_plan(
        write_plan(
            f"{HEAD},inputs,set:Z.c,checks,check:alarms\n"
            f"a,{ROW},set:Z.a=1 ;; plc:V.E.B=0; 1 at=M50,5,"
            '"latch_mm:Z=<= 3\ncheck:latch_mm:X== 4",none\n'
            f"*,{ROW},set:Z.a=1 ;; set:Z.b=2,3,latch_mm:Z=<= 3 ;; alarms=none,\n"
            "b,,,set:Z.b=4 ;; set:Z.d=5,,latch_mm:Z=-,\n"
            "c,,,-,-,-,\n"
            "d,,,set:Z.c=9,,,50059\n"
        )
    )
    a, b, c, d = plan.cases
    assert a.inputs == {"set:Z.a": "1", "plc:V.E.B": "0; 1 at=M50", "set:Z.c": "5"}
    assert _checks(a) == {"latch_mm:Z": "<= 3", "latch_mm:X": "== 4", "alarms": "none"}
    assert b.inputs == {"set:Z.a": "1", "set:Z.b": "4", "set:Z.d": "5", "set:Z.c": "3"}
    assert list(b.inputs) == ["set:Z.a", "set:Z.b", "set:Z.d", "set:Z.c"]
    assert _checks(b) == {"alarms": "none"}
    assert (c.inputs, _checks(c)) == ({}, {"alarms": "none"})
    assert d.inputs["set:Z.c"] == "9"
    assert _checks(d) == {"latch_mm:Z": "<= 3", "alarms": "50059"}
    assert plan.columns == (
        *HEAD.split(","),
        *("set:Z.c", "check:alarms"),
        *("set:Z.a", "plc:V.E.B", "check:latch_mm:Z", "check:latch_mm:X", "set:Z.b", "set:Z.d"),
    )


def test_lists_in_assignments_are_expanded(write_plan: PlanWriter) -> None:
    plan = read_plan(
        write_plan(f"{HEAD},inputs\na,{ROW},set:Z.a=[1 | 2] ;; set:Z.b=10 .. 20 step 10\n")
    )
    assert [case.run for case in plan.cases] == [
        f"probing-a-{a}-{b}" for a in (1, 2) for b in (10, 20)
    ]


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("set:Z.a", "the assignment has no value"),
        ("set:Z.a=", "the assignment has no value"),
        ("set:Z.b=1", "set:Z.b is given twice"),
        ("set:Z.a=1 ;; set:Z.a=2", "set:Z.a is given twice"),
        ("V.E.B=1", "cannot be assigned"),
        ("check:alarms=none", "cannot be assigned"),
        ("plant:p.x_mm=long", "not a number"),
        ("plant:p.x_mm=1 ;; plant:p.x_um=2", "sets this twice"),
    ],
)
def test_assignments_that_are_wrong_name_the_cell(
    write_plan: PlanWriter, cell: str, words: str
) -> None:
    path = write_plan(f"{HEAD},set:Z.b,inputs\na,{ROW},7,{cell}\n")
    with pytest.raises(UserError, match=words) as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.column) == (2, 5)
    assert "column 'inputs'" in str(caught.value)


A_SECOND_TIME = [
    ("set:Z.a,inputs", "1,set:Z.a=2", "set:Z.a", (2, 5, "2"), "column 'set:Z.a'"),
    ("inputs,set:Z.a", "set:Z.a=1,2", "set:Z.a", (2, 5, "2"), "column 'inputs', 'set:Z.a'"),
    ("inputs", "set:Z.a=1 ;; set:Z.a=2", "set:Z.a", (2, 4, "2"), "column 'inputs', 'set:Z.a'"),
    ("check:alarms,checks", "none,alarms=50059", "check:alarms", (2, 5, "50059"),
     "column 'check:alarms'"),
    ("checks,check:alarms", "alarms=50059,none", "check:alarms", (2, 5, "none"),
     "column 'checks', 'check:alarms'"),
]  # fmt: skip


@pytest.mark.parametrize(("head", "cells", "name", "at", "other"), A_SECOND_TIME)
def test_what_a_row_gives_twice_names_both_places(
    write_plan: PlanWriter, head: str, cells: str, name: str, at: tuple[int, int, str], other: str
) -> None:
    """The mistake is at the second one, its hint has the first one."""
    with pytest.raises(UserError, match=f"^[^:]*:2:{at[1]}: {name} is given twice") as caught:
        read_plan(write_plan(f"{HEAD},{head}\na,{ROW},{cells}\n"))
    error = caught.value
    assert (error.line, error.column, error.value) == at
    assert (error.hint, error.further) == (f"the other one is in {other}", ())
    of_defaults = f"{HEAD},{head}\n*,{ROW},{cells}\na,,,{',' * head.count(',')}\n"
    with pytest.raises(UserError) as again:
        read_plan(write_plan(of_defaults))
    assert (str(again.value), again.value.further) == (str(error), ())


def test_what_an_included_row_gives_twice_names_the_row_that_includes_it(tmp_path: Path) -> None:
    path, sub = _include(tmp_path), tmp_path / "parts" / "slow.csv"
    sub.write_text(
        "case,program,set:Z.b,inputs\nx,nc/touch.nc,1,set:Z.b=2 ;; set:Z.a=3\n", encoding="utf-8"
    )
    with pytest.raises(UserError, match=r"set:Z\.b is given twice") as caught:
        read_plan(path)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(sub), 2, 4)
    assert caught.value.hint == "the other one is in column 'set:Z.b', included by main.csv:3"


def test_a_table_that_a_table_includes_names_all_rows_on_the_way(tmp_path: Path) -> None:
    """The innermost first; a doubled file is one that is open, not one that was read before."""
    path = _include(tmp_path)
    parts = tmp_path / "parts"
    (parts / "inner.csv").write_text("case,program,seed\ny,nc/touch.nc,-1\n", encoding="utf-8")
    (parts / "slow.csv").write_text(
        "case,program,seed\nx,nc/touch.nc,\ninclude,inner.csv,\n", encoding="utf-8"
    )
    with pytest.raises(UserError, match="not an integer in the range") as caught:
        read_plan(path)
    assert (caught.value.file, caught.value.line) == (str(parts / "inner.csv"), 2)
    assert "(column 'seed', included by slow.csv:3, included by main.csv:3)" in str(caught.value)
    (parts / "inner.csv").write_text("case,program\nin,nc/touch.nc\n", encoding="utf-8")
    assert [case.case for case in read_plan(path).cases] == ["first", "x", "in", "last"]
    twice = path.read_text(encoding="utf-8") + "include,parts/inner.csv,machine.toml,,\n"
    path.write_text(twice, encoding="utf-8")
    with pytest.raises(
        UserError, match=r"same run as line 2 \(.*included by main.csv:5\)"
    ) as again:
        read_plan(path)
    assert (again.value.file, again.value.line) == (str(parts / "inner.csv"), 2)


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("latch_mm:Z=3", "3"),
        ("latch_mm:Z = 1 .. 2", "1 .. 2"),
        ("check:latch_mm:Z=<= 3", "<= 3"),
        ("latch_mm:Z <= 3", "<= 3"),
        ("latch_mm:Z>3", ">3"),
        ("latch_mm:Z == 3", "== 3"),
        ("latch_mm:Z= == 3", "== 3"),
        ("latch_mm:Z===3", "==3"),
        ("latch_mm:Z != 3", "!= 3"),
    ],
)
def test_a_check_may_be_written_as_it_is_read(
    write_plan: PlanWriter, text: str, condition: str
) -> None:
    (case,) = read_plan(write_plan(f"{HEAD},checks\na,{ROW},{text}\n")).cases
    assert _checks(case)["latch_mm:Z"] == condition


def _include(folder: Path) -> Path:
    """A plan that includes a table in a subfolder, with defaults for it."""
    sub = folder / "parts"
    (sub / "nc").mkdir(parents=True)
    (sub / "nc" / "touch.nc").write_text("N10 M30\n", encoding="utf-8")
    (folder / "machine.toml").write_text("[machine]\n", encoding="utf-8")
    (folder / "probe.nc").write_text("N10 M30\n", encoding="utf-8")
    (sub / "slow.csv").write_text(
        "case,program,set:Z.a,plc:V.E.B,check:latch_mm:Z\n"
        "*,,1,,\n"
        "x,nc/touch.nc,,[5 | 6],<= 3\n"
        "y,nc/touch.nc,2,,\n",
        encoding="utf-8",
    )
    (folder / "main.csv").write_text(
        f"{HEAD},inputs,checks\n"
        f"first,{ROW},,\n"
        "include,parts/slow.csv,machine.toml,set:Z.a=9 ;; set:Z.c=3,alarms=50059\n"
        f"last,{ROW},,\n",
        encoding="utf-8",
    )
    return folder / "main.csv"


def test_included_rows_carry_the_name_of_the_plan(tmp_path: Path) -> None:
    plan = read_plan(_include(tmp_path))
    assert [case.run for case in plan.cases] == [
        "main-first",
        "main-x-5",
        "main-x-6",
        "main-y",
        "main-last",
    ]
    x, y = plan.cases[1], plan.cases[3]
    assert x.program == tmp_path / "parts" / "nc" / "touch.nc"
    assert x.rig == tmp_path / "machine.toml"  # a default is relative to where it is written
    assert x.inputs == {"set:Z.a": "1", "plc:V.E.B": "5", "set:Z.c": "3"}
    assert y.inputs == {"set:Z.a": "2", "set:Z.c": "3"}
    assert [_checks(case)["alarms"] for case in (x, y)] == ["50059", "50059"]
    assert x.checks[0].reference == "slow.csv:3"
    assert plan.cases[-1].inputs == {}


def test_errors_in_an_included_table_name_both_files(tmp_path: Path) -> None:
    path = _include(tmp_path)
    sub = tmp_path / "parts" / "slow.csv"
    text = sub.read_text(encoding="utf-8")
    sub.write_text(text.replace("<= 3", "about 3"), encoding="utf-8")
    with pytest.raises(UserError, match=r"not a condition.*included by main.csv:3") as caught:
        read_plan(path)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(sub), 3, 5)
    sub.write_text(text.replace("plc:V.E.B", "plc"), encoding="utf-8")
    with pytest.raises(UserError, match=r"unknown column.*included by main.csv:3"):
        read_plan(path)
    sub.write_text("", encoding="utf-8")
    with pytest.raises(UserError, match=r"empty.*included by main.csv:3"):
        read_plan(path)
    sub.write_text("case,program,rig\ninclude,../main.csv,\n", encoding="utf-8")
    with pytest.raises(UserError, match="includes itself"):
        read_plan(path)
    sub.unlink()
    with pytest.raises(UserError, match="no such table file") as caught:
        read_plan(path)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(path), 3, 2)


def test_an_included_row_that_makes_the_same_run_is_refused(tmp_path: Path) -> None:
    path = _include(tmp_path)
    text = path.read_text(encoding="utf-8").replace("last,", "y,")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=r"same run as line 4 of .*slow.csv"):
        read_plan(path)


def test_comments_and_notes(write_plan: PlanWriter) -> None:
    plan = read_plan(
        write_plan(
            "# probes of the new batch, and what, they, are, for\n"
            f"{HEAD},note:serial number,title\n"
            "# one, two\n"
            f"a,{ROW},P-17,#1 of two\n"
            "#b,x,y,z\n"
        )
    )
    (case,) = plan.cases
    assert (case.line, case.title, case.notes) == (4, "#1 of two", {"note:serial number": "P-17"})
    moved = "title,case,program,rig\n,# no case,,\n#,a,,\nx,a,probe.nc,machine.toml\n"
    assert [case.line for case in read_plan(write_plan(moved)).cases] == [4]


def test_notes_and_words_of_a_row_stay_what_they_are_when_it_is_expanded(
    write_plan: PlanWriter,
) -> None:
    """A bracket is doubled only where it would begin a list."""
    plan = read_plan(
        write_plan(
            f"{HEAD},note:part,title,requirement,plc:V.E.A,check:msg:N10\n"
            f"a,{ROW},[P-17] [[x,[t],[R],[[v],== [[w]\n"
            f'b,{ROW},"[a | b]",,,[1 | 2],\n'
        )
    )
    again = read_plan(write_plan(expanded_text(plan)))
    for case, other in zip(plan.cases, again.cases, strict=True):
        for name in ("run", "notes", "title", "requirement", "inputs", "seed"):
            assert getattr(other, name) == getattr(case, name), name
        assert _checks(other) == _checks(case)
    assert plan.cases[0].notes == {"note:part": "[P-17] [[x"}
    assert plan.cases[0].inputs == {"plc:V.E.A": "[v]"}
    assert [case.notes["note:part"] for case in again.cases[1:]] == ["[a | b]"] * 2


def test_a_parquet_file_reads_like_the_csv(write_plan: PlanWriter, tmp_path: Path) -> None:
    write_plan("")
    rows = {
        "case": ["a", "b"],
        "program": ["probe.nc"] * 2,
        "rig": ["machine.toml"] * 2,
        "seed": [7, None],
        "plant:p.x_mm": [2.5, 3.0],
        "check:latch_mm:Z": ["66 .. 67", None],
    }
    path = tmp_path / "probing.parquet"
    pd.DataFrame(rows).to_parquet(path)
    a, b = read_plan(path).cases
    assert (a.seed, a.inputs, b.inputs) == (7, {"plant:p.x_mm": "2.5"}, {"plant:p.x_mm": "3"})
    assert _checks(a) == {"latch_mm:Z": "66 .. 67", "alarms": "none"}
    path.write_bytes(b"no parquet")
    with pytest.raises(UserError, match="cannot be read"):
        read_plan(path)


def test_numbers_of_a_parquet_file_are_written_as_python_writes_them(tmp_path: Path) -> None:
    """A whole one without a decimal point up to 2^53, from which on a float is known to 2 only."""
    cells = {
        0.0: "0", 3.0: "3", -3.0: "-3", 0.1: "0.1", -2.5: "-2.5", 2.0**53 - 1: "9007199254740991",
        1.0 - 2.0**53: "-9007199254740991", 1e300: "1e+300", -1e300: "-1e+300", 1e-7: "1e-07",
    }  # fmt: skip
    path = tmp_path / "numbers.parquet"
    pd.DataFrame({"case": list(cells)}).to_parquet(path)
    assert read_parquet(path) == [["case"], *([text] for text in cells.values())]


def test_all_mistakes_come_at_once_in_the_order_of_their_places(write_plan: PlanWriter) -> None:
    path = write_plan(
        f"{HEAD},chek:latch_mm,repeats,plc:V.E.A,check:latch_mm:Z\n"
        f"a b,{ROW},,0,[1,about\n"
        f"b,prob.nc,,,,,\n"
        f"c,{ROW},,,,latch\n"
        f"c,{ROW},,,,\n"
    )
    with pytest.raises(UserError) as caught:
        read_plan(path)
    errors = [caught.value, *caught.value.further]
    assert [(error.line, error.column) for error in errors] == [
        *[(1, 4), (2, 1), (2, 5), (2, 6), (2, 7), (3, 2), (3, 3), (4, 7)]
    ]
    assert "near it: probe.nc" in str(errors[5])


def test_a_row_that_cannot_be_expanded_is_read_to_its_end(write_plan: PlanWriter) -> None:
    path = write_plan(
        f"{HEAD},plc:V.E.A,plant:p.x_mm,check:latch_mm:Z,check:latch_eror_um\n"
        "a,prob.nc,machine.toml,300 .. 900,long,about,3\n"
    )
    with pytest.raises(UserError) as caught:
        read_plan(path)
    errors = [caught.value, *caught.value.further]
    assert [(error.line, error.column) for error in errors] == [
        *[(2, 2), (2, 4), (2, 5), (2, 6), (2, 7)]
    ]
    assert "latch_error_um" in str(errors[4])


def test_a_mistake_in_a_default_is_reported_once(write_plan: PlanWriter) -> None:
    path = write_plan(f"{HEAD},check:latch_mm:Z\n*,{ROW},about\na,,,\nb,,,\n")
    with pytest.raises(UserError) as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.further) == (2, ())


def test_the_examples_of_the_page_are_plans(tmp_path: Path) -> None:
    page = Path(__file__).parents[2] / "docs" / "plans.md"
    blocks = re.findall(r"```\n(case,.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 3
    (tmp_path / "more").mkdir()
    for name in ("probe-z.nc", "probe-z.toml", "more/edge.nc"):
        (tmp_path / name).touch()
    edges = tmp_path / "more" / "edges.csv"
    edges.write_text("case,program\nrising,edge.nc\n", encoding="utf-8")
    found = []
    for block in blocks:
        (tmp_path / "page.csv").write_text(block, encoding="utf-8")
        found.append([case.run for case in read_plan(tmp_path / "page.csv").cases])
    assert found == [
        ["page-feeds-60", "page-feeds-600", "page-feeds-3000"],
        ["page-fastest"],
        ["page-slow", "page-fast", "page-rising"],
    ]


def test_cells_of_a_parquet_file_that_have_no_value_are_empty(tmp_path: Path) -> None:
    """Of any type; a text is without its blanks, all else as Python writes it."""
    path = tmp_path / "cells.parquet"
    frame = pd.DataFrame(
        {
            "case": [" a ", None],
            "seed": pd.array([7, None], dtype="Int64"),
            "x": [0.5, None],
            "note:is": pd.array([True, None], dtype="boolean"),
            "note:at": pd.to_datetime(["2024-02-03 04:05:06", None]),
        }
    )
    frame.to_parquet(path)
    assert read_parquet(path) == [
        ["case", "seed", "x", "note:is", "note:at"],
        ["a", "7", "0.5", "True", "2024-02-03 04:05:06"],
        ["", "", "", "", ""],
    ]


@pytest.mark.parametrize(
    ("word", "other"), [("plc:V.E.B", "plc"), ("check:latch_mm:Z", "chekc:latch_mm:Z"),
                        ("program", "progam")],
)  # fmt: skip
def test_a_mistake_of_a_table_is_the_same_wherever_it_is_included(
    tmp_path: Path, word: str, other: str
) -> None:
    """Its place, what was found, what is allowed and what to do are those of the table alone."""
    path, sub = _include(tmp_path), tmp_path / "parts" / "slow.csv"
    text = "case,program,rig,plc:V.E.B,check:latch_mm:Z\nx,nc/touch.nc,../machine.toml,5,<= 3\n"
    sub.write_text(text.replace(word, other), encoding="utf-8")
    with pytest.raises(UserError) as alone:
        read_plan(sub)
    with pytest.raises(UserError) as included:
        read_plan(path)
    own, of_row = alone.value, included.value
    assert of_row.message == f"{own.message} (included by main.csv:3)"
    for name in ("file", "line", "column", "value", "allowed", "hint"):
        assert getattr(of_row, name) == getattr(own, name), name
    assert own.line == 1
