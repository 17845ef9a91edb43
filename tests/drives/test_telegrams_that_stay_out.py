"""What a link keeps, and what it begins anew, when a telegram of a cycle stays out; by hand."""

import struct
from pathlib import Path
from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, STAMPED, Wire, _link
from tests.drives.test_process_data_by_hand import COLUMNS, SENT

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.canopen.process_data import ProcessData
from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import MS

OLD, NEW = 990, 1001
ARMED, LATCHED = 0x1, 0x3
STAND = 1000


def take(link: AxisLink, wire: Wire, probe: int | None, latched: int | None) -> None:
    """A cycle with these telegrams; None for one that stays out."""
    if probe is not None:
        wire._bring(0x183, struct.pack("<HiH", OPERATION_ENABLED, STAND, probe))
    if latched is not None:
        wire._bring(0x283, struct.pack("<i", latched))
    link.take()


def ordered() -> tuple[AxisLink, Wire]:
    """A link without a counter that has been armed; the position of the run before is OLD."""
    link, wire = _link()
    take(link, wire, 0, OLD)
    link.arm()
    take(link, wire, ARMED, OLD)
    return link, wire


@pytest.mark.parametrize(
    ("probe", "latched"), [(None, NEW), (LATCHED, None), (None, None), (ARMED, NEW)]
)
def test_a_position_has_to_come_again_right_after_it_has_come(
    probe: int | None, latched: int | None
) -> None:
    """Without 60B9 or without the position of a cycle two in a row are needed anew."""
    link, wire = ordered()
    take(link, wire, LATCHED, NEW)
    if probe == ARMED:  # the run sees a probe that has gone back; 900062 says so
        with pytest.raises(Alarm) as caught:
            take(link, wire, probe, latched)
        assert caught.value.id == 900062
        return
    take(link, wire, probe, latched)
    assert link.latched_mm is None
    take(link, wire, LATCHED, NEW)
    assert link.latched_mm is None
    take(link, wire, LATCHED, NEW)
    assert link.latched_mm == NEW / 1000.0


def test_what_is_proved_stays_when_telegrams_stay_out() -> None:
    link, wire = ordered()
    for _ in range(2):
        take(link, wire, LATCHED, NEW)
    for probe, latched in ((None, NEW), (LATCHED, None), (None, None)):
        take(link, wire, probe, latched)
        assert (link.latched_mm, link.has_latched) == (NEW / 1000.0, True)


def stamped(tmp_path: Path) -> tuple[AxisLink, Wire]:
    table = tmp_path / "map.csv"
    table.write_text(STAMPED.format(latch="0x60BA", stamp="0x60D1"), encoding="utf-8")
    return _link(pdo_map=str(table), stamps=StampClock())


def test_a_time_stamp_stays_until_the_next_one(tmp_path: Path) -> None:
    """It is in TPDO2; 60B9 alone, or nothing at all, says nothing of it."""
    link, wire = stamped(tmp_path)
    for stamp in (4711, 0, 815):
        wire.status(OPERATION_ENABLED, 0)
        wire._bring(0x283, struct.pack("<iI", 0, stamp))
        link.take()
        assert (link.arrival.stamp, link.arrival.is_new) == (stamp, True)
        wire.status(OPERATION_ENABLED, 0)
        link.take()
        assert (link.arrival.stamp, link.arrival.is_new) == (stamp, True)
        link.take()
        assert (link.arrival.stamp, link.arrival.is_new) == (stamp, False)


PARTS = (
    "TPDO1,1,0,0x6041,0,16,no,statusword\nTPDO1,1,0,0x6064,0,32,yes,actual\n"
    "TPDO2,1,0,0x60FD,0,32,no,inputs\nTPDO2,1,0,0x60E4,1,32,yes,second\n"
)


def test_inputs_and_second_encoder_stay_and_only_the_encoder_ages(tmp_path: Path) -> None:
    """Each value in its place, with the sign of its object."""
    table = tmp_path / "map.csv"
    table.write_text(COLUMNS + SENT + PARTS, encoding="utf-8")
    link, wire = _link(pdo_map=str(table), missing_cycles=5)
    assert (link.digital_inputs, link.second_increments) == (None, None)
    assert (link.has_second, link.second_period_ns(2 * MS)) == (True, 2 * MS)
    for inputs, second in ((0x80000001, -7), (0, 0), (0x30000, 1 << 30)):
        wire._bring(0x183, struct.pack("<Hi", OPERATION_ENABLED, 0))
        wire._bring(0x283, struct.pack("<Ii", inputs, second))
        link.take()
        for age in range(3):
            assert (link.digital_inputs, link.second_increments) == (inputs, second)
            assert link.second_age_cycles == age
            wire._bring(0x183, struct.pack("<Hi", OPERATION_ENABLED, 0))
            link.take()


