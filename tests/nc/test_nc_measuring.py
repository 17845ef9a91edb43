"""Measuring types 2 to 6 as a program says them: what the channel is told, what is refused."""

from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import MeasuringRun, Message
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")


def _runs(commands: list[Any]) -> list[MeasuringRun]:
    return [command for command in commands if isinstance(command, MeasuringRun)]


def _texts(commands: list[Any]) -> list[str]:
    return [command.text for command in commands if isinstance(command, Message)]


def _alarm(run: Any, text: str, **options: Any) -> Alarm:
    with pytest.raises(Alarm) as caught:
        run(text, **options)
    return caught.value


def test_type_2_needs_no_feed_and_hands_none_on(run) -> None:
    (found,) = _runs(run("#MEAS MODE[2]\nG100 X5"))
    assert (found.measuring_type, found.feed_mm_min) == (2, None)
    (found,) = _runs(run("#MEAS MODE[2]\nG100 X5 F77"))
    assert found.feed_mm_min is None


def test_an_f_in_a_block_of_type_2_holds_for_what_follows(run) -> None:
    *_, move = [c for c in run("#MEAS MODE[2]\nG100 X5 F77\nG1 X6") if hasattr(c, "rapid")]
    assert move.feed_mm_min == 77


def test_g106_lets_a_run_of_type_3_go_on(run, plane_machine) -> None:
    program = '#MEAS MODE[3]\nG100 X9 F100{}\n#MSG["%g %g", V.A.MESS.X, V.A.ABS.X]'
    for word, stands in ((" G106", 9), ("", 4)):
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
        commands = run(program.format(word), machine)
        assert _runs(commands)[0].goes_on is bool(word)
        assert _texts(commands) == [f"4 {stands}"]


def test_g91_goes_on_from_the_target_after_g106(run, plane_machine) -> None:
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    run("#MEAS MODE[3]\nG100 X9 F100 G106\nG91 G1 X1", machine)
    assert machine.acs_mm["X"] == 10


def test_a_second_run_without_a_signal_leaves_nothing_of_the_first(run, plane_machine) -> None:
    program = 'G100 X9 F100\nG1 X0\nG100 X3 F100\n#MSG["%d", V.A.MERF.X]\n'
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    assert _texts(run(program, machine)) == ["0"]
    for asks in ('#MSG["%g", V.A.MESS.X]', '#MSG["%g", V.A.MOFFS.X]', "G101 X1"):
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
        assert _alarm(run, program + asks, machine=machine).id == 900101


@pytest.mark.parametrize("type_", [1, 2, 4])
@pytest.mark.provokes(20772, 2, g_function="G106")
def test_20772_g106_with_another_type(run, type_: int) -> None:
    alarm = _alarm(run, f"#MEAS MODE[{type_}]\nN7 G100 X9 F100 G106")
    assert (alarm.id, alarm.values) == (20772, {"g_function": "G106", "type": type_})


@pytest.mark.provokes(900228, 2)
def test_900228_g106_without_g100(run) -> None:
    alarm = _alarm(run, "#MEAS MODE[3]\nN7 G1 X9 F100 G106")
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (900228, 2, {})


@pytest.mark.provokes(50061, 4, programmed=4, maximum=3, type=4)
@pytest.mark.provokes(900220, 2, type=4, axis="B")
def test_type_4_measures_with_main_axes(run) -> None:
    axes = ("X", "Y", "Z", "A", "B")
    (found,) = _runs(run("#MEAS MODE[4]\nG100 X1 Y2 Z3 F100", axes=axes))
    assert found.programmed_axes == ("X", "Y", "Z")
    alarm = _alarm(run, "#MEAS MODE[4]\nN7 G100 X1 Y2 Z3 A4 F100", axes=axes)
    assert alarm.id == 50061
    assert alarm.values == {"programmed": 4, "maximum": 3, "type": 4}
    assert "The block names 4 axes and measuring type 4 allows at most 3" in str(alarm)
    alarm = _alarm(run, "#MEAS MODE[4]\nN7 G100 X1 B4 F100", axes=axes)
    assert (alarm.id, alarm.values) == (900220, {"type": 4, "axis": "B"})
    assert alarm.entry.reaction_class == 2


