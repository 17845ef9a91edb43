"""Bits 11 and 12 of the statusword in csp, csv and cst, and what reaches the axis meanwhile."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import FOLLOWS, LIMITED, PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

RATED_N = DriveProfile().rated_force_n
MM, MM_S = PER_M / 1e3, PER_M / 1e3
# mode: target within, offset, beyond in both directions; what then reaches the axis (SI)
LIMITS: dict[str, Any] = {
    "software limits": (
        8, "target_position", "position_offset", 0.002 * PER_M, (-0.004, 0.003),
        {"software_limit_min": -0.004 * PER_M, "software_limit_max": 0.003 * PER_M},
    ),
    "motor speed": (
        9, "target_velocity", "velocity_offset", 4 * MM_S, (-0.005, 0.005), {"max_motor_speed": 30},
    ),
    "torque limits": (
        10, "target_torque", "torque_offset", 40, (-0.09 * RATED_N, 0.06 * RATED_N),
        {"negative_torque_limit": 90, "positive_torque_limit": 60},
    ),
    "most torque": (
        10, "target_torque", "torque_offset", 40, (-0.05 * RATED_N, 0.05 * RATED_N),
        {"negative_torque_limit": 90, "positive_torque_limit": 60, "max_torque": 50},
    ),
}  # fmt: skip


def _reached(one: ServoAlone) -> float:
    """Return what the axis has of the demand at the end of the cycle."""
    last = one.axis.commands[-1]
    if one.image.mode == 8:
        return float(last.position_m + last.velocity_m_s * (last.end_ns - last.time_ns) * 1e-9)
    if one.image.mode == 9:
        changed_s = (last.end_ns - last.time_ns) * 1e-9
        return float(last.velocity_m_s + last.acceleration_m_s2 * changed_s)
    return float(last.force_n)


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("name", LIMITS)
def test_a_demand_is_limited_on_either_side_and_free_again(
    fake_axis: Any, name: str, side: int
) -> None:
    """Target and offset together count: each alone is within the limits, their sum is not."""
    mode, target, offset, within, ends, objects = LIMITS[name]
    sign = 1 if side else -1
    # A force would drive the axis away in the meantime: it stands whatever is commanded
    axis = fake_axis(motion=(lambda _: 0.0) if mode == 10 else None)
    one = ServoAlone(axis, mode, **objects)
    usual = one.cycle(**{target: sign * within})
    assert usual & (LIMITED | FOLLOWS) == FOLLOWS
    scale = {8: PER_M, 9: PER_M, 10: 1000 / RATED_N}[mode]
    assert _reached(one) == pytest.approx(sign * within / scale, rel=1e-4)
    for _ in range(2):
        word = one.cycle(**{target: sign * within, offset: sign * within * 2})
        assert word & (LIMITED | FOLLOWS) == LIMITED
        assert _reached(one) == pytest.approx(ends[side], rel=1e-4)
    assert one.cycle(**{offset: 0}) & (LIMITED | FOLLOWS) == FOLLOWS
    assert _reached(one) == pytest.approx(sign * within / scale, rel=1e-4)


@pytest.mark.parametrize("sign", [1, -1])
def test_csp_runs_at_the_motor_speed_to_a_target_too_far(fake_axis: Any, sign: int) -> None:
    """60 rev/min of 10 mm: 10 um in each cycle of 1 ms, so that 25 um take three."""
    one = ServoAlone(fake_axis(), max_motor_speed=60)
    moved = []
    for _ in range(4):
        word = one.cycle(target_position=sign * 25e-6 * PER_M)
        moved.append((round(_reached(one) * 1e6), bool(word & LIMITED), bool(word & FOLLOWS)))
    yes, no = (True, False), (False, True)
    expected = [(10, *yes), (20, *yes), (25, *no), (25, *no)]
    assert moved == [(sign * um, *bits) for um, *bits in expected]


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("habit", ["zero", "value"])
def test_homing_takes_the_software_limits_along(fake_axis: Any, habit: Any, side: int) -> None:
    """Method 35: home is at 20 mm, and -4 and 3 mm from there are the ends, whatever 607C is."""
    one = ServoAlone(
        fake_axis(start_m=0.02), 6, homing_method=35, home_offset=7 * MM,
        software_limit_min=-4 * MM, software_limit_max=3 * MM,
        profile=DriveProfile(home_offset=habit),
    )  # fmt: skip
    one.cycle(controlword=0x1F)
    one.cycle()
    assert one.cycle() & FOLLOWS  # bit 12 of homing: attained
    assert one.image.position_actual == round((-7 if habit == "zero" else 7) * MM)
    one.cycle(mode=8, controlword=0x0F)
    far = one.image.position_actual + (20 if side else -20) * MM
    word = [one.cycle(target_position=far) for _ in range(3)][-1]
    assert word & LIMITED
    assert _reached(one) == pytest.approx(0.023 if side else 0.016, abs=1e-8)


NONE = 65535  # 6072, 60E0 and 60E1 at power on: no limit


@pytest.mark.parametrize("mode", [1, 8, 10])
@pytest.mark.parametrize(
    ("objects", "limits"),
    [
        ({"negative_torque_limit": 90, "positive_torque_limit": 60}, (NONE, 90, 60)),
        ({"negative_torque_limit": 60, "positive_torque_limit": 90}, (NONE, 60, 90)),
        ({"negative_torque_limit": 60}, (NONE, 60, NONE)),
        ({"positive_torque_limit": 60}, (NONE, NONE, 60)),
        ({"max_torque": 50}, (50, NONE, NONE)),
        (
            {"max_torque": 70, "negative_torque_limit": 60, "positive_torque_limit": 90},
            (70, 60, 90),
        ),
    ],
)
def test_what_is_recorded_of_torque_limits_acts_in_the_same_direction(
    fake_axis: Any, objects: dict[str, int], limits: tuple[int, int, int], mode: int
) -> None:
    """6072, then 60E1 and 60E0; the least of 6072 and that of a direction acts there."""
    axis = fake_axis(motion=lambda _: 0.0)
    one = ServoAlone(axis, mode)
    assert one.servo.torque_limits == (NONE, NONE, NONE)
    one.write(**objects)
    one.cycle()
    assert one.servo.torque_limits == limits
    most, negative, positive = limits
    acting = [min(most, each) * RATED_N / 1000 for each in (negative, positive)]
    assert list(axis.limits[-1]) == pytest.approx(acting)
    one.servo.reset(one.now_ns)
    assert one.servo.torque_limits == (NONE, NONE, NONE)
    assert list(axis.limits[-1]) == pytest.approx([NONE * RATED_N / 1000] * 2)


@pytest.mark.parametrize("start_mm", [0.0, 12.0, -12.0])
@pytest.mark.parametrize("offset", [0x7FFF_FFFF, -0x8000_0000, 0x7000_0000])
def test_target_and_offset_of_a_position_add_up_in_32_bits(
    fake_axis: Any, start_mm: float, offset: int
) -> None:
    """607A is what gives the place of the axis with 60B0, a number of 32 bits in any case."""
    one = ServoAlone(fake_axis(start_m=start_mm / 1e3), position_offset=offset)
    place = round(start_mm * MM)
    target = one.image.target_position
    assert -0x8000_0000 <= target <= 0x7FFF_FFFF
    assert (target + offset - place) % (1 << 32) == 0
    one.cycle()
    assert _reached(one) == pytest.approx(start_mm / 1e3, abs=1e-8)
    one.cycle(target_position=(target + 1000 + (1 << 31)) % (1 << 32) - (1 << 31))
    assert _reached(one) == pytest.approx(start_mm / 1e3 + 1000 / PER_M, abs=1e-8)
