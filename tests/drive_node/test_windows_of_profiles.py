"""Windows and times of profile position and profile velocity, to the unit and to the tick.

Ticks come every 250 us from the last SYNC on; 10 mm/s are 1 048 576 units/s exactly.
"""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, REACHED, ServoAlone

NEW, AT_ONCE, TAKEN = 1 << 4, 1 << 5, 1 << 12
ON = 0x0F
UNITS_S = 1_048_576
TO_POINT = {
    "profile_velocity": 0.1 * PER_M,
    "profile_acceleration": 10 * PER_M,
    "profile_deceleration": 10 * PER_M,
}  # 0.1 m/s after 10 ms and 0.5 mm


def _at(units: int) -> Any:
    return lambda _time_s: units / PER_M


def _go(one: ServoAlone, place_m: float, bits: int = 0) -> None:
    one.cycle(controlword=ON | NEW | bits, target_position=place_m * PER_M)
    one.cycle(controlword=ON)


def _cycles_until(one: ServoAlone, bit: int, most: int = 400) -> int:
    """Return how many cycles it takes until a bit of the statusword is there."""
    return next(number for number in range(1, most) if one.cycle() & bit)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("away", "is_reached"), [(0, True), (500, True), (501, False)])
def test_a_target_is_reached_within_6067_on_either_side(
    fake_axis: Any, sign: int, away: int, is_reached: bool
) -> None:
    one = ServoAlone(fake_axis(motion=_at(10_000)), 1, position_window=500, **TO_POINT)
    _go(one, (10_000 + sign * away) / PER_M)
    for _ in range(30):
        word = one.cycle()
    assert bool(word & REACHED) is is_reached


def test_a_window_of_all_bits_asks_for_no_place(fake_axis: Any) -> None:
    """6067 = FFFFFFFF: the set-point is reached with the end of its profile."""
    one = ServoAlone(fake_axis(motion=_at(0)), 1, position_window=0xFFFF_FFFF, **TO_POINT)
    _go(one, 0.005)
    # 4.5 mm at 0.1 m/s after 10 ms, and 10 ms to rest: 60 ms after the first cycle
    assert _cycles_until(one, REACHED) == pytest.approx(59, abs=1)


def test_each_set_point_has_the_whole_time_of_6068(fake_axis: Any) -> None:
    one = ServoAlone(fake_axis(), 1, position_window=500, position_window_ms=25, **TO_POINT)
    for place_m in (0.005, 0.010, 0.005):
        one.run_ms(100)
        _go(one, place_m)
        assert not one.image.statusword & REACHED
        # 60 ms as above, and the time
        assert _cycles_until(one, REACHED) == pytest.approx(59 + 25, abs=1)


@pytest.mark.parametrize("bits", [0, AT_ONCE])
def test_a_third_set_point_is_not_taken_while_one_runs_and_one_waits(
    fake_axis: Any, bits: int
) -> None:
    """Bit 12 stays 1 until the second one runs: an edge of bit 4 before says nothing."""
    one = ServoAlone(fake_axis(), 1, **TO_POINT)
    _go(one, 0.005)
    _go(one, 0.010)
    assert one.image.statusword & TAKEN
    _go(one, 0.002, bits)
    assert one.image.statusword & TAKEN
    for _ in range(150):
        one.cycle()
    assert one.axis.motor_position_m() == pytest.approx(0.010)


def test_a_mode_that_begins_anew_takes_its_first_set_point_at_once(fake_axis: Any) -> None:
    """Nothing runs that the set-point had to wait for, whatever 6068 says of the standstill."""
    one = ServoAlone(fake_axis(), 1, position_window_ms=500, **TO_POINT)
    for place_m in (0.005, 0.010):
        _go(one, place_m)
        assert not one.image.statusword & TAKEN
        one.run_ms(65)
        assert one.axis.motor_position_m() == pytest.approx(place_m)
        one.cycle(mode=8)
        one.cycle(mode=1)


def test_the_acknowledge_falls_as_soon_as_the_next_one_can_be_taken(fake_axis: Any) -> None:
    """Bit 4 is low long before the first set-point is reached: bit 12 falls there, not later."""
    one = ServoAlone(fake_axis(), 1, **TO_POINT)
    _go(one, 0.005)
    assert not one.image.statusword & TAKEN
    _go(one, 0.010)
    changes: dict[tuple[bool, bool], int] = {}
    for number in range(150):
        word = one.cycle()
        assert not word & TAKEN or not word & REACHED
        changes.setdefault((bool(word & TAKEN), bool(word & REACHED)), number)
    assert list(changes) == [(True, False), (False, False), (False, True)]
    assert changes[False, False] == pytest.approx(57, abs=1)
    assert changes[False, True] == pytest.approx(57 + 60, abs=2)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("away", "is_reached"), [(0, True), (500, True), (501, False)])
