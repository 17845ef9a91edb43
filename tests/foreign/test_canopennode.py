"""Our master leads a drive that speaks CANopen by CANopenNode, a C stack nobody here wrote.

The stack runs in lockstep with simulated time. The drive around it (`canopennode/slave.py`) uses
nothing of our own drive node; its axis is ideal, so the measured value is the surface itself.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from fractions import Fraction
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.channel import AxisSettings, Channel, CycleTiming, Surroundings
from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.drives.canopen.carrier import CanCarrier
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.canopen.startup_steps import (
    BusSettings,
    Scaling,
    StartUpSettings,
    start_up_steps,
)
from axisrig.kernel.drives.canopen.watch import LinkWatch, WatchSettings
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS, US, S
from axisrig.kernel.time.scheduler import new_scheduler

NODE_ID = 5
PER_REVOLUTION, LEAD_MM = 1 << 20, 10
PER_MM = PER_REVOLUTION / LEAD_MM
START_MM, SURFACE = 20.0, round(5 * PER_MM) + 7
SLOPE = Slope(1000.0, 1000.0, 500.0)
_NUMBERS = count()


def block(number: int) -> Block:
    return Block(number, number * 10, f"N{number * 10}")


def move(number: int, z_mm: float) -> canon.LinearMove:
    return canon.LinearMove(block(number), {"Z": z_mm}, False, 6000.0)


def probe(number: int, z_mm: float) -> canon.MeasuringRun:
    return canon.MeasuringRun(block(number), {"Z": z_mm}, ("Z",), ("Z",), 600.0, 1)


class MasterBench:
    """The master with one foreign drive on a segment of 1 Mbit/s, SYNC every millisecond."""

    def __init__(self, library: Path, surface: int | None, settings: StartUpSettings) -> None:
        from canopennode.slave import ForeignDrive  # noqa: PLC0415

        self.scheduler = new_scheduler()
        self.segment = Segment(f"foreign {next(_NUMBERS)}", 1_000_000, self.scheduler)
        self.frames: list[tuple[int, int, bytes]] = []
        self.segment.observe(lambda t, _name, frame, _error: self.frames.append((t, *frame[:2])))
        port = self.segment.port("drive")
        start = round(START_MM * PER_MM)
        self.drive = ForeignDrive(library, port, self.scheduler, NODE_ID, start, surface)
        self.network = SimNetwork(self.segment.port("cnc")).connect()
        self.link = AxisLink(
            LinkSettings("Z", PER_MM, node_id=NODE_ID, lag_delay_cycles=2), self.network
        )
        dynamics = Dynamics(SLOPE, SLOPE, SLOPE, 500.0)
        axis = AxisSettings("Z", True, 0.01, 2 * S, dict.fromkeys(Motion, dynamics))
        self.channel = Channel(
            self.scheduler,
            CycleTiming(MS, 620 * US, 0),
            [axis],
            [self.link],
            Surroundings(
                put_out=lambda _message: None,
                monitor=Monitor(
                    [self.link],
                    [CanCarrier(self.network)],
                    [LinkWatch(self.link, self.scheduler, WatchSettings())],
                ),
            ),
        )
        self._start = self._start_up(settings)

    def _start_up(self, settings: StartUpSettings) -> StartUp:
        od = object_dictionary(NODE_ID, DriveProfile())
        scaling = Scaling(PER_REVOLUTION, Fraction(PER_REVOLUTION))
        steps = start_up_steps(settings, BusSettings(), self.link.telegrams, NODE_ID, scaling, od)
        sdo = SdoClient(self.network, self.scheduler, NODE_ID)
        address = DriveAddress("Z", NODE_ID)
        return StartUp(address, self.network, self.scheduler, sdo, steps, settings)

    def run(self, *commands: canon.Command, during: Callable[[], object] | None = None) -> None:
        """Run a program to its end; `during` is called 200 ms after the first motion."""
        self.channel.load(iter([*commands, canon.EndOfProgram(block(99))]))
        self.channel.start_up([self._start])
        if during is not None:
            self.scheduler.run_while(lambda: self.channel.start_ns is None, 2 * S)
            self.scheduler.run_until(self.scheduler.now_ns + 100 * MS)
            during()
        assert self.scheduler.run_while(lambda: not self.channel.has_ended, 20 * S)

    @property
    def alarm_ids(self) -> list[int]:
        return [alarm.id for alarm in self.channel.alarms]

    def measured_mm(self) -> list[dict[str, float]]:
        return [record.latched_mm for record in self.channel.records]


@pytest.fixture
def master_bench(canopennode: Path) -> Iterator[Callable[..., MasterBench]]:
    with ExitStack() as stack:

        def make(surface: int | None = SURFACE, **settings: Any) -> MasterBench:
            bench = MasterBench(canopennode, surface, StartUpSettings(**settings))
            stack.callback(bench.segment.close)
            stack.callback(bench.drive.close)
            return bench

        yield make


def test_it_is_started_and_measures(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench()
    bench.run(move(1, 15.0), probe(2, 0.0), move(3, 18.0))
    assert bench.alarm_ids == []
    assert bench.drive.latched == [SURFACE]
    (measured,) = bench.measured_mm()
    assert measured["Z"] == SURFACE / PER_MM  # to the increment
    assert bench.drive.position == round(18.0 * PER_MM)


def test_each_run_has_its_own_latch(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench()
    program = [move(1, 15.0), probe(2, 0.0), move(3, 15.0), probe(4, 0.0), move(5, 15.0)]
    bench.run(*program)
    assert bench.alarm_ids == []
    assert bench.drive.latched == [SURFACE, SURFACE]
    assert [value["Z"] for value in bench.measured_mm()] == [SURFACE / PER_MM] * 2


def test_without_a_surface_there_is_no_value(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench(surface=None)
    bench.run(move(1, 15.0), probe(2, 10.0))
    assert bench.alarm_ids == []
    assert bench.measured_mm() == [{}]


def test_a_fault_with_its_emergency_ends_the_program(
    master_bench: Callable[..., MasterBench],
) -> None:
    bench = master_bench()
    bench.run(move(1, 0.0), during=bench.drive.fail)
    (alarm,) = bench.channel.alarms
    assert "7300" in str(alarm)  # the emergency code of the drive


def test_it_sends_its_heartbeat_as_declared(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench(heartbeat_ms=20)
    bench.run(move(1, 10.0))
    beats = [t for t, can_id, data in bench.frames if can_id == 0x700 + NODE_ID and data == b"\x05"]
    assert len(beats) > 5
    gaps_ms = [(b - a) / MS for a, b in pairwise(beats)]
    assert all(abs(gap - 20) <= 1.1 for gap in gaps_ms)  # its stack is called once a millisecond


def test_another_device_is_refused(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench(identity={1: 0x1234})
    bench.run(move(1, 10.0))
    assert bench.alarm_ids == [900021]


def test_an_object_that_it_does_not_have_is_told(master_bench: Callable[..., MasterBench]) -> None:
    bench = master_bench(writes=[(0x605A, 0, 2)])  # the foreign drive has no quick stop option
    bench.run(move(1, 10.0))
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900011
    assert "605A" in str(alarm)


def test_two_runs_give_the_same_frames(canopennode: Path) -> None:
    logs = []
    for _ in range(2):
        bench = MasterBench(canopennode, SURFACE, StartUpSettings())
        bench.run(move(1, 15.0), probe(2, 0.0), move(3, 18.0))
        logs.append(bench.frames)
        bench.drive.close()
        bench.segment.close()
    assert len(logs[0]) > 4000
    assert logs[0] == logs[1]
