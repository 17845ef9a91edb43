"""The manuals' spellings of single axes: from the text to what the channel is told."""

from collections.abc import Callable
from typing import Any

import pytest
from axis_statements import AXES

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.canon import AxisPair

Run = Callable[..., Any]
XYZ2 = ("X", "Y", "Z", "X2")


def orders(commands: list[canon.Command]) -> list[canon.Command]:
    """What is told of single axes."""
    return [c for c in commands if isinstance(c, canon.AxisOrder)]


def test_the_program_of_the_manual(run: Run) -> None:
    """FCT-C4 section 2."""
    text = """%Independent_measurement_path
N10 G0 X0 Y0
N20 X[INDP_SYN G100 G90 POS100 FEED500] \\
        Y[INDP_SYN G100 G90 POS100 FEED1000]
N30 M30
"""
    x, y, both = orders(run(text))
    assert (x.axis, x.target_mm, x.feed_mm_min, x.measuring_type) == ("X", 100.0, 500.0, 1)
    assert (y.axis, y.target_mm, y.feed_mm_min, y.measuring_type) == ("Y", 100.0, 1000.0, 1)
    assert both.axes == ("X", "Y")


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("G90 G00 POS=100", {"target_mm": 100.0}),
        ("G91 G01 POS 20 TIME=1.5", {"target_mm": 20.0, "time_s": 1.5}),
        ("G90 G01 POS=[2*5] FEED_MAX_WEIGHT=25", {"target_mm": 10.0, "speed_share": 0.25}),
        ("POS=3 FEED=100 G90 G01 ACC_WEIGHT=40", {"feed_mm_min": 100.0, "acceleration_share": 0.4}),
        ("G90 G0 POS=3 RAPID_ACC_WEIGHT=10", {"acceleration_share": 0.1}),
        ("G90 G0 POS=3 INCL_OFFSETS", {"target_mm": 8.0}),
        ("G90 G0 POS=3 SLOPE_TYPE=STEP", {"target_mm": 3.0, "slope": "STEP"}),
        ("G90 G0 POS=3 SLOPE_TYPE=sin2", {"target_mm": 3.0, "slope": "SIN2"}),
        ("G90 G0 POS=3", {"slope": None}),
    ],
)
def test_spellings_of_independent_motion(
    run: Run, written: str, expected: dict[str, float]
) -> None:
    (move,) = orders(run(f"%t\nN5 G92 X5\nN10 X[INDP_ASYN {written}]\nN20 M30\n"))
    assert {name: getattr(move, name) for name in expected} == expected


def test_inches(run: Run) -> None:
    (move,) = orders(run("%t\nN5 G70\nN10 X[INDP_ASYN G90 G1 POS=2 FEED=10]\nN20 M30\n"))
    assert (move.target_mm, move.feed_mm_min) == (50.8, 254.0)


def test_m_and_h_functions_are_told_before_the_axis_moves(run: Run) -> None:
    commands = run("%t\nN10 X[INDP_SYN G90 G0 POS=2 M25 H7]\nN20 M30\n")
    message = [(c.letter, c.number) for c in commands if isinstance(c, canon.TechnologyFunction)]
    assert message == [("M", 25), ("H", 7)]
    assert isinstance(commands[2], canon.IndependentMove)


@pytest.mark.parametrize("word", ["DRY_RUN"])
def test_what_does_not_act_yet(run: Run, word: str) -> None:
    with pytest.raises(Alarm, match="900100"):
        run(f"%t\nN10 X[INDP_SYN G90 G0 POS=2 {word}]\nN20 M30\n")


@pytest.mark.parametrize("word", ["#WAIT INDP [X, Y]", "#WAIT INDP ALL", "#WAIT INDP[ALL]"])
def test_waiting(run: Run, word: str) -> None:
    text = "%t\nN10 X[INDP_ASYN G90 G0 POS=2] Y[INDP_ASYN G90 G0 POS=2]\n"
    assert orders(run(f"{text}N20 {word}\nN30 M30\n"))[-1].axes == ("X", "Y")


@pytest.mark.parametrize(
    ("define", "pairs"),
    [
        ("#SET AX LINK[1, [X2=X,G,15,20]]", [AxisPair("X2", "X", (15.0, 20.0))]),
        ("#SET AX LINK[1, X2=X]", [AxisPair("X2", "X")]),
        ("#AX LINK[1, X2=X]", [AxisPair("X2", "X")]),
        ("#SET AX LINK[1, [X2=X,G]]", [AxisPair("X2", "X")]),
        ("#SET AX LINK[ 1 , [ X2 = X , G , 2*7.5 , 20 ] ]", [AxisPair("X2", "X", (15.0, 20.0))]),
    ],
)
@pytest.mark.parametrize(
    ("on", "off"),
    [
        ("#ENABLE AX LINK[1]", "#DISABLE AX LINK[1]"),
        ("#AX LINK ON[1]", "#AX LINK OFF[1]"),
        ("#ENABLE AX LINK [1]", "#DISABLE AX LINK"),
        ("#AX LINK ON [1]", "#AX LINK OFF ALL"),
    ],
)
def test_spellings_of_couplings(
    run: Run, define: str, pairs: list[AxisPair], on: str, off: str
) -> None:
    begun, ended = orders(run(f"%t\nN10 {define}\nN20 {on}\nN30 {off}\nN40 M30\n", axes=XYZ2))
    assert list(begun.pairs) == pairs
    assert (begun.group, ended.group) == (1, 1)


