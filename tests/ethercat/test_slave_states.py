"""States of a slave: the whole table, AL status codes, watchdog, what each state serves."""

import struct

import pytest
from tests.ethercat.line import ACK, INIT, OP, PREOP, SAFEOP, Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US

BOOT = 3
# From the facts of docs/ethercat.md: the code of each request that is refused
REFUSED = {
    (INIT, SAFEOP): 0x11, (INIT, OP): 0x11, (INIT, BOOT): 0x13, (PREOP, OP): 0x11,
    (PREOP, BOOT): 0x11, (SAFEOP, BOOT): 0x11, (OP, BOOT): 0x11,
}  # fmt: skip


def line_in(state: int, profile: DriveProfile | None = None) -> Line:
    line = Line(profile=profile)
    {INIT: lambda: None, PREOP: line.preop, SAFEOP: line.safeop, OP: line.op}[state]()
    return line


@pytest.mark.parametrize("state", [INIT, PREOP, SAFEOP, OP])
@pytest.mark.parametrize("asked", [INIT, PREOP, BOOT, SAFEOP, OP])
def test_each_request_in_each_state(state: int, asked: int) -> None:
    line = line_in(state)
    if (state, asked) == (INIT, PREOP):
        line.preop()
        return
    if (state, asked) == (PREOP, SAFEOP):
        line.map_image()
    got = line.ask(asked)
    code = REFUSED.get((state, asked), 0)
    if code:
        assert got == (state | 0x10, code)
        assert line.ask(state) == (state | 0x10 if state != INIT else INIT, code * (state != INIT))
        assert line.ask(state | ACK) == (state, 0)
    elif (state, asked) == (SAFEOP, OP):
        assert got == (SAFEOP, 0)  # until outputs arrive, without an error
        line.cycle()
        assert line.al() == (OP, 0)
    else:
        assert got == (asked, 0)


@pytest.mark.parametrize("asked", [0, 5, 9, 15])
def test_a_state_that_there_is_not(asked: int) -> None:
    assert Line().ask(asked) == (INIT | 0x10, 0x12)


def test_an_error_is_left_by_an_acknowledge_or_by_init() -> None:
    line = line_in(PREOP)
    assert line.ask(OP) == (PREOP | 0x10, 0x11)
    assert line.ask(SAFEOP) == (PREOP | 0x10, 0x11)  # ignored
    line.map_image()
    assert line.ask(SAFEOP | ACK) == (SAFEOP, 0)
    assert line.ask(BOOT) == (SAFEOP | 0x10, 0x11)
    assert line.ask(INIT) == (INIT, 0)


@pytest.mark.parametrize(
    "managers",
    [
        b"",
        struct.pack("<HHBBBB", 0x1000, 128, 0x26, 0, 1, 0),
        struct.pack("<HHBBBBHHBBBB", 0x1000, 64, 0x26, 0, 1, 0, 0x1080, 128, 0x22, 0, 1, 0),
        struct.pack("<HHBBBBHHBBBB", 0x1000, 128, 0x22, 0, 1, 0, 0x1080, 128, 0x26, 0, 1, 0),
        struct.pack("<HHBBBBHHBBBB", 0x1000, 128, 0x26, 0, 0, 0, 0x1080, 128, 0x22, 0, 0, 0),
    ],
)
def test_mailboxes_that_are_not_as_the_eeprom_says(managers: bytes) -> None:
    line = Line()
    if managers:
        line.one(2, 0, 0x0800, managers)
    assert line.ask(PREOP) == (INIT | 0x10, 0x16)


@pytest.mark.parametrize(
    ("outputs", "inputs", "code"),
    [(8, 16, 0), (7, 16, 0x1D), (0, 16, 0x1D), (8, 15, 0x1E), (8, 0, 0x1E)],
)
def test_process_data_that_does_not_fit_what_is_assigned(
    outputs: int, inputs: int, code: int
) -> None:
    line = line_in(PREOP)
    line.map_image(0, outputs, inputs)
    assert line.ask(SAFEOP) == ((SAFEOP, 0) if not code else (PREOP | 0x10, code))


@pytest.mark.parametrize("state", [SAFEOP, OP])
@pytest.mark.parametrize(
    ("manager", "after", "code"),
    [(0, INIT, 0x16), (1, INIT, 0x16), (2, PREOP, 0x1D), (3, PREOP, 0x1E)],
)
def test_a_sync_manager_that_is_changed_under_a_state_ends_it(
    state: int, manager: int, after: int, code: int
) -> None:
    line = line_in(state)
    line.write(0x0800 + 8 * manager + 2, 5, 2)
    assert line.al() == (after | 0x10, code)