def test_a_position_that_stays_out_is_no_more_that_of_the_cycle() -> None:
    """And the state too: both are those that came last."""
    link, wire = _link(missing_cycles=5)
    for place in (2500, -2500):
        wire.status(OPERATION_ENABLED, place)
        wire.latch()
        link.take()
        assert (link.has_actual, link.actual_mm) == (True, place / 1000.0)
        for _ in range(2):
            wire.latch()
            link.take()
            assert (link.has_actual, link.actual_mm) == (False, place / 1000.0)
            assert link.state_name == "OPERATION_ENABLED"


# A telegram of another length


@pytest.mark.parametrize("length", [0, 1, 7, 9, 64])
@pytest.mark.parametrize("name", ["TPDO1", "TPDO2"])
def test_a_telegram_of_another_length_is_named_with_both_lengths(name: str, length: int) -> None:
    """8 bytes of status, position and 60B9; 4 of the latch. Shorter or longer: 900028, once."""
    link, wire = _link()
    expected = {"TPDO1": 8, "TPDO2": 4}[name]
    for _ in range(2):
        wire._bring({"TPDO1": 0x183, "TPDO2": 0x283}[name], bytes(length))
        with pytest.raises(Alarm) as caught:
            link.take()
        assert caught.value.id == 900028
        assert caught.value.values == {
            "axis": "Z", "pdo": name, "length": length, "expected": expected,
        }  # fmt: skip
        wire.status(OPERATION_ENABLED, 5)
        wire.latch()
        link.take()
        assert link.actual_mm == 0.005


def test_a_telegram_of_another_length_replaces_none_that_was_right() -> None:
    found = telegrams(0x60BA, None, counter=True, inputs=False)
    wire: Any = Wire()
    data = ProcessData(found, 3, wire)
    data.begin()
    right = struct.pack("<HiH", OPERATION_ENABLED, 77, 0)
    for telegram in (right, right + b"\0", right[:-1]):
        wire._bring(0x183, telegram)
    wire._bring(0x283, struct.pack("<iH", 5, 6))
    values = data.take()
    assert (values[1], values[3], data.is_disturbed) == (77, 5, False)
    assert data.wrong_length == ("TPDO1", 7, 8)


# What a link has telegrams for


OF_PROBE = {"probe_function", "probe_status", "latch"}


@pytest.mark.parametrize(
    ("settings", "lacks", "adds"),
    [
        ({}, set(), set()), ({"has_inputs": False}, {"inputs"}, set()),
        ({"has_probe": False}, OF_PROBE, set()), ({"has_counter": True}, set(), {"latch_count"}),
        ({"has_counter": True, "has_probe": False}, OF_PROBE, set()),
        ({"has_second": True}, set(), {"second"}),
        ({"loop": LoopSettings(10.0, 1e-3)}, {"target"}, {"speed"}),
    ],
)  # fmt: skip
def test_a_link_carries_what_its_drive_has(
    settings: dict[str, Any], lacks: set[str], adds: set[str]
) -> None:
    """And listens to the identifiers of its TPDOs, of its emergencies and to nothing else."""
    link, wire = _link(**settings)
    usual = {"controlword", "target", "statusword", "actual", "inputs", *OF_PROBE}
    fields = {o.field for telegram in link.telegrams.values() for o in telegram.objects}
    assert fields == (usual - lacks) | adds
    sent_back = {t.cob_id(3) for t in link.telegrams.values() if not t.is_received}
    assert set(wire.listeners) == sent_back | {0x83}
    assert link.has_second is ("second" in adds)
    link.send(0.0)
    assert set(wire.sent) == {0x203}
    assert len(wire.sent[0x203]) == (6 if "has_probe" in settings else 8)


@pytest.mark.parametrize("chosen", [(0x60BB, 0x60D6), (0x60BA, 0x60D5)])
def test_a_latch_without_a_counter_has_not_that_of_another_one(
    tmp_path: Path, chosen: tuple[int, int]
) -> None:
    """60D5 counts 60BA, also where a telegram carries it beside 60BB."""
    table = tmp_path / "map.csv"
    table.write_text(
        COLUMNS + SENT + "TPDO1,1,0,0x6041,0,16,no,statusword\nTPDO1,1,0,0x6064,0,32,yes,actual\n"
        "TPDO2,1,0,0x60BB,0,32,yes,\nTPDO2,1,0,0x60D5,0,16,no,latch_count\n"
        "TPDO3,1,0,0x60BA,0,32,yes,latch\n",
        encoding="utf-8",
    )
    wire: Any = Wire()
    data = ProcessData(telegrams(0x60BA, str(table), inputs=False), 3, wire)
    data.begin()
    assert data.choose_latch(*chosen)
    wire._bring(0x183, struct.pack("<Hi", OPERATION_ENABLED, 0))
    wire._bring(0x283, struct.pack("<iH", 11, 5))
    wire._bring(0x383, struct.pack("<i", 22))
    found = dict(zip(TAKEN, data.take(), strict=True))
    assert (found["latch"], found["latch_count"]) == ({0x60BB: 11, 0x60BA: 22}[chosen[0]], None)
