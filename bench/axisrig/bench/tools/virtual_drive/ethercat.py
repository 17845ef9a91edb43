"""The drives of a rig for somebody else's EtherCAT master: `axisrig drive RIG --interface ecat`.

They are one line on a raw socket, in the order of the rig, whatever carries them there; a stamping
terminal that the rig has on a line is the last slave. Plants and
faults of nature are those of every run, the clock is real time. A frame is an event at the instant
at which it was seen; it is answered before anything later happens.
"""

import gc
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from axisrig.bench.bus.deadlines import Deadlines, spread
from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.bus.ethercat.raw import RawPort
from axisrig.bench.bus.ethercat.segment import LOCAL_BIT, SOURCE, Passage
from axisrig.bench.bus.paced import PacedScheduler, Pacing
from axisrig.bench.drive.ethercat.description import MAILBOX_BYTES, Description, describe
from axisrig.bench.drive.ethercat.esi import esi_text
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.drive.sercos.description import describe as describe_sercos
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.machine.ethercat.slaves import ON_LINES, drive_slave, terminal_slave
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.kept_fmus import close_plant
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.machine.plants import build_plant, check_plants, start_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.canopen.keys import DriveTable as CanopenTable
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.ethercat.members import TERMINAL, ec_segments, terminal_on
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.sercos.keys import DriveTable as SercosTable
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.bench.tools.virtual_drive.parameters import ParameterFile
from axisrig.bench.tools.virtual_drive.serve import BEHIND_NS, SLICE_NS, only_axes
from axisrig.bench.tools.virtual_drive.terminal_watch import TerminalWatcher
from axisrig.bench.tools.virtual_drive.watch import EthercatWatcher
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, S, TimeNs

INTERFACE: Final = "ecat"
"""What --interface says for it."""
KEEP_UP_NS: Final[TimeNs] = 20 * MS


@dataclass(frozen=True)
class Wanted:
    """What the command line says. is_real: the interface may be any; for_s: None = until Ctrl-C.

    folder: gets frames, events and latches; store: file that keeps what 1010 stores.
    """

    channel: str | None
    is_real: bool = False
    folder: Path | None = None
    store: Path | None = None
    for_s: float | None = None


def line_settings(rig: Path, axes: Sequence[str], assignments: Sequence[str]) -> Settings:
    """Read a rig for its drives alone, whatever carries them. Raises UserError."""
    table, files = read_rig(rig)
    changes = [(parse_assignment(text), as_written) for text in assignments]
    settings = read_settings(table, files, changes)
    settings.has_kernel = False
    found = only_axes(settings, axes)
    for name in found.rig.axis:
        family = found.rig.drive[found.rig.axis[name].drive].family_name
        if family not in ON_LINES:
            raise UserError(
                f"the drive of axis {name} is of a family that is not on EtherCAT",
                file=rig, value=family, allowed=ON_LINES, hint="--axis NAME of another one",
            )  # fmt: skip
    return found


def _describe(settings: Settings, name: str) -> Description:
    """Describe the drive of an axis."""
    table = settings.rig.drive[settings.rig.axis[name].drive]
    if isinstance(table, SercosTable):
        return describe_sercos(table.make(), 0, MAILBOX_BYTES)
    assert isinstance(table, CanopenTable), name
    return describe(table.make())


def write_esi(settings: Settings, path: Path) -> Path:
    """Write the ESI file of the drives of a rig and return its path.

    Raises UserError when its axes have different drives.
    """
    found = {_describe(settings, name) for name in settings.rig.axis}
    if len(found) != 1:
        raise UserError(
            "the rig has different drives: say of which one the ESI file is to be",
            allowed=settings.rig.axis,
            hint="--axis NAME",
        )
    path.write_text(esi_text(found.pop()), encoding="utf-8", newline="\n")
    return path


def whose_esi(settings: Settings) -> str:
    """Name the axes that the written ESI file fits, and their drives."""
    rig = settings.rig
    return ", ".join(
        f"axis {name} ({axis.drive}, {rig.drive[axis.drive].in_words})"
        for name, axis in rig.axis.items()
    )


def serve_line(
    settings: Settings, wanted: Wanted, hardware: Hardware, put_out: Callable[[str], None]
) -> None:
    """Run the drives until Ctrl-C, or for so many seconds; arguments as `LineServer`."""
    with LineServer(settings, wanted, hardware, put_out) as server:
        server.run()


