"""Positions that the second encoder latches, and bit 11 where a torque limit of an object acts."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS

OFFSET_M, SPEED_M_S = 0.002, 0.5
RISING = 0x11
NO_LIMIT = 0xFFFF


@pytest.mark.parametrize("home_units", [None, 0, -70_000])
@pytest.mark.parametrize("second_increments", [1 << 20, 5000])
@pytest.mark.parametrize(
    ("chosen", "word", "offset_m"),
    [
        ("second", RISING, OFFSET_M),
        ("function_bit", RISING | 1 << 6, OFFSET_M),
        ("function_bit", RISING, 0.0),
        ("motor", RISING, 0.0),
        ("motor", RISING | 1 << 6, 0.0),
    ],
)
def test_a_latch_of_the_second_encoder_is_a_position_as_one_of_the_first(
    fake_axis: Any,
    fake_signal: Any,
    chosen: Any,
    word: int,
    offset_m: float,
    second_increments: int,
    home_units: int | None,
) -> None:
    """The control compares it with 6064: units and home are those; 60E6 counts in 60E4 alone."""
    edge_ns = 5 * MS + 300_000
    axis = fake_axis(motion=lambda time_s: SPEED_M_S * time_s, encoder_2_m=OFFSET_M)
    profile = DriveProfile(latch_encoder=chosen, input_delay_ns=0)
    one = ServoAlone(axis, profile=profile, signals=(fake_signal(axis, [edge_ns]), None))
    one.write(second_increments=second_increments)
    if home_units is not None:
        one.servo.scaling.set_home(0.0, home_units)
    one.cycle(probe_function=word)
    for _ in range(3):
        one.cycle()
    assert one.image.probe_status & 3 == 3
    wanted = round((SPEED_M_S * edge_ns * 1e-9 + offset_m) * PER_M) + (home_units or 0)
    assert one.image.latch_1_positive == pytest.approx(wanted, abs=1)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("most", "positive", "negative", "per_mille", "is_shown"),
    [
        (NO_LIMIT, NO_LIMIT, NO_LIMIT, 100, False),
        (80, NO_LIMIT, NO_LIMIT, 80, True),
        (NO_LIMIT, 70, 90, 70, True),
        (60, 70, 90, 60, True),
        (NO_LIMIT, NO_LIMIT, 70, 100, False),
        (120, NO_LIMIT, NO_LIMIT, 100, False),
    ],
)
def test_bit_11_shows_that_a_torque_limit_acts(
    fake_axis: Any,
    sign: int,
    most: int,
    positive: int,
    negative: int,
    per_mille: int,
    is_shown: bool,
) -> None:
    """CST asks for 10 %. positive: 60E0 in the direction of the torque, negative: 60E1 against."""
    if sign < 0:
        positive, negative = negative, positive
    one = ServoAlone(
        fake_axis(), 10, max_torque=most, positive_torque_limit=positive,
        negative_torque_limit=negative, target_torque=sign * 100,
    )  # fmt: skip
    one.cycle()
    status = one.cycle()
    assert one.image.torque_actual == sign * per_mille
    assert bool(status & LIMITED) == is_shown
    one.write(max_torque=50)
    assert one.cycle() & LIMITED
    assert one.image.torque_actual == sign * 50
    one.write(target_torque=sign * 40)
    assert not one.cycle() & LIMITED


@pytest.mark.parametrize("mode", [8, 9])
@pytest.mark.parametrize("sign", [1, -1])
def test_bit_11_shows_a_torque_limit_while_the_axis_is_pushed(
    fake_axis: Any, sign: int, mode: int
) -> None:
    """Positions and velocities too: against a stop the force is what the limit leaves of it."""
    one = ServoAlone(fake_axis(), mode)
    rated_n = one.servo.limits.rated_n

    def force_n() -> float:
        negative_n, positive_n = one.axis.limits[-1] if one.axis.limits else (1e9, 1e9)
        return max(-negative_n, min(sign * 0.5 * rated_n, positive_n))

    one.axis.force_n = force_n
    assert not one.cycle() & LIMITED
    for per_mille, is_shown in ((300, True), (600, False), (500, True), (NO_LIMIT, False)):
        one.write(max_torque=per_mille)
        assert bool(one.cycle() & LIMITED) == is_shown
        assert one.image.torque_actual == sign * min(per_mille, 500)
    for against, is_shown in ((True, False), (False, True)):
        one.write(positive_torque_limit=NO_LIMIT, negative_torque_limit=NO_LIMIT)
        is_negative = (sign < 0) is not against
        name = "negative_torque_limit" if is_negative else "positive_torque_limit"
        one.write(**{name: 300})
        assert bool(one.cycle() & LIMITED) == is_shown
