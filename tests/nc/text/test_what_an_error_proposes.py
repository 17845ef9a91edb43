"""What is allowed where a block is wrong, and the hint beside it: place, value, allowed, hint."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")
TERM = 'number, variable, function, text in ", +, -, ['
OPERATORS = "+, -, operator such as * or ==, end of the block"
FUNCTIONS = (
    "ABS, SQR, SQRT, EXP, LN, DEXP, LOG, SIN, COS, TAN, COT, ASIN, ACOS, ATAN, ACOT, ATAN2, INT, "
    "FRACT, ROUND, MIN, MAX, INV, NOT, SIZEOF, EXIST"
)
SHAPE = ", what is in ( ) may be left out"
LEADS = "X[expression], X[INDP_SYN ..], X[INDP_ASYN ..], X[DIST_CTRL ..], X[MC_TOUCHPROBE ..]"

# text, column in its last line (but for an end that only closes), value, allowed, hint
WORDS = [
    ("X1 N5", 4, "N5", None, None),
    ("G0 Q1", 4, "Q", "X, Y, Z", None),
    ("P=5", 1, "P", "X, Y, Z", None),
    ("G[P1] X1", 1, "G", None, None),
    ("M[1.5]", 1, "M", None, None),
    ("G[-1]", 1, "G", None, None),
    ("M=3", 1, "M", None, None),
    ("X1 F0", 4, "F0", "greater than 0 mm/min", None),
    ("F-1.5", 1, "F-1.5", "greater than 0 mm/min", None),
    ("H1 H2", 4, "H", None, None),
    ('X="a"', 1, "a", "no text", None),
    ("5 X1", 1, "5", "X10, F500; a time alone after G4", None),
    ("X5 P1", 4, "P1", "X10, F500; a time alone after G4", None),
    ("G74", 1, "G74", "X.., Y.., Z..", None),
    ("G1 G130", 4, "G130", "X.., Y.., Z..", None),
    ("G159", 1, None, "G159 = 0 .. 96", None),
    ("X1 G133", 4, None, "G133 = 70", None),
    ("G17 G18", 5, "G18", "one word of the group 'plane'", None),
    ("M0 M30", 4, "M30", "one word of the group 'stop'", None),
    ("X[1]=2", 1, "X", None, None),
    ("/11 X1", 1, "/11", "/1 to /10", None),
    ("/0 X1", 1, "/0", "/1 to /10", None),
    (": X1", 1, ":", None, None),
    ("X1,5", 3, ",", "word such as G1 or X10, $GOTO, end of the block",
     "the decimal sign is a point: 1.5"),
    ("X1, Y2", 3, ",", "word such as G1 or X10, $GOTO, end of the block", None),
    ("X1O", 3, "O", "word such as G1 or X10, $GOTO, end of the block",
     "X10 meant? It has a letter O"),
    ("V.P.A : REAL64", 7, ":", "word such as G1 or X10, $GOTO, =, end of the block",
     "a variable gets its type between #VAR and #ENDVAR"),
]  # fmt: skip

FLOW = [
    ("N5: X1\nX1 $GOTO N5", 4, "$GOTO", "a block of its own",
     "only G310 and G210 jump when their motion ends by the signal"),
    ("G100 X1 $GOTO N5", 9, "$GOTO", "a block of its own",
     "only G310 and G210 jump when their motion ends by the signal"),
    ("N10 $GOTO N20", 5, "N20", "N10: or [NAME] before a block", None),
    ("N25: X1\n$GOTO N20", 1, "N20", "N25", "nearest: N25"),
    ("[ENDE] X1\nP1=1 $GOTO [END]", 6, "[END]", "[ENDE]", "nearest: [ENDE]"),
    ("[A] X1\n[B] X2\n$GOTO [LONGNAME]", 1, "[LONGNAME]", "[A], [B]", None),
    ("%L A\n[L1] X1\n%MAIN\n$GOTO [L1]", 1, "[L1]", "N10: or [NAME] before a block", None),
    ("X1\nN5: X1\nX2\nN5: X2", 1, "N5", None, "also in line 2"),
    ("X1\n$IF 1\n$ELSE\n$ELSEIF 2\n$ENDIF", 1, "$ELSEIF", None, None),
    ("$FOR P1=1,2,0\n$ENDFOR", 13, "0", "any other step", None),
    ("$FOR P1=1,2\n$ENDFOR", 12, None, "comma", "$FOR P1 = first, last, step"),
    ("$IF P1=1\n$ENDIF", 7, "=", "$GOTO, " + OPERATORS, "equal is written =="),
    ("$WHILE P1=>1\n$ENDWHILE", 10, "=", OPERATORS, "at least is written >="),
    ("$IF P1=<1\n$ENDIF", 7, "=", "$GOTO, " + OPERATORS, "at most is written <="),
    ("$REPEAT\n$UNTIL P1<>1", 11, ">", TERM, "not equal is written !="),
    ("N10 $ENDFOR", 5, "$ENDFOR", None, None),
    ("N10 $CASE 1", 5, "$CASE", None, None),
    ("$BREAK", 1, "$BREAK", "inside $FOR, $WHILE, $DO, $REPEAT, $SWITCH", None),
    ("$CONTINUE", 1, "$CONTINUE", "inside $FOR, $WHILE, $DO, $REPEAT", None),
    ("X1\n#VAR\nV.P.A = 1\n#ENDVAR\n#ENDVAR", 1, "#ENDVAR", None, None),
    ("X1\n #COMMENT END", 2, "#COMMENT END", None, None),
    ("LL SUP", 1, "SUP", "%L SUP before the main program", None),
    ("%L SUB\nX1\n%MAIN\n  LL SUP", 3, "SUP", "SUB", "nearest: SUB"),
    ("%L SUB\nX1\n%L SUB", 1, "SUB", None, None),
    ("$CASE", 6, None, TERM, None),
    ("P1=", 4, None, TERM, None),
]  # fmt: skip

VALUES = [
    ("X=0xFFFFFFFFFFFFFFFFFF", 3, "0xFFFFFFFFFF..", None, None),
    ("P1=FOO[1]", 4, "FOO", FUNCTIONS, None),
    ("P1=SINN[1]", 4, "SINN", FUNCTIONS, "nearest: SIN, ASIN"),
    ("P1=V.A.ABS.W", 4, "W", "X, Y, Z", "in V.A.ABS.W"),
    ("P1=SIN[1,2]", 4, 2, None, None),
    ("P1=MIN[1]", 4, 1, None, None),
]

COMMANDS = [
    ('#MSSG ["a"]', 1, "#MSSG", None, "nearest: #MSG"),
    ("#FOO", 1, "#FOO", None, "`axisrig language` lists them all"),
    ("#CS OFF X1", 1, "X1", "nothing after it", None),
    ("#TIME", 1, None, f"#TIME [expression (1)]{SHAPE}", None),
    ("X1\n#TIME [1,2]", 1, None, f"#TIME [expression (1)]{SHAPE}", None),
    ('#TIME ["a"]', 1, None, f"#TIME [expression (1)]{SHAPE}", None),
    ("#SLOPE [NO_OPT=1]", 1, None, f"#SLOPE [TYPE=name (NO_OPT=number)]{SHAPE}", None),
    ("#MEAS MODE[9]", 1, "9", "1, 2, 3, 4, 5, 6, 7", None),
    ("#MEAS MODE[,]", 1, None, f"#MEAS MODE [expression (0-1)]{SHAPE}", None),
    ("#CS ON 1", 1, None, "brackets after it", None),
    ("#CS ON[1,2,3,4,5,6,7]", 1, None, "three shifts and three angles", None),
    ("#CS ON[A=1]", 1, None, "three shifts and three angles", None),
    ("#CS ON[O][1,2]", 8, "O", "a number from 1, or a name", "0 meant?"),
    ("#CS ADD[A B][1]", 11, "B", "a name", None),
    ("#CS ON[1][A]", 11, "A", "10, P1, V.P.NAME, [P1+5]", None),
    ("#CS ON[1][2,o]", 13, "o", "10, P1, V.P.NAME, [P1+5]", "0 meant?"),
    ("#CS DEF", 1, None, f"#CS DEF [group (1-2)]{SHAPE}", None),
    ("#DRIVE WR [KEY=ABC VAL=1]", 1, None,
     f"#DRIVE WR [(AX=axis) (AXNR=number) KEY=name VAL=number (WAIT)]{SHAPE}", None),
    ("#MEAS [AX=X]", 1, "AX",
     "TYPE, ERR_NO_SIGNAL, or a setting of an axis beside AX or AXNR",
     "#MEAS DEFAULT goes back to what the lists say"),
    ("#MEAS []", 1, None,
     "TYPE, ERR_NO_SIGNAL, or a setting of an axis beside AX or AXNR",
     "#MEAS DEFAULT goes back to what the lists say"),
    ("#MEAS [EDGE=POS]", 1, "EDGE", "AX=<name> or AXNR=<number>", None),
    ("#MEAS PREPARE", 1, None, "AX=<name> or AXNR=<number>", None),
    ("#MEAS [AX=X AXNR=1 EDGE=POS]", 1, "AXNR", "one of them", None),
    ("#MEAS [SIMU_OFFSET=1 AX=X]", 1, "AX", "one of them", None),
    ("#MEAS [AX=X EDGE=UP]", 18, "UP", "POS, NEG", None),
    ("#MEAS [AX=W EDGE=POS]", 11, "W", "X, Y, Z", None),
    ("#MEAS [ERR_NO_SIGNAL=2]", 22, "2", "0 1", None),
    (f"#DRIVE WR [AX=X KEY={'K' * 30} VAL=1]", 21, "K" * 30,
     "letters, digits, _ and ., at most 29", None),
    ("#DRIVE WR [AX=X KEY=ABC VAL=1.5]", 29, "1.5", None,
     "fractions come from scaling_factor of the function"),
    ("#DRIVE RD [AX=X KEY=ABC P=V.G.T_AKT]", 27, "V.G.T_AKT", "V.P.name, P1", None),
    ("#DRIVE WR [AX=X KEY=A B VAL=1]", 23, "B", "AX, AXNR, KEY, VAL, WAIT",
     "names have no blanks: A_B?"),
    ("#IDENT WR [AX=X ID=S0092 VAL=1 TYP=2 DEC=0]", 20, "S0092",
     "S-0-0092, P-0-0129; 0x6072_00 with CAN", None),
    ("#KIN ID[70000]", 1, "#KIN ID [70000]", "1 .. 65535 (P-CHAN-00262)", None),
    ("#TRAFO[]", 1, "#TRAFO []", "#TRAFO [9], #TRAFO [9, 98]", None),
    ("#KIN ID [A]", 10, "A", "10, P1, V.P.NAME", None),
    ("#KIN ID [O]", 10, "O", "10, P1, V.P.NAME", "0 meant?"),
    ("#CHANNEL INIT [ACTPOS AX]", 23, "AX",
     f"#CHANNEL INIT [(CMDPOS) (ACTPOS) (AX=axis) (AXNR=number)]{SHAPE}", None),
    ("#MSG [V.P.T]", 1, None, '["text", value, ..]', None),
]  # fmt: skip

AXES = [
    ("W[INDP_SYN POS=1 G00]", 1, "W", "X, Y, Z", None),
    ("X[INDP SYN POS=1 G00]", 3, "INDP", "INDP_SYN, INDP_ASYN, DIST_CTRL, MC_TOUCHPROBE",
     "nearest: INDP_SYN, INDP_ASYN"),
    ("X[FEED=5]", 2, "X[", LEADS, None),
    ("X[]", 2, "X[", LEADS, None),
    ("X[INDP_SYN POS=1 SLOPE_TYPE=STAP FEED=1]", 29, "STAP", "STEP, TRAPEZ, SIN2",
     "nearest: STEP, TRAPEZ"),
    ("X[INDP_SYN POS=1 FEED=P1 ACC_WEIGHT=A]", 37, "A", "ACC_WEIGHT=number", None),
    ("Z[DIST_CTRL ON OFF]", 16, "OFF", "one of them", None),
    ("Z[DIST_CTRL ON DRYRUN]", 16, "DRYRUN", "one of them", None),
    ("Z[DIST_CTRL NO_MOVE]", 13, "NO_MOVE", "OFF", None),
    ("Z[DIST_CTRL ON N_CYCLES=1 DISTC_N_CYCLES=2]", 42, "DISTC_N_CYCLES", "N_CYCLES", None),
    ("#DIST CTRL", 1, None, "ON, DRYRUN, OFF, FREEZE, CHECK_POS, REF", None),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "column", "value", "allowed", "hint"), WORDS + FLOW + VALUES + COMMANDS + AXES
)
def test_an_error_says_what_is_meant_where_it_is(text, column, value, allowed, hint):
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    error = caught.value
    lines = text.splitlines()
    line = len(lines) - (len(lines) > 1 and lines[-1] in ("$ENDIF", "$ENDFOR", "$ENDWHILE"))
    assert (error.file, error.line, error.column) == ("p.nc", line, column)
    assert (error.value, error.allowed, error.hint) == (value, allowed, hint)


@pytest.mark.parametrize(
    ("opening", "line", "ending"),
    [
        ("$IF 1", 1, "$ENDIF"),
        ("X1\n  N10 $FOR P1=1,2,1", 2, "$ENDFOR"),
        ("$WHILE 1", 1, "$ENDWHILE"),
        ("$DO", 1, "$ENDDO"),
        ("X1\nX2\n$REPEAT", 3, "$UNTIL"),
        ("$SWITCH 1", 1, "$ENDSWITCH"),
    ],
)
def test_what_is_open_is_shown_where_it_begins_and_with_its_end(opening, line, ending):
    word = ending.replace("END", "").replace("UNTIL", "REPEAT")
    with pytest.raises(UserError) as caught:
        parse_program(f"{opening}\nX5", file="p.nc", axes=XYZ)
    error = caught.value
    assert (error.message, error.line) == (f"{word} is not closed", line)
    assert error.column == opening.splitlines()[-1].index("$") + 1
    assert error.allowed == ending


def test_a_wrong_end_names_what_is_open_and_its_line():
    with pytest.raises(UserError) as caught:
        parse_program("X1\n$IF 1\n$ENDIF\n$FOR P1=1,2,1\nX1 $GOTO N1", axes=XYZ)
    assert caught.value.line == 4
    text = "X1\n$FOR P1=1,2,1\n$ENDIF\n$ENDFOR"
    with pytest.raises(UserError) as caught:
        parse_program(text, axes=XYZ)
    error = caught.value
    assert (error.message, error.line) == ("$ENDIF without $IF", 3)
    assert (error.value, error.hint) == ("$ENDIF", "open is $FOR of line 2")


@pytest.mark.parametrize(
    ("text", "lacking"),
    [
        ("#DRIVE WR [KEY=ABC VAL=1]", "AX or AXNR"),
        ("#DRIVE WR [AXNR=1 KEY=ABC]", "VAL"),
        ("#IDENT WR [AX=X ID=S-0-1 VAL=1]", "TYP and DEC"),
        ("#IDENT WR [ID=S-0-1 TYP=2 DEC=0]", "AX or AXNR and VAL"),
        ("#DRIVE RD [P=P1]", "AX or AXNR and KEY"),
    ],
)
def test_everything_that_a_command_lacks_is_named(text, lacking):
    with pytest.raises(UserError) as caught:
        parse_program(text, axes=XYZ)
    assert caught.value.message == f"{text.partition(' [')[0]} lacks {lacking}"


def test_a_name_that_is_wrong_more_than_once_is_shown_where_it_is_first():
    text = "X1\nX2 Y=V.P.NOBODY\n$IF V.P.NOBODY\n$ENDIF\nX=V.P.NOBODY"
    program = parse_program(text, axes=XYZ)
    assert program.variables == (("V.P.NOBODY", 2, 6),)


@pytest.mark.parametrize(("digits", "is_taken"), [("F" * 15, True), ("F" * 16, False)])
def test_a_hexadecimal_number_has_fifteen_digits_at_most(digits, is_taken):
    text = f"X1\nP1=0x{digits}"
    if is_taken:
        value = parse_program(text, axes=XYZ).blocks[1].statement.value.value
        assert value == float(16**15 - 1)
        return
    with pytest.raises(UserError, match="number too large") as caught:
        parse_program(text, axes=XYZ)
    assert (caught.value.line, caught.value.column) == (2, 4)
