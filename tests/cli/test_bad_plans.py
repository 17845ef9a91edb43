"""Plans, selections and output folders that cannot be used: told whole, and nothing is written.

Every row is tried with `run` and with `check`; both must refuse it with the same place.
"""

import json
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.record.facts import VERSION

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Reject = Callable[..., str]

HEADER = "case,program,rig,plc:V.E.FEED"
ROW = "a,part.nc,rig.toml,3000"


# Row of a table -> the defect that it shows; a row leaves this list when it is mended.
def _table(names: str, rows: Iterable[Any], *, named: bool = False) -> pytest.MarkDecorator:
    """Make the cases of a table whose rows begin with their name; named: the test takes it too."""
    return pytest.mark.parametrize(
        names.split(),
        [
            pytest.param(
                *(row if named else row[1:]),
                id=row[0][:40] or "empty",
            )
            for row in rows
        ],
    )


def _holds(message: str, *fragments: str) -> None:
    for fragment in fragments:
        assert fragment in message, message


def _refused(place: Path, rejected: Reject, fragments: list[str], plan: str = "plan.csv") -> None:
    """Both commands refuse the plan, and no results folder comes up."""
    _holds(rejected("run", plan, "-o", "out"), *fragments)
    assert not (place / "out").exists()
    _holds(rejected("check", plan), *fragments)


TABLES = [
    ("empty", "", ["plan.csv:1", "empty"]),
    ("blank", "\n \n", ["plan.csv:1", "empty"]),
    ("header only", f"{HEADER}\n", ["plan.csv", "no case"]),
    ("unknown column", f"{HEADER},chek:alarms\n{ROW},none\n", ["plan.csv:1:5:", "'chek:alarms'"]),
    ("column twice", f"{HEADER},rig\n{ROW},rig.toml\n", ["plan.csv:1:5:", "twice", "'rig'"]),
    ("column missing", "case,program\na,part.nc\n", ["plan.csv:1", "'rig' is missing"]),
    ("column without name", f"{HEADER},,title\n{ROW},,x\n", ["plan.csv:1:5:", "no name"]),
    ("more cells", f"{HEADER}\n{ROW},x,y\n", ["plan.csv:2", "6 cells and the header 4"]),
    ("fewer cells", f"{HEADER}\na,part.nc\n", ["plan.csv:2:", "2 cells and the header 4"]),
    ("open quote", f'{HEADER}\n"{ROW}\n', ["plan.csv"]),
    ("case twice", f"{HEADER}\n{ROW}\n\n{ROW}\n", ["plan.csv:4:1:", "line 2", "'plan-a'"]),
    ("case twice but for case", f"{HEADER}\n{ROW}\nA{ROW[1:]}\n", ["plan.csv:3:1:", "line 2"]),
    ("name with a slash", f"{HEADER}\n../{ROW}\n", ["plan.csv:2:1:", "'../a'", "letters, digits"]),
    ("name of 300", f"{HEADER}\n{'a' * 300}{ROW}\n", ["plan.csv:2:1:"]),
    ("no program", f"{HEADER}\na,pert.nc,rig.toml,1\n", ["plan.csv:2:2:", "near it: part.nc"]),
    ("no rig", f"{HEADER}\na,part.nc,no/rig.toml,1\n", ["plan.csv:2:3:", "looked in"]),
    ("folder as program", f"{HEADER}\na,lists,rig.toml,1\n", ["plan.csv:2:2:", "'lists'"]),
    ("seed below 0", f"{HEADER},seed\n{ROW},-1\n", ["plan.csv:2:5:", "0 to 4294967295"]),
    ("seed of 5000", f"{HEADER},seed\n{ROW},{'9' * 5000}\n", ["plan.csv:2:5:", "0 to 4294967295"]),
    ("no repeats", f"{HEADER},repeats\n{ROW},0\n", ["plan.csv:2:5:", "1 to 999"]),
    ("backslash", f"{HEADER}\nx,lists\\a.nc,rig.toml,1\n", ["plan.csv:2:2:", "/: lists/a.nc"]),
    ("tabs", f"{HEADER}\n{ROW}\n".replace(",", "\t"), ["plan.csv:1:", "separated by tabs"]),
    ("title", f"Plan of May\n{HEADER}\n{ROW}\n", ["plan.csv:1:", "no header", "in row 2"]),
    ("capitals", f"C{HEADER[1:]}\n{ROW}\n", ["plan.csv:1:1:", "did you mean: case"]),
    ("bad last row", f"{HEADER}\n{ROW}\nb{ROW[1:]}\nc{ROW[1:-4]}fast\n", ["plan.csv:4:4:", "fast"]),
    ("bad last program", f"{HEADER}\n{ROW}\nb,bad.nc,rig.toml,1\n", ["bad.nc:1:4:", "'X'"]),
    ("bad last rig", f"{HEADER}\n{ROW}\nb,part.nc,bad.toml,1\n", ["bad.toml:3", "300"]),
]


