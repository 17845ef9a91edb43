"""Positions by the scaling objects, and what a drive shows of its axis, by their formulas."""

from fractions import Fraction
from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.units import Units


def _units(**objects: int) -> tuple[Units, ProcessImage]:
    profile, image = DriveProfile(encoder_increments=10_000), ProcessImage()
    image.set_defaults(profile)
    for name, value in objects.items():
        setattr(image, name, value)
    return Units(profile, image), image


@pytest.mark.parametrize(
    ("objects", "factor"),
    [
        ({}, Fraction(1)),
        ({"feed": 5000}, Fraction(1, 2)),
        ({"feed": 30_000, "feed_shaft": 2}, Fraction(3, 2)),
        ({"gear_motor": 5, "gear_shaft": 2}, Fraction(2, 5)),
        ({"encoder_increments": 40_000, "encoder_revolutions": 3}, Fraction(3, 4)),
        ({"feed": 7, "gear_motor": 3}, Fraction(7, 30_000)),
    ],
)
@pytest.mark.parametrize("increments", [123_457, -123_457, 0])
def test_a_position_is_increments_by_the_scaling_objects(
    objects: dict[str, int], factor: Fraction, increments: int
) -> None:
    """feed * revolutions * shaft / (feed shaft * increments * motor), rounded half to even."""
    units, _ = _units(**objects)
    place_m = increments / 1e6
    assert units.position_units(place_m) == round(increments * factor)
    assert units.increments(place_m) == increments
    per_m = 1e6 * float(factor)
    assert units.position_m(777) == pytest.approx(777 / per_m)
    assert units.metres(777) == pytest.approx(777 / per_m)
    assert units.velocity_units_s(-0.25) == round(-0.25 * per_m)


def test_the_second_encoder_has_60e6_and_60eb_in_the_place_of_608f() -> None:
    usual = {"feed": 20_000, "encoder_increments": 10_000, "encoder_revolutions": 1}
    units, image = _units(**usual, second_increments=5000, second_revolutions=3)
    # 20000 * 3 / 5000 units per increment; 608F gives 2
    assert units.second_units(0.000_123) == 123 * 12
    assert units.position_units(0.000_123) == 123 * 2
    image.second_increments = 60_000
    units.update()
    assert units.second_units(0.000_123) == 123
    assert units.second_units(-3000.0) == (-3_000_000_000 + (1 << 31)) % (1 << 32) - (1 << 31)


@pytest.mark.parametrize("sign", [1, -1])
def test_home_is_where_it_was_found_last_and_gone_with_another_unit(sign: int) -> None:
    units, image = _units()
    for place_m, home in ((0.02, 500), (0.05 * sign, -sign * 700), (-0.01, 0)):
        units.set_home(place_m, home)
        assert units.is_homed
        assert units.home_units == home
        assert units.position_units(place_m) == home
        assert units.position_units(place_m + 0.001) == home + 1000
        assert units.position_m(home) == pytest.approx(place_m)
        assert units.origin_units == home - round(place_m * 1e6)
    units.update()
    assert units.is_homed  # nothing has changed
    image.feed *= 2
    units.update()
    assert (units.is_homed, units.origin_units, units.home_units) == (False, 0, 0)
    assert units.position_units(0.001) == 2000


def test_an_axis_without_a_second_encoder_shows_0(fake_axis: Any) -> None:
    one = ServoAlone(fake_axis(start_m=0.1))
    one.cycle()
    assert one.image.second_position == 0


@pytest.mark.parametrize("mode", [8, 9])
def test_demand_lag_and_torque_are_those_of_the_loop_that_runs(fake_axis: Any, mode: int) -> None:
    """Without a position demand the actual position is the demand, and there is no lag."""
    one = ServoAlone(fake_axis(start_m=0.02), mode)
    one.axis.motion = lambda time_s: 0.02
    one.cycle(target_position=0.0201 * PER_M, target_velocity=0.3 * PER_M)
    one.cycle()
    image = one.image
    demand = round((0.0201 if mode == 8 else 0.02) * PER_M)
    assert image.position_actual == round(0.02 * PER_M)
    assert (image.position_demand, image.position_demand_internal) == (demand, demand)
    assert image.following_error == demand - image.position_actual
    assert image.position_internal == image.position_actual


@pytest.mark.parametrize(("share", "shown"), [(0.25, 250), (-0.25, -250), (0.0, 0), (60, 0x7FFF)])
def test_torque_and_current_are_per_mille_of_the_rated_ones(
    fake_axis: Any, share: float, shown: int
) -> None:
    one = ServoAlone(fake_axis(motion=lambda _: 0.0), 10)
    one.axis.command_force(one.now_ns, share * DriveProfile().rated_force_n)
    one.servo.refresh(one.now_ns)
    assert (one.image.torque_actual, one.image.current_actual) == (shown, shown)


@pytest.mark.parametrize("mode", [8, 9])
def test_internal_values_are_increments_of_the_encoder_and_the_others_position_units(
    fake_axis: Any, mode: int
) -> None:
    """6063 and 60FC against 6064 and 6062, with half a unit to an increment (CiA 402-2)."""
    one = ServoAlone(fake_axis(start_m=0.02), mode)
    one.axis.motion = lambda time_s: 0.02
    one.write(feed=one.image.feed // 2)
    one.cycle(target_position=0.0201 * PER_M / 2)
    one.cycle()
    image = one.image
    demand_m = 0.0201 if mode == 8 else 0.02
    assert image.position_demand_internal == pytest.approx(demand_m * PER_M, abs=1)
    assert image.position_demand == pytest.approx(demand_m * PER_M / 2, abs=1)
    assert image.position_internal == pytest.approx(0.02 * PER_M, abs=1)
    assert image.position_actual == pytest.approx(0.02 * PER_M / 2, abs=1)
    assert image.following_error == image.position_demand - image.position_actual


@pytest.mark.parametrize("sign", [1, -1])
def test_what_is_too_large_for_32_bits_is_shown_as_the_largest(sign: int) -> None:
    """Velocity and lag end at the range of INTEGER32, a position goes round (CiA 402-2)."""
    units, _ = _units()
    assert units.velocity_units_s(sign * 1e5) == (0x7FFF_FFFF if sign > 0 else -0x8000_0000)
    assert units.deviation_units(sign * 1e5) == (0x7FFF_FFFF if sign > 0 else -0x8000_0000)
    assert units.velocity_units_s(sign * 0.25) == sign * 250_000
    assert units.position_units(sign * 2147.483648) == -0x8000_0000


def test_cst_begins_without_force_whatever_pushes_an_axis_without_power(fake_axis: Any) -> None:
    """A clamp or a weight presses on an axis that nobody holds: that is no demand of the drive."""
    axis = fake_axis(motion=lambda _: 0.0)
    axis.force_n = lambda: 123.0
    one = ServoAlone(axis, 10)
    first = next(command for command in axis.commands[2:] if command.kind.name == "FORCE")
    assert first.force_n == 0.0
    one.cycle(target_torque=100)
    assert axis.commands[-1].force_n == pytest.approx(0.1 * DriveProfile().rated_force_n)
