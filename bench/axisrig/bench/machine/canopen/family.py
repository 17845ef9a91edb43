"""CANopen drives on CAN in a machine."""

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import pyarrow as pa

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.journal import BLOCK_FRAMES, Journal
from axisrig.bench.machine.canopen.bus_figures import bus_figures
from axisrig.bench.machine.canopen.io_terminal import IoTerminal
from axisrig.bench.machine.canopen.links import (
    build_carriers,
    build_links,
    build_start_up,
)
from axisrig.bench.machine.canopen.nodes import build_nodes, build_segments
from axisrig.bench.machine.canopen.telegram_log import TelegramLog
from axisrig.bench.machine.cia402 import LOAD_SPAN_NS, Cia402Segments
from axisrig.bench.machine.families import Bench
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.frames import OnCan
from axisrig.bench.machine.faults.injection import ON_CAN
from axisrig.bench.machine.recording.received import Received, noted
from axisrig.bench.record.axes import Telegram
from axisrig.bench.record.bus import BusFigures
from axisrig.bench.record.series import ACTUAL, Times
from axisrig.bench.rig.canopen.answers import first_answer_ns
from axisrig.bench.rig.canopen.io_node import synced_segments, terminal_telegrams
from axisrig.bench.rig.canopen.members import drive_of, segment_of
from axisrig.bench.rig.canopen.startup import watch_settings
from axisrig.bench.rig.reading.faults import Fault
from axisrig.bench.rig.real_axes import outside_axes
from axisrig.kernel.drives.canopen.carrier import HeartbeatProducer
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.startup import StartUp
from axisrig.kernel.drives.canopen.watch import LinkWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import NMT_ID
from axisrig.kernel.profiles.canopen.nmt import ENTER_PRE_OPERATIONAL
from axisrig.kernel.time.clock import TimeNs


