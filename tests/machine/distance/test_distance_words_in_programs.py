"""Words for distance control among the other blocks of a program: order, positions, the end.

The surface is at 30.4 mm, the ideal one at 30: the offset of the surface mode is 0.4 mm.
"""

import pytest

LEVEL = "plant:gap.workpiece.plane.level_mm=30.4"
ON = "Z[DIST_CTRL ON SET_POS=30]"
SETTLED = "G4 0.5"
SHOW = '#MSG SYN["Z=%f", V.A.ACT_POS.Z]'
SENT_MM = pytest.approx(0.4, abs=2e-5)


def shown(watched):
    return watched.outcome.printed("Z")


@pytest.mark.long
def test_a_word_acts_where_the_motion_before_it_has_ended(run_distance):
    """0.5 mm at 600 mm/min take 62.5 ms; the control begins where it has come to its target."""
    watched = run_distance(
        f"N10 G1 Z32.5 F600\nN20 {ON}\nN30 {SETTLED}\nN40 Z[DIST_CTRL WAIT OFF]", LEVEL
    )
    on = watched.first(lambda cycle: cycle.state == "ACTIVE")
    moved = watched.first(lambda cycle: cycle.block == 10)
    assert 62.5 <= on - moved <= 65
    assert watched.channel.alarms == []


@pytest.mark.long
def test_a_word_beside_a_motion_acts_at_its_begin(run_distance):
    """The way of 1 mm at 600 mm/min takes 112.5 ms, and the control is on all the time."""
    watched = run_distance(
        f"N10 G4 0.02\nN20 G1 Z33 F600 {ON}\nN30 {SETTLED}\n{SHOW}\nN40 Z[DIST_CTRL WAIT OFF]",
        LEVEL,
    )
    on = watched.first(lambda cycle: cycle.state == "ACTIVE")
    moving = watched.first(lambda cycle: abs(cycle.actual_mm - 32) > 1e-9)
    assert on == watched.first_of(20) < moving <= on + 4
    assert shown(watched) == [pytest.approx(33.4, abs=2e-5)]


@pytest.mark.long
def test_off_without_motion_beside_a_motion_of_the_axis(run_distance):
    """The block goes to its true target from where the control has left the axis."""
    watched = run_distance(
        f"N10 {ON}\nN20 {SETTLED}\n{SHOW}\nN30 G1 Z33 F600 Z[DIST_CTRL OFF NO_MOVE]\n"
        f"N40 G4 0.1\n{SHOW}\nN50 G91 G1 Z-1\nN60 G4 0.1\n{SHOW}",
        LEVEL,
    )
    assert shown(watched) == [pytest.approx(z, abs=2e-5) for z in (32.4, 33.0, 32.0)]
    steps = [
        abs(after.actual_mm - before.actual_mm)
        for before, after in zip(watched.cycles, watched.cycles[1:], strict=False)
    ]
    assert max(steps[watched.first_of(30) :]) <= 0.0101, "600 mm/min are 10 um in 1 ms"


@pytest.mark.long
def test_a_relative_move_behind_off_without_motion_counts_from_there(run_distance):
    watched = run_distance(
        f"N10 {ON}\nN20 {SETTLED}\nN30 Z[DIST_CTRL OFF NO_MOVE]\nN40 G91 G1 Z1 F600\n"
        f"N50 G4 0.1\n{SHOW}",
        LEVEL,
    )
    assert shown(watched) == [pytest.approx(33.4, abs=2e-5)]


@pytest.mark.long
@pytest.mark.parametrize(
    ("block", "rig", "shift_mm"),
    [
        ("#CHANNEL INIT[ACTPOS]", "", 0.0),
        # The present position becomes the zero of positions, 1 000 000 increments of 10 nm away
        ("G74 Z1", '[drive.servo]\nsdo = [["0x6098:0", 37], ["0x607C:0", 1_000_000]]\n', None),
    ],
    ids=["ACTPOS", "G74"],
)
def test_a_frozen_offset_outlives_a_new_position(run_distance, block, rig, shift_mm):
    """What the axis is told stays what it was: program and offset together."""
    watched = run_distance(
        f"N10 {ON}\nN20 {SETTLED}\nN30 Z[DIST_CTRL FREEZE]\nN40 {block}\nN50 {SHOW}\n"
        f'N60 #MSG SYN["P=%f", V.A.ABS.Z]\nN70 G91 G1 Z1 F600\nN80 G4 0.1\n{SHOW}\n'
        f"N90 Z[DIST_CTRL WAIT OFF]\nN95 G4 0.1\n{SHOW}",
        LEVEL,
        rig=rig,
    )
    assert watched.channel.alarms == []
    before, moved, off = shown(watched)
    (programmed,) = watched.outcome.printed("P")
    assert before - programmed == SENT_MM
    assert moved == pytest.approx(before + 1.0, abs=2e-5)
    assert moved - off == SENT_MM
    if shift_mm is not None:
        assert before == pytest.approx(32.4 + shift_mm, abs=2e-5)


@pytest.mark.long
def test_program_words_act_in_inches(run_distance):
    watched = run_distance(
        f"N10 G70\nN20 Z[DIST_CTRL ON CONST_DIST SET_DIST=0.1]\nN30 {SETTLED}\nN40 G71\n{SHOW}\n"
        "N50 Z[DIST_CTRL WAIT OFF]",
        LEVEL,
    )
    assert shown(watched) == [pytest.approx(30.4 + 2.54, abs=2e-5)]


@pytest.mark.long
def test_an_axis_goes_away_and_comes_back_between_two_controls(run_distance):
    watched = run_distance(
        f"N10 {ON}\nN20 {SETTLED}\nN30 Z[DIST_CTRL WAIT OFF]\nN40 #PUT AX[Z]\n"
        f"N50 #CALL AX[Z,3,0]\nN60 {ON}\nN70 {SETTLED}\n{SHOW}\nN80 Z[DIST_CTRL WAIT OFF]",
        LEVEL,
    )
    assert watched.channel.alarms == []
    assert shown(watched) == [pytest.approx(32.4, abs=2e-5)]
