"""A whole number may be computed: what its computation rounds counts for no fraction."""

import pytest
from tests.nc.conftest import texts

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Homing

COMPUTED = "[0.1 + 0.2] * 10"  # 3.0000000000000004 in double precision
LESS = "4.35 * 100 - 432"  # 2.99999999999994 in double precision

WORDS = [
    "G159 = P1",
    "V.G.NP_DEFAULT = P1",
    "V.G.NP[P1].V.X = 1",
    "P2 = V.G.NP_AKT.V[P1 - 1]",
    "V.G.WZ[3].OK = 1\nD = P1",
    "#CS ON [P1][0, 0, 1]",
    "#SET AX LINK [P1, Y=X]",
    "#MEAS MODE [P1]",
    "#MEAS [TYPE=P1]",
    "#MEAS [AX=X INPUT=P1]",
    "#MEAS [AXNR=P1 INPUT=1]",
    "#ERROR [ID=P1 RC=0]",
    "G74 X=P1",
    "H = P1",
    "#TIME [P1]",
    '#MSG ["%d", P1]',
    "P2 = P1 & 1",
    "#KIN ID [3 * P1]",
    "G74 X=P1 Y=3",
]


@pytest.mark.parametrize("text", WORDS)
@pytest.mark.parametrize("computed", [COMPUTED, LESS])
def test_a_computed_whole_number_is_taken(run, text, computed):
    run(f"P1 = {computed}\n{text}")


@pytest.mark.parametrize(
    "text", [each for each in WORDS if each[0] not in "H" and "TIME" not in each]
)
@pytest.mark.parametrize("away", ["0.01", "-0.01"])
def test_a_real_fraction_is_refused(run, text, away):
    with pytest.raises(Alarm):
        run(f"P1 = 3 + {away}\n{text}")


def test_axes_with_one_computed_place_home_together(run):
    commands = run(f"P1 = {COMPUTED}\nG74 X=P1 Y=3 Z=2")
    assert [c.groups for c in commands if isinstance(c, Homing)] == [(("Z",), ("X", "Y"))]


def test_a_message_shows_the_whole_number_that_was_meant(run):
    assert texts(run(f'P1 = {LESS}\n#MSG ["%d %i", P1, P1]')) == ["3 3"]


@pytest.mark.parametrize("word", ["G159 = P1", "V.G.NP_DEFAULT = P1"])
def test_a_group_with_a_fraction_is_named_with_its_word(run, word):
    with pytest.raises(Alarm) as caught:
        run(f"P1 = 2.5\n{word}")
    reason = f"{word.partition(' ')[0]} = 2.5 is no group"
    assert (caught.value.id, caught.value.values["reason"]) == (900105, reason)


@pytest.mark.parametrize("text", ["G159 = V.E.A", "#MEAS MODE [V.E.A]", "#ERROR [ID=V.E.A RC=0]"])
@pytest.mark.parametrize("number", ["inf", "-inf", "nan"])
def test_a_number_of_the_plc_side_that_is_none_is_no_whole_one(run, text, number):
    """The alarm names variable, value and what is allowed, whatever takes the value."""
    with pytest.raises(Alarm) as caught:
        run(f"G0 X1\n{text}", external={"B": 1.0, "A": float(number)})
    reason = f"V.E.A of the PLC side is {number}, and has to be a finite number"
    assert (caught.value.id, caught.value.values["reason"]) == (900105, reason)
    assert caught.value.place == "test.nc line 2"


@pytest.mark.parametrize("number", ["inf", "nan"])
def test_a_value_that_is_none_stops_only_who_reads_it(run, number):
    external = {"Gap[2]": float(number), "Gap[1]": 4.0}
    assert texts(run('#MSG ["%g", V.E.GAP[1]]', external=external)) == ["4"]
    for text in ("P1 = V.E.GAP[2] + 1", "$IF V.E.GAP[2] > 1\n$ENDIF", "P1 = ABS[V.E.GAP[2]]"):
        with pytest.raises(Alarm, match=rf"V\.E\.Gap\[2\] of the PLC side is {number}"):
            run(text, external=external)