class CanBuses(Cia402Segments):
    """The CAN buses of a machine with all that is on them.

    segments: by name. nodes: of virtual drives, by axis.
    """

    links: Mapping[str, AxisLink]

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        settings, clock = bench.settings, bench.scheduler
        self._lost = set[str]()
        # In real time no block may hold a cycle up
        journal = Journal(1 if bench.hardware else BLOCK_FRAMES)
        self._hash = FrameHash(journal)
        self.segments: dict[str, Segment] = build_segments(
            settings, clock, journal, bench.bus_logs, bench.opened
        )
        self.nodes = build_nodes(
            settings, clock, self.segments, bench.beside, bench.seed, self._note_state
        )
        self.states = {name: [] for name in self.nodes}
        self._networks = {
            name: SimNetwork(segment.port("cnc", segment_of(settings, name).queue))
            for name, segment in self.segments.items()
        }
        for network in self._networks.values():
            network.connect()
        self.links = build_links(settings, self._networks, clock)
        self.drives = {name: node.servo for name, node in self.nodes.items()}
        self._expect_answers()
        self._telegrams = TelegramLog(
            (
                (settings.rig.axis[name].segment, link)
                for name, link in self.links.items()
                if settings.axis[name].flag("lr_param.distance_control_on")
            ),
            journal,
            terminal_telegrams(settings),
        )
        # On a segment without a drive nobody would acknowledge a SYNC
        used = synced_segments(settings)
        self._synced = {name: n for name, n in self._networks.items() if name in used}
        self.carriers = build_carriers(settings, self._synced)
        self._open_ways()

    def _expect_answers(self) -> None:
        """Give real segments the telegrams their drives answer a SYNC with."""
        settings, outside = self._bench.settings, outside_axes(self._bench.settings)
        for name, segment in self.segments.items():
            if isinstance(segment, OutsideSegment):
                segment.expect(
                    telegram.cob_id(link.node_id)
                    for axis, link in self.links.items()
                    if axis in outside and settings.rig.axis[axis].segment == name
                    for telegram in link.telegrams.values()
                    if telegram.transmission == 1 and telegram.name.startswith("TPDO")
                )

    # The control's side

    def watch(self, axis: str) -> LinkWatch:
        """Make the watch over one drive."""
        settings = watch_settings(drive_of(self._bench.settings, axis))
        return LinkWatch(self.links[axis], self._bench.scheduler, settings)

    def start_up(self, axis: str) -> StartUp:
        """Make the start-up of one drive."""
        return build_start_up(self._bench.settings, axis, self.links[axis], self._bench.scheduler)

    def presence(self) -> HeartbeatProducer:
        """Make the heartbeat of the kernel."""
        cycle = self._bench.settings.rig.cycle
        networks = list(self._synced.values())
        return HeartbeatProducer(
            networks, self._bench.scheduler, cycle.master_node, cycle.heartbeat_ms
        )

    # The machine's side

    def terminal(self, advance: Callable[[TimeNs], None]) -> IoTerminal | None:
        """Make the node with digital inputs that is the terminal of the PLC."""
        settings, clock = self._bench.settings, self._bench.scheduler
        task = settings.rig.plc_task
        table = None if task is None else task.terminal
        telegrams = terminal_telegrams(settings)
        if table is None or telegrams is None or table.segment not in self.segments:
            return None
        queue = segment_of(settings, table.segment).drive_queue
        return IoTerminal(
            table,
            self._bench.beside.signals,
            clock,
            node_port=SimNetwork(self.segments[table.segment].port("terminal", queue)).connect(),
            master=self._networks[table.segment],
            advance=advance,
            telegrams=telegrams,
        )

    def listen(self, into: Received) -> None:
        """Note the telegrams with actual positions, and those of the node of the PLC."""
        settings, clock = self._bench.settings, self._bench.scheduler
        for axis, link in self.links.items():
            for telegram in link.telegrams.values():
                fields = [mapped.field for mapped in telegram.objects]
                if ACTUAL not in fields or telegram.is_received:
                    continue
                into.increments[axis] = partial(_value, telegram.codec, fields.index(ACTUAL))
                segment = settings.rig.axis[axis].segment
                into.first_ns[axis] = first_answer_ns(settings, segment, telegram.codec.size)
                note = noted(into.positions.setdefault(axis, []), clock)
                link.network.subscribe(telegram.cob_id(link.node_id), note)
        node = terminal_telegrams(settings)
        if node is not None:
            into.inputs_first_ns = node.first_ns
            self._networks[node.segment].subscribe(node.cob_id, noted(into.inputs, clock))

    def build_fault(self, fault: Fault, numbers: random.Random, record: Injected) -> Act | None:
        """Build in a fault of frames on CAN, or of a drive there; None for others."""
        bench = self._bench
        on = fault.segment or bench.settings.rig.axis[fault.axis].segment
        if on not in self.segments:
            return None
        buses = OnCan(bench.settings, bench.scheduler, self.segments, self.nodes)
        return ON_CAN[fault.kind](buses, fault, numbers, record)

    def look(self) -> Iterator[Alarm]:
        """Yield an alarm for each interface that was lost since the last look."""
        for name, segment in self.segments.items():
            if isinstance(segment, OutsideSegment) and segment.lost and name not in self._lost:
                self._lost.add(name)
                yield Alarm(900071, segment=name, reason=segment.lost)

    def let_go(self, axes: Sequence[str]) -> None:
        """Lead real drives to NMT pre-operational."""
        for link in (self.links[axis] for axis in axes):
            link.network.send_message(NMT_ID, bytes([ENTER_PRE_OPERATIONAL, link.node_id]))

    # What a run leaves

    def hexdigest(self) -> str:
        """Return the hash over every frame."""
        return self._hash.hexdigest()

    def take_columns(self, times_ns: Times, *, is_last: bool) -> Mapping[str, pa.Array]:
        """Return columns of cyclic values up to each instant."""
        return self._telegrams.take_columns(times_ns, is_last=is_last)

    def figures(self) -> list[BusFigures]:
        """Return what each bus has carried."""
        return bus_figures(self._bench.settings, self.links, self.segments)

    def telegrams(self, axis: str) -> list[Telegram]:
        """Return the PDOs of an axis."""
        return [
            Telegram(t.name, t.transmission, tuple(mapped.field for mapped in t.objects))
            for t in self.links[axis].telegrams.values()
        ]

    def shown(self) -> list[dict[str, Any]]:
        """Return load and error counters of each bus."""
        return [self._shown(name, segment) for name, segment in self.segments.items()]

    def _shown(self, name: str, segment: Segment) -> dict[str, Any]:
        load = segment.load_now(self._bench.scheduler.now_ns, LOAD_SPAN_NS)
        is_outside = isinstance(segment, OutsideSegment)
        return {
            "segment": name,
            "bitrate": segment.bitrate,
            "is_outside": is_outside,
            "lost": segment.lost if isinstance(segment, OutsideSegment) else None,
            "frames": load.frames,
            "error_frames": load.error_frames,
            "load_pct": 100.0 * load.busy_share,
            "counters": [
                {
                    "node": port.port_name,
                    "tec": port.tec,
                    "rec": port.rec,
                    "state": str(port.error_state),
                }
                for port in segment.ports
                if port.tec or port.rec
            ],
        }


def _value(codec: Any, place: int, data: bytes) -> int:
    """Return one value of a telegram."""
    found: int = codec.unpack(data)[place]
    return found


def install(bench: Bench) -> CanBuses:
    """Install the CAN buses of a rig. Raises UserError when an interface cannot be opened."""
    return CanBuses(bench)