# Type 7


@pytest.mark.parametrize("choice", ["#MEAS MODE[7]", "#MEAS [TYPE=7]"])
def test_type_7_measures_as_type_1_does(run, choice: str) -> None:
    (found,) = _runs(run(f"{choice}\nG100 X5 Y6 F100"))
    assert (found.measuring_type, found.feed_mm_min, found.goes_on) == (7, 100, False)
    assert found.measuring_axes == found.programmed_axes == ("X", "Y")
    (found,) = _runs(run(f"{choice}\n#CS ON[0,0,0,0,0,90]\nG100 X5 F100\n#CS OFF"))
    # Turned by 90 degrees X is Y: all main axes deliver a value, one is moved to the stop
    assert found.measuring_axes == XYZ
    assert {axis for axis, mm in found.target_mm.items() if abs(mm) > 1e-9} == {"Y"}


def test_the_results_of_type_7_are_those_of_type_1(run, plane_machine) -> None:
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    text = '#MEAS MODE[7]\nG100 X9 F100\n#MSG["%g %g %d", V.A.MESS.X, V.A.MOFFS.X, V.A.MERF.X]'
    assert _texts(run(text, machine)) == ["4 -5 1"]
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    text = '#MEAS MODE[7]\nG100 X9 F100\n#MSG["%d", V.A.MERF.X]'
    assert _texts(run(text, machine)) == ["0"]


def test_the_check_of_a_program_has_nothing_to_say_about_type_7() -> None:
    text = "#MEAS MODE[7]\n#MEAS [TYPE=7]\n#MEAS [AX=X SIGNAL=FIXED_STOP]\nG100 X9 F100\n"
    program = parse_program(text, file="test.nc", axes=XYZ)
    assert [note for block in program.blocks for note in block.not_acting] == []


# Types 5 and 6


@pytest.mark.parametrize("word", ["G310", "G210"])
def test_g310_measures_with_feed_or_in_rapid_traverse(run, word: str) -> None:
    for motion, feed in (("G1 F100", 100), ("G0", None), ("F50", 50)):
        (found,) = _runs(run(f"#MEAS MODE[5]\n{word} {motion} X5"))
        assert (found.measuring_type, found.feed_mm_min, found.goes_on) == (5, feed, False)


@pytest.mark.parametrize("type_", [1, 2, 3, 4, 7])
@pytest.mark.provokes(20956, 2)
def test_20956_g310_with_a_type_of_g100(run, type_: int) -> None:
    alarm = _alarm(run, f"#MEAS MODE[V.A.ABS.X+{type_}]\nN7 G310 X5 F100")
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (20956, 2, {"type": type_})


@pytest.mark.provokes(900221, 2, type=6, axes="X Y")
def test_900221_type_6_needs_a_sercos_axis(run) -> None:
    alarm = _alarm(run, "#MEAS MODE[6]\nN7 G310 X5 Y6 F100")
    assert (alarm.id, alarm.entry.reaction_class) == (900221, 2)
    assert alarm.values == {"type": 6, "axes": "X Y"}


def test_the_target_becomes_the_actual_position_of_every_measuring_axis(run, plane_machine) -> None:
    """Also of axes that the block does not name; not of those that do not measure."""
    machine = plane_machine({"X": 0.0, "Y": 1.0, "Z": 2.0}, ("X", 4.0))
    machine.lag_mm, machine.not_released = 0.5, ("Z",)
    text = (
        "#MEAS MODE[5]\nG310 X9 F100\n"
        '#MSG["%g %g %g", V.A.PROG.X, V.A.PROG.Y, V.A.PROG.Z]\n'
        '#MSG["%g %g", V.A.ABS.X, V.A.MESS.X]\n#MSG["%g", V.A.MOFFS.X]'
    )
    assert _texts(run(text, machine)) == ["4.5 1.5 2", "4.5 4", "-5"]


def test_without_signal_the_target_stays_what_was_programmed(run, plane_machine) -> None:
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    machine.lag_mm = 0.5
    text = '#MEAS MODE[5]\nG310 X9 F100\n#MSG["%g %g %d", V.A.PROG.X, V.A.ABS.X, V.A.MERF.X]'
    assert _texts(run(text, machine)) == ["9 9 0"]


