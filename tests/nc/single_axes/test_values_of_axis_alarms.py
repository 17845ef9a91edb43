"""What an alarm of a command to single axes shows: its ID, its block and every value of it."""

import pytest

from axisrig.kernel.errors import Alarm

XYZAB = ("X", "Y", "Z", "A", "B")

# (blocks, ID, values): the last block is the one that is refused
LINKS = [
    ("#SET AX LINK [0, A=X]", 900197, {"group": "0", "what": "cannot be defined"}),
    ("#SET AX LINK [32, A=X]", 900197, {"group": "32", "what": "cannot be defined"}),
    ("#SET AX LINK [1.5, A=X]", 900197, {"group": "1.5", "what": "cannot be defined"}),
    ("#SET AX LINK [7]", 900197, {"group": 7, "what": "has no pair of axes"}),
    ("#SET AX LINK [1, [A=X,G,2,1]]", 900198,
     {"value": "2, 1", "what": "limits rise and are above 0"}),
    ("#SET AX LINK [1, [A=X,G,0,1]]", 900198,
     {"value": "0, 1", "what": "limits rise and are above 0"}),
    ("#SET AX LINK [1, [A=X,G,1]]", 900198,
     {"value": "A", "what": "G and two limits belong after it"}),
    ("#SET AX LINK [1, [A=X,H,1,2]]", 900198,
     {"value": "A", "what": "G and two limits belong after it"}),
    ("#SET AX LINK [1, [A=X,G,1,B]]", 900198, {"value": "A", "what": "limits are numbers"}),
    ("#SET AX LINK [1, A=W]", 900198, {"value": "A=W", "what": "the channel has no such axis"}),
    ("#SET AX LINK [1, B=X, A=W]", 900198,
     {"value": "A=W", "what": "the channel has no such axis"}),
    ("#SET AX LINK [4, B=X, A=A]", 20475, {"axis": "A", "pair": 1, "group": 4}),
    ("#SET AX LINK [1, A=X, B=X, A=Y]", 20476, {"axis": "A"}),
    ("#SET AX LINK [1, A=X, B=A]", 20477, {"axis": "A"}),
    ("#ENABLE AX LINK [2]", 900197, {"group": 2, "what": "is not defined"}),
    ("#ENABLE AX LINK", 900197, {"group": 0, "what": "is not defined"}),
    ("#ENABLE AX LINK [1.5]", 900197, {"group": "1.5", "what": "is no whole number"}),
    ("#DISABLE AX LINK [2.25]", 900197, {"group": "2.25", "what": "is no whole number"}),
    ("#SET AX LINK [2, A=X]\n#DISABLE AX LINK [2]", 900197, {"group": 2, "what": "is not on"}),
    ("#SET AX LINK [1, A=Y, Z=X]\n#ENABLE AX LINK [1]", 20467, {"axis": "Z"}),
    ("#SET AX LINK [3, A=X]\n#ENABLE AX LINK [3]\n#SET AX LINK [3, B=X]", 20472, {"group": 3}),
    ("#SET AX LINK [5, A=X]\n#SET AX LINK [6, B=Y, A=Y]\n#ENABLE AX LINK [5]\n#ENABLE AX LINK [6]",
     21283, {"axis": "A", "group": 5}),
    ("#SET AX LINK [5, B=A]\n#SET AX LINK [6, A=X]\n#ENABLE AX LINK [5]\n#ENABLE AX LINK [6]",
     21284, {"axis": "A", "group": 5}),
    ("#SET AX LINK [5, A=X]\n#SET AX LINK [6, B=A]\n#ENABLE AX LINK [5]\n#ENABLE AX LINK [6]",
     21285, {"axis": "A", "group": 5}),
    ("#SET AX LINK [5, A=X]\n#ENABLE AX LINK [5]\nA1", 900196,
     {"axis": "A", "master": "X", "group": 5}),
    ("#SET AX LINK [5, B=Y, A=X]\n#ENABLE AX LINK [5]\nA[INDP_SYN G00 POS=1]", 900196,
     {"axis": "A", "master": "X", "group": 5}),
    ("#SET AX LINK [5, B=Y, A=X]\n#ENABLE AX LINK [5]\nX[INDP_SYN G00 POS=1]", 21481,
     {"axis": "X", "group": 5}),
    ("#SET AX LINK [5, A=X]\n#ENABLE AX LINK [5]\n#PUT AX [B, X]", 20545,
     {"axis": "X", "group": 5}),
    ("#SET AX LINK [5, A=X]\n#SET AX LINK [6, B=Y]\n#ENABLE AX LINK [6]\n#ENABLE AX LINK [5]\n"
     "G74 X1", 20137, {"g_function": "G74", "group": 5}),
]  # fmt: skip

