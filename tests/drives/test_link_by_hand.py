"""The kernel's link with telegrams written by hand: nothing but the link is behind the numbers."""

import struct
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.measuring.latest_edge import StampClock

OPERATION_ENABLED, FAULT, REACTING = 0x1237, 0x0218, 0x021F


class Wire:
    """Takes what the link sends and brings what the test says."""

    def __init__(self) -> None:
        self.sent: dict[int, bytes] = {}
        self.listeners: dict[int, Callable[[int, bytearray, float], None]] = {}

    def subscribe(self, can_id: int, callback: Any) -> None:
        self.listeners[can_id] = callback

    def send_message(self, can_id: int, data: bytes) -> None:
        self.sent[can_id] = bytes(data)

    def status(self, statusword: int, increments: int) -> None:
        self._bring(0x183, struct.pack("<HiH", statusword, increments, 0))

    def latch(self) -> None:
        self._bring(0x283, struct.pack("<i", 0))

    def probe(self, probe_status: int, increments: int, latched: int) -> None:
        data = struct.pack("<HiH", OPERATION_ENABLED, increments, probe_status)
        self._bring(0x183, data)
        self._bring(0x283, struct.pack("<i", latched))

    def _bring(self, can_id: int, data: bytes) -> None:
        self.listeners[can_id](can_id, bytearray(data), 0.0)


def _link(**settings: Any) -> tuple[AxisLink, Wire]:
    wire = Wire()
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3, **settings), wire)
    link.begin()
    return link, wire


@pytest.mark.parametrize(("after_ns", "actual"), [(154_999, 0.0), (155_000, 2.0)])
def test_what_ends_before_it_can_answer_the_sync_is_of_an_earlier_one(
    after_ns: int, actual: float
) -> None:
    """SYNC, intermission and 8 bytes without a stuff bit: 44 + 3 + 44 + 64 bits at 1 Mbit/s."""
    wire, clock = Wire(), SimpleNamespace(now_ns=0)
    answers_ns = tuple((91 + 8 * count) * 1000 for count in range(9))
    settings = LinkSettings("Z", 1000.0, node_id=3, answers_ns=answers_ns)
    link = AxisLink(settings, wire, clock=clock)  # type: ignore[arg-type]
    link.begin()
    for sync_ns in (7_000_000, 8_000_000):
        clock.now_ns = sync_ns
        link.begin_cycle()
        clock.now_ns = sync_ns + after_ns
        wire.status(OPERATION_ENABLED, 2000)
        clock.now_ns = sync_ns + 200_000
        wire.latch()
        link.take()
        assert (link.actual_mm, link.has_actual) == (actual, actual > 0)


def test_missing_telegrams_leave_more_way_before_a_position_has_jumped() -> None:
    """1 mm per cycle at most; 0.9 mm per cycle over two missing cycles are 2.7 mm."""
    link, wire = _link(jump_mm=1.0)
    for cycle, arrives in enumerate((True, True, False, False, True)):
        if arrives:
            wire.status(OPERATION_ENABLED, 900 * cycle)
        wire.latch()
        link.take()
    assert link.jump_mm is None
    wire.status(OPERATION_ENABLED, 900 * 4 + 1001)
    link.take()
    assert link.jump_mm == 1.001


@pytest.mark.parametrize("latched", [1700, 2000, 2900, 3300])
def test_the_doubt_of_an_unproved_latch_is_how_far_it_may_be_off(latched: int) -> None:
    """No SDO asks. 500 a cycle from 1000 to 3000: believed is 500 + 0.1 mm more on both sides,
    400 to 3600; the farther end counts.
    """
    link, wire = _link()
    assert link.doubt_mm is None
    places = [1000, 1500, 2000, 2500, 3000]
    for turn in range(2):  # what the second run has seen alone counts
        wire.probe(0, 1000, 0)
        link.take()
        link.arm()
        assert link.doubt_mm is None
        for place in places:
            is_stored = place >= 2500
            wire.probe(0x3 if is_stored else 0x1, place, latched + turn if is_stored else turn)
            link.take()
        assert link.is_confirmed()
        farthest = max(latched + turn - 400, 3600 - latched - turn)
        assert link.doubt_mm == pytest.approx(farthest / 1000.0, abs=1e-12)
        assert link.unproved_latches == turn + 1
        link.disarm()


def test_a_fault_is_acknowledged_by_edges_until_it_is_gone() -> None:
    """The first edge may be lost on the bus, and a bit that is held resets nothing."""
    link, wire = _link(fault_reset=True)
    link.acknowledges_faults = True
    words = []
    for _ in range(4):
        wire.status(FAULT, 0)
        wire.latch()
        link.take()
        link.send(0.0)
        words.append(wire.sent[0x203][0] & 0x80)
    assert words == [0x80, 0, 0x80, 0]


def test_a_fault_is_acknowledged_only_after_the_reaction_of_the_drive() -> None:
    """CiA 402-2: fault reaction active takes no command; the reset bit comes with FAULT."""
    link, wire = _link(fault_reset=True)
    link.acknowledges_faults = True
    words = []
    for state in (REACTING, REACTING, REACTING, FAULT, FAULT):
        wire.status(state, 0)
        wire.latch()
        link.take()
        link.send(0.0)
        words.append(wire.sent[0x203][0])
    assert words == [0, 0, 0, 0x80, 0]


STAMPED = (
    "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
    "RPDO1,1,0,0x6040,0,16,no,controlword\nRPDO1,1,0,0x607A,0,32,yes,target\n"
    "RPDO1,1,0,0x60B8,0,16,no,probe_function\nTPDO1,1,0,0x6041,0,16,no,statusword\n"
    "TPDO1,1,0,0x6064,0,32,yes,actual\nTPDO1,1,0,0x60B9,0,16,no,probe_status\n"
    "TPDO2,1,0,{latch},0,32,yes,latch\nTPDO2,1,0,{stamp},0,32,no,\n"
)


