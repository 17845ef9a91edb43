"""A rig brought to life: scheduler, segments, drive nodes, plants, and the channel that runs it.

`Machine` is built from checked settings and runs one program once. Everything a run leaves behind
(messages, alarms, records, trace, frame hash) is read from it afterwards.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path

from bench.bus.arithmetic import CycleArithmetic
from bench.bus.canopen_sim import SimNetwork
from bench.bus.record import BlfLog, FrameHash
from bench.bus.segment import Segment
from bench.drive.node import DriveNode
from bench.rig.check import check_rig, segment_schedules
from bench.rig.injection import inject
from bench.rig.master import build_link, build_monitor, build_start_up
from bench.rig.plants import build_plant, check_plants, start_plant
from bench.rig.recorder import Recorder
from bench.rig.settings import Settings
from kernel.channel import AxisSettings, Channel, CycleTiming
from kernel.clock import MS, US, TimeNs
from kernel.cosim.scheduler import Scheduler
from kernel.nc.canon import Message
from kernel.nc.interpreter import Interpreter
from kernel.nc.syntax import Program

SIMULATED_LIMIT_NS = 600_000 * MS
DRIVE_SEED_STRIDE = 1_000_003


class SimulatedTimeoutError(Exception):
    """A program did not end within the simulated time that a run may take."""


class Machine:
    """One rig with one program, ready to run.

    settings: checked rig with the assignments of this run. program: parsed NC program.
    bus_log: BLF file to write, or None. put_out: takes each `#MSG` text when it is due.
    seed: of everything random in the run. limit_ns: simulated time that it may take.
    Raises UserError when the rig does not fit together.
    """

    def __init__(
        self,
        settings: Settings,
        program: Program,
        *,
        bus_log: Path | None = None,
        put_out: Callable[[str], None] | None = None,
        seed: int = 0,
        limit_ns: TimeNs = SIMULATED_LIMIT_NS,
    ) -> None:
        check_rig(settings)
        self.settings = settings
        self.messages: list[Message] = []
        self._put_out = put_out
        self._limit_ns = limit_ns
        self.timing = CycleTiming(
            period_ns=settings.rig.cycle.period_us * US,
            offset_ns=settings.rig.cycle.cycle_offset_us * US,
            buffer_cycles=settings.rig.cycle.buffer_cycles,
        )
        self._open = ExitStack()
        with ExitStack() as guard:  # frees what was opened when building fails half way
            guard.callback(self._open.close)
            self.scheduler = Scheduler()
            self.frame_hash = FrameHash()
            self.plant = build_plant(settings)
            self._open.callback(self.plant.close)
            check_plants(settings, self.plant)
            start_plant(settings, self.plant)
            self.segments = self._build_segments(bus_log)
            self.nodes = self._build_nodes(seed)
            self.networks = {
                name: SimNetwork(segment.port("cnc", settings.segment[name].queue))
                for name, segment in self.segments.items()
            }
            for network in self.networks.values():
                network.connect()
            self.links = {
                name: build_link(settings, name, self.networks[axis.segment])
                for name, axis in settings.rig.axis.items()
            }
            self.channel = self._build_channel()
            inject(self, seed)
            axes = [(name, self.plant.axes[a.plant]) for name, a in settings.rig.axis.items()]
            self.recorder = Recorder(self.plant, axes, self.plant.probes)
            self.channel.observers.append(self.recorder)
            interpreter = Interpreter(
                program,
                tuple(settings.rig.axis),
                self.channel,
                external=settings.external,
                default_measuring_type=settings.channel.integer("messtyp"),
            )
            self.channel.load(interpreter.commands())
            guard.pop_all()

    def _build_segments(self, bus_log: Path | None) -> dict[str, Segment]:
        segments = {}
        log = None if bus_log is None else BlfLog(bus_log, list(self.settings.segment))
        if log is not None:
            self._open.callback(log.stop)
        for name, table in self.settings.segment.items():
            segment = self._open.enter_context(
                Segment(
                    name,
                    table.bitrate,
                    self.scheduler,
                    automatic_recovery=table.bus_off == "recover",
                )
            )
            segment.observe(self.frame_hash)
            if log is not None:
                segment.observe(log)
            segments[name] = segment
        return segments

    def _build_nodes(self, seed: int) -> dict[str, DriveNode]:
        nodes: dict[str, DriveNode] = {}
        signals = {name: probe.signal for name, probe in self.plant.probes.items()}
        for name, axis in self.settings.rig.axis.items():
            queue = self.settings.segment[axis.segment].drive_queue
            network = SimNetwork(self.segments[axis.segment].port(name, queue))
            network.connect()
            nodes[name] = DriveNode(
                name,
                axis.node,
                network,
                self.scheduler,
                self.plant.axes[axis.plant],
                (
                    signals[axis.probe_1] if axis.probe_1 else None,
                    signals[axis.probe_2] if axis.probe_2 else None,
                ),
                self.settings.rig.drive[axis.drive].make(),
                seed + DRIVE_SEED_STRIDE * len(nodes),
            )
        return nodes

    def _build_channel(self) -> Channel:
        return Channel(
            self.scheduler,
            self.timing,
            [
                AxisSettings.read(name, self.settings.axis[name], self.settings.channel)
                for name in self.settings.rig.axis
            ],
            list(self.links.values()),
            list(self.networks.values()),
            error_no_signal=self.settings.channel.flag("meas_error_no_signal"),
            put_out=self._message,
            monitor=build_monitor(self.settings, self.links, self.networks, self.scheduler),
        )

    def _message(self, message: Message) -> None:
        self.messages.append(message)
        if self._put_out is not None:
            self._put_out(message.text)

    @property
    def schedules(self) -> Mapping[str, CycleArithmetic]:
        """The worst-case cyclic schedule of every segment."""
        return segment_schedules(self.settings)

    def run(self) -> TimeNs:
        """Start the drives, run the program to its end, return the simulated time.

        Alarms are found in `channel.alarms`. Raises PlantError when a plant fails,
        SimulatedTimeoutError when the program does not end, UserError for what only running shows.
        """
        self.channel.start_up(
            [
                build_start_up(self.settings, name, self.networks[axis.segment], self.scheduler)
                for name, axis in self.settings.rig.axis.items()
            ]
        )
        scheduler, channel, period_ns = self.scheduler, self.channel, self.timing.period_ns
        limit_ns = scheduler.now_ns + self._limit_ns
        while not channel.has_ended:
            if scheduler.now_ns >= limit_ns:
                places = ", ".join(f"{link.name} {link.actual_mm:.3f}" for link in channel.links)
                raise SimulatedTimeoutError(
                    f"the program did not end within {self._limit_ns // 1_000_000_000} s of"
                    f" simulated time; the axes stand at {places} mm; feed too small or path too"
                    " long?"
                )
            scheduler.run_until(scheduler.now_ns + period_ns)
        return scheduler.now_ns

    def close(self) -> None:
        """Free plants, segments and the bus log."""
        self._open.close()