def test_the_watchdog_takes_a_slave_without_outputs_to_safeop_and_inputs_go_on() -> None:
    line = Line(motion=lambda time_s: 0.010 * time_s)
    line.op()
    line.write(0x0400, 2498, 2)
    line.write(0x0420, 30, 2)  # 30 units of (2498 + 2) 40 ns
    line.cycle()
    came_ns = line.back[-1][0] - 1
    line.clock.run_until(came_ns + 3 * MS - 20 * US)
    assert line.read(0x0440, 2) == 1
    line.clock.run_until(came_ns + 3 * MS + 20 * US)
    assert line.al() == (SAFEOP | 0x10, 0x1B)
    assert (line.read(0x0440, 2), line.read(0x0442, 1)) == (0, 1)
    line.wait(50 * MS)
    line.cycle(0x0F, 1234)  # shows what was sampled behind the frame before
    line.wait(10 * MS)
    first = line.cycle(0x0F, 1234)
    line.wait(10 * MS)
    second = line.cycle(0x0F, 1234)
    # 10 mm/s for 10 ms and the time of a frame, in increments of 10 mm / 2^20
    per_mm = float(line.drive.profile.units_per_mm)
    assert (second[1] - first[1]) / per_mm == pytest.approx(0.1, rel=0.01)
    # The outputs of SAFEOP act on nothing
    assert line.drive.image.controlword == 0
    assert line.drive.image.target_position != 1234
    assert line.ask(OP) == (SAFEOP | 0x10, 0x1B)
    line.write(0x0120, OP | ACK, 2)
    line.cycle()
    assert line.al() == (OP, 0)


@pytest.mark.parametrize(("control", "time"), [(0x24, 1000), (0x64, 0)])
def test_a_watchdog_that_is_off_lets_the_slave_in_op(control: int, time: int) -> None:
    line = Line()
    line.preop()
    line.map_image()
    line.one(2, 0, 0x0810, struct.pack("<HHBBBB", 0x1800, 8, control, 0, 1, 0))
    line.write(0x0420, time, 2)
    line.ask(SAFEOP)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.cycle()
    line.wait(1000 * MS)
    assert line.al() == (OP, 0)


@pytest.mark.parametrize(
    ("option", "state", "code"),
    [
        (0, State.OPERATION_ENABLED, None),
        (1, State.FAULT_REACTION_ACTIVE, 0x8130),
        (2, State.SWITCH_ON_DISABLED, None),
        (3, State.QUICK_STOP_ACTIVE, None),
    ],
)
@pytest.mark.parametrize("way", ["watchdog", "master"])
def test_a_moving_drive_that_leaves_op_does_what_6007_says(
    option: int, state: State, code: int | None, way: str
) -> None:
    line = Line()
    line.preop()
    assert line.sdo_write(0x6007, 0, option, 2) == 0
    line.map_image()
    line.ask(SAFEOP)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.enable()
    assert line.drive.state is State.OPERATION_ENABLED
    if way == "watchdog":
        line.wait(101 * MS)
    else:
        assert line.ask(SAFEOP) == (SAFEOP, 0)
    settled = {
        State.FAULT_REACTION_ACTIVE: State.FAULT,
        State.QUICK_STOP_ACTIVE: State.SWITCH_ON_DISABLED,
    }
    assert line.drive.state in (state, settled.get(state))
    assert line.drive.image.error_code == (code or 0)


def test_a_drive_at_rest_that_leaves_op_has_no_fault() -> None:
    line = Line()
    line.op()
    line.wait(101 * MS)
    assert line.al() == (SAFEOP | 0x10, 0x1B)
    assert line.drive.image.error_code == 0


def test_power_takes_everything_but_what_was_stored() -> None:
    line = Line()
    line.preop()
    line.sdo_write(0x6065, 0, 4711, 4)
    line.sdo_write(0x1010, 1, int.from_bytes(b"save", "little"), 4)
    line.sdo_write(0x6066, 0, 12, 2)
    line.drive.power_off()
    line.drive.power_on()
    assert line.al() == (INIT, 0)
    line.preop()
    assert line.sdo_read(0x6065, 0) == struct.pack("<I", 4711)
    assert line.sdo_read(0x6066, 0) == b"\x00\x00"


@pytest.mark.parametrize("first", [SAFEOP, OP])
def test_outputs_of_an_earlier_time_do_not_lead_to_op(first: int) -> None:
    """Outputs count from SAFEOP on: after PREOP the slave waits for new ones."""
    line = line_in(first)
    line.cycle()
    assert line.ask(PREOP) == (PREOP, 0)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    assert line.ask(OP) == (SAFEOP, 0)
    line.wait(5 * MS)
    assert line.al() == (SAFEOP, 0)
    line.cycle()
    assert line.al() == (OP, 0)


@pytest.mark.parametrize("state", [SAFEOP, PREOP])
def test_no_outputs_are_missed_after_op_was_left_by_request(state: int) -> None:
    """0440 shows that nothing is watched, 0442 counts nothing, and no error comes later."""
    line = Line()
    line.op()
    line.cycle()
    assert line.read(0x0440, 2) == 1
    assert line.ask(state) == (state, 0)
    line.wait(500 * MS)
    assert (line.al(), line.read(0x0440, 2), line.read(0x0442, 1)) == ((state, 0), 0, 0)
    if state == SAFEOP:
        line.cycle()
        line.wait(500 * MS)  # outputs in SAFEOP are none that anybody waits for
        assert (line.al(), line.read(0x0442, 1)) == ((SAFEOP, 0), 0)
        line.cycle()
        line.ask(OP)
        line.cycle()
        line.wait(500 * MS)
        assert (line.al()[0], line.read(0x0442, 1)) == (SAFEOP | 0x10, 1)
