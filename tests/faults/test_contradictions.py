"""A telegram that contradicts another is no measurement: the kernel's end of one drive."""

import pytest

from axisrig.bench.tools.scenarios.campaign import run_scenario
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")


def run(*faults: str) -> Judgement:
    return run_scenario(Scenario(0, 1, (*INPUTS, *faults)))


@pytest.mark.long
def test_a_second_node_with_the_identifier_of_the_status_telegram_stops_the_axis() -> None:
    """It repeats the telegram of one cycle before: plausible, and different while it moves."""
    judgement = run("fault:second_sender=Z.TPDO1 at=motion+5ms")
    assert (judgement.result, judgement.alarms) == (Result.ALARM, [900080])


@pytest.mark.long
def test_the_same_contents_twice_are_no_contradiction() -> None:
    """A controller repeats a frame whose last bit one node saw wrong; all have had it."""
    judgement = run("fault:duplicate=Z.TPDO1 Z.TPDO2")
    assert (judgement.result, judgement.right) == (Result.GOOD, 4)


@pytest.mark.long
def test_a_late_telegram_beside_the_right_one_costs_a_cycle_and_no_more() -> None:
    judgement = run("fault:delay=Z.TPDO1 by=1ms p=0.1")
    assert (judgement.result, judgement.right) == (Result.GOOD, 4)


@pytest.mark.long
def test_a_status_word_that_no_state_has_is_not_acted_on() -> None:
    """Bit 6 (switch on disabled) beside those of operation enabled; three cycles are borne."""
    for_three = run("fault:alter=Z.TPDO1 byte=1 xor=0x40 at=motion+5ms count=3")
    assert (for_three.result, for_three.right) == (Result.GOOD, 4)
    lasting = run("fault:alter=Z.TPDO1 byte=1 xor=0x40 at=motion+5ms")
    assert (lasting.result, lasting.alarms) == (Result.ALARM, [900081])


@pytest.mark.long
def test_a_probe_that_somebody_switched_off_ends_the_run() -> None:
    """RPDO1 with a latch control word of 0 for one cycle: bit 0 of byte 7 is the enable bit."""
    judgement = run("fault:alter=Z.RPDO1 byte=7 xor=0x01 at=motion+5ms count=1")
    assert (judgement.result, judgement.alarms) == (Result.ALARM, [900082])
