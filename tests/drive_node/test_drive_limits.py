"""Limits in csp, csv and cst, offsets, interpolation time, and scaling that acts on the bus."""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.limits import NEGATIVE_END, POSITIVE_END
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
PER_M = 104_857_600
LIMITED, FOLLOWS = 1 << 11, 1 << 12


def status(bench: Any) -> int:
    return int.from_bytes(bench.frames(0x183)[-1][:2], "little")


def velocity(bench: Any) -> float:
    return float(bench.axis.commands[-1].velocity_m_s)


@pytest.mark.parametrize(("target_m", "stop_m"), [(0.003, 0.002), (-0.003, -0.001)])
def test_csp_stops_at_the_software_limits(
    drive_bench: Make, target_m: float, stop_m: float
) -> None:
    bench = drive_bench()
    bench.remote.sdo[0x607D][1].raw = round(-0.001 * PER_M)
    bench.remote.sdo[0x607D][2].raw = round(0.002 * PER_M)
    bench.operational(4)
    bench.enable(5)
    for n in range(1, 4):
        bench.set_values(0x0F, round(target_m * PER_M * n / 3))
        bench.sync_at_ms(8 + n)
    assert status(bench) & (LIMITED | FOLLOWS) == LIMITED
    bench.sync_at_ms(12)
    bench.axis.advance_to(12_900_000)
    assert bench.axis.motor_position_m() == pytest.approx(stop_m, abs=1e-8)
    bench.set_values(0x0F, 0)
    bench.sync_at_ms(13)
    assert status(bench) & (LIMITED | FOLLOWS) == FOLLOWS


def test_an_offset_that_stands_moves_nothing_when_operation_is_enabled(drive_bench: Make) -> None:
    """607A takes it into account: target and offset together are where the axis is."""
    bench = drive_bench()
    bench.remote.sdo[0x60B0].raw = 5000
    bench.operational(4)
    for word in (0x06, 0x07, 0x0F):
        bench.remote.sdo[0x6040].raw = word
    for n in range(3):
        bench.sync_at_ms(10 + n)
        assert bench.remote.sdo[0x6064].raw == 0
    assert bench.remote.sdo[0x607A].raw == -5000


def test_a_mode_that_begins_long_after_the_last_sync_begins_at_rest(drive_bench: Make) -> None:
    """10 um per ms until SYNCs stay away: the demand has ended and pp has nothing to brake."""
    bench = drive_bench()
    bench.operational(4)
    bench.enable(5)
    for n in range(1, 4):
        bench.set_values(0x0F, n * 1048)
        bench.sync_at_ms(8 + n)
    bench.run_to_ms(30)
    bench.remote.sdo[0x6060].raw = 1
    bench.run_to_ms(200)
    assert bench.remote.sdo[0x6061].raw == 1
    assert bench.remote.sdo[0x6064].raw == 3 * 1048


def test_csp_and_csv_keep_below_the_motor_speed(drive_bench: Make) -> None:
    """60 rev/min of a 10 mm screw: 10 mm/s; csp catches up afterwards."""
    bench = drive_bench()
    bench.remote.sdo[0x6080].raw = 60
    bench.operational(4)
    bench.enable(5)
    for n in range(5):
        bench.set_values(0x0F, round(20e-6 * PER_M))
        bench.sync_at_ms(9 + n)
        moved_m = min(20e-6, n * 10e-6)
        assert bench.axis.commands[-1].position_m == pytest.approx(moved_m, abs=1e-8)
        assert bool(status(bench) & LIMITED) == (n == 0)
    bench.remote.sdo[0x60FF].raw = round(-0.05 * PER_M)
    bench.remote.sdo[0x6060].raw = 9
    bench.sync_at_ms(20)
    bench.sync_at_ms(21)
    bench.axis.advance_to(21 * MS + 800_000)
    assert bench.axis.demand_velocity_m_s() == pytest.approx(-0.01)


def test_overspeed_in_cst_is_a_fault(drive_bench: Make, fake_axis: Any) -> None:
    """69 N on 100 kg: 0.69 m/s2; 60 rev/min = 10 mm/s are passed 14.5 ms after the force."""
    bench = drive_bench()
    sdo = bench.remote.sdo
    sdo[0x6060].raw, sdo[0x6071].raw, sdo[0x6080].raw, sdo[0x605E].raw = 10, 50, 60, 0
    bench.operational(8)
    bench.enable(9)
    bench.sync_at_ms(12)
    force = next(c for c in bench.axis.commands if c.force_n)
    passed_ns = force.time_ns + round(0.01 / (force.force_n / 100.0) * 1e9)
    for k in range(13, 40):
        bench.sync_at_ms(k)
        if bench.node.state is not State.OPERATION_ENABLED:
            break
    assert k == passed_ns // MS
    bench.run_to_ms(k + 1)
    assert bench.frames(0x083)[0][:3] == bytes.fromhex("008421")


