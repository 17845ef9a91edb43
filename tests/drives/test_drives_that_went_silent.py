"""A drive whose telegrams stay out, restart or do not fit: what its link does, by hand."""

import struct
from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire, _link

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.cia402.objects import Done
from axisrig.kernel.drives.cia402.settings import MISSING_CYCLES
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State

KV, PERIOD_S = 10.0, 1e-3
LOOP = LoopSettings(KV, PERIOD_S)
CONTROLWORD, TARGET_VELOCITY = (0x6040, 0), (0x60FF, 0)


class Written:
    """Notes what is written by SDO."""

    def __init__(self) -> None:
        self.objects: list[tuple[tuple[int, int], bytes]] = []

    def write(self, index: int, sub: int, data: bytes, _done: Done) -> None:
        self.objects.append(((index, sub), data))


def led(**settings: Any) -> tuple[AxisLink, Wire, Written]:
    """A drive in operation, and what SDO writes to it."""
    link, wire = _link(**settings)
    written: Any = Written()
    link.sdo = written
    link.order(PowerOrder.SWITCH_ON)
    cycle(link, wire, 0.0)
    return link, wire, written


def cycle(
    link: AxisLink, wire: Wire, set_mm: float, place: int | None = 0, word: int = OPERATION_ENABLED
) -> int | None:
    """One cycle; place None: TPDO1 stays out. Return the alarm of it."""
    found = None
    if place is not None:
        wire.status(word, place)
    wire.latch()
    try:
        link.take()
    except Alarm as alarm:
        found = alarm.id
    link.send(set_mm)
    return found


def lost(link: AxisLink, wire: Wire, places_mm: list[float]) -> list[int | None]:
    """Cycles without TPDO1, with their set positions."""
    return [cycle(link, wire, set_mm, None) for set_mm in places_mm]


# What is repeated by SDO


def test_a_set_speed_is_written_by_sdo_once_the_set_position_stands() -> None:
    """In pre-operational a drive hears no PDO: it would go on with its last set speed."""
    link, wire, written = led(loop=LOOP)
    alarms = lost(link, wire, [0.01, 0.02, 0.03, 0.04, 0.05])
    assert alarms == [None] * MISSING_CYCLES + [900006] * 2
    assert written.objects == []  # the axis is still on its way
    lost(link, wire, [0.05, 0.05, 0.05])
    assert written.objects == [(CONTROLWORD, b"\x0f\0"), (TARGET_VELOCITY, bytes(4))]


@pytest.mark.parametrize("creep_mm", [0.0004, -0.0004, 0.0])
def test_a_way_of_less_than_an_increment_is_no_speed_for_ever(creep_mm: float) -> None:
    """1000 increments per mm: 0.4 of one in 1 ms are 0.4 mm/s, and nothing is written after it."""
    link, wire, written = led(loop=LOOP)
    lost(link, wire, [0.01, 0.02, 0.03, 0.04, 0.05, 0.05 + creep_mm, 0.05 + creep_mm])
    assert written.objects == [(CONTROLWORD, b"\x0f\0"), (TARGET_VELOCITY, bytes(4))]


def test_a_homing_is_ended_by_sdo_and_a_position_is_not_repeated() -> None:
    """A drive that leads itself hears of the end of it; one that follows positions stands."""
    for leads_itself in (True, False):
        link, wire, written = led()
        link.leads_itself, link.mode_bits = leads_itself, 0x10
        lost(link, wire, [0.0] * MISSING_CYCLES)
        assert written.objects == []
        link.mode_bits = 0
        lost(link, wire, [0.0] * 4)
        assert written.objects == ([(CONTROLWORD, b"\x0f\0")] if leads_itself else [])


def test_each_loss_is_repeated_anew() -> None:
    link, wire, written = led(loop=LOOP)
    for losses in (1, 2):
        lost(link, wire, [0.0] * (MISSING_CYCLES + 3))
        assert len(written.objects) == 2 * losses
        cycle(link, wire, 0.0)


