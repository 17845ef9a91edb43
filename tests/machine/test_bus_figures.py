"""What the figures of a CAN bus say of ports whose controllers were in trouble, and of others."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.canopen.bus_figures import _figures, frame_names
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import new_scheduler

BIT_RATE = 1_000_000
RECOVERY_NS = 128 * 11_000
"""128 times 11 recessive bits of 1 us (ISO 11898-1)."""


def test_a_port_that_came_back_from_bus_off_is_listed_with_counters_of_0() -> None:
    """The one that saw its error frame has REC 1; one that nothing has happened to is left out."""
    scheduler = new_scheduler()
    with Segment("can1", BIT_RATE, scheduler) as segment:
        sender = segment.port("sender")
        segment.port("other")
        sender.send_raw(0x123, b"\x01\x02")
        scheduler.call_at(19_500, Phase.APPLICATION, sender.force_bus_off)
        scheduler.run_until(MS)
        segment.port("idle")
        scheduler.run_until(MS + 2 * RECOVERY_NS)
        found = _figures(segment, {0x123: ("Z.TPDO1", "Z")}, "too late")
    assert [port[:3] for port in found.counters] == [("sender", 0, 0), ("other", 0, 1)]
    assert [(change.port, change.is_active) for change in found.changes] == [
        ("sender", False),
        ("sender", True),
    ]
    assert (found.error_frames, found.overload) == (1, "too late")


def test_loads_are_of_the_run_and_of_the_worst_windows() -> None:
    """Ten frames, one each ms from 40 ms on, in a run of 300 ms: once for 10 ms and one of 1 ms."""
    scheduler = new_scheduler()
    with Segment("can1", BIT_RATE, scheduler) as segment:
        sender = segment.port("sender")
        segment.port("other")
        for number in range(10):
            at_ns = (40 + number) * MS
            scheduler.call_at(at_ns, Phase.APPLICATION, lambda: sender.send_raw(0x123, bytes(8)))
        scheduler.run_until(300 * MS)
        found = _figures(segment, {}, "")
    frame = Frame(0x123, bytes(8), False, False, 8)
    busy_us = frame_bits(frame)  # at 1 Mbit/s, with the intermission
    assert (found.segment, found.bitrate, found.frames) == ("can1", BIT_RATE, 10)
    assert found.load_pct == pytest.approx(100 * 10 * busy_us / 300e3)
    assert found.load_100ms_pct == pytest.approx(100 * 10 * busy_us / 100e3)
    assert found.load_1ms_pct == pytest.approx(100 * busy_us / 1e3)
    assert (found.error_frames, found.counters, found.changes, found.overload) == (0, (), (), "")


def test_the_longest_waits_come_first_and_have_their_names() -> None:
    """Four frames at once: each waits for those before it; an unknown one has its number."""
    scheduler = new_scheduler()
    ids = [(0x181, False), (0x0777, False), (0x18AA0001, True), (0x201, False)]
    with Segment("can1", BIT_RATE, scheduler) as segment:
        for number, (can_id, _) in enumerate(ids):
            port = segment.port(f"p{number}")
            port.send_raw(can_id, b"")
        scheduler.run_until(5 * MS)
        found = _figures(segment, {0x181: ("Z.TPDO1", "Z"), 0x201: ("Z.RPDO1", "Z")}, "")
    # By priority: 0x181, 0x201, then 11 bits of 0x18AA0001 (0x62A) before 0x777
    waits = [(waiting.name, waiting.axis) for waiting in found.waiting]
    assert waits == [("0x777", ""), ("0x18aa0001", ""), ("Z.RPDO1", "Z"), ("Z.TPDO1", "Z")]
    lengths = [
        frame_bits(Frame(can_id, b"", is_long, False, 0)) for can_id, is_long in (ids[0], ids[3])
    ]
    us = {waiting.name: waiting.worst_us for waiting in found.waiting}
    first = us["Z.TPDO1"]
    assert us["Z.RPDO1"] - first == pytest.approx(lengths[0])
    assert us["0x18aa0001"] - first == pytest.approx(sum(lengths))


@pytest.mark.interpreted
@pytest.mark.parametrize("master", [1, 100, 127])
def test_frames_of_a_segment_have_the_names_of_its_own_axes(master: int) -> None:
    """The pre-defined connection set of CiA 301, and what an axis has mapped elsewhere."""
    settings = settings_of("probe-xyz.toml")
    cycle = settings.rig.cycle.model_copy(update={"master_node": master})
    rig = settings.rig.model_copy(update={"cycle": cycle})
    own: Any = SimpleNamespace(name="TPDO1", cob_id=lambda _node: 0x1F5)
    links: Any = {
        name: SimpleNamespace(telegrams={"TPDO1": own} if name == "Y" else {}) for name in "XYZ"
    }
    given: Any = SimpleNamespace(rig=rig)
    axis = rig.axis["Y"]
    found = frame_names(given, links, axis.segment)
    node = axis.node_id
    assert found == {
        0x000: ("NMT", ""), 0x080: ("SYNC", ""), 0x700 + master: ("heartbeat of the kernel", ""),
        0x080 + node: ("Y.EMCY", "Y"), 0x580 + node: ("Y.SDO answer", "Y"),
        0x600 + node: ("Y.SDO request", "Y"), 0x700 + node: ("Y.heartbeat", "Y"),
        0x1F5: ("Y.TPDO1", "Y"),
    }  # fmt: skip
