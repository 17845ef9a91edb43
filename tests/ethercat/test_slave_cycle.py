"""The cycle of a drive on EtherCAT: SYNC0, outputs of a frame, free run; instants of its values."""

import struct
from itertools import pairwise

import pytest
from tests.ethercat.line import ACK, OP, PREOP, SAFEOP, Line, physical
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US, S


def in_sync(cycle_ns: int = MS, value: int = 1, index: int = -3, **kinds: object) -> Line:
    """A drive in SAFEOP whose clock is SYNC0."""
    line = Line(**kinds)  # type: ignore[arg-type]
    line.preop()
    assert line.sdo_write(0x60C2, 1, value, 1) == 0
    assert line.sdo_write(0x60C2, 2, index, 1) == 0
    line.map_image()
    start_sync(line, cycle_ns)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    return line


@pytest.mark.parametrize(
    ("cycle_ns", "value", "index", "code"),
    [
        (MS, 1, -3, 0),
        (2 * MS, 20, -4, 0),
        (500_000, 5, -4, 0),
        (2 * MS, 1, -3, 0x35),
        (MS, 2, -3, 0x35),
        (200_000, 2, -4, 0x36),
        (1_000_001, 1, -3, 0x35),
    ],
)
def test_60c2_agrees_with_sync0_or_the_drive_stays_in_safeop(
    cycle_ns: int, value: int, index: int, code: int
) -> None:
    line = in_sync(cycle_ns, value, index)
    line.wait(10 * MS)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.cycle()
    line.wait(5 * MS)
    assert line.al() == ((SAFEOP | 0x10, code) if code else (OP, 0))


@pytest.mark.parametrize(("activation", "cycle_ns"), [(3, 0), (0, MS)])
def test_sync0_as_clock_without_sync0_or_without_its_cycle(activation: int, cycle_ns: int) -> None:
    line = Line()
    line.preop()
    assert line.sdo_write(0x1C32, 1, 2, 2) == 0
    line.map_image()
    line.write(0x09A0, cycle_ns, 4)
    line.write(0x0981, activation, 1)
    assert line.ask(SAFEOP) == (PREOP | 0x10, 0x30)


