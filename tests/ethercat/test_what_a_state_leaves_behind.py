"""What a drive serves in each state of its slave controller; what ends with a state or power."""

import struct

import pytest
from tests.ethercat.line import ACK, INIT, OP, PREOP, SAFEOP, Line, physical
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US, S

APRD, APWR = 1, 2
UPLOAD_6061 = struct.pack("<HBHB4x", 2 << 12, 0x40, 0x6061, 0)
MAILBOXES = struct.pack("<HHBBBBHHBBBB", 0x1000, 128, 0x26, 0, 1, 0, 0x1080, 128, 0x22, 0, 1, 0)


def is_answered(line: Line) -> bool:
    """Whether the drive serves a request in its mailbox now."""
    line.send_mail(3, UPLOAD_6061)
    line.wait(MS)
    return line.one(APRD, 0, 0x1080, 128).wkc == 1


# Mailbox


@pytest.mark.parametrize("way", ["INIT", "power"])
def test_the_mailbox_is_served_from_preop_on_and_never_in_init(way: str) -> None:
    """Its SyncManagers may be set up in INIT; nobody looks into them there."""
    line = Line()
    line.wait(MS)
    assert line.one(APWR, 0, 0x800, MAILBOXES).wkc == 1
    assert not is_answered(line)
    for _ in range(2):
        line.preop()
        assert is_answered(line)
        if way == "power":
            line.drive.power_off()
            line.drive.power_on()
            assert line.one(APWR, 0, 0x800, MAILBOXES).wkc == 1
        else:
            assert line.ask(INIT) == (INIT, 0)
        assert not is_answered(line)


def test_a_request_that_waits_for_its_answer_ends_with_the_state() -> None:
    """The drive looks at it 5 ms later; in INIT or after power it does not."""
    for is_power in (False, True):
        line = Line(profile=DriveProfile(sdo_answer_ns=5 * MS))
        line.preop()
        assert line.send_mail(3, UPLOAD_6061) == 1
        line.wait(2 * MS)
        if is_power:
            line.drive.power_off()
            line.drive.power_on()
        else:
            line.ask(INIT)
        line.preop()
        line.wait(20 * MS)
        assert line.one(APRD, 0, 0x1080, 128).wkc == 0
        assert line.send_mail(3, UPLOAD_6061) == 1
        line.wait(4 * MS)
        assert line.one(APRD, 0, 0x1080, 128).wkc == 0  # its own time is not over
        line.wait(2 * MS)
        assert line.one(APRD, 0, 0x1080, 128).wkc == 1


@pytest.mark.parametrize("number", [0, 2, 3])
def test_the_last_answer_is_repeated_by_its_own_mailbox_alone(number: int) -> None:
    """Bit 1 of the activation of another SyncManager asks for nothing."""
    line = Line()
    line.safeop()
    assert is_answered(line)
    for activation in (3, 1, 3):
        line.write(0x0806 + 8 * number, activation, 1)
        assert line.read(0x080F, 1) == 0
        assert line.one(APRD, 0, 0x1080, 128).wkc == 0
    line.write(0x080E, 3, 1)
    assert line.one(APRD, 0, 0x1080, 128).wkc == 1
    assert line.read(0x080F, 1) == 2


@pytest.mark.parametrize("number", [0, 1])
def test_a_mailbox_that_is_changed_ends_preop(number: int) -> None:
    line = Line()
    line.preop()
    line.write(0x0802 + 8 * number, 64, 2)
    assert line.al() == (INIT | ACK, 0x16)


# Ways up


def test_inputs_of_safeop_are_sampled_when_it_is_entered() -> None:
    """The axis moves at 20 mm/s all the time: the sample is as old as the state."""
    line = Line(motion=lambda time_s: 0.02 * time_s)
    per_mm = float(line.drive.profile.units_per_mm)
    line.preop()
    line.map_image()
    for _ in range(2):
        line.wait(50 * MS)
        line.write(0x0120, SAFEOP, 2)
        entered_s = line.clock.now_ns * 1e-9
        _, place = struct.unpack_from("<Hi", line.one(APRD, 0, 0x1C00, 16).data)
        # A frame takes some 10 us: 0.2 um
        assert place / per_mm == pytest.approx(20.0 * entered_s, abs=0.001)
        line.ask(PREOP)


