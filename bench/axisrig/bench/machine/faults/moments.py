"""Moments of a run that faults begin at: looked at before every frame that goes on the wire."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.reading.faults import Moment
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.cia402.words import enabled_bit, stored_bit
from axisrig.kernel.time.clock import Phase
from axisrig.kernel.time.scheduler import Scheduler

Level = Callable[[], bool]


@dataclass(frozen=True)
class World:
    """The parts of a machine that faults look at and act on; nodes and links by axis.

    beside: wires and whatever else is no frame, with their faults.
    """

    settings: Settings
    scheduler: Scheduler
    segments: Mapping[str, Segment]
    nodes: Mapping[str, DriveNode]
    links: Mapping[str, AxisLink]
    plant: Plant
    channel: Channel
    beside: Beside


@dataclass
class _Watch:
    """One wait: for the nth time that `level` becomes true."""

    level: Level
    left: int
    offset_ns: int
    action: Callable[[], None]
    was: bool = False


class Moments:
    """Calls actions at moments of `fault_moments.csv`; a fault hook of every segment.

    A moment is noticed with the next frame after it, which is within the cycle.
    """

    def __init__(self, world: World) -> None:
        self._world, self._clock = world, world.scheduler
        self._watches: list[_Watch] = []

    def when(self, moment: Moment, nth: int, axes: list[str], action: Callable[[], None]) -> None:
        """Call `action` at a moment of one of the axes, for the nth time it comes."""
        if not self._watches:
            for segment in self._world.segments.values():
                segment.add_fault(self._look)
        levels = [self._level(moment.name, axis) for axis in axes]
        self._watches.append(
            _Watch(lambda: any(level() for level in levels), nth, moment.offset_ns, action)
        )

    def _level(self, name: str, axis: str) -> Level:
        """Return the condition whose beginning is the moment."""
        world = self._world
        link, probe = world.links[axis], world.nodes[axis].servo.touch_probe
        number, edge = link.settings.probe_input, link.settings.edge
        table = world.settings.rig.axis[axis]
        wired = world.plant.probes.get((table.probe_1, table.probe_2)[number - 1] or "")
        enabled, stored = enabled_bit(number), stored_bit(number, edge)
        conditions: dict[str, Level] = {
            "start": lambda: world.channel.start_ns is not None,
            "motion": lambda: not world.channel.interpolator.is_standing,
            "standing": lambda: world.channel.interpolator.is_standing,
            "armed": lambda: bool(probe.status & enabled),
            "edge": lambda: wired is not None and wired.signal.level == (edge == "POS"),
            "latched": lambda: bool(probe.status & stored),
            "seen": lambda: link.has_latched,
        }
        level = conditions[name]
        if name == "start":
            return level
        return lambda: world.channel.start_ns is not None and level()

    def _look(self, _frame: Frame, _port: Controller, _attempt: int) -> None:
        for watch in self._watches:
            if watch.left:
                now = watch.level()
                if now and not watch.was:
                    watch.left -= 1
                    if not watch.left:
                        self._begin(watch)
                watch.was = now

    def _begin(self, watch: _Watch) -> None:
        if not watch.offset_ns:
            watch.action()
            return
        time_ns = self._clock.now_ns + watch.offset_ns
        self._clock.call_at(time_ns, Phase.APPLICATION, watch.action)
