"""Stops of a servo and its limit switches: when they begin, when they are done, what is free then.

The axis follows exactly. Ramps are 10 m/s2, so that 0.1 m/s end after 10 ms and 0.5 mm.
"""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, REACHED, ServoAlone

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US, S

RAMPS = {"quick_stop_deceleration": 10 * PER_M, "profile_deceleration": 10 * PER_M}
SPEED_M_S, BRAKE_NS, BRAKE_M = 0.1, 10 * MS, 0.0005
MET, GONE = (0x8612, 0x21, 0), (0, 0, 0)


def _running(axis: Any, sign: int = 1, **given: Any) -> ServoAlone:
    """Return a servo in csv at 0.1 m/s in one direction, at 5 ms."""
    one = ServoAlone(axis, 9, target_velocity=sign * SPEED_M_S * PER_M, **RAMPS, **given)
    one.cycle()
    one.cycle()
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * SPEED_M_S)
    return one


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
def test_a_limit_switch_stops_the_axis_and_leaves_the_way_back(
    fake_axis: Any, fake_signal: Any, name: str, sign: int
) -> None:
    """On at 6 ms: the tick at 6.25 ms brakes; the error is there as long as the switch is on."""
    axis = fake_axis()
    one = _running(axis, sign, switches={name: fake_signal(axis, [6 * MS, 60 * MS])})
    one.cycle()
    one.cycle()
    command = axis.commands[-1]
    assert (command.time_ns, command.end_ns) == (6 * MS + 250 * US, 6 * MS + 250 * US + BRAKE_NS)
    assert one.sent == [MET]
    met_m = command.position_m
    while one.now_ns < 30 * MS:
        word = one.cycle()
    assert word & LIMITED
    assert axis.demand_velocity_m_s() == 0.0
    assert axis.motor_position_m() == pytest.approx(met_m + sign * BRAKE_M)
    assert one.image.digital_inputs == (1 if sign < 0 else 2)
    assert (one.sent, one.servo.state) == ([MET], State.OPERATION_ENABLED)
    one.cycle(target_velocity=-sign * SPEED_M_S * PER_M)
    one.run_ms(5)
    assert axis.demand_velocity_m_s() == pytest.approx(-sign * SPEED_M_S)
    while one.now_ns < 62 * MS:
        word = one.cycle()
    assert (word & LIMITED, one.sent, one.image.error_register) == (0, [MET, GONE], 0)
    one.cycle(target_velocity=sign * SPEED_M_S * PER_M)
    one.run_ms(2)
    assert axis.demand_velocity_m_s() == pytest.approx(sign * SPEED_M_S)


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
def test_a_switch_behind_the_axis_does_not_stop_it(
    fake_axis: Any, fake_signal: Any, name: str, sign: int
) -> None:
    """The way off a switch is free, and the error is of an axis that runs into one."""
    axis = fake_axis()
    one = _running(axis, -sign, switches={name: fake_signal(axis, [6 * MS])})
    for _ in range(5):
        one.cycle()
    assert axis.demand_velocity_m_s() == pytest.approx(-sign * SPEED_M_S)
    assert one.sent == []


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
def test_an_axis_pushed_on_without_power_begins_where_it_is(
    fake_axis: Any, fake_signal: Any, name: str, sign: int
) -> None:
    """The end of the way is the place at which operation begins, not that of the switch."""
    axis = fake_axis(start_m=0.02)
    one = ServoAlone(axis, switches={name: fake_signal(axis, [2 * MS])})
    for _ in range(3):
        one.cycle()
    one.cycle(controlword=0)
    axis.motion = lambda time_s: 0.02 + sign * 0.001
    one.cycle(controlword=6)
    axis.motion, axis.commands[-1].position_m = None, 0.02 + sign * 0.001
    for word in (0x06, 0x07, 0x0F, 0x0F):
        one.cycle(controlword=word)
    assert axis.motor_position_m() == pytest.approx(0.02 + sign * 0.001)
    for _ in range(3):
        word = one.cycle(target_position=(0.02 + sign * 0.003) * PER_M)
    assert word & LIMITED
    assert axis.motor_position_m() == pytest.approx(0.02 + sign * 0.001, abs=1e-8)
    for _ in range(3):
        one.cycle(target_position=0.02 * PER_M)
    assert axis.motor_position_m() == pytest.approx(0.02, abs=1e-8)


