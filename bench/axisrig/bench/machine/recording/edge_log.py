"""Notes where the axes were at the edges of the signals that they watch: the truth of a latch.

An observer of the channel. Cheap while nothing happens: it compares how many edges there are.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from axisrig.bench.oracles.interpolation import cubic
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.bench.record.edges import EdgeTruth, ReadBy
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import MOTOR_POSITION, POSITION
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantSignal
from axisrig.kernel.time.clock import US, TimeNs

SlavesOf = Callable[[Collection[str]], Mapping[str, str]]


@dataclass(frozen=True)
class Watcher:
    """An axis that watches a signal. times: of what reads it, its drive or the terminal."""

    axis: str
    times: LatchTimes
    read_by: ReadBy = "drive"


@dataclass
class Places:
    """Where an axis is at an instant, mm; degrees where it turns."""

    motor_mm: float | None = None
    load_mm: float | None = None
    second_mm: float | None = None


@dataclass
class _Edge:
    """An edge that came. latch: None while its instant has not come."""

    probe: str
    watcher: Watcher
    level: bool
    edge_ns: TimeNs
    at_edge: Places
    latch_ns: TimeNs
    latch: Places | None = None


class EdgeLog:
    """Keeps the edges of the signals that axes watch, with motor and load position of each axis.

    axes: plants by the axes of the rig that are simulated here. watchers: by the plant of the
    signal. slaves_of: the slaves that follow any of some axes now, each with its master.
    """

    def __init__(
        self,
        plant: Plant,
        axes: Mapping[str, PlantAxis],
        watchers: Mapping[str, Sequence[Watcher]],
        slaves_of: SlavesOf,
    ) -> None:
        self._plant, self._axes, self._slaves_of = plant, dict(axes), slaves_of
        self._watchers = [watchers[name] for name in watchers]
        self._names = list(watchers)
        self._signals: list[PlantSignal] = [plant.probes[name].signal for name in watchers]
        self._seen = [0] * len(self._signals)
        self._edges: list[_Edge] = []
        self._open: list[_Edge] = []

    def __call__(self, _channel: Channel) -> None:
        """Look up what the plant has passed since the last cycle."""
        self.look()

    def look(self) -> None:
        """Look up what the plant has passed since the last call."""
        for number, signal in enumerate(self._signals):
            if len(signal.edges) != self._seen[number]:
                self._take(number, signal.edges[self._seen[number] :])
                self._seen[number] = len(signal.edges)
        if self._open:
            self._close()

    def rows(self) -> tuple[EdgeTruth, ...]:
        """Return all edges until now, by instant, signal and the order of the axes."""
        self.look()
        order = {axis: number for number, axis in enumerate(self._axes)}
        found = sorted(
            self._edges,
            key=lambda e: (e.edge_ns, e.probe, order[e.watcher.axis], e.watcher.read_by),
        )
        return tuple(_row(edge) for edge in found)

    def _take(self, number: int, edges: Sequence[tuple[TimeNs, bool]]) -> None:
        """Note edges of a signal, for each axis that watches it and for their slaves."""
        own = self._watchers[number]
        known = {(watcher.axis, watcher.read_by) for watcher in own}
        watchers = list(own)
        for slave, master in self._slaves_of([watcher.axis for watcher in own]).items():
            if slave in self._axes:
                watchers += [
                    Watcher(slave, watcher.times, watcher.read_by)
                    for watcher in own
                    if watcher.axis == master and (slave, watcher.read_by) not in known
                ]
        for edge_ns, level in edges:
            for watcher in watchers:
                place = self._places_at(watcher.axis, edge_ns)
                latch_ns = watcher.times.instant_ns(edge_ns)
                edge = _Edge(self._names[number], watcher, level, edge_ns, place, latch_ns)
                self._edges.append(edge)
                self._open.append(edge)

    def _close(self) -> None:
        """Look up the latches whose instants have come."""
        now_ns, still = self._plant.now_ns, []
        for edge in self._open:
            if edge.latch_ns <= now_ns:
                edge.latch = self._places_at(edge.watcher.axis, edge.latch_ns)
            else:
                still.append(edge)
        self._open = still

    def _places_at(self, name: str, time_ns: TimeNs) -> Places:
        """Return where an axis was, apart from what its drive takes for a latch.

        Nothing where the plant does not keep that motion any more. The second encoder is the load
        then and the error of the encoder now, as far as the plant knows it.
        """
        axis = self._axes[name]
        try:
            begin, end = axis.ends_around(time_ns)
        except PlantError:
            return Places()
        load_m = _between(time_ns, begin, end, POSITION)
        second_m = axis.second_encoder_m()
        return Places(
            _between(time_ns, begin, end, MOTOR_POSITION) * 1e3,
            load_m * 1e3,
            None if second_m is None else (load_m + (second_m - axis.position_m())) * 1e3,
        )


def _between(
    time_ns: TimeNs,
    begin: tuple[TimeNs, list[float]],
    end: tuple[TimeNs, list[float]],
    place: int,
) -> float:
    """Return an output of an axis inside a step of its plant; its rate is the next output."""
    (begin_ns, first), (end_ns, last) = begin, end
    if end_ns == begin_ns:
        return first[place]
    ends = (first[place], first[place + 1], last[place], last[place + 1])
    return cubic((time_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9, ends)


def _row(edge: _Edge) -> EdgeTruth:
    latch = edge.latch or Places()
    return EdgeTruth(
        probe=edge.probe,
        axis=edge.watcher.axis,
        level=edge.level,
        edge_ns=edge.edge_ns,
        motor_mm=edge.at_edge.motor_mm,
        load_mm=edge.at_edge.load_mm,
        latch_ns=edge.latch_ns,
        latch_motor_mm=latch.motor_mm,
        latch_load_mm=latch.load_mm,
        second_mm=edge.at_edge.second_mm,
        latch_second_mm=latch.second_mm,
        read_by=edge.watcher.read_by,
        latch_jitter_ns=edge.watcher.times.jitter_ns,
    )


def edge_log(
    settings: Settings, plant: Plant, axes: Collection[str], slaves_of: SlavesOf
) -> EdgeLog:
    """Return the log of a machine; axes: those of the rig that are simulated here."""
    plants = {name: plant.axes[settings.rig.axis[name].plant] for name in axes}
    return EdgeLog(plant, plants, watchers_of(settings, axes), slaves_of)


def watchers_of(settings: Settings, axes: Collection[str]) -> dict[str, list[Watcher]]:
    """Return who watches which signal, by the plant of the signal.

    axes: those of the rig that are simulated here. An axis watches what is wired to its drive, each
    signal once; what is at the terminal of the PLC may be measured with any axis.
    """
    found: dict[str, list[Watcher]] = {}
    for name in axes:
        table = settings.rig.axis[name]
        times = settings.rig.drive[table.drive].facts().latch
        for probe in dict.fromkeys(table.signals.values()):
            found.setdefault(probe, []).append(Watcher(name, times))
    task = settings.rig.plc_task
    if task is not None and task.terminal is not None:
        stamped = stamp_times(task)
        for probe in dict.fromkeys(task.terminal.inputs.values()):
            found.setdefault(probe, []).extend(Watcher(name, stamped, "terminal") for name in axes)
    return found


def stamp_times(task: PlcTaskTable) -> LatchTimes:
    """Return what a terminal makes of an edge; a node on a CAN bus has no stamps."""
    table = task.terminal
    assert table is not None
    stamps = Stamps(
        table.stamp_resolution_ns,
        task.clock_offset_ns,
        task.clock_drift_ppm,
        task.assumed_offset_ns,
        task.assumed_drift_ppm,
    )
    return LatchTimes(
        delay_ns=round(table.filter_us * US),
        jitter_ns=table.stamp_jitter_ns,
        stamps=None if table.is_on_can else stamps,
    )