EXCHANGES = [
    ("#PUT AX [B]\nB1", 900195, {"axis": "B"}),
    ("#PUT AX [B]\n#SET AX LINK [1, A=B]\n#ENABLE AX LINK [1]", 900195, {"axis": "B"}),
    ("#PUT AX [B]\n#SET AX LINK [1, B=X]\n#ENABLE AX LINK [1]", 900195, {"axis": "B"}),
    ("#PUT AX [Y]\n#CALL AX [Z, 2]", 21261, {"axis": "Z"}),
    ("#PUT AX [Y]\n#CALL AX [W, 2]", 900199, {"axis": "Y", "what": "name (W)"}),
    ("#PUT AX [Y, Z]\n#CALL AX [Z, 2]", 900199, {"axis": "Y", "what": "name (Z)"}),
    ("#PUT AX [Y]\n#CALL AX [Y, 2, 0]", 21260, {"index": 0}),
    ("#PUT AX [Y]\n#CALL AX [Y, 2, 4]", 21260, {"index": 4}),
    ("#PUT AX [Y]\n#CALL AX [Y, 2, 5]", 900199, {"axis": "Y", "what": "axis index (5)"}),
    ("#PUT AX [X, Y]\n#CALL AX [Y, 2, 0]", 900199, {"axis": "Y", "what": "axis index (0)"}),
    ("#CALL AX [Y, 2.5]", 20312, {"number": "2.5"}),
    ("#CALL AX [Y]", 20312, {"number": "nothing"}),
    ("#CALL AX [Y, 9]", 20312, {"number": 9}),
    ("#CALL AX [Y, 2, -1]", 900199, {"axis": "Y", "what": "axis index (-1)"}),
    ("#CALL AX [Y, 2, 1.5]", 900199, {"axis": "Y", "what": "axis index (1.5)"}),
    ("#CALL AX [X, 1][Y, 2][y, 3]", 21256, {"axis": "Y"}),
    ("#CALL AX [Y, 2][X, 1][Z, 2]", 21258, {"number": "2"}),
    ("#CALL AX [X, 1, 0][Y, 2, 1][Z, 3, 1]", 21257, {"index": "1"}),
    ("#CALL AX [X, 1, 0, 5]", 900100,
     {"word": "options of #CALL AX", "what": "offsets taken over"}),
    ("#CALL AX [X, 1, 0, V=3]", 900100,
     {"word": "options of #CALL AX", "what": "offsets taken over"}),
    ("#CHANNEL INIT [ACTPOS AXNR=9]", 20312, {"number": "9"}),
    ("#CHANNEL INIT [CMDPOS AXNR=1.5]", 20312, {"number": "1.5"}),
]  # fmt: skip

HOMING = [
    ("G74 Y1 X0", 20816, {"axis": "X", "value": "0", "low": 1, "high": 65535}),
    ("G74 X-1", 20816, {"axis": "X", "value": "-1", "low": 1, "high": 65535}),
    ("G74 Y2 X65536", 20816, {"axis": "X", "value": "65536", "low": 1, "high": 65535}),
    ("G74 X2 Y1.5", 20816, {"axis": "Y", "value": "1.5", "low": 1, "high": 65535}),
]

