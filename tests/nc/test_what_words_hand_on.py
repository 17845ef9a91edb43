"""What a word hands to the channel: units, defaults, order, and what is switched off again."""

import pytest
from tests.nc.conftest import of, texts
from tests.nc.five_axes import ON, run5

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import (
    ArcMove,
    DriveRead,
    DriveWait,
    DriveWrite,
    Dwell,
    DynamicWeights,
    ExactStop,
    Homing,
    IndependentMove,
    KinematicChoice,
    LinearMove,
    MeasuringRun,
    ProgramStop,
    SlopeChoice,
    TechnologyFunction,
    Wait,
    WaitIndependent,
)
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.coordinates.circle import CircleLimits

XYZA = ("X", "Y", "Z", "A")


# ---- motion


def test_a_feed_is_that_of_the_unit_in_which_it_is_written(run):
    """G70 of its block counts for its F; what is written stays when the unit changes."""
    moves = of(run("G1 F100 X1\nG70 F10 X1\nG71 X3\nF50 X4"), LinearMove)
    assert [move.feed_mm_min for move in moves] == pytest.approx([100.0, 254.0, 254.0, 50.0])
    assert [move.target_mm["X"] for move in moves] == pytest.approx([1.0, 25.4, 3.0, 4.0])


def test_the_feed_is_read_in_the_unit_of_the_program(run):
    show = '#MSG ["%.3f", V.G.FEEDRATE]'
    assert texts(run(f"{show}\nF254\n{show}\nG70\n{show}\nG71\n{show}")) == [
        "0.000",
        "254.000",
        "10.000",
        "254.000",
    ]


def test_rapid_traverse_has_no_feed_whatever_was_programmed(run):
    moves = of(run("F100\nG0 X1\nG1 X2\nG0 X3"), LinearMove)
    assert [(move.rapid, move.feed_mm_min) for move in moves] == [
        (True, None),
        (False, 100.0),
        (True, None),
    ]


def test_what_was_last_of_an_arc_is_read_in_the_unit_and_the_plane(run):
    """V.G.R, V.G.I, J, K: from the start to the centre; nothing before an arc."""
    show = '#MSG ["%.3f %.3f %.3f %.3f", V.G.R, V.G.I, V.G.J, V.G.K]'
    text = f"{show}\nG2 F100 X6 Y0 I3 J4\n{show}\nG70\n{show}\nG71 G19 G3 Y0 Z0 J0 K25.4\n{show}"
    assert texts(run(text)) == [
        "0.000 0.000 0.000 0.000",
        "5.000 3.000 4.000 0.000",
        "0.197 0.118 0.157 0.000",  # 5, 3 and 4 mm in inch
        "25.400 0.000 0.000 25.400",
    ]


def test_the_limits_of_an_arc_are_those_of_the_lists(run):
    """The end of half a circle of radius 10 is 0.03 mm too far on."""
    text = "G164 G2 F100 X20.03 I10 J0"
    with pytest.raises(Alarm) as caught:
        run(text)
    assert caught.value.id == 21758
    limits = CircleLimits(radius_mm=0.05, radius_of_radius=0.01)
    (arc,) = of(run(text, tables=OffsetTables(circle=limits)), ArcMove)
    assert arc.centre_mm == {"X": 10.0, "Y": 0.0}


@pytest.mark.parametrize(
    ("blocks", "stops"),
    [
        ("G0 X1", 0),
        ("G60 G0 X1\nX2", 1),
        ("G360\nG0 X1\nX2\nG359\nX3", 2),
        ("G360\nG60 G0 X1", 1),
        ("G0 X1\nG360\nG4 X1", 0),
        ("F9\nG60 G2 I5", 1),  # a full circle has no axis word
        ("G0 X1\nG360\nG1 F5 X1", 1),  # its end is waited for where nothing moves too
    ],
)
def test_an_exact_stop_is_after_each_block_that_asks_for_it(run, blocks, stops):
    commands = run(blocks)
    assert len(of(commands, ExactStop)) == stops


