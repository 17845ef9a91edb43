"""Keys of `[segment.S]` reach the ports, from the rig and from `bus:` columns; forced overload."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.can_parts import can_of

from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.canopen.schedule import describe_schedules, overloads, segment_schedules
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import FORCED, Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program

Write = Callable[..., Path]
Read = Callable[..., Settings]


def machine_of(settings: Settings, folder: Path) -> Machine:
    program = folder / "part.nc"
    program.write_text("N10 M30\n")
    return Machine(settings, read_program(program, tuple(settings.rig.axis)))


def test_queues_and_recovery_reach_the_ports(
    rig_file: Write, settings_of: Read, tmp_path: Path
) -> None:
    """A FIFO is a deque, mailboxes are a heap in a list."""
    path = rig_file(("bitrate = 1_000_000", 'bitrate = 1_000_000\nqueue = "mailbox"'))
    settings = settings_of(path, "bus:all.bus_off=stay")
    machine = machine_of(settings, tmp_path)
    try:
        (segment,) = can_of(machine).segments.values()
        kinds = {port.port_name: type(port.pending).__name__ for port in segment.ports}
        assert (kinds["cnc"], kinds["Z"]) == ("list", "deque")
    finally:
        machine.close()
    settings = settings_of(path, "bus:can1.queue=fifo", "bus:can1.drive_queue=mailbox")
    machine = machine_of(settings, tmp_path)
    try:
        (segment,) = can_of(machine).segments.values()
        kinds = {port.port_name: type(port.pending).__name__ for port in segment.ports}
        assert (kinds["cnc"], kinds["Z"]) == ("deque", "list")
    finally:
        machine.close()


@pytest.mark.parametrize(
    "text", ["bus:can1.queue=stack", "bus:can9.queue=fifo", "bus:all.colour=red"]
)
def test_a_key_or_value_that_cannot_be_is_refused(
    rig_file: Write, settings_of: Read, text: str
) -> None:
    with pytest.raises(UserError):
        settings_of(rig_file(), text)


def test_overload_is_refused_unless_it_is_wanted(rig_file: Write, settings_of: Read) -> None:
    """At 125 kbit/s SYNC and one drive take 8 * 420 = 3360 us of 1000."""
    slow = "bus:can1.bitrate=125000"
    with pytest.raises(UserError, match="does not fit") as refused:
        check_rig(settings_of(rig_file(), slow))
    assert "--force" in (refused.value.hint or "")
    forced = settings_of(rig_file(), slow, FORCED)
    check_rig(forced)
    assert "cyclic frames 3360.0 of 1000.0 us" in overloads(forced)["can1"]
    assert overloads(settings_of(rig_file())) == {}


def test_heartbeats_count_where_they_are_configured(rig_file: Write, settings_of: Read) -> None:
    """1 byte: 55 + 8 * 1.25 = 65 bits; the drive's and the kernel's own."""
    plain = segment_schedules(settings_of(rig_file()))["can1"]
    path = rig_file(
        ("cycle_offset_us = 600", "cycle_offset_us = 600\nheartbeat_ms = 100"),
        ("lead_mm = 10.0", "lead_mm = 10.0\nheartbeat_ms = 100"),
        name="beating.toml",
    )
    beating = segment_schedules(settings_of(path))["can1"]
    assert beating.event_ns - plain.event_ns == 2 * 65_000
    assert (beating.busy_ns, beating.last_tpdo_ns) == (plain.busy_ns, plain.last_tpdo_ns)


def test_guarding_counts_with_its_question_and_its_answer(
    rig_file: Write, settings_of: Read
) -> None:
    """A remote frame without data, 55 bits in the worst case, and one byte, 65 bits."""
    plain = segment_schedules(settings_of(rig_file()))["can1"]
    path = rig_file(("lead_mm = 10.0", "lead_mm = 10.0\nguard_time_ms = 100"), name="guarded.toml")
    guarded = segment_schedules(settings_of(path))["can1"]
    assert guarded.event_ns - plain.event_ns == (55 + 65) * 1000
    assert guarded.busy_ns == plain.busy_ns


def test_a_sync_with_a_counter_is_a_byte_longer(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("cycle_offset_us = 600", "cycle_offset_us = 600\nsync_counter = 10"))
    schedule = segment_schedules(settings_of(path))["can1"]
    assert schedule.busy_ns == segment_schedules(settings_of(rig_file()))["can1"].busy_ns + 10_000


def test_rare_frames_are_shown_and_refuse_nothing(rig_file: Write, settings_of: Read) -> None:
    """EMCY goes before TPDO1, an SDO frame of 135 us instead of a TPDO3 of 95 is in the way."""
    settings = settings_of(rig_file())
    plain = segment_schedules(settings)["can1"]
    rare = segment_schedules(settings, with_rare=True)["can1"]
    assert rare.last_tpdo_ns == plain.last_tpdo_ns + 135_000 + 40_000
    (text,) = describe_schedules(settings)
    assert f"with EMCY and SDO as well: last TPDO {rare.last_tpdo_ns / 1000:.1f} us" in text
