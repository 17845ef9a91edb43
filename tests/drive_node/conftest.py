"""One drive node on a real simulated segment, in front of an axis whose motion is known."""

import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import count
from typing import Any

import pytest
from tests.drive_node.profile_drive import Drive

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.axis.ports import ControlKind
from axisrig.bench.drive.canopen.node import Document, DriveNode
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

NODE = 3


@dataclass
class Command:
    """What the axis was told last: a ramp of position or velocity, or a force."""

    time_ns: int
    position_m: float = 0.0
    velocity_m_s: float = 0.0
    end_ns: int = 0
    enabled: bool = True
    kind: ControlKind = ControlKind.POSITION
    acceleration_m_s2: float = 0.0
    force_n: float = 0.0


class FakeAxis:
    """An axis that follows its demand exactly, or moves as `motion(time_s)` says whatever comes.

    A force within the limits moves its mass without friction. encoder_2_m: offset of a second
    encoder, None = there is none. limits: every pair that `limit_force` was given.
    """

    kinds = frozenset(ControlKind)
    limits_force = True
    mass_kg = 100.0

    def __init__(
        self,
        start_m: float = 0.0,
        motion: Callable[[float], float] | None = None,
        encoder_2_m: float | None = None,
    ):
        self.now_ns = 0
        self.motion = motion
        self.encoder_2_m = encoder_2_m
        self.commands = [Command(0, start_m, enabled=False)]
        self.limits: list[tuple[float, float]] = []

    def advance_to(self, time_ns: int) -> None:
        assert time_ns >= self.now_ns
        self.now_ns = time_ns

    def command(
        self, time_ns: int, position_m: float, velocity_m_s: float, end_ns: int, enabled: bool
    ) -> None:
        assert time_ns == self.now_ns
        self.commands.append(Command(time_ns, position_m, velocity_m_s, end_ns, enabled))

    def command_velocity(
        self, time_ns: int, velocity_m_s: float, acceleration_m_s2: float, end_ns: int
    ) -> None:
        assert time_ns == self.now_ns
        command = Command(time_ns, self.demand_position_m(), velocity_m_s, end_ns)
        command.kind, command.acceleration_m_s2 = ControlKind.VELOCITY, acceleration_m_s2
        self.commands.append(command)

    def command_force(self, time_ns: int, force_n: float) -> None:
        assert time_ns == self.now_ns
        here_m, velocity_m_s = self.demand_position_m(), self.demand_velocity_m_s()
        command = Command(time_ns, here_m, velocity_m_s, kind=ControlKind.FORCE, force_n=force_n)
        self.commands.append(command)

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        self.limits.append((negative_n, positive_n))

    def force_n(self) -> float:
        negative_n, positive_n = self.limits[-1] if self.limits else (1e9, 1e9)
        return max(-negative_n, min(self.commands[-1].force_n, positive_n))

    def second_encoder_m(self) -> float | None:
        return None if self.encoder_2_m is None else self.motor_position_m() + self.encoder_2_m

    def second_encoder_m_at(self, time_ns: int) -> float:
        assert self.encoder_2_m is not None
        return self.motor_position_m_at(time_ns) + self.encoder_2_m

    def _spans_s(self) -> tuple[float, float]:
        """How long the last command has been moving, and how long it has rested since."""
        last = self.commands[-1]
        moving_ns = min(self.now_ns, last.end_ns) - last.time_ns
        return moving_ns * 1e-9, (self.now_ns - last.time_ns - moving_ns) * 1e-9

    def demand_position_m(self) -> float:
        last, (moving_s, resting_s) = self.commands[-1], self._spans_s()
        if last.kind is ControlKind.POSITION:
            return last.position_m + last.velocity_m_s * moving_s
        if last.kind is ControlKind.VELOCITY:
            way_m = (last.velocity_m_s + last.acceleration_m_s2 / 2 * moving_s) * moving_s
            return last.position_m + way_m + self.demand_velocity_m_s() * resting_s
        passed_s = (self.now_ns - last.time_ns) * 1e-9
        return last.position_m + passed_s * (
            last.velocity_m_s + self.force_n() / self.mass_kg / 2 * passed_s
        )

    def demand_velocity_m_s(self) -> float:
        last, (moving_s, resting_s) = self.commands[-1], self._spans_s()
        if last.kind is ControlKind.POSITION:
            return last.velocity_m_s if resting_s == 0.0 else 0.0
        if last.kind is ControlKind.VELOCITY:
            return last.velocity_m_s + last.acceleration_m_s2 * moving_s
        passed_s = (self.now_ns - last.time_ns) * 1e-9
        return last.velocity_m_s + self.force_n() / self.mass_kg * passed_s

    def motor_position_m(self) -> float:
        return self.motor_position_m_at(self.now_ns)

    def motor_velocity_m_s(self) -> float:
        if self.motion:
            now_s, step_s = self.now_ns * 1e-9, 1e-6
            return (self.motion(now_s + step_s) - self.motion(now_s - step_s)) / (2 * step_s)
        return self.demand_velocity_m_s()

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
    """Make a bench: axis, edges of probe input 1 and 2 (None = open), profile, remote class.

    Each one has a clock of its own.
    """
    numbers = count(1)
    with ExitStack() as stack:

        def make(
            axis: FakeAxis | None = None,
            inputs: tuple[Any, Any] = (None, None),
            profile: DriveProfile | None = None,
            remote: type[SimRemoteNode] = SimRemoteNode,
            document: Document | None = None,
        ) -> DriveBench:
            scheduler = new_scheduler()
            name = f"drive bus {next(numbers)}"
            segment = stack.enter_context(Segment(name, 1_000_000, scheduler))
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
                document=document,
            )
            port = segment.port("master")
            heard: list[tuple[int, int, bytes]] = []
            port.attach(lambda m: heard.append((segment.now_ns, m.arbitration_id, bytes(m.data))))
            master = SimNetwork(port).connect()
            od = object_dictionary(NODE, profile) if document is None else document.dictionary
            far = remote(NODE, od)
            master.add_node(far)
            bench = DriveBench(scheduler, segment, axis, node, master, far, heard)
            bench.run_to_ms(1)
            return bench

        yield make


@pytest.fixture
def drive(drive_bench: Callable[..., DriveBench]) -> Callable[..., Drive]:
    """Make a drive in a mode of operation, with values of objects by name (o6081)."""
    return lambda mode, **objects: Drive(drive_bench(), mode, **objects)