@_table("text fragments", TABLES)
def test_table_is_rejected(place: Path, rejected: Reject, text: str, fragments: list[str]) -> None:
    (place / "lists" / "a.nc").write_text("M30\n", encoding="utf-8")
    (place / "bad.nc").write_text("N1 X1 F1\n", encoding="utf-8")
    (place / "bad.toml").write_text('base = "rig.toml"\n[axis.Z]\nnode = 300\n', encoding="utf-8")
    (place / "plan.csv").write_text(text, encoding="utf-8")
    _refused(place, rejected, fragments)


@pytest.mark.parametrize(
    ("file", "content", "fragments"),
    [
        ("plan.csv", bytes(range(256)), ["plan.csv:2", "UTF-8"]),
        ("plan.csv", "title\nMüll\n".encode("latin-1"), ["plan.csv:2", "UTF-8"]),
        ("plan.csv", "case\n".encode("utf-16"), ["plan.csv:1", "UTF-8"]),
        ("plan.csv", f"{HEADER},title\0\n{ROW},t\n".encode(), ["plan.csv:1:5:", r"'title\x00'"]),
        ("plan.xlsx", b"PK\x03\x04rest", ["plan.xlsx", "cannot be read"]),
        ("plan.ods", b"", ["plan.ods", "cannot be read"]),
        ("plan.txt", b"case", ["plan.txt", "'.txt'", ".csv, .xlsx, .ods"]),
        ("my plan.csv", f"{HEADER}\n{ROW}\n".encode(), ["my plan.csv", "letters, digits"]),
    ],
)
def test_file_that_is_no_plan(
    place: Path, rejected: Reject, file: str, content: bytes, fragments: list[str]
) -> None:
    (place / file).write_bytes(content)
    _refused(place, rejected, fragments, file)


def test_plan_that_is_not_there_or_a_folder(place: Path, rejected: Reject) -> None:
    _refused(place, rejected, ["no.csv", "no such file"], "no.csv")
    (place / "dir.csv").mkdir()
    _refused(place, rejected, ["dir.csv"], "dir.csv")


