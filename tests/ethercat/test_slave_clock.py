"""Distributed clocks: local time, delays, offset, control of the clock, SYNC signals, latches."""

import struct
from itertools import pairwise

import pytest
from tests.ethercat.line import Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.bus.ethercat.segment import Link
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.sync_unit import SyncUnit
from axisrig.kernel.time.clock import MS, US, S
from axisrig.kernel.time.scheduler import new_scheduler

APRD, APWR, BWR, FRMW = 1, 2, 8, 14
LINKS = [Link(50, 300, 300), Link(75, 300, 300), Link(500, 300, 300)]


def settings(*drifts: float) -> list[SlaveSettings]:
    return [SlaveSettings(n, start_ns=n * 7 * S + 123, drift_ppm=d) for n, d in enumerate(drifts)]


def test_receive_times_give_the_delays_of_the_line() -> None:
    """Of each pair half of the difference of what the frame needed behind each of them."""
    line = Line(3, LINKS, settings(0.0, 0.0, 0.0))
    line.one(BWR, 0, 0x0900, bytes(4))
    times = [struct.unpack("<II", line.one(APRD, -n, 0x0900, 8).data) for n in range(3)]
    behind = [(second - first) % 2**32 if second else 0 for first, second in times]
    assert behind[2] == 0
    assert [second == 0 for _, second in times] == [False, False, True]  # nothing at its port 1
    # A slave forwards in 300 ns; wires of 75 and 500 ns
    assert [(behind[n] - behind[n + 1]) / 2 for n in (0, 1)] == [375.0, 800.0]
    units = [line.one(APRD, -n, 0x0918, 8).number for n in range(3)]
    assert [unit & 0xFFFF_FFFF for unit in units] == [first for first, _ in times]
    # Local times: 0, 7 and 14 s and 123 ns apart from the begin of the frame at each
    assert units[1] - units[0] == 7 * S + 375
    assert units[2] - units[0] == 14 * S + 375 + 800


def set_up(line: Line, delay_ns: tuple[int, ...], offsets: bool = True) -> None:
    """Stations, and the system time of the first slave in all of them."""
    for n in range(len(line.drives)):
        line.write(0x0010, 0x1001 + n, 2, n)
    line.one(BWR, 0, 0x0900, bytes(4))
    local = [line.one(APRD, -n, 0x0918, 8).number for n in range(len(line.drives))]
    for n, delay in enumerate(delay_ns):
        if offsets:
            offset = local[0] + delay - local[n] & (1 << 64) - 1
            line.one(APWR, -n, 0x0920, struct.pack("<Q", offset))
        line.write(0x0928, delay, 4, n)


def error_ns(line: Line, number: int) -> int:
    """How far a slave's copy is ahead of the first one's now."""
    now_ns = line.clock.now_ns
    return line.drives[number].time.system_ns(now_ns) - line.drives[0].time.system_ns(now_ns)


def run(line: Line, cycles: int, period_ns: int = MS) -> list[int]:
    """FRMW each period; the error of the second slave before each of them."""
    errors = []
    begin_ns = line.clock.now_ns
    for n in range(1, cycles + 1):
        line.clock.run_until(begin_ns + n * period_ns)
        errors.append(error_ns(line, 1))
        line.one(FRMW, 0x1001, 0x0910, 8)
    return errors


def test_offset_and_delay_make_all_copies_equal() -> None:
    line = Line(3, LINKS, settings(0.0, 0.0, 0.0))
    set_up(line, (0, 375, 1175))
    assert [error_ns(line, n) for n in range(3)] == [0, 0, 0]
    line.one(FRMW, 0x1001, 0x0910, 8)
    assert [line.read(0x092C, 4, n) for n in (1, 2)] == [1 << 31, 1 << 31]


def test_a_delay_that_was_not_written_is_what_the_copy_is_wrong_by() -> None:
    line = Line(2, [Link(), Link(10_000 - 300)], settings(0.0, 0.0))
    set_up(line, (0, 10_000))
    line.write(0x0928, 0, 4, 1)
    errors = run(line, 400)
    # It follows the frame, which is 10 us old: at 50 mm/s 0.5 um
    assert errors[-1] == -10_000


@pytest.mark.parametrize("drift_ppm", [100.0, -100.0, 0.0])
@pytest.mark.parametrize("static_ns", [50_000, -50_000, 0])
def test_a_clock_that_follows_is_within_what_it_drifts_between_two_frames(
    drift_ppm: float, static_ns: int
) -> None:
    line = Line(2, [Link(), Link(75)], settings(0.0, drift_ppm))
    set_up(line, (0, 375))
    offset = line.one(APRD, -1, 0x0920, 8).number
    line.one(APWR, -1, 0x0920, struct.pack("<Q", offset + static_ns & (1 << 64) - 1))
    errors = run(line, 500)
    assert max(map(abs, errors[200:])) <= 10 + 100  # 10 ns and 100 ppm of 1 ms
    assert max(map(abs, errors[400:])) <= 2  # it has learned the rate