class LineServer:
    """The virtual drives of a rig as one line on an interface; a context manager that closes it.

    Raises UserError when the rig does not fit, or the interface cannot be used.
    """

    def __init__(
        self, settings: Settings, wanted: Wanted, hardware: Hardware, put_out: Callable[[str], None]
    ) -> None:
        self._hardware, self._put_out, self._wanted = hardware, put_out, wanted
        if wanted.channel is None:
            raise UserError(
                "EtherCAT needs an Ethernet interface", value=INTERFACE, hint="--channel IF"
            )
        tables = [settings.rig.drive[axis.drive] for axis in settings.rig.axis.values()]
        if wanted.store is not None and not any(isinstance(t, CanopenTable) for t in tables):
            raise UserError(
                "no drive of the rig stores its parameters (1010)",
                value=str(wanted.store),
                hint="leave --store out",
            )
        self._open = ExitStack()
        self._kept_ns: TimeNs = 0
        monotonic_ns = hardware.real_time.monotonic_ns
        with ExitStack() as guard:
            guard.callback(self._open.close)
            # Before the plants, which take a while
            self.port = RawPort(wanted.channel, self._answer, monotonic_ns, is_real=wanted.is_real)
            self._open.callback(self.port.close)
            check_rig(settings)
            pacing = Pacing(slip_ns=BEHIND_NS)
            self.scheduler = PacedScheduler(hardware.real_time, pacing, Deadlines(BEHIND_NS))
            self.scheduler.listen(self.port)
            self.plant = build_plant(settings)
            self._open.callback(close_plant, self.plant)
            check_plants(settings, self.plant)
            start_plant(settings, self.plant)
            beside = Beside(settings, self.plant, self.scheduler)
            self.drives = self._build(settings, beside)
            self._line: list[EthercatDrive | StampingTerminal] = list(self.drives.values())
            self.terminal = self._build_terminal(settings, beside)
            memories = {
                name: drive.storage
                for name, drive in self.drives.items()
                if not isinstance(drive, SercosDrive)  # they have no 1010
            }
            store, folder = wanted.store, wanted.folder
            self._parameters = ParameterFile(store, memories) if store is not None else None
            self._frames = None
            if folder is not None:
                folder.mkdir(parents=True, exist_ok=True)
                self._frames = self._open.enter_context(
                    PcapngFile(folder / "bus.pcapng", [wanted.channel])
                )
            self._watcher = EthercatWatcher(
                settings, self.drives, self.plant, put_out, folder, self._open
            )
            self._looks = [self._watcher.look]
            self._watch_terminal(settings)
            guard.pop_all()

    def _build(self, settings: Settings, beside: Beside) -> dict[str, EthercatDrive]:
        return {
            name: drive_slave(settings, name, self.scheduler, beside, place + 1, place)
            for place, name in enumerate(settings.rig.axis)
        }

    def _build_terminal(self, settings: Settings, beside: Beside) -> StampingTerminal | None:
        """Make the stamping terminal that the rig has on a line, behind all drives."""
        advance, serial = self.plant.advance_to, len(self._line) + 1
        for name in ec_segments(settings):
            found = terminal_slave(settings, name, self.scheduler, beside, advance, serial)
            if found is not None:
                self._line.append(found)
                return found
        return None

    def _watch_terminal(self, settings: Settings) -> None:
        tables = [terminal_on(settings, name) for name in ec_segments(settings)]
        table = next((table for table in tables if table is not None), None)
        if self.terminal is not None and table is not None:
            report = self._watcher.report
            watcher = TerminalWatcher(self.terminal, table.inputs, self.plant, report)
            self._looks.append(watcher.look)

    def __enter__(self) -> "LineServer":
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def run(self) -> None:
        """Run until the operator stops, or for so much real time."""
        wanted, clock = self._wanted, self._hardware.real_time.monotonic_ns
        for place, name in enumerate(self.drives):
            self._put_out(f"axis {name}: slave {place} on {wanted.channel}")
        if self.terminal is not None:
            self._put_out(f"{TERMINAL}: slave {len(self.drives)} on {wanted.channel}")
        self._put_out(
            "these slaves are the last ones of the line: nothing may be connected behind them"
        )
        end_ns = None if wanted.for_s is None else clock() + round(wanted.for_s * S)
        gc.collect()
        gc.freeze()
        gc.disable()  # a frame may not wait for it; nothing here makes circles
        try:
            while not self._hardware.stop() and (end_ns is None or clock() < end_ns):
                self.scheduler.run_until(self.scheduler.now_ns + SLICE_NS)
                self._keep_up(self.scheduler.now_ns)
                for look in self._looks:
                    look(self.scheduler.now_ns)
                if self._parameters is not None and self._parameters.look():
                    self._watcher.report(self.scheduler.now_ns, "", "store", "parameters written")
        finally:
            gc.enable()
            gc.unfreeze()
            for line in self._summary():
                self._put_out(line)

    def _keep_up(self, now_ns: TimeNs) -> None:
        """Step plants that no cycle steps, or the first access would wait for all that time."""
        if now_ns - self._kept_ns >= KEEP_UP_NS:
            self._kept_ns = now_ns
            for drive in self.drives.values():
                drive.servo.begin(now_ns)
            if self.terminal is not None:
                self.terminal.before_latches()

    def _answer(self, frame: bytearray) -> None:
        """Let the frame pass the line; all of it at one instant."""
        now_ns: TimeNs = self.scheduler.now_ns
        last = len(self._line) - 1
        for number, slave in enumerate(self._line):
            slave.process(frame, Passage(now_ns, None if number == last else now_ns))
        frame[SOURCE] |= LOCAL_BIT
        if self._frames is not None:
            self._frames.add(now_ns, 0, bytes(frame))

    def _summary(self) -> list[str]:
        lines = []
        times = spread(list(self.port.latencies_ns))
        if times is not None:
            lines.append(
                f"{self.port.frames} frames answered; from reception to answer"
                f" median {times.median_us:.0f} us, p99 {times.p99_us:.0f} us,"
                f" max {self.port.latest_ns / US:.0f} us"
            )
        behind = self.scheduler.deadlines
        if behind.slips:
            lines.append(
                f"this computer was more than {BEHIND_NS // MS} ms late {behind.slips} times,"
                f" {behind.slipped_ns / MS:.0f} ms in all; the drives ran slower by that"
            )
        return lines
