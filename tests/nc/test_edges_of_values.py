"""The least and the largest value that a word takes, and the first ones that it does not."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message, TechnologyFunction

FARTHEST = 214_748.3647  # 2^31 steps of 0.1 um

# (blocks with P1, values that are taken, values that are refused, with which alarm)
EDGES = [
    ("#ERROR [ID=P1 RC=0]", (0, 1, 1000), (-1, 1001, 1.5), 900133),
    ("#ERROR [ID=1 RC=P1]", (0,), (-1, 1, 3, 6, 8), 900133),
    ("#MEAS [AX=X INPUT=P1]", (1, 255), (0, 256, 1.5), 900227),
    ("#MEAS [ERR_NO_SIGNAL=P1]", (0, 1), (-1, 2, 0.5), 900227),
    ("#MEAS [TYPE=P1]", (1, 7), (0, 8, 1.5), 900104),
    ("#MEAS MODE [P1]", (1, 7), (0, 8, 1.5), 900104),
    ("#SET AX LINK [P1, Y=X]", (1, 31), (0, 32, 1.5), 900197),
    ("#CS ON [P1][0,0,1]", (1, 99), (0, -1, 1.5), 20820),
    ("G159 = P1", (0, 96), (-1, 97), 20403),
    ("G159 = P1", (), (0.5, 1.5), 900105),
    ("V.G.NP[P1].V.X=1", (0, 96), (-1, 97, 0.5), 20403),
    ("V.G.WZ[P1].L=1", (0, 200), (-1, 201, 0.5), 20403),
    ("V.G.WZ[200].OK=1\nD=P1", (0, 200), (-1, 201, 0.5), 900155),
    ("V.G.KIN_STEP[P1].ID[1].PARAM[0]=1", (0, 1), (-1, 2), 20403),
    ("V.G.KIN_STEP[0].ID[1].PARAM[P1]=1", (0, 73), (-1, 74), 20403),
    ("H=P1", (0, 999, 999.4, -0.4), (-1, 1000, 999.6), 900172),
    ("G74 X=P1", (1, 65535), (0, 65536, 1.5), 20816),
    ("G131 = P1", (0.001, 1000), (0, -1), 900174),
    ("G133 = P1", (0.001, 1000), (0, -1), 900174),
    ("G134 = P1", (0.001, 1000), (0, -1), 900174),
    ("G130 X=P1", (0.001, 1000), (0, -1), 900174),
    ("G132 Y=P1", (0.001, 1000), (0, -1), 900174),
    ("#SLOPE [TYPE=TRAPEZ NO_OPT=P1]", (0, 1), (-1, 2, 0.5), 900105),
    ("X[INDP_SYN G01 POS=1 FEED_MAX_WEIGHT=P1]", (0.1, 100), (0, -1, 100.1), 50603),
    ("X[INDP_SYN G01 POS=1 FEED=5 ACC_WEIGHT=P1]", (0.1, 100), (0, -1, 100.1), 50603),
    ("X[INDP_SYN G00 POS=1 RAPID_ACC_WEIGHT=P1]", (0.1, 100), (0, -1, 100.1), 50603),
    ("X[INDP_SYN G01 POS=1 FEED=P1]", (0.1, 1e6), (0, -1), 50603),
    ("X[INDP_SYN G01 POS=1 TIME=P1]", (0.1, 1e6), (0, -1), 50603),
    ("G2 I=P1 F100", (FARTHEST, -FARTHEST), (FARTHEST + 1e-4, -FARTHEST - 1e-4), 20020),
    ("G2 X1 R=P1 F100", (1e9, -1e9), (1e9 + 1, -1e9 - 1), 20054),
    ("G0 X=P1", (FARTHEST, -FARTHEST), (FARTHEST + 1e-4, -FARTHEST - 1e-4), 900156),
    ("G1 F=P1 X1", (0.001,), (0, -1), 20008),
]


@pytest.mark.parametrize(("text", "taken", "refused", "alarm_id"), EDGES)
def test_a_word_takes_its_edges_and_nothing_behind_them(run, text, taken, refused, alarm_id):
    for value in taken:
        run(f"P1={value:.4f}\n{text}")
    for value in refused:
        with pytest.raises(Alarm) as caught:
            run(f"P1={value:.4f}\n{text}")
        assert caught.value.id == alarm_id, value


@pytest.mark.parametrize(("text", "alarm_id"), [("G4[P1]", 20752), ("#TIME [P1]", 20751)])
def test_the_edges_of_a_dwell_time(run, text, alarm_id):
    """Whole us in 32 bits: TF5200 diagnosis 252425611, 252429963."""
    for value in (0.0, 4294.967295):
        run(f"P1={value:.6f}\n{text}")
    for value in ("-0.000001", "4294.967296", "4294.9672951", "DEXP[305]"):
        with pytest.raises(Alarm) as caught:
            run(f"P1={value}\n{text}")
        assert caught.value.id == alarm_id, value


@pytest.mark.parametrize(("value", "number"), [(1.4, 1), (1.6, 2), (2.51, 3), (-0.4, 0)])
def test_numbers_for_the_plc_side_are_rounded(run, value, number):
    """TF5200 programming manual 206761227."""
    commands = run(f'P1={value}\nH=P1 T=P1\n#MSG ["%g", V.G.T_AKT]')
    sent = [c.word for c in commands if isinstance(c, TechnologyFunction)]
    assert sent == [f"H{number}", f"T{number}"]
    assert [c.text for c in commands if isinstance(c, Message)] == [f"{number}"]