CELLS = [
    ("set:Q.kenngr.messachse", "1", ["'Q'", "allowed: channel, Z"]),
    ("set:Z.kenngr.messachs", "1", ["nearest names: kenngr.messachse"]),
    ("set:Z.kenngr.messachse", "7", ["'7'", "allowed: 0 .. 1"]),
    ("set:Z.kenngr.measure.edge", "UP", ["'UP'", "allowed: POS, NEG"]),
    ("set:channel.messtyp", "99", ["'99'", "allowed: 1 .. 7"]),
    ("plant:q.kv", "1", ["'q'", "allowed: z, probe"]),
    ("plant:z.kvv", "1", ["'kvv'", "did you mean: kv"]),
    ("plant:probe.surface_mm", "high", ["not a number", "'high'"]),
    ("plant:probe.surface_mm", "nan", ["'nan'"]),
    ("plant:probe.surface_mm", "1e999999999999", ["number"]),
    ("plant:probe.surface_us", "1", ["another unit", "'us'"]),
    ("plant:z.kv", "-1", ["kv", "'-1'"]),
    ("plant:z.position_start_mm", "20490", ["20490", "-20480 .. 20480"]),
    ("plant:probe.normal_z", "0", ["unit vector"]),
    ("plant:probe.inverted", "maybe", ["'maybe'", "true, false"]),
    ("plant:probe.signal", "1", ["can be set"]),
    ("bus:can1.bitrate", "123", ["125000", "'123'"]),
    ("bus:can9.bitrate", "125000", ["'can9'", "allowed: can1"]),
    ("plc:FEED", "1", ["V.E.<NAME>"]),
    ("plant:probe.surface_inch", "1", ["inch is no unit of surface", "surface_mm, surface_um"]),
    ("plant:probe.surfase_mm", "1", ["'surfase_mm'", "did you mean: surface_mm"]),
    ("plc:V.E.FED", "300:3000:300", ["300 .. 3000 step 300"]),
    ("plc:V.E.OTHER", "inf", ["not a number", "'inf'"]),
    ("fault:drop", "Z.TPDO9", ["'Z.TPDO9'", "allowed: Z.TPDO1"]),
    ("fault:drip", "Z.TPDO1", ["'drip'", "did you mean: drop"]),
    ("check:latch_error", "1", ["'latch_error'", "latch_error_um", "axisrig metrics"]),
    ("check:latch_error_um", "about 3", ["not a condition", "'about 3'", "100 +- 0.001"]),
    ("check:latch_error_um", '"0,5"', ["'0,5'", "a decimal point"]),
    ("check:latch_error_um:Q", "<= 1", ["Q", "allowed: Z"]),
    ("check:duration_s:Z", "<= 1", ["'duration_s:Z'", "allowed: duration_s"]),
    ("check:msg", "== 1", ["allowed: msg:N30"]),
    ("check:msg:N999", "== 1", ["N999"]),
    ("check:alarms", "nothing", ["'nothing'", "for alarms: none"]),
    ("check:overtravel_mm", "5 .. 1", ["'5 .. 1'", "smaller number first"]),
    ("check:overtravel_mm", "<= inf", ["'<= inf'"]),
    ("check:overtravel_mm", "<= 1e999", ["'<= 1e999'"]),
]
# The rig as it comes out of the cell is what does not fit together, so the rig is named.
NAMES_THE_RIG = {"plant:probe.normal_z"}


@pytest.mark.long(but=1)
@_table("column cell fragments", [(f"{row[0]} = {row[1]}", *row) for row in CELLS])
def test_cell_is_rejected_with_its_place(
    place: Path, rejected: Reject, column: str, cell: str, fragments: list[str]
) -> None:
    text = f"{HEADER},{column}\n{ROW},\nb{ROW[1:]},{cell}\n"
    (place / "plan.csv").write_text(text, encoding="utf-8")
    where = [] if column in NAMES_THE_RIG else ["plan.csv:3:5:"]
    _refused(place, rejected, [*where, *fragments])


@pytest.fixture
def plan(place: Path) -> Path:
    path = place / "plan.csv"
    path.write_text(f"{HEADER}\n{ROW}\nb{ROW[1:]}\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("expression", "fragments"),
    [
        ("zzz", ["no case fits", "'zzz'", "axisrig check"]),
        ("", ["cannot be read"]),
        ("and", ["cannot be read at 'and'", "words, and, or, not, brackets"]),
        ("(plan", ["cannot be read at 'the end'"]),
        ("plan)", ["cannot be read at ')'"]),
        ("not", ["cannot be read"]),
        ("plan or or", ["cannot be read at 'or'"]),
        ("plan a", ["cannot be read at 'a'"]),
    ],
)
def test_selection(plan: Path, rejected: Reject, expression: str, fragments: list[str]) -> None:
    _holds(rejected("run", plan.name, "-o", "out", "-k", expression), *fragments)
    assert not (plan.parent / "out").exists()


def test_set_on_a_plan_names_the_option_and_not_a_cell(plan: Path, rejected: Reject) -> None:
    message = rejected("run", plan.name, "-o", "out", "--set", "plc:V.E.FEED=fast")
    assert "--set" in message
    assert "plan.csv:2:4" not in message


