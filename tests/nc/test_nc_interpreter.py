"""What programs do: modal words, shifts, measuring results, alarms."""

import pytest
from tests.nc.conftest import texts

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import EndOfProgram, LinearMove, MeasuringRun

XYZ = ("X", "Y", "Z")


def moves(commands):
    return [c for c in commands if isinstance(c, LinearMove | MeasuringRun)]


def targets(commands):
    return [dict(c.target_mm) for c in moves(commands)]


def value_of(run, expression, before="", **options):
    """Let a message print an expression with nine digits."""
    (text,) = texts(run(f'{before}\n#MSG ["%.9f", {expression}]', **options))
    return float(text)


# ---- moves


def test_motion_is_modal_and_feed_stays(run):
    commands = run("G0 X5\nX10\nG1 X20 F300\nY1\nG00 Z1")
    assert [(m.rapid, m.feed_mm_min) for m in moves(commands)] == [
        (True, None),
        (True, None),
        (False, 300.0),
        (False, 300.0),
        (True, None),
    ]


def test_measuring_run_does_not_change_the_modal_motion(run):
    commands = run("G0 X5 F100\nG100 X10\nX7")
    assert [type(m) for m in moves(commands)] == [LinearMove, MeasuringRun, LinearMove]
    assert moves(commands)[2].rapid


def test_relative_programming_adds_to_the_position(run):
    assert targets(run("G0 X10\nG91 X5 Y-1\nX5\nG90 X1")) == [
        {"X": 10.0},
        {"X": 15.0, "Y": -1.0},
        {"X": 20.0},
        {"X": 1.0},
    ]


def test_move_to_the_present_position_is_no_command(run):
    assert targets(run("G0 X0\nX1\nX1")) == [{"X": 1.0}]


def test_start_position_is_that_of_the_machine(run, plane_machine):
    machine = plane_machine({"X": 3.0, "Y": 0.0, "Z": 0.0}, None)
    assert targets(run("G91 G0 X1", machine)) == [{"X": 4.0}]


def test_program_ends_at_m30_and_nothing_behind_it_runs(run):
    commands = run("G0 X1\nN20 M30\nX2")
    assert targets(commands) == [{"X": 1.0}]
    assert commands[-1].block.number == 20


@pytest.mark.parametrize("word", ["M30", "M2", "M02", "m30"])
def test_words_that_end_a_program(run, word):
    assert len(run(f"{word}\nG0 X1")) == 1


def test_m30_beside_a_move_ends_after_it(run):
    assert [type(c) for c in run("G0 X1 M30\nX2")] == [LinearMove, EndOfProgram]


@pytest.mark.parametrize("text", ["", "\n\n", "%empty\n", "; comment\n(another"])
def test_empty_program_ends(run, text):
    assert [type(c) for c in run(text)] == [EndOfProgram]


def test_block_text_and_line_are_as_written(run):
    (move, _) = run("%p\n\nN10 G0 \\\n  X1  ; there\n")
    assert (move.block.line, move.block.number) == (3, 10)
    assert move.block.text.startswith("N10 G0 \\ X1")
    assert str(move.block) == "line 3, block N10"


def test_axis_name_with_digit(run):
    assert targets(run("G0 X2=4 X=1", axes=("X", "X2"))) == [{"X": 1.0, "X2": 4.0}]


# ---- reference point offset


def test_reference_point_offset_moves_the_next_absolute_target(run):
    assert targets(run("G92 X10\nG0 X5\nG92 X0\nX5")) == [{"X": 15.0}, {"X": 5.0}]


def test_reference_point_offset_alone_moves_nothing_in_relative_programming(run):
    """The manual's rule: G92 and then a relative 0 causes no motion."""
    assert targets(run("G0 X1\nG92 X10 Y20\nG91 X0\nX2\nG90 X0")) == [
        {"X": 1.0},
        {"X": 3.0},
        {"X": 10.0},
    ]


def test_reference_point_offset_replaces_in_g90_and_adds_in_g91(run):
    assert targets(run("G92 X10\nG92 X4\nG0 X0\nG91 G92 X3\nG90 X0")) == [{"X": 4.0}, {"X": 7.0}]


def test_absolute_coordinate_and_programmed_coordinate(run):
    before = "G92 X10\nG0 X5"
    assert value_of(run, "V.A.PROG.X", before) == 5
    assert value_of(run, "V.A.ABS.X", before) == 15


def test_offset_of_an_axis_waits_for_its_own_programming(run):
    """X keeps its place while only Y is programmed."""
    assert targets(run("G0 X1 Y1\nG92 X10 Y10\nY2\nX2")) == [
        {"X": 1.0, "Y": 1.0},
        {"Y": 12.0},
        {"X": 12.0},
    ]


# ---- measuring


def test_moved_axes_must_signal_without_transformation(run):
    (measuring,) = [c for c in run("G100 X10 Y0 F100") if isinstance(c, MeasuringRun)]
    assert measuring.programmed_axes == ("X", "Y")
    assert measuring.measuring_axes == ("X",)


