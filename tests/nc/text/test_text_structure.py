"""Control structures, labels, jumps, subprograms and declarations over several blocks."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc import syntax
from axisrig.kernel.nc.syntax import (
    Declare,
    Goto,
    Label,
    Number,
    SubprogramCall,
    Target,
    Variable,
    Words,
)
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.structure import DEPTH_MAX

XYZ = ("X", "Y", "Z")


def program(text):
    return parse_program(text, file="p.nc", axes=XYZ)


def statements(text):
    return [part.statement for part in program(text).blocks]


def kinds(text):
    return [type(statement).__name__ for statement in statements(text)]


def test_every_control_structure_is_read():
    text = """$IF P1 == 1
    $ELSEIF P1 > 2
    $ELSE
    $ENDIF
    $FOR P1 = 0, 10, 1
    $CONTINUE
    $ENDFOR
    $WHILE P1 < 3
    $BREAK
    $ENDWHILE
    $DO
    $ENDDO P1 < 5
    $REPEAT
    $UNTIL P1 > 5
    $SWITCH P1
    $CASE 1
    $BREAK
    $DEFAULT
    $ENDSWITCH"""
    assert kinds(text) == [
        *("If", "ElseIf", "Else", "EndIf", "For", "Continue", "EndFor"),
        *("While", "Break", "EndWhile", "Do", "EndDo", "Repeat", "Until"),
        *("Switch", "Case", "Break", "Default", "EndSwitch"),
    ]


def test_a_loop_without_condition_goes_on_for_ever():
    assert statements("$WHILE\n$ENDWHILE")[0] == syntax.While(Number(1.0))


def test_jumps_and_labels():
    text = "N10: G0 X1\n[BACK] X2\n$GOTO N10\n$IF P1 > 3 $GOTO [BACK]\nG310 X3 $GOTO [BACK]"
    n10, _, back, _, jump, conditional, move = statements(text)
    assert (n10, back, jump) == (Label("N10"), Label("[BACK]"), Goto(Target("N10")))
    assert isinstance(conditional, Goto)
    assert conditional.condition is not None
    assert isinstance(move, Words)
    assert move.goto == Target("[BACK]")


def test_a_label_and_its_jump_may_have_leading_zeros_and_blanks():
    text = "N010: G0 X1\n$GOTO N10\n$GOTO N0010\n$GOTO N 010\n$IF P1 $GOTO N010"
    label, _, *jumps = statements(text)
    assert label == Label("N10")
    assert [jump.target for jump in jumps] == [Target("N10")] * 4


def test_a_name_of_a_label_has_no_blanks_around_it_wherever_it_is_written():
    for written in ("[A_B]", "[ A_B]", "[A_B ]", "[ A_B ]"):
        text = f"{written} G0 X1\n$GOTO [A_B]\n$IF P1 $GOTO {written}\nG310 X3 $GOTO {written}"
        label, _, jump, conditional, move = statements(text)
        assert label == Label("[A_B]")
        assert {each.target for each in (jump, conditional)} | {move.goto} == {Target("[A_B]")}


def test_a_block_has_one_of_ten_levels_of_skip():
    """Source: functional description of block skip, page 214611467."""
    for level in range(1, 11):
        for text in (f"/{level} N5 G0 X1", f"N5 /{level} G0 X1", f"/{level} $WHILE 0\n$ENDWHILE"):
            assert program(text).blocks[0].skip == level
    assert [program(f"{head}G0 X1").blocks[0].skip for head in ("/", "/ N5 ", "")] == [1, 1, 0]
    for level in ("/0", "/11", "/100"):
        with pytest.raises(UserError, match="no such level"):
            program(f"{level} G0 X1")


def test_a_case_may_stand_behind_the_default_branch():
    assert kinds("$SWITCH 1\n$CASE 1\n$DEFAULT\n$CASE 2\n$ENDSWITCH")[2:4] == ["Default", "Case"]


@pytest.mark.parametrize(
    ("text", "line", "message", "hint"),
    [
        ("$IF 1", 1, "$IF is not closed", "$ENDIF"),
        ("G0 X1\n$ENDIF", 2, "$ENDIF without $IF", ""),
        ("$IF 1\n$ENDWHILE\n$ENDIF", 2, "$ENDWHILE without $WHILE", "open is $IF of line 1"),
        ("$ELSE", 1, "$ELSE without $IF", ""),
        ("$IF 1\n$ELSE\n$ELSEIF 2\n$ENDIF", 3, "after the last branch", ""),
        ("$IF 1\n$ELSE\n$ELSE\n$ENDIF", 3, "after the last branch", ""),
        ("$SWITCH 1\n$DEFAULT\n$DEFAULT\n$ENDSWITCH", 3, "after the last branch", ""),
        ("$SWITCH 1\n$DEFAULT\n$CASE 2\n$DEFAULT\n$ENDSWITCH", 4, "after the last branch", ""),
        ("$BREAK", 1, "$BREAK is in no loop", "$SWITCH"),
        ("$SWITCH 1\n$CONTINUE\n$ENDSWITCH", 2, "$CONTINUE is in no loop", "$FOR"),
        ("$FOR P1 = 1, 2, 0\n$ENDFOR", 1, "step of 0", ""),
        ("$WHIL 1", 1, "unknown control structure", "$WHILE"),
        ("[A] G0 X1\n[A] X2", 2, "label twice", "line 1"),
        ("$GOTO [BAKC]\n[BACK] G0 X1", 1, "no such label", "[BACK]"),
        ("$GOTO N20\nN20 G0 X1", 1, "no such label", "N10: or [NAME]"),
        ("LL PU\n", 1, "no such local subprogram", "%L PU"),
        ("%L UP\nM17\n%MAIN\nLL PU", 4, "no such local subprogram", "UP"),
        ("%L A\nM17\n%L A\nM17\n%MAIN\nM30", 3, "second subprogram", ""),
        ("%L A\n[X1]\n%MAIN\n$GOTO [X1]", 4, "no such label", ""),
        ("#VAR\nV.P.A", 1, "#VAR is not closed", "#ENDVAR"),
        ("#ENDVAR", 1, "#ENDVAR without #VAR", ""),
        ("#COMMENT BEGIN\nG0", 1, "comment is not closed", "#COMMENT END"),
        ("/11 G0 X1", 1, "no such level", "/1 to /10"),
    ],
)
def test_what_does_not_fit_together_is_refused(text, line, message, hint):
    with pytest.raises(UserError) as caught:
        program(text)
    assert caught.value.line == line
    assert message in caught.value.message
    assert hint in str(caught.value)


def test_deep_nesting_ends_in_a_clear_error():
    with pytest.raises(UserError, match="nested too deep"):
        program("$IF 1\n" * (DEPTH_MAX + 1) + "$ENDIF\n" * (DEPTH_MAX + 1))
    program("$IF 1\n" * DEPTH_MAX + "$ENDIF\n" * DEPTH_MAX)


def test_local_subprograms_stand_in_front_of_the_main_program():
    found = program("%L UP1\nN1 G0 X1\nN9 M17\n%L UP 2\nG0 X2\n%MAIN\nN10 LL UP1\nN20 M30")
    assert found.name == "MAIN"
    assert {name: len(blocks) for name, blocks in found.subprograms.items()} == {
        "UP1": 2,
        "UP 2": 1,
    }
    assert found.blocks[0].statement == SubprogramCall("UP1", "local")


@pytest.mark.parametrize(
    ("text", "call"),
    [
        ("L gup_1.nc", SubprogramCall("gup_1.nc", "global")),
        ("N5 L D:\\prog\\ini_1.nc", SubprogramCall("D:\\prog\\ini_1.nc", "global")),
        ('L "my part.nc"', SubprogramCall("my part.nc", "global")),
        (
            "L CYCLE [NAME = SysMeasCs2.ecy \\\n @P4 = 30 \\\n @P6  = -40 ]",
            SubprogramCall(
                "SysMeasCs2.ecy", "cycle", (("@P4", Number(30.0)), ("@P6", Number(-40.0)))
            ),
        ),
    ],
)
def test_calls_of_other_files(text, call):
    assert statements(text) == [call]


def test_declarations_of_variables():
    text = """#VAR
    V.P.A
    V.L.B[3] = [10, 11, \\
                12]
    V.S.C : UNS32 = 200
    V.P.D : STRING[20] = "END_OK"
    V.P.E[2][2]
    #ENDVAR"""
    _, a, b, c, d, e, _ = statements(text)
    assert a == Declare(Variable("V.P.A"))
    ten = (Number(10.0), Number(11.0), Number(12.0))
    assert b == Declare(Variable("V.L.B[]", (Number(3.0),)), ten)
    assert c == Declare(Variable("V.S.C"), (Number(200.0),), "UNS32")
    assert d == Declare(Variable("V.P.D"), (syntax.Text("END_OK"),), "STRING")
    assert e == Declare(Variable("V.P.E[][]", (Number(2.0), Number(2.0))))