def test_position_offset_is_added_to_the_target(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.remote.sdo[0x60B0].raw = 500
    bench.operational(4)
    bench.enable(5)
    bench.set_values(0x0F, 1000)
    bench.sync_at_ms(9)
    assert velocity(bench) == pytest.approx(1500 / PER_M / 1e-3)


Period = tuple[int, int, int, int]
# (index, sub-index, value, bytes) that a master writes, in its order; time from target to target
PERIODS: list[tuple[list[Period], int]] = [
    ([], 1_000_000),  # 1006 is 0: 60C2 has 1 ms
    ([(0x1006, 0, 4000, 4)], 4_000_000),
    ([(0x60C2, 1, 100, 1)], 100_000_000),
    ([(0x60C2, 1, 25, 1), (0x60C2, 2, -4, 1)], 2_500_000),
    ([(0x60C2, 1, 25, 1), (0x60C2, 2, -4, 1), (0x1006, 0, 4000, 4)], 2_500_000),
    ([(0x1006, 0, 4000, 4), (0x60C2, 2, -2, 1)], 10_000_000),
    ([(0x1006, 0, 4000, 4), (0x60C2, 1, 1, 1)], 1_000_000),  # its default, but written
]


def interpolation_ns(bench: Any, mode: int = 8) -> int:
    """Let the drive take a new target; return over which time it goes there."""
    bench.remote.sdo[0x6060].raw = mode
    bench.operational(bench.scheduler.now_ns // MS + 2)
    bench.enable(bench.scheduler.now_ns // MS + 2)
    bench.set_values(0x0F, 1000)
    bench.remote.sdo[0x60FF].raw = 1000
    bench.sync_at_ms(bench.scheduler.now_ns // MS + 1)
    last = bench.axis.commands[-1]
    return int(last.end_ns - last.time_ns)


def write_all(bench: Any, writes: list[Period]) -> None:
    for index, sub, value, size in writes:
        data = value.to_bytes(size, "little", signed=value < 0)
        bench.remote.sdo.download(index, sub, data)


@pytest.mark.parametrize("mode", [8, 9])
@pytest.mark.parametrize(("writes", "expected_ns"), PERIODS)
def test_the_interpolation_time_is_60c2_once_written_and_1006_before(
    drive_bench: Make, writes: list[Period], expected_ns: int, mode: int
) -> None:
    bench = drive_bench()
    write_all(bench, writes)
    assert interpolation_ns(bench, mode) == expected_ns


@pytest.mark.parametrize(
    ("stores", "command", "expected_ns"),
    [
        (False, 129, 4_000_000),  # reset node: no master has written 60C2 since
        (False, 130, 2_500_000),  # reset communication leaves the application alone
        (True, 129, 2_500_000),  # stored by 1010: a master has written it
    ],
)
def test_a_reset_forgets_60c2_unless_it_was_stored(
    drive_bench: Make, stores: bool, command: int, expected_ns: int
) -> None:
    bench = drive_bench()
    write_all(bench, PERIODS[3][0])
    if stores:
        bench.remote.sdo[0x1010][1].raw = int.from_bytes(b"save", "little")
    bench.remote.nmt.send_command(command)
    bench.run_to_ms(bench.scheduler.now_ns // MS + 5)
    write_all(bench, [(0x1006, 0, 4000, 4)])
    assert interpolation_ns(bench) == expected_ns


SCALES = [
    ({}, 1),
    ({(0x6092, 1): 10_000}, Fraction(10_000, 1 << 20)),
    ({(0x6092, 1): 10_000, (0x6092, 2): 3}, Fraction(10_000, 3 << 20)),
    ({(0x6091, 1): 7, (0x6091, 2): 2}, Fraction(2, 7)),
    ({(0x608F, 1): 4096, (0x608F, 2): 5}, Fraction(5 << 20, 4096)),
    ({(0x6092, 1): 2**32 - 1, (0x6092, 2): 2**32 - 2}, Fraction(2**32 - 1, 2**32 - 2 << 20)),
]  # fmt: skip


@pytest.mark.parametrize(("objects", "factor"), SCALES)
def test_scaling_objects_change_the_position_unit_on_the_bus(
    drive_bench: Make, fake_axis: Any, objects: dict[tuple[int, int], int], factor: Fraction
) -> None:
    """Unit = increment * 6092 / (608F * 6091), exact for whole increments however large.

    With 2^20 increments per 10 mm; the axis stands at 123.4567 mm.
    """
    bench = drive_bench(fake_axis(start_m=0.1234567))
    for (index, sub), value in objects.items():
        bench.remote.sdo[index][sub].raw = value
    increments = round(Fraction("123.4567") * Fraction("104857.6"))
    units = round(increments * factor)
    found = bench.remote.sdo[0x6064].raw
    assert found == (units + 2**31) % 2**32 - 2**31
    assert bench.remote.sdo[0x6063].raw == increments
    bench.operational(12)
    bench.enable(13)
    step = round(Fraction("0.1") * Fraction("104857.6") * factor)
    if step and abs(units) < 2**31:
        bench.set_values(0x0F, units + step)
        bench.sync_at_ms(16)
        moved_m = velocity(bench) * 1e-3
        assert moved_m == pytest.approx(float(step / factor / Fraction(PER_M)), rel=2e-2)


@pytest.mark.parametrize("index", [0x608F, 0x6091, 0x6092])
def test_scaling_is_refused_while_the_power_stage_is_on(drive_bench: Make, index: int) -> None:
    """Abort 0800 0022 (not in this state); 0 would divide by nothing."""
    bench = drive_bench()
    entry = bench.remote.sdo[index][1]

    def code(value: int) -> int:
        with pytest.raises(SdoAbortedError) as caught:
            entry.raw = value
        return int(caught.value.code)

    assert code(0) == 0x06090032
    bench.remote.sdo[0x6040].raw = 0x06
    entry.raw = entry.raw
    for word in (0x07, 0x0F):
        bench.remote.sdo[0x6040].raw = word
        assert code(entry.raw) == 0x08000022
    bench.remote.sdo[0x6040].raw = 0x00
    entry.raw = entry.raw


def test_no_64_bit_product_overflows(drive_bench: Make, fake_axis: Any) -> None:
    """26 bit per revolution and 20 units of 0.5 um: a product of some 2^57 on the way."""
    profile = DriveProfile(encoder_increments=1 << 26)
    bench = drive_bench(fake_axis(start_m=-0.2), profile=profile)
    bench.remote.sdo[0x6092][1].raw, bench.remote.sdo[0x6092][2].raw = 4_000_000_000, 200_000
    assert bench.remote.sdo[0x6064].raw == -20 * 20_000


def test_second_encoder_and_demand_values(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(start_m=0.01, encoder_2_m=0.003))
    sdo = bench.remote.sdo
    assert sdo[0x60E4][1].raw == round(0.013 * PER_M)
    sdo[0x60E6][1].raw, sdo[0x60EB][1].raw = 1 << 18, 3
    assert sdo[0x60E4][1].raw == round(0.013 * PER_M) * 12
    assert sdo[0x6064].raw == round(0.01 * PER_M)
    bench.operational(4)
    bench.enable(5)
    bench.axis.motion = lambda t: 0.01
    bench.set_values(0x0F, round(0.011 * PER_M))
    bench.sync_at_ms(8)
    bench.run_to_ms(10)
    demand = round(0.011 * PER_M)
    assert (sdo[0x6062].raw, sdo[0x60FC].raw) == (demand, demand)
    assert sdo[0x60F4].raw == demand - sdo[0x6064].raw
    assert (sdo[0x6075].raw, sdo[0x6076].raw) == (4490, 2200)


def test_a_direction_stays_blocked_where_it_was_met_whatever_the_other_switch_does(
    drive_bench: Make,
) -> None:
    """Limit switches come and go; the place is that of the look that first found one on."""
    limits, free, inf = drive_bench().node.servo.limits, 0, math.inf
    for word, place_m, ends_m in (
        (NEGATIVE_END, -0.05, (-0.05, inf)),
        (NEGATIVE_END, -0.06, (-0.05, inf)),
        (NEGATIVE_END | POSITIVE_END, -0.04, (-0.05, -0.04)),
        (NEGATIVE_END | POSITIVE_END, -0.03, (-0.05, -0.04)),
        (POSITIVE_END, -0.02, (-inf, -0.04)),
        (NEGATIVE_END | POSITIVE_END, -0.045, (-0.045, -0.04)),
        (free, 0.0, (-inf, inf)),
        (POSITIVE_END, 0.07, (-inf, 0.07)),
    ):
        limits.block(word, place_m)
        assert (limits.low_m, limits.high_m) == ends_m
        assert limits.velocity_m_s(-0.01) == (0.0 if word & NEGATIVE_END else -0.01)
        assert limits.velocity_m_s(0.01) == (0.0 if word & POSITIVE_END else 0.01)
        assert limits.torque(-300) == (0 if word & NEGATIVE_END else -300)
        assert limits.torque(300) == (0 if word & POSITIVE_END else 300)
