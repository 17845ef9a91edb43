"""A channel with drives on a simulated bus; axes in closed form (`world.py`) behind them."""

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count, zip_longest
from typing import Any

import pytest
from tests.channel.programs import end, message, move, prepare, probe, probe_settings, wait
from tests.channel.world import FirstOrderAxis, PlaneProbe, World

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.channel import (
    AxisSettings,
    Channel,
    ChannelSettings,
    CycleTiming,
    Surroundings,
)
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.channel.path.settings import OverrideMode
from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.drives.canopen.carrier import CanCarrier
from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
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
from axisrig.kernel.drives.functions import DriveFunction
from axisrig.kernel.drives.power import PowerRequest
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS, US, S
from axisrig.kernel.time.scheduler import new_scheduler

INCREMENTS_PER_MM = 2**20 / 10
OFFSET_NS = 620 * US
LIMIT_NS = 20 * S
_NUMBERS = count()  # open segments have names of their own


@dataclass(frozen=True)
class AxisSpec:
    """One axis of a bench.

    a_mm_s2: of every ramp. stop_mm_s2: of a stop, None = as the others. ramp_s: of the slopes with
    ramps, at rest and of a stop. probed: whether the probe
    leads to its drive. stop_mm: a fixed stop, beyond which the axis does not get. height_mm: of a
    surface by the time; its second encoder tells how far the axis is below it, in its increments.
    """

    name: str
    start_mm: float = 0.0
    kv: float = 40.0
    droop_mm: float = 0.0
    a_mm_s2: float = 1000.0
    stop_mm_s2: float | None = None
    ramp_s: tuple[float, float] = (0.05, 0.05)
    speed_max_mm_s: float = 500.0
    may_measure: bool = True
    probing_offset_mm: float = 0.0
    old_offset_mm: float = 0.0
    measuring_mm_s: float = 10.0
    stroke_mm: float = math.inf
    delay_ns: int = 0
    simulated: tuple[int, int] = (0, 0)
    source: str = "DRIVE"
    window_mm: float = 0.001
    settling_ns: int = 2 * S
    probed: bool = True
    stop_mm: float = math.inf
    fixed_stop: FixedStopSettings = field(default_factory=FixedStopSettings)
    distance: AxisDistanceSettings | None = None
    height_mm: Callable[[int], float] | None = None
    limits: SoftLimits | None = None
    tells_newer_ids: bool = False
    override_mode: OverrideMode = OverrideMode.CHANNEL

    def measuring(self) -> MeasuringAxis:
        return MeasuringAxis(
            self.measuring_mm_s,
            self.stroke_mm,
            self.probing_offset_mm,
            self.old_offset_mm,
            self.delay_ns,
            simulated=self.simulated,
            source=self.source,
            fixed_stop=self.fixed_stop,
        )

    def settings(self) -> AxisSettings:
        slope = Slope(self.a_mm_s2, self.a_mm_s2, self.speed_max_mm_s)
        stop_mm_s2 = self.stop_mm_s2 or self.a_mm_s2
        stop = Slope(stop_mm_s2, stop_mm_s2, self.speed_max_mm_s)
        dynamics = Dynamics(slope, slope, stop, self.speed_max_mm_s)
        jerk_limited = {}
        for shape in Shape:
            ramped = JerkSlope(self.a_mm_s2, self.ramp_s[0], self.ramp_s[0], shape)
            own = JerkSlope(stop_mm_s2, self.ramp_s[1], self.ramp_s[1], shape)
            limits = Dynamics(ramped, ramped, own, self.speed_max_mm_s)
            jerk_limited[shape] = dict.fromkeys(Motion, limits)
        return AxisSettings(
            self.name,
            self.may_measure,
            self.window_mm,
            self.settling_ns,
            dict.fromkeys(Motion, dynamics),
            self.measuring(),
            distance=self.distance,
            limits=self.limits,
            tells_newer_ids=self.tells_newer_ids,
            override_mode=self.override_mode,
            jerk_limited=jerk_limited,
        )