def test_a_clock_that_jumps_is_led_back_by_a_tenth_of_the_time_at_most() -> None:
    line = Line(2, [Link(), Link(75)], settings(0.0, 0.0))
    set_up(line, (0, 375))
    run(line, 5)
    line.drives[1].jump(700 * US)
    errors = run(line, 60)
    assert errors[0] == 700 * US
    steps = [before - after for before, after in pairwise(errors)]
    # The period and, the first time, the frame
    assert max(steps) <= 101 * US
    assert steps[1:5] == [100 * US] * 4
    assert max(map(abs, errors[50:])) <= 10


@pytest.mark.parametrize("jump_us", [700, -700])
def test_a_clock_that_was_led_back_goes_on_at_its_own_rate(jump_us: int) -> None:
    """What a step was cut off by says nothing of the rate: a clock that never drifted does not."""
    line = Line(2, [Link(), Link(75)], settings(0.0, 0.0))
    set_up(line, (0, 375))
    run(line, 5)
    line.drives[1].jump(jump_us * US)
    assert max(map(abs, run(line, 60)[50:])) <= 10
    before = error_ns(line, 1)
    line.wait(S)
    assert abs(error_ns(line, 1) - before) <= 2000  # 2 ppm


def test_a_clock_that_does_not_follow_drifts() -> None:
    line = Line(2, settings=settings(0.0, 100.0))
    set_up(line, (0, 350))
    before = error_ns(line, 1)
    line.wait(10 * S)
    assert error_ns(line, 1) - before == 1_000_000  # 100 ppm of 10 s: 50.0 um at 50 mm/s


def test_many_frames_at_start_take_a_static_error_away() -> None:
    """As a master does: 15 000 in a row; here as many as it takes, 20 us apart."""
    line = Line(2, settings=settings(0.0, 0.0))
    set_up(line, (0, 350))
    offset = line.one(APRD, -1, 0x0920, 8).number
    line.one(APWR, -1, 0x0920, struct.pack("<Q", offset + 100_000))
    errors = run(line, 300, 20 * US)
    assert errors[0] == 100_000
    assert abs(errors[-1]) <= 2
    # Never by more than a tenth of the time that has passed
    assert max(abs(b - a) for a, b in pairwise(errors[1:])) <= 4 * US


@pytest.mark.parametrize(("ahead_ns", "shown"), [(0, 1 << 31), (7, 7 | 1 << 31), (-7, 7)])
def test_the_difference_is_sign_and_amount(ahead_ns: int, shown: int) -> None:
    clock = DistributedClock(LocalClock())
    clock.follow(1000 - ahead_ns, 64, 1000)
    assert clock.difference == shown


def test_a_time_of_32_bits_is_compared_with_the_low_half() -> None:
    clock = DistributedClock(LocalClock(start_ns=5 * 2**32 - 10))
    clock.follow(3, 32, 20)  # the copy shows 10, a wrap ago it was below
    assert clock.difference == 7 | 1 << 31


def test_the_instant_of_a_time_is_the_first_one_that_shows_it() -> None:
    for drift in (0.0, 100.0, -100.0, 33.333):
        clock = DistributedClock(LocalClock(17, drift))
        for system in (18, 1_000_000, 123_456_789, 10**12):
            at_ns = clock.instant_ns(system, 0)
            assert clock.system_ns(at_ns) >= system
            assert clock.system_ns(at_ns - 1) < system


@pytest.mark.parametrize("drift_ppm", [0.0, 80.0, -80.0])
def test_sync0_comes_at_its_instants_of_the_system_time(drift_ppm: float) -> None:
    line = Line(settings=[SlaveSettings(start_ns=999_999, drift_ppm=drift_ppm)])
    seen: list[int] = []
    line.drive.sync._sync0 = lambda: seen.append(line.clock.now_ns)
    first = start_sync(line, 2 * MS)
    assert line.read(0x0984, 1) == 1
    line.wait(21 * MS)
    assert line.read(0x0984, 1) == 0
    shown = [line.drive.time.system_ns(at_ns) for at_ns in seen]
    assert len(shown) >= 8
    assert all(0 <= at - (first + n * 2 * MS) <= 1 for n, at in enumerate(shown))
    assert line.one(APRD, 0, 0x0990, 8).number == first + len(shown) * 2 * MS
    line.write(0x0981, 0, 1)
    count = len(seen)
    line.wait(10 * MS)
    assert len(seen) == count


