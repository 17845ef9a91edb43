"""The second encoder costs bus time, and only where distance control wants it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.machine.canopen.links import build_links
from axisrig.bench.rig.canopen.schedule import axis_telegrams, segment_schedules
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.scheduler import new_scheduler

Write = Callable[..., Path]
Read = Callable[..., Settings]
RELEASED = "set:Z.lr_param.distance_control_on=1"
WITH_SCALE = ('drive = "servo"', 'drive = "servo"\nencoder_2 = "load"')
# Worst-case bits at 1 Mbit/s, as in test_rig_check.py
SYNC, FOUR, SIX, EIGHT = 55, 95, 115, 135
MAP = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
TPDO2,{transmission},0,0x60E4,1,32,yes,second
"""


class _Network:
    def subscribe(self, can_id: int, callback: object) -> None: ...

    def send_message(self, can_id: int, data: bytes) -> None: ...


def _has_second(settings: Settings) -> bool:
    networks = {name: _Network() for name in settings.segment}
    return build_links(settings, networks, new_scheduler())["Z"].has_second


@pytest.mark.parametrize(
    ("has_scale", "released", "mapped"),
    [(True, True, True), (True, False, False), (False, True, False), (False, False, False)],
)
def test_tpdo4_is_there_when_an_encoder_and_a_release_are(
    rig_file: Write, settings_of: Read, has_scale: bool, released: bool, mapped: bool
) -> None:
    path = rig_file(WITH_SCALE) if has_scale else rig_file()
    settings = settings_of(path, *([RELEASED] if released else []))
    check_rig(settings)
    assert ("TPDO4" in axis_telegrams(settings, "Z")) is mapped
    assert (
        build_links(settings, {name: _Network() for name in settings.segment}, new_scheduler())[
            "Z"
        ].has_second
        is mapped
    )


def test_its_frame_counts_in_the_cycle(rig_file: Write, settings_of: Read) -> None:
    (plain,) = segment_schedules(settings_of(rig_file(WITH_SCALE))).values()
    (more,) = segment_schedules(settings_of(rig_file(WITH_SCALE), RELEASED)).values()
    assert more.last_tpdo_ns - plain.last_tpdo_ns == FOUR * 1000
    assert more.busy_ns - plain.busy_ns == FOUR * 1000
    assert more.busy_ns == (SYNC + EIGHT + SIX + FOUR + EIGHT) * 1000


def test_a_cycle_that_it_fills_up_is_refused(rig_file: Write, settings_of: Read) -> None:
    """At 400 us the TPDOs are in without it and late with it."""
    early = ("cycle_offset_us = 600", "cycle_offset_us = 400")
    check_rig(settings_of(rig_file(WITH_SCALE, early)))
    with pytest.raises(UserError, match="does not fit") as refused:
        check_rig(settings_of(rig_file(WITH_SCALE, early), RELEASED))
    assert "Z.TPDO4" in str(refused.value)


@pytest.mark.parametrize(("transmission", "cyclic"), [(1, True), (4, True), (254, False)])
def test_a_table_of_its_own_is_reckoned_with_by_its_type(
    rig_file: Write, settings_of: Read, tmp_path: Path, transmission: int, cyclic: bool
) -> None:
    """A type n fills the cycle in which it comes; one on change counts as an event."""
    (tmp_path / "map.csv").write_text(MAP.format(transmission=transmission))
    path = rig_file(WITH_SCALE, ("lead_mm = 10.0", 'lead_mm = 10.0\npdo_map = "map.csv"'))
    settings = settings_of(path, RELEASED)
    check_rig(settings)
    (schedule,) = segment_schedules(settings).values()
    rows = {line.split()[1]: line.split()[0] for line in schedule.table().splitlines()[1:-3]}
    assert rows["Z.TPDO2"] == ("SYNC" if cyclic else "event")
    assert build_links(settings, {name: _Network() for name in settings.segment}, new_scheduler())[
        "Z"
    ].has_second