def test_couplings_by_logical_axis_numbers(run: Run) -> None:
    """TF5200 programming manual 207120267: `#AX LINK NBR [2, 8 = 2]`."""
    text = "%t\nN5 #AX LINK NBR[1, 4 = 1]\nN10 #AX LINK NBR [2, [4=2,G,1,2]]\n"
    (on,) = orders(run(text + "N20 #AX LINK ON[2]\nN30 M30\n", axes=XYZ2))
    assert on.pairs == (AxisPair("X2", "Y", (1.0, 2.0)),)
    for pair in ("9=1", "4=9", "4=X", "X2=1"):
        with pytest.raises(Alarm, match="900198"):
            run(f"%t\nN10 #AX LINK NBR[1, {pair}]\nN20 M30\n", axes=XYZ2)


def test_spellings_of_the_exchange(run: Run) -> None:
    for all_of_them in ("ALL", "all", "[ALL]", "[all]", "[All]"):
        (every,) = orders(run(f"%t\nN10 #PUT AX {all_of_them}\nN20 M30\n"))
        assert every.given == ("X", "Y", "Z")
    text = "%t\nN10 #PUT AX[X, X]\nN20 #CALL AX[X,1,0]\nN30 #PUT AX ALL\n"
    text += "N40 #CALL AX FAST [X,1,0] [Y,2,1]\nN50 M30\n"
    first, back, every, two = orders(run(text))
    assert (first.given, back.called) == (("X",), ("X",))
    assert (every.given, two.called) == (("X", "Y", "Z"), ("X", "Y"))


def test_an_axis_that_is_away_is_not_given_again(run: Run) -> None:
    """Nothing is left of a command that names no other one."""
    text = "%t\n#PUT AX[Y]\n#PUT AX[Y]\n#PUT AX[Y, Z]\n#PUT AX ALL\n#PUT AX ALL\nM30\n"
    assert [order.given for order in orders(run(text))] == [("Y",), ("Z",), ("X",)]


def test_homing_and_positions(run: Run) -> None:
    text = "%t\nN10 G74 X2 Y3 Z1\nN20 #CHANNEL INIT [ACTPOS AX=X AX=Y]\n"
    text += "N30 #CHANNEL INIT[CMDPOS]\nN40 #CHANNEL INIT[ACTPOS AXNR=3]\nN50 M30\n"
    home, some, one = orders(run(text))
    assert home.groups == (("Z",), ("X",), ("Y",))
    assert (some.axes, one.axes) == (("X", "Y"), ("Z",))


@pytest.mark.parametrize(
    "block",
    [
        "W[INDP_SYN G90 G0 POS=1]",
        "X[INDP_SYN G90 G0 POS=1 SPEED=2]",
        "X[INDP_SYN G90 G0 POS=]",
        "X[INDP G90 G0 POS=1]",
        "#SET AX LINK",
        "#PUT AX[O]",
        "#PUT AX[Q,X]",
        "G74",
    ],
)
def test_what_the_text_alone_shows_is_refused_before_anything_moves(run: Run, block: str) -> None:
    with pytest.raises(UserError) as caught:
        run(f"%t\nN10 {block}\nN20 M30\n")
    assert (caught.value.line, caught.value.file) == (2, "test.nc")
    assert AXES


@pytest.mark.provokes(20203, 2, axis="X")
@pytest.mark.parametrize(
    "block",
    ["X10 X[INDP_SYN G0 G90 POS=1] F100", "X[INDP_SYN G0 G90 POS=1] X[INDP_SYN G0 G90 POS=2]"],
)
def test_20203_for_an_axis_that_is_programmed_twice_in_a_block(run: Run, block: str) -> None:
    with pytest.raises(Alarm, match="20203"):
        run(f"%t\nN10 {block}\nN20 M30\n")


@pytest.mark.parametrize(
    ("block", "alarm_id"),
    [
        ("#SET AX LINK[1,[X2=X,G,X,Y]]", 900198),
        ("#SET AX LINK[1,[X2=X,H,1,2]]", 900198),
        ("#SET AX LINK[1,[[X2=X]]]", 900198),
        ("#SET AX LINK[1,[X2=X,Y=X,G]]", 900198),  # a bracket has one pair
        ("#SET AX LINK[1,X2=5]", 900198),
        ("#SET AX LINK[1,,X2=X]", 900198),
        ("#SET AX LINK[]", 900197),
        ("#ENABLE AX LINK", 900197),
        ("#CALL AX[]", 20312),
        ("#CALL AX[X,Y,Z]", 20312),
        ("#CALL AX[X,1,0.5]", 900199),
        ("#CALL AX[X,1,-1]", 900199),
        ("#CHANNEL INIT[ACTPOS AXNR=1.5]", 20312),
    ],
)
def test_what_a_command_cannot_mean_is_told(run: Run, block: str, alarm_id: int) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"%t\nN10 {block}\nN20 M30\n", axes=XYZ2)
    assert caught.value.id == alarm_id
