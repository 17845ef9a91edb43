"""Errors of sensor, filter and parameters of distance control."""

import pytest

from axisrig.bench.rig.settings import AS_CANOPEN

ON = "Z[DIST_CTRL ON SET_POS=30]"
VARIABLE = "SENSOR_SOURCE=VARIABLE"


def ends_at(watched, block):
    """The alarm came up in the cycle in which its block began."""
    assert watched.alarm_cycle() == watched.first_of(block)
    assert watched.cycles[-1].block == block
    return watched.alarm.id


@pytest.mark.provokes(310027, 7, owner="axis Z")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize(
    ("words", "source"),
    [
        (VARIABLE, "VARIABLE without SENSOR_VAR"),
        (f"{VARIABLE} SENSOR_VAR=V.P.GAP", "VARIABLE V.P.GAP"),
    ],
)
def test_no_valid_sensor_variable(run_distance, newer, words, source):
    watched = run_distance(
        f"V.P.GAP = 1\nN10 G4 0.02\nN20 Z[DIST_CTRL {words} ON SET_POS=30]\nN30 G4 1", newer=newer
    )
    assert ends_at(watched, 20) == 310027
    assert watched.alarm.values["source"] == source


@pytest.mark.provokes(310028, 7, owner="axis Z")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("state", ["ON", "FREEZE"])
def test_another_sensor_while_on(run_distance, newer, state):
    hold = "N15 Z[DIST_CTRL FREEZE]\n" if state == "FREEZE" else ""
    watched = run_distance(
        f"N10 {ON}\n{hold}N20 G4 0.02\nN30 Z[DIST_CTRL {VARIABLE} SENSOR_VAR=V.E.GAP]\nN40 G4 1",
        "plc:V.E.GAP=-20000",
        newer=newer,
    )
    assert ends_at(watched, 30) == 310028
    assert "SECOND_ENCODER" in watched.alarm.values["current"]
    assert "VARIABLE" in watched.alarm.values["programmed"]


def test_another_sensor_before_on_is_no_error(run_distance):
    watched = run_distance(
        f"N10 Z[DIST_CTRL {VARIABLE} SENSOR_VAR=V.E.GAP]\nN20 {ON}\nN30 G4 0.1\n"
        "N40 Z[DIST_CTRL WAIT OFF]",
        "plc:V.E.GAP=-20000",
    )
    # Nobody would notice that the plan writes it no more
    assert [alarm.id for alarm in watched.channel.alarms] == [900315]


@pytest.mark.provokes(310029, 7, owner="axis Z", source="SECOND_ENCODER")
@pytest.mark.parametrize("words", ["ON SET_POS=30", "SENSOR_SOURCE=SECOND_ENCODER"])
def test_a_drive_without_a_second_encoder(run_distance, words):
    watched = run_distance(
        f"N10 G4 0.02\nN20 Z[DIST_CTRL {words}]\nN30 G4 1",
        "set:Z.lr_param.distance_control_on=1",
        base="probe-z.toml",
    )
    assert ends_at(watched, 20) == 310029


# ---- filters


@pytest.mark.provokes(310001, 7, owner="axis Z", order=4, f0_hz=500.0)
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("when", ["before", "while on"])
def test_a_low_pass_that_cannot_be_built(run_distance, newer, when):
    """f0 has to be below half the cycle rate: 500 Hz at 1 ms."""
    words = "Z[DIST_CTRL FILTER_TYPE=LOWPASS FG_F0=500]"
    blocks = (words, ON) if when == "before" else (ON, words)
    watched = run_distance(f"N10 {blocks[0]}\nN20 G4 0.02\nN30 {blocks[1]}\nN40 G4 1", newer=newer)
    assert ends_at(watched, 30) == 310001
    assert watched.alarm.values["cycle_us"] in (1000, 1000.0)


