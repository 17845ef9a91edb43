"""Files of global subprograms and cycles: where they are looked for, and whose error it is."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.decoder.base.subprograms import link, missing_files, reachable
from axisrig.kernel.nc.text.parser import parse_program, read_program

XYZ = ("X", "Y", "Z")


@pytest.fixture
def linked(tmp_path: Path):
    """Write files by their path without extension, and link `main`."""

    def make(**texts: str):
        for name, text in texts.items():
            path = tmp_path / f"{name.replace('__', '/')}.nc"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return link(read_program(tmp_path / "main.nc", XYZ))

    return make


def refused(linked, **texts: str) -> UserError:
    with pytest.raises(UserError) as caught:
        linked(**texts)
    assert caught.value.message == "the file of the global subprogram is not there"
    return caught.value


CALLS = [
    ("L none.nc", "none.nc", 3), ("N10 L none", "none", 7), ("L NONE.NC", "NONE.NC", 3),
    ("L CYCLE [NAME=none.nc]", "none.nc", 15),
]  # fmt: skip


@pytest.mark.parametrize(("call", "value", "column"), CALLS)
def test_a_missing_file_is_the_error_of_the_text_that_calls_it(
    linked, tmp_path: Path, call: str, value: str, column: int
) -> None:
    """Of the main program, of a file that it calls, and of one that this one calls."""
    found = [
        refused(linked, main=f"G0\n{call}"),
        refused(linked, main="L sub", sub=f"G0\n{call}"),
        refused(linked, main="L sub", sub="L deep/part", deep__part=f"G0\n{call}"),
        refused(linked, main=f"%L UP\n{call}\nM17\n%MAIN\nLL UP"),
    ]
    files = ("main.nc", "sub.nc", "deep/part.nc", "main.nc")
    for error, file in zip(found, files, strict=True):
        assert error.file == str(tmp_path / file)
        assert (error.line, error.column, error.value) == (2, column, value)


def test_the_places_where_it_was_looked_for_are_those_of_main_program_and_caller(
    linked, tmp_path: Path
) -> None:
    """Without an extension as it is and with .nc, with one as it is; beside the main one first."""
    error = refused(linked, main="L deep/part", deep__part="L none")
    tried = [tmp_path / "none", tmp_path / "none.nc", tmp_path / "deep" / "none",
             tmp_path / "deep" / "none.nc"]  # fmt: skip
    assert error.allowed == f"a file at {', '.join(map(str, tried))}"
    error = refused(linked, main="L none.cyc")
    assert error.allowed == f"a file at {tmp_path / 'none.cyc'}"
    error = refused(linked, main=f"L {tmp_path}/none")
    assert error.allowed == f"a file at {tmp_path / 'none'}, {tmp_path / 'none.nc'}"


def test_near_names_are_those_beside_the_main_program_and_beside_the_caller(linked) -> None:
    error = refused(linked, main="L deep/part", deep__part="L stroke.nc", deep__strokes="X1")
    assert error.hint == "nearest: strokes.nc"
    error = refused(linked, main="L deep/part", deep__part="L stroke.nc", strokee="X1")
    near = str(error.hint).removeprefix("nearest: ").split(", ")
    assert sorted(near) == ["strokee.nc", "strokes.nc"]
    assert refused(linked, main="L qqqq.nc").hint is None


def test_a_text_that_is_no_file_has_no_place_to_look_at() -> None:
    with pytest.raises(UserError) as caught:
        link(parse_program("G0\nL none.nc", axes=XYZ))
    assert (caught.value.file, caught.value.line) == (None, 2)
    assert caught.value.allowed == "a file: this program has no place of its own"


def test_a_file_is_read_once_however_often_it_is_called(linked, tmp_path: Path) -> None:
    """Under both of its names; a file that calls the main program does not read it again."""
    main = linked(main="L a\nL a.nc\nL b", a="L b.nc", b="L a\nL main.nc")
    units = reachable(main)
    names = [Path(str(unit.program.file)).name for unit in units]
    assert sorted(names) == ["a.nc", "b.nc", "main.nc"]
    a, b = main.called["a"], main.called["b"]
    assert main.called["a.nc"] is a
    assert (a.called["b.nc"], b.called["a"], b.called["main.nc"]) == (b, a, main)


def test_missing_files_of_one_text_are_all_found_each_once(tmp_path: Path) -> None:
    (tmp_path / "there.nc").write_text("X1", encoding="utf-8")
    text = (
        "%L UP\nL none.nc\nM17\n%MAIN\nL there\nN5 L other\nL other\nLL UP\n"
        "L CYCLE [NAME=cycle.nc]\nL none.nc"
    )
    (tmp_path / "main.nc").write_text(text, encoding="utf-8")
    found = missing_files(read_program(tmp_path / "main.nc", XYZ))
    assert sorted((error.line, error.value) for error in found) == [
        (6, "other"), (9, "cycle.nc"), (10, "none.nc"),
    ]  # fmt: skip


def test_an_error_of_a_jump_has_the_file_that_it_is_in(linked, tmp_path: Path) -> None:
    """Into a loop; in a local subprogram of a file too."""
    loop = "$GOTO [A]\n$WHILE 1\n[A] X1\n$ENDWHILE"
    for texts, file, line in (
        ({"main": f"G0\n{loop}"}, "main.nc", 2),
        ({"main": "L sub", "sub": f"G0\n{loop}"}, "sub.nc", 2),
        ({"main": "L sub", "sub": f"%L UP\nG0\n{loop}\nM17\n%SUB\nLL UP"}, "sub.nc", 3),
    ):
        with pytest.raises(UserError, match="leads into") as caught:
            linked(**texts)
        assert (caught.value.file, caught.value.line) == (str(tmp_path / file), line)


def test_a_file_without_extension_comes_before_one_with_it(linked, tmp_path: Path) -> None:
    (tmp_path / "sub").write_text("X1", encoding="utf-8")
    unit = linked(main="G0\nL sub\nL sub.nc", sub="X2")
    found = [Path(str(unit.called[name].program.file)).name for name in ("sub", "sub.nc")]
    assert found == ["sub", "sub.nc"]
