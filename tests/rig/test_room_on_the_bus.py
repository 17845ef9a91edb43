"""What each key puts on the bus of a segment, what then does not fit, and what room SDO has.

Longest frames in bits, with the intermission (CAN 2.0 with all stuff bits): 55, 65, 95, 115 and 135
for 0, 1, 4, 6 and 8 bytes of data.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.latches import SdoRoom, describe_latches, describe_places, sdo_room
from axisrig.bench.rig.canopen.schedule import (
    describe_schedules,
    overloads,
    schedule_of,
    segment_schedules,
)
from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.settings import Settings

RigWriter = Callable[..., Path]
Read = Callable[..., Settings]
CYCLIC = [("0", "SYNC", 0x080, 0), ("SYNC", "Z.TPDO1", 0x183, 8), ("SYNC", "Z.TPDO2", 0x283, 6),
          ("offset", "Z.RPDO1", 0x203, 8)]  # fmt: skip
INPUTS = ("event", "Z.TPDO3", 0x383, 4)
OFFSET, BITRATE = "cycle_offset_us = 600", "bitrate = 1_000_000"


@pytest.mark.parametrize(
    ("cycle", "assignments", "more"),
    [
        ("", (), []),
        ("heartbeat_ms = 20\nmaster_node = 5", (), [("event", "heartbeat", 0x705, 1)]),
        ("master_node = 5", (), []),
        ("", ("drive:servo.heartbeat_ms=20",), [("event", "Z.heartbeat", 0x703, 1)]),
        ("", ("drive:servo.guard_time_ms=20",),
         [("event", "Z.guarding", 0x703, 0), ("event", "Z.guarded", 0x703, 1)]),
    ],
)  # fmt: skip
def test_the_frames_of_a_segment(
    rig_file: RigWriter, settings_of: Read, cycle: str, assignments: tuple[str, ...],
    more: list[tuple[str, str, int, int]],
) -> None:  # fmt: skip
    settings = settings_of(rig_file((OFFSET, f"{OFFSET}\n{cycle}")), *assignments)
    for with_rare in (False, True):
        schedule = segment_schedules(settings, with_rare=with_rare)["can1"]
        found = [(at, f.name, f.can_id, f.data_bytes) for at, f in schedule.frames]
        rare = [
            ("event", f"Z.{what}", base + 3, 8)
            for what, base in (("EMCY", 0x80), ("SDO answer", 0x580), ("SDO request", 0x600))
        ]
        expected = [INPUTS, *more, *(rare if with_rare else [])]
        assert found[:4] == CYCLIC
        assert sorted(found[4:]) == sorted(expected)


def test_a_sync_with_a_counter_is_a_byte_longer(rig_file: RigWriter, settings_of: Read) -> None:
    busy_us = {}
    for counter in (0, 10):
        path = rig_file((OFFSET, f"{OFFSET}\nsync_counter = {counter}"))
        schedule = schedule_of(settings_of(path), "can1", counters=False)
        busy_us[counter] = schedule.busy_ns / 1000
    assert busy_us == {0: 55 + 135 + 95 + 135, 10: 65 + 135 + 95 + 135}


@pytest.mark.parametrize(
    ("bitrate", "words"),
    [
        (1_000_000, None),
        (800_000, None),
        # 2 us a bit. TPDO3 may be on the wire: 55 + 135 + 95 + 95 - 3; 300 + 95 + 135 - 3
        (500_000, "last TPDO 754.0 of 600.0 us; last RPDO 1054.0 of 994.0 us"),
    ],
)
def test_what_does_not_fit_is_said_with_its_times(
    rig_file: RigWriter, settings_of: Read, bitrate: int, words: str | None
) -> None:
    path = rig_file((BITRATE, f'bitrate = {bitrate}\noverload = "run"'))
    settings = settings_of(path)
    assert overloads(settings) == ({} if words is None else {"can1": words})
    (text,) = describe_schedules(settings)
    assert text.startswith(f"segment can1, {bitrate} bit/s, worst case of one cycle\n")
    if bitrate == 1_000_000:
        # With EMCY first and the longest SDO on the wire: 135 + 55 + 135 + 135 + 115 - 3
        assert text.endswith("last TPDO 572.0 us, last RPDO 1002.0 us")


@pytest.mark.parametrize(
    ("offset_us", "missing", "room"),
    [
        (600, 1, SdoRoom.CYCLE),
        # An SDO on the wire: (135 + 55 + 135 + 115 - 3) 1.25 us = 546.25 us; TPDO3: 496.25 us
        (547, 1, SdoRoom.CYCLE),
        (546, 2, SdoRoom.STANDSTILL),
        (546, 1, SdoRoom.NONE),
        (497, 2, SdoRoom.STANDSTILL),
        (470, 2, SdoRoom.STANDSTILL),  # telegrams are late without it too: there is time
    ],
)
def test_room_for_sdo(
    rig_file: RigWriter, settings_of: Read, offset_us: int, missing: int, room: SdoRoom
) -> None:
    """At 800 kbit/s; at standstill only where the drive bears two cycles without its telegrams."""
    path = rig_file(
        (OFFSET, f"cycle_offset_us = {offset_us}"),
        (BITRATE, 'bitrate = 800_000\noverload = "run"'),
        ("lead_mm = 10.0", f"lead_mm = 10.0\nmissing_cycles = {missing}"),
    )
    (path.parent / "lists" / "axis-z.lst").write_text(
        "kopf.log_achs_name Z\nkenngr.messachse 1\n", encoding="utf-8"
    )
    settings = settings_of(path)
    assert sdo_room(settings, "Z") is room
    (line,) = describe_latches(settings)
    proved = f"axis Z: SDO proves its latches; room for that {room.value}"
    reason = "segment can1 has no room for SDO, not even at standstill"
    if room is SdoRoom.NONE:
        assert line.startswith(f"warning: axis Z: its latches are unproved: {reason}; ")
    else:
        assert line == proved
    places = describe_places(settings)
    assert places == ([unproved_place(settings, "Z", reason)] if room is SdoRoom.NONE else [])
    (line,) = describe_latches(settings_of(path, "drive:servo.latch_check=false"))
    reason = "latch_check of drive servo is false"
    assert line.startswith(f"warning: axis Z: its latches are unproved: {reason}; ")


@pytest.mark.parametrize(("period_us", "room"), [(693, SdoRoom.NONE), (694, SdoRoom.STANDSTILL)])
def test_without_the_time_for_a_frame_there_is_no_room(
    rig_file: RigWriter, settings_of: Read, period_us: int, room: SdoRoom
) -> None:
    """At 800 kbit/s the telegrams take (55 + 135 + 95 + 135) 1.25 us, one frame more 168.75 us."""
    path = rig_file(
        (OFFSET, f"period_us = {period_us}\ncycle_offset_us = 400"),
        (BITRATE, 'bitrate = 800_000\noverload = "run"'),
        ("lead_mm = 10.0", "lead_mm = 10.0\nmissing_cycles = 9"),
    )
    settings = settings_of(path)
    assert schedule_of(settings, "can1", counters=False).busy_ns == 525_000
    assert sdo_room(settings, "Z") is room


OTHER_DRIVE = """
[drive.other]
lead_mm = 10.0
missing_cycles = {missing}