@pytest.mark.provokes(310003, 7, owner="axis Z", filter="EXPO_MEAN")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("words", ["SMOOTH_FACT=0", "SMOOTH_FACT=1.5", "N_CYCLES=100"])
def test_a_filter_that_cannot_be_built(run_distance, newer, words):
    watched = run_distance(
        f"N10 Z[DIST_CTRL FILTER_TYPE=EXPO_MEAN {words}]\nN20 G4 0.02\nN30 {ON}\nN40 G4 1",
        newer=newer,
    )
    assert ends_at(watched, 30) == 310003


# ---- values in the program


@pytest.mark.provokes(22096, 2, value_s=60.0, low_s=0.0, high_s=50.0)
@pytest.mark.provokes(22142, 2, value="7", low=0, high=6)
@pytest.mark.provokes(22349, 2, value="2")
@pytest.mark.provokes(900300, 2, keyword="KP", value="3", owner="axis Z")
@pytest.mark.parametrize(
    ("alarm_id", "words"),
    [(22096, "I_TN=60"), (22142, "ORDER=7"), (22349, "BOTH_ENCODER=2"), (900300, "KP=P1")],
)
def test_a_value_out_of_its_range_ends_the_program_at_its_block(run_distance, alarm_id, words):
    """Class 2: the control itself goes on, with the offset that it has."""
    watched = run_distance(
        f"P1=3\nN10 {ON}\nN20 G4 0.1\nN30 Z[DIST_CTRL {words}]\nN40 G4 1",
        "plant:gap.workpiece.plane.level_mm=30.5",
    )
    assert watched.alarm.id == alarm_id
    assert "N30" in str(watched.alarm.place)
    assert 40 not in {cycle.block for cycle in watched.cycles}


# ---- parameter lists: warnings at the start, the value corrected, the run goes on


@pytest.mark.provokes(110604, 1, owner="axis Z", value_um_s=0, corrected_um_s=1)
@pytest.mark.provokes(315000, 1, owner="axis Z", value_um_s=0, corrected_um_s=1)
@pytest.mark.provokes(315001, 1, owner="axis Z")
@pytest.mark.provokes(315002, 1, owner="axis Z", value=100, high=99, corrected=99)
@pytest.mark.provokes(315003, 1, owner="axis Z")
@pytest.mark.provokes(315004, 1, owner="axis Z", value=7, corrected=6)
@pytest.mark.provokes(315005, 1, owner="axis Z", value=2000, corrected=1999)
@pytest.mark.provokes(315008, 1, owner="axis Z", value=1.5, corrected=1.0)
@pytest.mark.provokes(315010, 1, owner="axis Z", value=2.5, corrected=2.0)
@pytest.mark.provokes(315011, 1, owner="axis Z", value_s=51.0, corrected_s=50.0)
@pytest.mark.provokes(315012, 1, owner="axis Z", value_s=2.5, corrected_s=2.0)
@pytest.mark.parametrize(
    ("alarm_id", "newer", "line"),
    [
        (110604, False, "{list}v_max 0"),
        (315000, True, "{list}v_max 0"),
        (315001, True, "{list}a_max -2"),
        (315002, True, "{list}n_cycles 100"),
        (315003, True, "{list}low_pass_filter_fg_f0 -1"),
        (315004, True, "{list}low_pass_filter_order 7"),
        (315005, True, "{list}v_weight_down 2000"),
        (315008, True, "{list}smoothing_factor 1.5"),
        (315010, True, "{list}kp 2.5"),
        (315011, True, "{list}i_tn 51"),
        (315012, True, "{list}d_tv 2.5"),
    ],
)
def test_a_list_with_a_value_out_of_its_range(run_distance, alarm_id, newer, line):
    watched = run_distance("N10 G4 0.01", newer=newer, lines=[line])
    assert [alarm.id for alarm in watched.channel.alarms] == [alarm_id]
    assert watched.alarm_cycle() == 0
    assert watched.first_of(10) > 0


@pytest.mark.provokes(110547, 1, axis="Z")
@pytest.mark.provokes(70336, 7, owner="axis Z")
def test_a_drive_type_without_distance_control_loses_its_release(run_distance):
    watched = run_distance(f"N10 {ON}", AS_CANOPEN, lines=["kenngr.antr_typ 4"])
    assert [alarm.id for alarm in watched.channel.alarms] == [110547, 70336]
