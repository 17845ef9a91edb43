"""Local time of a slave beside its system time, shares of a ppm, and pulses that go on."""

import struct

import pytest
from tests.ethercat.line import Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.kernel.time.clock import MS, S

APRD, APWR, BWR = 1, 2, 8
START_NS = 7 * S + 123


@pytest.mark.parametrize("offset", [0, 5 * S, -3 * S])
@pytest.mark.parametrize("drift_ppm", [0.0, 25.0])
def test_receive_times_are_local_ones_whatever_the_offset(offset: int, drift_ppm: float) -> None:
    """0900 and 0918; 0910 alone is the system time (ET1100, distributed clocks). After 10 s."""
    line = Line(settings=[SlaveSettings(1, start_ns=START_NS, drift_ppm=drift_ppm)])
    line.one(APWR, 0, 0x0920, struct.pack("<Q", offset % (1 << 64)))
    line.clock.run_until(10 * S)
    line.one(BWR, 0, 0x0900, bytes(4))
    frame_ns = line.clock.now_ns - 10 * S
    port_0 = line.one(APRD, 0, 0x0900, 4).number
    unit = line.one(APRD, 0, 0x0918, 8).number
    assert unit & 0xFFFF_FFFF == port_0
    drift_ns = round(10_000 * drift_ppm)
    assert 0 < unit - START_NS - 10 * S - drift_ns < frame_ns < 10_000
    system = line.one(APRD, 0, 0x0910, 8).number
    passed_ns = line.clock.now_ns - 10 * S  # three frames
    assert 0 < (system - unit - offset) % (1 << 64) < passed_ns


@pytest.mark.parametrize("drift_ppm", [0.4, -0.4, 1.5, -1.5, 0.001, 99.999])
def test_a_drift_is_exact_to_a_thousandth_of_a_ppm(drift_ppm: float) -> None:
    """0.4 ppm are 400 ns in a second."""
    clock = LocalClock(10, drift_ppm)
    for seconds in (1, 100):
        expected = 10 + seconds * S + round(seconds * drift_ppm * 1000)
        assert clock.at(seconds * S) == expected
    assert clock.parts == round(drift_ppm * 1000)


@pytest.mark.parametrize(("first", "second"), [(3, 7), (7, 3)])
def test_pulses_of_sync0_go_on_when_sync1_comes_or_goes(first: int, second: int) -> None:
    """0981 is written while SYNC0 runs: its cycle is kept, and no pulse is counted anew."""
    line = Line()
    cycle_ns = 250_000
    line.write(0x09A4, cycle_ns, 4)
    start_sync(line, cycle_ns, 1 * MS, first)
    line.clock.run_until(line.clock.now_ns + 3 * MS)
    sync = line.drive.sync
    before, next_ns = sync.pulses, sync.next0
    assert before > 4
    line.write(0x0981, second, 1)
    assert sync.pulses >= before
    line.clock.run_until(line.clock.now_ns + 2 * MS)
    assert sync.pulses >= before + 7
    assert (sync.next0 - next_ns) % cycle_ns == 0
    assert (sync.next0 - next_ns) // cycle_ns == sync.pulses - before
