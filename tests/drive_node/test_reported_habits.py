"""Habits of drives that users have reported: halt and mode, homing, boot-up, first heartbeat."""

import struct
from collections.abc import Callable
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS, US

Make = Callable[..., Any]
NODE = 3
HALTED, HOMING, CSP = 0x10F, 6, 8
ATTAINED, REACHED = 1 << 12, 1 << 10
CURRENT_POSITION = 37
"""Homing method: the position that the axis has."""


@pytest.mark.parametrize("habit", ["always", "not_halted"])
def test_a_mode_may_be_refused_while_the_axis_is_halted(drive_bench: Make, habit: str) -> None:
    bench = drive_bench(profile=DriveProfile(mode_change=habit))  # type: ignore[arg-type]
    bench.operational()
    bench.enable(5)
    sdo = bench.remote.sdo
    for controlword, is_refused in ((0x00F, False), (HALTED, habit == "not_halted"), (0xF, False)):
        now_ms = round(bench.scheduler.now_ns / 1e6) + 2
        bench.set_values(controlword, 0)
        bench.sync_at_ms(now_ms)
        if is_refused:
            with pytest.raises(SdoAbortedError) as error:
                sdo.download(0x6060, 0, struct.pack("b", HOMING))
            assert error.value.code == 0x08000022
        else:
            sdo.download(0x6060, 0, struct.pack("b", HOMING))
            sdo.download(0x6060, 0, struct.pack("b", CSP))


@pytest.mark.parametrize("has_bit", [True, False])
def test_homing_with_and_without_bit_10(drive_bench: Make, has_bit: bool) -> None:
    bench = drive_bench(profile=DriveProfile(homing_bit_10=has_bit))
    sdo = bench.remote.sdo
    sdo.download(0x6060, 0, struct.pack("b", HOMING))
    sdo.download(0x6098, 0, struct.pack("b", CURRENT_POSITION))
    bench.operational()
    bench.enable(5)
    for step in range(4):
        bench.set_values(0x1F, 0)
        bench.sync_at_ms(round(bench.scheduler.now_ns / 1e6) + 1 + step)
    word = struct.unpack_from("<H", bench.frames(0x180 + NODE)[-1])[0]
    assert bool(word & ATTAINED)
    assert bool(word & REACHED) == has_bit


@pytest.mark.parametrize(("habit", "count"), [("always", 3), ("power_on", 2)])
def test_a_boot_up_may_come_at_power_on_alone(drive_bench: Make, habit: str, count: int) -> None:
    """Power on, a reset by NMT, power off and on."""
    bench = drive_bench(profile=DriveProfile(boot_up=habit))  # type: ignore[arg-type]
    bench.remote.nmt.send_command(0x81)
    bench.run_to_ms(20)
    bench.node.power_off()
    bench.run_to_ms(30)
    bench.node.power_on()
    bench.run_to_ms(40)
    assert bench.frames(0x700 + NODE).count(b"\0") == count


@pytest.mark.parametrize("first_ms", [0, 35])
def test_the_first_heartbeat_may_come_late(drive_bench: Make, first_ms: int) -> None:
    """1017 = 10 ms, stored, so that a reset has it: then every 10 ms.

    The boot-up message comes right after the command and waits for the 3 bits between two frames.
    """
    bench = drive_bench(profile=DriveProfile(first_heartbeat_ns=first_ms * MS))
    sdo = bench.remote.sdo
    sdo.download(0x1017, 0, struct.pack("<H", 10))
    sdo.download(0x1010, 1, b"save")
    bench.heard.clear()
    bench.remote.nmt.send_command(0x81)
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 100)
    sent = [(time_ns, data) for time_ns, can_id, data in bench.heard if can_id == 0x700 + NODE]
    begin = next(place for place, (_, data) in enumerate(sent) if data == b"\0")
    (boot_ns, _), (first_ns, _), (second_ns, _) = sent[begin : begin + 3]
    assert first_ns - boot_ns == (first_ms or 10) * MS - 3 * US
    assert second_ns - first_ns == 10 * MS
