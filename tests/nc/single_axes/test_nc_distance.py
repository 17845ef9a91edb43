"""DIST_CTRL: from a word of the program to a plain command, and what is refused before."""

import re
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.text.check import check_program

Run = Callable[..., Any]


def commands(run: Run, *blocks: str, **more: Any) -> list[canon.DistanceCommand]:
    lines = "\n".join(blocks)
    return [c for c in run(f"%t\n{lines}\nM30\n", **more) if isinstance(c, canon.DistanceCommand)]


def one(run: Run, *blocks: str, **more: Any) -> canon.DistanceCommand:
    (found,) = commands(run, *blocks, **more)
    return found


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("ON", {"action": "on"}),
        ("ON SET_POS=30", {"action": "on", "set_pos_mm": 30.0}),
        ("SET_POS=30", {"set_pos_mm": 30.0}),
        ("ON CONST_DIST", {"action": "on_const"}),
        ("ON CONST_DIST SET_DIST=1", {"action": "on_const", "set_dist_mm": 1.0}),
        ("DRYRUN", {"action": "on", "dry_run": True}),
        ("DRYRUN CONST_DIST SET_DIST=2", {"action": "on_const", "dry_run": True, "set_dist_mm": 2}),
        ("OFF", {"action": "off"}),
        ("", {"action": "off"}),
        ("OFF NO_MOVE", {"action": "off", "no_move": True}),
        ("WAIT OFF", {"action": "off", "wait": True}),
        ("WAIT ON SET_POS 12.5", {"action": "on", "wait": True, "set_pos_mm": 12.5}),
        ("FREEZE", {"action": "freeze"}),
        ("CHECK_POS", {"action": "check"}),
        ("REF", {"action": "ref"}),
        ("REF SET_POS=3", {"action": "ref", "set_pos_mm": 3.0}),
        ("VAL1=1 VAL5=-5", {"values": (1.0, None, None, None, -5.0)}),
        ("SENSOR_SOURCE=SECOND_ENCODER", {"sensor_source": "SECOND_ENCODER"}),
    ],
)
def test_each_keyword_of_the_manual_has_its_place(
    run: Run, words: str, expected: dict[str, Any]
) -> None:
    found = one(run, f"N10 Z[DIST_CTRL {words}]")
    assert found == canon.DistanceCommand(found.block, "Z", **expected)
    assert found.block.number == 10


def test_parameters_have_their_names_in_the_control(run: Run) -> None:
    found = one(
        run,
        "P1 = 0.5",
        "Z[DIST_CTRL KP=0.3 I_TN=P1 D_TV=0.01 FILTER_TYPE=kalman_expo N_CYCLES=30 FG_F0=80 \\",
        "ORDER=3 SMOOTH_FACT=0.25 KALMAN_SIGMA=1000 BOTH_ENCODER=1]",
    )
    assert found.parameters == {
        "kp": 0.3,
        "tn_s": 0.5,
        "tv_s": 0.01,
        "filter_type": "KALMAN_EXPO",
        "n_cycles": 30,
        "low_pass_filter_fg_f0": 80.0,
        "low_pass_filter_order": 3,
        "smoothing_factor": 0.25,
        "kalman_sigma": 1000.0,
        "both_encoders": True,
    }


def test_the_diagnosis_manual_spells_two_keywords_longer(run: Run) -> None:
    found = one(run, "Z[DIST_CTRL DISTC_N_CYCLES=30 DISTC_ORDER=2]")
    assert found.parameters == {"n_cycles": 30, "low_pass_filter_order": 2}


def test_inches_count_for_position_and_distance(run: Run) -> None:
    found = one(run, "G70", "Z[DIST_CTRL ON SET_POS=1 SET_DIST=0.5]")
    assert (found.set_pos_mm, found.set_dist_mm) == (25.4, 12.7)


def test_the_surface_is_where_the_axis_counts_whatever_is_shifted(run: Run) -> None:
    found = one(run, "G92 Z7", "G91", "Z[DIST_CTRL SET_POS=30]")
    assert found.set_pos_mm == 30.0


def test_words_of_a_block_act_in_their_order_before_its_motion(run: Run) -> None:
    block = "N10 G0 Z5 X1 Z[DIST_CTRL SET_POS=3] X[DIST_CTRL FREEZE] Z[DIST_CTRL ON]"
    found = run(f"%t\n{block}\nM30\n")
    answer = [
        (c.axis, c.action) if isinstance(c, canon.DistanceCommand) else type(c).__name__
        for c in found
    ]
    assert answer == [("Z", None), ("X", "freeze"), ("Z", "on"), "LinearMove", "EndOfProgram"]


def test_behind_off_no_move_the_program_counts_from_where_the_axis_stands(
    run: Run, plane_machine: Any
) -> None:
    """The control has led the axis 2 mm away from its programmed 10; 1 mm on from there is 13."""

    class Led(plane_machine):
        def execute(self) -> None:
            is_off = any(isinstance(c, canon.DistanceCommand) and c.no_move for c in self.queue)
            super().execute()
            self.acs_mm["Z"] += 2.0 if is_off else 0.0

    machine = Led(dict.fromkeys(("X", "Y", "Z"), 0.0), None)
    found = run(
        "%t\nG0 Z10\nZ[DIST_CTRL OFF NO_MOVE]\nG91 G0 Z1\nG90 G0 Z100\nM30\n", machine=machine
    )
    moves = [c.target_mm["Z"] for c in found if isinstance(c, canon.LinearMove)]
    assert moves == [10.0, 13.0, 100.0]


# ---- the variable of the sensor


