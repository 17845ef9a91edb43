"""The table of signal sources: what FCT-C4 7 and 8.2.2 say of each."""

from collections.abc import Callable

import pytest

from axisrig.bench.record.signal_sources import AT_PLC, AT_SIGNAL, HELD, STAMPED
from axisrig.kernel.measuring.rules import OF_PLC
from axisrig.kernel.parameters import ParameterSet, start_up
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES
from axisrig.kernel.parameters.signal_sources import SOURCES, latched


def test_who_latches() -> None:
    """7.1 and 7.5: the PLC; 7.2: the drive, at a probe that the PLC switches; 7.4: hardware."""
    assert set(AT_SIGNAL) == {"PLC", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL"}
    assert (STAMPED, HELD) == ("PLC_TIMESTAMP", "PLC_EXT_LATCH_CONTROL")
    assert set(AT_PLC) == {*AT_SIGNAL, STAMPED}
    assert set(OF_PLC) == {*AT_PLC, "EXT_PROBE_WITH_DRIVE"}
    assert set(latched("drive")) == {"DRIVE", "DRIVE_TYPE_DEFAULT", "EXT_PROBE_WITH_DRIVE"}
    assert latched("none") == ("FIXED_STOP",)


TWO_INPUTS = (2, 3, 8)  # SERCOS, PROFIDRIVE MC, CANopen
WITHOUT_LATCH = (4, 16)
TO_A_STOP = (1, 2, 3, 5, 6, 8)  # FCT-C4 8.2.4, P-AXIS-00330


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_inputs_of_each_drive_type_with_each_source(number: int) -> None:
    """FCT-C4 8.2.2, the table of P-AXIS-00517: other signals use no input."""
    kind = DRIVE_TYPES[number]
    of_drive = 2 if number in TWO_INPUTS else 1
    assert {source: kind.inputs_of(source) for source in SOURCES} == dict.fromkeys(SOURCES) | {
        "DRIVE": of_drive,
        "DRIVE_TYPE_DEFAULT": of_drive,
        "EXT_PROBE_WITH_DRIVE": 2,
        "PLC_EXT_LATCH_CONTROL": 255,
    }


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_sources_of_each_drive_type(number: int) -> None:
    lacking = {source for source in SOURCES if not DRIVE_TYPES[number].offers(source)}
    latch = {"DRIVE", "EXT_PROBE_WITH_DRIVE"} if number in WITHOUT_LATCH else set()
    stop = set() if number in TO_A_STOP else {"FIXED_STOP"}
    assert lacking == latch | stop


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_an_input_that_follows_another_one_is_not_corrected_for_it(
    listed: Callable[..., ParameterSet], number: int
) -> None:
    """The hardware of the PLC has 255 inputs (FCT-C4 7.4); those of a drive were not set."""
    axis = listed(
        f"kenngr.antr_typ {number}\nkenngr.measure.signal PLC_EXT_LATCH_CONTROL\n"
        "kenngr.measure.input 200\n"
    )
    assert [alarm.id for alarm in start_up(axis, "Z") if alarm.id in (110614, 110622)] == []
    assert axis.integer("kenngr.measure.input") == 200
    assert axis.integer("kenngr.measure.probe[0].input") == 200
