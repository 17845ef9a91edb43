"""Cells that name a file of a drive: from the folder of their table, wherever one works."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.case_files import rig_parts
from axisrig.bench.plan.assignment import MAP_KEYS, parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.rig import contents
from axisrig.kernel.errors import UserError

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"
COLUMN = "drive:servo.pdo_map"


@pytest.fixture
def plans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a plan that includes a table of a folder below; one works in another one."""
    parts, elsewhere = tmp_path / "plans" / "parts", tmp_path / "elsewhere"
    for folder in (parts, elsewhere):
        folder.mkdir(parents=True)
    plans = parts.parent
    (plans / "probe.nc").write_text("N10 M30\n", encoding="utf-8")
    (plans / "machine.toml").write_text("[machine]\n", encoding="utf-8")
    (parts / "below.csv").write_text(
        f"case,program,rig,{COLUMN},drive:servo.eds\n"
        "own,../probe.nc,../machine.toml,maps/a.csv,\n"
        "default,../probe.nc,../machine.toml,,\n",
        encoding="utf-8",
    )
    (plans / "main.csv").write_text(
        f"case,program,rig,{COLUMN},drive:servo.eds,set:Z.a,check:alarms\n"
        "first,probe.nc,machine.toml,../maps/b.csv,x.eds,maps/c.csv,none\n"
        "include,parts/below.csv,,d.csv,,,none\n",
        encoding="utf-8",
    )
    monkeypatch.chdir(elsewhere)
    return plans


def files_of(case: Case) -> dict[str, str]:
    return {item.column: item.value for item in case.assignments()}


def test_a_file_is_named_from_the_folder_of_the_table_that_names_it(plans: Path) -> None:
    """Of an included table its own one, of a default for it that of the plan with the default."""
    first, own, default = read_plan(plans / "main.csv").cases
    assert files_of(first) == {
        COLUMN: str(plans.parent / "maps" / "b.csv"),
        "drive:servo.eds": str(plans / "x.eds"),
        "set:Z.a": "maps/c.csv",  # a value, no file
    }
    assert files_of(own) == {COLUMN: str(plans / "parts" / "maps" / "a.csv")}
    assert files_of(default) == {COLUMN: str(plans / "d.csv")}


def test_the_expanded_plan_names_the_same_files(plans: Path) -> None:
    """A row of an included table has a row of the plan there, which is in another folder."""
    plan = read_plan(plans / "main.csv")
    text = expanded_text(plan)
    (plans / "whole.csv").write_text(text, encoding="utf-8")
    again = read_plan(plans / "whole.csv")
    assert [files_of(case) for case in again.cases] == [files_of(case) for case in plan.cases]
    cells = [case.inputs[COLUMN] for case in again.cases]
    assert cells == ["../maps/b.csv", "parts/maps/a.csv", "d.csv"]
    moved = plan.with_inputs([parse_assignment(f"{COLUMN}=e.csv")])
    (plans / "whole.csv").write_text(expanded_text(moved), encoding="utf-8")
    given = str(plans.parent / "elsewhere" / "e.csv")
    assert [files_of(case)[COLUMN] for case in read_plan(plans / "whole.csv").cases] == [given] * 3


def test_what_a_plan_writes_stays_what_results_show(plans: Path) -> None:
    first, *_ = read_plan(plans / "main.csv").cases
    assert first.inputs[COLUMN] == "../maps/b.csv"


def test_the_command_line_names_files_from_where_one_works(plans: Path) -> None:
    given = [parse_assignment(f"{COLUMN}=e.csv"), parse_assignment("set:Z.a=f.csv")]
    first, *_ = read_plan(plans / "main.csv").with_inputs(given).cases
    assert files_of(first) == {
        COLUMN: str(plans.parent / "elsewhere" / "e.csv"),
        "drive:servo.eds": str(plans / "x.eds"),
        "set:Z.a": "f.csv",
    }


def test_these_files_are_those_whose_hashes_are_kept(plans: Path) -> None:
    first, *_ = read_plan(plans / "main.csv").cases
    assert rig_parts(first) == [plans.parent / "maps" / "b.csv", plans / "x.eds"]


@pytest.mark.parametrize("key", MAP_KEYS)
def test_a_cell_that_names_no_file_is_refused_with_its_place(tmp_path: Path, key: str) -> None:
    (tmp_path / "near.csv").write_text("", encoding="utf-8")
    (tmp_path / "part.nc").write_text("M30\n", encoding="utf-8")
    plan = tmp_path / "plan.csv"
    plan.write_text(
        f"case,program,rig,drive:servo.{key},check:alarms\na,part.nc,{RIG},nears.csv,none\n",
        encoding="utf-8",
    )
    (case,) = read_plan(plan).cases
    with pytest.raises(UserError, match=f"{key} names no file") as caught:
        settings_of(case)
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(plan), 2, 4)
    assert "near it: near.csv" in str(caught.value)


@pytest.mark.parametrize("key", MAP_KEYS)
@pytest.mark.parametrize("target", ["servo", "all"])
def test_a_folder_is_no_file_of_a_drive(tmp_path: Path, key: str, target: str) -> None:
    """Neither in a cell nor on the command line."""
    (tmp_path / "maps").mkdir()
    (tmp_path / "part.nc").write_text("M30\n", encoding="utf-8")
    column = f"drive:{target}.{key}"
    plan = tmp_path / "plan.csv"
    plan.write_text(
        f"case,program,rig,{column},check:alarms\na,part.nc,{RIG},maps,none\n", encoding="utf-8"
    )
    (case,) = read_plan(plan).cases
    with pytest.raises(UserError, match=f"{key} names no file") as caught:
        settings_of(case)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(plan), 2, 4)
    assert error.value == str(tmp_path / "maps")
    assert error.hint == "it is a folder"
    for named in (tmp_path / "maps", tmp_path):
        with pytest.raises(UserError, match=f"--set {column}=.*: {key} names no file"):
            contents.settings_of(RIG, [f"{column}={named}"])


@pytest.mark.parametrize(
    ("named", "hint"),
    [
        ("maps\\a.csv", "folders are separated by /: {0}/maps/a.csv"),
        ("maps/b.csv", "near it: a.csv"),
        ("maps/QQQQ", "looked in {0}/maps"),
        ("nowhere/a.csv", "looked in {0}/nowhere"),
        ("maps/a.csv/x", "looked in {0}/maps/a.csv"),
    ],
)
def test_a_file_of_a_drive_that_is_missing_is_looked_for_near_its_name(
    tmp_path: Path, named: str, hint: str
) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "a.csv").write_text("", encoding="utf-8")
    with pytest.raises(UserError, match="pdo_map names no file") as caught:
        contents.settings_of(RIG, [f"{COLUMN}={tmp_path}/{named}"])
    assert caught.value.hint == hint.format(tmp_path)