def test_a_mode_that_is_asked_for_in_a_halt_comes_when_the_axis_rests(fake_axis: Any) -> None:
    one = _running(fake_axis(), halt_option=1)
    one.cycle(controlword=0x010F)
    halted_ns = one.now_ns
    one.cycle(mode=8)
    shown = {}
    for _ in range(40):
        word = one.cycle()
        shown[one.now_ns - halted_ns] = (one.image.mode_display, bool(word & REACHED))
    assert all(shown[late] == (9, False) for late in shown if late < BRAKE_NS)
    assert shown[max(shown)] == (8, True)
    rest_m = one.axis.motor_position_m()
    one.cycle(controlword=0x0F)
    one.cycle()
    assert one.axis.motor_position_m() == pytest.approx(rest_m)


@pytest.mark.parametrize(
    ("code", "last"),
    [(1, "SWITCH_ON_DISABLED"), (2, "SWITCH_ON_DISABLED"), (5, "QUICK_STOP_ACTIVE"),
     (6, "QUICK_STOP_ACTIVE")],
)  # fmt: skip
def test_a_quick_stop_needs_no_sync_and_ends_its_ticks(
    fake_axis: Any, code: int, last: str
) -> None:
    one = _running(fake_axis(), quick_stop_option=code, velocity_threshold_ms=2)
    one.write(controlword=0x02)
    begun_ns = one.now_ns
    one.run_ms(9)
    assert one.servo.state.name == "QUICK_STOP_ACTIVE"
    one.run_ms(5)
    assert one.servo.state.name == last
    assert one.axis.commands[-1].enabled is (last == "QUICK_STOP_ACTIVE")
    # 0.1 m/s are reached within the cycle from 4 to 5 ms: half the speed on the average there
    braked_m = SPEED_M_S * (begun_ns - 4.5 * MS) * 1e-9 + BRAKE_M
    assert one.axis.motor_position_m() == pytest.approx(braked_m)
    assert one.image.statusword & REACHED == (REACHED if last == "QUICK_STOP_ACTIVE" else 0)
    commands = len(one.axis.commands)
    one.run_ms(20)
    assert len(one.axis.commands) == commands


@pytest.mark.parametrize("sign", [1, -1])
def test_a_stop_of_an_axis_that_goes_on_is_done_a_second_after_its_ramp(
    fake_axis: Any, sign: int
) -> None:
    """Moved from outside at 0.05 m/s it is never at standstill; the drive gives up waiting."""
    axis = fake_axis(motion=lambda time_s: sign * 0.05 * time_s)
    one = ServoAlone(axis, 9, velocity_threshold=0.01 * PER_M, **RAMPS)
    one.write(controlword=0x02)
    ramp_end_ns = one.now_ns + BRAKE_NS // 2
    one.run_ms((ramp_end_ns + S - one.now_ns) / MS - 1)
    assert one.servo.state is State.QUICK_STOP_ACTIVE
    one.run_ms(2)
    assert one.servo.state.name == "SWITCH_ON_DISABLED"


@pytest.mark.parametrize(("below", "is_done"), [(0, False), (1, True)])
@pytest.mark.parametrize("sign", [1, -1])
def test_standstill_is_a_speed_below_606f_for_6070(
    fake_axis: Any, sign: int, below: int, is_done: bool
) -> None:
    """1048 units/s are 0.01 mm/s; a speed as large as 606F is none below it."""
    units_s = 1048
    axis = fake_axis(motion=lambda time_s: sign * units_s / PER_M * time_s)
    one = ServoAlone(axis, 9, velocity_threshold=units_s + below, velocity_threshold_ms=30, **RAMPS)
    one.write(controlword=0x02)
    one.run_ms(28)
    assert one.servo.state is State.QUICK_STOP_ACTIVE
    one.run_ms(4)
    assert (one.servo.state.name == "SWITCH_ON_DISABLED") is is_done


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("met_mm", "end_mm"), [(1.0, 1.0), (3.0, 3.0), (5.0, 3.0)])
def test_the_nearer_of_switch_and_software_limit_is_the_end(
    fake_axis: Any, sign: int, met_mm: float, end_mm: float
) -> None:
    """607D: -3 and 3 mm; the other direction keeps its own. When it is left, 607D alone counts."""
    ends: Any = {"software_limit_min": -3e-3 * PER_M, "software_limit_max": 3e-3 * PER_M}
    limits = ServoAlone(fake_axis(), **ends).servo.limits
    limits.block(2 if sign > 0 else 1, sign * met_mm * 1e-3)
    own, other = (limits.high_m, limits.low_m)[::sign]
    assert own == pytest.approx(sign * end_mm * 1e-3)
    assert other == pytest.approx(-sign * 3e-3)
    limits.block(0, 0.0)
    assert (limits.low_m, limits.high_m) == pytest.approx((-3e-3, 3e-3))


