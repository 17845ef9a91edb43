"""How long the handshake of a touch probe takes on the bus: docs/touch-probe.md, table.

SYNC every ms, RPDO1 250 us after it, one drive at 1 Mbit/s. T the period, S the delivery of SYNC,
D that of TPDO1 after the request of SYNC. A request waits for the RPDO (0 to T), which acts with
the next SYNC (T - 250 us later) and shows in its TPDO1:

    request -> acknowledged   T - 250 us + D  to  2 T - 250 us + D
    edge -> stored bit        D - S           to  T + D - S

A drive that samples before it applies, or whose status is older, adds whole periods.
"""

import random
import statistics
import struct
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import Phase

Make = Callable[..., Any]
MS, US = 1_000_000, 1_000
TPDO1 = 0x183
OFFSET_NS = 250 * US
ARMED = 0x0011
SAMPLES = 60


class Handshake:
    """A master that sends the function word with every RPDO1 and watches 60B9."""

    def __init__(self, bench: Any) -> None:
        self.bench, self.word = bench, 0
        bench.operational(6)
        self._at(10 * MS, self._sync)
        self._at(10 * MS + OFFSET_NS, self._send)

    def _at(self, time_ns: int, what: Callable[[], None]) -> None:
        self.bench.scheduler.call_at(time_ns, Phase.APPLICATION, what)

    def _sync(self) -> None:
        self.bench.master.send_message(0x80, b"")
        self._at(self.bench.scheduler.now_ns + MS, self._sync)

    def _send(self) -> None:
        self.bench.set_values(0, 0, self.word)
        self._at(self.bench.scheduler.now_ns + MS, self._send)

    def seen_ns(self, bit: int, is_set: bool, after_ns: int) -> int:
        """When a TPDO1 first shows a bit of 60B9 so."""
        looked = len(self.bench.heard)
        while True:
            for time_ns, can_id, data in self.bench.heard[looked:]:
                looked += 1
                if can_id == TPDO1 and time_ns > after_ns:
                    status = struct.unpack("<HiH", data)[2]
                    if bool(status & bit) is is_set:
                        return int(time_ns)
            self.bench.scheduler.run_until(self.bench.scheduler.now_ns + 10 * US)

    def ask(self, word: int, request_ns: int) -> int:
        """Ask for a word at an instant; return when 60B9 bit 0 follows."""
        self.bench.scheduler.run_until(max(request_ns, self.bench.scheduler.now_ns))
        self.word = word
        return self.seen_ns(0x0001, bool(word), request_ns)


@pytest.mark.parametrize(
    ("habits", "late_cycles", "full_ms"),
    [
        ({}, 0, 2),
        ({"sampling": "before_rpdo"}, 1, 4),
        ({"status_delay_cycles": 1}, 1, 4),
        ({"sampling": "before_rpdo", "status_delay_cycles": 2}, 3, 8),
    ],
)
@pytest.mark.long(but=1)
def test_arming_and_arming_again(
    drive_bench: Make, habits: dict[str, Any], late_cycles: int, full_ms: int
) -> None:
    handshake = Handshake(drive_bench(profile=DriveProfile(input_delay_ns=0, **habits)))
    rng = random.Random(1)
    waits = []
    for n in range(SAMPLES):
        request_ns = (20 + 20 * n) * MS + rng.randrange(MS)
        waits.append(handshake.ask(ARMED, request_ns) - request_ns)
        handshake.ask(0, (30 + 20 * n) * MS + 100 * US)
    delivery_ns = _delivery_ns(handshake.bench)
    shortest = MS - OFFSET_NS + delivery_ns + late_cycles * MS
    assert shortest <= min(waits) < shortest + 60 * US
    assert shortest + MS - 60 * US < max(waits) <= shortest + MS
    assert abs(statistics.median(waits) - shortest - MS / 2) < 130 * US
    # Off, seen, on, seen, each order given as soon as the answer is there
    begin_ns = 2000 * MS + 200 * US
    armed_ns = handshake.ask(ARMED, begin_ns)
    again_ns = handshake.ask(ARMED, handshake.ask(0, armed_ns))
    assert again_ns - armed_ns == pytest.approx(full_ms * MS, abs=20 * US)


@pytest.mark.long
@pytest.mark.parametrize(
    ("habits", "late_cycles"),
    [({}, 0), ({"sampling": "before_rpdo"}, 0), ({"status_delay_cycles": 2}, 2)],
)
def test_from_the_edge_to_the_stored_bit(
    drive_bench: Make, habits: dict[str, Any], late_cycles: int
) -> None:
    """The order of sampling and applying does not matter for an edge."""
    rng = random.Random(2)
    edges, waits = [], []
    for n in range(SAMPLES):
        edges += [(25 + 20 * n) * MS + rng.randrange(MS), (29 + 20 * n) * MS]
    profile = DriveProfile(input_delay_ns=0, **habits)
    handshake = Handshake(drive_bench(inputs=(edges, None), profile=profile))
    for n, edge_ns in enumerate(edges[::2]):
        handshake.ask(ARMED, (20 + 20 * n) * MS)
        handshake.bench.scheduler.run_until(edge_ns)
        waits.append(handshake.seen_ns(0x0002, True, edge_ns) - edge_ns)
        handshake.ask(0, (33 + 20 * n) * MS)
    shortest = _delivery_ns(handshake.bench) - 48 * US + late_cycles * MS
    assert shortest <= min(waits) < shortest + 60 * US
    assert shortest + MS - 60 * US < max(waits) <= shortest + MS + 1
    assert abs(statistics.median(waits) - shortest - MS / 2) < 130 * US


def _delivery_ns(bench: Any) -> int:
    """When TPDO1 comes after the request of its SYNC, from the log."""
    times = [t % MS for t, can_id, _ in bench.heard if can_id == TPDO1]
    assert max(times) - min(times) <= 8 * US  # stuff bits
    return min(times)
