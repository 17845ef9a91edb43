"""What an alarm of a block shows: its ID, its block and every value, for each word that has one."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Warn

XYZA = ("X", "Y", "Z", "A")
PROBES = "1 .. 255 PROBE0 PROBE1"
MANUAL = "TF5200 programming manual"
DWELL = {"lower": 0, "upper": 4_294_967_295}  # us in 32 bits
SPINDLE = {"spindles": 0, "release": 0}
NEVER = "nothing has written it or a name like it"

ARCS = [
    ("G2 X5 I1 R5 F10", 21024, {}),
    ("G1 X1 I5 F10", 900153, {"word": "I", "where": "with G1"}),
    ("G0 K5", 900153, {"word": "K", "where": "with G0"}),
    ("G92 X1 J5", 900153, {"word": "J", "where": "with G92"}),
    ("G100 X1 J5 F10", 900153, {"word": "J", "where": "with G100"}),
    ("G2 X5 I1 K1 F10", 900153, {"word": "K", "where": "in plane G17"}),
    ("G18 G3 X5 J1 F10", 900153, {"word": "J", "where": "in plane G18"}),
    ("G19 G2 Y5 I1 F10", 900153, {"word": "I", "where": "in plane G19"}),
    ("G2 X5 I1 J300000 F10", 20020,
     {"word": "J", "value_mm": "300000", "limit_mm": 214_748.3647}),
    ("G70\nG2 X5 I-10000 F10", 20020,
     {"word": "I", "value_mm": "-254000", "limit_mm": 214_748.3647}),
    ("G2 X5 R-2000000000 F10", 20054, {"value_mm": "-2e+09", "limit_mm": "1e+09"}),
    ("G0 Y-300000", 900156, {"axis": "Y", "value_mm": "-300000", "limit_mm": 214_748.3647}),
    ("G2 X5 R1 F10", 900151, {"radius_mm": "1.0000", "distance_mm": "5.0000"}),
    ("G70 G2 X1 R0.1 F10", 900151, {"radius_mm": "2.5400", "distance_mm": "25.4000"}),
]  # fmt: skip

MOTION = [
    ("X1", 20008, {"word": "G1"}),
    ("G2 X5 R5", 20008, {"word": "G2"}),
    ("G3 X5 R5", 20008, {"word": "G3"}),
    ("G100 X1", 20008, {"word": "G100"}),
    ("#MEAS MODE[5]\nG1 G310 X1", 20008, {"word": "G310"}),
    ("G4", 900171, {"word": "G4"}),
    ("G4[1] X2", 20013, {}),
    ("G4 X-1", 20752, {"value": "-1000000", **DWELL}),
    ("#TIME [-0.5]", 20751, {"value": "-500000", **DWELL}),
    ("G4 X5000", 20752, {"value": "5000000000", **DWELL}),
    ("P1=0\n#WAIT FOR P1", 900173, {}),
    ("#SLOPE [TYPE=SIN]", 21629, {"type": "SIN", "known": "STEP TRAPEZ SIN2"}),
    ("#SLOPE [TYPE=HSC]", 900100, {"word": "#SLOPE [TYPE=HSC]", "what": "acceleration profile"}),
    ("P1=2\n#SLOPE [TYPE=STEP NO_OPT=P1]", 900105, {"reason": "NO_OPT = 2 is neither 0 nor 1"}),
    ("G131=0", 900174, {"word": "G131", "weight": "0"}),
    ("G133=-0.5", 900174, {"word": "G133", "weight": "-0.5"}),
    ("G134=-70", 900174, {"word": "G134", "weight": "-70"}),
    ("G130 X5 Y-5", 900174, {"word": "G130", "weight": "-5"}),
    ("G132 X0 Y5", 900174, {"word": "G132", "weight": "0"}),
    ("M3", 21548, {"number": "3", **SPINDLE}),
    ("M7 M19", 21548, {"number": "19", **SPINDLE}),
    ("M45", 21548, {"number": "45", **SPINDLE}),
    ("M1000", 20160, {"word": "M1000", "upper": 999}),
    ("M7 H1000", 900172, {"word": "H1000", "upper": 999}),
    ("H-1", 900172, {"word": "H-1", "upper": 999}),
    ("D5", 900154, {"word": "D5"}),
    ("D201", 900155, {"value": "201", "last": 200}),
    ("P1=0.5\nD=P1", 900155, {"value": "0.5", "last": 200}),
]

MEASURING = [
    ("#MEAS MODE[5]\nG100 X1 F1", 20138, {"type": 5}),
    ("#MEAS MODE[6]\nG100 X1 F1", 20138, {"type": 6}),
    ("G310 X1 F1", 20956, {"type": 1}),
    ("#MEAS MODE[7]\nG210 X1 F1", 20956, {"type": 7}),
    ("G106 G100 X1 F1", 20772, {"g_function": "G106", "type": 1}),
    ("#MEAS MODE[5]\nG101 X1", 20772, {"g_function": "G101", "type": 5}),
    ("#MEAS MODE[6]\nG102 X1", 20772, {"g_function": "G102", "type": 6}),
    ("#MEAS MODE[2]\nG100 X1 Y1 Z1", 50061, {"programmed": 3, "maximum": 1, "type": 2}),
    ("#MEAS MODE[4]\nG100 X1 A1 F1", 900220, {"type": 4, "axis": "A"}),
    ("#MEAS MODE[6]\nG310 X1 Y2 F1", 900221, {"type": 6, "axes": "X Y"}),
    ("G106 G1 X1 F5", 900228, {}),
    ("G100 X0 Z0 F5", 900103, {"axes": "X Z"}),
    ("X=V.A.MESS.Y F5", 900101, {"axis": "Y", "name": "V.A.MESS.Y"}),
    ("X=V.A.MOFFS.Z", 900101, {"axis": "Z", "name": "V.A.MOFFS.Z"}),
    ("X=V.A.MEAS.ACS.VALUE.A", 900101, {"axis": "A", "name": "V.A.MEAS.ACS.VALUE.A"}),
    ("X=V.A.MEAS.PCS.VALUE.X", 900101, {"axis": "X", "name": "V.A.MEAS.PCS.VALUE.X"}),
    ("G101 Y1", 900101, {"axis": "Y", "name": "G101"}),
    ("G261\nG100 X1 F1", 120652, {}),
    ("G61 G100 X1 F1", 120652, {}),
    ("P1=9\n#MEAS [TYPE=P1]", 900104, {"value": "9"}),
    ("P1=1.5\n#MEAS MODE[P1]", 900104, {"value": "1.5"}),
    ("P1=2\n#MEAS [ERR_NO_SIGNAL=P1]", 900227,
     {"keyword": "ERR_NO_SIGNAL", "value": "2", "allowed": "0 1"}),
    ("#MEAS [AX=X INPUT=PROBE2]", 900227,
     {"keyword": "INPUT", "value": "PROBE2", "allowed": PROBES}),
    ("P1=0.5\n#MEAS [AX=X INPUT=P1]", 900227,
     {"keyword": "INPUT", "value": "0.5", "allowed": PROBES}),
    ("#MEAS [AXNR=9 EDGE=POS]", 20312, {"number": "9"}),
    ("#MEAS PREPARE [AXNR=1.5]", 20312, {"number": "1.5"}),
    ("#MEAS [AX=X G107]", 900430, {"word": "#MEAS [G107]", "section": f"{MANUAL} 207092107"}),
    ("#MEAS [AX=X G108]", 900430, {"word": "#MEAS [G108]", "section": f"{MANUAL} 207092107"}),
    ("#MEAS [TRIGGER]", 900430,
     {"word": "#MEAS [TRIGGER]", "section": "TF5200 channel parameters 149024651, P-CHAN-00257"}),
    ("G108 X1", 900430, {"word": "G108", "section": f"{MANUAL} 206213899"}),
    ("G107 X1", 900430, {"word": "G107", "section": f"{MANUAL} 206224907"}),
]  # fmt: skip

DRIVES = [
    ("P1=3\n#IDENT WR [AX=X ID=S-0-1 VAL=1 TYP=P1 DEC=0]", 900256,
     {"keyword": "TYP", "value": "3", "allowed": "2, 4"}),
    ("P1=1\n#IDENT RD [AX=X ID=S-0-1 P=P2 TYP=2 DEC=0-P1]", 900256,
     {"keyword": "DEC", "value": "-1", "allowed": "0, 1, 2, 3, 4, 5, 6, 7, 8, 9"}),
    ("P1=10\n#IDENT WR [AX=X ID=S-0-1 VAL=1 TYP=4 DEC=P1]", 900256,
     {"keyword": "DEC", "value": "10", "allowed": "0, 1, 2, 3, 4, 5, 6, 7, 8, 9"}),
    ("#DRIVE WR [AXNR=9 KEY=A VAL=1]", 20312, {"number": "9"}),
    ("#COMMAND WR [AXNR=2.5 ID=S-0-99]", 20312, {"number": "2.5"}),
]  # fmt: skip

VARIABLES = [
    ("P1=P2", 900113, {"name": "P2", "near": NEVER}),
    ("V.S.LEFT=1\nP1=V.S.LEFTY", 900113,
     {"name": "V.S.LEFTY", "near": "the nearest with one: V.S.LEFT"}),
    ("V.A.ABS.X=5", 900121, {"name": "V.A.ABS.X"}),
    ("V.G.FEEDRATE=5", 900121, {"name": "V.G.FEEDRATE"}),
    ("@P1=2", 21382, {"name": "@P1"}),
    ("P1=@S30", 21382, {"name": "@S30"}),
    ("#VAR\nV.P.B[2] = [1,2,3]", 900124, {"name": "V.P.B[2]", "places": 2, "given": 3}),
    ("#VAR\nV.P.B[2][3] = [1,2,3,4,5,6,7]", 900124,
     {"name": "V.P.B[2][3]", "places": 6, "given": 7}),
    ("#VAR\nV.P.B[2][0]", 900123, {"name": "V.P.B[2][0]", "maximum": 1_000_000}),
    ("#VAR\nV.P.B[2.5]", 900123, {"name": "V.P.B[2.5]", "maximum": 1_000_000}),
    ("#VAR\nV.P.B[1001][1000]", 900123, {"name": "V.P.B[1001][1000]", "maximum": 1_000_000}),
    ("#VAR\nV.P.B : SGN08 = 128", 20847,
     {"name": "V.P.B", "value": "128", "lower": -128, "upper": 127}),
    ("#VAR\nV.P.B : UNS08 = -1.5", 20847,
     {"name": "V.P.B", "value": "-1.5", "lower": 0, "upper": 255}),
    ("#VAR\nV.P.B[2] : UNS16 = [1, 65536]", 20847,
     {"name": "V.P.B[1]", "value": "65536", "lower": 0, "upper": 65535}),
    ('#VAR\nV.P.B : SGN08 = "a"', 900122, {"name": "V.P.B", "kind": "SGN08", "value": "a"}),
    ("#VAR\nV.P.B : STRING = 5", 900122, {"name": "V.P.B", "kind": "STRING", "value": 5.0}),
    ("#VAR\nP5 = 1", 900121, {"name": "P[]"}),
    ("#VAR\nV.P.A[3][2]\n#ENDVAR\nP1=V.P.A[2][2]", 20403,
     {"name": "V.P.A[2][2]", "value": 2, "lower": 0, "upper": 1}),
    ("#VAR\nV.P.A[3][2]\n#ENDVAR\nV.P.A[3][1]=5", 20403,
     {"name": "V.P.A[3][1]", "value": 3, "lower": 0, "upper": 2}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("blocks", "alarm_id", "values"), ARCS + MOTION + MEASURING + DRIVES + VARIABLES
)
def test_the_block_that_is_refused_and_every_value_of_why(run, blocks, alarm_id, values):
    is_open = "#VAR" in blocks and "#ENDVAR" not in blocks
    with pytest.raises(Alarm) as caught:
        run(f"{blocks}\n#ENDVAR" if is_open else blocks, axes=XYZA)
    alarm = caught.value
    assert (alarm.id, alarm.values) == (alarm_id, values)
    assert alarm.place == f"test.nc line {len(blocks.splitlines())}"


def test_an_alarm_has_the_number_of_its_block(run):
    with pytest.raises(Alarm) as caught:
        run("N10 G0 X1\n\n  N20 X1 Y1 Z1\nN30 M1000 ; last")
    assert caught.value.place == "test.nc line 4, block N30"


@pytest.mark.parametrize("called", ["SUB", "OTHER"])
def test_20360_names_the_call_that_is_one_too_many(run, called):
    """SUB calls itself, whether the main program or OTHER calls it first."""
    text = f"%L OTHER\nLL SUB\n%L SUB\nLL SUB\n%MAIN\nLL {called}"
    with pytest.raises(Alarm) as caught:
        run(text)
    assert (caught.value.id, caught.value.values) == (20360, {"limit": 50, "name": "SUB"})


@pytest.mark.parametrize(
    ("blocks", "alarm_id", "values"),
    [
        ("G4 X1 Y2 A3", 20685, [{"axis": "Y"}, {"axis": "A"}]),
        ("G60", 20003, [{"g_function": "G60"}]),
        ("%L SUB\nM2\n%MAIN\nLL SUB", 900125, [{"word": "M2", "name": "SUB"}]),
        ("%L SUB\nM30\n%MAIN\nLL SUB", 900125, [{"word": "M30", "name": "SUB"}]),
        ("#ERROR [ID=7 RC=0]", 900130, [{"number": 7, "details": "without values"}]),
        ("#ERROR [RC=0 PV1=1.5 PM1=2]", 900130, [{"number": 0, "details": "PV1 1.5, PM1 2"}]),
        ("#KIN ID [9.98]", 900484, [{"remark": "#KIN ID[9.98] read as [9,98]"}]),
    ],
)
def test_a_warning_lets_the_program_go_on(run, blocks, alarm_id, values):
    found = [each.alarm for each in run(blocks, axes=XYZA) if isinstance(each, Warn)]
    assert [(each.id, each.values) for each in found] == [(alarm_id, each) for each in values]
