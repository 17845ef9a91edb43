"""One, two and three drives on a bus of 1 Mbit/s with SYNC every ms, with FIFO and mailbox ports.

Per drive TPDO 8 + 8, RPDO 8 + 5 bytes, RPDOs 250 us after SYNC. What must come out follows from the
lengths of the frames alone: 49 + 3 * 114 + 89 bits on average, so one drive takes half the time,
two nearly all of it, three more than there is.
"""

import random
from dataclasses import dataclass, field
from itertools import pairwise

import pytest

from axisrig.bench.bus.can.arithmetic import PlannedFrame, cycle_arithmetic
from axisrig.bench.bus.can.controller import QueueKind
from axisrig.bench.bus.can.load import LoadFigures
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import new_scheduler

CYCLES = 1000
TPDOS, RPDOS = {0x180: 8, 0x280: 8}, {0x200: 8, 0x300: 5}


@dataclass
class Traffic:
    """syncs: ends of SYNC frames, ns. received: TPDO1s that the master got."""

    load: LoadFigures
    syncs: list[int] = field(default_factory=list)
    received: int = 0

    @property
    def worst_interval_us(self) -> float:
        return max(b - a for a, b in pairwise(self.syncs)) / US


def play(drives: int, queue: QueueKind) -> Traffic:
    """Let a master and its drives talk for 1000 cycles with random data."""
    scheduler, numbers = new_scheduler(), random.Random(drives)
    with Segment("load", 1_000_000, scheduler) as segment:
        traffic = Traffic(segment.load())
        master = segment.port("master", queue)
        nodes = range(1, drives + 1)
        ports = {node: segment.port(f"drive {node}", queue) for node in nodes}

        def sync_came(port_node: int) -> None:
            for base, size in TPDOS.items():
                ports[port_node].send_raw(base + port_node, numbers.randbytes(size))

        def listen(node: int) -> None:
            ports[node].attach_data(
                lambda can_id, data, time_s: sync_came(node) if can_id == 0x080 else None
            )

        def tpdo_came(can_id: int) -> None:
            traffic.received += can_id in range(0x181, 0x181 + drives)

        master.attach_data(lambda can_id, data, time_s: tpdo_came(can_id))
        for node in nodes:
            listen(node)
        segment.observe(
            lambda time_ns, name, frame, is_error: (
                traffic.syncs.append(time_ns) if frame.arbitration_id == 0x080 else None
            )
        )

        def rpdos() -> None:
            for node in nodes:
                for base, size in RPDOS.items():
                    master.send_raw(base + node, numbers.randbytes(size))

        for k in range(CYCLES):
            at_ns = k * MS
            scheduler.call_at(at_ns, Phase.APPLICATION, lambda: master.send_raw(0x080, b""))
            scheduler.call_at(at_ns + 250 * US, Phase.APPLICATION, rpdos)
        scheduler.run_until(CYCLES * MS)
        traffic.load = segment.load()
        return traffic


@pytest.mark.long
@pytest.mark.parametrize("queue", ["fifo", "mailbox"])
def test_one_drive_takes_half_the_bus_two_nearly_all(queue: QueueKind) -> None:
    """By the mean lengths 49 + 3 * 114 + 89 = 480 bits, two 911."""
    one, two = play(1, queue), play(2, queue)
    assert one.load.busy_share == pytest.approx(0.49, abs=0.02)
    assert two.load.busy_share == pytest.approx(0.93, abs=0.03)
    assert (one.received, two.received) == (CYCLES, 2 * CYCLES)
    assert len(two.syncs) == CYCLES
    # A frame on the wire cannot be interrupted: SYNC is late by one frame at most
    assert max(end - k * MS for k, end in enumerate(two.syncs)) <= (135 + 49) * US
    assert two.load.worst_delay_ns[0x080] <= 135 * US


@pytest.mark.long
def test_in_overload_a_fifo_holds_back_even_sync() -> None:
    """SYNC stands behind RPDOs that lose against every TPDO1: priority inversion."""
    traffic = play(3, "fifo")
    assert traffic.load.busy_share > 0.999
    assert len(traffic.syncs) < CYCLES
    assert traffic.received < 3 * CYCLES
    assert traffic.load.worst_delay_ns[0x080] > 5 * MS


@pytest.mark.long
def test_in_overload_mailboxes_keep_sync_and_starve_the_lowest() -> None:
    """The last RPDO never gets through; its delay is the time since its first request."""
    traffic = play(3, "mailbox")
    assert len(traffic.syncs) == CYCLES
    assert traffic.received == 3 * CYCLES
    assert traffic.worst_interval_us < 1_000 + 2 * 135
    assert traffic.load.worst_delay_ns[0x080] <= 135 * US
    assert traffic.load.worst_delay_ns[0x303] > 100 * MS


@pytest.mark.parametrize(("drives", "fits"), [(1, True), (2, False), (3, False)])
def test_the_arithmetic_foresees_it(drives: int, fits: bool) -> None:
    """Worst case 55 + 540 - 30 bits for one drive; two may be too late, as at 93 % they can be."""
    frames = {
        kind: [
            PlannedFrame(f"{base:x}", base + node, size)
            for node in range(1, drives + 1)
            for base, size in sizes.items()
        ]
        for kind, sizes in (("T", TPDOS), ("R", RPDOS))
    }
    schedule = cycle_arithmetic(1_000_000, MS, 500 * US, frames["T"], frames["R"])
    assert schedule.busy_ns == (55 + drives * (3 * 135 + 105)) * US
    assert schedule.fits is fits
