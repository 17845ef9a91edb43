"""Power as a control wants it: each order in each request, and the words of CiA 402 for each."""

import pytest

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.cia402.link import WORDS
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.power import NEXT, Power, PowerOrder, PowerRequest
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.profiles.cia402.ds402 import STATES, State

OFF, ON, KEEP = PowerRequest.OFF, PowerRequest.ON, PowerRequest.KEEP
RELEASE, STOP = PowerRequest.RELEASE, PowerRequest.STOP
# After switch on, switch off, hold back, stop, let go
AFTER = {
    OFF: (ON, OFF, RELEASE, STOP, OFF),
    ON: (ON, OFF, KEEP, STOP, ON),
    KEEP: (KEEP, RELEASE, KEEP, STOP, ON),
    RELEASE: (KEEP, RELEASE, RELEASE, STOP, OFF),
    STOP: (STOP, RELEASE, STOP, STOP, ON),
}


def drive(*orders: PowerOrder) -> Drive:
    made = Drive(DriveSettings("Z", 1000.0), Arrival())
    for order in orders:
        made.order(order)
    return made


@pytest.mark.parametrize("before", PowerRequest)
def test_every_order_in_every_request(before: PowerRequest) -> None:
    """An alarm never leads a drive into operation again, and only a reset takes that back."""
    found = [NEXT.get((before, order), before) for order in PowerOrder]
    assert tuple(found) == AFTER[before]


def test_only_on_and_keep_keep_a_drive_in_operation() -> None:
    order = PowerOrder
    assert not drive().keeps_operating
    assert drive(order.SWITCH_ON).keeps_operating
    assert drive(order.SWITCH_ON, order.HOLD_BACK).keeps_operating
    assert not drive(order.SWITCH_ON, order.HOLD_BACK, order.SWITCH_OFF).keeps_operating
    assert not drive(order.SWITCH_ON, order.STOP).keeps_operating
    assert drive(order.SWITCH_ON, order.STOP, order.LET_GO).keeps_operating


def test_power_of_a_state_is_in_the_table_of_states() -> None:
    operating = [state for state, of in STATES.items() if of.power == Power.OPERATING.name]
    assert operating == [State.OPERATION_ENABLED]
    faults = {state for state, of in STATES.items() if of.power == Power.FAULT.name}
    assert faults == {State.FAULT, State.FAULT_REACTION_ACTIVE}


@pytest.mark.parametrize(
    ("request_", "state", "word"),
    [
        (ON, State.SWITCH_ON_DISABLED, 0x06),
        (ON, State.SWITCHED_ON, 0x0F),
        (ON, State.OPERATION_ENABLED, 0x0F),
        (OFF, State.OPERATION_ENABLED, 0x06),
        (OFF, State.SWITCH_ON_DISABLED, 0x06),
        (KEEP, State.OPERATION_ENABLED, 0x0F),
        (KEEP, State.QUICK_STOP_ACTIVE, 0x02),
        (KEEP, State.SWITCHED_ON, 0x00),
        (RELEASE, State.OPERATION_ENABLED, 0x06),
        (RELEASE, State.READY_TO_SWITCH_ON, 0x00),
        (STOP, State.OPERATION_ENABLED, 0x02),
        (STOP, State.QUICK_STOP_ACTIVE, 0x02),
        (STOP, State.SWITCHED_ON, 0x00),
    ],
)
def test_words_of_requests(request_: PowerRequest, state: State, word: int) -> None:
    assert WORDS[request_, state] == word


def test_a_fault_is_left_by_no_request() -> None:
    for request_ in PowerRequest:
        for state in (State.FAULT, State.FAULT_REACTION_ACTIVE):
            assert WORDS[request_, state] == 0x00
    assert issubclass(AxisLink, Drive)
