"""`axisrig nc --check`: everything wrong with a program at once, with the place under a caret."""

import pytest

from axisrig.bench.cli.main import main
from axisrig.kernel.nc.text.check import axes_of, check_program

XYZ = ("X", "Y", "Z")


def checked(text, axes=XYZ):
    return check_program(text, "p.nc", axes)


def test_every_wrong_block_is_told_not_only_the_first():
    found = checked("G0 X1\nG777 X1\nG0 Q3\nX=V.A.MES.X\nM30")
    assert [(error.line, error.column) for error in found.errors] == [(2, 1), (3, 4), (4, 3)]
    assert found.blocks == 5


def test_a_bracket_that_is_not_closed_hides_its_own_block_only():
    found = checked("N10 #CS ON[0,0,33\nN20 G777\nN30 G0 X1")
    assert [(error.line, error.column) for error in found.errors] == [(1, 11), (2, 5)]


def test_a_text_that_is_not_closed_hides_its_own_line_only():
    found = checked('#MSG ["a\nG777\n')
    assert [error.line for error in found.errors] == [1, 2]


def test_what_does_not_act_is_a_note_and_no_error():
    found = checked("N10 G42\nN20 G41 X1")
    assert found.errors == ()
    assert [(note.line, note.column, note.text.split()[0]) for note in found.notes] == [
        (1, 5, "G42"),
        (2, 5, "G41"),
    ]


def test_what_is_read_in_another_way_is_a_note():
    notes = checked("Nxx G0 X1\n#KIN ID[9.98]").notes
    assert notes[0].text == "Nxx read as a block without number"
    assert "read as [9,98]" in " ".join(note.text for note in notes)


@pytest.mark.parametrize(
    ("text", "excerpt"),
    [
        ("N10 G777 X1", "    1 | N10 G777 X1\n      |     ^^^^"),
        ("G0 X1\n  X=SINE[3]", "    2 |   X=SINE[3]\n      |     ^^^^"),
        ("G1 X\t?", "    1 | G1 X ?\n      |    ^"),
        ("X=", "    1 | X=\n      |   ^"),
    ],
)
def test_the_caret_stands_under_the_place(text, excerpt):
    assert checked(text).errors[0].excerpt == excerpt


def test_a_long_line_shows_the_part_around_the_place():
    excerpt = checked("X=" + "1+" * 500 + "SINE[1]" + "+1" * 500).errors[0].excerpt
    shown, caret = excerpt.split("\n")
    assert len(shown) < 120
    begin = caret.index("^")
    assert shown[begin : begin + caret.count("^")] == "SINE"


def test_axes_without_a_rig_are_the_usual_letters_and_numbered_ones_of_the_program():
    assert axes_of("G0 X100 X2=0\nZ10[INDP_SYN POS=3]\nV.P.Y1=3") == (
        *("X", "Y", "Z", "A", "B", "C", "U", "V", "W"),
        *("X2", "Z10"),
    )


def check_file(tmp_path, capsys, text, *options):
    file = tmp_path / "p.nc"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["nc", "--check", str(file), *options])
    return ended.value.code, *capsys.readouterr()


def test_a_sound_program_ends_with_0(tmp_path, capsys):
    code, out, err = check_file(tmp_path, capsys, "%A\nN10 G0 X1\nN20 M30\n")
    assert (code, err) == (0, "")
    assert out.endswith("p.nc: 2 blocks, no errors, no notes\n")


def test_errors_end_with_2_and_show_their_line(tmp_path, capsys):
    code, out, err = check_file(tmp_path, capsys, "N10 G777 X1\nN20 #TIME 71\nN30 G0 Q1 \n")
    assert code == 2
    assert err.count("error: ") == 2
    assert "    1 | N10 G777 X1\n      |     ^^^^\n" in err
    assert out.endswith("p.nc: 3 blocks, 2 errors, no notes\n")


def test_the_rig_gives_the_axes(tmp_path, capsys):
    rig = "testplans/rigs/probe-xyz.toml"
    assert check_file(tmp_path, capsys, "G0 C1\n", "--rig", rig)[0] == 2
    assert check_file(tmp_path, capsys, "G0 C1\n")[0] == 0


