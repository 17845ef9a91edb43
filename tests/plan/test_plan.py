"""Plans: what is read, and that every error names file, line and column."""

import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from zipfile import ZipFile

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.table import read_table
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig"
ROW = "probe.nc,machine.toml"


def test_a_plan_with_inputs_and_checks(write_plan: PlanWriter) -> None:
    path = write_plan(
        "case,program,rig,title,tags,requirement,set:Z.kenngr.measure.edge,"
        "plant:probe.pretravel_um,plc:V.E.FEED,fault:drop,check:latch_error_um:Z,check:alarms\n"
        f'a,{ROW},"Touch, slowly",slow z,REQ-1,NEG,5,,Z.TPDO2,-0.5 .. 0.5,50059\n'
        f"b,{ROW},,,,,,600,,,\n"
    )
    plan = read_plan(path)
    assert (plan.name, [case.run for case in plan.cases]) == ("probing", ["probing-a", "probing-b"])
    a, b = plan.cases
    assert (a.title, a.tags, a.requirement) == ("Touch, slowly", ("slow", "z"), "REQ-1")
    assert a.inputs == {
        "set:Z.kenngr.measure.edge": "NEG",
        "plant:probe.pretravel_um": "5",
        "fault:drop": "Z.TPDO2",
    }
    assert [check.metric for check in a.checks] == ["latch_error_um:Z", "alarms"]
    assert a.checks[0].reference == "probing.csv:2"
    assert a.program == path.parent / "probe.nc"
    assert a.seed == zlib.crc32(b"probing-a")
    assert b.inputs == {"plc:V.E.FEED": "600"}
    assert (b.index, b.line) == (1, 3)


def test_a_row_that_expects_no_alarm_is_checked_for_none(write_plan: PlanWriter) -> None:
    (case,) = read_plan(write_plan(f"{HEAD}\na,{ROW}\n")).cases
    assert [(check.metric, check.condition.text) for check in case.checks] == [("alarms", "none")]


def test_semicolons_byte_order_mark_blank_lines_and_line_breaks_in_cells(
    write_plan: PlanWriter,
) -> None:
    text = 'case;program;rig;title;check:latch_mm:Z\n\na;probe.nc;machine.toml;"two\nlines";1,5\n'
    with pytest.raises(UserError) as caught:
        read_plan(write_plan(text, encoding="utf-8-sig"))
    assert (caught.value.line, caught.value.column) == (3, 5)
    good = text.replace("1,5", "1.5") + "\nb;probe.nc;machine.toml;;\n"
    assert [(c.case, c.line) for c in read_plan(write_plan(good, encoding="utf-8-sig")).cases] == [
        ("a", 3),
        ("b", 6),
    ]


def test_rows_with_fewer_cells_than_the_header_are_refused_all_at_once(
    write_plan: PlanWriter,
) -> None:
    text = f"{HEAD},title,check:latch_mm:Z,\n# a note\na,{ROW},x\nb,{ROW},,3\n\n,# no row\nc\n"
    with pytest.raises(UserError) as caught:
        read_plan(path := write_plan(text))
    found = [(e.file, e.line, e.message) for e in (caught.value, *caught.value.further)]
    assert found == [
        (str(path), 3, "the row has 4 cells and the header 5"),
        (str(path), 7, "the row has 1 cell and the header 5"),
    ]
    outer = write_plan(f"{HEAD}\ninclude,{path.name},machine.toml\n", name="outer.csv")
    with pytest.raises(UserError, match=r"5 \(included by outer.csv:2\)") as caught:
        read_plan(outer)
    assert [error.line for error in (caught.value, *caught.value.further)] == [3, 7]


