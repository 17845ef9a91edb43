"""Which latch an axis measures with whose source is at the PLC, and what #MEAS PREPARE does."""

from collections.abc import Iterable, Mapping

from axisrig.kernel.channel.probing.external import DrivePort, ExternalPort
from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.channel.probing.signal import SignalPort, StampPort
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import (
    EXTERNAL,
    EXTERNAL_WITH_DRIVE,
    PLC_FIRST_EVENT,
    PLC_TIMESTAMP,
)
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.plc.probing import PlcTask
from axisrig.kernel.time.clock import Clock

PlcPort = SignalPort | DrivePort


class PlcPorts:
    """Makes and keeps the latches at the PLC; one for each axis and source.

    Every one follows signal and position in every cycle, so that a run finds the level before it.
    """

    def __init__(self, links: Mapping[str, Drive], plc: PlcInterface, clock: Clock) -> None:
        self._links, self._plc, self._clock = links, plc, clock
        self._ports: dict[tuple[str, str], PlcPort] = {}
        self._handshakes: dict[str, Handshake] = {}
        self._sharing: list[SignalPort] = []  # those of PLC_FIRST_EVENT; only armed ones latch

    def task(self, axis: str, source: str) -> PlcTask:
        """Return the task of the PLC; raises Alarm 900400 for a rig without one."""
        if self._plc.task is None:
            raise Alarm(900400, axis=axis, source=source)
        return self._plc.task

    def find(self, axis: str, source: str) -> PlcPort | None:
        """Return the latch of an axis by a source, None while nothing has used it."""
        return self._ports.get((axis, source))

    def _make(self, axis: str, source: str) -> PlcPort:
        task, link, unit = self.task(axis, source), self._links[axis], self._plc.axis[axis].probing
        if source == EXTERNAL_WITH_DRIVE:
            return DrivePort(link, self._handshake(axis, task))
        if source == EXTERNAL:
            return ExternalPort(link, unit, task, self._clock, self._handshake(axis, task))
        if source == PLC_TIMESTAMP:
            return StampPort(link, unit, task, self._clock, link.edge)
        port = SignalPort(link, unit, task, self._clock, link.edge)
        if source == PLC_FIRST_EVENT:
            self._sharing.append(port)
        return port

    def _handshake(self, axis: str, task: PlcTask) -> Handshake:
        if axis not in self._handshakes:
            unit = self._plc.axis[axis].probing
            self._handshakes[axis] = Handshake(axis, unit, task, self._clock)
        return self._handshakes[axis]

    def choose(self, axis: str, source: str, probe_input: int, edge: str) -> PlcPort:
        """Return the latch for a run, with its input and edge; from its first use on it is kept up
        to date.
        """
        port = self._ports.get((axis, source))
        if port is None:
            port = self._ports[axis, source] = self._make(axis, source)
        if port.handshake is not None:
            port.handshake.probe_input, port.handshake.edge = probe_input, edge
        elif isinstance(port, SignalPort):
            port.edge = edge
        return port

    @property
    def is_ordered(self) -> bool:
        """Whether a run uses one of them."""
        return any(port.is_ordered for port in self._ports.values())

    def look(self) -> None:
        """Take this cycle's signals and positions; raises the alarms of the latches."""
        for port in self._ports.values():
            port.look()
        if self._sharing and any(port.has_latched for port in self._sharing):
            for port in self._sharing:
                port.take_event()

    def prepare(self, axis: str, source: str, probe_input: int, edge: str) -> None:
        """Make a probe ready ahead of its run, where the PLC switches it."""
        port = self.choose(axis, source, probe_input, edge)
        if port.handshake is not None:
            port.handshake.prepare()

    def forget(self, axes: Iterable[str]) -> None:
        """Switch probes off again that are prepared and not in use."""
        for axis in axes:
            handshake = self._handshakes.get(axis)
            if handshake is not None and not handshake.is_enabled:
                handshake.disable()