def test_sync0_follows_a_clock_that_is_corrected() -> None:
    line = Line(2, settings=settings(0.0, 100.0))
    set_up(line, (0, 350))
    seen: list[int] = []
    line.drives[1].sync._sync0 = lambda: seen.append(line.clock.now_ns)
    run(line, 300)
    now = line.one(APRD, 0, 0x0910, 8).number
    first = (now // MS + 5) * MS
    line.one(APWR, -1, 0x0990, struct.pack("<Q", first))
    line.write(0x09A0, MS, 4, 1)
    line.write(0x0981, 3, 1, 1)
    run(line, 100)
    # At the first slave's time, for that is what its clock follows
    shown = [line.drives[0].time.system_ns(at_ns) for at_ns in seen]
    assert len(shown) > 90
    assert all(abs(at - (first + n * MS)) <= 3 for n, at in enumerate(shown))


def test_a_clock_that_is_put_forward_has_no_pulses_of_what_it_left_out() -> None:
    line = Line()
    seen: list[int] = []
    line.drive.sync._sync0 = lambda: seen.append(line.clock.now_ns)
    start_sync(line, MS)
    line.wait(10 * MS)
    count = len(seen)
    line.one(APWR, 0, 0x0920, struct.pack("<Q", 3600 * S + 400_000))
    line.wait(10 * MS)
    assert 10 <= len(seen) - count <= 11
    assert {b - a for a, b in pairwise(seen[count + 1 :])} == {MS}
    # Still on its grid
    first, last = line.drive.time.system_ns(seen[0]), line.drive.time.system_ns(seen[-1])
    assert (last - first - 3600 * S) % MS in (0, 400_000, 600_000)


def test_sync1_comes_its_time_after_sync0() -> None:
    line = Line()
    seen: list[tuple[int, int]] = []
    line.drive.sync._sync0 = lambda: seen.append((0, line.clock.now_ns))
    line.drive.sync._sync1 = lambda: seen.append((1, line.clock.now_ns))
    line.write(0x09A4, 300_000, 4)
    start_sync(line, MS, activation=7)
    line.wait(8 * MS)
    assert [kind for kind, _ in seen[:4]] == [0, 1, 0, 1]
    assert seen[1][1] - seen[0][1] == 300_000


@pytest.mark.parametrize(("activation", "before", "between"), [(3, 1, 0), (7, 3, 2)])
def test_each_signal_is_pending_until_its_first_pulse(
    activation: int, before: int, between: int
) -> None:
    """0984: bit 0 of SYNC0, bit 1 of SYNC1, 300 us later; each activation begins anew."""
    line = Line()
    line.write(0x09A4, 300_000, 4)
    for _ in range(2):
        first = start_sync(line, MS, activation=activation)
        assert line.read(0x0984, 1) == before
        left_ns = first - line.drive.time.system_ns(line.clock.now_ns)
        line.wait(left_ns + 100_000)
        assert line.read(0x0984, 1) == between
        line.wait(300_000)
        assert line.read(0x0984, 1) == 0
        line.write(0x0980, 0, 2)
        assert line.read(0x0984, 1) == 0


@pytest.mark.parametrize(("cycle_ns", "after_ns"), [(MS, -5 * MS), (9_999, MS)])
def test_a_start_time_that_has_passed_gives_no_pulse_and_says_so(
    cycle_ns: int, after_ns: int
) -> None:
    """A cycle that is too short as well."""
    line = Line()
    seen: list[int] = []
    line.drive.sync._sync0 = lambda: seen.append(line.clock.now_ns)
    line.wait(10 * MS)
    start_sync(line, cycle_ns, after_ns=after_ns)
    line.wait(10 * MS)
    assert (seen, line.read(0x0984, 1)) == ([], 4)


# Latch unit

EDGES = [10 * MS, 12 * MS, 14 * MS, 16 * MS]


@pytest.mark.parametrize(("control", "stamps", "status"), [(0, (14, 16), 0), (3, (10, 12), 3)])
def test_latches_keep_the_last_edge_or_the_first_one(
    control: int, stamps: tuple[int, int], status: int
) -> None:
    line = Line(settings=[SlaveSettings(start_ns=5000)], edges_ns=EDGES)
    line.write(0x09A8, control, 1)
    line.wait(20 * MS)
    assert line.read(0x09AE, 1) == status
    positive, negative = struct.unpack("<QQ", line.one(APRD, 0, 0x09B0, 16).data)
    assert (positive - 5000, negative - 5000) == tuple(stamp * MS for stamp in stamps)
    assert line.read(0x09AE, 1) == 0


def test_each_activation_counts_its_own_pulses() -> None:
    """A master waits for the first one after each; what was pending ends with the activation."""
    clock, came = new_scheduler(), list[int]()
    unit = SyncUnit(
        clock, DistributedClock(LocalClock()), lambda: came.append(clock.now_ns), lambda: None
    )
    unit.cycle0 = MS
    for begin_ns in (5 * MS, 50 * MS):
        unit.start = begin_ns
        unit.activate(3)
        assert (unit.has_sync0, unit.pulses, unit.status) == (True, 0, 1)
        clock.run_until(begin_ns - 1)
        assert unit.pulses == 0
        clock.run_until(begin_ns + 2 * MS)
        assert (unit.pulses, unit.status) == (3, 0)
        unit.activate(0)
        assert (unit.has_sync0, unit.pulses) == (False, 0)
        clock.run_until(begin_ns + 20 * MS)
    assert came == [5 * MS, 6 * MS, 7 * MS, 50 * MS, 51 * MS, 52 * MS]
    unit.start = 100 * MS
    unit.activate(3)
    unit.activate(0)
    clock.run_until(200 * MS)
    assert len(came) == 6
