"""Subprograms in the file of the main program and in files of their own."""

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import LinearMove, Warn
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import read_program

XYZ = ("X", "Y", "Z")


def moves_of(commands):
    return [c.target_mm["X"] for c in commands if isinstance(c, LinearMove)]


def path(run, text):
    return moves_of(run(text))


@pytest.fixture
def files(tmp_path, plane_machine):
    """Write files and run the one that is called main.nc."""

    def run_files(**texts):
        for name, text in texts.items():
            (tmp_path / f"{name}.nc").write_text(text, encoding="utf-8")
        program = read_program(tmp_path / "main.nc", XYZ)
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
        return moves_of(Interpreter(program, XYZ, machine, external={}).commands())

    return run_files


# ---- in the same file


@pytest.mark.parametrize("end", ["M17\n", "M29\n", "", "M17\nX9\n"])
def test_a_local_subprogram_comes_back_behind_its_call(run, end):
    """Programming manual 206828043: M17, M29 and the end of its text lead back."""
    assert path(run, f"%L SUB\nG0 X1\n{end}%MAIN\nLL SUB\nX2\nLL SUB\nX3") == [1, 2, 1, 3]


def test_subprograms_call_each_other(run):
    text = "%L INNER\nX1\n%L OUTER\nX2\nLL INNER\nX3\n%MAIN\nG0\nLL OUTER\nX4"
    assert path(run, text) == [2, 1, 3, 4]


def test_parameters_carry_values_in_and_out(run):
    """Programming manual 206822155: by P parameters."""
    assert path(run, "%L TWICE\nP2=P1*2\n%MAIN\nG0 P1=4\nLL TWICE\nX=P2") == [8]


@pytest.mark.provokes(900125, 1, word="M30", name="SUB")
def test_900125_warns_of_m30_in_a_subprogram_which_ends_the_program(run):
    commands = run("%L SUB\nX1 M30\n%MAIN\nG0\nLL SUB\nX2")
    assert moves_of(commands) == [1]
    (warning,) = (c.alarm for c in commands if isinstance(c, Warn))
    assert (warning.id, warning.ends_program) == (900125, False)


@pytest.mark.parametrize(
    ("block", "word"),
    [("M30", "M30"), ("M2", "M2"), ("M10 M30", "M30"), ("M30 M10", "M30"), ("M10 M2", "M2")],
)
def test_900125_names_the_word_that_ends_the_program_and_the_subprogram(run, block, word):
    """Other M functions of the block do not; nor is a warned word one of the main program."""
    commands = run(f"%L INNER\n{block}\n%L OUTER\nLL INNER\nX9\n%MAIN\nG0\nLL OUTER\nX8")
    (warning,) = (c.alarm for c in commands if isinstance(c, Warn))
    assert (warning.id, warning.values) == (900125, {"word": word, "name": "INNER"})
    assert moves_of(commands) == []
    assert [c for c in run(f"G0 X1\n{block}") if isinstance(c, Warn)] == []


def test_modal_words_go_on_behind_the_return(run):
    assert path(run, "%L SUB\nG91\n%MAIN\nG0 X1\nLL SUB\nX1") == [1, 2]


def test_the_same_label_in_two_parts_is_two_labels(run):
    text = "%L SUB\n$GOTO [A]\nX9\n[A] X1\n%MAIN\nG0\nLL SUB\n$GOTO [A]\nX8\n[A] X2"
    assert path(run, text) == [1, 2]


def test_an_unknown_local_subprogram_is_refused_with_the_nearest_names(run):
    with pytest.raises(UserError) as caught:
        run("%L PROBE\nX1\n%MAIN\nX0\nLL PROB")
    assert (caught.value.line, "PROBE" in str(caught.value)) == (5, True)


@pytest.mark.provokes(20360, 2, name="SUB", limit=50)
def test_20360_for_a_subprogram_that_calls_itself_for_ever(run):
    with pytest.raises(Alarm) as caught:
        run("%L SUB\nLL SUB\n%MAIN\nLL SUB")
    assert caught.value.id == 20360


def test_calls_may_go_fifty_deep(run):
    text = "%L SUB\nP1=P1+1\n$IF P1<50\nLL SUB\n$ENDIF\n%MAIN\nG0 P1=0\nLL SUB\nX=P1"
    assert path(run, text) == [50]


# ---- V.L


