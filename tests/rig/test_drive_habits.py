"""Named drive profiles: every key means the same in the table, in a rig and in the drive."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import eds_text, object_dictionary
from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import (
    habits,
    named_profile,
    profile_keys,
    profile_listing,
    profile_names,
)
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]


def test_generic_is_the_drive_without_a_profile() -> None:
    assert named_profile("generic") == DriveProfile()


def test_every_field_of_the_drive_has_a_key_and_the_other_way_round() -> None:
    known = {field.name for field in dataclasses.fields(DriveProfile)} - {"position_factor"}
    assert {habit.field for habit in habits().values()} == known


@pytest.mark.parametrize("name", profile_names())
def test_every_value_lies_within_its_own_limits(name: str) -> None:
    for key, value in profile_keys(name).items():
        habit = habits()[key]
        if habit.words:
            assert value in habit.words
        elif habit.low is not None and habit.high is not None:
            assert isinstance(value, int | float)
            assert habit.low <= value <= habit.high


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_is_a_drive_with_an_eds_that_can_be_read(name: str) -> None:
    profile = named_profile(name)
    dictionary = object_dictionary(3, profile)
    for index, sub in variables():
        has = index in dictionary and (not sub or sub in dictionary[index].subindices)
        assert has == profile.has_object(index, sub)
    assert eds_text(profile) == eds_text(named_profile(name))


def test_a_rig_names_a_profile_and_changes_single_keys(rig_file: Write) -> None:
    path = rig_file(
        ("lead_mm = 10.0", 'profile = "lenze-i700-like"\nlead_mm = 5.0\ndead_time_us = 100')
    )
    profile = read_rig(path)[0].drive["servo"].make()
    assert profile == dataclasses.replace(
        named_profile("lenze-i700-like"), lead_um=5_000, dead_time_ns=100_000
    )
    assert (profile.latch_mode, profile.grid_ns) == ("linear", 250_000)


def test_a_base_keeps_its_keys_when_the_profile_changes(rig_file: Write, tmp_path: Path) -> None:
    rig_file(("lead_mm = 10.0", "lead_mm = 5.0\ninput_delay_us = 7.0"))
    above = tmp_path / "above.toml"
    above.write_text('base = "rig.toml"\n[drive.servo]\nprofile = "epos4-like"\n')
    profile = read_rig(above)[0].drive["servo"].make()
    assert (profile.lead_um, profile.input_delay_ns) == (5_000, 7_000)
    assert not profile.has_object(0x60D1)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('profile = "lenze"', "lenze-i700-like"),
        ('rearm = "never"', "zero_first"),
        ("status_delay_cycles = 3", "2"),
        ('toggle_bits = "yes"', "toggle_bits"),
    ],
)
def test_a_wrong_habit_is_told_with_what_is_allowed(
    rig_file: Write, line: str, message: str
) -> None:
    with pytest.raises(UserError) as caught:
        read_rig(rig_file(("lead_mm = 10.0", line)))
    assert message in str(caught.value)
    assert caught.value.line is not None


@pytest.mark.parametrize(
    "values", [{"lacks": "60D1,60D2"}, {"lacks": "0x60D1"}, {"trigger_sources": "one"}]
)
def test_a_list_that_cannot_be_read_is_refused(values: dict[str, str]) -> None:
    with pytest.raises(UserError, match="such as"):
        DriveProfile(**values)  # type: ignore[arg-type]


def test_the_listing_names_every_profile_and_what_is_special_in_it() -> None:
    lines = profile_listing(None).splitlines()
    assert [line.split()[0] for line in lines] == list(profile_names())
    assert lines[0] == "generic"
    assert "counters_cleared_on_disarm = True" in lines[profile_names().index("epos4-like")]
    title, *rows = profile_listing("generic").splitlines()
    assert title.startswith("generic; ")
    assert [line.split(" = ")[0].strip() for line in rows[::2]] == list(habits())
    assert [line.strip() for line in rows[1::2]] == [habit.meaning for habit in habits().values()]
    with pytest.raises(UserError, match="no such drive profile"):
        profile_listing("epos5")


def test_a_plan_changes_the_drive(rig_file: Write, settings_of: Callable[..., Settings]) -> None:
    path = rig_file(("lead_mm = 10.0", "lead_mm = 5.0\ninput_delay_us = 4.0"))
    settings = settings_of(
        path,
        "drive:servo.input_filter_us=250",
        "drive:servo.profile=lenze-i700-like",
        "drive:servo.toggle_bits=yes",
        "drive:servo.trigger_sources=1",
        "drive:servo.input_jitter_us=0.5",
    )
    assert settings.rig.drive["servo"].make() == dataclasses.replace(
        named_profile("lenze-i700-like"),
        lead_um=5_000,
        input_filter_ns=250_000,
        input_jitter_ns=500,
        toggle_bits=True,
        trigger_sources="1",
    )


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("drive:servo.profile=lenze", "lenze-i700-like"),
        ("drive:servo.toggle_bits=perhaps", "toggle_bits"),
        ("drive:servo.input_delay_us=-1", "greater than or equal to 0"),
        ("drive:servo.leed_mm=10", "lead_mm"),
        ("drive:motor.lead_mm=10", "servo"),
    ],
)
def test_a_wrong_column_for_a_drive_is_told(
    rig_file: Write, settings_of: Callable[..., Settings], assignment: str, message: str
) -> None:
    with pytest.raises(UserError) as caught:
        settings_of(rig_file(), assignment)
    assert message in str(caught.value)


def test_the_documents_describe_every_profile() -> None:
    text = (Path(__file__).parents[2] / "docs" / "touch-probe.md").read_text("utf-8")
    described = [line.split("`")[1] for line in text.splitlines() if line.startswith("| `")]
    assert [name for name in described if name in profile_names()] == list(profile_names())


def test_the_keys_of_a_profile_are_marked_where_they_differ_from_generic() -> None:
    usual = profile_keys("generic")
    for name in profile_names():
        rows = profile_listing(name).splitlines()[1::2]
        marked = [row.split(" = ")[0].removeprefix("* ") for row in rows if row.startswith("* ")]
        assert marked == [key for key, value in profile_keys(name).items() if value != usual[key]]


@pytest.mark.parametrize(
    ("name", "rows"),
    [
        # a word, a number with its unit, one without
        ("late-status", ["sampling = before_rpdo  (after_rpdo)",
                         "status_delay_cycles = 2 SYNC  (0)", "value_delay_cycles = 1 SYNC  (0)"]),
        ("akd-like", ["input_delay_us = 3.0 us  (4.0)",
                      "delay_compensation_us = 136.333 us  (0.0)"]),
        ("lenze-i950-like", ["min_pulse_us = 4.0 us  (0.0)"]),
        # flags, and a list that generic has not
        ("epos4-like", ["counters_cleared_on_disarm = True  (False)",
                        'option_codes = 605A:6  ("")']),
        # lists of both
        ("ax8000-like", ["trigger_sources = 1 2 3 4 5 6  (1 2 5 6)", "source_1 = 3  (1)",
                         "source_2 = 3  (2)"]),
    ],
)  # fmt: skip
def test_what_generic_has_instead_is_in_brackets(name: str, rows: list[str]) -> None:
    """The values are those of `profiles.csv`; the unit is not repeated."""
    shown = profile_listing(name).splitlines()[1::2]
    assert [row for row in shown if row.removeprefix("* ") in rows] == [f"* {row}" for row in rows]


@pytest.mark.parametrize("name", profile_names())
def test_a_key_has_its_value_its_unit_and_brackets_only_where_it_differs(name: str) -> None:
    """Without the brackets of the others a row is as in the listing of `generic`."""
    usual = dict(zip(habits(), profile_listing("generic").splitlines()[1::2], strict=True))
    title, *rows = profile_listing(name).splitlines()
    assert title == f"{name}; * = not as in generic, with what that has in brackets"
    for (key, value), row in zip(profile_keys(name).items(), rows[::2], strict=True):
        unit = f" {habits()[key].unit}" if habits()[key].unit else ""
        if value == profile_keys("generic")[key]:
            assert row == usual[key]
            assert "(" not in row
            continue
        text, _, instead = row.partition("  (")
        assert text == f"* {key} = {value}{unit}"
        of_generic = usual[key].removeprefix(f"  {key} = ").removesuffix(unit)
        assert instead == f"{of_generic})"


def test_an_empty_text_of_a_profile_is_shown_as_one() -> None:
    rows = {row.strip() for row in profile_listing("generic").splitlines()}
    assert {'lacks = ""', 'option_codes = ""'} <= rows
