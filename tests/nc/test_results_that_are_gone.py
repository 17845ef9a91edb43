"""Results of a measuring run that a later run takes away, and those that it leaves."""

import pytest
from tests.nc.conftest import texts

from axisrig.kernel.errors import Alarm

XYZ = ("X", "Y", "Z")
RESULTS = ("V.A.MESS", "V.A.MOFFS", "V.A.MEAS.ACS.VALUE", "V.A.MEAS.PCS.VALUE")


@pytest.fixture
def touching(plane_machine):
    """Its probe signals where X crosses 5 mm."""
    return plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 5.0))


@pytest.mark.parametrize("name", RESULTS)
def test_900101_after_a_run_without_a_signal_whatever_the_run_before_gave(run, touching, name):
    """FCT-C4 section 5: the values are those of the last run."""
    first = f'G100 F9 X10\n#MSG ["%g %d", {name}.X, V.A.MERF.X]\nG0 X10\n'
    second = "G100 X12"
    show = f'{second}\n#MSG ["%d", V.A.MERF.X]\n'
    assert [text.split()[-1] for text in texts(run(first + show, touching))] == ["1", "0"]
    for reading in (f"P1={name}.X", *(["G101 X1"] if name == "V.A.MOFFS" else [])):
        touching.acs_mm.update(dict.fromkeys(XYZ, 0.0))
        with pytest.raises(Alarm) as caught:
            run(f"{first}{second}\n{reading}", touching)
        assert (caught.value.id, caught.value.values["axis"]) == (900101, "X")


def test_an_axis_that_was_not_in_a_run_keeps_what_it_had(run, touching):
    """FCT-C4 section 5, several runs: other axes keep theirs."""
    text = "G100 F9 X10\nG0 X0\nG100 Y1\nP1=V.A.MESS.X\n"
    show = '#MSG ["%g %d %d", P1, V.A.MERF.X, V.A.MERF.Y]'
    assert texts(run(text + show, touching)) == ["5 1 0"]
