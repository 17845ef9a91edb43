"""Errors of what distance control watches: ID, class, values, and no cycle lost.

A sensor value is judged in the cycle that has received it. What is due when is computed here from
the telegrams alone: limits as written, values as received.
"""

import pytest

PERIOD_S = 1e-3
AT_ONCE = 1e-9
SURFACE_ON = "N10 Z[DIST_CTRL ON SET_POS=30]\n"
DISTANCE_ON = "N10 Z[DIST_CTRL ON CONST_DIST SET_DIST=2]\n"
FOLLOWING = ("ACTIVE", "ACTIVE_CONST_DIST")


def judged(watched):
    """The cycles in which a value is watched, with the one before: the control was on by then."""
    cycles = watched.cycles
    return [
        (i, cycles[i - 1], cycles[i])
        for i in range(2, len(cycles))
        if cycles[i - 1].state in FOLLOWING and cycles[i - 1].sensor_mm is not None
    ]


def stands_with_its_offset(watched):
    """Behind the alarm: the offset as it was, the axis brought to rest, the program ended."""
    behind = watched.cycles[watched.alarm_cycle() :]
    assert len({cycle.offset_mm for cycle in behind}) == 1
    assert behind[-1].actual_mm == behind[-2].actual_mm
    assert behind[-1].state not in FOLLOWING


@pytest.mark.provokes(70329, 7, owner="axis Z", limit_um_s=5000.0)
@pytest.mark.provokes(310018, 7, owner="axis Z", limit_um_s=5000.0)
@pytest.mark.parametrize("alarm_id", [70329, 310018])
def test_a_sensor_value_that_changes_too_fast(run_distance, alarm_id):
    """The limit of the default list, 5 mm/s, on the way from 32 to 36 mm with 800 mm/s2."""
    watched = run_distance(
        SURFACE_ON + "N20 G1 Z36 F6000",
        lines=["{list}max_act_value_change 5000"],
        newer=alarm_id == 310018,
    )
    due, change_um_s = next(
        (i, abs(now.sensor_mm - before.sensor_mm) / PERIOD_S * 1000)
        for i, before, now in judged(watched)
        if abs(now.sensor_mm - before.sensor_mm) > 5.0 * PERIOD_S + AT_ONCE
    )
    assert (watched.alarm.id, watched.alarm_cycle()) == (alarm_id, due)
    assert watched.alarm.values["change_um_s"] == pytest.approx(change_um_s, abs=0.1)
    stands_with_its_offset(watched)


@pytest.mark.long
def test_the_same_motion_with_a_limit_above_it(run_distance):
    """10 m/min are 0.167 mm in 1 ms: the limit of P-AXIS-00417 is one of um/s."""
    motion = SURFACE_ON + "N20 G1 Z36 F10000\nN30 G4 0.3\nN40 Z[DIST_CTRL WAIT OFF]"
    watched = run_distance(motion, lines=["{list}max_act_value_change 166667"])
    assert watched.channel.alarms == []


@pytest.mark.long
@pytest.mark.provokes(70330, 7, owner="axis Z", limit_mm=-0.1)
@pytest.mark.provokes(310019, 7, owner="axis Z", limit_mm=-0.1)
@pytest.mark.provokes(70576, 7, owner="axis Z", limit_mm=-7.9)
@pytest.mark.provokes(310020, 7, owner="axis Z", limit_mm=-7.9)
@pytest.mark.parametrize(
    ("alarm_id", "target"), [(70330, 30.02), (310019, 30.02), (70576, 38.3), (310020, 38.3)]
)
def test_a_sensor_beyond_its_range_less_the_tolerance(run_distance, alarm_id, target):
    """Surface at 30: the tool goes nearer than 0.1 mm, or farther away than 7.9 mm."""
    watched = run_distance(
        SURFACE_ON + f"N20 G1 Z{target} F600\nN30 G4 1", newer=alarm_id > 300_000
    )
    due, value_mm = next(
        (i, now.sensor_mm)
        for i, _, now in judged(watched)
        if not -7.9 - AT_ONCE <= now.sensor_mm <= -0.1 + AT_ONCE
    )
    assert (watched.alarm.id, watched.alarm_cycle()) == (alarm_id, due)
    assert watched.alarm.values["value_mm"] == pytest.approx(value_mm, abs=1e-6)
    stands_with_its_offset(watched)


