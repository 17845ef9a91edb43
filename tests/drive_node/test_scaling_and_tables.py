"""Scaling objects, sampled values and the tables of habits, each value by its formula."""

from fractions import Fraction
from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.objects import Allowed
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import (
    habits,
    in_lengths,
    make_profile,
    named_profile,
    profile_names,
    value_of,
)
from axisrig.bench.drive.cia402.functions.units import Units, scaled
from axisrig.kernel.errors import UserError


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


@pytest.mark.parametrize("value", range(-13, 14))
def test_halves_are_rounded_to_the_even_number(value: int) -> None:
    for factor in (Fraction(1, 2), Fraction(3, 2), Fraction(1, 4), Fraction(2, 3)):
        assert scaled(value, factor) == round(value * factor)


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


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_the_second_encoder_is_so_many_syncs_old(fake_axis: Any, delay: int) -> None:
    """10 um in each cycle; before there were so many samples the oldest one is shown."""
    axis = fake_axis(motion=lambda time_s: 0.01 * time_s, encoder_2_m=0.5)
    one = ServoAlone(axis, profile=DriveProfile(second_delay_cycles=delay))
    shown = []
    for _ in range(8):
        one.cycle()
        shown.append(round((one.image.second_position / PER_M - 0.5) * 1e5))
    now = round(one.now_ns / 1e6)
    assert shown[-4:] == [now - 3 - delay, now - 2 - delay, now - 1 - delay, now - delay]


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_samples_apart_from_the_sync_are_counted_and_those_of_it_are_not(
    fake_axis: Any, delay: int
) -> None:
    """Taken 0.6 ms after each SYNC the value is that of as many such samples before."""
    axis = fake_axis(motion=lambda time_s: 0.01 * time_s, encoder_2_m=0.5)
    one = ServoAlone(axis, profile=DriveProfile(second_delay_cycles=delay))
    for _ in range(6):
        one.cycle()
        one.run_ms(0.6)
        one.servo.refresh(one.now_ns, is_apart=True)
    shown_ms = (one.image.second_position / PER_M - 0.5) * 1e5
    assert shown_ms == pytest.approx(one.now_ns / 1e6 - delay, abs=0.01)


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


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("", (0, -1, 1 << 31), ()),
        ("0|2..240", (0, 2, 3, 240), (1, -1, 241)),
        ("5", (5,), (4, 6)),
        ("0x10..0x1F", (16, 31), (15, 32)),
        ("-3..-1|7", (-3, -1, 7), (-4, 0, 8)),
        ("mask 0x0303", (0, 1, 0x0303, 0x0200), (4, 0x0304, 0x10000)),
    ],
)
def test_allowed_values_are_ranges_with_both_ends_or_bits(
    text: str, inside: tuple[int, ...], outside: tuple[int, ...]
) -> None:
    allowed = Allowed.parse(text)
    assert all(value in allowed for value in inside)
    assert not any(value in allowed for value in outside)


def test_each_habit_has_values_of_its_type_within_its_limits() -> None:
    types = {"whole": int, "number": float, "flag": bool, "text": str}
    for habit in habits().values():
        for name in profile_names():
            value = habit.values[name]
            kind = str if habit.words else types[habit.type]
            assert type(value) is kind, (habit.key, name)
            assert not habit.words or value in habit.words
            if kind in (int, float):
                assert habit.low is None or habit.low <= value  # type: ignore[operator]
                assert habit.high is None or value <= habit.high  # type: ignore[operator]
    for name in profile_names():
        assert make_profile({k: h.values[name] for k, h in habits().items()}) == named_profile(name)


@pytest.mark.parametrize(
    ("key", "text", "value"),
    [
        ("input_delay_us", "4", 4),
        ("input_delay_us", "4.5", 4.5),
        ("toggle_bits", "yes", True),
        ("toggle_bits", "False", False),
        ("toggle_bits", "2", "2"),
        ("option_codes", "12", "12"),
        ("no_such_key", "yes", True),
        ("no_such_key", "12", 12),
        ("no_such_key", "word", "word"),
    ],
)
def test_cells_of_a_plan_are_read_by_the_type_of_their_habit(
    key: str, text: str, value: Any
) -> None:
    found = value_of(key, text)
    assert (found, type(found)) == (value, type(value))


def test_habits_are_in_the_unit_of_the_profile() -> None:
    """us become ns, mm become um, whole ones by rounding; a count stays."""
    made = make_profile({"input_delay_us": 1.5, "lead_mm": 5.0, "status_delay_cycles": 2})
    assert (made.input_delay_ns, made.lead_um, made.status_delay_cycles) == (1500, 5000, 2)
    assert make_profile({"input_delay_us": 0.0004}).input_delay_ns == 0


def test_a_position_unit_of_a_length_divides_the_lead() -> None:
    usual = DriveProfile(lead_um=5000)
    made = in_lengths(usual, 0.1)
    assert made.units_per_mm == 10_000
    assert made.units_per_revolution == 50_000
    assert made.encoder_increments == usual.encoder_increments
    with pytest.raises(UserError, match="lead_mm = 5"):
        in_lengths(usual, 0.3)


@pytest.mark.parametrize(
    ("increments", "window"),
    [(2**17, 0.5 * 2**17 / 10), (2**20, 0.5 * 2**20 / 10), (2**24, 0xFFFF), (2, 1)],
)
def test_windows_of_16_bits_are_at_most_what_these_hold(increments: int, window: float) -> None:
    """606D is 0.5 mm/s and 6067 is 0.01 mm, of 32 bits; both are at least a unit."""
    profile = DriveProfile(encoder_increments=increments, lead_um=10_000)
    assert profile.object_defaults["velocity_window"] == round(window)
    assert profile.object_defaults["position_window"] == max(1, round(increments / 1000))


def test_sources_of_a_profile_are_words_of_its_text() -> None:
    profile = DriveProfile(trigger_sources="1 5 -2", lacks="60D1 60D0.2")
    assert profile.source_values == {1, 5, -2}
    asked = ((0x60D1, 0), (0x60D1, 3), (0x60D0, 2), (0x60D0, 1))
    assert [profile.has_object(*key) for key in asked] == [False, False, False, True]
