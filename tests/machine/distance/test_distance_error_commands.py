"""Errors of commands to distance control: each in the cycle in which its block begins.

70333, 70334 and 70332 have no newer twin, so they come up in both families; 51062 is newer and has
no older one.
"""

import pytest

from axisrig.kernel.distance import DistanceCommand

ON = "Z[DIST_CTRL ON SET_POS=30]"
ON_CONST = "Z[DIST_CTRL ON CONST_DIST SET_DIST=2]"


def ends_at(watched, block):
    """The alarm came up in the cycle in which its block was at the head, and nothing after it."""
    assert watched.alarm_cycle() == watched.first_of(block)
    assert watched.cycles[-1].block == block
    assert f"N{block}" in str(watched.alarm.place)
    return watched.alarm.id


@pytest.mark.provokes(70335, 7, owner="axis Z")
@pytest.mark.provokes(310024, 7, owner="axis Z")
@pytest.mark.parametrize("alarm_id", [70335, 310024])
def test_on_without_a_surface(run_distance, alarm_id):
    watched = run_distance("N10 G4 0.02\nN20 Z[DIST_CTRL ON]", newer=alarm_id == 310024)
    assert ends_at(watched, 20) == alarm_id
    assert watched.cycles[-1].offset_mm == 0.0


@pytest.mark.provokes(70336, 7, owner="axis Z")
@pytest.mark.provokes(310015, 7, owner="axis Z")
@pytest.mark.parametrize("alarm_id", [70336, 310015])
@pytest.mark.parametrize("words", ["ON SET_POS=30", "SET_POS=30", "OFF", "CHECK_POS"])
def test_any_command_to_an_axis_that_is_not_released(run_distance, alarm_id, words):
    watched = run_distance(
        f"N10 G4 0.02\nN20 Z[DIST_CTRL {words}]",
        "set:Z.lr_param.distance_control_on=0",
        newer=alarm_id == 310015,
    )
    assert ends_at(watched, 20) == alarm_id


@pytest.mark.provokes(70440, 7, owner="axis Z")
@pytest.mark.provokes(310025, 7, owner="axis Z")
@pytest.mark.parametrize("alarm_id", [70440, 310025])
@pytest.mark.parametrize(
    ("first", "second", "current", "programmed"),
    [
        (ON, ON_CONST, "ACTIVE", "ON_CONST_DIST"),
        (ON_CONST, ON, "ACTIVE_CONST_DIST", "ON"),
    ],
)
def test_another_mode_while_on(run_distance, alarm_id, first, second, current, programmed):
    watched = run_distance(
        f"N10 {first}\nN20 G4 0.02\nN30 {second}\nN40 G4 1", newer=alarm_id == 310025
    )
    assert ends_at(watched, 30) == alarm_id
    found = (watched.alarm.values["current"], watched.alarm.values["programmed"])
    assert found == (current, programmed)


@pytest.mark.long
@pytest.mark.provokes(70334, 7)
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("again", [ON, ON_CONST])
def test_on_again_before_the_offset_has_run_out(run_distance, newer, again):
    """1 mm of offset at 100 mm/s and 5000 mm/s2 takes 28 ms: OFF and the next block are earlier."""
    watched = run_distance(
        f"N10 {ON}\nN20 G4 0.5\nN30 Z[DIST_CTRL OFF]\nN40 {again}\nN50 G4 1",
        "plant:gap.workpiece.plane.level_mm=31",
        newer=newer,
    )
    assert ends_at(watched, 40) == 70334


@pytest.mark.long
def test_on_again_behind_a_wait_is_no_error(run_distance):
    watched = run_distance(
        f"N10 {ON}\nN20 G4 0.5\nN30 Z[DIST_CTRL WAIT OFF]\nN40 {ON_CONST}\nN50 G4 0.1\n"
        "N60 Z[DIST_CTRL WAIT OFF]",
        "plant:gap.workpiece.plane.level_mm=31",
    )
    assert watched.channel.alarms == []


@pytest.mark.provokes(70332, 1, axis="Z")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize(
    ("words", "state"), [(ON, "ACTIVE"), (ON_CONST, "ACTIVE_CONST_DIST"), (ON, "FREEZE")]
)
def test_still_on_at_program_end_is_a_warning_and_stays_on(run_distance, newer, words, state):
    hold = "N20 Z[DIST_CTRL FREEZE]\n" if state == "FREEZE" else ""
    watched = run_distance(f"N10 {words}\n{hold}N30 G4 0.1", newer=newer)
    assert [alarm.id for alarm in watched.channel.alarms] == [70332]
    assert watched.cycles[-1].state == state


@pytest.mark.long
def test_turning_off_at_program_end_is_waited_for(run_distance):
    watched = run_distance(
        f"N10 {ON}\nN20 G4 0.5\nN30 Z[DIST_CTRL OFF]", "plant:gap.workpiece.plane.level_mm=31"
    )
    assert watched.channel.alarms == []
    assert (watched.cycles[-1].state, watched.cycles[-1].offset_mm) == ("INACTIVE", 0.0)


