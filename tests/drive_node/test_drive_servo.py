"""Set value, sampling order, following error and latches of a node on the bus, by closed forms."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US

Make = Callable[..., Any]
SYNC_NS = 48_000  # SYNC without data at 1 Mbit/s: 44 bit to the end of frame, 4 stuff bits
PER_MM = Fraction("104857.6")


def units(position_m: float) -> int:
    return round(Fraction(position_m) * 1000 * PER_MM)


def position_of(frame: bytes) -> int:
    return int.from_bytes(frame[2:6], "little", signed=True)


def test_operation_starts_where_the_axis_is_whatever_the_target_says(
    drive_bench: Make, fake_axis: Any
) -> None:
    bench = drive_bench(fake_axis(start_m=0.12))
    bench.operational()
    bench.enable(3, target=-999_999)
    assert bench.node.state is State.OPERATION_ENABLED
    last = bench.axis.commands[-1]
    assert (last.position_m, last.velocity_m_s, last.enabled) == (0.12, 0.0, True)
    bench.sync_at_ms(6)  # no new target came: hold
    step_mm = bench.axis.commands[-1].velocity_m_s * 1000 * 0.001
    assert abs(step_mm) <= 0.5 / PER_MM  # the actual position as an increment


def test_target_is_reached_linearly_over_one_sync_period(drive_bench: Make, fake_axis: Any) -> None:
    """1048576 units = 10 mm; 10 mm in 1 ms are 10 m/s, in 2 ms 5 m/s."""
    bench = drive_bench(fake_axis(start_m=0.0))
    bench.operational()
    bench.enable(3)
    bench.set_values(0x0F, 1_048_576)
    bench.sync_at_ms(6)
    last = bench.axis.commands[-1]
    assert last.position_m == pytest.approx(0.0, abs=1e-12)
    assert last.velocity_m_s == pytest.approx(10.0)
    assert last.end_ns - last.time_ns == 1 * MS
    bench.sync_at_ms(7)
    assert bench.axis.commands[-1].position_m == pytest.approx(0.010)
    bench.remote.sdo[0x1006].raw = 2000
    bench.set_values(0x0F, 2 * 1_048_576)
    bench.sync_at_ms(9)
    assert bench.axis.commands[-1].velocity_m_s == pytest.approx(5.0)
    assert bench.axis.commands[-1].end_ns - bench.axis.commands[-1].time_ns == 2 * MS


def test_an_early_sync_goes_on_from_the_present_demand(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(start_m=0.0))
    bench.operational()
    bench.enable(3)
    bench.set_values(0x0F, 1_048_576)
    bench.sync_at_ms(6)
    bench.set_values(0x0F, 2 * 1_048_576)
    bench.run_to_ms(6.8)  # early: 8 of 10 mm done, 12 mm to go
    bench.master.send_message(0x80, b"")
    bench.run_to_ms(6.9)
    last = bench.axis.commands[-1]
    assert last.position_m == pytest.approx(0.008)
    assert last.velocity_m_s == pytest.approx(12.0)


def test_no_demand_without_operation_enabled(drive_bench: Make, fake_axis: Any) -> None:
    """The axis is pushed about; the demand follows it and 60F4 is 0."""
    bench = drive_bench(fake_axis(motion=lambda t: 0.5 * t))
    bench.operational()
    for step, word in enumerate((0x06, 0x07)):
        bench.set_values(word, 0)
        bench.sync_at_ms(3 + step)
        last = bench.axis.commands[-1]
        assert not last.enabled
        assert last.position_m == 0.5 * last.time_ns * 1e-9
    assert bench.remote.sdo[0x60F4].raw == 0


@pytest.mark.parametrize(("word", "state"), [(0x00, "SWITCH_ON_DISABLED"), (0x06, "READY_TO")])
def test_leaving_operation_takes_the_force_away_at_the_same_sync(
    drive_bench: Make, word: int, state: str
) -> None:
    bench = drive_bench()
    bench.operational()
    bench.enable(3)
    bench.set_values(word, 0)
    bench.sync_at_ms(6)
    assert bench.node.state.name.startswith(state)
    assert not bench.axis.commands[-1].enabled


@pytest.mark.parametrize(("option", "first"), [(0, 0x0217), (2, 0x0617)])
def test_quick_stop_of_a_standing_axis_shows_for_one_sync(
    drive_bench: Make, option: int, first: int
) -> None:
    """Transition 11, then 12 by itself; bit 10 = it stands, where it is not left alone (0)."""
    bench = drive_bench()
    bench.remote.sdo[0x605A].raw = option
    bench.operational()
    bench.enable(3)
    bench.set_values(0x02, 0)
    bench.sync_at_ms(6)
    bench.sync_at_ms(7)
    assert not bench.axis.commands[-1].enabled
    words = [int.from_bytes(frame[:2], "little") for frame in bench.frames(0x183)[-2:]]
    assert words == [first, 0x0250]


def test_sdo_takes_the_force_away_between_two_syncs(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.operational()
    bench.enable(3)
    bench.remote.sdo[0x6040].raw = 0x06
    assert not bench.axis.commands[-1].enabled
    assert bench.axis.commands[-1].time_ns < 6 * MS


def test_sample_is_of_the_instant_the_sync_arrives(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(motion=lambda t: 0.3 * t))
    bench.operational()
    for k in (3, 4, 5):
        bench.sync_at_ms(k)
        assert position_of(bench.frames(0x183)[-1]) == units(0.3 * (k * MS + SYNC_NS) * 1e-9)


def test_following_error_is_demand_less_encoder(drive_bench: Make, fake_axis: Any) -> None:
    """The axis is stuck at 0; after n periods of 0.1 mm the demand is n * 0.1 mm ahead."""
    bench = drive_bench(fake_axis(motion=lambda t: 0.0))
    bench.operational()
    bench.enable(3)
    for n in range(1, 6):
        bench.set_values(0x0F, round(n * PER_MM / 10))
        bench.sync_at_ms(5 + n)
        assert bench.node.image.following_error == round((n - 1) * PER_MM / 10)
    bench.run_to_ms(12)
    assert bench.remote.sdo[0x60F4].raw == round(5 * PER_MM / 10)


def test_following_error_fault_after_window_and_time_out(drive_bench: Make, fake_axis: Any) -> None:
    """Stuck axis, 1000 units per ms, window 2500, time-out 3 ms, ticks of 250 us.

    The target n * 1000 of SYNC 8 + n is reached 1 ms later, so the demand is 1000 (t - 9 ms) after
    SYNC 9 and above 2500 first at the tick of 11.75 ms; the fault comes at 14.75 ms, the axis
    stands, and one tick later the reaction is over. From the tick on that sees the excess, bit 7
    warns.
    """
    bench = drive_bench(fake_axis(motion=lambda t: 0.0))
    bench.operational()
    bench.remote.sdo[0x6065].raw = 2500
    bench.remote.sdo[0x6066].raw = 3
    bench.run_to_ms(5.7)
    bench.enable(6)
    for n in range(1, 9):
        bench.set_values(0x0F, n * 1000)
        bench.sync_at_ms(8 + n)
    status = [int.from_bytes(frame[:2], "little") for frame in bench.frames(0x183)]
    assert status == [0x0231, 0x0233] + [0x1237] * 4 + [0x12B7] * 3 + [0x2218] * 2
    assert bench.frames(0x083) == [bytes.fromhex("1186210000000000")]
    frame_ns = bench.times_ns(0x083)[0] - (14_750_000 + SYNC_NS)
    assert 108 * US < frame_ns < 132 * US  # 8 byte at 1 Mbit/s
    assert bench.remote.sdo[0x603F].raw == 0x8611
    assert bench.remote.sdo[0x1001].raw == 0x21
    assert not bench.axis.commands[-1].enabled
    bench.set_values(0x80, 0)
    bench.sync_at_ms(18)
    assert bench.node.state is State.SWITCH_ON_DISABLED
    assert bench.frames(0x083)[1:] == [bytes(8)]
    assert bench.remote.sdo[0x1001].raw == 0
    assert bench.remote.sdo[0x603F].raw == 0
    assert int.from_bytes(bench.frames(0x183)[-1][:2], "little") == 0x0250


def test_node_reset_ends_a_fault_without_a_message(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(motion=lambda t: 0.0))
    bench.remote.sdo[0x6065].raw = 100
    bench.operational()
    bench.enable(3)
    bench.set_values(0x0F, 1000)
    for k in (6, 7, 8):
        bench.sync_at_ms(k)
    assert bench.node.state is State.FAULT
    bench.remote.nmt.send_command(129)
    bench.run_to_ms(10)
    assert bench.remote.sdo[0x6041].raw == 0x0250
    assert bench.remote.sdo[0x1001].raw == 0
    assert len(bench.frames(0x083)) == 1
    bench.remote.sdo[0x6065].raw = 100
    bench.operational(15)
    bench.enable(16)
    bench.set_values(0x0F, 1000)
    bench.sync_at_ms(19)
    bench.sync_at_ms(20)
    assert len(bench.frames(0x083)) == 2  # the same error is a new one


def test_a_fault_that_stands_is_not_taken_again(drive_bench: Make) -> None:
    """The first error stays in 603F and the state stays; nothing is sent a second time."""
    bench = drive_bench()
    bench.operational()
    bench.enable(3)
    bench.node.servo.fault(0x7305, 0x01, bench.scheduler.now_ns)
    bench.run_to_ms(20)
    assert bench.node.state is State.FAULT
    bench.node.servo.fault(0x2310, 0x02, bench.scheduler.now_ns)
    assert bench.node.state is State.FAULT
    bench.run_to_ms(25)
    assert bench.remote.sdo[0x603F].raw == 0x7305
    assert [frame[:2].hex() for frame in bench.frames(0x083)] == ["0573"]


def test_window_not_exceeded_long_enough_is_no_fault(drive_bench: Make, fake_axis: Any) -> None:
    """The encoder is off by 3 mm from 8.5 to 10.5 ms and from 11.5 ms on; time-out 3 ms.

    A tick lies 48 us behind each quarter of a millisecond, so the first one beyond the window is
    that of 11.548 ms and the fault comes at 14.548 ms.
    """
    axis = fake_axis(motion=lambda t: 0.003 if 0.0085 < t < 0.0105 or t > 0.0115 else 0.0)
    bench = drive_bench(axis)
    bench.operational()
    bench.remote.sdo[0x6065].raw = 2500
    bench.remote.sdo[0x6066].raw = 3
    bench.run_to_ms(4.7)
    bench.enable(5)
    for k in range(8, 14):
        bench.sync_at_ms(k)
    bench.run_to_ms(14.547)
    assert bench.node.state is State.OPERATION_ENABLED
    bench.run_to_ms(14.549)
    assert bench.node.state is State.FAULT_REACTION_ACTIVE


def test_window_ffffffff_is_not_monitored(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(motion=lambda t: 0.0))
    bench.operational()
    bench.enable(3)
    bench.set_values(0x0F, 0x7FFF_FFFF)
    for k in range(6, 12):
        bench.sync_at_ms(k)
    assert bench.node.state is State.OPERATION_ENABLED
    assert bench.frames(0x083) == []


V_M_S, A_M_S2 = 0.25, 3.0
CASES = {
    "ideal": (DriveProfile(input_delay_ns=0), 0),
    "delay": (DriveProfile(input_delay_ns=4000), 4000),
    "delay and filter": (DriveProfile(input_delay_ns=4000, input_filter_ns=100_000), 104_000),
    "position factor": (DriveProfile(position_factor=Fraction(625, 65536)), 4000),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("probe", [1, 2])
def test_latched_position_is_the_motion_at_edge_delay_filter(
    drive_bench: Make, fake_axis: Any, case: str, probe: int
) -> None:
    """x = v t + a t^2 / 2 at the latch instant, in exact arithmetic, to the increment."""
    profile, after_ns = CASES[case]
    edge_ns = 5_321_987
    axis = fake_axis(motion=lambda t: V_M_S * t + A_M_S2 * t * t / 2)
    wired = ([edge_ns], None) if probe == 1 else (None, [edge_ns])
    bench = drive_bench(axis, wired, profile)
    bench.operational()
    bench.set_values(0x06, 0, function=0x0011 << 8 * (probe - 1))
    for k in range(3, 8):
        bench.sync_at_ms(k)
    t_s = Fraction(edge_ns + after_ns, 10**9)
    exact_mm = (Fraction(1, 4) * t_s + Fraction(3, 2) * t_s * t_s) * 1000
    expected = round(round(exact_mm * PER_MM) * profile.position_factor)
    assert bench.remote.sdo[0x60BA if probe == 1 else 0x60BC].raw == expected
    assert bench.remote.sdo[0x60D5 if probe == 1 else 0x60D7].raw == 1
    status = [int.from_bytes(f[6:8], "little") >> 8 * (probe - 1) for f in bench.frames(0x183)]
    assert status == [1, 1, 1, 3, 3]  # edge at 5.3 ms: seen at the SYNC of 6 ms


def test_position_and_stored_bit_come_from_the_same_sync(drive_bench: Make, fake_axis: Any) -> None:
    """TPDO2 of the SYNC that first shows the bit carries the value; the one before carries 0."""
    bench = drive_bench(fake_axis(motion=lambda t: t), ([5_500_000], None), DriveProfile())
    bench.operational()
    bench.set_values(0x06, 0, function=0x0011)
    for k in range(3, 8):
        bench.sync_at_ms(k)
    stored = [frame[6] for frame in bench.frames(0x183)]
    values = [int.from_bytes(frame, "little") for frame in bench.frames(0x283)]
    assert stored == [1, 1, 1, 3, 3]
    assert values == [0, 0, 0] + [units(5.504e-3)] * 2


def test_arming_and_latch_by_sdo_between_two_syncs(drive_bench: Make, fake_axis: Any) -> None:
    """No SYNC at all: the function word acts when it is written, the value is read afterwards."""
    axis = fake_axis(motion=lambda t: t)
    bench = drive_bench(axis, ([1_100_000, 1_200_000, 9_000_000], None), DriveProfile())
    bench.remote.sdo[0x60B8].raw = 0x0011  # takes about 0.25 ms: after 1.1 ms, 1.2 ms
    assert bench.scheduler.now_ns < 9_000_000
    assert bench.remote.sdo[0x60B9].raw == 0x0001
    bench.run_to_ms(10)
    assert bench.remote.sdo[0x60B9].raw == 0x0003
    assert bench.remote.sdo[0x60BA].raw == units(9.004e-3)
    bench.remote.sdo[0x60B8].raw = 0
    assert bench.remote.sdo[0x60B9].raw == 0
    assert bench.remote.sdo[0x60BA].raw == units(9.004e-3)
