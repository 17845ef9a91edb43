"""What random scenarios have found, reduced: wrong values, an axis that runs away; and 200 more."""

import pytest

from axisrig.bench.tools.scenarios.campaign import run_scenario, run_scenarios
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Judgement
from axisrig.bench.tools.scenarios.scenario import Scenario

pytestmark = pytest.mark.long

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")
SCENARIOS = 200


def run(fault: str) -> Judgement:
    return run_scenario(Scenario(0, 1, (*INPUTS, fault)))


@pytest.mark.parametrize(
    "fault",
    [
        # Set positions and latch control words of 82 ms ago: the probe is armed a second time
        "fault:delay=Z.RPDO1 by=82.394ms jitter=104us p=0.4512 at=seen",
        # Latches of a node that invents them, between those of the drive
        "fault:second_sender=Z.TPDO2 data=random p=0.3226 at=standing",
        # One bit of the latch in some of its telegrams, in all, and once when it is new
        "fault:alter=Z.TPDO2 byte=1 xor=216 p=0.0779 at=latched",
        "fault:alter=Z.TPDO2 byte=1 xor=216",
        "fault:alter=Z.TPDO2 p=0.0303",
        # 60B9 tells of an edge in the second run that was none; 60BA still has the first one
        "fault:alter=Z.TPDO1 byte=7 xor=2 at=armed+1.331ms nth=2",
        # The latch comes so late that it is the one of the run before
        "fault:delay=Z.TPDO2 by=100ms at=latched",
    ],
)
def test_no_wrong_value_passes_as_good(fault: str) -> None:
    judgement = run(fault)
    assert judgement.result not in DEFECTS, judgement.note


def test_an_axis_that_runs_away_by_itself_is_stopped_by_its_drive() -> None:
    """The set position stands and every telegram with it is wrong: braking would change nothing."""
    judgement = run("fault:alter=Z.RPDO1 byte=6 xor=0x40 at=seen+20ms")
    assert judgement.result not in DEFECTS, judgement.note
    assert judgement.alarms


def test_two_hundred_random_scenarios_have_no_defect() -> None:
    """The long run is `axisrig scenarios --count 10000 -j 2`."""
    found = [
        (scenario, judgement)
        for scenario, judgement in run_scenarios(seed=2, first=0, count=SCENARIOS)
        if judgement.result in DEFECTS
    ]
    assert found == []