def test_a_local_variable_ends_with_its_subprogram(run):
    text = "%L SUB\nV.L.A=1\nX=V.L.A\n%MAIN\nG0\nLL SUB\nX=V.L.A"
    with pytest.raises(Alarm) as caught:
        run(text)
    assert (caught.value.id, caught.value.values["name"]) == (900113, "V.L.A")


def test_a_local_variable_is_known_in_what_is_called(run):
    """Programming manual 207981323: in the level that made it and in those below."""
    assert path(run, "%L SUB\nX=V.L.A\nV.L.A=2\n%MAIN\nG0 V.L.A=1\nLL SUB\nX=V.L.A*10") == [1, 20]


def test_a_local_variable_that_is_declared_again_hides_the_other_one(run):
    text = (
        "%L SUB\n#VAR\nV.L.A=5\n#ENDVAR\nX=V.L.A\n"
        "%MAIN\n#VAR\nV.L.A=1\n#ENDVAR\nG0\nLL SUB\nX=V.L.A"
    )
    assert path(run, text) == [5, 1]


# ---- in files of their own


def test_a_global_subprogram_is_a_file_beside_the_main_program(files):
    assert files(main="G0 X1\nL sub.nc\nX3", sub="X2\nM17") == [1, 2, 3]


def test_the_extension_may_be_left_out(files):
    assert files(main="G0 X1\nL sub\nX3", sub="%sub\nX2") == [1, 2, 3]


def test_a_global_subprogram_has_local_ones_of_its_own(files):
    sub = "%L PART\nX2\n%SUB\nLL PART\nX3"
    assert files(main="%L PART\nX1\n%MAIN\nG0\nLL PART\nL sub.nc", sub=sub) == [1, 2, 3]


def test_a_missing_file_says_where_it_was_looked_for(files, tmp_path):
    with pytest.raises(UserError) as caught:
        files(main="X1\nL subb.nc", sub="X2")
    text = str(caught.value)
    assert caught.value.line == 2
    assert str(tmp_path / "subb.nc") in text
    assert "nearest: sub.nc" in text


def test_errors_in_a_global_subprogram_carry_its_own_file_name(files, tmp_path):
    with pytest.raises(UserError) as caught:
        files(main="L sub.nc", sub="X1\n$IF 1")
    assert (caught.value.file, caught.value.line) == (str(tmp_path / "sub.nc"), 2)


def test_alarms_in_a_global_subprogram_carry_its_own_file_name(files):
    with pytest.raises(Alarm) as caught:
        files(main="P1=0\nL sub.nc", sub="G0\nN20 X=1/P1")
    assert "sub.nc line 2, block N20" in str(caught.value.place)


def test_alarms_of_the_machine_carry_the_file_of_their_block(tmp_path, plane_machine):
    """What comes up in a cycle knows the block only."""
    (tmp_path / "main.nc").write_text("L sub.nc", encoding="utf-8")
    (tmp_path / "sub.nc").write_text("G0\nN20 X7", encoding="utf-8")
    program = read_program(tmp_path / "main.nc", XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    move, *_ = Interpreter(program, XYZ, machine, external={}).commands()
    assert move.block.place == f"{tmp_path / 'sub.nc'} line 2, block N20"


def test_files_may_call_each_other_as_long_as_they_come_back(files):
    main = "G0 P1=0\nL a.nc\nX9"
    assert files(main=main, a="P1=P1+1\nX=P1\n$IF P1<3\nL b.nc\n$ENDIF", b="L a.nc") == [1, 2, 3, 9]


def test_a_file_is_looked_for_beside_the_main_program_and_then_beside_its_caller(files, tmp_path):
    (tmp_path / "lib" / "deep").mkdir(parents=True)
    (tmp_path / "lib" / "first.nc").write_text("X1\nL second\nL deep/third.nc", encoding="utf-8")
    (tmp_path / "lib" / "second.nc").write_text("X2", encoding="utf-8")
    (tmp_path / "lib" / "deep" / "third.nc").write_text("X3\nL fourth", encoding="utf-8")
    (tmp_path / "lib" / "deep" / "fourth.nc").write_text("X4", encoding="utf-8")
    main = "G0\nL lib/first.nc\nX9"
    assert files(main=main) == [1, 2, 3, 4, 9]
    assert files(main=main, second="X12", fourth="X14") == [1, 12, 3, 14, 9]
    with pytest.raises(UserError) as caught:
        files(main="G0\nL first")
    assert caught.value.file == str(tmp_path / "main.nc")
