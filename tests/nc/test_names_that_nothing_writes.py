"""V.P and V.L names that no block of a program can have made: refused before anything runs."""

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import Message
from axisrig.kernel.nc.decoder.interpreter import check_program
from axisrig.kernel.nc.text.parser import read_program

OWN = pytest.mark.parametrize("kind", ["V.P", "V.L"])
READ = "variable is read and never written"


def refused(run, text, **options):
    with pytest.raises(UserError) as caught:
        run(text, **options)
    return caught.value


def place_of(error):
    return error.file, error.line, error.column


# Where a name may be read


@OWN
@pytest.mark.parametrize(
    "block",
    [
        "G0 X={}", "G0 X1 Y={}", "X=1+{}", "X=SIN[{}]", "P1={}", "P[{}]=1", "X=P[{}]", "F={}",
        "V.P.OTHER={}", '#MSG ["%g", {}]', "$IF {}>1\n$ENDIF", "$WHILE {}>1\n$ENDWHILE",
        "$FOR P1={},2,1\n$ENDFOR", "$FOR P1=1,{},1\n$ENDFOR", "$FOR P1=1,2,{}\n$ENDFOR",
        "$SWITCH {}\n$CASE 1\n$ENDSWITCH", "#TIME [{}]", "V.G.NP[{}].V.X=1",
    ],
)  # fmt: skip
def test_a_name_is_refused_wherever_it_is_read(run, kind, block):
    """With file, line and column of the name, and the nearest one that is written."""
    name = f"{kind}.SPEDE"
    text = f"{kind}.SPEED=1\n{block.format(name)}"
    error = refused(run, text)
    assert (error.message, error.value) == (READ, name)
    lines = text.splitlines()
    assert place_of(error) == ("test.nc", 2, lines[1].index(name) + 1)
    assert f"did you mean: {kind}.SPEED" in str(error)


@OWN
def test_the_first_of_several_names_is_shown(run, kind):
    error = refused(run, f"{kind}.A=1\nX={kind}.BB\nY={kind}.CC")
    assert (error.value, error.line) == (f"{kind}.BB", 2)


@OWN
def test_a_name_that_reads_itself_is_written(run, kind):
    """The check knows no order: the alarm of the run says that it has no value yet."""
    with pytest.raises(Alarm) as caught:
        run(f"{kind}.A={kind}.A+1")
    assert (caught.value.id, caught.value.values["name"]) == (900113, f"{kind}.A")


@OWN
def test_a_block_that_is_never_reached_writes_all_the_same(run, kind):
    """But the value is missing in the run, where it is read."""
    run(f"$IF 0\n{kind}.A=1\nX={kind}.A\n$ENDIF")


def test_kinds_are_different_variables(run):
    """V.P.A is none of V.L.A; the nearest name of another kind is a help."""
    for written, read in (("V.P", "V.L"), ("V.L", "V.P"), ("V.S", "V.P"), ("V.S", "V.L")):
        error = refused(run, f"{written}.SPEED=1\nG0 X={read}.SPEED")
        assert (error.message, error.value) == (READ, f"{read}.SPEED")
        assert f"{written}.SPEED" in str(error)


@OWN
def test_without_any_name_that_is_written_there_is_no_help(run, kind):
    error = refused(run, f"G0 X={kind}.A")
    assert (error.message, error.allowed) == (READ, None)


def test_a_variable_of_the_session_may_come_from_an_earlier_program(run):
    """Only the run shows whether it has a value."""
    run("$IF 0\nX=V.S.A\n$ENDIF")
    with pytest.raises(Alarm) as caught:
        run("V.S.SPEED=1\nG0 X=V.S.SPEDE")
    assert (caught.value.id, caught.value.values["near"]) == (
        900113,
        "the nearest with one: V.S.SPEED",
    )


# How a name may be made


@OWN
@pytest.mark.parametrize(
    ("made", "value"),
    [
        ("{}=7", "7"), ("#VAR\n{}\n#ENDVAR", "0"), ("#VAR\n{} = 5\n#ENDVAR", "5"),
        ("#VAR\n{} : UNS08 = 5\n#ENDVAR", "5"), ("P1=1 {}=P1+1", "2"),
        ("$FOR {}=1,3,1\n$ENDFOR\n{}=9", "9"), ("G0 X1 {}=4", "4"),
    ],
)  # fmt: skip
def test_a_name_is_known_however_it_is_made(run, kind, made, value):
    """In any spelling of its letters."""
    for name, read in ((f"{kind}.Len_1", f"{kind}.LEN_1"), (f"{kind}.A", f"{kind.lower()}.a")):
        commands = run(f'{made.replace("{}", name)}\n#MSG ["%g", {read}]')
        assert [c.text for c in commands if isinstance(c, Message)] == [value]


