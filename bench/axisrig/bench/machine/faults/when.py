"""When faults act: from which moment (`at`, `nth`), how long (`for`), which hits (`p`, `count`).

Each moment is noticed where it comes up. Which frames are hit meanwhile `bench.bus.hits` counts.
"""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from axisrig.bench.bus.hits import Hits, Window
from axisrig.bench.drive.axis.drive import DriveLatch, VirtualDrive
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.rig.reading.faults import Fault, Moment
from axisrig.bench.rig.reading.file import RigFile
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantSignal
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.time.clock import Phase, TimeNs
from axisrig.kernel.time.scheduler import Scheduler

Level = Callable[[], bool]


def hits_of(fault: Fault, numbers: random.Random) -> Hits:
    """Return which frames a fault hits, in a window that `windowed` opens."""
    keys = fault.values
    window = Window(is_open=False)
    return Hits(window, numbers, share=keys["p"], skip=keys["skip"], count=keys["count"])


def windowed(window: Window) -> Act:
    """Return the act of what acts while a window is open."""
    return Act(window.begin, window.end, is_early=True)


@dataclass(frozen=True)
class Watched:
    """What moments are read from; links and virtual drives by axis, of any family."""

    rig: RigFile
    clock: Scheduler
    channel: Channel
    links: Mapping[str, Drive]
    drives: Mapping[str, VirtualDrive]
    plant: Plant

    def wired(self, axis: str) -> PlantSignal | None:
        """Return the plant's signal at the input that an axis measures with."""
        table, number = self.rig.axis[axis], self.links[axis].probe_input
        probe = self.plant.probes.get((table.probe_1, table.probe_2)[number - 1] or "")
        return None if probe is None else probe.signal

    def latch(self, axis: str) -> DriveLatch | None:
        """Return the latch in the drive that an axis measures with."""
        drive, number = self.drives.get(axis), self.links[axis].probe_input
        return drive.latches[number - 1] if drive and number <= len(drive.latches) else None


class _Wait:
    """One wait: for the nth time that one of the levels becomes true.

    counts: whether that is a moment yet.
    """

    def __init__(
        self, levels: Sequence[Level], nth: int, counts: Level, come: Callable[[TimeNs], None]
    ) -> None:
        self._levels, self._left, self._counts, self._come = levels, nth, counts, come
        self._was = self._is_true()

    def _is_true(self) -> bool:
        return any(level() for level in self._levels)

    def look(self, time_ns: TimeNs) -> None:
        """Look at the levels; time_ns: since when they are what they are."""
        if self._left:
            now = self._is_true()
            if now and not self._was and self._counts():
                self._left -= 1
                if not self._left:
                    self._come(time_ns)
            self._was = now


class Moments:
    """Begins and ends acts at moments of `fault_moments.csv`.

    The channel is looked at in every NC cycle, a drive when its latches change, a signal of the
    plant at each of its edges. What a moment begins comes at the same instant after whatever
    happens there, and before the next frame; an offset counts from the edge itself. What is so
    when the program starts is no moment: it has to come up again.
    """

    def __init__(self, watched: Watched) -> None:
        self._watched, self._clock = watched, watched.clock

    def run(self, fault: Fault, act: Act, axes: Sequence[str], record: Injected) -> None:
        """Let an act begin at the moment of its fault, or now, and end after its time.

        axes: whose moments count. record: gets the instants.
        """
        clock, values = self._clock, fault.values
        for_ns, moment = values.get("for"), values.get("at")

        def stop() -> None:
            act.end()
            record.end_ns = clock.now_ns

        def start() -> None:
            act.begin()
            record.begin_ns = clock.now_ns
            if for_ns is not None:
                clock.call_at(clock.now_ns + for_ns, Phase.APPLICATION, stop)

        if moment is not None:
            self._when(moment, values["nth"], axes, start)
            return
        if act.is_early:
            act.begin()
        clock.call_at(clock.now_ns, Phase.APPLICATION, start)

    def _when(
        self, moment: Moment, nth: int, axes: Sequence[str], action: Callable[[], None]
    ) -> None:
        def come(time_ns: TimeNs) -> None:
            due_ns = max(time_ns + moment.offset_ns, self._clock.now_ns)
            self._clock.call_at(due_ns, Phase.APPLICATION, action)

        level = _LEVELS[moment.name]
        levels = [partial(level, self._watched, axis) for axis in axes]
        wait = _Wait(levels, nth, partial(_has_started, self._watched), come)
        self._watched.channel.observers.append(lambda _: wait.look(self._clock.now_ns))
        for axis in axes:
            self._follow(moment.name, axis, wait)

    def _follow(self, moment: str, axis: str, wait: _Wait) -> None:
        """Let a wait look between two NC cycles, where its moment can come then."""
        watched = self._watched
        if moment == "edge":
            table = watched.rig.axis[axis]
            for probe in dict.fromkeys((table.probe_1, table.probe_2)):
                if probe in watched.plant.probes:
                    watched.plant.probes[probe].signal.watches.append(wait.look)
        elif moment in ("armed", "latched") and axis in watched.drives:
            clock = self._clock
            watched.drives[axis].latch_watches.append(lambda: wait.look(clock.now_ns))


def _has_started(watched: Watched, _axis: str = "") -> bool:
    return watched.channel.start_ns is not None


def _is_standing(watched: Watched, _axis: str) -> bool:
    return watched.channel.interpolator.is_standing


def _is_armed(watched: Watched, axis: str) -> bool:
    latch = watched.latch(axis)
    return latch is not None and latch.is_enabled


def _has_edge(watched: Watched, axis: str) -> bool:
    signal = watched.wired(axis)
    return signal is not None and signal.level == (watched.links[axis].edge == "POS")


def _has_stored(watched: Watched, axis: str) -> bool:
    latch = watched.latch(axis)
    return latch is not None and latch.has_stored(watched.links[axis].edge == "POS")


# The condition whose beginning is the moment
_LEVELS: Mapping[str, Callable[[Watched, str], bool]] = {
    "start": _has_started,
    "motion": lambda watched, axis: not _is_standing(watched, axis),
    "standing": _is_standing,
    "armed": _is_armed,
    "edge": _has_edge,
    "latched": _has_stored,
    "seen": lambda watched, axis: watched.links[axis].has_latched,
}
