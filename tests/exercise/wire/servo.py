"""The drive at the far end of a wire: it follows its set position and latches a signal."""

from tests.exercise.wire.control import Wire

from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.drive.axis.motion import Motion
from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.kernel.time.clock import Clock, TimeNs


class WireServo(VirtualDrive):
    """Takes part in each cycle by `exchange`; a rising edge is latched where the motor was."""

    def __init__(
        self, wire: Wire, axis: AxisPort, signal: SignalPort | None, clock: Clock, period_ns: TimeNs
    ) -> None:
        super().__init__(tick_ns=period_ns)
        self._wire, self._axis, self._signal, self._clock = wire, axis, signal, clock
        self._motion, self._seen, self._latched_ns = Motion(axis), 0, list[TimeNs]()
        self._motion.off(clock.now_ns)
        self.latches = (self,)

    def exchange(self) -> None:
        """Look at the wire: at the begin of a cycle."""
        wire, now_ns = self._wire, self._clock.now_ns
        self._axis.advance_to(now_ns)
        self.sync_ns = now_ns
        edges = self._signal.edges if self._signal is not None else ()
        for at_ns, level in edges[self._seen :]:
            if level and wire.is_armed and wire.latched_mm is None:
                wire.latched_mm = self._axis.motor_position_m_at(at_ns) * 1e3
                self._latched_ns.append(at_ns)
                self._show()
        self._seen = len(edges)
        wire.level = None if self._signal is None else self._signal.level
        if wire.is_armed is not wire.is_ordered:
            wire.is_armed = wire.is_ordered
            self._show()
        wire.actual_mm = self._axis.motor_position_m() * 1e3
        if wire.is_on:
            begin_m = self._motion.position_m()
            self._motion.ramp(now_ns, begin_m, wire.set_mm * 1e-3, now_ns + self.tick_ns)
        elif self._motion.kind is not None:
            self._motion.off(now_ns)

    def _show(self) -> None:
        for watch in self.latch_watches:
            watch()

    @property
    def is_enabled(self) -> bool:
        """Whether it is armed."""
        return self._wire.is_armed

    def has_stored(self, is_rising: bool) -> bool:
        """It latches rising edges."""
        return is_rising and self._wire.latched_mm is not None

    @property
    def latch_instants_ns(self) -> list[list[TimeNs]]:
        """It has one input."""
        return [self._latched_ns]
