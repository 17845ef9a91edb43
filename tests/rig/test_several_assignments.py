"""Several assignments of one run: each keeps what those before it have changed, in either order."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.rig.settings import Settings

Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RIG = RIGS / "plc-timestamp.toml"


def _task(settings: Settings) -> Any:
    task = settings.rig.plc_task
    assert task is not None
    return task


# column: a value and another one, how it is read, what it reads for them
CHANGES: dict[str, tuple[tuple[str, str], Callable[[Settings], Any], tuple[Any, Any]]] = {
    "drive:servo.lag_limit_mm": (("2", "3"), lambda s: s.rig.drive["servo"].lag_limit_mm, (2, 3)),
    "distance:limiter": (("clamp", "slope"), lambda s: s.rig.distance.limiter, ("clamp", "slope")),
    "plc:busy_us": (("100", "150"), lambda s: _task(s).busy_us, (100, 150)),
    "drive:all.missing_cycles": (("5", "6"), lambda s: s.rig.drive["servo"].missing_cycles, (5, 6)),
    "distance:derivative_of": (
        ("error", "feedback"), lambda s: s.rig.distance.derivative_of, ("error", "feedback"),
    ),
    "plc:terminal.filter_us": (("5", "7.5"), lambda s: _task(s).terminal.filter_us, (5, 7.5)),
    "plc:watchdog_cycles": (("7", "8"), lambda s: _task(s).watchdog_cycles, (7, 8)),
    "bus:can1.bitrate": (("500000", "800000"), lambda s: s.segment["can1"].bitrate,
                         (500_000, 800_000)),
    "bus:all.queue": (("mailbox", "fifo"), lambda s: s.segment["can1"].queue, ("mailbox", "fifo")),
    "plc:start_ms": (("5", "6"), lambda s: s.operator.start_after_ns, (5_000_000, 6_000_000)),
    "plc:optional_stop": (("1", "0"), lambda s: s.operator.optional_stop, (True, False)),
    "plc:limit_s": (("7", "8"), lambda s: s.operator.limit_ns, (7 * 10**9, 8 * 10**9)),
    "plc:after_end_ms": (("3", "4"), lambda s: s.operator.after_end_ns, (3_000_000, 4_000_000)),
    "plc:V.E.FEED": (("9", "-9"), lambda s: s.external["FEED"], (9.0, -9.0)),
    "set:Z.kenngr.probing_offset": (
        ("20000", "10000"), lambda s: s.axis["Z"].mm("kenngr.probing_offset"), (2.0, 1.0),
    ),
    "set:channel.meas_error_no_signal": (
        ("1", "0"), lambda s: s.channel.flag("meas_error_no_signal"), (True, False),
    ),
    "set:zero_offsets.np_grp[1].achse[0].versch": (
        ("5", "-6"), lambda s: s.offset_tables.zero_offsets.shift_mm(1, 0), (0.0005, -0.0006),
    ),
}  # fmt: skip


@pytest.mark.parametrize("order", [1, -1], ids=["in order", "in the other order"])
def test_each_of_several_assignments_keeps_those_before_it(settings_of: Read, order: int) -> None:
    columns = list(CHANGES)[::order]
    settings = settings_of(RIG, *(f"{column}={CHANGES[column][0][0]}" for column in columns))
    for column, (_, read, (expected, _)) in CHANGES.items():
        assert read(settings) == expected, column
    assert [item.column for item, _ in settings.assigned] == columns


def test_of_two_assignments_of_a_column_the_last_one_counts(settings_of: Read) -> None:
    """Whatever stands between the two."""
    texts = [f"{column}={CHANGES[column][0][at]}" for at in (0, 1) for column in CHANGES]
    settings = settings_of(RIG, *texts)
    for column, (_, read, (_, expected)) in CHANGES.items():
        assert read(settings) == expected, column


@pytest.mark.parametrize("column", CHANGES)
def test_an_assignment_changes_nothing_else_and_not_what_the_files_have(
    settings_of: Read, column: str
) -> None:
    values, read, (expected, _) = CHANGES[column]
    before, after = settings_of(RIG), settings_of(RIG, f"{column}={values[0]}")
    assert read(after) == expected
    for other, (_, other_read, _) in CHANGES.items():
        if other not in (column, "plc:V.E.FEED"):
            assert other_read(after) == other_read(before), other
    assert after.written == before.written == before.rig


@pytest.mark.parametrize("order", [1, -1])
def test_what_is_collected_is_kept_in_its_order(settings_of: Read, order: int) -> None:
    """Start values of an FMU and faults: all of them, with other columns between."""
    texts = ["plant:probe.surface_mm=100.5", "drive:servo.lag_limit_mm=2", "fault:drop=Z.TPDO1",
             "plant:probe.trigger_delay_us=20", "distance:limiter=clamp",
             "fault:drop=Z.TPDO2"][::order]  # fmt: skip
    settings = settings_of(RIG, *texts)
    kept = [(item.name, item.si()) for item, _ in settings.start["probe"]]
    assert kept == [("surface", 0.1005), ("trigger_delay", 2e-5)][::order]
    assert [fault.target for fault in settings.faults] == ["Z.TPDO1", "Z.TPDO2"][::order]


def test_a_column_of_all_drives_and_one_of_a_single_drive_act_in_their_order(
    rig_above: Callable[..., Settings],
) -> None:
    two = "[drive.other]\nlead_mm = 5.0\n"
    every, one = "drive:all.lag_limit_mm=1", "drive:other.lag_limit_mm=2"
    for texts, expected in (((every, one), (1, 2)), ((one, every), (1, 1))):
        drives = rig_above("probe-z.toml", two, *texts).rig.drive
        assert (drives["servo"].lag_limit_mm, drives["other"].lag_limit_mm) == expected
        assert drives["other"].lead_mm == 5.0