def test_moves_go_on_from_there(run, plane_machine) -> None:
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    run("#MEAS MODE[5]\nG310 X9 F100\nG91 G1 X1", machine)
    assert machine.acs_mm["X"] == 5


# What other axes keep


def test_merf_and_values_of_axes_that_are_not_named_stay(run, plane_machine) -> None:
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
    text = (
        "#MEAS MODE[{}]\nG100 X9 F100\n#MEAS MODE[{}]\nG100 Y3 F100\n"
        '#MSG["%d %d %g", V.A.MERF.X, V.A.MERF.Y, V.A.MESS.X]'
    )
    for first in (1, 2, 3, 4):
        for second in (1, 2, 3, 4):
            machine.acs_mm = dict.fromkeys(XYZ, 0.0)
            assert _texts(run(text.format(first, second), machine)) == ["1 0 4"]


def test_under_cs_all_three_main_axes_must_signal_in_every_type(run, plane_machine) -> None:
    for type_, word in ((1, "G100"), (2, "G100"), (3, "G100"), (4, "G100"), (5, "G310")):
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 4.0))
        text = f"#MEAS MODE[{type_}]\n#CS ON[0,0,0,0,0,0]\n{word} X9 F100"
        (found,) = _runs(run(text, machine))
        assert found.measuring_axes == XYZ


# Programs of the manuals


def test_fct_c4_waits_for_the_axes_that_move(run) -> None:
    """%Measurement_run_standard, FCT-C4 section 4."""
    text = (
        "%Measurement_run_standard\nN10 G00 X0 Y1 Z0\nN20 X5\nN30 G100 X10 F500\nN40 G01 Y3\n"
        "N50 G100 Y10 F500\nN60 G01 X10 Y5\nN70 G100 X15 Y10 F500\nN100 M30\n"
    )
    assert [found.measuring_axes for found in _runs(run(text))] == [("X",), ("Y",), ("X", "Y")]


def test_fct_c4_waits_for_all_three_under_cs(run) -> None:
    """%Measurement_run_CS, FCT-C4 section 4; its `\\#CS` is damaged."""
    text = (
        "%Measurement_run_CS\nN10 G00 X0 Y1 Z0\nN20 #CS ON[0,0,0,0,45]\nN30 G100 X10 F500\n"
        "N40 #CS OFF\nN50 #CS ON[0,0,0,0,0,90]\nN60 G100 X10 F500\nN70 #CS OFF\nN100 M30\n"
    )
    assert [found.measuring_axes for found in _runs(run(text))] == [XYZ, XYZ]


@pytest.mark.parametrize(("plane_mm", "end_mm"), [(40.0, (0.0, 0.0)), (500.0, (200.0, 200.0))])
def test_the_manual_jumps_only_after_a_signal(
    run, plane_machine, plane_mm: float, end_mm: tuple[float, float]
) -> None:
    """Programming manual 206197003; default type 5 of the channel."""
    text = (
        "N10 G00 X0 Y0\nN20 G310 G01 F100 X100 Y200 $GOTO[N_LABEL]\nN30 G01 X200\n"
        "N40 $GOTO[ENDE]\nN50 [N_LABEL] X0 Y0\nN60 [ENDE] M30\n"
    )
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", plane_mm))
    run(text, machine, default_measuring_type=5)
    assert (machine.acs_mm["X"], machine.acs_mm["Y"]) == end_mm


def test_a_search_that_measures_in_a_loop_until_it_meets_something(run, plane_machine) -> None:
    """Steps of 10 from 0; the plane lies at 34, so the fourth step meets it."""
    text = (
        "#MEAS MODE[5]\nV.P.STEPS = 0\n$WHILE V.P.STEPS < 9\nV.P.STEPS = V.P.STEPS + 1\n"
        'G91 G310 G1 F100 X10 $GOTO[MET]\n$ENDWHILE\n#MSG["nothing"]\nM30\n'
        '[MET] #MSG["%d %g", V.P.STEPS, V.A.MESS.X]\n'
    )
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 34.0))
    assert _texts(run(text, machine)) == ["4 34"]
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    assert _texts(run(text, machine)) == ["nothing"]