def test_a_comment_over_several_lines_is_no_code():
    found = program("N10 G0 X1\nN20 #COMMENT BEGIN\nN30 G777\n#COMMENT END\nN40 M30")
    assert [part.block.number for part in found.blocks] == [10, 20, 40]


def test_block_skip_is_kept_with_its_level():
    assert [part.skip for part in program("/G0 X1\n/3 N10 X2\nN20 / X3\nX4").blocks] == [1, 3, 1, 0]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2+3*4", 14.0),
        ("[2+3]*4", 20.0),
        ("-2**2", -4.0),
        ("2**-1", 0.5),
        ("2**3**2", 64.0),
        ("10-2-3", 5.0),
        ("7 MOD 4 + 1", 4.0),
        ("1 + 2 == 3", 1.0),
        ("1 == 1 && 2 > 3 || TRUE", 1.0),
        ("1 | 6 & 3", 3.0),
        ("5 ^ 1 == 4", 1.0),
        ("FALSE XOR TRUE", 1.0),
        ("NOT[0] and 1", 1.0),
        ("0x1F", 31.0),
        ("1234.56789", 1234.56789),
        ("9999.9999", 9999.9999),
        ("---5", -5.0),
    ],
)
def test_constant_expressions_are_computed_by_the_ranks_of_the_manual(text, value):
    (words,) = statements(f"X={text}")
    assert words.axes == (("X", Number(value)),)