def test_sync0_that_does_not_begin_ends_the_way_to_op() -> None:
    line = Line()
    line.preop()
    line.map_image()
    line.wait(10 * MS)
    start_sync(line, MS, after_ns=-5 * MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.cycle()
    line.wait(999 * MS)
    assert line.al() == (SAFEOP, 0)
    line.wait(2 * MS)
    assert line.al() == (SAFEOP | 0x10, 0x2D)


def test_sync0_that_ends_in_op_is_fatal() -> None:
    line = in_sync()
    line.wait(10 * MS)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.cycle()
    line.wait(2 * MS)
    assert line.al() == (OP, 0)
    line.write(0x0981, 0, 1)
    assert line.al() == (SAFEOP | 0x10, 0x2C)


@pytest.mark.parametrize(("limit", "missing", "state"), [(3, 2, OP), (3, 3, SAFEOP), (0, 50, OP)])
def test_outputs_that_stay_away_for_so_many_sync0(limit: int, missing: int, state: int) -> None:
    line = in_sync(profile=DriveProfile(sync_loss_periods=limit))
    line.wait(10 * MS)
    for _ in range(6):
        line.cycle()
        line.write(0x0120, OP, 2)
        line.wait(MS - 2 * 60 * US)
    assert line.al() == (OP, 0)
    assert line.sdo_read(0x1C32, 32) == b"\x00"
    missed = line.drive.cycle_clock.missed
    pulses = line.drive.sync.pulses
    line.cycle()
    line.clock.run_while(lambda: line.drive.sync.pulses < pulses + 1 + missing, 100 * MS)
    line.wait(1)
    assert line.drive.cycle_clock.missed - missed == missing
    assert line.al() == ((OP, 0) if state == OP else (SAFEOP | 0x10, 0x1A))
    if state == OP:
        assert line.sdo_read(0x1C32, 32) == b"\x01"


def follow(line: Line, period_ns: int, step: int, cycles: int = 20) -> list[tuple[int, int]]:
    """Ramp of target positions; instant of each frame's end and the position it brought."""
    seen = []
    begin_ns = line.clock.now_ns
    for n in range(1, cycles + 1):
        line.clock.run_until(begin_ns + n * period_ns)
        position = line.cycle(0x0F, n * step)[1]
        seen.append((line.clock.now_ns, position))
    return seen


def ready(line: Line, period_ns: int) -> None:
    """To OP and operation enabled, frames half a period behind SYNC0."""
    line.wait(10 * MS)
    line.cycle()
    line.write(0x0120, OP, 2)
    pulses = line.drive.sync.pulses
    if line.drive.sync.has_sync0:
        line.clock.run_while(lambda: line.drive.sync.pulses == pulses, 100 * MS)
        line.wait(period_ns // 2)
    line.enable(period_ns)
    assert line.drive.state is State.OPERATION_ENABLED


def test_with_sync0_a_set_position_is_reached_one_cycle_after_its_sync0() -> None:
    line = in_sync(2 * MS, 2)
    ready(line, 2 * MS)
    step = 100_000
    seen = follow(line, 2 * MS, step)
    # Target n is taken at the SYNC0 behind frame n and reached at the next one; what frame n+2
    # brings was sampled there
    steady = [position for _, position in seen[5:]]
    assert [b - a for a, b in pairwise(steady)] == [step] * (len(steady) - 1)
    assert seen[10][1] == pytest.approx((10 + 1 - 2) * step, abs=1)
    line.ask(SAFEOP | ACK)


def test_with_the_outputs_a_set_position_is_taken_at_the_end_of_its_frame() -> None:
    line = Line()
    line.preop()
    line.map_image()
    line.ask(SAFEOP)
    ready(line, MS)
    step = 50_000
    seen = follow(line, MS, step)
    # Sampled behind frame n, shown by frame n+1: what was to be reached by n, of target n-1
    assert seen[10][1] == pytest.approx((10 + 1 - 2) * step, abs=1)
    assert line.sdo_read(0x1C33, 1) == b"\x22\x00"


def test_in_free_run_the_drive_has_its_own_cycle_of_60c2() -> None:
    line = Line()
    line.preop()
    assert line.sdo_write(0x1C32, 1, 0, 2) == 0
    assert line.sdo_write(0x60C2, 1, 4, 1) == 0
    line.map_image()
    line.ask(SAFEOP)
    before = len(line.axes[0].commands)
    line.wait(50 * MS)
    instants = [command.time_ns for command in line.axes[0].commands[before:]]
    assert len(instants) == 12
    assert {b - a for a, b in pairwise(instants)} == {4 * MS}
    assert line.sdo_read(0x1C32, 1) == b"\x00\x00"
    assert line.sdo_read(0x1C32, 2) == struct.pack("<I", 4 * MS)


@pytest.mark.parametrize("sample_ns", [0, 250_000, -300_000])
def test_inputs_are_those_of_the_instant_at_which_they_are_sampled(sample_ns: int) -> None:
    """50 mm/s: 250 us after SYNC0 are 12.5 um, 300 us before the next one 35.0 um."""
    line = in_sync(
        motion=lambda time_s: 0.05 * time_s,
        settings=[SlaveSettings(drift_ppm=0.0, sample_ns=sample_ns)],
    )
    line.wait(10 * MS)
    pulse_ns = line.drive.sync.next0
    line.clock.run_until(pulse_ns + MS - 10 * US)  # just before the next SYNC0
    position = line.cycle()[1]
    after_ns = sample_ns % MS
    per_mm = float(line.drive.profile.units_per_mm)
    assert position == pytest.approx(0.05e-6 * (pulse_ns + after_ns) * per_mm, abs=0.51)


def test_a_time_stamp_is_the_system_time_of_the_edge() -> None:
    """60D1 in ns of the slave's copy, 32 bits of it; the latch is where the axis was there."""
    edge_ns = 30 * MS + 123_456
    start_ns = 5 * 2**32 - 31 * MS  # wraps 31 ms after the start, behind the edge
    line = Line(
        settings=[SlaveSettings(start_ns=start_ns, drift_ppm=100.0)],
        motion=lambda time_s: 0.05 * time_s,
        edges_ns=[edge_ns],
        profile=DriveProfile(input_delay_ns=0),
    )
    line.op()
    line.enable()
    for _ in range(60):
        line.cycle(0x0F, 0, 0x0011)
        line.wait(MS)
    assert line.cycle(0x0F, 0, 0x0011)[2] == 0x0003
    (stamp,) = struct.unpack("<I", line.sdo_read(0x60D1, 0))
    assert stamp == (start_ns + edge_ns + edge_ns // 10_000) % 2**32
    (position,) = struct.unpack("<i", line.sdo_read(0x60BA, 0))
    assert position == round(0.05 * edge_ns / S * 1e3 * float(line.drive.profile.units_per_mm))


def test_frames_go_together() -> None:
    """Position and state of all slaves in one frame: what a control reads each cycle."""
    line = Line(2)
    line.preop()
    line.preop(1)
    line.map_image(0)
    line.map_image(1, logical=24)
    for n in range(2):
        assert line.ask(SAFEOP, n) == (SAFEOP, 0)
    both = line.exchange((12, 0, bytes(48)), physical(7, 0, 0x0130, 2))
    assert [answer.wkc for answer in both] == [6, 2]
    assert both[1].number == SAFEOP


def test_a_sample_gives_way_to_the_next_cycle() -> None:
    """700 us after each outputs; where these come each 500 us, only the last one is sampled so."""
    line = Line(
        motion=lambda time_s: 0.1 * time_s, settings=[SlaveSettings(serial=1, sample_ns=700 * US)]
    )
    line.op()
    line.wait(5 * MS)
    samples: list[int] = []
    refresh = line.drive.servo.refresh

    def note(now_ns: int, *, is_apart: bool = False) -> None:
        if is_apart:
            samples.append(now_ns)
        refresh(now_ns, is_apart=is_apart)

    line.drive.servo.refresh = note  # type: ignore[method-assign]
    for _ in range(4):
        line.cycle()
        line.wait(500 * US)
    assert samples == []
    line.wait(2 * MS)
    (only_ns,) = samples
    latest = line.drive.managers[3].latest
    shown_um = int.from_bytes(latest[2:6], "little", signed=True) / 104.8576
    assert shown_um == pytest.approx(0.1 * only_ns * 1e-3, abs=0.5 / 104.8576 + 1e-9)
