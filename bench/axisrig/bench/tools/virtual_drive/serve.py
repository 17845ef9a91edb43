"""The drives of a rig for the master of somebody else: what `axisrig drive` does.

Nodes, plants and faults of nature are those of every run; the clock is real time, or, by choice,
the master's SYNC. The drives run until they are stopped, whatever happens to the bus.
"""

import gc
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.journal import Journal
from axisrig.bench.bus.paced import PacedScheduler, Pacing
from axisrig.bench.campaign.hardware_runs import Outside
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.machine.canopen.nodes import build_nodes, build_segments
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.kept_fmus import close_plant
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.machine.plants import build_plant, check_plants, start_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.record.series import SeriesWriter, column_of
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.carriers import refusal
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.real_axes import is_real
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.bench.tools.virtual_drive.parameters import ParameterFile
from axisrig.bench.tools.virtual_drive.watch import Watcher
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import DEMAND_POSITION, MOTOR_POSITION, POSITION, VELOCITY
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.canopen.identifiers import SYNC_ID
from axisrig.kernel.time.clock import MS, US, Phase, S, TimeNs

SLICE_NS = 2 * MS
BEHIND_NS = 100 * MS
"""So far may the drives lag real time; then what is missing is given up."""
REOPEN_NS = S


def only_axes(settings: Settings, names: Sequence[str]) -> Settings:
    """Leave only these axes in a rig, all when none is named; plants stay for who reads them.

    Raises UserError for an axis that the rig does not have.
    """
    for name in names:
        if name not in settings.rig.axis:
            raise UserError("the rig has no such axis", value=name, allowed=settings.rig.axis)
    if not names:
        return settings
    axes = {name: table for name, table in settings.rig.axis.items() if name in names}
    segments = {axis.segment for axis in axes.values()}
    return replace(
        settings,
        rig=settings.rig.model_copy(update={"axis": axes}),
        segment={name: table for name, table in settings.segment.items() if name in segments},
    )


def drive_settings(
    rig: Path, outside: Outside, axes: Sequence[str], assignments: Sequence[str]
) -> Settings:
    """Read a rig for its drives alone, with the interface and changes of the command line."""
    table, files = read_rig(rig)
    changes = [parse_assignment(text) for text in assignments]
    changes += outside.changes(table.segment, rig)
    settings = read_settings(table, files, [(item, as_written) for item in changes])
    settings.has_kernel = False
    return only_axes(settings, axes)


def write_eds(settings: Settings, path: Path) -> Path:
    """Write the EDS of the drives of a rig and return its path.

    Raises UserError when its axes have different drives.
    """
    for axis in settings.rig.axis.values():
        if settings.segment[axis.segment].is_line:
            raise refusal("drive --eds", axis.segment)
    profiles = {drive_of(settings, name).make() for name in settings.rig.axis}
    if len(profiles) != 1:
        raise UserError(
            "the rig has different drives: say of which one the EDS is to be",
            allowed=settings.rig.axis,
            hint="--axis NAME",
        )
    path.write_text(eds_text(profiles.pop(), path.name), encoding="ascii", newline="\r\n")
    return path


def whose_eds(settings: Settings) -> str:
    """Name the axes that the written EDS fits, and their drives."""
    return ", ".join(
        f"axis {name} ({axis.drive}, profile {drive_of(settings, name).profile})"
        for name, axis in settings.rig.axis.items()
    )


def serve(
    settings: Settings,
    outside: Outside,
    put_out: Callable[[str], None],
    *,
    by_sync: bool,
    folder: Path | None,
    for_s: float | None,
    store: Path | None = None,
) -> None:
    """Run the drives until Ctrl-C, or for so many seconds; arguments as `DriveServer`."""
    with (
        outside.open_hardware() as hardware,
        DriveServer(
            settings, hardware, put_out, by_sync=by_sync, folder=folder, store=store
        ) as server,
    ):
        server.run(None if for_s is None else round(for_s * S))