def test_repeats_are_runs_with_seeds_of_their_own(write_plan: PlanWriter) -> None:
    plan = read_plan(write_plan(f"{HEAD},repeats,seed\na,{ROW},3,7\nb,{ROW},2,\nc,{ROW},1,\n"))
    assert [(c.run, c.repeat) for c in plan.cases] == [
        ("probing-a-001", 1),
        ("probing-a-002", 2),
        ("probing-a-003", 3),
        ("probing-b-001", 1),
        ("probing-b-002", 2),
        ("probing-c", 0),
    ]
    assert [c.seed for c in plan.cases[:3]] == [7, 8, 9]
    assert plan.cases[4].seed == zlib.crc32(b"probing-b-002")
    assert [c.index for c in plan.cases] == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("", 1, None, "empty"),
        ("\n\n", 1, None, "empty"),
        (f"{HEAD}\n", None, None, "no case"),
        (f"case,program\na,{ROW}\n", 2, None, "header"),
        ("case,program\na,probe.nc\n", 1, None, "'rig' is missing"),
        (f"{HEAD},chek:latch_mm\na,{ROW},1\n", 1, 4, "did you mean: check:latch_mm"),
        (f"{HEAD},pla:V.E.F\na,{ROW},1\n", 1, 4, "did you mean: .*plc:V.E.F"),
        (f"{HEAD},plc.V.E.F\na,{ROW},1\n", 1, 4, "did you mean: plc:V.E.F"),
        (f"{HEAD},V.E.F\na,{ROW},1\n", 1, 4, "did you mean: plc:V.E.F"),
        (f"{HEAD},fautl:drop\na,{ROW},1\n", 1, 4, "did you mean: fault:drop"),
        (f"{HEAD},title,Title\na,{ROW},1,\n", 1, 5, "title"),
        (f"{HEAD},set:Z\na,{ROW},1\n", 1, 4, "set:<axis>.<path>"),
        (f"{HEAD},title,title\na,{ROW},x,y\n", 1, 5, "twice"),
        (f"{HEAD},,title\na,{ROW},,x\n", 1, 4, "no name"),
        (f"{HEAD}\na,,machine.toml\n", 2, 2, "missing"),
        (f"{HEAD}\n,{ROW}\n", 2, 1, "missing"),
        (f"{HEAD}\na b,{ROW}\n", 2, 1, "letters, digits"),
        (f"{HEAD}\na/b,{ROW}\n", 2, 1, "letters, digits"),
        (f"{HEAD}\na,{ROW}\n\na,{ROW}\n", 4, 1, "line 2"),
        (f"{HEAD}\na,{ROW}\nA,{ROW}\n", 3, 1, "line 2"),
        (f"{HEAD},repeats\na,{ROW},2\na-002,{ROW},\n", 3, 1, "line 2"),
        (f"{HEAD}\na,prob.nc,machine.toml\n", 2, 2, "near it: probe.nc"),
        (f"{HEAD}\na,probe.nc,none/m.toml\n", 2, 3, "rig file"),
        (f"{HEAD},repeats\na,{ROW},0\n", 2, 4, "1 to 999"),
        (f"{HEAD},repeats\na,{ROW},two\n", 2, 4, "1 to 999"),
        (f"{HEAD},seed\na,{ROW},-1\n", 2, 4, "0 to 4294967295"),
        (f"{HEAD},check:latch_mm:Z\na,{ROW},about 3\n", 2, 4, "not a condition"),
        (f"{HEAD},check:latchmm:Z\na,{ROW},3\n", 2, 4, "latch_mm"),
        (f"{HEAD},plant:probe.delay_us\na,{ROW},long\n", 2, 4, "not a number"),
        (f"{HEAD}\na,{ROW}\nb,{ROW},x\n", 3, None, "header"),
    ],
)
def test_errors_name_the_place(
    write_plan: PlanWriter, text: str, line: int | None, column: int | None, words: str
) -> None:
    path = write_plan(text)
    with pytest.raises(UserError, match=words) as caught:
        read_plan(path)
    assert caught.value.file == str(path)
    assert (caught.value.line, caught.value.column) == (line, column)


def test_a_file_that_is_not_utf_8_names_the_line(write_plan: PlanWriter) -> None:
    path = write_plan(f"{HEAD},title\na,{ROW},fünf\n", encoding="latin-1")
    with pytest.raises(UserError, match="UTF-8") as caught:
        read_plan(path)
    assert caught.value.line == 2


def test_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such file"):
        read_plan(tmp_path / "nothing.csv")
    with pytest.raises(UserError, match="not a table"):
        read_plan(tmp_path / "plan.txt")
    (tmp_path / "broken.xlsx").write_bytes(b"no zip")
    with pytest.raises(UserError, match="workbook"):
        read_plan(tmp_path / "broken.xlsx")


