"""What power, reset of the node and reset of the communication take from a node, and what acts."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130
SAVE = int.from_bytes(b"save", "little")
PER_M = 104_857_600  # units of 607D in a metre
UNITS_PER_MS = 10_485.76  # of 6064, at 0.1 m/s


def boot_ups(drive: Any) -> int:
    return int(drive.frames(0x703).count("00"))


@pytest.mark.parametrize("boot_up", ["always", "power_on"])
def test_a_boot_up_comes_with_each_power_and_by_habit_with_each_reset(
    stranger: Make, boot_up: str
) -> None:
    drive = stranger(profile=DriveProfile(boot_up=boot_up))
    for _ in range(3):
        drive.heard.clear()
        drive.times_ns.clear()
        drive.node.power_off()
        drive.run_ms(2)
        assert boot_ups(drive) == 0
        drive.node.power_on()
        drive.run_ms(2)
        assert boot_ups(drive) == 1
        resets = (RESET_COMMUNICATION, RESET_NODE, RESET_NODE)
        for number, command in enumerate(resets, 1):
            drive.nmt(command, wait_ms=2)
            assert boot_ups(drive) == 1 + number * (boot_up == "always")
            assert drive.node.nmt_state.name == "PRE_OPERATIONAL"


@pytest.mark.parametrize("command", [RESET_NODE, RESET_COMMUNICATION])
def test_a_reset_ends_what_lss_has_begun(stranger: Make, command: int) -> None:
    """CiA 305: an LSS slave waits after it. A selection by four numbers begins anew as well."""
    drive = stranger()
    inquire = "5e" + "00" * 7
    assert drive.after(0x7E5, "0401000000000000") == []
    assert drive.after(0x7E5, inquire) == [(0x7E4, "5e03000000000000")]
    drive.nmt(command, wait_ms=2)
    assert drive.after(0x7E5, inquire) == []
    identity = [number.to_bytes(4, "little").hex() for number in (0, 402, 0x10000, 3)]
    for place, number in enumerate(identity[:2]):
        drive.after(0x7E5, f"4{place}{number}000000")
    drive.nmt(command, wait_ms=2)
    for place, number in enumerate(identity[2:], 2):
        assert drive.after(0x7E5, f"4{place}{number}000000") == []
    assert drive.after(0x7E5, inquire) == []


@pytest.mark.parametrize("again", [RESET_NODE, "power"])
def test_stored_values_act_after_a_reset_and_those_that_were_not_stored_do_not(
    stranger: Make, again: int | str
) -> None:
    """Software limits (607D) and the period of interpolation (60C2), as the axis has them."""
    drive = stranger()
    servo = drive.node.servo
    for sub, metres in ((1, -0.25), (2, 0.5)):
        assert drive.write(0x607D, sub, round(metres * PER_M), 4) == 0
    assert drive.write(0x60C2, 1, 3, 1) == 0
    assert drive.write(0x1010, 1, SAVE, 4) == 0
    for sub, metres in ((1, -0.1), (2, 0.1)):
        drive.write(0x607D, sub, round(metres * PER_M), 4)
    drive.write(0x60C2, 1, 7, 1)
    if again == "power":
        drive.node.restart()
        drive.run_ms(2)
    else:
        drive.nmt(again, wait_ms=2)
    assert servo.limits.low_m == pytest.approx(-0.25)
    assert servo.limits.high_m == pytest.approx(0.5)
    assert servo.interpolation.period_ns() == 3 * MS


def test_a_reset_of_the_communication_leaves_what_the_axis_has(stranger: Make) -> None:
    drive = stranger()
    servo = drive.node.servo
    drive.write(0x607D, 1, -PER_M // 4, 4)
    drive.write(0x607D, 2, PER_M // 2, 4)
    drive.write(0x1006, 0, 4000, 4)
    assert servo.interpolation.period_ns() == 4 * MS
    drive.nmt(RESET_COMMUNICATION, wait_ms=2)
    assert servo.limits.low_m == pytest.approx(-0.25)
    assert servo.interpolation.period_ns() == MS  # 1006 is 0 again, so that 60C2 counts


# Telegrams by event


def by_event(drive: Any, entry: int, kind: int, *, inhibit: int = 0, event_ms: int = 0) -> None:
    """TPDO4 carries one object."""
    for index, sub, value, size in (
        (0x1A03, 1, entry, 4),
        (0x1A03, 0, 1, 1),
        (0x1803, 2, kind, 1),
        (0x1803, 3, inhibit, 2),
        (0x1803, 5, event_ms, 2),
        (0x1803, 1, 0x4000_0483, 4),
    ):
        assert drive.write(index, sub, value, size) == 0


def test_a_telegram_by_event_begins_with_the_place_of_its_instant(
    stranger: Make, fake_axis: Any
) -> None:
    """6064 of an axis at 0.1 m/s, and not that of a SYNC of long ago."""
    drive = stranger(axis=fake_axis(motion=lambda time_s: 0.1 * time_s))
    by_event(drive, 0x60640020, 255, inhibit=10_000)
    for wait_ms in (5, 17):
        drive.after(0x80)
        drive.run_ms(wait_ms)
        drive.nmt(START)
        sent_ms = drive.times_ms(0x483)[-1]
        (place,) = (int.from_bytes(bytes.fromhex(d), "little") for d in drive.frames(0x483)[-1:])
        # Its own way on the bus, and that of what is sent before it, are less than 0.5 ms
        assert 0.0 <= sent_ms - place / UNITS_PER_MS < 0.5
        drive.nmt(PRE_OPERATIONAL)


@pytest.mark.parametrize("kind", [254, 255])
def test_what_an_rpdo_changes_by_event_is_sent_without_a_sync(stranger: Make, kind: int) -> None:
    drive = stranger()
    by_event(drive, 0x60410010, 255)
    drive.write(0x1400, 1, 0x8000_0203, 4)
    drive.write(0x1400, 2, kind, 1)
    drive.write(0x1400, 1, 0x203, 4)
    drive.nmt(START)
    drive.run_ms(1)
    for word, status in (("0600", "3102"), ("0700", "3302"), ("0600", "3102"), ("0000", "5002")):
        assert drive.after(0x203, word + "000000000000") == [(0x483, status)]
        assert drive.after(0x203, word + "000000000000") == []


def test_inhibit_time_and_event_timer_are_of_types_254_and_255_alone(stranger: Make) -> None:
    """Type 0 comes with each SYNC after a change, 1 ms apart here, and by itself never."""
    for kind in (0, 1):
        drive = stranger()
        by_event(drive, 0x60410010, kind, inhibit=200, event_ms=5)
        drive.nmt(START)
        for word in (6, 7, 6, 7):
            drive.write(0x6040, 0, word, 2)
            drive.after(0x80)
        assert drive.frames(0x483) == ["3102", "3302"] * 2
        drive.run_ms(50)
        assert len(drive.frames(0x483)) == 4
