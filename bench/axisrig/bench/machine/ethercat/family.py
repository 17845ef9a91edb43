"""Drives on EtherCAT in a machine: CiA 402 and SERCOS."""

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow as pa

from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.bus.ethercat.frame_hash import FrameHash
from axisrig.bench.bus.ethercat.pcapng import SUFFIX, PcapngFile
from axisrig.bench.bus.journal import Journal
from axisrig.bench.machine.cia402 import LOAD_SPAN_NS, Cia402Segments
from axisrig.bench.machine.ethercat.line import Line, driven
from axisrig.bench.machine.ethercat.line_meter import LineMeters, al_words
from axisrig.bench.machine.ethercat.line_terminal import LineTerminal
from axisrig.bench.machine.ethercat.value_log import ValueLog
from axisrig.bench.machine.families import Bench
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.injection import ON_LINES
from axisrig.bench.machine.faults.lines import OnLine
from axisrig.bench.record.axes import Telegram
from axisrig.bench.record.bus import BusFigures, LineFigures
from axisrig.bench.record.series import Times
from axisrig.bench.rig.ethercat.members import ec_segments
from axisrig.bench.rig.ethercat.schedule import overloads, schedule_of
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.drives.accesses import AccessesByAxis
from axisrig.kernel.drives.ethercat.image import objects_of
from axisrig.kernel.drives.ethercat.line_start import SlaveStart
from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.drives.interface import DriveAccesses, DriveWatch
from axisrig.kernel.drives.sercos.accesses import SercosAccesses
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.time.clock import MS, US, TimeNs

BIT_RATE = 100_000_000