def test_numbers_keep_a_tenth_of_a_micrometre_over_ten_metres():
    for tenths_um in range(99_999_000, 100_000_000, 37):
        text = f"{tenths_um // 10_000}.{tenths_um % 10_000:04d}"
        (words,) = statements(f"G1 X{text}")
        assert words.axes == (("X", Number(float(text))),)
        assert f"{words.axes[0][1].value:.4f}" == text


@pytest.mark.parametrize(
    ("text", "value"),
    [("SQR[-3]", 9.0), ("DEXP[3]", 1000.0), ("ATAN2[1,-1]", 135.0), ("INV[5]", -6.0)],
)
def test_functions_known_by_their_name_only(text, value):
    (words,) = statements(f"X={text}")
    assert words.axes[0][1].value == pytest.approx(value, abs=1e-12)


def test_assignments_act_in_front_of_the_words_of_their_block():
    assert kinds("G0 XP1 P1=5 P2=P1") == ["Assign", "Assign", "Words"]


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("N10 G310 X1 $GOTO [A]", 13),
        ("N10 $IF P1 $GOTO N5", 12),
        ("N10 $ENDIF", 5),
        ("/ N10 $IF 1", 7),
    ],
)
def test_the_place_is_that_of_the_word(text, column):
    with pytest.raises(UserError) as caught:
        program(text)
    assert caught.value.column == column


@pytest.mark.parametrize("words", ["G1 Z140 F3000", "G100 Z20 F300", "M3", "F500", "P1=3 G4 1"])
def test_a_jump_beside_words_is_refused_as_it_would_not_be_made(words):
    with pytest.raises(UserError) as caught:
        parse_program(f"{words} $GOTO [A]\n[A] M30", axes=XYZ)
    assert (caught.value.line, caught.value.column) == (1, len(words) + 2)
    assert "G310" in str(caught.value)


@pytest.mark.parametrize("words", ["", "P1=3 V.P.A=4 ", "G310 Z20 F300 ", "G210 Z20 "])
def test_a_jump_stands_alone_behind_assignments_or_behind_g310(words):
    assert len(parse_program(f"{words}$GOTO [A]\n[A] M30", axes=XYZ).blocks) >= 3