@pytest.mark.provokes(70333, 7, axis="Z")
@pytest.mark.parametrize("newer", [False, True])
def test_an_axis_under_control_is_given_away(run_distance, newer):
    watched = run_distance(f"N10 {ON}\nN20 G4 0.02\nN30 #PUT AX[Z]\nN40 G4 1", newer=newer)
    assert [alarm.id for alarm in watched.channel.alarms] == [70333]
    assert "N30" in str(watched.alarm.place)
    assert 40 not in {cycle.block for cycle in watched.cycles}


@pytest.mark.provokes(51062, 7, plane="ACS")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize("block", ["G74 Z1", "#CHANNEL INIT[ACTPOS]"])
def test_positions_are_initialised_under_control(run_distance, newer, block):
    watched = run_distance(f"N10 {ON}\nN20 G4 0.02\nN30 {block}\nN40 G4 1", newer=newer)
    assert [alarm.id for alarm in watched.channel.alarms] == [51062]
    assert 40 not in {cycle.block for cycle in watched.cycles}


# ---- measuring and distance control of one axis

MEASURES = (
    "kenngr.messachse 1",
    "kenngr.measure.signal DRIVE",
    "kenngr.measure.input 1",
    "kenngr.measure.edge POS",
)
PROBE = """
probe_1 = "probe"
[plant.probe]
fmu = "AxisRig.Sensors.TouchProbe"
start = { surface_mm = 20 }
wire = { z = "z" }
"""


@pytest.mark.provokes(900521, 7, axis="Z", owner="axis Z", controlword="ACTIVE")
@pytest.mark.parametrize("newer", [False, True])
def test_a_measurement_begins_while_control_is_on(run_distance, newer):
    watched = run_distance(
        f"N10 {ON}\nN20 G4 0.02\nN30 G100 Z33 F600\nN40 G4 1",
        newer=newer,
        lines=MEASURES,
        rig=PROBE,
    )
    assert ends_at(watched, 30) == 900521


@pytest.mark.provokes(70521, 7, owner="axis Z")
@pytest.mark.provokes(310005, 7, owner="axis Z")
@pytest.mark.parametrize("alarm_id", [70521, 310005])
def test_control_is_switched_on_while_the_axis_measures(run_distance, alarm_id):
    watched = run_distance(
        f"N10 Z[INDP_ASYN G100 G90 POS=34 FEED=600]\nN20 G4 0.02\nN30 {ON}\nN40 G4 1",
        newer=alarm_id == 310005,
        lines=MEASURES,
        rig=PROBE,
    )
    assert ends_at(watched, 30) == alarm_id


# ---- the PLC side


def asks(*transitions):
    """A PLC that gives one command after the other, as soon as the last one was taken.

    Each stands in the unit at the end of a cycle and is taken in the next one.
    """
    waiting = list(transitions)

    def act(channel, cycle):
        unit = channel.plc.axis["Z"].distance
        if cycle < 50 or unit.command_semaphor_rw or not waiting:
            return
        unit.enable_w = True
        command, set_pos_mm = waiting.pop(0)
        unit.command_w.transition, unit.command_w.set_pos_mm = command, set_pos_mm
        unit.command_semaphor_rw = True

    return act


@pytest.mark.provokes(310014, 7, owner="axis Z")
@pytest.mark.parametrize("newer", [False, True])
@pytest.mark.parametrize(
    ("commands", "current", "wanted"),
    [
        ([(DistanceCommand.FREEZE, None)], "INACTIVE", "FREEZE"),
        (
            [(DistanceCommand.ON, 30.0), (DistanceCommand.ON_CONST_DIST, None)],
            "ACTIVE",
            "ON_CONST_DIST",
        ),
    ],
)
def test_a_change_of_state_that_the_plc_must_not_ask_for(
    run_distance, newer, commands, current, wanted
):
    """The last command stands in the unit behind cycle 50, the one before it: taken one later."""
    watched = run_distance("N10 G4 0.5", newer=newer, act=asks(*commands))
    assert watched.alarm.id == 310014
    assert (watched.alarm.values["current"], watched.alarm.values["wanted"]) == (current, wanted)
    assert watched.alarm_cycle() == 49 + len(commands)


# ---- causes without a documented ID


@pytest.mark.provokes(900310, 7)
@pytest.mark.provokes(900311, 7, owner="axis Z")
@pytest.mark.provokes(900313, 7, owner="axis Z")
@pytest.mark.parametrize(
    ("alarm_id", "before", "words"),
    [
        (900310, "G4 0.02", "FREEZE"),
        (900311, "G4 0.02", "ON CONST_DIST"),
        (900313, ON, "REF"),
    ],
)
def test_commands_of_the_program_without_an_id_of_the_manual(run_distance, alarm_id, before, words):
    watched = run_distance(f"N10 {before}\nN20 G4 0.02\nN30 Z[DIST_CTRL {words}]\nN40 G4 1")
    assert ends_at(watched, 30) == alarm_id


@pytest.mark.provokes(900312, 7, owner="axis Z")
def test_an_absolute_sensor_is_not_referenced(run_distance):
    """P-AXIS-00418 is the reference of an absolute one."""
    watched = run_distance(
        "N10 G4 0.02\nN20 Z[DIST_CTRL REF]\nN30 G4 1", lines=["{list}ref_offset 10"]
    )
    assert ends_at(watched, 20) == 900312