def test_plans_of_one_name(plan: Path, rejected: Reject) -> None:
    _holds(rejected("run", plan.name, plan.name, "-o", "out"), "same name", "plan")
    assert not (plan.parent / "out").exists()


FOREIGN = {
    "a file of mine": {"notes.txt": "mine"},
    "a manifest of mine": {"manifest.json": '{"name": "web"}', "runs/mine.json": "{}"},
    "a table of mine": {"cases.csv": "a,b\n1,2\n", "traces/mine.parquet": "x"},
}


@pytest.mark.parametrize("files", FOREIGN.values(), ids=FOREIGN)
def test_output_folder_of_somebody_else_is_left_alone(
    plan: Path, rejected: Reject, files: dict[str, str]
) -> None:
    folder = plan.parent / "out"
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    _holds(rejected("run", plan.name, "-o", "out"), "out", "no results folder")
    kept = {
        p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()
    }
    assert kept == files


def test_output_that_cannot_be_a_folder(plan: Path, rejected: Reject) -> None:
    _holds(rejected("run", plan.name, "-o", "part.nc"), "part.nc", "not a folder")
    _holds(rejected("run", plan.name, "-o", "part.nc/out"), "part.nc", "Not a directory")
    _holds(rejected("run", plan.name, "-o", "x" * 300), "name too long")


@pytest.mark.long
def test_output_folder_with_blanks_is_cleared_by_the_option(plan: Path, axisrig: Call) -> None:
    folder = plan.parent / "my results ü" / "of today"
    assert axisrig("run", plan.name, "-k", "a", "-o", folder)[0] == 0
    assert axisrig("run", plan.name, "-k", "b", "-o", folder, "--fresh")[0] == 0
    assert [path.stem for path in (folder / "traces").iterdir()] == ["plan-b"]


# ---- results folders read back


