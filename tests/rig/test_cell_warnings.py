"""Cells that can be run and are hardly meant: a length without unit, a variable nobody reads."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.checking import check_file, check_inputs
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError

TESTPLANS = Path(__file__).parents[2] / "testplans"
FILES = f"{TESTPLANS}/programs/probe-z.nc,{TESTPLANS}/rigs/probe-z.toml"


def warnings_of(folder: Path, header: str, *cells: str) -> list[str]:
    path = folder / "touch.csv"
    rows = [f"r{number},{FILES},{text}\n" for number, text in enumerate(cells)]
    path.write_text(f"case,program,rig,plc:V.E.FEED,{header}\n" + "".join(rows), "utf-8")
    lines = check_file(path).splitlines()
    return [line.replace(f"{path}:", "") for line in lines if line.startswith("warning: ")]


def test_a_length_without_unit_counts_in_metres_and_the_check_says_so(tmp_path: Path) -> None:
    found = warnings_of(tmp_path, "plant:probe.surface", "600,0.02", "600,")
    (text,) = found
    assert text.startswith("warning: 2:5: plant:probe.surface names no unit, so 0.02 counts in m;")
    assert "plant:probe.surface_mm" in text


def test_a_start_value_of_the_rig_without_unit_is_named_too(tmp_path: Path) -> None:
    """surface = 100 is 100 m, in the rig as in a plan."""
    rig = tmp_path / "metres.toml"
    base = f'base = "{TESTPLANS}/rigs/probe-z.toml"\n'
    rig.write_text(base + "[plant.probe.start]\nsurface = 0.1\n", "utf-8")
    words = "start value probe.surface names no unit and counts in m; with a unit: surface_"
    assert words in check_file(rig)
    path = tmp_path / "touch.csv"
    path.write_text(
        f"case,program,rig,plc:V.E.FEED\na,{TESTPLANS}/programs/probe-z.nc,{rig},600\n", "utf-8"
    )
    assert words in check_file(path)


@pytest.mark.parametrize(
    ("header", "value"),
    [("plant:probe.surface_mm", "20"), ("plant:z.kv", "40"), ("plant:z.coulomb_friction", "0")],
)
def test_units_that_are_named_or_without_doubt_give_no_warning(
    tmp_path: Path, header: str, value: str
) -> None:
    assert warnings_of(tmp_path, header, f"600,{value}") == []


def test_a_variable_that_no_program_and_no_moment_uses_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"touch\.csv:2:5: plc:V\.E\.FED is not used: .*V\.E\.FEED"):
        warnings_of(tmp_path, "plc:V.E.FED,plc:V.E.feed", "600,5,")


def test_a_variable_that_a_moment_waits_for_is_used(tmp_path: Path) -> None:
    header = "plc:V.E.GO,plc:feedhold"
    assert warnings_of(tmp_path, header, "600,0; 1 at=100ms,at=V.E.GO=1 for=5ms") == []


def test_a_default_is_used_when_one_of_its_rows_does(tmp_path: Path) -> None:
    other = tmp_path / "other.nc"
    other.write_text("N10 G1 G90 Z10 F600\nN20 M30\n", "utf-8")
    rig = f"{TESTPLANS}/rigs/probe-z.toml"
    path = tmp_path / "touch.csv"
    rows = f"*,,{rig},600\na,{TESTPLANS}/programs/probe-z.nc,,\nb,other.nc,,\n"
    path.write_text(f"case,program,rig,plc:V.E.FEED\n{rows}", "utf-8")
    assert "warning" not in check_file(path)
    path.write_text(
        f"case,program,rig,plc:V.E.FEED\n{rows.replace(chr(10) + 'a,', chr(10) + '#a,')}", "utf-8"
    )
    assert "warning: " in check_file(path)


def test_a_plan_is_expanded_only_with_values_that_its_rig_takes(tmp_path: Path) -> None:
    path = tmp_path / "touch.csv"
    cells = "plc:V.E.FEED,set:Z.kenngr.measure.edge,check:duration_s"
    rows = f"a,{FILES},[300 | sechs],[POS | NEG],\nb,{FILES},600,[POS | UP],\n"
    path.write_text(f"case,program,rig,{cells}\n{rows}", "utf-8")
    with pytest.raises(UserError) as caught:
        check_inputs(read_plan(path))
    errors = (caught.value, *caught.value.further)
    assert [(e.line, e.column, e.value) for e in errors] == [(2, 4, "sechs"), (3, 5, "UP")]


@pytest.mark.parametrize(
    "cell",
    [
        "at=100ms until=V.E.GO=1",
        "at=V.E.GO=1 until=M50",
        "at=M50 for=5ms; at=M51 until=V.E.GO=1",
    ],
)
def test_a_variable_that_ends_a_feedhold_is_used_as_one_that_begins_it(
    tmp_path: Path, cell: str
) -> None:
    assert warnings_of(tmp_path, "plc:V.E.GO,plc:feedhold", f"600,0,{cell}") == []