def test_a_variable_is_named_and_not_read(run: Run) -> None:
    found = run(
        "%t\nZ[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\nM30\n",
        external={"Sensor": 5.0},
    )
    assert [type(c).__name__ for c in found] == ["DistanceCommand", "EndOfProgram"]
    assert (found[0].sensor_source, found[0].sensor_variable) == ("VARIABLE", "Sensor")


def test_an_element_of_a_field_may_be_the_sensor(run: Run) -> None:
    found = one(
        run, "P1=2", "Z[DIST_CTRL SENSOR_VAR=V.E.GAP[P1]]", external={"GAP[1]": 0.0, "GAP[2]": 0.0}
    )
    assert found.sensor_variable == "GAP[2]"


@pytest.mark.parametrize("variable", ["V.P.GAP", "V.E.GAP[7]"])
def test_a_variable_that_the_plc_does_not_have_stays_as_written(run: Run, variable: str) -> None:
    """Switching on with it ends with 310027."""
    found = one(run, "V.P.GAP = 1", f"Z[DIST_CTRL SENSOR_VAR={variable}]", external={"GAP[1]": 0.0})
    assert found.sensor_variable == variable


# ---- what cannot be


@pytest.mark.parametrize(
    ("words", "message", "column"),
    [
        ("ON OFF", "ON and OFF of Z[DIST_CTRL exclude each other", 16),
        ("FREEZE CHECK_POS", "FREEZE and CHECK_POS of", 20),
        ("OFF REF", "OFF and REF of", 17),
        ("ON DRYRUN", "ON and DRYRUN of", 16),
        ("CONST_DIST SET_DIST=1", "CONST_DIST of Z[DIST_CTRL needs ON or DRYRUN", 13),
        ("FREEZE NO_MOVE", "NO_MOVE of Z[DIST_CTRL needs OFF", 20),
        ("WAIT REF", "WAIT of Z[DIST_CTRL needs", 13),
        ("N_CYCLES=3 DISTC_N_CYCLES=4", "are the same", 39),
        ("KP=2.5", "KP out of range", 16),
        ("FILTER_TYPE=MEDIAN", "FILTER_TYPE takes a name", 25),
        ("SENSOR_VAR=5", "SENSOR_VAR takes a variable", 24),
        ("SENSOR_SOURCE=THIRD", "SENSOR_SOURCE takes a name", 27),
        ("SURFACE", "unknown keyword of Z[DIST_CTRL", 13),
    ],
)
def test_what_the_text_alone_shows_is_refused_before_anything_moves(
    run: Run, words: str, message: str, column: int
) -> None:
    with pytest.raises(UserError, match=re.escape(message)) as caught:
        run(f"%t\nZ[DIST_CTRL {words}]\nM30\n")
    assert (caught.value.line, caught.value.column) == (2, column)


@pytest.mark.parametrize("words", ["ON DIST_CTRL", "SET_POS=3", "SET_DIST 3 DIST_CTRL", "ON"])
def test_dist_ctrl_is_the_first_word(run: Run, words: str) -> None:
    with pytest.raises(UserError, match="DIST_CTRL is written before its keywords") as caught:
        run(f"%t\nZ[{words}]\nM30\n")
    assert (caught.value.line, caught.value.column) == (2, 3)


@pytest.mark.provokes(22096, 2, value_s=60.0, low_s=0.0, high_s=50.0)
@pytest.mark.parametrize("value", ["60", "P1*2"])
def test_22096_for_an_integral_action_time_out_of_range(run: Run, value: str) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"%t\nP1=30\nN20 Z[DIST_CTRL I_TN={value}]\nM30\n")
    assert (caught.value.id, caught.value.place) == (22096, "test.nc line 3, block N20")


@pytest.mark.provokes(22142, 2, value="7", low=0, high=6)
def test_22142_for_an_order_out_of_range(run: Run) -> None:
    with pytest.raises(Alarm, match="22142"):
        run("%t\nZ[DIST_CTRL ORDER=7]\nM30\n")


@pytest.mark.parametrize(("written", "value"), [("2", "2"), ("MOTOR", "MOTOR"), ('"1"', '"1"')])
@pytest.mark.provokes(22349, 2)
def test_22349_for_another_value_of_both_encoder(run: Run, written: str, value: str) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"%t\nZ[DIST_CTRL BOTH_ENCODER={written}]\nM30\n")
    assert (caught.value.id, caught.value.values) == (22349, {"value": value})


@pytest.mark.provokes(900300, 2)
@pytest.mark.parametrize(
    ("words", "keyword", "value", "allowed"),
    [
        ("KP=P1-3", "KP", "0", "above 0.0, up to 2.0"),
        ("KP=P1", "KP", "3", "above 0.0, up to 2.0"),
        ("D_TV=P1", "D_TV", "3", "0.0 .. 2.0 s"),
        ("N_CYCLES=P1/2", "N_CYCLES", "1.5", "whole numbers"),
    ],
)
def test_900300_for_values_without_an_id_of_their_own(
    run: Run, words: str, keyword: str, value: str, allowed: str
) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"%t\nP1=3\nZ[DIST_CTRL {words}]\nM30\n")
    assert caught.value.id == 900300
    assert caught.value.values == {
        "keyword": keyword,
        "value": value,
        "owner": "axis Z",
        "allowed": allowed,
    }


@pytest.mark.parametrize("word", ["MIN_MEAS_DIST=1", "MAX_MEAS_DIST=2", "AX1=X", "AX2=Y"])
@pytest.mark.provokes(900100, 2)
def test_the_measuring_function_does_not_act_yet_and_says_so(run: Run, word: str) -> None:
    text = f"%t\nZ[DIST_CTRL {word}]\nM30\n"
    notes = check_program(text, None, ("X", "Y", "Z")).notes
    assert any("measuring function of distance control" in note.text for note in notes)
    with pytest.raises(Alarm, match="measuring function of distance control"):
        run(text)
