"""Assignments at the ends of what is allowed, and what a refusal of one names."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
Above = Callable[..., Settings]
TASK_RIG = "plc-timestamp.toml"


def _refused(settings_of: Read, path: Path, text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        settings_of(path, text)
    return caught.value


@pytest.mark.parametrize(
    ("key", "value", "name", "expected"),
    [
        ("start_ms", "0", "start_after_ns", 0),
        ("start_ms", "1000000000", "start_after_ns", 10**15),
        ("after_end_ms", "0", "after_end_ns", 0),
        ("after_end_ms", "10000000", "after_end_ns", 10**13),
        ("limit_s", "0.001", "limit_ns", 10**6),
        ("limit_s", "10000000", "limit_ns", 10**16),
        ("start_ms", "0.0000014", "start_after_ns", 1),  # rounded to a nanosecond
        ("optional_stop", "0", "optional_stop", False),
    ],
)
def test_the_first_and_the_last_time_of_an_operator_is_allowed(
    rig_file: Write, settings_of: Read, key: str, value: str, name: str, expected: object
) -> None:
    assert getattr(settings_of(rig_file(), f"plc:{key}={value}").operator, name) == expected


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("start_ms", "1000000001", "0 .. 1e9 ms"),
        ("after_end_ms", "10000001", "0 .. 1e7 ms"),
        ("limit_s", "0.0009", "0.001 .. 1e7 s"),
        ("limit_s", "10000001", "0.001 .. 1e7 s"),
        ("start_ms", "-0.001", "0 .. 1e9 ms"),
        ("after_end_ms", "-0.001", "0 .. 1e7 ms"),
        ("optional_stop", "2", "0, 1"),
        ("optional_stop", "01", "0, 1"),
    ],
)
def test_the_next_time_is_refused(
    rig_file: Write, settings_of: Read, key: str, value: str, allowed: str
) -> None:
    error = _refused(settings_of, rig_file(), f"plc:{key}={value}")
    assert (error.value, error.allowed) == (value, allowed)


@pytest.mark.parametrize(
    ("text", "value", "words"),
    [
        ("drive:servo.family=sercos", "sercos", "does not change the family"),
        ("bus:can1.carrier=ethercat", "ethercat", "does not change what carries a segment"),
        ("bus:can1.bitrate=1000000000000000", "1000000000000000", "bitrate: "),
        ("distance:limiter=none", "none", "limiter: "),
        ("plc:silent_from_ms=5", "silent_from_ms", "the rig has no PLC task"),
    ],
)
def test_a_refusal_has_the_value_that_was_written(
    rig_file: Write, settings_of: Read, text: str, value: str, words: str
) -> None:
    error = _refused(settings_of, rig_file(), text)
    assert error.value == value
    assert words in error.message


@pytest.mark.parametrize(
    ("text", "allowed"),
    [
        ("set:Q.kenngr.messachse=1", "channel, Z, zero_offsets, tools"),
        ("drive:motor.lag_limit_mm=1", "servo, all"),
        ("bus:can2.bitrate=500000", "can1, all"),
        ("distance:limitr=clamp", "limiter"),
        ("distance:q=1", "derivative_of, limiter, derivative"),
        ("drive:servo.lag_limit_m=1", "lag_limit_mm"),
        ("plant:q.surface_mm=1", "z, probe"),
    ],
)
def test_a_name_that_nothing_has_is_refused_with_those_there_are(
    rig_file: Write, settings_of: Read, text: str, allowed: str
) -> None:
    found = _refused(settings_of, rig_file(), text).allowed
    assert found is not None
    words = found if isinstance(found, str) else ", ".join(map(str, found))
    assert words.startswith(allowed)


def test_a_key_that_resembles_none_is_refused_with_all_keys_of_the_drives(
    rig_above: Above,
) -> None:
    """Each key once, though two drives have it."""
    with pytest.raises(UserError) as caught:
        rig_above("probe-z.toml", "[drive.other]\nlead_mm = 5.0\n", "drive:all.qqqqqqqq=1")
    keys = str(caught.value.allowed).split(", ")
    assert "lead_mm" in keys
    assert len(keys) == len(set(keys))


@pytest.mark.parametrize("column", ["drive:servo.eds", "drive:all.eds"])
def test_a_folder_is_no_file_of_a_drive(
    rig_file: Write, settings_of: Read, tmp_path: Path, column: str
) -> None:
    (tmp_path / "drives.eds").mkdir()
    text = f"{column}={tmp_path / 'drives.eds'}"
    error = _refused(settings_of, rig_file(), text)
    assert "eds names no file" in error.message


def test_a_plc_without_a_terminal_has_no_keys_of_one(rig_above: Above, tmp_path: Path) -> None:
    program = tmp_path / "task.py"
    program.write_text("")
    task = f'[plc]\nperiod_us = 1000\nprogram = "{program.as_posix()}"\n'
    with pytest.raises(UserError, match="no terminal") as caught:
        rig_above("probe-z.toml", task, "plc:terminal.filter_us=5")
    assert caught.value.value == "terminal.filter_us"
    changed = rig_above("probe-z.toml", task, "plc:busy_us=20").rig.plc_task
    assert changed is not None
    assert (changed.busy_us, changed.terminal) == (20, None)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("plc:period_us=49", "49"),
        ("plc:period_us=1000001", "1000001"),
        ("plc:terminal.stamp_edge=both", "both"),
        ("plc:task=1.5", "1.5"),
        ("plc:task=first", "first"),
    ],
)
def test_a_key_of_the_task_that_cannot_be_is_refused_with_its_value(
    rig_above: Above, text: str, value: str
) -> None:
    with pytest.raises(UserError) as caught:
        rig_above(TASK_RIG, "", text)
    assert caught.value.value == value
    assert text.removeprefix("plc:").partition("=")[0] + ": " in caught.value.message


@pytest.mark.parametrize(
    ("texts", "fits"),
    [
        (("plc:Z.probing_signal=0; 1 at=5ms",), False),
        (("plc:Z.probing_position=1; 2 at=5ms",), False),
        (("plc:Z.override=50",), True),
    ],
)
def test_beside_a_task_no_column_gives_the_probing_signal(
    rig_above: Above, texts: tuple[str, ...], fits: bool
) -> None:
    if fits:
        assert [rule.text for rule in rig_above(TASK_RIG, "", *texts).plc] == ["50"]
        return
    with pytest.raises(UserError, match="PLC task of this rig gives the probing signal") as caught:
        rig_above(TASK_RIG, "", *texts)
    assert caught.value.value == texts[0].removeprefix("plc:").partition("=")[0]


def test_rules_of_columns_stand_in_their_order_and_each_column_once(settings_of: Read) -> None:
    rig = Path(__file__).parents[2] / "testplans" / "rigs" / "drive-functions.toml"
    limit, window = "plc:Z.torque_limit", "plc:Z.lag_window"
    found = settings_of(rig, f"{limit}=1; 2 at=M50", f"{window}=3", f"{limit}=4; 5 at=M51")
    assert [rule.text for rule in found.plc] == ["3", "4", "5 at=M51"]


def test_variables_of_sensors_begin_at_0_by_their_names(rig_above: Above) -> None:
    """So that a program may read one before the first value of its sensor."""
    settings = rig_above("distance-z-variable.toml")
    assert settings.rig.plc
    assert settings.external == {name.removeprefix("V.E."): 0.0 for name in settings.rig.plc}
    name = next(iter(settings.rig.plc))
    column = f"plc:Z.override=50 at={name}"
    assert [rule.moment.word for rule in rig_above("distance-z-variable.toml", "", column).plc] == [
        name.upper()
    ]


@pytest.mark.parametrize("bitrate", [250_000, 800_000, 1_000_000])
def test_a_bitrate_is_taken_with_all_its_digits(
    rig_file: Write, settings_of: Read, bitrate: int
) -> None:
    path = rig_file(("bitrate = 1_000_000", "bitrate = 500_000"))
    assert settings_of(path, f"bus:can1.bitrate={bitrate}").segment["can1"].bitrate == bitrate


def test_a_value_of_a_tool_that_never_acts_is_noted_with_its_column(
    rig_file: Write, settings_of: Read
) -> None:
    text = "set:tools.wz[1].radius=30000"
    notes = settings_of(rig_file(), text).notes
    assert any(f"({text.partition('=')[0]})" in note and "D1 is refused" in note for note in notes)


# --- once --------------------------------------------------------------------------------------


def _counted() -> tuple[list[object], Any]:
    calls: list[object] = []

    def work(settings: Settings, of: str = "", *, more: int = 0) -> tuple[object, ...]:
        calls.append((of, more))
        return (len(calls), of, more)

    return calls, once(work)


def test_settings_that_may_change_are_asked_each_time(rig_file: Write, settings_of: Read) -> None:
    calls, work = _counted()
    settings = settings_of(rig_file())
    assert [work(settings, "a")[0], work(settings, "a")[0]] == [1, 2]
    settings.is_settled = True
    assert [work(settings, "a")[0], work(settings, "a")[0]] == [3, 3]
    settings.is_settled = False  # what is known is of what they were
    assert work(settings, "a")[0] == 4
    assert len(calls) == 4


def test_settled_settings_answer_once_for_each_question(rig_file: Write, settings_of: Read) -> None:
    """Of each function, of each argument, by name or by place; and other settings anew."""
    path = rig_file()
    calls, work = _counted()
    _, other = _counted()
    settings = settings_of(path)
    settings.is_settled = True
    asked = [("a", 0), ("b", 0), ("a", 1), ("b", 1)]
    for _ in range(2):
        for of, more in asked:
            assert work(settings, of, more=more)[1:] == (of, more)
    assert calls == asked
    assert other(settings, "b", more=1)[0] == 1
    again = settings_of(path)
    again.is_settled = True
    assert work(again, "a", more=0)[0] == 5


def test_what_circles_may_miss_follows_from_the_list_of_the_channel(
    rig_file: Write, settings_of: Read
) -> None:
    """Lengths in 0.1 um and shares in 0.1 percent: P-CHAN-00059, 00060, 00171, 00172."""
    limits = settings_of(
        rig_file(),
        "set:channel.mittelpkt_diff=20000",
        "set:channel.mittelpkt_faktor=3",
        "set:channel.max_radius_diff_circle=5000",
        "set:channel.max_proz_radius_diff_circle=7",
    ).offset_tables.circle
    assert dataclasses.astuple(limits) == (2.0, 0.003, 0.5, 0.007)


@pytest.mark.parametrize("flag", ["meas_pcs_value_no_probe_radius", "cycle_changes_modal"])
@pytest.mark.parametrize("value", [0, 1])
def test_tables_of_offsets_follow_the_flags_of_the_channel(
    rig_file: Write, settings_of: Read, flag: str, value: int
) -> None:
    tables = settings_of(rig_file(), f"set:channel.{flag}={value}").offset_tables
    if flag == "cycle_changes_modal":
        assert tables.cycle_changes_modal is bool(value)
    else:
        assert tables.ball_radius_counts is not bool(value)