@pytest.fixture(scope="session")
def results(originals: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of one run, made once."""
    from axisrig.bench.campaign.campaign import Choice, run_campaign  # noqa: PLC0415
    from axisrig.bench.campaign.runner import no_stopwatch  # noqa: PLC0415

    place = tmp_path_factory.mktemp("results")
    shutil.copytree(originals, place, dirs_exist_ok=True)
    (place / "plan.csv").write_text(f"{HEADER}\n{ROW}\n", encoding="utf-8")
    run_campaign(
        [place / "plan.csv"], out=place / "out", select=Choice(), jobs=1, timeout_s=60.0,
        assignments=[], command=["axisrig"], started="", stopwatch=no_stopwatch,
    )  # fmt: skip
    return place / "out"


def test_folder_that_holds_no_results(place: Path, rejected: Reject) -> None:
    for folder in ("lists", "no", "part.nc"):
        _holds(rejected("report", folder), folder, "no results folder", "axisrig run -o")
        _holds(rejected("replay", folder, "plan-a"), folder, "no results folder")


def test_run_that_the_folder_does_not_hold(results: Path, rejected: Reject) -> None:
    _holds(rejected("replay", results, "plan-b"), "'plan-b'", "did you mean: plan-a")


def _cut(text: str) -> str:
    return text[:-40]


def _other(text: str, put: str) -> Callable[[str], str]:
    def change(old: str) -> str:
        assert text in old
        return old.replace(text, put)

    return change


DAMAGES: list[tuple[str, str, bytes | Callable[[str], str], tuple[str, ...]]] = [
    ("manifest empty", "manifest.json", b"", ("report", "replay")),
    ("manifest a list", "manifest.json", b"[]", ("report", "replay")),
    ("manifest without plans", "manifest.json", b"{}", ("replay",)),
    ("cases binary", "cases.csv", bytes(range(256)), ("report", "replay")),
    ("cases of another table", "cases.csv", b"a,b\n1,2\n", ("report", "replay")),
    ("cases with a cut row", "cases.csv", _cut, ("report", "replay")),
    ("unknown verdict", "cases.csv", lambda t: t.replace("pass", "super"), ("report",)),
    ("results binary", "results.csv", bytes(range(256)), ("report",)),
    ("run empty", "runs/plan-a.json", b"", ("report",)),
    ("run a list", "runs/plan-a.json", b"[]", ("report",)),
    ("run of an older version", "runs/plan-a.json", b'{"events": [], "log": []}', ("report",)),
    (
        "run of a later version",
        "runs/plan-a.json",
        _other(f'"version": {VERSION}', f'"version": {VERSION + 1}'),
        ("report",),
    ),
    ("run without a value", "runs/plan-a.json", _other('"end_ns"', '"ended_ns"'), ("report",)),
    ("trace empty", "traces/plan-a.parquet", b"", ("report",)),
    ("trace broken", "traces/plan-a.parquet", b"PAR1", ("report",)),
]


@_table("name change commands", DAMAGES)
def test_damaged_results_are_told_with_their_file(
    place: Path,
    results: Path,
    rejected: Reject,
    name: str,
    change: bytes | Callable[[str], str],
    commands: tuple[str, ...],
) -> None:
    folder = shutil.copytree(results, place / "copy")
    file = folder / name
    old = file.read_bytes()
    file.write_bytes(change if isinstance(change, bytes) else change(old.decode()).encode())
    for command in commands:
        words = [folder] if command == "report" else [folder, "plan-a"]
        assert Path(name).name in rejected(command, *words)


def test_replay_after_the_plan_has_gone(place: Path, results: Path, rejected: Reject) -> None:
    folder = shutil.copytree(results, place / "copy")
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    manifest["plans"][0]["path"] = str(place / "gone.csv")
    (folder / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    _holds(rejected("replay", folder, "plan-a"), "gone.csv", "not there any more")


def test_every_mistake_of_one_row_is_named(place: Path, axisrig: Call) -> None:
    """Parameters that do not exist, and start values that no plant has: one line for each."""
    header = "case,program,rig,plant:probe.surfce_mm,plant:probe.invertd"
    header += ",set:Z.kenngr.foo,set:channel.bar"
    rows = ["a,part.nc,rig.toml,,,2,3,none", "b,part.nc,rig.toml,5,1,,,none"]
    text = "\n".join([f"{header},check:alarms", *rows, ""])
    (place / "plan.csv").write_text(text, encoding="utf-8")
    code, _, err = axisrig("check", "plan.csv")
    assert code == 2
    places = [line.split(": ")[1] for line in err.splitlines()]
    assert places == ["plan.csv:2:6", "plan.csv:2:7", "plan.csv:3:4", "plan.csv:3:5"]


def test_all_mistakes_of_a_plan_are_reported_at_once(place: Path, axisrig: Call) -> None:
    """Of the table, of its cells, and of what only the rig knows, whatever else is wrong."""
    header = f"{HEADER},chek:alarms,check:latch_err,plant:prob.surface_mm,titel"
    rows = [
        "a,tuch.nc,no.toml,1,none,1,2,x",
        "a,part.nc,rig.toml,fast,none,1 ... 2,2,x",
    ]
    (place / "plan.csv").write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    for command in (("run", "-o", "out"), ("check",)):
        code, _, err = axisrig(command[0], "plan.csv", *command[1:])
        assert code == 2
        errors = err.splitlines()
        assert [line.split(" ")[1] for line in errors] == [
            f"plan.csv:{where}:"
            for where in ("1:5", "1:8", "2:2", "2:3", "2:6", "3:4", "3:6", "3:6", "3:7")
        ], err
        _holds(errors[5], "not a number", "'fast'")
        _holds(errors[7], "not a condition", "write 1 .. 2")
        _holds(errors[8], "no such plant", "'prob'")


def test_all_that_a_good_rig_refuses_in_a_row_is_reported_at_once(
    place: Path, axisrig: Call
) -> None:
    header = f"{HEADER},plc:V.E.FEDE,check:lag_mm_max:Q,check:msg:N999"
    (place / "plan.csv").write_text(f"{header}\n{ROW},1,<= 1,== 1\n", encoding="utf-8")
    code, _, err = axisrig("check", "plan.csv")
    assert code == 2
    places = [line.split(" ")[1] for line in err.splitlines()]
    assert places == [f"plan.csv:2:{column}:" for column in (5, 6, 7)], err
