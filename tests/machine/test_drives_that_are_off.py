"""When the drive of an axis has left operation, for every state and every kind of drive."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.cia402 import Cia402Segments
from axisrig.bench.machine.cyclic.family import CyclicSegments
from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.power import Power
from axisrig.kernel.profiles.cia402.ds402 import State

WITHOUT_TORQUE = {
    "NOT_READY_TO_SWITCH_ON": False,  # it says nothing yet
    "SWITCH_ON_DISABLED": True,
    "READY_TO_SWITCH_ON": True,
    "SWITCHED_ON": False,  # on the way
    "OPERATION_ENABLED": False,
    "QUICK_STOP_ACTIVE": False,
    "FAULT_REACTION_ACTIVE": False,
    "FAULT": True,
}


@pytest.mark.interpreted
@pytest.mark.parametrize("segments", [Cia402Segments, CyclicSegments])
@pytest.mark.parametrize("power", Power)
def test_a_drive_without_states_of_cia_402_is_off_without_torque(
    segments: Any, power: Power
) -> None:
    """A fault is the end of operation as well; a drive that stops by itself has torque."""
    on: Any = SimpleNamespace(links={"Z": SimpleNamespace(power=power)})
    assert segments.is_off(on, "Z") is (power.name in ("OFF", "FAULT"))


@pytest.mark.interpreted
@pytest.mark.parametrize("state", State)
def test_a_drive_of_cia_402_is_off_where_its_states_say_so(state: State) -> None:
    class Link(Cia402Drive):
        state = None  # type: ignore[assignment]

        def __init__(self) -> None:
            self.state = state  # type: ignore[misc]

    on: Any = SimpleNamespace(links={"Z": Link()})
    assert Cia402Segments.is_off(on, "Z") is WITHOUT_TORQUE[state.name]