def test_a_stop_comes_after_the_motion_of_its_block(run):
    found = of(run("G0 X1 M0\nX2 M1"), LinearMove, ProgramStop)
    assert [type(each) for each in found] == [LinearMove, ProgramStop] * 2
    assert [each.optional for each in found if isinstance(each, ProgramStop)] == [False, True]


def test_functions_go_out_before_the_motion_of_their_block(run):
    found = of(run("G0 X1 H7 M50 T3 M8"), LinearMove, TechnologyFunction)
    words = [each.word if isinstance(each, TechnologyFunction) else "X1" for each in found]
    assert words == ["M50", "M8", "H7", "T3", "X1"]


@pytest.mark.parametrize(
    ("blocks", "duration_ns"),
    [
        ("G4 X0.25", 250_000_000),
        ("G4 0.000001", 1_000),
        ("G4[2]", 2_000_000_000),
        ("G70 G4 X1", 1_000_000_000),  # a time has no inch
        ("P1=1.5\n#TIME [P1]", 1_500_000_000),
    ],
)
def test_a_dwell_time_is_in_seconds(run, blocks, duration_ns):
    assert [each.duration_ns for each in of(run(blocks), Dwell)] == [duration_ns]


# ---- profiles and weights


def test_weights_are_shares_of_the_named_axes_or_of_all(run):
    text = "G130 X50 A200\nG131=70\nG132 Y1\nG133=100\nG134=0.5"
    assert [(w.what, w.shares) for w in of(run(text, axes=XYZA), DynamicWeights)] == [
        ("acceleration", {"X": 0.5, "A": 2.0}),
        ("acceleration", dict.fromkeys(XYZA, 0.7)),
        ("ramp_time", {"Y": 0.01}),
        ("ramp_time", dict.fromkeys(XYZA, 1.0)),
        ("contour_time", dict.fromkeys(XYZA, 0.005)),
    ]


def test_a_weight_has_no_unit(run):
    (weights,) = of(run("G70 G130 X50"), DynamicWeights)
    assert weights.shares == {"X": 0.5}


def test_profiles_in_their_order_and_back(run):
    text = "#SLOPE [TYPE=step]\n#SLOPE [TYPE=SIN2 NO_OPT=1]\n#SLOPE DEFAULT\n#SLOPE [TYPE=TRAPEZ]"
    assert [each.profile for each in of(run(text), SlopeChoice)] == ["STEP", "SIN2", None, "TRAPEZ"]


# ---- measuring


def test_settings_of_measuring_hold_until_their_default(run):
    block = "G100 F100 X{}"
    text = (
        f"{block.format(1)}\n#MEAS [ERR_NO_SIGNAL=1 SIMU_OFFSET=2]\n{block.format(2)}\n"
        f"#MEAS [ERR_NO_SIGNAL=0]\nG70\n#MEAS [SIMU_OFFSET=2]\nG71\n{block.format(3)}\n"
        f"#MEAS DEFAULT\n{block.format(4)}"
    )
    assert [
        (each.error_no_signal, each.simulated_offset_mm) for each in of(run(text), MeasuringRun)
    ] == [(None, 0.0), (True, 2.0), (False, 50.8), (None, 0.0)]


@pytest.mark.parametrize(("default", "chosen"), [(1, 3), (3, 1), (7, 2)])
def test_the_type_of_the_lists_counts_until_one_is_chosen_and_after_it(run, default, chosen):
    text = (
        f"G100 F100 X1\n#MEAS MODE[{chosen}]\nG100 X2\n#MEAS MODE\nG100 X3\n"
        f"#MEAS [TYPE={chosen}]\nG100 X4\n#MEAS DEFAULT\nG100 X5"
    )
    runs = of(run(text, default_measuring_type=default), MeasuringRun)
    assert [each.measuring_type for each in runs] == [default, chosen, default, chosen, default]