@pytest.mark.provokes(70331, 7, owner="axis Z", limit_mm=5.0, offset_mm=5.0)
@pytest.mark.provokes(310017, 7, owner="axis Z", limit_mm=5.0, offset_mm=5.0)
@pytest.mark.parametrize("alarm_id", [70331, 310017])
def test_an_offset_beyond_its_limit_is_limited_and_an_alarm(run_distance, alarm_id):
    """The ideal surface is 6 mm below the real one: o += limit(kp (6 - o)) comes to 5 on its way.

    The step of kp 0.2 is 1.2 mm, far above what 5000 mm/s2 allow: the offset speeds up by 5 um per
    cycle and cycle to 0.1 mm, and goes on with that until 0.2 (6 - o) is less.
    """
    watched = run_distance("N10 Z[DIST_CTRL ON SET_POS=24]\nN20 G4 1", newer=alarm_id == 310017)
    offset_mm, step_mm, cycles = 0.0, 0.0, 0
    while True:
        step_mm = min(0.2 * (6.0 - offset_mm), 0.1, step_mm + 0.005)
        cycles += 1
        if offset_mm + step_mm > 5.0:
            break
        offset_mm += step_mm
    began = watched.first(lambda cycle: cycle.offset_mm != 0.0)
    assert (watched.alarm.id, watched.alarm_cycle()) == (alarm_id, began + cycles - 1)
    assert watched.alarm.values["deviation_mm"] == pytest.approx(offset_mm + step_mm, abs=1e-5)
    assert watched.cycles[-1].offset_mm == 5.0
    stands_with_its_offset(watched)


@pytest.mark.provokes(70330, 7, owner="axis Z", value_mm=-0.05, limit_mm=-0.1)
@pytest.mark.provokes(310019, 7, owner="axis Z", value_mm=-0.05, limit_mm=-0.1)
@pytest.mark.provokes(70576, 7, owner="axis Z", value_mm=-8.0, limit_mm=-7.9)
@pytest.mark.provokes(310020, 7, owner="axis Z", value_mm=-8.0, limit_mm=-7.9)
@pytest.mark.parametrize(
    ("alarm_id", "level"), [(70330, 31.95), (310019, 31.95), (70576, 24), (310020, 24)]
)
def test_check_pos_asks_at_once_whether_the_sensor_is_in_its_range(run_distance, alarm_id, level):
    watched = run_distance(
        "N10 G4 0.05\nN20 Z[DIST_CTRL CHECK_POS]\nN30 G4 0.1",
        f"plant:gap.workpiece.plane.level_mm={level}",
        newer=alarm_id > 300_000,
    )
    assert (watched.alarm.id, watched.alarm_cycle()) == (alarm_id, watched.first_of(20))
    assert 30 not in {cycle.block for cycle in watched.cycles}


@pytest.mark.long
def test_outside_of_control_nothing_is_watched(run_distance):
    """FREEZE and INACTIVE: the same motions come to their ends."""
    motion = "N20 G1 Z38.3 F600\nN30 G1 Z30.02\nN40 G1 Z32"
    frozen = f"{SURFACE_ON}N15 Z[DIST_CTRL FREEZE]\n{motion}\nN50 Z[DIST_CTRL WAIT OFF]"
    for program in (motion, frozen):
        watched = run_distance(program, lines=["{list}max_act_value_change 5000"])
        assert watched.channel.alarms == []
        assert watched.cycles[-1].actual_mm == pytest.approx(32.0, abs=1e-4)
