"""Homing led by a plain master: by SDO, by PDO, with a probe armed."""

import csv
import struct
from importlib import resources

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.homing_methods import METHODS

ATTAINED, REACHED = 1 << 12, 1 << 10
NODE = 3


def in_operation(bench) -> None:
    """Walk to operation enabled in mode 6 by SDO."""
    bench.run_to_ms(2)
    sdo = bench.remote.sdo
    sdo[0x6060].raw = 6
    for word in (0x06, 0x07, 0x0F):
        sdo[0x6040].raw = word
    assert sdo[0x6041].raw & 0x6F == 0x27
    assert sdo[0x6061].raw == 6


def test_a_master_homes_by_sdo(drive_bench, fake_axis) -> None:
    bench = drive_bench(axis=fake_axis(start_m=0.0123))
    in_operation(bench)
    sdo = bench.remote.sdo
    sdo[0x6098].raw = 37
    sdo[0x607C].raw = -5000
    sdo[0x6040].raw = 0x1F
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 50)
    assert sdo[0x6041].raw & 0x3400 == ATTAINED | REACHED
    assert sdo[0x6064].raw == 5000


def test_a_master_homes_by_pdo(drive_bench, fake_axis) -> None:
    """Bit 4 comes in RPDO1; the status in TPDO1 tells the end."""
    bench = drive_bench(axis=fake_axis(start_m=0.0123))
    in_operation(bench)
    bench.remote.sdo[0x6098].raw = 35
    bench.operational(at_ms=bench.scheduler.now_ns // 1_000_000 + 1)
    first_ms = bench.scheduler.now_ns // 1_000_000 + 1
    words = []
    for step in range(30):
        bench.set_values(0x1F, 0)
        bench.sync_at_ms(first_ms + step)
        words.append(struct.unpack("<H", bench.frames(0x180 + NODE)[-1][:2])[0])
    assert words[-1] & 0x3400 == ATTAINED | REACHED
    assert bench.remote.sdo[0x6064].raw == 0


@pytest.mark.parametrize("method", [0, 15, 16, 31, 32, 36, -5])
def test_a_method_that_is_not_supported_is_refused(drive_bench, method) -> None:
    bench = drive_bench()
    bench.run_to_ms(2)
    with pytest.raises(SdoAbortedError) as refused:
        bench.remote.sdo[0x6098].raw = method
    assert refused.value.code == 0x06090030


def test_the_drive_says_which_methods_it_supports(drive_bench) -> None:
    """60E3 lists the rows of the table, and 6098 takes them."""
    bench = drive_bench()
    bench.run_to_ms(2)
    record = bench.remote.sdo[0x60E3]
    listed = [record[n].raw for n in range(1, record[0].raw + 1)]
    text = (
        resources.files("axisrig.bench.drive.cia402.functions")
        .joinpath("homing_methods.csv")
        .read_text()
    )
    assert listed == [int(row["method"]) for row in csv.DictReader(text.splitlines())]
    assert set(listed) == set(METHODS)
    allowed = variables()[0x6098, 0].allowed
    assert [n for n in range(-128, 128) if n in allowed] == sorted(METHODS)
    assert bench.remote.sdo[0x6502].raw & 1 << 5


@pytest.mark.parametrize(
    ("habit", "armed", "value"),
    [("independent", 0x0101, 42), ("probe_1_off", 0x0100, 42), ("off", 0, 42), ("clears", 0, 0)],
)
def test_a_probe_that_is_armed_while_homing_begins(drive_bench, habit, armed, value) -> None:
    """What the profile says: it stays, it goes off, and its positions may be cleared."""
    bench = drive_bench(profile=DriveProfile(homing=habit))
    in_operation(bench)
    sdo, servo = bench.remote.sdo, bench.node.servo
    sdo[0x60B8].raw = 0x1111
    assert sdo[0x60B9].raw == 0x0101
    for probe in servo.touch_probe.probes:
        probe.latches[True].units = 42
    servo.touch_probe._write()
    sdo[0x6098].raw = 34
    sdo[0x6040].raw = 0x1F
    assert sdo[0x6041].raw & 0x3400 == 0
    assert sdo[0x60B9].raw == armed
    assert sdo[0x60BA].raw == value