def test_the_name_of_the_plan_must_do_as_a_file_name(write_plan: PlanWriter) -> None:
    with pytest.raises(UserError, match="name of the plan"):
        read_plan(write_plan(f"{HEAD}\na,{ROW}\n", name="my plan.csv"))


def _xlsx(path: Path, rows: Sequence[Sequence[object]]) -> None:
    """A workbook in its smallest form: one sheet, texts in the cells, numbers as numbers."""

    def cell(value: object, name: str) -> str:
        if isinstance(value, (int, float)):
            return f'<c r="{name}"><v>{value}</v></c>'
        return f'<c r="{name}" t="inlineStr"><is><t>{value}</t></is></c>'

    lines = ""
    for r, row in enumerate(rows, start=1):
        cells = "".join(cell(value, f"{chr(64 + c)}{r}") for c, value in enumerate(row, start=1))
        lines += f'<row r="{r}">{cells}</row>'
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    with ZipFile(path, "w") as file:
        file.writestr(
            "[Content_Types].xml",
            '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
            '<Default Extension="rels" ContentType='
            '"application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="xml" ContentType="application/xml"/></Types>',
        )
        file.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{package}"><Relationship Id="r1" Type="{office}/officeDocument"'
            ' Target="xl/workbook.xml"/></Relationships>',
        )
        file.writestr(
            "xl/workbook.xml",
            f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets><sheet name="plan" sheetId="1"'
            ' r:id="r1"/></sheets></workbook>',
        )
        file.writestr(
            "xl/_rels/workbook.xml.rels",
            f'<Relationships xmlns="{package}"><Relationship Id="r1" Type="{office}/worksheet"'
            ' Target="worksheets/sheet1.xml"/></Relationships>',
        )
        file.writestr(
            "xl/worksheets/sheet1.xml",
            f'<worksheet xmlns="{main}"><sheetData>{lines}</sheetData></worksheet>',
        )


def test_a_workbook_reads_like_the_csv(write_plan: PlanWriter, tmp_path: Path) -> None:
    write_plan("")
    path = tmp_path / "probing.xlsx"
    head = ["case", "program", "rig", "seed", "plant:probe.pretravel_um", "check:latch_mm:Z"]
    _xlsx(path, [head, ["a", "probe.nc", "machine.toml", 7, 2.5, "66.99 .. 67.01"]])
    (case,) = read_plan(path).cases
    assert (case.seed, case.inputs["plant:probe.pretravel_um"]) == (7, "2.5")
    assert case.checks[0].condition.upper == 67.01
    _xlsx(path, [head, [], ["a", "probe.nc", "machine.toml", "", "", "sixty"]])
    with pytest.raises(UserError) as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.column) == (3, 6)


@pytest.mark.parametrize(
    ("text", "kind", "target", "name", "unit", "value"),
    [
        ("set:Z.kenngr.measure.edge=NEG", "set", "Z", "kenngr.measure.edge", "", "NEG"),
        ("set:channel.feed = 600", "set", "channel", "feed", "", "600"),
        ("plant:probe.pretravel_um=5", "plant", "probe", "pretravel", "um", "5"),
        ("plant:probe.normal_x=1", "plant", "probe", "normal_x", "", "1"),
        ("plant:Z.speed_mm_s=2", "plant", "Z", "speed", "mm_s", "2"),
        ("bus:can0.bitrate=500000", "bus", "can0", "bitrate", "", "500000"),
        ("plc:V.E.FEED=10", "plc", "", "V.E.FEED", "", "10"),
        ("fault:drop=Z.TPDO2", "fault", "", "drop", "", "Z.TPDO2"),
        ("fault:drop=a=b", "fault", "", "drop", "", "a=b"),
    ],
)
def test_assignments_of_the_command_line(
    text: str, kind: str, target: str, name: str, unit: str, value: str
) -> None:
    item = parse_assignment(text)
    assert (item.kind, item.target, item.name) == (kind, target, name)
    assert (item.unit, item.value) == (unit, value)


