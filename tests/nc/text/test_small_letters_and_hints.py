"""Small letters mean what capital ones mean; a hint about a printed page is beside any other."""

from dataclasses import replace

import pytest
from tests.nc.text.test_text_refusals import refused

from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import AdoptActual, Message

XYZ = ("X", "Y", "Z")


def commands(run, text):
    """What a program gives, without its own text."""
    return [repr(replace(each, block=Block(0, None, ""))) for each in run(text)]


@pytest.mark.parametrize(
    "blocks",
    [
        "N10 G1 F100 X1 Y2 M7 H3\nG91 X=V.A.ABS.X+1\nG4 X0.5",
        "P1=SIN[30]+MAX[1,2] MOD 2\nX=P1 F5\nX=P[1]",
        "$IF 1 AND NOT[0]\nP1=1\n$ELSE\nP1=2\n$ENDIF\nG0 X=P1",
        "$FOR P1=1,3,1\nG0 X=P1\n$ENDFOR\n$WHILE 0\n$ENDWHILE",
        "$SWITCH 2\n$CASE 2\nG0 X1\n$BREAK\n$DEFAULT\n$ENDSWITCH",
        "$REPEAT\nP1=1\n$UNTIL TRUE\n$DO\n$ENDDO FALSE",
        "G0 X1\nN20 $GOTO N40\nX2\nN40: X3\n$GOTO [END]\nX4\n[END] X5",
        "#VAR\nV.P.A : SGN16 = 1.9\nV.P.B[2] : UNS08 = [1, 2]\n#ENDVAR\nG0 X=V.P.A Y=V.P.B[1]",
        "#MEAS MODE[2]\nG100 X5\n#MEAS [AX=Y EDGE=NEG INPUT=PROBE1 SIGNAL=PLC]\n#MEAS DEFAULT",
        "#CS DEF[2][1,2,3]\n#CS ON[2]\nG0 X0\n#CS OFF ALL\n#CS ADD[WP][1]\n#CS SELECT[WP]\nX0",
        "X[INDP_ASYN G91 POS=5 FEED=100 SLOPE_TYPE=SIN2 M7 H5]\n#WAIT INDP [X]\n#WAIT INDP ALL",
        "#PUT AX [Y]\n#CALL AX [Y, 2, 1]\n#CHANNEL INIT [ACTPOS AX=X]\n#TIME [1]\n#FLUSH WAIT",
        "#SLOPE [TYPE=STEP]\nG130 X50\nG131=70\nG161 G2 F5 X2 I1\nG3 X4 R5",
        "V.G.WZ_AKT.L=5\nV.G.NP[1].V.X=2\nG54 G0 X0\nD0\nT5\nV.G.WZ[3].OK=TRUE\nD3",
        "#IDENT WR SYN [AX=X ID=S-0-0092 VAL=1 TYP=2 DEC=0 NO_WAIT]\n#COMMAND WAIT SYN [AXNR=1]",
        "/2 G0 X1\n#ERROR [ID=5 RC=0]\n%L SUB",
    ],
)
def test_a_program_in_small_letters_is_the_same_program(run, blocks):
    if blocks.endswith("%L SUB"):
        blocks = f"%L SUB\nG0 X5\nM17\n%MAIN\n{blocks.removesuffix('%L SUB')}"
    assert commands(run, blocks.lower()) == commands(run, blocks)


@pytest.mark.parametrize("name", ["X2_Table", "x2_table", "X2_TABLE"])
def test_an_axis_whose_name_has_small_letters_is_meant_however_it_is_written(run, name):
    """As an argument of a command, in a list, and as the master of a pair."""
    axes = ("X", "X2_Table")
    init, *_ = [
        each for each in run(f"#CHANNEL INIT [ACTPOS AX={name}]", axes=axes)
        if isinstance(each, AdoptActual)
    ]  # fmt: skip
    assert init.axes == ("X2_Table",)
    put = run(f"#PUT AX [{name}]\n#CALL AX [{name}, 2, 1]", axes=axes)
    assert "X2_Table" in repr(put)


def test_a_type_in_small_letters_is_that_type(run):
    text = (
        "#VAR\nV.P.A[2] : sgn08 = [-1.9, 1.9]\nV.P.B : Boolean = 1\nV.P.T : string[9]\n#ENDVAR\n"
        '#MSG ["%g %g %g|%s|", V.P.A[0], V.P.A[1], V.P.B, V.P.T]'
    )
    (message,) = [each for each in run(text) if isinstance(each, Message)]
    assert message.text == "-1 1 1||"


@pytest.mark.parametrize(
    ("text", "axes", "column", "axis"),
    [
        ("x", XYZ, 1, "X"),
        ("G1 y Z1", XYZ, 4, "Y"),
        ("G1 x z5", XYZ, 4, "X"),
        ("G1 Y", ("X", "y", "Z"), 4, "y"),
        ("G1 X", XYZ, 4, "X"),
    ],
)
def test_an_axis_without_a_value_in_any_letters(text, axes, column, axis):
    error = refused(text, axes)
    assert (error.message, error.column) == (f"axis {axis} has no value", column)
    assert (error.value, error.allowed) == (axis, f"{axis}10, {axis}=expression")


@pytest.mark.parametrize(
    ("text", "hint", "printed", "meant"),
    [
        ("Z[DIST CTRL OFF]", "nearest: DIST_CTRL", "Z[DIST CTRL OFF]", "Z[DIST_CTRL OFF]"),
        ("#DRIVE RD [AX=X KEY=MON WINDOW P=P1]", "names have no blanks: MON_WINDOW?",
         "MON WINDOW", "MON_WINDOW"),
        ("Z[DIST_CTRL ON CONST DIST SET_DIST=1]", "nearest: CONST_DIST",
         "ON CONST DIST", "ON CONST_DIST"),
        ("Z[DIST_CTRL SMOOTH FACT=0.3]", "nearest: SMOOTH_FACT",
         "SMOOTH FACT=0.3", "SMOOTH_FACT=0.3"),
    ],
)  # fmt: skip
def test_a_guess_stays_beside_what_a_printed_page_means(text, hint, printed, meant):
    error = refused(f"X1\n{text}")
    assert error.hint == f"{hint}; the manual prints {printed!r} and means {meant!r}"
    assert (error.file, error.line) == ("p.nc", 2)
    assert error.value is not None
    assert error.allowed
    assert text in (error.excerpt or "")


@pytest.mark.parametrize(
    ("text", "printed", "meant"),
    [
        ("NO30 X1", "NO30", "N030"),
        ("#MEAS [AXNR=xx EDGE=POS]", "AXNR=xx", "AXNR=1"),
        ("#MEAS [SIGNAL=PLC\\_TIMESTAMP AX=X]", "SIGNAL=PLC\\_TIMESTAMP", "SIGNAL=PLC_TIMESTAMP"),
    ],
)
def test_without_a_guess_it_is_the_hint(text, printed, meant):
    assert refused(text).hint == f"the manual prints {printed!r} and means {meant!r}"