def test_the_time_stamp_is_that_of_the_latch_in_use(tmp_path: Path) -> None:
    """60D1 belongs to 60BA; by the words `latch` and `stamp` 60D4 to 60BD. It needs no field."""
    for latch, stamp, chosen, is_there in (
        ("0x60BA", "0x60D1", (1, "POS"), True),
        ("0x60BA", "0x60D2", (1, "POS"), False),
        ("latch", "stamp", (2, "NEG"), True),
    ):
        table = tmp_path / f"{latch}{stamp}.csv"
        table.write_text(STAMPED.format(latch=latch, stamp=stamp))
        link, wire = _link(
            pdo_map=str(table),
            probe_input=chosen[0],
            edge=chosen[1],
            stamps=StampClock(),
        )
        wire.status(OPERATION_ENABLED, 0)
        wire._bring(0x283, struct.pack("<iI", 0, 4711))
        link.take()
        assert link.arrival.stamp == (4711 if is_there else None)
        assert (link.arrival.is_new, link.arrival.is_stamped) == (True, is_there)
        wire._bring(0x283, struct.pack("<iI", 0, 4712))
        link.take()  # without 60B9
        assert link.arrival.is_new is False


def test_another_latch_has_the_time_stamp_of_its_own(tmp_path: Path) -> None:
    """60D1 with 60BA and 60D4 with 60BD, there and back; 60BB is mapped without one."""
    table = tmp_path / "map.csv"
    rows = STAMPED.partition("TPDO2")[0]
    for number, (latch, stamp) in enumerate(((0x60BA, 0x60D1), (0x60BD, 0x60D4)), 2):
        rows += f"TPDO{number},1,0,0x{latch:X},0,32,yes,{'latch' if number == 2 else ''}\n"
        rows += f"TPDO{number},1,0,0x{stamp:X},0,32,no,\n"
    table.write_text(f"{rows}TPDO4,1,0,0x60BB,0,32,yes,\n", encoding="utf-8")
    link, wire = _link(pdo_map=str(table), stamps=StampClock())

    def cycle() -> None:
        wire.status(OPERATION_ENABLED, 0)
        wire._bring(0x283, struct.pack("<iI", 0, 4711))
        wire._bring(0x383, struct.pack("<iI", 0, 815))
        wire._bring(0x483, struct.pack("<i", 0))
        link.take()

    for chosen, stamp in (
        ((1, "POS"), 4711), ((2, "NEG"), 815), ((1, "NEG"), None), ((2, "NEG"), 815),
        ((1, "POS"), 4711),
    ):  # fmt: skip
        link.choose_latch(*chosen)
        assert link.arrival.stamp is None
        cycle()
        assert link.arrival.stamp == stamp


TWO_EDGES = (
    STAMPED.partition("TPDO2")[0] + "TPDO2,1,0,latch,0,32,yes,latch\n"
    "TPDO2,1,0,counter,0,16,no,latch_count\n"
    "TPDO3,1,0,0x60BB,0,32,yes,\nTPDO3,1,0,0x60D6,0,16,no,\n"
)


@pytest.mark.parametrize("in_use", ["POS", "NEG"])
def test_after_a_restart_of_the_drive_every_latch_counts_anew(tmp_path: Path, in_use: str) -> None:
    """The counter of 60BA goes on at 0, whichever latch was in use when the drive restarted."""
    table = tmp_path / "map.csv"
    table.write_text(TWO_EDGES, encoding="utf-8")
    link, wire = _link(pdo_map=str(table))

    def cycle(probe_status: int, place: int, count: int) -> None:
        wire._bring(0x183, struct.pack("<HiH", OPERATION_ENABLED, place, probe_status))
        wire._bring(0x283, struct.pack("<iH", place, count))
        wire._bring(0x383, struct.pack("<iH", 0, 0))
        link.take()

    for count, place in ((5, 1000), (0, 3000)):
        cycle(0x0, place, count)
        assert link.is_clear
        link.arm()
        cycle(0x1, place, count)
        assert link.latched_mm is None
        cycle(0x3, place, count + 1)
        assert link.latched_mm == place / 1000.0
        link.disarm()
        link.choose_latch(1, in_use)
        link.forget()
        link.choose_latch(1, "POS")
        assert link.is_clear


@pytest.mark.parametrize("counted", [0x60D5, 0x60D6])
def test_another_edge_is_proved_by_its_own_counter(tmp_path: Path, counted: int) -> None:
    """60D6 counts 60BB: one more than before proves the position at once, 60D5 says nothing."""
    table = tmp_path / "map.csv"
    table.write_text(TWO_EDGES, encoding="utf-8")
    link, wire = _link(pdo_map=str(table))
    link.choose_latch(1, "NEG")

    def cycle(probe_status: int, latched: int, more: int) -> None:
        counts = [5 + more * (counted == 0x60D5), 8 + more * (counted == 0x60D6)]
        wire._bring(0x183, struct.pack("<HiH", OPERATION_ENABLED, 1000, probe_status))
        wire._bring(0x283, struct.pack("<iH", 700, counts[0]))
        wire._bring(0x383, struct.pack("<iH", latched, counts[1]))
        link.take()

    cycle(0x0, 900, 0)
    link.arm()
    cycle(0x1, 900, 0)
    cycle(0x5, 1001, 1)  # bit 2 of 60B9: the negative edge is stored
    assert link.latched_mm == (1.001 if counted == 0x60D6 else None)