@pytest.mark.parametrize("gone", [0x183, 0x283])
def test_whichever_of_its_telegrams_stays_out_the_drive_gets_its_words_by_sdo(gone: int) -> None:
    """TPDO1 or TPDO2: one is enough to end the program, and the set speed would go on."""
    link, wire, written = led(loop=LOOP)
    for lost_cycles in range(1, MISSING_CYCLES + 4):
        if gone != 0x183:
            wire.status(OPERATION_ENABLED, 0)
        if gone != 0x283:
            wire.latch()
        if lost_cycles <= MISSING_CYCLES:
            link.take()
        else:
            with pytest.raises(Alarm, match="TPDO1" if gone == 0x183 else "TPDO2") as silent:
                link.take()
            assert (silent.value.id, silent.value.values["cycles"]) == (900006, lost_cycles)
        link.send(0.0)
        assert bool(written.objects) is (lost_cycles > MISSING_CYCLES)
    assert written.objects == [(CONTROLWORD, b"\x0f\0"), (TARGET_VELOCITY, bytes(4))]


# The set speed meanwhile


def test_the_loop_is_closed_over_the_last_position_as_long_as_telegrams_may_stay_out() -> None:
    """1 mm of lag is 10 mm/s; after the last cycle that is allowed it is the set speed alone."""
    link, wire, _ = led(loop=LOOP)
    cycle(link, wire, 1.0)
    speeds = []
    for _ in range(MISSING_CYCLES + 2):
        cycle(link, wire, 1.0, None)
        speeds.append(struct.unpack("<HiH", wire.sent[0x203])[1])
    assert speeds == [10_000] * MISSING_CYCLES + [0, 0]
    cycle(link, wire, 1.0, 500)
    assert struct.unpack("<HiH", wire.sent[0x203])[1] == 5000


# A restart


def test_a_drive_that_has_restarted_is_known_by_nothing_of_before() -> None:
    link, wire, _ = led()
    link.arm()
    cycle(link, wire, 0.0)
    assert wire.sent[0x203][6:] != bytes(2)
    link.forget()
    assert (link.statusword, link.state, link.power) == (
        0, State.NOT_READY_TO_SWITCH_ON, Power.OFF,
    )  # fmt: skip
    link.send(0.0)
    assert wire.sent[0x203][6:] == bytes(2)  # 60B8: it has no probe enabled
    cycle(link, wire, 0.0)  # the same word as before is a new one
    assert (link.state, link.power) == (State.OPERATION_ENABLED, Power.OPERATING)


# What does not fit


def test_a_telegram_of_another_length_is_an_alarm_once_each_time() -> None:
    link, wire, _ = led()
    for _ in range(2):
        wire._bring(0x183, b"\x37\x12\0")
        wire.latch()
        with pytest.raises(Alarm) as caught:
            link.take()
        assert caught.value.values == {"axis": "Z", "pdo": "TPDO1", "length": 3, "expected": 8}
        assert cycle(link, wire, 0.0) is None


def test_what_came_with_another_length_before_the_program_does_not_count() -> None:
    link, wire, _ = led()
    wire._bring(0x283, b"\0")
    link.begin()
    assert cycle(link, wire, 0.0) is None


# The second encoder


def test_a_second_encoder_grows_old_while_it_stays_out(tmp_path: Any) -> None:
    table = tmp_path / "map.csv"
    table.write_text(
        "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
        "RPDO1,1,0,0x6040,0,16,no,controlword\nRPDO1,1,0,0x607A,0,32,yes,target\n"
        "TPDO1,1,0,0x6041,0,16,no,statusword\nTPDO1,1,0,0x6064,0,32,yes,actual\n"
        "TPDO4,1,0,0x60E4,1,32,yes,second\n",
        encoding="utf-8",
    )
    link, wire = _link(pdo_map=str(table))
    ages = []
    for second in (None, None, 5, None, None, -7):
        wire._bring(0x183, struct.pack("<Hi", OPERATION_ENABLED, 0))
        if second is not None:
            wire._bring(0x483, struct.pack("<i", second))
        link.take()
        ages.append((link.second_increments, link.second_age_cycles))
    assert ages == [(None, 1), (None, 2), (5, 0), (5, 1), (5, 2), (-7, 0)]
