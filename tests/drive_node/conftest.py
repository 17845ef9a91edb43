"""One drive node on a real simulated segment, in front of an axis whose motion is known."""

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

from bench.bus.canopen_sim import SimNetwork, SimRemoteNode
from bench.bus.segment import Segment
from bench.drive.eds import object_dictionary
from bench.drive.node import DriveNode
from bench.drive.profile import DriveProfile
from kernel.clock import MS, US
from kernel.cosim.scheduler import Scheduler

NODE = 3


@dataclass
class Command:
    time_ns: int
    position_m: float
    velocity_m_s: float
    end_ns: int
    enabled: bool


class FakeAxis:
    """An axis that follows its demand exactly, or moves as `motion(time_s)` says whatever comes."""

    def __init__(self, start_m: float = 0.0, motion: Callable[[float], float] | None = None):
        self.now_ns = 0
        self.motion = motion
        self.commands = [Command(0, start_m, 0.0, 0, False)]

    def advance_to(self, time_ns: int) -> None:
        assert time_ns >= self.now_ns
        self.now_ns = time_ns

    def command(
        self, time_ns: int, position_m: float, velocity_m_s: float, end_ns: int, enabled: bool
    ) -> None:
        assert time_ns == self.now_ns
        self.commands.append(Command(time_ns, position_m, velocity_m_s, end_ns, enabled))

    def demand_position_m(self) -> float:
        last = self.commands[-1]
        return last.position_m + last.velocity_m_s * 1e-9 * (
            min(self.now_ns, last.end_ns) - last.time_ns
        )

    def motor_position_m(self) -> float:
        return self.motor_position_m_at(self.now_ns)

    def motor_velocity_m_s(self) -> float:
        return 0.0125

    def motor_position_m_at(self, time_ns: int) -> float:
        assert time_ns <= self.now_ns
        return self.motion(time_ns * 1e-9) if self.motion else self.demand_position_m()


class FakeSignal:
    """A signal with edges known beforehand; it shows those that lie before the axis' now."""

    def __init__(self, axis: FakeAxis, edges_ns: Sequence[int] = (), start: bool = False):
        self.axis, self.start = axis, start
        self.all = [(t, start ^ (n % 2 == 0)) for n, t in enumerate(edges_ns)]

    @property
    def edges(self) -> list[tuple[int, bool]]:
        return [edge for edge in self.all if edge[0] <= self.axis.now_ns]

    @property
    def level(self) -> bool:
        edges = self.edges
        return edges[-1][1] if edges else self.start


@dataclass
class DriveBench:
    """Segment with master and drive; every frame that the master hears, with its time."""

    scheduler: Scheduler
    segment: Segment
    axis: FakeAxis
    node: DriveNode
    master: SimNetwork
    remote: SimRemoteNode
    heard: list[tuple[int, int, bytes]] = field(default_factory=list)

    def frames(self, cob_id: int) -> list[bytes]:
        return [data for _, can_id, data in self.heard if can_id == cob_id]

    def times_ns(self, cob_id: int) -> list[int]:
        return [time_ns for time_ns, can_id, _ in self.heard if can_id == cob_id]

    def run_to_ms(self, time_ms: float) -> None:
        self.scheduler.run_until(round(time_ms * MS))

    def sync_at_ms(self, time_ms: int) -> None:
        """Send a SYNC at `time_ms` and let the answers through; it arrives 47 us later."""
        self.run_to_ms(time_ms)
        self.master.send_message(0x80, b"")
        self.scheduler.run_until(time_ms * MS + 600 * US)

    def set_values(self, controlword: int, target: int, function: int = 0) -> None:
        """Send RPDO1 in its default mapping."""
        self.master.send_message(0x200 + NODE, struct.pack("<HiH", controlword, target, function))

    def operational(self, at_ms: float = 2) -> None:
        self.run_to_ms(at_ms)
        self.remote.nmt.send_command(1)
        self.run_to_ms(at_ms + 0.5)

    def enable(self, first_ms: int, target: int = 0, function: int = 0) -> None:
        """Walk to operation enabled with the SYNCs at first_ms, +1 and +2 ms."""
        for step, controlword in enumerate((0x06, 0x07, 0x0F)):
            self.set_values(controlword, target, function)
            self.sync_at_ms(first_ms + step)


@pytest.fixture
def fake_axis() -> type[FakeAxis]:
    return FakeAxis


@pytest.fixture
def fake_signal() -> type[FakeSignal]:
    return FakeSignal


@pytest.fixture
def drive_bench() -> Iterator[Callable[..., DriveBench]]:
    """Make a bench: axis, edges of probe input 1 and 2 (None = open), profile, remote class."""
    scheduler = Scheduler()
    with Segment("drive bus", 1_000_000, scheduler) as segment:

        def make(
            axis: FakeAxis | None = None,
            inputs: tuple[Any, Any] = (None, None),
            profile: DriveProfile | None = None,
            remote: type[SimRemoteNode] = SimRemoteNode,
        ) -> DriveBench:
            axis = axis or FakeAxis()
            profile = profile or DriveProfile()
            signals = [None if edges is None else FakeSignal(axis, edges) for edges in inputs]
            node = DriveNode(
                "Z",
                NODE,
                SimNetwork(segment.port("drive")).connect(),
                scheduler,
                axis,
                (signals[0], signals[1]),
                profile,
            )
            port = segment.port("master")
            heard: list[tuple[int, int, bytes]] = []
            port.attach(lambda m: heard.append((segment.now_ns, m.arbitration_id, bytes(m.data))))
            master = SimNetwork(port).connect()
            far = remote(NODE, object_dictionary(NODE, profile))
            master.add_node(far)
            bench = DriveBench(scheduler, segment, axis, node, master, far, heard)
            bench.run_to_ms(1)
            return bench

        yield make