def test_a_run_has_no_feed_where_its_type_has_a_speed_of_its_own(run):
    runs = of(run("F77\nG100 X1\n#MEAS MODE[2]\nG100 X2\n#MEAS MODE[3]\nG100 X3"), MeasuringRun)
    assert [each.feed_mm_min for each in runs] == [77.0, None, 77.0]
    (rapid, fed) = of(run("F77\n#MEAS MODE[5]\nG0 G310 X1\nG1 G310 X2"), MeasuringRun)
    assert (rapid.feed_mm_min, fed.feed_mm_min) == (None, 77.0)


# ---- drives


@pytest.mark.parametrize(
    ("block", "waits", "value", "length"),
    [
        ("#DRIVE WR [AX=Y KEY=LIMIT VAL=7]", False, 7.0, None),
        ("#DRIVE WR SYN [AXNR=2 KEY=LIMIT VAL=-7 WAIT]", True, -7.0, None),
        ("#IDENT WR [AX=Y ID=S-0-0092 VAL=1.5 TYP=2 DEC=2]", True, 150.0, 2),
        ("#IDENT WR SYN [AXNR=2 ID=s-0-0092 VAL=1.5 TYP=4 DEC=0 NO_WAIT]", False, 1.5, 4),
        ("#COMMAND WR [AX=Y ID=S-0-0099]", True, 3.0, 2),
    ],
)
def test_a_write_waits_as_its_command_says(run, block, waits, value, length):
    (write,) = of(run(block), DriveWrite)
    assert (write.axis, write.waits, write.value) == ("Y", waits, value)
    assert write.length_bytes == length
    assert write.word == block.partition(" [")[0].removesuffix(" SYN")
    assert write.key == ("LIMIT" if length is None else block.partition("ID=")[2][:8].upper())


def test_waiting_for_one_axis_for_all_and_for_one_command(run):
    text = "#DRIVE WAIT SYN [AX=Z]\n#IDENT WAIT SYN\n#COMMAND WAIT SYN [AX=Y ID=s-0-0099]"
    assert [(w.axis, w.commands, w.key) for w in of(run(text), DriveWait)] == [
        ("Z", False, ""),
        *((axis, False, "") for axis in "XYZ"),
        ("Y", True, "S-0-0099"),
    ]
    every = of(run("#COMMAND WAIT SYN"), DriveWait)
    assert [(w.axis, w.commands, w.key) for w in every] == [(axis, True, "") for axis in "XYZ"]


def test_an_ident_is_read_in_what_its_digits_mean(run, plane_machine):
    machine = plane_machine(dict.fromkeys("XYZ", 0.0), None)
    values = {("Y", "S-0-0092"): 1234.0, ("Y", "LIMIT"): 7.0}
    machine.drive_value = lambda axis, key: values[axis, key]
    text = "#IDENT RD [AX=Y ID=S-0-0092 P=P1 TYP=2 DEC=2]\n#DRIVE RD [AX=Y KEY=LIMIT P=V.P.L]\n"
    commands = run(f'{text}#MSG ["%.3f %.3f", P1, V.P.L]', machine)
    assert texts(commands) == ["12.340 7.000"]
    assert [(r.key, r.length_bytes) for r in of(commands, DriveRead)] == [
        ("S-0-0092", 2),
        ("LIMIT", None),
    ]
    kinds = [type(each) for each in commands[:4]]
    assert kinds == [DriveRead, Wait, DriveRead, Wait]  # the value is there when it is read


# ---- single axes


