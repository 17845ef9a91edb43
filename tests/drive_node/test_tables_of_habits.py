"""Habits of drives: values of their table and of plans, allowed values, and what follows."""

from fractions import Fraction
from typing import Any

import pytest

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
from axisrig.kernel.errors import UserError


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
    for factor in (1, Fraction(1, 16), 5):  # what the bus spoke before says nothing
        usual = DriveProfile(lead_um=5000, position_factor=Fraction(factor))
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
    profile = DriveProfile(trigger_sources="1 5 -2", lacks="60D1 60D0.2 1018.0")
    assert profile.source_values == {1, 5, -2}
    asked = ((0x60D1, 0), (0x60D1, 3), (0x60D0, 2), (0x60D0, 1), (0x60D0, 0), (0x1018, 1))
    found = [profile.has_object(*key) for key in asked]
    assert found == [False, False, False, True, True, True]
    assert not profile.has_object(0x1018)  # sub-index 0 alone


def test_times_and_lengths_of_a_rig_are_whole_in_the_unit_of_the_profile() -> None:
    """us become ns and mm become um, to the nearest one: 0.57 us are 570 ns, 1.001 mm 1001 um."""
    found = {
        habit.field[-3:]: habit for habit in habits().values() if habit.field[-3:] in ("_ns", "_um")
    }
    assert set(found) == {"_ns", "_um"}
    for habit in found.values():
        for thousandths in range(1, 20_000):
            assert habit.in_profile(thousandths / 1000) == thousandths
        assert habit.in_profile(4) == 4000
    others = [habit for habit in habits().values() if habit.field[-3:] not in ("_ns", "_um")]
    assert all(habit.in_profile(7) == 7 for habit in others)
