"""The kernel's end of a drive and the drive itself on one simulated segment, the axis a fake."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.axis.ports import ControlKind
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.canopen.startup_steps import (
    BusSettings,
    Scaling,
    StartUpSettings,
    start_up_steps,
)
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

NODE = 3
OFFSET_NS = 600 * US
# 20 bit per revolution on a screw of 10 mm lead
INCREMENTS_PER_MM = 2**20 / 10


class TrailingAxis:
    """An axis that is always `behind_m` below its demand and stands when it has none."""

    kinds = frozenset({ControlKind.POSITION})
    limits_force = False

    def __init__(self, start_m: float = 0.0, behind_m: float = 0.0) -> None:
        self.now_ns, self.behind_m = 0, behind_m
        self.standing_m = start_m
        self.demand: tuple[int, float, float, int] | None = None

    def advance_to(self, time_ns: int) -> None:
        assert time_ns >= self.now_ns
        self.now_ns = time_ns

    def command(
        self, time_ns: int, position_m: float, velocity_m_s: float, end_ns: int, enabled: bool
    ) -> None:
        assert time_ns == self.now_ns
        if not enabled:
            self.standing_m, self.demand = self.motor_position_m(), None
        else:
            self.demand = (time_ns, position_m, velocity_m_s, end_ns)

    def demand_position_m(self) -> float:
        return self.demand_at(self.now_ns)

    def demand_at(self, time_ns: int) -> float:
        if self.demand is None:
            return self.standing_m
        begin_ns, position_m, velocity_m_s, end_ns = self.demand
        return position_m + velocity_m_s * (min(time_ns, end_ns) - begin_ns) * 1e-9

    def motor_position_m(self) -> float:
        return self.motor_position_m_at(self.now_ns)

    def motor_velocity_m_s(self) -> float:
        return 0.0

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        pass

    def force_n(self) -> float | None:
        return None

    def second_encoder_m(self) -> float | None:
        return None

    def motor_position_m_at(self, time_ns: int) -> float:
        return self.demand_at(time_ns) - (0.0 if self.demand is None else self.behind_m)


class Signal:
    """A probe signal with known edges; one in the future is not there yet."""

    def __init__(self, axis: TrailingAxis, edges_ns: Sequence[int], start: bool) -> None:
        self._axis, self._start = axis, start
        self._edges = [(time_ns, start ^ (n % 2 == 0)) for n, time_ns in enumerate(edges_ns)]

    @property
    def edges(self) -> list[tuple[int, bool]]:
        return [edge for edge in self._edges if edge[0] <= self._axis.now_ns]

    @property
    def level(self) -> bool:
        edges = self.edges
        return edges[-1][1] if edges else self._start


@dataclass
class LinkBench:
    """One drive with its link; `cycle` is what a channel does with both in one period."""

    scheduler: Scheduler
    segment: Segment
    axis: TrailingAxis
    node: DriveNode
    network: SimNetwork
    remote: SimRemoteNode
    link: AxisLink
    heard: list[tuple[int, int, bytes]]
    lags_mm: list[tuple[float, float]] = field(default_factory=list)
    judged_lags_mm: list[float] = field(default_factory=list)

    def commission(self) -> None:
        """Start the drive; raises the alarm of a start-up that fails."""
        self.scheduler.run_until(2 * MS)
        ended = self.start_up()
        self.scheduler.run_while(lambda: not ended, None)
        if ended[0] is not None:
            raise ended[0]
        self.scheduler.run_until(self.next_period_ns + MS)  # what it tells at once has come

    def start_up(
        self,
        settings: StartUpSettings | None = None,
        telegrams: dict[str, Telegram] | None = None,
        bus: BusSettings | None = None,
        scaling: Scaling | None = None,
    ) -> list[Alarm | None]:
        """Begin the start-up; the list holds its result when it is over."""
        settings = settings or StartUpSettings()
        profile = self.node.profile
        scaling = scaling or Scaling(
            profile.encoder_increments, Fraction(profile.units_per_revolution)
        )
        steps = start_up_steps(
            settings,
            bus or BusSettings(),
            telegrams or self.link.telegrams,
            NODE,
            scaling,
            self.remote.object_dictionary,
        )
        sdo = SdoClient(
            self.network,
            self.scheduler,
            NODE,
            timeout_ns=settings.sdo_timeout_ns,
            attempts=settings.sdo_attempts,
        )
        ended: list[Alarm | None] = []
        drive = DriveAddress("Z", NODE)
        StartUp(drive, self.network, self.scheduler, sdo, steps, settings).begin(ended.append)
        return ended

    @property
    def next_period_ns(self) -> int:
        return -(-self.scheduler.now_ns // MS) * MS

    def cycle(self, set_mm: float = 0.0) -> None:
        """SYNC at the next whole ms; take, then send `set_mm`; run to the end of the period."""
        begin_ns = self.next_period_ns
        self.scheduler.run_until(begin_ns)
        self.link.begin_cycle()
        self.network.send_message(0x80, b"")
        self.scheduler.run_until(begin_ns + OFFSET_NS)
        self.link.take()
        self.judged_lags_mm.append(self.link.lag_mm)
        self.link.send(set_mm)
        # Both lags with the set value of this cycle counted (docs/architecture.md)
        self.lags_mm.append((self.link.lag_mm, self.drive_lag_mm))
        self.scheduler.run_until(begin_ns + MS)

    @property
    def drive_lag_mm(self) -> float:
        """60F4 as sampled at the last SYNC."""
        return self.node.image.following_error / INCREMENTS_PER_MM

    def enable(self) -> None:
        """Power on and hold: three steps of the state machine, one SYNC each, and some to see."""
        self.link.order(PowerOrder.SWITCH_ON)
        here_mm = self.axis.motor_position_m() * 1e3
        for _ in range(8):
            self.cycle(here_mm)
        assert self.link.state is State.OPERATION_ENABLED

    def frames(self, cob_id: int) -> list[bytes]:
        return [data for _, can_id, data in self.heard if can_id == cob_id]

    def read(self, index: int, sub: int) -> int:
        """An object of the drive as SDO gives it."""
        value: int = self.remote.sdo[index][sub].raw
        return value


@pytest.fixture
def link_bench() -> Iterator[Callable[..., LinkBench]]:
    """Make a bench; edges_ns: of the signal wired to the probe input in use."""
    scheduler = new_scheduler()
    with Segment("link bus", 1_000_000, scheduler) as segment:

        def make(
            *,
            start_mm: float = 0.0,
            behind_mm: float = 0.0,
            probe_input: int = 1,
            edge: str = "POS",
            lag_delay_cycles: int = 0,
            edges_ns: Sequence[int] = (),
            level: bool = False,
            silent: bool = False,
            counter: bool = False,
            profile: DriveProfile | None = None,
        ) -> LinkBench:
            axis = TrailingAxis(start_mm * 1e-3, behind_mm * 1e-3)
            profile = profile or DriveProfile(input_delay_ns=0)
            signal = Signal(axis, edges_ns, level)
            drive_network = SimNetwork(segment.port("drive")).connect()
            node = DriveNode(
                "Z",
                NODE + silent,  # another node answers nothing that is meant for this one
                drive_network,
                scheduler,
                axis,
                (signal, None) if probe_input == 1 else (None, signal),
                profile,
            )
            port = segment.port("cnc")
            network = SimNetwork(port).connect()
            heard: list[tuple[int, int, bytes]] = []
            segment.observe(
                lambda time_ns, _name, frame, _error: heard.append((time_ns, frame[0], frame[1]))
            )
            remote = SimRemoteNode(NODE, object_dictionary(NODE, profile))
            network.add_node(remote)
            settings = LinkSettings(
                "Z",
                INCREMENTS_PER_MM,
                probe_input,
                edge,
                lag_delay_cycles,
                node_id=NODE,
                has_counter=counter,
            )
            link = AxisLink(settings, network)
            return LinkBench(scheduler, segment, axis, node, network, remote, link, heard)

        yield make
