"""Latches of an axis whose hardware the PLC switches: PLC_EXT_LATCH_CONTROL, EXT_PROBE_WITH_DRIVE.

The CNC gives tasks (`LatchOrder`) and waits for the acknowledgement of each: of ENABLE before the
path moves, of DISABLE before the next run. Sources: FCT-C4 7.2 and 7.4.
"""

from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.channel.probing.signal import SignalPort
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.plc.probing import PlcTask, ProbingUnit
from axisrig.kernel.time.clock import Clock


class ExternalPort(SignalPort):
    """The latch in external measuring hardware: source PLC_EXT_LATCH_CONTROL.

    The rising edge of `probing_signal` reports the latch whatever P-AXIS-00518 says, which goes
    into the task only. The value is the enabled `probing_position`, else the actual position of the
    cycle that sees the signal. Errors: of `SignalPort` and `Handshake`.
    """

    def __init__(
        self, link: Drive, unit: ProbingUnit, task: PlcTask, clock: Clock, handshake: Handshake
    ) -> None:
        super().__init__(link, unit, task, clock, "POS")
        self.handshake, self._tasks = handshake, handshake
        self._waits = False

    @property
    def is_clear(self) -> bool:
        """Whether the hardware has acknowledged that it is off, or was never on."""
        self._waits = not self._tasks.is_idle
        return not self._waits

    def arm(self) -> None:
        """Enable the hardware."""
        self._tasks.enable()
        super().arm()

    def disarm(self) -> None:
        """Disable the hardware where it was enabled: after a latch and after an abort."""
        super().disarm()
        self._waits = False
        if self._tasks.is_enabled:
            self._tasks.disable()

    def look(self) -> None:
        """Take this cycle's signal; nothing counts before the hardware is enabled."""
        if self._waits or self.is_ordered:
            self._tasks.check()
        if self.is_ordered and not self._tasks.is_ready:
            self._ordered_ns = self._clock.now_ns
            self._level = self._unit.writes.signal
            return
        super().look()


class DrivePort:
    """A probe that the PLC switches, latched by the drive: source EXT_PROBE_WITH_DRIVE.

    As the link itself (`LatchPort`), but armed only when the PLC has enabled the probe. Errors: of
    `Handshake`.
    """

    def __init__(self, link: Drive, handshake: Handshake) -> None:
        self._link, self.handshake, self.name = link, handshake, link.name
        self._of_drive = link.arrival
        self._waits = self.is_ordered = self._has_armed = False

    @property
    def arrival(self) -> Arrival:
        """As that of the drive; the drive has its cycles from when it is armed on."""
        found = self._of_drive
        if self._has_armed:
            return found
        return Arrival(found.delay_cycles, found.missing_cycles, handshake_cycles=None)

    @property
    def is_clear(self) -> bool:
        """Whether the probe is off at the PLC and no latch is left in the drive."""
        self._waits = not self.handshake.is_idle
        return not self._waits and self._link.is_clear

    @property
    def is_armed(self) -> bool:
        """Whether the probe is on and the drive waits for its edge."""
        return self._has_armed and self._link.is_armed

    @property
    def is_prepared(self) -> bool:
        """Whether everything is known that a latch will be checked with."""
        return self._link.is_prepared

    @property
    def is_actuated(self) -> bool | None:
        """As the drive; while the probe is off its output says nothing."""
        return self._link.is_actuated if self._has_armed else None

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a stored edge."""
        return self._link.has_latched

    @property
    def latched_mm(self) -> float | None:
        """The latched position, None while it is not proved."""
        return self._link.latched_mm

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self._link.latched_speed_mm

    @property
    def doubt_mm(self) -> float | None:
        """How far the value may be wrong, None where it is proved."""
        return self._link.doubt_mm

    def is_confirmed(self) -> bool:
        """Whether SDO has reported the latch too, or cannot."""
        return self._link.is_confirmed()

    def arm(self) -> None:
        """Enable the probe; the drive is armed when the PLC has acknowledged it."""
        self.handshake.enable()
        self.is_ordered, self._has_armed = True, False

    def disarm(self) -> None:
        """Switch latch and probe off."""
        self._link.disarm()
        self.is_ordered = self._has_armed = self._waits = False
        if self.handshake.is_enabled:
            self.handshake.disable()

    def look(self) -> None:
        """Go on with the handshake."""
        if self._waits or self.is_ordered:
            self.handshake.check()
        if self.is_ordered and not self._has_armed and self.handshake.is_ready:
            self._link.arm()
            self._has_armed = True