ALONE = [
    ("Y[INDP_SYN G00 POS=1 FEED=1]", 50603, {"axis": "Y", "option": "FEED with G00"}),
    ("Y[INDP_ASYN G00 POS=1 TIME=1]", 50603, {"axis": "Y", "option": "TIME with G00"}),
    ("Y[INDP_SYN G01 POS=1]", 900194,
     {"axis": "Y", "what": "no FEED or TIME or FEED_MAX_WEIGHT"}),
    ("Y[INDP_SYN POS=1]", 900194, {"axis": "Y", "what": "no G00 or G01 or G100 or speed"}),
    ("Y[INDP_SYN POS=1 TIME=1 FEED=1]", 900194, {"axis": "Y", "what": "FEED and TIME at a time"}),
    ("Y[INDP_SYN POS=1 FEED_MAX_WEIGHT=9 TIME=1]", 900194,
     {"axis": "Y", "what": "TIME and FEED_MAX_WEIGHT at a time"}),
    ("Y[INDP_SYN G91 G90 POS=1 FEED=1]", 900194, {"axis": "Y", "what": "G90 and G91 at a time"}),
    ("Y[INDP_SYN G100 G00 POS=1]", 900194, {"axis": "Y", "what": "G0 and G100 at a time"}),
    ("Y[INDP_SYN POS=1 FEED=0]", 50603, {"axis": "Y", "option": "FEED=0"}),
    ("Y[INDP_SYN POS=1 FEED=-2.5]", 50603, {"axis": "Y", "option": "FEED=-2.5"}),
    ("Y[INDP_SYN POS=1 TIME=0]", 50603, {"axis": "Y", "option": "TIME=0"}),
    ("Y[INDP_SYN POS=1 FEED_MAX_WEIGHT=0]", 50603, {"axis": "Y", "option": "FEED_MAX_WEIGHT=0"}),
    ("Y[INDP_SYN POS=1 FEED_MAX_WEIGHT=100.5]", 50603,
     {"axis": "Y", "option": "FEED_MAX_WEIGHT=100.5"}),
    ("Y[INDP_SYN POS=1 FEED=1 ACC_WEIGHT=101]", 50603, {"axis": "Y", "option": "ACC_WEIGHT=101"}),
    ("Y[INDP_SYN G00 POS=1 RAPID_ACC_WEIGHT=-1]", 50603,
     {"axis": "Y", "option": "RAPID_ACC_WEIGHT=-1"}),
    ("G0 X1\nX[INDP_SYN G100 POS=1 FEED=100]", 900103, {"axes": "X"}),
    ("#MEAS MODE[3]\nY[INDP_SYN G100 POS=1 FEED=100]", 21588, {"axis": "Y", "type": 3}),
    ("X1 Y[INDP_SYN POS=1 FEED=1] Y5", 20203, {"axis": "Y"}),
    ("#CS ON [1,2]\nY[INDP_SYN POS=1 FEED=1]", 21071, {"axis": "Y", "transformation": "Cartesian"}),
]  # fmt: skip


@pytest.mark.parametrize(("blocks", "alarm_id", "values"), LINKS + EXCHANGES + HOMING + ALONE)
def test_the_block_that_is_refused_and_why(run, blocks, alarm_id, values):
    with pytest.raises(Alarm) as caught:
        run(f"G0\n{blocks}", axes=XYZAB)
    alarm = caught.value
    assert (alarm.id, alarm.values) == (alarm_id, values)
    assert alarm.place == f"test.nc line {len(blocks.splitlines()) + 1}"


@pytest.mark.parametrize(
    "blocks",
    [
        "#SET AX LINK [1, A=X]",  # the first and the last group
        "#SET AX LINK [31, A=X]",
        "#SET AX LINK [1, [A=X,G,1,1]]",  # both limits alike
        "#SET AX LINK [1, [A=X,G]]",
        "#DISABLE AX LINK",
        "G74 X65535 Y1 Z1",
        "Y[INDP_SYN POS=1 FEED=1 ACC_WEIGHT=100]",
        "Y[INDP_SYN POS=1 FEED_MAX_WEIGHT=100]",
        "Y[INDP_SYN POS=1 FEED=0.001]",
        "#CS ON [1,2]\nA[INDP_SYN POS=1 FEED=1]",
        "#CALL AX [Y, 2]",  # it is in the channel: nothing is done
        "#PUT AX [Y, A]\n#CALL AX [Y, 2, 1][A, 4]\nY1 A2",
    ],
)
def test_what_is_just_allowed(run, blocks):
    run(f"G0\n{blocks}", axes=XYZAB)