@OWN
def test_a_counter_is_written_by_its_loop(run, kind):
    commands = run(f'$FOR {kind}.I=1,3,1\n#MSG ["%d", {kind}.I]\n$ENDFOR')
    assert [c.text for c in commands if isinstance(c, Message)] == ["1", "2", "3"]


@pytest.mark.parametrize("block", ["$FOR V.E.N=1,3,1\n$ENDFOR", "$FOR v.e.n=1,3,1\n$ENDFOR"])
def test_a_loop_cannot_count_on_the_side_of_the_plc(run, block):
    """What is written is there only later: the loop would not end."""
    error = refused(run, f"X1\n  N20 {block}", external={"N": 0.0})
    assert error.message == "$FOR cannot count in a variable of the PLC side"
    assert (error.line, error.value, error.allowed) == (2, "V.E.N", "P or V.P")


# Arrays


@OWN
@pytest.mark.parametrize(
    ("made", "read"),
    [
        ("{}[2]", "{}"), ("{}[2]", "{}[0][0]"), ("{}[2][2]", "{}[0]"), ("{}[2][2]", "{}"),
        ("{}", "{}[0]"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("use", ["G0 X={}", "{}=1"])
def test_an_array_of_other_dimensions_is_refused_with_those_it_has(run, kind, made, read, use):
    name = f"{kind}.A"
    declared = made.format(name)
    error = refused(run, f"#VAR\n{declared}\n#ENDVAR\n{use.format(read.format(name))}")
    assert error.message == "variable is an array of other dimensions (ID 21216)"
    shown = declared.replace("2", "")
    assert (error.line, error.value) == (4, read.format(name).replace("0", ""))
    assert error.allowed == shown


@OWN
@pytest.mark.parametrize("indices", ["[0]", "[1][2]", "[P1]"])
def test_an_array_has_to_be_declared(run, kind, indices):
    error = refused(run, f"P1=0\n{kind}.A{indices}=1")
    brackets = "[]" * indices.count("[")
    assert (error.message, error.value) == ("array is not declared", f"{kind}.A{brackets}")
    assert error.allowed == f"#VAR with {kind}.A{brackets} and its sizes"
    assert place_of(error) == ("test.nc", 2, 1)


@OWN
def test_an_array_that_is_only_read_is_never_written(run, kind):
    error = refused(run, f"G0 X={kind}.A[0]")
    assert (error.message, error.value) == (READ, f"{kind}.A[]")


# Subprograms


@OWN
def test_a_name_of_a_local_subprogram_is_refused_at_its_place(run, kind):
    error = refused(run, f"%L SUB\n{kind}.SPEED=1\nX={kind}.SPEDE\n%MAIN\nG0\nLL SUB")
    assert (error.message, *place_of(error)) == (READ, "test.nc", 3, 3)


@OWN
def test_one_that_is_never_called_is_looked_at_too(run, kind):
    error = refused(run, f"%L SUB\nX={kind}.A\n%MAIN\nG0 X1")
    assert (error.message, error.line) == (READ, 2)


@OWN
def test_a_subprogram_may_read_what_another_one_writes(run, kind):
    """The name is made somewhere; whether it has a value shows in the run."""
    text = f"%L ONE\n{kind}.A=1\n%L TWO\nX={kind}.A\n%MAIN\nG0\nLL ONE\nLL TWO"
    if kind == "V.P":
        run(text)
    else:  # it ends with its subprogram
        with pytest.raises(Alarm) as caught:
            run(text)
        assert caught.value.id == 900113


@OWN
def test_a_name_of_a_global_subprogram_is_refused_with_its_file(tmp_path, kind):
    """Also in the local one of a file that another file calls."""
    texts = {
        "main": "G0\nL outer.nc",
        "outer": "X1\nL inner.nc\nM17",
        "inner": f"%L PART\nX1 Y={kind}.SPEDE\n%INNER\nLL PART\nM17",
        "unused": f"X={kind}.OTHER",
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.nc").write_text(f"{text}\n", encoding="utf-8")
    with pytest.raises(UserError) as caught:
        check_program(read_program(tmp_path / "main.nc", ("X", "Y")))
    assert place_of(caught.value) == (str(tmp_path / "inner.nc"), 2, 6)
    assert caught.value.value == f"{kind}.SPEDE"
    # What the caller writes is known in the file
    (tmp_path / "main.nc").write_text(f"G0 {kind}.SPEDE=1\nL outer.nc\n", encoding="utf-8")
    check_program(read_program(tmp_path / "main.nc", ("X", "Y")))