# Which axis, which word, which unit


@pytest.mark.parametrize("sercos", ["X", "Y", "XY"])
def test_one_sercos_axis_is_enough_for_type_6(run, plane_machine, sercos: str) -> None:
    """FCT-C4 section 3: as type 5 with at least one SERCOS axis, at whatever place it is."""
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    machine.is_sercos = lambda axis: axis in sercos
    (found,) = _runs(run("#MEAS MODE[6]\nG310 X5 Y6 F100", machine))
    assert (found.measuring_type, found.measuring_axes) == (6, ("X", "Y"))
    assert _alarm(run, "#MEAS MODE[6]\nG310 Z5 F100", machine=machine).id == 900221


@pytest.mark.parametrize(
    ("type_", "block", "word"),
    [
        (1, "G100 X5", "G100"), (3, "G100 X5 G106", "G100"), (4, "G100 X5", "G100"),
        (7, "G100 X5", "G100"), (5, "G310 X5", "G310"), (5, "G210 X5", "G310"), (1, "X5", "G1"),
    ],
)  # fmt: skip
def test_20008_names_the_word_that_needs_the_feed(run, type_: int, block: str, word: str) -> None:
    alarm = _alarm(run, f"#MEAS MODE[{type_}]\n{block}")
    assert (alarm.id, alarm.values) == (20008, {"word": word})


@pytest.mark.parametrize(("block", "axis"), [("X1 A4 B5", "A"), ("B5 X1 A4", "B"), ("A4", "A")])
def test_900220_names_the_first_axis_of_the_block_that_is_none(run, block: str, axis: str) -> None:
    alarm = _alarm(run, f"#MEAS MODE[4]\nG100 {block} F100", axes=("X", "Y", "Z", "A", "B"))
    assert (alarm.id, alarm.values["axis"]) == (900220, axis)


@pytest.mark.parametrize("default", [1, 2, 4, 7])
@pytest.mark.parametrize("back", ["#MEAS MODE", "#MEAS MODE[]", "#MEAS DEFAULT"])
def test_without_a_type_that_of_the_channel_counts_again(run, default: int, back: str) -> None:
    text = f'#MEAS MODE[3]\n#MSG["%d", V.G.MEAS_TYPE]\n{back}\n#MSG["%d", V.G.MEAS_TYPE]'
    assert _texts(run(text, default_measuring_type=default)) == ["3", str(default)]


OFFSETS = '#MSG["%g %g %g", V.A.MEIN.X, V.A.MEIN.Y, V.A.MEIN.B]\n'


@pytest.mark.parametrize(
    ("drops", "left"),
    [("G102", "0 0 0"), ("G102 X1", "0 -5 -5"), ("G102 Y1 B1", "-5 0 0"), ("G102 B1", "-5 -5 0")],
)
def test_g102_drops_the_offsets_of_its_axes_or_of_all(
    run, plane_machine, drops: str, left: str
) -> None:
    """Programmed to 9, 4 and 3 and met half-way: 5 short in X, and so on for each."""
    axes = ("X", "Y", "Z", "A", "B")
    machine = plane_machine(dict.fromkeys(axes, 0.0), ("X", 5.0))
    text = f"G100 X10 Y10 B10 F100\nG101 X1 Y1 B1\n{OFFSETS}{drops}\n{OFFSETS}"
    assert _texts(run(text, machine, axes=axes)) == ["-5 -5 -5", left]


@pytest.mark.parametrize(("unit", "shown"), [("G70", "-0.5"), ("G71", "-12.7")])
def test_the_measurement_offset_has_the_unit_of_the_program(
    run, plane_machine, unit: str, shown: str
) -> None:
    """Programmed to 25.4 mm and met at 12.7: half an inch."""
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 12.7))
    text = f'G100 X25.4 F100\nG101 X1\n{unit}\n#MSG["%g", V.A.MEIN.X]\n#MSG["%g", V.A.MOFFS.X]'
    assert _texts(run(text, machine)) == [shown, shown]