[axis.Y]
list = "lists/axis-y.lst"
segment = "can1"
node = 4
drive = "other"
plant = "y"

[plant.y]
fmu = "AxisRig.Drives.ServoAxis"

[plant.z]
"""


@pytest.mark.parametrize(("mine", "others"), [(9, 9), (9, 1), (1, 9)])
def test_at_standstill_every_drive_of_the_segment_has_to_bear_what_sdo_keeps_away(
    rig_file: RigWriter, settings_of: Read, mine: int, others: int
) -> None:
    """785 bits of telegrams and a frame of 135 are in 1000 us; four frames of SDO are not."""
    path = rig_file(
        ("lead_mm = 10.0", f"lead_mm = 10.0\nmissing_cycles = {mine}"),
        ("[plant.z]\n", OTHER_DRIVE.format(missing=others)),
    )
    settings = settings_of(path)
    room = SdoRoom.STANDSTILL if min(mine, others) > 1 else SdoRoom.NONE
    assert (sdo_room(settings, "Z"), sdo_room(settings, "Y")) == (room, room)


@pytest.mark.parametrize("without", ["", "X", "Y", "Z", "XZ", "XYZ"])
def test_each_axis_whose_place_nothing_proves_is_warned_of(rig_above: Read, without: str) -> None:
    """In the order of the rig, by the key of its own drive."""
    text = "[drive.blind]\nposition_check = false\n"
    text += "".join(f'[axis.{axis}]\ndrive = "blind"\n' for axis in without)
    settings = rig_above("probe-xyz.toml", text)
    found = describe_places(settings)
    assert found == [unproved_place(settings, axis) for axis in without]
    assert all(line.endswith("position_check of drive blind is false") for line in found)