def test_a_speed_is_reached_within_606d_for_606e(
    fake_axis: Any, sign: int, away: int, is_reached: bool
) -> None:
    """|606C - 60FF| up to 606D counts, on either side of either direction."""
    for side in (1, -1):
        axis = fake_axis(motion=lambda time_s: sign * 0.01 * time_s)
        target = sign * UNITS_S + side * away
        one = ServoAlone(axis, 3, velocity_window=500, velocity_window_ms=20, **TO_POINT)
        one.cycle(target_velocity=target)
        assert not one.image.statusword & REACHED
        for _ in range(18):
            assert not one.cycle() & REACHED
        assert [bool(one.cycle() & REACHED) for _ in range(4)][-1] is is_reached


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("limit", "most_m_s"), [({"max_motor_speed": 120}, 0.02),
                            ({"max_profile_velocity": 0.03 * PER_M}, 0.03)],
)  # fmt: skip
def test_a_speed_that_is_limited_in_motion_and_free_again(
    fake_axis: Any, sign: int, limit: dict[str, Any], most_m_s: float
) -> None:
    """The lesser of 6080 and 607F counts from its write on; bit 11 says so."""
    one = ServoAlone(fake_axis(), 3, target_velocity=sign * 0.05 * PER_M, **TO_POINT)
    one.run_ms(10)
    assert one.cycle() & LIMITED == 0
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * 0.05)
    free = {name: getattr(one.image, name) for name in limit}
    one.write(**limit)
    one.run_ms(10)
    assert one.cycle() & LIMITED
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * most_m_s)
    one.write(**free)
    one.run_ms(10)
    assert one.cycle() & LIMITED == 0
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * 0.05)


def test_the_shape_of_a_ramp_changes_in_the_middle_of_it(fake_axis: Any) -> None:
    """From 0.05 m/s on sin2 takes pi/2 times as long for the other 0.05 m/s: 7.85 ms, not 5."""
    one = ServoAlone(fake_axis(), 3, **TO_POINT)
    one.cycle(target_velocity=0.1 * PER_M)
    one.run_ms(5)
    one.write(profile_type=1)
    one.run_ms(6)
    assert one.axis.demand_velocity_m_s() < 0.098
    one.run_ms(3)
    assert one.axis.demand_velocity_m_s() == pytest.approx(0.1)


@pytest.mark.parametrize("by", ["mode", "halt"])
def test_the_time_of_a_velocity_window_begins_anew_with_the_mode_and_after_a_halt(
    fake_axis: Any, by: str
) -> None:
    """606E = 10 ms: a target of 0 is near all the time, and reached 10 ms after each begin."""
    one = ServoAlone(fake_axis(), 3, velocity_window=5, velocity_window_ms=10)
    for _ in range(2):
        assert _cycles_until(one, REACHED) in (9, 10, 11)
        if by == "mode":
            one.cycle(mode=8, target_position=one.image.position_actual)
            for _ in range(20):
                one.cycle()
            assert one.cycle(mode=3) & REACHED == 0
        else:
            one.cycle(controlword=ON | 1 << 8)
            for _ in range(20):
                one.cycle()
            assert one.cycle(controlword=ON) & REACHED == 0


@pytest.mark.parametrize("is_high", [True, False])
def test_a_mode_that_begins_anew_has_acknowledged_nothing(fake_axis: Any, is_high: bool) -> None:
    """Bit 4 held high through another mode is no new set-point, and bit 12 none of the old one."""
    one = ServoAlone(fake_axis(), 1, **TO_POINT)
    one.cycle(controlword=ON | NEW, target_position=0.005 * PER_M)
    assert one.image.statusword & TAKEN
    one.cycle(mode=8)
    one.cycle(mode=1, controlword=ON | NEW * is_high)
    assert one.image.statusword & TAKEN == 0
    here_m = one.axis.motor_position_m()
    one.cycle(controlword=ON)
    one.cycle(controlword=ON | NEW, target_position=0.010 * PER_M)
    assert one.image.statusword & TAKEN
    one.run_ms(150)
    assert one.axis.motor_position_m() == pytest.approx(0.010)
    assert here_m < 0.010


def test_a_set_point_without_a_speed_leaves_the_axis_where_it_is(fake_axis: Any) -> None:
    """6081 = 0; the next one with a speed goes on from there."""
    one = ServoAlone(fake_axis(start_m=0.001), 1, **{**TO_POINT, "profile_velocity": 0})
    _go(one, 0.005)
    one.run_ms(100)
    assert one.axis.motor_position_m() == pytest.approx(0.001)
    one.write(profile_velocity=0.1 * PER_M)
    _go(one, 0.005, AT_ONCE)
    one.run_ms(100)
    assert one.axis.motor_position_m() == pytest.approx(0.005)


def test_the_time_of_a_position_window_begins_with_each_set_point(fake_axis: Any) -> None:
    """6068 = 20 ms, also where the axis stands on its new target already."""
    place_m = 100_000 / PER_M
    one = ServoAlone(fake_axis(start_m=place_m), 1, position_window_ms=20, **TO_POINT)
    for _ in range(2):
        one.cycle(controlword=ON | NEW, target_position=100_000)
        assert one.image.statusword & REACHED == 0
        one.cycle(controlword=ON)
        assert _cycles_until(one, REACHED) == 19
        for _ in range(5):
            assert one.cycle() & REACHED
