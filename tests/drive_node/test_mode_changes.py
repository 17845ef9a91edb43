"""Changes of the mode of operation: of moving axes, of unknown modes, and what a plant allows."""

from collections.abc import Callable
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from tests.drive_node.profile_drive import PER_M, PROFILE, Drive
from tests.drive_node.servo_alone import ServoAlone

from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US

RATES_OF_PROFILES = {"profile_acceleration": PER_M, "profile_deceleration": PER_M}


def test_an_unknown_mode_is_refused_by_sdo_and_not_followed_from_a_pdo(
    drive_bench: Callable[..., Any],
) -> None:
    bench = drive_bench()
    sdo = bench.remote.sdo
    sdo[0x1401][1].raw = 0x80000303
    sdo[0x1601][1].raw, sdo[0x1601][0].raw = 0x60600008, 1
    sdo[0x1401][1].raw = 0x303
    bench.operational(30)
    for mode, display in ((3, 3), (5, 3), (-1, 3), (1, 1), (8, 8)):
        bench.master.send_message(0x303, mode.to_bytes(1, "little", signed=True))
        bench.sync_at_ms(bench.scheduler.now_ns // MS + 1)
        assert sdo[0x6061].raw == display


@pytest.mark.parametrize("mode", [1, 3])
def test_a_mode_of_positions_takes_a_moving_axis_over_without_a_jump(
    drive_bench: Callable[..., Any], mode: int
) -> None:
    """Csp at 100 mm/s, then pp or pv: it goes on from there and slows down with 1 m/s2."""
    bench = drive_bench()
    bench.remote.sdo[0x6084].raw = PER_M
    bench.operational()
    bench.enable(4)
    for n in range(1, 50):
        bench.set_values(0x0F, round(n * PER_M * 1e-4))
        bench.sync_at_ms(7 + n)
    bench.remote.sdo[0x6060].raw = mode
    first = next(i for i, c in enumerate(bench.axis.commands) if c.time_ns > 56 * MS + 100 * US)
    turn = bench.axis.commands[first]
    assert turn.position_m == pytest.approx(
        bench.axis.commands[first - 1].position_m
        + 0.1 * (turn.time_ns - bench.axis.commands[first - 1].time_ns) * 1e-9, abs=1e-8
    )  # fmt: skip
    bench.scheduler.run_until(turn.time_ns + 40 * MS)
    bench.axis.advance_to(turn.time_ns + 40 * MS)
    expected = turn.position_m + 0.1 * 0.04 - 0.04**2 / 2
    assert bench.axis.motor_position_m() == pytest.approx(expected, abs=3e-5)
    assert bench.remote.sdo[0x6061].raw == mode


def test_csp_keeps_the_course_of_a_moving_axis_for_one_period(drive: Callable[..., Drive]) -> None:
    """Pv at 0.1 m/s, then csp by SDO: 607A is where the demand is one period later."""
    one = drive(3, **PROFILE, o60FF=0.1 * PER_M)
    one.run_ms(100)
    one.set(o6060=8)
    last = one.axis.commands[-1]
    assert last.velocity_m_s == pytest.approx(0.1)
    assert last.end_ns - last.time_ns == 1 * MS
    assert one.sdo[0x607A].raw == round((last.position_m + 0.1e-3) * PER_M)


def test_an_axis_under_velocity_control_is_stopped_before_it_is_positioned(
    drive: Callable[..., Drive],
) -> None:
    """Csv at 0.1 m/s, then csp: 25 ms with 4 m/s2, and 6061 shows 9 until it stands."""
    one = drive(9, **PROFILE, o60FF=0.1 * PER_M)
    one.bench.master.send_message(0x80, b"")
    one.run_ms(20)
    one.set(o6060=8)
    begin_ns = one.axis.commands[-1].time_ns
    assert one.axis.commands[-1].kind is ControlKind.VELOCITY
    assert one.sdo[0x6061].raw == 9
    one.at(begin_ns + 24 * MS)
    assert one.bench.node.image.mode_display == 9
    one.at(begin_ns + 26 * MS)
    assert one.bench.node.image.mode_display == 8
    assert one.axis.commands[-1].kind is ControlKind.POSITION


def test_6502_follows_the_plant_and_so_do_modes_and_option_codes(
    drive_bench: Callable[..., Any], fake_axis: Any
) -> None:
    axis = fake_axis()
    axis.kinds = frozenset({ControlKind.POSITION})
    bench = drive_bench(axis)
    bits = bench.remote.sdo[0x6502].raw
    assert bits & 0x385 == 0x085  # pp, pv, csp; neither csv nor cst
    for index, value in ((0x6060, 9), (0x6060, 10), (0x605A, 3), (0x605A, 8), (0x605E, 4)):
        with pytest.raises(SdoAbortedError) as caught:
            bench.remote.sdo[index].raw = value
        assert caught.value.code == 0x06090030
    assert drive_bench().remote.sdo[0x6502].raw & 0x385 == 0x385


@pytest.mark.parametrize("sign", [1, -1])
def test_csp_begins_at_rest_where_no_position_was_controlled(fake_axis: Any, sign: int) -> None:
    """An axis that rolls at 50 mm/s without power: the demand stays at the place of its begin."""
    axis = fake_axis(motion=lambda time_s: sign * 0.05 * time_s)
    one = ServoAlone(axis, 8)
    assert axis.commands[-1].enabled
    begun = axis.commands[-1]
    place_m = sign * 0.05 * begun.time_ns * 1e-9
    assert (begun.velocity_m_s, begun.position_m) == (0.0, pytest.approx(place_m))
    assert one.image.target_position == round(begun.position_m * PER_M)


def test_pv_counts_its_standstill_from_its_own_begin(fake_axis: Any) -> None:
    """Bit 12 is there after the 30 ms of 6070, also where it was in pv some time before."""
    one = ServoAlone(fake_axis(), 3, target_velocity=0, velocity_threshold_ms=30)
    for _ in range(2):
        late = [bool(one.cycle(mode=3) & 1 << 12) for _ in range(40)]
        assert 29 <= late.index(True) <= 31
        assert all(late[late.index(True) :])
        for _ in range(50):
            one.cycle(mode=8, target_position=0)


@pytest.mark.parametrize("still_ms", [0, 30])
def test_a_mode_of_positions_begins_when_the_axis_has_stood_for_6070(
    fake_axis: Any, still_ms: int
) -> None:
    """Csv at 0.1 m/s, csp with 10 m/s2: 10 ms of ramp, then the time of 6070 once."""
    one = ServoAlone(fake_axis(), 9, target_velocity=0.1 * PER_M, profile_deceleration=10 * PER_M,
                     velocity_threshold_ms=still_ms)  # fmt: skip
    one.cycle()
    one.cycle()
    shown = [one.cycle(mode=8) and one.image.mode_display for _ in range(80)]
    assert shown == sorted(shown, reverse=True)
    assert 10 + still_ms <= shown.count(9) <= 12 + still_ms


@pytest.mark.parametrize("speed_um_s", [50_000, -50_000, 900, -900])
@pytest.mark.parametrize("mode", [1, 3, 6])
def test_a_profile_begins_at_rest_where_an_axis_rolls_without_power(
    fake_axis: Any, mode: int, speed_um_s: int
) -> None:
    """No position was led: the first demand is the place of the axis, and stays there."""
    speed_m_s = speed_um_s * 1e-6
    axis = fake_axis(motion=lambda time_s: speed_m_s * time_s)
    one = ServoAlone(axis, mode, **RATES_OF_PROFILES)
    begun = next(command for command in axis.commands if command.enabled)
    place_m = speed_m_s * begun.time_ns * 1e-9
    for _ in range(3):
        one.cycle()
        for command in axis.commands[axis.commands.index(begun) :]:
            assert command.kind is ControlKind.POSITION
            assert command.position_m == pytest.approx(place_m, abs=1e-12)
            assert command.velocity_m_s == 0.0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("mode", [1, 3, 6])
@pytest.mark.parametrize("before", [9, 10])
def test_after_velocity_or_torque_a_profile_begins_at_rest_where_the_axis_is(
    fake_axis: Any, before: int, mode: int, sign: int
) -> None:
    """It creeps with 0.5 mm/s, less than the 1 mm/s that 606F takes for standing."""
    speed_m_s = sign * 0.5e-3
    axis = fake_axis(motion=lambda time_s: speed_m_s * time_s)
    one = ServoAlone(
        axis, before, target_velocity=speed_m_s * PER_M, velocity_threshold=1e-3 * PER_M,
        velocity_threshold_ms=0, **RATES_OF_PROFILES,
    )  # fmt: skip
    for _ in range(3):
        one.cycle()
    last = axis.commands[-1].kind
    assert last is (ControlKind.VELOCITY if before == 9 else ControlKind.FORCE)
    count = len(axis.commands)
    for _ in range(40):
        one.cycle(mode=mode, target_velocity=0)
        if axis.commands[-1].kind is ControlKind.POSITION:
            break
    begun = next(c for c in axis.commands[count:] if c.kind is ControlKind.POSITION)
    place_m = speed_m_s * begun.time_ns * 1e-9
    for _ in range(3):
        one.cycle()
    for command in axis.commands[axis.commands.index(begun) :]:
        assert command.position_m == pytest.approx(place_m, abs=1e-12)
        assert command.velocity_m_s == 0.0
