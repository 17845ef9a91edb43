"""Each of the eight SyncManagers, errors and observers of AL states, a flag of SDO information."""

import struct

import pytest
from tests.ethercat.test_al_states_by_hand import States
from tests.ethercat.test_buffers_of_sync_managers import registers

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.object_information import ObjectInformation
from axisrig.bench.drive.ethercat.sync_managers import COUNT, SyncManager, SyncManagers
from axisrig.kernel.profiles.ethercat.layouts import SM_MASTER_WRITES
from axisrig.kernel.profiles.ethercat.tables import AlState, al_status_codes

AREA, SIZE = 0x1800, 4


@pytest.mark.parametrize("number", range(COUNT))
def test_each_of_the_eight_guards_its_area(number: int) -> None:
    """The master reads nothing from an area that it writes. A buffer is whole at its last byte."""
    whole: list[int] = []
    managers = SyncManagers(whole.append, whole.append, whole.append, lambda: None)
    ram = bytearray(0x2000)
    managers.configure(
        bytes(8 * number) + registers(AREA, SIZE, SM_MASTER_WRITES) + bytes(8 * (7 - number))
    )
    assert managers.read(AREA, SIZE, ram) is None
    assert managers.read(AREA - 2, 2, ram) == bytes(2)
    assert managers.write(AREA, b"ab", ram)
    assert whole == []
    assert managers.write(AREA + 2, b"cd", ram)
    assert (whole, managers[number].latest) == ([number], b"abcd")
    assert ram[AREA : AREA + SIZE] == bytes(4)  # it is in the buffers


@pytest.mark.parametrize("start", [AREA, AREA + 8])
def test_a_half_written_buffer_is_forgotten_with_its_area(start: int) -> None:
    manager = SyncManager(2)
    assert manager.configure(registers(AREA, SIZE, SM_MASTER_WRITES))
    assert manager.write(AREA, b"ab") is False
    assert manager.configure(registers(start, SIZE, SM_MASTER_WRITES, 0))
    assert manager.configure(registers(start, SIZE, SM_MASTER_WRITES))
    assert manager.write(start + 2, b"cd") is True
    assert manager.latest == b"\0\0cd"


@pytest.mark.parametrize("requested", [AlState.PREOP, AlState.SAFEOP, AlState.OP])
def test_an_error_holds_the_state_until_it_is_acknowledged(requested: AlState) -> None:
    """Also downwards: INIT alone needs no acknowledgement."""
    states = States()
    states.machine.refuse("WATCHDOG")
    code = al_status_codes()["WATCHDOG"]
    states.machine.control(requested)
    assert (states.machine.state, states.shown) == (AlState.SAFEOP, (4 | 0x10, code))
    assert states.behaviour.left == []
    states.machine.control(requested | 0x10)
    assert (states.machine.state, states.shown) == (requested, (requested, 0))


def test_each_observer_of_a_slave_gets_each_state() -> None:
    states = States()
    heard: list[tuple[str, AlState, int]] = []

    def listen(name: str) -> None:
        states.machine.observers.append(lambda state, code: heard.append((name, state, code)))

    for name in "ab":
        listen(name)
    states.machine.control(AlState.OP)
    states.machine.fall(AlState.SAFEOP, "WATCHDOG")
    code = al_status_codes()["WATCHDOG"]
    assert heard == [
        *((name, AlState.OP, 0) for name in "ab"),
        *((name, AlState.SAFEOP, code) for name in "ab"),
    ]


def test_a_request_for_information_may_say_that_more_follows() -> None:
    """Bit 7 of the operation is of answers: a request is the same with it."""
    information = ObjectInformation({}, DriveProfile(), lambda _: 0, lambda: 128)

    def ask(operation: int) -> list[bytes]:
        return information.request(struct.pack("<HBBHH", 0x8000, operation, 0, 0, 1))

    assert ask(0x81) == ask(0x01)
    assert ask(0x83) == ask(0x03)
    assert ask(0x81) != ask(0x83)