def test_all_main_axes_must_signal_under_a_coordinate_system(run):
    text = "#CS ON[0,0,0,0,0,90]\nG100 X10 F500\n#CS OFF\nG100 X20 F500"
    runs = [c for c in run(text) if isinstance(c, MeasuringRun)]
    assert [r.measuring_axes for r in runs] == [XYZ, ("X",)]
    assert dict(runs[0].target_mm) == pytest.approx({"Y": 10.0})


def test_fourth_axis_signals_only_when_it_moves(run):
    axes = (*XYZ, "A")
    text = "#CS ON[0,0,0,0,0,90]\nG100 X10 F500\nG100 X20 A5"
    runs = [c for c in run(text, axes=axes) if isinstance(c, MeasuringRun)]
    assert [r.measuring_axes for r in runs] == [XYZ, axes]


def test_machine_is_read_only_after_the_run_has_been_executed(run, plane_machine):
    """The machine of these tests refuses to be read before; a relative move shows the end."""
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    assert targets(run("G100 X10 F100\nG91 G0 X1", machine)) == [{"X": 10.0}, {"X": 5.0}]


RUN = "G100 X10 F100"


@pytest.fixture
def at_four(plane_machine):
    return plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))


@pytest.mark.parametrize(
    ("variable", "expected"),
    [
        ("V.A.MESS.X", 4),
        ("V.A.MEAS.ACS.VALUE.X", 4),
        ("V.A.MEAS.PCS.VALUE.X", 4),
        ("V.A.MOFFS.X", -6),
        ("V.A.MERF.X", 1),
        ("V.A.MERF.Y", 0),
        ("V.A.PROG.X", 10),
        ("V.A.ABS.X", 4),
        ("V.G.MEAS_TYPE", 1),
    ],
)
def test_values_after_a_run(run, at_four, variable, expected):
    assert value_of(run, variable, RUN, machine=at_four) == expected


def test_measured_flag_prints_as_whole_number_and_as_float(run, at_four):
    text = f'{RUN}\n#MSG ["%d %f", V.A.MERF.X, V.A.MERF.X]'
    assert texts(run(text, at_four)) == ["1 1.000000"]


@pytest.mark.parametrize(
    "second", ["G0 X20\nG100 X30", "G100 X4 Y10"], ids=["no signal", "programmed without path"]
)
def test_second_run_without_measurement_takes_the_value_away(run, plane_machine, second):
    """An old value would be taken for a new one, so neither flag nor value stays."""

    def machine():
        return plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))

    assert value_of(run, "V.A.MERF.X", f"{RUN}\n{second}", machine=machine()) == 0
    with pytest.raises(Alarm) as caught:
        value_of(run, "V.A.MESS.X", f"{RUN}\n{second}", machine=machine())
    assert caught.value.id == 900101


def test_values_of_axes_not_programmed_later_are_kept(run, at_four):
    shown = '#MSG ["%g %d %d", V.A.MESS.X, V.A.MERF.X, V.A.MERF.Y]'
    assert texts(run(f"{RUN}\nG100 Y10\n{shown}", at_four)) == ["4 1 0"]


def test_broken_signal_line_of_one_axis(run, plane_machine):
    start = dict.fromkeys(XYZ, 0.0)
    before = "G100 X10 Y5 F100"
    machine = plane_machine(start, ("X", 4.0), silent=("Y",))
    assert value_of(run, "V.A.MESS.X", before, machine=machine) == 4
    machine = plane_machine(start, ("X", 4.0), silent=("Y",))
    assert value_of(run, "V.A.MERF.Y", before, machine=machine) == 0


def test_broken_signal_line_under_a_coordinate_system_leaves_no_value(run, plane_machine):
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0), silent=("Y",))
    before = "#CS ON[0,0,0,0,0,45]\nG100 X10 F100"
    assert value_of(run, "V.A.MERF.X", before, machine=machine) == 1
    with pytest.raises(Alarm) as caught:
        value_of(run, "V.A.MESS.X", before, machine=machine)
    assert caught.value.id == 900101


def test_values_stay_in_the_system_of_their_run(run, plane_machine):
    """MESS of a run under #CS keeps its value after #CS OFF."""
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    before = "#CS ON[1,0,0]\nG100 X10 F100\n#CS OFF"
    assert value_of(run, "V.A.MESS.X", before, machine=machine) == 3


def test_factor_of_the_measurement_offset_and_its_replacement(run, at_four):
    """MOFFS is -6: half of it, then twice; the second does not add to the first."""
    before = f"{RUN}\nG101 X0.5\nG101 X2\nG0 X100"
    assert value_of(run, "V.A.MEIN.X", before, machine=at_four) == -12
    assert at_four.acs_mm["X"] == 88


def test_measurement_offset_waits_for_absolute_programming(run, at_four):
    assert targets(run(f"{RUN}\nG101 X1\nG91 G0 X1\nG90 X100", at_four))[1:] == [
        {"X": 5.0},
        {"X": 94.0},
    ]


