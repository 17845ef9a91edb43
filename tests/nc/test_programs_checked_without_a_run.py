"""What a check finds in a program and in every file that it can reach, before anything runs."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.decoder import check_program
from axisrig.kernel.nc.decoder.base.subprograms import missing_files
from axisrig.kernel.nc.text.parser import parse_program, read_program

XYZ = ("X", "Y", "Z")
Check = Callable[..., Any]


@pytest.fixture
def check(tmp_path: Path) -> Check:
    """Write files by their names without extension, and check `main`."""

    def checked(external: Mapping[str, float] | None = None, **texts: str) -> Any:
        for name, text in texts.items():
            (tmp_path / f"{name}.nc").write_text(text, encoding="utf-8")
        return check_program(read_program(tmp_path / "main.nc", XYZ), external)

    return checked


def refused(check: Check, external: Mapping[str, float] | None, **texts: str) -> UserError:
    with pytest.raises(UserError) as caught:
        check(external, **texts)
    return caught.value


# Where a wrong block may be: its file, and the texts with `{}` in its place
REACHED = [
    ("main", 2, {"main": "G0\n{}"}),
    ("main", 2, {"main": "%L UP\n{}\nM17\n%MAIN\nLL UP"}),
    ("sub", 2, {"main": "L sub", "sub": "G0\n{}"}),
    ("sub", 3, {"main": "L sub", "sub": "%L UP\nG0\n{}\nM17\n%SUB\nLL UP"}),
    ("two", 1, {"main": "L one\nL two", "one": "X1", "two": "{}"}),
    ("two", 1, {"main": "L one", "one": "L two", "two": "{}"}),
    ("two", 1, {"main": "L one\nX1", "one": "%L UP\nL two\nM17\n%ONE\nLL UP", "two": "{}"}),
    ("two", 1, {"main": "%L UP\nL one\nL two\nM17\n%MAIN\nLL UP", "one": "X1", "two": "{}"}),
    ("two", 1, {"main": "L one\nL CYCLE [NAME=two.nc]", "one": "L one.nc", "two": "{}"}),
]
WRONG = [
    ("X=V.P.NOBODY", "V.P.NOBODY", "variable is read and never written"),
    ("X=V.L.NOBODY", "V.L.NOBODY", "variable is read and never written"),
    ("$FOR V.E.A = 1, 2, 1\n$ENDFOR", "V.E.A", "$FOR cannot count in a variable of the PLC side"),
    ("X=V.E.OTHER", "V.E.OTHER", "the PLC side has no such variable"),
    ("V.E.OTHER=1", "V.E.OTHER", "the PLC side has no such variable"),
    ("$GOTO [A]\n$WHILE 1\n[A] X1\n$ENDWHILE", "[A]", "$GOTO leads into $WHILE"),
]


@pytest.mark.parametrize(("block", "value", "message"), WRONG)
@pytest.mark.parametrize(("file", "line", "texts"), REACHED)
def test_a_wrong_block_is_found_in_each_text_that_a_run_can_reach(
    check: Check,
    tmp_path: Path,
    block: str,
    value: str,
    message: str,
    file: str,
    line: int,
    texts: dict[str, str],
) -> None:
    filled = {name: text.replace("{}", block) for name, text in texts.items()}
    error = refused(check, {"A": 0.0}, **filled)
    assert error.message.startswith(message)
    assert (error.file, error.line) == (str(tmp_path / f"{file}.nc"), line)
    assert error.value == value
    assert error.column == block.index(value) + 1
    if file != "main":  # nobody calls it: nothing of it counts
        check({"A": 0.0}, **{**filled, "main": "G0 X1"})


@pytest.mark.parametrize(
    ("text", "is_right"),
    [
        ("V.P.A=1\nX=V.P.A\n#VAR\nV.P.AB[3]\n#ENDVAR\nX=V.P.AB[1]", True),
        ("#VAR\nV.P.A[2]\n#ENDVAR\nV.P.AB=1\nX=V.P.AB+V.P.A[0]", True),
        ("#VAR\nV.P.A[2]\n#ENDVAR\nX=V.P.A", False),
        ("#VAR\nV.P.A[2]\n#ENDVAR\nX=V.P.A[1][1]", False),
        ("V.P.A[1]=2\nX=V.P.A[1]", False),
    ],
)
def test_an_array_is_one_by_its_whole_name_and_its_dimensions(text: str, is_right: bool) -> None:
    program = parse_program(text, file="p.nc", axes=XYZ)
    if is_right:
        check_program(program)
        return
    with pytest.raises(UserError) as caught:
        check_program(program)
    assert str(caught.value.value).startswith("V.P.A")


PLC = {"GAP": 0.0, "List[1]": 0.0, "LIST[2]": 0.0, "Grid[1][2]": 0.0, "Kin[1].Pos": 0.0}


@pytest.mark.parametrize("name", ["GAP", "LIST[1]", "LIST[P1]", "GRID[1][2]", "KIN[1].POS"])
def test_what_the_plc_side_has_may_be_read_and_written(name: str) -> None:
    """An index may be computed: which one it is the run shows."""
    for text in (f"X=V.E.{name}", f"V.E.{name}=1", f"x=v.e.{name.lower()}"):
        check_program(parse_program(text, file="p.nc", axes=XYZ), PLC)


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("GAP[1]", "GAP[]"), ("LIST", "LIST"), ("LIST[1][2]", "LIST[][]"), ("GRID[1]", "GRID[]"),
        ("KIN[1]", "KIN[]"), ("KIN[1].VEL", "KIN[].VEL"), ("KIN.POS", "KIN.POS"), ("GA", "GA"),
    ],
)  # fmt: skip
def test_a_variable_of_the_plc_side_has_its_dimensions_and_its_fields(
    name: str, shown: str
) -> None:
    """Another number of indices, or another field, is another variable, and there is none."""
    for text in (f"Y1 X=V.E.{name}", f"Y1 V.E.{name}=1"):
        with pytest.raises(UserError) as caught:
            check_program(parse_program(text, file="p.nc", axes=XYZ), PLC)
        assert caught.value.message == "the PLC side has no such variable"
        assert (caught.value.value, caught.value.line) == (f"V.E.{shown}", 1)
        assert caught.value.column == text.index("V.E.") + 1
    check_program(parse_program(f"X=V.E.{name}", file="p.nc", axes=XYZ))  # not known yet


@pytest.mark.parametrize("index", ["3", "0"])
def test_an_index_that_the_plc_side_lacks_shows_in_the_run(run: Any, index: str) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"X=V.E.LIST[{index}]", external=PLC)
    assert caught.value.id == 900113
    assert caught.value.values["name"] == f"V.E.LIST[{index}]"
    assert "V.E.LIST[2]" in caught.value.values["near"]


def test_near_names_of_a_missing_file_are_those_of_its_name_alone(tmp_path: Path) -> None:
    """Whatever folder is before it."""
    (tmp_path / "stroke.nc").write_text("X1", encoding="utf-8")
    (tmp_path / "main.nc").write_text("L some/long/folder/strokes.nc", encoding="utf-8")
    (error,) = missing_files(read_program(tmp_path / "main.nc", XYZ))
    assert (error.value, error.hint) == ("some/long/folder/strokes.nc", "nearest: stroke.nc")