class DriveServer:
    """The virtual drives of a rig on real interfaces; a context manager that closes them.

    settings: of the rig, without kernel. by_sync: each SYNC of the master advances the time of
    drives and plants by one period (1006, or 60C2 where it is 0), however late it comes. folder:
    gets the bus log, events, latches and a trace; None = nothing is written. store: file that keeps
    what the master stores (1010), None = it is forgotten at the end.
    Raises UserError when the rig does not fit, or an interface cannot be opened.
    """

    def __init__(
        self,
        settings: Settings,
        hardware: Hardware,
        put_out: Callable[[str], None],
        *,
        by_sync: bool = False,
        folder: Path | None = None,
        store: Path | None = None,
    ) -> None:
        check_rig(settings)
        for name in settings.segment:
            if not is_real(settings, name):
                table = settings.segment[name]
                raise UserError(
                    f"segment {name} is simulated: no master can reach its drives",
                    hint="--interface ecat --channel IF for a master of EtherCAT, on CAN an"
                    " --axis that is there"
                    if table.is_line
                    else "name a CAN interface, e.g. --interface socketcan --channel can0",
                )
        self._hardware, self._put_out, self._folder = hardware, put_out, folder
        self._open = ExitStack()
        with ExitStack() as guard:
            guard.callback(self._open.close)
            period = self._sync_period_ns if by_sync else None
            pacing = Pacing(slip_ns=BEHIND_NS, sync_period_ns=period)
            self.scheduler = PacedScheduler(hardware.real_time, pacing, Deadlines(BEHIND_NS))
            self.plant = build_plant(settings)
            self._open.callback(close_plant, self.plant)
            check_plants(settings, self.plant)
            start_plant(settings, self.plant)
            if folder is not None:
                folder.mkdir(parents=True, exist_ok=True)
            bus_logs = [] if folder is None else [folder / "bus.blf"]
            # Real time: no block may hold a cycle up
            self.segments = build_segments(
                settings, self.scheduler, Journal(1), bus_logs, self._open
            )
            beside = Beside(settings, self.plant, self.scheduler)
            self.nodes = build_nodes(settings, self.scheduler, self.segments, beside, 0)
            memories = {name: node.slave.storage for name, node in self.nodes.items()}
            self._parameters = ParameterFile(store, memories) if store is not None else None
            self._watcher = Watcher(settings, self.nodes, self.plant, put_out, folder, self._open)
            self._trace = Trace(
                {name: self.plant.axes[settings.rig.axis[name].plant] for name in self.nodes}
            )
            for segment in self.segments.values():
                assert isinstance(segment, OutsideSegment)
                segment.keeps_load = False  # the drives may run for days
                segment.observe(self._watcher)
                if folder is not None:
                    segment.observe(self._on_frame)
            guard.pop_all()
        self._tried_ns: dict[str, TimeNs] = {}

    def __enter__(self) -> "DriveServer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(self, for_ns: TimeNs | None = None) -> None:
        """Run until the operator stops, or for so much real time."""
        for name, segment in self.segments.items():
            assert isinstance(segment, OutsideSegment)
            self._put_out(f"segment {name}: {segment.info}")
        for name, node in self.nodes.items():
            self._put_out(f"axis {name}: drive with node {node.node_id}")
        clock = self._hardware.real_time.monotonic_ns
        begin_ns = clock()
        gc.freeze()
        try:
            while not self._hardware.stop() and (for_ns is None or clock() - begin_ns < for_ns):
                self.scheduler.run_until(self.scheduler.now_ns + SLICE_NS)
                self._watcher.look(self.scheduler.now_ns)
                if self._parameters is not None and self._parameters.look():
                    self._watcher.report(self.scheduler.now_ns, "", "store", "parameters written")
                self._mend(clock())
        finally:
            gc.unfreeze()
        behind = self.scheduler.deadlines
        if behind.slips:
            self._put_out(
                f"this computer was more than {BEHIND_NS // MS} ms late {behind.slips} times,"
                f" {behind.slipped_ns / MS:.0f} ms in all; the drives ran slower by that"
            )

    def close(self) -> None:
        """Write the trace; close interfaces, logs and plants."""
        if self._folder is not None:
            writer = SeriesWriter(self._folder / "trace.parquet")
            writer.add(self._trace.columns())
            writer.close()
            self._folder = None
        self._open.close()

    def _sync_period_ns(self) -> TimeNs:
        return max((_sync_period_ns(node) for node in self.nodes.values()), default=0)

    def _on_frame(self, _time_ns: TimeNs, _segment: str, frame: Frame, _is_error: bool) -> None:
        if frame.arbitration_id == SYNC_ID and not frame.is_extended_id:
            # After the nodes, which act on the SYNC later in this instant
            now_ns = self.scheduler.now_ns
            self.scheduler.call_at(now_ns, Phase.ARBITRATION, partial(self._trace.add, now_ns))

    def _mend(self, real_ns: TimeNs) -> None:
        """Report interfaces that are lost, and try once per second to open them again."""
        for name, segment in self.segments.items():
            assert isinstance(segment, OutsideSegment)
            if segment.lost is None:
                continue
            if name not in self._tried_ns:
                self._watcher.report(
                    self.scheduler.now_ns, "", "bus", f"{name} is lost: {segment.lost}"
                )
            elif real_ns - self._tried_ns[name] < REOPEN_NS:
                continue
            self._tried_ns[name] = real_ns
            if segment.reopen():
                del self._tried_ns[name]
                self._watcher.report(self.scheduler.now_ns, "", "bus", f"{name} is there again")


def _sync_period_ns(node: DriveNode) -> TimeNs:
    """Return the period of the SYNC as the objects of a drive say it."""
    return node.image.sync_period_us * US or node.servo.interpolation.period_ns()


class Trace:
    """The truth of the plants at every SYNC: `table()` as the traces of runs, without a kernel."""

    COLUMNS = ("truth_mm", "velocity_mm_s", "motor_mm", "demand_mm")
    _PLACES = (POSITION, VELOCITY, MOTOR_POSITION, DEMAND_POSITION)

    def __init__(self, axes: dict[str, PlantAxis]) -> None:
        self._axes = axes
        self._times: list[TimeNs] = []
        self._rows: list[list[float]] = []

    def add(self, time_ns: TimeNs) -> None:
        """Note one SYNC."""
        row: list[float] = []
        for axis in self._axes.values():
            row += [axis.motion[place] * 1e3 for place in self._PLACES]
        self._times.append(time_ns)
        self._rows.append(row)

    def columns(self) -> dict[str, pa.Array]:
        """Return column `time_ns` and COLUMNS for each axis."""
        columns = {"time_ns": column_of(np.array(self._times, dtype=np.int64))}
        names = [f"{axis}.{column}" for axis in self._axes for column in self.COLUMNS]
        for index, name in enumerate(names):
            columns[name] = column_of(
                np.array([row[index] for row in self._rows], dtype=np.float64)
            )
        return columns