def test_second_run_with_included_offset_follows_the_formula_of_the_manual(run, at_four):
    """MOFFS = MESS - PROG - zero shifts: the included offset is not subtracted, MEAS.PCS is."""
    before = f"{RUN}\nG0 X0\nG101 X1\nG100 X12"
    assert value_of(run, "V.A.MOFFS.X", before, machine=at_four) == 4 - 12
    before = f"{RUN}\nG0 X0\nG101 X1\nG100 X12"
    at_four.acs_mm["X"] = 0.0
    assert value_of(run, "V.A.MEAS.PCS.VALUE.X", before, machine=at_four) == 4 + 6


def test_g102_drops_the_named_axis_or_all(run, plane_machine):
    start = dict.fromkeys(XYZ, 0.0)
    before = "G100 X8 Y8 F100\nG101 X1 Y1\n"
    named = f'{before}G102 X1\n#MSG ["%g %g", V.A.MEIN.X, V.A.MEIN.Y]'
    assert texts(run(named, plane_machine(start, ("X", 4.0)))) == ["0 -4"]
    every = f'{before}G102\n#MSG ["%g %g", V.A.MEIN.X, V.A.MEIN.Y]'
    assert texts(run(every, plane_machine(start, ("X", 4.0)))) == ["0 0"]


@pytest.mark.parametrize(
    ("text", "alarm_id"),
    [
        ("#MEAS MODE[5]\nN7 G100 X1 F100", 20138),
        ("#MEAS MODE[6]\nN7 G100 X1 F100", 20138),
        ("#MEAS MODE[5]\nN7 G101 X1", 20772),
        ("#MEAS MODE[6]\nN7 G102 X1", 20772),
        ("N7 G101 X1", 900101),
        ('N7 #MSG ["%f", V.A.MESS.X]', 900101),
        ('N7 #MSG ["%f", V.A.MEAS.ACS.VALUE.X]', 900101),
        ('N7 #MSG ["%f", V.A.MEAS.PCS.VALUE.X]', 900101),
        ('N7 #MSG ["%f", V.A.MOFFS.X]', 900101),
        ("#MEAS MODE[2]\nN7 G100 X1 Y1 F100", 50061),
        ("N7 G100 X0 F100", 900103),
        ("N7 #MEAS MODE[V.A.ABS.X]", 900104),
        ("N7 G0 X=1/V.A.ABS.X", 20396),
        ("N7 G0 X=SQRT[V.A.ABS.X-1]", 900105),
        ("N7 G0 X=TAN[V.A.ABS.X+90]", 900105),
        ("N7 G1 X1", 20008),
        ("N7 X1", 20008),
        ("N7 G100 X1", 20008),
        ("N7 G1 X1 F=V.A.ABS.X", 20008),
        ('N7 #MSG ["%d", V.A.ABS.X+0.5]', 900107),
        ("N7 #CS OFF", 900108),
    ],
)
@pytest.mark.provokes(20008, 2)
@pytest.mark.provokes(20138, 2)
@pytest.mark.provokes(20396, 2)
@pytest.mark.provokes(20772, 2)
@pytest.mark.provokes(50061, 4)
@pytest.mark.provokes(900101, 2)
@pytest.mark.provokes(900103, 2)
@pytest.mark.provokes(900104, 2, value=0)
@pytest.mark.provokes(900105, 2)
@pytest.mark.provokes(900107, 2, format="%d")
@pytest.mark.provokes(900108, 2)
def test_alarms_name_file_line_and_block(run, text, alarm_id):
    with pytest.raises(Alarm) as caught:
        run(text)
    assert caught.value.id == alarm_id
    assert caught.value.place == f"test.nc line {len(text.splitlines())}, block N7"


def test_default_measuring_type_is_that_of_the_channel(run):
    assert value_of(run, "V.G.MEAS_TYPE", "#MEAS MODE[5]\n#MEAS MODE") == 1
    with pytest.raises(Alarm) as caught:
        run("G100 X1 F100", default_measuring_type=5)
    assert caught.value.id == 20138


def test_switching_off_all_systems_needs_none(run):
    assert targets(run("#CS OFF ALL\nG0 X1\n#CS ON[1,0]\n#CS ON[1,0]\n#CS OFF ALL\nX2")) == [
        {"X": 1.0},
        {"X": 2.0},
    ]


@pytest.mark.parametrize(
    ("expression", "dividend"),
    [
        ("1/P1", "1"), ("-2.5/P1", "-2.5"), ("P1/P1", "0"), ("7 MOD P1", "7"), ("P1**-1", "1"),
        ("P1**-2", "1"), ("3+4/P1", "4"),
    ],
)  # fmt: skip
def test_20396_names_what_was_to_be_divided(run, expression, dividend):
    """A power below 0 of nothing divides 1 by it."""
    with pytest.raises(Alarm) as caught:
        run(f"P1=0\nX=[{expression}]")
    assert (caught.value.id, caught.value.values) == (20396, {"value": dividend})
