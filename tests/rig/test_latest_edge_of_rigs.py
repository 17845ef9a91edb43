"""What a rig says of the arrival of an edge, and the clock of its drives' time stamps."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.machine.canopen.links import build_links
from axisrig.bench.rig.canopen.arrival import describe_arrival, stamp_clock
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.scheduler import new_scheduler

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
SettingsOf = Callable[..., Settings]


class Wire:
    """Takes subscriptions and frames."""

    def subscribe(self, can_id: int, callback: object) -> None: ...
    def send_message(self, can_id: int, data: bytes) -> None: ...


@pytest.mark.parametrize(
    ("rig", "changes", "message"),
    [
        ("probe-z", (), "axis Z, edge at standstill: believed up to 3.6 ms after that SYNC"),
        ("probe-z", (), "update delay 0 SYNCs, PDO 600 us, missing_cycles 3"),
        ("probe-z", ("drive:servo.profile=late-status",), "up to 5.6 ms"),
        ("probe-z", ("drive:servo.profile=late-status",), "update delay 2 SYNCs"),
        ("probe-z", ("drive:servo.missing_cycles=1",), "up to 1.6 ms"),
        ("fixed-stop-z-2ms", (), "up to 6.6 ms"),
        ("probe-z", (), "no time stamp mapped"),
        ("probe-z-stamps", (), "time stamp 60D1 decides"),
        ("probe-z-stamps", ("set:Z.kenngr.measure.edge=NEG",), "time stamp 60D2 decides"),
        ("probe-z-stamps", ("set:Z.kenngr.messachse=0",), ""),
    ],
)
def test_check_tells_how_late_a_status_may_be(
    settings_of: SettingsOf, rig: str, changes: tuple[str, ...], message: str
) -> None:
    """(update delay + missing telegrams) periods, and the cycle offset until it is taken."""
    lines = describe_arrival(settings_of(RIGS / f"{rig}.toml", *changes))
    assert len(lines) == 2 * bool(message)
    assert message in "\n".join(lines)
    assert all(len(line) <= 80 for line in lines)


@pytest.mark.parametrize("measuring", ["", "X", "Y", "Z", "XY", "XZ", "YZ", "XYZ"])
def test_each_axis_that_may_measure_has_its_own_lines(
    rig_above: SettingsOf, measuring: str
) -> None:
    """X bears one missing telegram, Y and Z three with 2 SYNCs of update delay in Z."""
    text = """
        [cycle]
        cycle_offset_us = 640
        [drive.strict]
        missing_cycles = 1
        [drive.late]
        profile = "late-status"
        [axis.X]
        drive = "strict"
        [axis.Z]
        drive = "late"
    """
    flags = [f"set:{axis}.kenngr.messachse={int(axis in measuring)}" for axis in "XYZ"]
    lines = describe_arrival(rig_above("probe-xyz.toml", text, *flags))
    late_ms = {"X": 1.64, "Y": 3.64, "Z": 5.64}
    assert lines[::2] == [
        f"axis {axis}, edge at standstill: believed up to {late_ms[axis]} ms after that SYNC"
        for axis in measuring
    ]
    assert len(lines) == 2 * len(measuring)


@pytest.mark.parametrize(
    ("stamp", "message"),
    [
        ("TPDO2,1,0,0x60D1,0,32,no,,its time stamp", "time stamp 60D1 decides"),
        # Neither a telegram that comes on change, nor one every second SYNC, nor one to the drive
        ("TPDO4,254,10,0x60D1,0,32,no,,its time stamp", "no time stamp mapped"),
        ("TPDO4,2,0,0x60D1,0,32,no,,its time stamp", "no time stamp mapped"),
        ("RPDO2,1,0,0x60D1,0,32,no,,its time stamp", "no time stamp mapped"),
        ("TPDO2,1,0,0x60D3,0,32,no,,another one", "no time stamp mapped"),
    ],
)
def test_a_time_stamp_decides_where_each_cycle_brings_it(
    settings_of: SettingsOf, tmp_path: Path, stamp: str, message: str
) -> None:
    stamps = (RIGS / "lists" / "pdo-stamps.csv").read_text(encoding="utf-8").splitlines()
    lines = [line for line in stamps if "0x60D" not in line and "TPDO4" not in line]
    lines.insert(1 + lines.index("TPDO2,1,0,0x60BA,0,32,yes,latch,input 1 rising"), stamp)
    (tmp_path / "map.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    rig = tmp_path / "rig.toml"
    base = (RIGS / "probe-z.toml").as_posix()
    rig.write_text(f'base = "{base}"\n[drive.servo]\npdo_map = "map.csv"\n', encoding="utf-8")
    assert message in "\n".join(describe_arrival(settings_of(rig)))


@pytest.mark.parametrize(("bitrate", "sync_us"), [(1_000_000, 48), (500_000, 96)])
def test_the_clock_of_a_drive(settings_of: SettingsOf, bitrate: int, sync_us: int) -> None:
    """A SYNC without data has 44 bits, 4 stuff bits and 3 of intermission."""
    settings = settings_of(
        RIGS / "probe-z-latches.toml",
        "drive:servo.timestamp_unit=us",
        "drive:servo.timestamp_start=7",
        f"bus:can1.bitrate={bitrate}",
    )
    assert stamp_clock(settings, "Z") == StampClock(1000, 7, sync_us * 1000)


def test_a_link_knows_delay_and_clock_of_its_drive(settings_of: SettingsOf) -> None:
    settings = settings_of(RIGS / "probe-z.toml", "drive:servo.profile=late-status")
    arrival = build_links(settings, {name: Wire() for name in settings.segment}, new_scheduler())[
        "Z"
    ].arrival
    assert (arrival.delay_cycles, arrival.missing_cycles) == (2, 3)
    assert (arrival.clock, arrival.is_stamped) == (StampClock(1, 0, 48_000), False)
