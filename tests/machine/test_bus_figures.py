"""What the figures of a CAN bus say of ports whose controllers were in trouble, and of others."""

from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.canopen.bus_figures import _figures
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