class EthercatLines(Cia402Segments):
    """The EtherCAT lines of a machine with all that is on them; lines: by name."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        settings = bench.settings
        journal = Journal()
        self._hash = FrameHash(journal)
        for name, path in _files(bench.bus_logs, ec_segments(settings)):
            log = PcapngFile(path, [name])
            bench.opened.callback(log.stop)
            journal.add(log.take)
        bench.opened.callback(journal.drain)
        # A slave may take a state while it is built
        self.states = {axis: [] for axis in settings.rig.axis}
        self.lines = {
            name: Line(
                settings,
                name,
                bench.scheduler,
                journal,
                bench.beside,
                bench.plant.advance_to,
                bench.seed,
                self._note_state,
            )
            for name in ec_segments(settings)
        }
        self._meters = LineMeters(self.lines.values(), bench.scheduler, journal)
        self.links = driven(self.lines)
        self.states = {axis: self.states[axis] for axis in self.links}
        self.nodes = {a: node for line in self.lines.values() for a, node in line.nodes.items()}
        self.drives = {axis: node.servo for axis, node in self.nodes.items()}
        self.carriers = {name: line.carrier for name, line in self.lines.items()}
        controlled = {
            axis for axis in self.links if settings.axis[axis].flag("lr_param.distance_control_on")
        }
        self._values = ValueLog(self.lines, controlled, journal)
        self._open_ways()

    def _line_of(self, axis: str) -> Line:
        return self.lines[self._bench.settings.rig.axis[axis].segment]

    # The control's side

    def watch(self, axis: str) -> DriveWatch:
        """Make the watch over one drive."""
        line = self._line_of(axis)
        return line.watches[axis](line.carrier)

    def start_up(self, axis: str) -> SlaveStart:
        """Make the start-up of one drive, which is a part of that of its line."""
        line = self._line_of(axis)
        return SlaveStart(line.start, line.axes.index(axis))

    def functions(self) -> DriveAccesses | None:
        """Return what #DRIVE and #IDENT act on."""
        of_objects = super().functions()
        drives = {a: link for a, link in self.links.items() if isinstance(link, SercosDrive)}
        if not drives:
            return of_objects
        by_axis: dict[str, DriveAccesses] = dict.fromkeys(drives, SercosAccesses(drives))
        if of_objects is not None:
            by_axis |= dict.fromkeys(self.accesses, of_objects)
        return AccessesByAxis(by_axis)

    # The machine's side

    def terminal(self, advance: Callable[[TimeNs], None]) -> LineTerminal | None:
        """Return the terminal of the PLC, where it is the last slave of a line."""
        found = (line.terminal for line in self.lines.values() if line.terminal is not None)
        return next(found, None)

    def sampled_ns(self, axis: str, sync_ns: TimeNs) -> TimeNs:
        """Return when the control assumes that the position of this cycle is sampled."""
        return self._line_of(axis).carrier.sampled_ns(axis)

    def clock_limit_ns(self, axis: str) -> TimeNs | None:
        """Return `clock_limit_us` of a line whose master watches the clocks."""
        line = self._line_of(axis).master.line
        return line.clock_limit_ns if line.reads_differences else None

    def clocks_off_ns(self, axis: str) -> TimeNs:
        """Return how far the clocks of its line were apart at most, as the master knows it."""
        return self._line_of(axis).master.clocks_off_ns

    def build_fault(self, fault: Fault, numbers: random.Random, record: Injected) -> Act | None:
        """Build in a fault of frames on a line, or of a slave there; None for others."""
        on = fault.segment or self._bench.settings.rig.axis[fault.axis].segment
        if on not in self.lines:
            return None
        line = OnLine(self._bench.scheduler, self.lines[on].faults, self.nodes)
        return ON_LINES[fault.kind](line, fault, numbers, record)

    # What a run leaves

    def hexdigest(self) -> str:
        """Return the hash over every frame."""
        return self._hash.hexdigest()

    def take_columns(self, times_ns: Times, *, is_last: bool) -> Mapping[str, pa.Array]:
        """Return columns of cyclic values up to each instant."""
        return self._values.take_columns(times_ns, is_last=is_last)

    def figures(self) -> list[BusFigures]:
        """Return what each line has carried."""
        over = overloads(self._bench.settings)
        return [self._figures(name, over.get(name, "")) for name in self.lines]

    def _figures(self, name: str, overload: str) -> BusFigures:
        meter, now_ns = self._meters[name], self._bench.scheduler.now_ns
        segment = self.lines[name].segment
        return BusFigures(
            segment=name,
            bitrate=BIT_RATE,
            load_pct=meter.load_pct(now_ns),
            load_100ms_pct=meter.worst_pct(100 * MS, now_ns),
            load_1ms_pct=meter.worst_pct(MS, now_ns),
            frames=segment.frames,
            error_frames=segment.lost,
            overload=overload,
            counters=(),
            waiting=(),
            changes=tuple(meter.changes),
            line=self._line_figures(name),
        )

    def _line_figures(self, name: str) -> LineFigures:
        line, meter = self.lines[name], self._meters[name]
        schedule = schedule_of(self._bench.settings, name)
        return LineFigures(
            period_us=schedule.period_ns / US,
            wire_us=schedule.wire_ns / US,
            sent=line.master.frames,
            back=meter.back,
            counter=line.master.image.counter,
            wrong=meter.wrong,
            wrong_in_a_row=meter.wrong_in_a_row,
            slaves=tuple(
                (name, al_words(slave.states.state, slave.states.code))
                for name, slave in line.slaves.items()
            ),
        )

    def telegrams(self, axis: str) -> list[Telegram]:
        """Return what the process image of an axis carries."""
        settings = self.links[axis].settings
        slave = next(s for s in self._line_of(axis).master.slaves if s.axis == settings.axis)
        return [_telegram("RxPDO1", slave.outputs), _telegram("TxPDO1", slave.inputs)]

    def shown(self) -> list[dict[str, Any]]:
        """Return load, working counters and states of each line."""
        return [self._shown(name, line) for name, line in self.lines.items()]

    def _shown(self, name: str, line: Line) -> dict[str, Any]:
        meter, now_ns = self._meters[name], self._bench.scheduler.now_ns
        return {
            "segment": name,
            "bitrate": BIT_RATE,
            "is_outside": False,
            "lost": None,
            "frames": line.segment.frames,
            "error_frames": line.segment.lost,
            "load_pct": meter.recent_pct(now_ns, LOAD_SPAN_NS),
            "counters": [],
            "line": asdict(self._line_figures(name)),
        }


def _files(bus_logs: Sequence[Path], segments: Sequence[str]) -> list[tuple[str, Path]]:
    """Return the file of each line, whatever kinds of logs are asked for: `<run>@<segment>.pcapng`.

    The other kinds hold frames of CAN.
    """
    if not bus_logs:
        return []
    stem, folder = bus_logs[0].stem, bus_logs[0].parent
    return [(name, folder / f"{stem}{SEGMENT_MARK}{name}{SUFFIX}") for name in segments]


def _telegram(name: str, pdos: Iterable[Pdo]) -> Telegram:
    return Telegram(name, 1, tuple(mapped.field for mapped in objects_of(list(pdos))))


def install(bench: Bench) -> EthercatLines:
    """Install the EtherCAT lines of a rig."""
    return EthercatLines(bench)