@pytest.mark.parametrize(
    ("words", "speed"),
    [
        ("FEED=100", (100.0, None, None, 1.0)),
        ("G01 TIME=2.5", (None, 2.5, None, 1.0)),
        ("FEED_MAX_WEIGHT=50 ACC_WEIGHT=25", (None, None, 0.5, 0.25)),
        ("G00", (None, None, None, 1.0)),
        ("G00 RAPID_ACC_WEIGHT=10", (None, None, None, 0.1)),
        ("G00 ACC_WEIGHT=10", (None, None, None, 1.0)),  # it is that of G01
        ("FEED=5 RAPID_ACC_WEIGHT=10", (5.0, None, None, 1.0)),
    ],
)
def test_the_speed_and_the_weight_of_an_axis_by_itself(run, words, speed):
    (move,) = of(run(f"Y[INDP_SYN POS=1 {words}]"), IndependentMove)
    found = (move.feed_mm_min, move.time_s, move.speed_share, move.acceleration_share)
    assert found == speed
    assert (move.axis, move.target_mm, move.slope, move.measuring_type) == ("Y", 1.0, None, None)


def test_the_unit_counts_for_way_and_feed_of_an_axis_by_itself_and_not_for_its_time(run):
    tables = OffsetTables(rotary=frozenset("A"))
    text = "G70\nX[INDP_SYN POS=1 FEED=10]\nY[INDP_SYN POS=1 TIME=10]\nA[INDP_SYN POS=1 FEED=10]"
    moves = of(run(text, axes=XYZA, tables=tables), IndependentMove)
    assert [(m.target_mm, m.feed_mm_min, m.time_s) for m in moves] == [
        (25.4, pytest.approx(254.0), None),
        (25.4, None, 10.0),
        (1.0, 10.0, None),  # degrees
    ]


def test_distances_and_coordinates_of_an_axis_by_itself(run):
    text = "G91\n{0} POS=5 G00]\n{0} POS=5 G00]\n{0} G90 POS=5 G00]\nG90\n{0} G91 POS=-1 G00]"
    moves = of(run(text.format("X[INDP_SYN")), IndependentMove)
    assert [move.target_mm for move in moves] == [5.0, 10.0, 5.0, 4.0]


def test_a_profile_of_an_axis_by_itself_is_that_of_its_command_alone(run):
    text = "X[INDP_SYN POS=1 G00 SLOPE_TYPE=sin2]\nX[INDP_SYN POS=2 G00]"
    assert [move.slope for move in of(run(text), IndependentMove)] == ["SIN2", None]


def test_who_is_waited_for(run):
    text = (
        "X[INDP_ASYN POS=1 FEED=5]\nY[INDP_ASYN POS=1 FEED=5]\nZ[INDP_SYN POS=1 FEED=5]\n"
        "#WAIT INDP [Y]\n#WAIT INDP\n#WAIT INDP ALL"
    )
    assert [each.axes for each in of(run(text), WaitIndependent)] == [("Z",), ("Y",), ("X",)]


def test_axes_home_in_the_order_of_their_numbers(run):
    """Programming manual 206138635: `G74 X2 Y3 Z1` homes Z, then X, then Y."""
    for blocks, groups in (
        ("G74 X2 Y3 Z1", (("Z",), ("X",), ("Y",))),
        ("G74 X1 Y1 Z1", (("X", "Y", "Z"),)),
        ("G74 Z20 A9 X9", (("A", "X"), ("Z",))),
    ):
        (homing,) = of(run(blocks, axes=XYZA), Homing)
        assert tuple(map(sorted, homing.groups)) == tuple(map(sorted, groups))


# ---- kinematics


def test_a_kinematic_keeps_the_parameters_that_it_was_built_from() -> None:
    """What is written afterwards is for the next one; off twice is off once."""
    name = "V.G.KIN_STEP[0].ID[9].PARAM[0]"
    text = f"{name} = 800000\n{ON}{name} = 900000\n#TRAFO OFF\n#TRAFO OFF"
    first, last = of(run5(text), KinematicChoice)
    assert first.written == {(0, 9, 0): 800_000.0}
    assert (first.ids[:1], last.kinematic, last.axes) == ((9,), None, ())