@pytest.mark.parametrize(
    ("profile", "quick", "most", "expected"),
    [
        ((5.0, 8.0), 20.0, (6.0, 7.0), (5.0, 7.0, 7.0)),
        ((9.0, 2.0), 4.0, (6.0, 7.0), (6.0, 2.0, 4.0)),
        ((5.0, 6.0), 3.0, (100.0, 100.0), (5.0, 6.0, 3.0)),
        ((0.0, 0.0), 3.0, (6.0, 7.0), (1 / PER_M, 1 / PER_M, 3.0)),
    ],
)
def test_each_rate_has_its_own_limit(
    fake_axis: Any,
    profile: tuple[float, float],
    quick: float,
    most: tuple[float, float],
    expected: tuple[float, float, float],
) -> None:
    """6083 by 60C5; 6084 and 6085 by 60C6; a rate of 0, which a PDO can write, is one unit."""
    one = ServoAlone(
        fake_axis(),
        profile_acceleration=profile[0] * PER_M, profile_deceleration=profile[1] * PER_M,
        quick_stop_deceleration=quick * PER_M,
        max_acceleration=most[0] * PER_M, max_deceleration=most[1] * PER_M,
    )  # fmt: skip
    found = (*one.servo.limits.rates_m_s2(), one.servo.limits.quick_stop_m_s2())
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(
    ("limits", "acts", "at_the_limit"),
    [
        ({}, False, ()),
        ({"positive_torque_limit": 300}, True, (300,)),
        ({"negative_torque_limit": 300}, True, (-300,)),
        ({"max_torque": 200, "positive_torque_limit": 300}, True, (200, -200)),
    ],
)
def test_a_torque_at_a_limit_of_its_own_direction_is_limited(
    fake_axis: Any, limits: dict[str, int], acts: bool, at_the_limit: tuple[int, ...]
) -> None:
    """From 0.99 of it on; the other direction has none, where its object does not say one."""
    made = ServoAlone(fake_axis(), **limits).servo.limits
    assert made.is_limiting is acts
    for torque in (*at_the_limit, 100, -100, 1000, -1000):
        nearest = [limit for limit in at_the_limit if limit * torque > 0]
        is_at = any(abs(torque) >= 0.99 * abs(limit) for limit in nearest)
        assert made.is_torque_limited(torque) is is_at
    for limit in at_the_limit:
        assert made.is_torque_limited(round(limit * 0.992))
        assert not made.is_torque_limited(round(limit * 0.98))


def test_an_axis_that_stood_before_its_stop_has_the_whole_time_of_6070(fake_axis: Any) -> None:
    """Pv at 0 counts standstill too; a stop at once is done 30 ms after its begin and not before.

    Ticks of 250 us, as the drive looks then.
    """
    one = ServoAlone(fake_axis(), 3, target_velocity=0, velocity_threshold_ms=30, **RAMPS)
    one.run_ms(100)
    one.write(controlword=0x02)
    one.run_ms(29.5)
    assert one.servo.state is State.QUICK_STOP_ACTIVE
    one.run_ms(1)
    assert one.servo.state.name == "SWITCH_ON_DISABLED"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_following_error_is_braked_from_where_the_axis_is(fake_axis: Any, sign: int) -> None:
    """A plant of positions alone: 0.02 m/s beside a demand at rest, stopped with 10 m/s2.

    The ramp of the fault has 2 ms and 20 um from the actual position on.
    """
    axis = fake_axis(motion=lambda time_s: sign * 0.02 * time_s)
    axis.kinds = frozenset({ControlKind.POSITION})
    one = ServoAlone(axis, 8, following_window=50e-6 * PER_M, following_timeout_ms=0,
                     fault_option=1, **RAMPS)  # fmt: skip
    for _ in range(6):
        one.cycle(target_position=0)
        if one.sent:
            break
    assert one.sent[0][0] == 0x8611
    fault = next(c for c in axis.commands if c.velocity_m_s * sign > 0.0)
    place_m = sign * 0.02 * fault.time_ns * 1e-9
    assert fault.position_m == pytest.approx(place_m)
    # 0.02 m/s less half of what 10 m/s2 take in a tick of 250 us
    assert fault.velocity_m_s == pytest.approx(sign * (0.02 - 10 * 125e-6))
    one.run_ms(5)
    assert axis.demand_position_m() == pytest.approx(place_m + sign * 20e-6)