@pytest.mark.parametrize("has_sync", [False, True])
def test_op_is_waited_for_without_outputs_as_long_as_it_takes(has_sync: bool) -> None:
    """The second after which 002D comes is that of SYNC0, which is there."""
    line = Line()
    line.preop()
    line.map_image()
    if has_sync:
        start_sync(line, MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    assert line.ask(OP) == (SAFEOP, 0)
    line.wait(3 * S)
    assert line.al() == (SAFEOP, 0)
    line.cycle()
    assert line.al() == (OP, 0)


def test_the_first_sync0_brings_op_where_outputs_were_there_before() -> None:
    line = Line()
    line.preop()
    line.map_image()
    start_sync(line, 20 * MS, after_ns=40 * MS)
    assert line.sdo_write(0x60C2, 1, 20, 1) == 0
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.cycle()
    assert line.ask(OP) == (SAFEOP, 0)
    assert line.drive.sync.pulses == 0
    line.clock.run_while(lambda: line.drive.sync.pulses == 0, 100 * MS)
    line.wait(10 * US)
    assert line.al() == (OP, 0)


@pytest.mark.parametrize("has_sync", [False, True])
def test_the_watchdog_runs_from_op_on_with_the_outputs_that_led_there(has_sync: bool) -> None:
    """No further outputs: 100 ms later SAFEOP with 001B."""
    line = Line(profile=DriveProfile(sync_loss_periods=0))
    line.preop()
    line.map_image()
    if has_sync:
        start_sync(line, MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.wait(10 * MS)
    line.cycle()
    assert line.ask(OP) == (OP, 0)
    assert line.read(0x0440, 2) == 1
    line.wait(95 * MS)
    assert line.al() == (OP, 0)
    line.wait(6 * MS)
    assert line.al() == (SAFEOP | ACK, 0x1B)


# Ways down


@pytest.mark.parametrize("state", [PREOP, INIT])
def test_below_safeop_the_drive_has_no_cycle(state: int) -> None:
    """Neither its own (free run) nor that of SYNC0 or of outputs; 1C32:01 is what was written."""
    for timing in (0, 1, 2):
        line = Line()
        line.preop()
        assert line.sdo_write(0x1C32, 1, timing, 2) == 0
        line.map_image()
        if timing == 2:
            start_sync(line, MS)
        assert line.ask(SAFEOP) == (SAFEOP, 0)
        line.wait(10 * MS)
        line.cycle()
        assert line.drive.cycle_clock.is_running
        line.ask(state)
        before = len(line.axes[0].commands)
        line.wait(20 * MS)
        if timing == 1:
            line.one(APWR, 0, 0x1800, bytes(8))
            line.wait(MS)
        assert len(line.axes[0].commands) == before
        line.preop()
        for wanted in (1, 0):
            assert line.sdo_write(0x1C32, 1, wanted, 2) == 0
            assert line.sdo_read(0x1C32, 1) == bytes((wanted, 0))


def test_what_6007_says_counts_where_op_is_left_and_not_below() -> None:
    """0 let the drive move on in SAFEOP; another value that comes there acts at no way down."""
    line = Line()
    line.preop()
    assert line.sdo_write(0x6007, 0, 0, 2) == 0
    line.map_image()
    line.ask(SAFEOP)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.enable()
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    assert line.drive.state is State.OPERATION_ENABLED
    assert line.sdo_write(0x6007, 0, 1, 2) == 0
    assert line.ask(PREOP) == (PREOP, 0)
    assert line.drive.state is State.OPERATION_ENABLED
    assert line.drive.image.error_code == 0


def test_outputs_of_safeop_act_on_nothing() -> None:
    """Those of OP are kept: what came last there."""
    line = Line()
    line.op()
    line.cycle(0x06, 77)
    assert (line.drive.image.controlword, line.drive.image.target_position) == (0x06, 77)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    for _ in range(2):
        line.cycle(0x07, 1234)
        line.wait(MS)
    assert (line.drive.image.controlword, line.drive.image.target_position) == (0x06, 77)


def test_a_sample_that_was_planned_is_not_taken_below_safeop() -> None:
    """3 ms after the outputs; SAFEOP ends before."""
    line = Line(
        motion=lambda time_s: 0.1 * time_s, settings=[SlaveSettings(serial=1, sample_ns=3 * MS)]
    )
    line.preop()
    assert line.sdo_write(0x60C2, 1, 10, 1) == 0
    line.map_image()
    line.ask(SAFEOP)
    line.cycle()
    line.wait(MS)
    line.ask(PREOP)
    before = line.one(APRD, 0, 0x1C00, 16).data
    line.wait(10 * MS)
    assert line.one(APRD, 0, 0x1C00, 16).data == before


# The clock


def test_sync0_that_is_off_and_on_within_a_frame_is_there() -> None:
    line = Line()
    line.preop()
    line.map_image()
    start_sync(line, MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.wait(10 * MS)
    line.cycle()
    assert line.ask(OP) == (OP, 0)
    start = (line.drive.time.system_ns(line.clock.now_ns) + 2 * MS).to_bytes(8, "little")
    line.exchange(
        physical(APWR, 0, 0x0981, b"\x00"),
        physical(APWR, 0, 0x0990, start),
        physical(APWR, 0, 0x0981, b"\x03"),
    )
    line.wait(US)
    assert line.al() == (OP, 0)
    line.write(0x0981, 0, 1)
    assert line.al() == (SAFEOP | ACK, 0x2C)


@pytest.mark.parametrize("drift_ppm", [50_000.0, -50_000.0, 0.0])
@pytest.mark.parametrize("sample_ns", [400_000, -400_000])
def test_a_sample_comes_its_time_after_sync0_by_the_clock_of_the_slave(
    drift_ppm: float, sample_ns: int
) -> None:
    """A clock that is 5 % fast shows 400 us after 381 us: at 50 mm/s 0.95 um less."""
    line = Line(
        motion=lambda time_s: 0.05 * time_s,
        settings=[SlaveSettings(serial=1, drift_ppm=drift_ppm, sample_ns=sample_ns)],
    )
    line.preop()
    line.map_image()
    start_sync(line, MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.wait(10 * MS)
    pulses = line.drive.sync.pulses
    line.clock.run_while(lambda: line.drive.sync.pulses == pulses, 10 * MS)
    pulse_ns = line.clock.now_ns
    line.wait(900 * US)
    _, place = struct.unpack_from("<Hi", line.one(APRD, 0, 0x1C00, 16).data)
    after_ns = sample_ns % MS / (1 + drift_ppm * 1e-6)
    per_mm = float(line.drive.profile.units_per_mm)
    assert place == pytest.approx(0.05e-6 * (pulse_ns + after_ns) * per_mm, abs=0.51)


@pytest.mark.parametrize("tick_us", [250, 500])
def test_the_least_cycle_is_the_tick_of_the_drive(tick_us: int) -> None:
    """1C32:05 says so, and SYNC0 of so much is accepted where 60C2 is the same."""
    line = Line(profile=DriveProfile(tick_ns=tick_us * US))
    line.preop()
    for index in (0x1C32, 0x1C33):
        assert line.sdo_read(index, 5) == struct.pack("<I", tick_us * US)
    for sub, value in ((1, tick_us // 10), (2, -5)):
        assert line.sdo_write(0x60C2, sub, value, 1) == 0
    line.map_image()
    start_sync(line, tick_us * US)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.wait(10 * MS)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.cycle()
    assert line.al() == (OP, 0)


# Power


def test_power_takes_events_that_nobody_has_read() -> None:
    line = Line()
    line.wait(MS)
    line.write(0x0200, 1 << 3, 2)
    line.write(0x0120, OP, 2)  # refused: AL status has changed
    assert line.one(APRD, 0, 0, 1).events == 1 << 3
    line.drive.power_off()
    line.drive.power_on()
    line.write(0x0200, 1 << 3, 2)
    assert line.one(APRD, 0, 0, 1).events == 0


def test_power_takes_the_areas_of_the_sync_managers() -> None:
    """What was a mailbox, outputs and inputs is memory again."""
    line = Line()
    line.safeop()
    line.drive.power_off()
    line.drive.power_on()
    for address in (0x1000, 0x1080, 0x1800, 0x1C00):
        assert line.one(APWR, 0, address + 1, b"\x5a\xa5").wkc == 1
        assert line.one(APRD, 0, address, 3).data == b"\x00\x5a\xa5"
    assert line.drive.managers[0].is_enabled is False


def test_power_that_is_there_or_gone_already_changes_nothing() -> None:
    """On in OP: it stays there, and the drive goes on. Off twice: one boot follows."""
    line = Line()
    line.op()
    line.enable()
    line.drive.power_on()
    assert line.al() == (OP, 0)
    assert line.drive.state is State.OPERATION_ENABLED
    for _ in range(2):
        line.drive.power_off()
        assert line.drive.state is State.SWITCH_ON_DISABLED
    for _ in range(2):
        line.drive.power_on()
        line.preop()