@dataclass
class Sample:
    """What one cycle left behind: its instant, set positions at its end, state of the links."""

    time_ns: int
    set_mm: tuple[float, ...]
    sent_mm: tuple[float, ...]
    power: bool


class ChannelBench:
    """Scheduler, one segment, a drive per axis, the channel; everything is seen from outside."""

    def __init__(
        self,
        specs: tuple[AxisSpec, ...],
        *,
        plane_mm: float | None = None,
        input_delay_ns: int = 0,
        buffer_cycles: int = 0,
        settings: ChannelSettings | None = None,
        functions: dict[str, DriveFunction] | None = None,
        sync_counter: int = 0,
        missing_cycles: int = 3,
        fault_reset: bool = False,
        lag_limit_mm: float = math.inf,
        pdo_map: str | None = None,
        watches: tuple[WatchSettings, ...] = (),
        start_up: StartUpSettings | None = None,
        profile: DriveProfile | None = None,
        stamps: StampClock | None = None,
        bitrate: int = 1_000_000,
    ) -> None:
        self.bus = BusSettings(sync_counter=sync_counter)
        self.start_up = start_up or StartUpSettings()
        self.scheduler = new_scheduler()
        self.segment = Segment(f"channel bus {next(_NUMBERS)}", bitrate, self.scheduler)
        self.world = World()
        self.frames: list[tuple[int, int, bytes]] = []
        self.segment.observe(lambda t, _name, frame, _e: self.frames.append((t, *frame[:2])))
        self.axes = {
            s.name: FirstOrderAxis(
                self.world, s.start_mm / 1e3, s.kv, s.droop_mm / 1e3, s.stop_mm / 1e3
            )
            for s in specs
        }
        for s in specs:
            self.axes[s.name].height_mm = s.height_mm
        if plane_mm is not None:
            axis = self.axes[specs[-1].name]
            self.world.probe = PlaneProbe(axis, plane_mm / 1e3)
            self.world.probe.level = self.world.probe.is_deflected(0)
        self.profile = profile or DriveProfile(input_delay_ns=input_delay_ns)
        self.nodes = {s.name: self._node(n, s) for n, s in enumerate(specs, 1)}
        self.network = SimNetwork(self.segment.port("cnc")).connect()
        self.links = [
            AxisLink(
                LinkSettings(
                    s.name,
                    INCREMENTS_PER_MM,
                    node_id=n,
                    lag_delay_cycles=2,
                    missing_cycles=missing_cycles,
                    fault_reset=fault_reset,
                    lag_limit_mm=lag_limit_mm,
                    pdo_map=pdo_map,
                    jump_mm=2 * s.speed_max_mm_s * 1e-3,
                    has_second=s.height_mm is not None,
                    status_delay_cycles=self.profile.status_delay_cycles,
                    stamps=stamps,
                ),
                self.network,
                SdoClient(self.network, self.scheduler, n),
            )
            for n, s in enumerate(specs, 1)
        ]
        self.remotes = {}
        for number, spec in enumerate(specs, 1):
            remote = SimRemoteNode(number, object_dictionary(number, self.profile))
            self.network.add_node(remote)
            self.remotes[spec.name] = remote
        self.messages: list[tuple[int, str]] = []
        self.samples: list[Sample] = []
        timing = CycleTiming(MS, OFFSET_NS, buffer_cycles)
        self.channel = Channel(
            self.scheduler,
            timing,
            [s.settings() for s in specs],
            self.links,
            Surroundings(
                put_out=lambda m: self.messages.append((self.scheduler.now_ns, m.text)),
                monitor=Monitor(
                    self.links,
                    [CanCarrier(self.network, sync_counter)],
                    [
                        LinkWatch(link, self.scheduler, watch)
                        for link, watch in zip_longest(
                            self.links, watches, fillvalue=WatchSettings()
                        )
                    ],
                ),
                functions=DriveFunctions(self._accesses(functions)),
            ),
            settings,
        )
        self.channel.observers.append(self._observe)

    def _accesses(self, functions: dict[str, DriveFunction] | None) -> dict[str, DriveAccess]:
        """The ways to the drive of the first axis, None = #DRIVE acts on none."""
        if functions is None:
            return {}
        link = self.links[0]
        sdo = SdoClient(self.network, self.scheduler, 1, timeout_ns=20 * MS)
        return {link.name: DriveAccess(link, sdo, functions)}

    def _node(self, number: int, spec: AxisSpec) -> DriveNode:
        network = SimNetwork(self.segment.port(spec.name)).connect()
        return DriveNode(
            spec.name,
            number,
            network,
            self.scheduler,
            self.axes[spec.name],
            (self.world.probe if spec.probed else None, None),
            self.profile,
        )

    def _observe(self, channel: Channel) -> None:
        self.samples.append(
            Sample(
                self.scheduler.now_ns,
                channel.interpolator.positions_mm,
                tuple(link.set_mm for link in self.links),
                any(link.request is not PowerRequest.OFF for link in self.links),
            )
        )

    def prepare(self, commands: Iterable[canon.Command]) -> None:
        """Start the drives, then the cyclic exchange with a program."""
        self.channel.load(iter(commands))
        self.channel.start_up([self._start_up(link) for link in self.links])

    def _start_up(self, link: AxisLink) -> StartUp:
        node_id, settings = link.node_id, self.start_up
        scaling = Scaling(
            self.profile.encoder_increments, Fraction(self.profile.units_per_revolution)
        )
        od = object_dictionary(node_id, self.profile)
        steps = start_up_steps(settings, self.bus, link.telegrams, node_id, scaling, od)
        assert link.sdo is not None
        address = DriveAddress(link.name, node_id)
        return StartUp(address, self.network, self.scheduler, link.sdo, steps, settings)

    def run(self, commands: Iterable[canon.Command]) -> "ChannelBench":
        """Run a program to its end."""
        self.prepare(commands)
        self.finish()
        return self

    def finish(self, limit_ns: int = LIMIT_NS) -> None:
        ended = self.scheduler.run_while(lambda: not self.channel.has_ended, limit_ns)
        assert ended, f"still {self.channel.state.name} after {limit_ns / S} s"

    # What was seen

    @property
    def alarm_ids(self) -> list[int]:
        return [alarm.id for alarm in self.channel.alarms]

    def set_mm(self, axis: str) -> list[float]:
        index = list(self.axes).index(axis)
        return [sample.set_mm[index] for sample in self.samples]

    def final_mm(self, axis: str) -> float:
        """Where the interpolation ended."""
        return self.set_mm(axis)[-1]

    def sync_ns(self) -> list[int]:
        """Delivery of every SYNC."""
        return [time_ns for time_ns, can_id, _ in self.frames if can_id == 0x080]

    def edge_ns(self) -> int:
        """The one edge of the probe signal."""
        assert self.world.probe is not None
        ((time_ns, _),) = self.world.probe.edges[:1]
        return time_ns


@dataclass(frozen=True)
class Words:
    """The helpers of `programs.py`, for tests that cannot import them."""

    move: Callable[..., canon.LinearMove] = move
    probe: Callable[..., canon.MeasuringRun] = probe
    probe_settings: Callable[..., canon.ProbeSettings] = probe_settings
    prepare: Callable[..., canon.PrepareProbe] = prepare
    message: Callable[..., canon.Message] = message
    wait: Callable[..., canon.Wait] = wait
    end: Callable[..., canon.EndOfProgram] = end
    axis: type[AxisSpec] = AxisSpec


@pytest.fixture
def words() -> Words:
    return Words()


@pytest.fixture
def channel_bench() -> Iterator[Callable[..., ChannelBench]]:
    """Make a bench of axes; plane_mm belongs to the last of them."""
    with ExitStack() as stack:

        def make(*specs: AxisSpec, **options: Any) -> ChannelBench:
            bench = ChannelBench(specs, **options)
            stack.callback(bench.segment.close)
            return bench

        yield make