def test_a_run_without_a_rig_is_refused(tmp_path, capsys):
    file = tmp_path / "p.nc"
    file.write_text("M30\n", encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["nc", str(file)])
    assert ended.value.code == 2
    assert "--check" in capsys.readouterr().err


def test_an_error_of_a_run_shows_its_line_too(tmp_path, capsys):
    file = tmp_path / "p.nc"
    file.write_text("N10 G777\n", encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["nc", str(file), "--rig", "testplans/rigs/probe-xyz.toml"])
    assert "      |     ^^^^\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    [
        "$IF V.A.MES.X\nG0 X1\n$ELSE\nG0 X2\n$ENDIF",
        "N5 $FOR P1=1,\nG0 X1\n$ENDFOR",
        "/ N5 $WHILE 1+\n$BREAK\n$ENDWHILE",
        "N10: G777\n$GOTO N10",
        "[A] G777\n$GOTO [A]",
        "$IF Q $GOTO [A]\n[A] G0 X1",
    ],
)
def test_a_wrong_block_does_not_make_those_wrong_that_belong_to_it(text):
    assert [error.line for error in checked(text).errors] == [1]


def test_a_hundred_errors_are_enough():
    found = checked("G777\n" * 5000)
    assert [error.line for error in found.errors] == list(range(1, 101))


def test_a_sound_text_says_that_values_show_in_a_run(tmp_path, capsys):
    _, out, _ = check_file(tmp_path, capsys, "G4\nM30\n")
    assert "whether its values can be carried out shows in a run" in out
    _, out, _ = check_file(tmp_path, capsys, "G777\n")
    assert "shows in a run" not in out


def test_a_missing_file_is_told_beside_other_errors(tmp_path, capsys):
    code, _, err = check_file(tmp_path, capsys, "G777\nL nofile\nL nofile\nM30\n")
    assert code == 2
    assert err.count("error: ") == 2
    assert "allowed: a file at " in err


@pytest.mark.parametrize(
    ("text", "alarm"),
    [
        ("D-1", 900155),
        ("M1000", 20160),
        ("G4", 900171),
        ("G4 X-1", 20752),
        ("G2 X10 Y10 F500", 20036),
        ("X[INDP_SYN POS10 G0 G1 FEED=5]", 900194),
        ("X[INDP_ASYN POS10 FEED=-5]", 50603),
        ("X[INDP_ASYN POS10 FEED=5] Y[INDP_SYN POS10 TIME=-1]", 50603),
        ("G4 Y-1", 900171),  # only the first main axis has the time
    ],
)
def test_constants_that_no_run_can_carry_out_are_noted_with_their_alarm(text, alarm):
    (note,) = checked(f"G0 X1\n{text}\nM30").notes
    assert note.line == 2
    assert f"(ID {alarm})" in note.text


@pytest.mark.parametrize(
    "text", ["D=P1", "M999", "G4 0", "G4 X2", "G2 X1 I5", "G2 R5\nG2 X9", "G2", "G4=V.E.T"]
)
def test_what_may_be_right_in_a_run_is_not_noted(text):
    assert not [note for note in checked(text).notes if "a run ends here" in note.text]


def test_a_var_that_is_not_closed_ends_with_its_part_of_the_file():
    found = checked("%L A\nG0 X1\n#VAR\nV.P.A\n%L B\nG0 X1\nV.P.B = 1\n%MAIN\nG0 X2\nLL B\nM30")
    assert [(error.line, error.message) for error in found.errors] == [(3, "#VAR is not closed")]
    found = checked("%L A\n$IF 1\n%L B\n[X1]\n%MAIN\n[X1] G0 X2\nM30")
    assert [(error.line, error.message) for error in found.errors] == [(2, "$IF is not closed")]


def test_what_does_not_act_in_a_subprogram_is_a_note_too():
    found = checked("%L A\nG42\n%L B\nG0 X1\nG41 X2\n%MAIN\nLL A\nG40\nM30")
    assert [(note.line, note.text.split()[0]) for note in found.notes] == [(2, "G42"), (5, "G41")]