@pytest.mark.parametrize(
    ("text", "si"),
    [
        ("plant:p.a_um=5", 5e-6),
        ("plant:p.a_mm=0.1", 1e-4),
        ("plant:p.a_mm_min=60", 1e-3),
        ("plant:p.a_deg=180", 3.141592653589793),
        ("plant:p.a_n_um=20", 2e7),
        ("plant:p.a=0.25", 0.25),
    ],
)
def test_plant_values_arrive_in_si(text: str, si: float) -> None:
    assert parse_assignment(text).si() == pytest.approx(si, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["set:Z.a", "set:Z.a=", "check:alarms=1", "title=x", "plant:p.a_um=much", "=1"]
)
def test_assignments_that_are_refused(text: str) -> None:
    with pytest.raises(UserError):
        parse_assignment(text)


def test_the_command_line_overrides_every_case(write_plan: PlanWriter) -> None:
    plan = read_plan(write_plan(f"{HEAD},set:Z.a\na,{ROW},1\nb,{ROW},\n"))
    changed = plan.with_inputs([parse_assignment("set:Z.a=2"), parse_assignment("bus:can0.k=3")])
    assert [case.inputs for case in changed.cases] == [{"set:Z.a": "2", "bus:can0.k": "3"}] * 2
    assert changed.columns == (*plan.columns, "bus:can0.k")
    assert plan.cases[1].inputs == {}


def test_a_later_error_points_at_the_cell(write_plan: PlanWriter) -> None:
    (case,) = read_plan(write_plan(f"{HEAD},set:Z.nme\na,{ROW},1\n")).cases
    error = case.error("unknown parameter", "set:Z.nme", value="nme")
    assert (error.line, error.column) == (2, 4)
    assert case.error("unknown", "set:X.y").line is None


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("Z.kenngr.measure.edge=NEG", "set:Z.kenngr.measure.edge"),
        ("V.E.FEED=600", "plc:V.E.FEED"),
    ],
)
def test_a_column_without_its_kind_is_told_with_it(text: str, meant: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_assignment(text)
    assert str(caught.value).endswith(f"did you mean: {meant}")


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("\n\ncase,b\nr,1\n", [(4, "r", "1")]),
        ('case,b\r\nr,"1\r\n2"\r\ns,3', [(2, "r", "1\n2"), (4, "s", "3")]),
        ('case,b\nr,"a ""b"", c"\n', [(2, "r", 'a "b", c')]),
        ("case;b\nr; 1,5 \n", [(2, "r", "1,5")]),
        ('case,b\nr,5" probe\n', [(2, "r", '5" probe')]),
        ("case,b\nNA,nan\n", [(2, "NA", "nan")]),
    ],
)
def test_cells_are_taken_as_they_are_written(
    tmp_path: Path, text: str, rows: list[tuple[int, str, str]]
) -> None:
    path = tmp_path / "p.csv"
    path.write_bytes(text.encode())
    table = read_table(path)
    assert [(row.line, row.cells["case"], row.cells["b"]) for row in table.rows] == rows


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ('case,b\nr,"1\n2"\ns,1,2\n', 4, "the row has 3 cells and the header 2"),
        ('case,b\nr,"1\ns,2\n', 2, "cannot be taken apart"),
        ('case,b\nr,1\ns,"', 3, "cannot be taken apart"),
        (f"case,b\nr,{'1' * 200_000}\n", 2, "cannot be taken apart"),
        ("", 1, "the table is empty"),
        ("\n \n,\n", 1, "the table is empty"),
    ],
)
def test_what_is_no_table_is_refused_with_its_line(
    tmp_path: Path, text: str, line: int, words: str
) -> None:
    path = tmp_path / "p.csv"
    path.write_bytes(text.encode())
    with pytest.raises(UserError, match=words) as caught:
        read_table(path)
    assert caught.value.line == line


def test_several_cells_with_line_breaks_make_a_row_so_much_longer(write_plan: PlanWriter) -> None:
    text = 'case,program,rig,title,requirement\na,probe.nc,machine.toml,"x\ny","z\n\nw"\nb,,,,\n'
    with pytest.raises(UserError) as caught:
        read_plan(write_plan(text))
    assert caught.value.line == 6


def test_a_comment_may_begin_in_the_column_of_cases(write_plan: PlanWriter) -> None:
    """Where that is not the first one; a sign in another column is text of its cell."""
    head = "requirement,case,program,rig,title"
    text = f"{head}\n,#a,probe.nc,machine.toml,\n,b,probe.nc,machine.toml,#1\n"
    (case,) = read_plan(write_plan(text)).cases
    assert (case.case, case.title, case.line) == ("b", "#1", 3)
