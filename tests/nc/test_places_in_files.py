"""Where something is wrong in a program of several files: its file, line, column, and the line."""

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.decoder import Interpreter, check_program
from axisrig.kernel.nc.text.parser import parse_program, read_program

XYZ = ("X", "Y", "Z")


@pytest.fixture
def play(tmp_path, plane_machine):
    """Write files and run main.nc, the first program of the given ones."""

    def run(**texts):
        for name, text in texts.items():
            (tmp_path / f"{name}.nc").write_text(text, encoding="utf-8")
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
        program = read_program(tmp_path / "main.nc", XYZ)
        return list(Interpreter(program, XYZ, machine, external={"READY": 0.0}).commands())

    return run


def refused(play, **texts):
    with pytest.raises(UserError) as caught:
        play(**texts)
    return caught.value


WRONG = [
    # what is wrong in a block that begins in column 3, its column, the value
    ("$GOTO [IN]", 9, "[IN]"),
    ("L gone", 5, "gone"),
    ("L CYCLE [NAME=gone.cyc]", 17, "gone.cyc"),
    ("P1=V.P.NOBODY", 6, "V.P.NOBODY"),
    ("P1=V.E.REDY", 6, "V.E.REDY"),
    ("$FOR V.E.READY=1,2,1", 8, "V.E.READY"),
]


@pytest.mark.parametrize("file", ["main", "sub"])
@pytest.mark.parametrize(("block", "column", "value"), WRONG)
def test_what_only_the_whole_program_shows_has_its_place_and_its_line(
    play, tmp_path, file, block, column, value
):
    end = "\n$ENDFOR" if "$FOR" in block else ""
    wrong = f"X1\n  {block}{end}\n$WHILE 0\n[IN] X2\n$ENDWHILE\nM17"
    texts = {"main": wrong} if file == "main" else {"main": "X0\nL sub\nM30", "sub": wrong}
    error = refused(play, **texts)
    assert (error.file, error.line) == (str(tmp_path / f"{file}.nc"), 2)
    assert (error.column, error.value) == (column, value)
    line, mark = (each.partition("| ")[2] for each in (error.excerpt or "").splitlines())
    assert line == f"  {block}"
    assert mark.index("^") == column - 1


def test_a_text_without_a_file_has_no_line_to_show():
    with pytest.raises(UserError) as caught:
        check_program(parse_program("X1\nX=V.P.NOBODY", axes=XYZ))
    assert (caught.value.file, caught.value.line, caught.value.column) == (None, 2, 3)


def test_a_missing_file_is_looked_for_beside_the_main_program_and_beside_its_caller(play, tmp_path):
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "inner.nc").write_text("L near\nM17", encoding="utf-8")
    (tmp_path / "below" / "near2.nc").write_text("M17", encoding="utf-8")
    error = refused(play, main="L below/inner.nc\nM30")
    assert error.file == str(tmp_path / "below" / "inner.nc")
    tried = [tmp_path / name for name in ("near", "near.nc", "below/near", "below/near.nc")]
    assert error.allowed == f"a file at {', '.join(map(str, tried))}"
    assert error.hint == "nearest: near2.nc"
    (tmp_path / "below" / "near.nc").write_text("G0 X2\nM17", encoding="utf-8")
    assert [c.target_mm for c in play() if hasattr(c, "target_mm")] == [{"X": 2.0}]
    (tmp_path / "near.nc").write_text("G0 X1\nM17", encoding="utf-8")  # it comes first
    assert [c.target_mm for c in play() if hasattr(c, "target_mm")] == [{"X": 1.0}]


def test_a_name_with_a_suffix_is_that_file_alone(play, tmp_path):
    error = refused(play, main="L other.sub\nM30")
    assert error.allowed == f"a file at {tmp_path / 'other.sub'}"
    (tmp_path / "other.sub.nc").write_text("M17", encoding="utf-8")
    assert refused(play, main="L other.sub\nM30").value == "other.sub"


def test_an_alarm_is_placed_in_the_file_of_its_block_and_after_the_call_in_that_of_the_caller(
    play, tmp_path
):
    for main, file, line in (
        ("G0 X1\nL sub\nX2\nM30", "sub", 3),
        ("G0 X1\nL good\n\nN40 D7\nM30", "main", 4),
        ("%L LOCAL\nN5 D7\nM17\n%MAIN\nL good\nLL LOCAL", "main", 2),
    ):
        with pytest.raises(Alarm) as caught:
            play(main=main, sub="G0 X2\n\nD7\nM17", good="G0 X5\nM17")
        number = {4: ", block N40", 2: ", block N5"}.get(line, "")
        assert caught.value.place == f"{tmp_path / f'{file}.nc'} line {line}{number}"


@pytest.mark.parametrize(
    ("block", "alarm_id"), [("#KIN ID [7777]", 292005), ("#TRAFO [98]", 900441)]
)
@pytest.mark.parametrize("file", ["main", "sub"])
def test_an_alarm_of_a_kinematic_has_the_file_of_its_block_too(
    play, tmp_path, file, block, alarm_id
):
    wrong = f"G0 X1\nN20 {block}\nM17"
    texts = {"main": wrong} if file == "main" else {"main": "G0\nL sub\nM30", "sub": wrong}
    with pytest.raises(Alarm) as caught:
        play(**texts)
    place = f"{tmp_path / f'{file}.nc'} line 2, block N20"
    assert (caught.value.id, caught.value.place) == (alarm_id, place)
