"""Profile velocity: ramps and limits by closed forms."""

from collections.abc import Callable

import pytest
from tests.drive_node.profile_drive import BIT_12, LIMITED, PER_M, PROFILE, REACHED, Drive

from axisrig.kernel.time.clock import MS, S


def test_pv_ramps_to_its_target_and_through_zero(drive: Callable[..., Drive]) -> None:
    """0 -> 0.1 m/s with 2 m/s2 (50 ms), -> -0.2 m/s: 25 ms with 4 m/s2, 100 ms with 2 m/s2."""
    one = drive(3, **PROFILE)
    one.run_ms(5)
    assert one.status & BIT_12  # stands
    one.set(o60FF=0.1 * PER_M)
    one.run_ms(100)
    assert one.sdo[0x606C].raw == pytest.approx(0.1 * PER_M, abs=1)
    assert one.status & (REACHED | BIT_12) == REACHED
    here_ns = one.now_ns
    here_m = one.at(here_ns)
    assert one.at(here_ns + 40 * MS) == pytest.approx(here_m + 0.1 * 0.04, abs=1e-9)
    one.set(o60FF=-0.2 * PER_M)
    turn = one.axis.commands[-1]
    begin_m, begin_ns = turn.position_m, turn.time_ns
    ticks = [0.02, 0.025, 0.05, 0.1, 0.125]
    for time_s in ticks:
        if time_s <= 0.025:
            expected = (0.1 - 2 * time_s) * time_s
        else:
            expected = 0.1 * 0.025 / 2 - (time_s - 0.025) ** 2
        now_ns = begin_ns + round(time_s * S)
        if now_ns > one.now_ns:
            # The target acts at the next tick: up to 250 us late
            assert one.at(now_ns) == pytest.approx(begin_m + expected, abs=0.25e-3 * 0.3)
    one.run_ms(50)
    assert one.sdo[0x606C].raw == pytest.approx(-0.2 * PER_M, abs=1)


def test_pv_acceleration_takes_v_by_a(drive: Callable[..., Drive]) -> None:
    """Bit 10 with a window of 1 unit/s and 606E = 0: at the tick that ends the ramp of 50 ms."""
    one = drive(3, **PROFILE, o606D=1)
    one.set(o60FF=0.1 * PER_M)
    moving = [c for c in one.axis.commands if c.velocity_m_s]
    begin_ns = moving[0].time_ns
    one.at(begin_ns + 49 * MS)
    assert not one.bench.node.image.statusword & REACHED
    one.at(begin_ns + 51 * MS)
    assert one.bench.node.image.statusword & REACHED


@pytest.mark.long
def test_pv_stops_exactly_at_a_software_limit(drive: Callable[..., Drive]) -> None:
    one = drive(3, **PROFILE, o607D_1=-0.01 * PER_M, o607D_2=0.02 * PER_M, o60FF=0.1 * PER_M)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.02, abs=1e-8)
    assert one.status & LIMITED
    one.set(o60FF=-0.1 * PER_M)
    one.run_ms(600)
    assert one.axis.motor_position_m() == pytest.approx(-0.01, abs=1e-8)


@pytest.mark.parametrize(
    ("changed", "speed_m_s"),
    [
        ({"o607F": 0.05 * PER_M}, 0.05),
        ({"o6080": 120}, 0.02),  # rev/min of a screw with 10 mm
        ({"o607D_1": -0.01 * PER_M, "o607D_2": 0.03 * PER_M}, 0.0),
    ],
)
def test_a_limit_that_is_set_while_an_axis_moves_with_pv_acts_from_then_on(
    drive: Callable[..., Drive], changed: dict[str, float], speed_m_s: float
) -> None:
    """With 0.1 m/s it is at 17.5 mm after 200 ms; bit 11 says that it is limited."""
    one = drive(3, **PROFILE, o60FF=0.1 * PER_M)
    one.run_ms(190)
    assert not one.status & LIMITED
    one.set(**changed)
    one.run_ms(300)
    assert one.sdo[0x606C].raw == pytest.approx(speed_m_s * PER_M, abs=1)
    assert one.status & LIMITED
    if not speed_m_s:
        assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    one.set(o607F=PER_M, o6080=0xFFFFFFFF, o607D_1=0, o607D_2=0)
    one.run_ms(200)
    assert one.sdo[0x606C].raw == pytest.approx(0.1 * PER_M, abs=1)
    assert not one.status & LIMITED


def test_ramps_that_change_while_an_axis_follows_them_with_pv_act_from_then_on(
    drive: Callable[..., Drive],
) -> None:
    """To 0.4 m/s with 2 m/s2 for 50 ms, then with 4: there 75 ms later; down with 8 m/s2 in 50."""
    one = drive(3, **PROFILE, o60FF=0.4 * PER_M)
    one.run_ms(50)
    one.set(o6083=4 * PER_M)
    one.run_ms(70)
    assert 0.36 * PER_M < one.sdo[0x606C].raw < 0.4 * PER_M
    one.run_ms(10)
    assert one.sdo[0x606C].raw == pytest.approx(0.4 * PER_M, abs=1)
    one.set(o60FF=0.0)
    one.set(o6084=8 * PER_M)
    one.run_ms(55)
    assert one.sdo[0x606C].raw == 0
