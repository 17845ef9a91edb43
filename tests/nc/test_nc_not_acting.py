"""What the manuals know and nobody carries out: the tables say it, the run ends with 900100."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.nc.decoder import not_acting
from axisrig.kernel.nc.text.check import check_program

# What the language has to do by now, as the project has set it out; what belongs to 3D distance
# control, to SERCOS and to kinematics comes later.
CLAIMED = {
    *(f"G{number}" for number in (0, 1, 2, 3, 4, 9, *range(53, 60), 70, 71, 74, 90, 91, 92)),
    *("G17", "G18", "G19", "G100", "G101", "G102", "G106", "G210", "G310"),
    *("M0", "M1", "M2", "M17", "M29", "M30", "F", "D", "T"),
}
CLAIMED_COMMANDS = (
    "#MEAS MODE",
    "#MEAS",
    "#MEAS PREPARE",
    "#CS ON",
    "#CS OFF",
    "#CS OFF ALL",
    "#DRIVE WR SYN",
    "#DRIVE RD",
    "#SET AX LINK",
    "#ENABLE AX LINK",
    "#DISABLE AX LINK",
    "#WAIT INDP",
    "#TIME",
    "#CHANNEL INIT",
    "#MSG",
    "#MSG SYN",
    "#MSG INFO",
    "#MSG SYN PLC",
    "#FLUSH WAIT",
    "#CALL AX",
    "#PUT AX",
    "#CONTOUR MODE ON",
    "#CONTOUR MODE OFF",
    "#VAR",
    "<axis>[INDP_SYN]",
    "<axis>[INDP_ASYN]",
    "<axis>[DIST_CTRL]",
)
CLAIMED_VARIABLES = (
    "V.A.MESS.<axis>",
    "V.A.MERF.<axis>",
    "V.A.MOFFS.<axis>",
    "V.A.MEIN.<axis>",
    "V.A.MEAS.ACS.VALUE.<axis>",
    "V.A.MEAS.PCS.VALUE.<axis>",
    "V.G.MEAS_TYPE",
    "V.G.WZ_AKT.L",
    "V.G.KIN_STEP[].ID[].PARAM[]",
    "V.E.<name>",
    "V.P.<name>",
    "V.L.<name>",
    "V.S.<name>",
    "P[]",
)


def test_the_tables_say_what_acts_as_it_is():
    """A row with acts = yes has a handler, one with acts = no has none."""
    wrong = [entry for entry in not_acting.known() if entry.acts != entry.is_handled]
    assert [f"{entry.word} ({entry.table})" for entry in wrong] == []


def test_what_this_version_claims_acts():
    missing = {entry.word for entry in not_acting.known() if not entry.is_handled}
    assert missing & {*CLAIMED, *CLAIMED_COMMANDS, *CLAIMED_VARIABLES} == set()


def test_everything_claimed_is_known():
    words = {entry.word for entry in not_acting.known()}
    assert {*CLAIMED, *CLAIMED_COMMANDS, *CLAIMED_VARIABLES} - words == set()


@pytest.mark.provokes(900100, 2, word="G41")
def test_900100_ends_the_program_at_the_block(run):
    with pytest.raises(Alarm) as caught:
        run("G0 X1\nN20 G41\nX2")
    assert (caught.value.id, "block N20" in str(caught.value.place)) == (900100, True)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ('#MSG SYN_ACK ["ready?"]', "#MSG SYN_ACK"),
        ("Z[MC_TOUCHPROBE CHANNEL=1]", "Z[MC_TOUCHPROBE]"),
        ("G41", "G41"),
        ("P1=V.TOOL.X", "V.TOOL.X"),
    ],
)
def test_the_alarm_names_the_word(run, text, word):
    with pytest.raises(Alarm) as caught:
        run(text)
    assert (caught.value.id, caught.value.values["word"]) == (900100, word)


def test_blocks_that_are_never_reached_end_nothing(run):
    commands = run("G0 X1\n$IF 0\nG41\n$ENDIF\nX2")
    assert len([c for c in commands if isinstance(c, LinearMove)]) == 2


def test_functions_of_a_spindle_are_noted_and_end_with_an_alarm_of_their_own(run):
    """TF5200 diagnosis 255149963: 21548, not the 900100 of other words that do not act."""
    for word in ("M3", "M4", "M5", "M19"):
        noted = check_program(f"N10 G1 X1 F100\nN20 {word}\n", "spindle.nc", ("X", "Y", "Z")).notes
        assert [(note.line, note.column) for note in noted] == [(2, 5)]
        assert "alarm 21548 without a spindle" in noted[0].text
        with pytest.raises(Alarm) as caught:
            run(f"N20 {word}")
        assert caught.value.id == 21548
