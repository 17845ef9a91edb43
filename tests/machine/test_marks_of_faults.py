"""The marks of a run name the faults brought in, the frames hit, and what the drive did then."""

import pytest

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.program.findings import program_events
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.record.facts import Facts
from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import Scenario

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")
MS = 1_000_000


def marks(*faults: str) -> dict[str, int]:
    seen: list[Facts] = []
    _, machine = examine(
        Scenario(0, 1, (*INPUTS, *faults)), lambda machine: seen.append(facts_of(machine))
    )
    assert machine is not None
    found = program_events(Observed(seen[0], machine.recorder.series()))
    return {mark.label: mark.time_ns for mark in found}


@pytest.mark.long
def test_a_fault_of_frames_tells_its_begin_and_how_many_it_hit() -> None:
    found = marks("fault:drop=Z.TPDO2 at=latched count=3")
    begin_ns = found["drop Z.TPDO2 begins"]
    last_ns = found["drop Z.TPDO2: 3 frames hit, the last"]
    assert 2 * MS <= last_ns - begin_ns <= 3 * MS


@pytest.mark.long
def test_a_fault_for_a_time_tells_its_end() -> None:
    found = marks("fault:power_loss=Z at=motion+5ms for=1ms")
    assert found["power_loss Z ends"] - found["power_loss Z begins"] == MS


@pytest.mark.long
def test_the_drive_that_goes_into_fault_is_marked() -> None:
    """Set positions stay out: fault reaction, standstill, fault; not its way into operation."""
    found = marks("fault:drop=Z.RPDO1 at=motion+5ms")
    assert found["drop Z.RPDO1 begins"] < found["Z: fault reaction active"] <= found["Z: fault"]
    assert "Z: ready to switch on" not in found


@pytest.mark.long
def test_a_fault_whose_moment_does_not_come_says_so() -> None:
    _, machine = examine(Scenario(0, 1, (*INPUTS, "fault:drop=Z.TPDO1 at=100s")))
    assert machine is not None
    (fault,) = machine.faults
    assert fault.marks() == []
    assert "has not come" in fault.in_words()
