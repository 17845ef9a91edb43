"""Latches of an axis whose edge the PLC hands over: sources PLC, PLC_FIRST_EVENT, PLC_TIMESTAMP.

The CNC judges the level of `probing_signal` once in each of its cycles. The value is the actual
position of that cycle or the enabled `probing_position`; with a time stamp the position of the axis
at that instant, from the history of its positions. Sources: FCT-C4 7.1, 7.5, 8.2.3.
A `probing_position` is in 0.1 um, as the kernel API hands latched positions over (402368651).
"""

from typing import Final

from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival, StampClock
from axisrig.kernel.measuring.position_history import PositionHistory
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.plc.probing import PlcTask, ProbingUnit
from axisrig.kernel.time.clock import MS, Clock, TimeNs

STAMP_MASK: Final = 0xFFFF_FFFF


class SignalPort:
    """The latch of one axis by `probing_signal` (`LatchPort`); edge: POS or NEG, of P-AXIS-00518.

    handshake: of a source whose hardware the PLC switches, else None. doubt_mm: how far a value
    may be off that lies between positions which do not show where the axis was; None: they do.

    `look` is to be called in every cycle, before the run is evaluated. It raises Alarm 900401 when
    the PLC does not enable the unit, 900402 when its task is silent.
    """

    def __init__(
        self, link: Drive, unit: ProbingUnit, task: PlcTask, clock: Clock, edge: str
    ) -> None:
        self._link, self._unit, self._task, self._clock = link, unit, task, clock
        self.name, self.edge = link.name, edge
        self.handshake: Handshake | None = None
        self.history = PositionHistory()
        self.arrival = Arrival(handshake_cycles=None)
        self.latched_mm: float | None = None
        self.has_latched = self.is_armed = self.is_ordered = False
        self._level: bool | None = None
        self._ordered_ns: TimeNs = 0
        self._latch_ns: TimeNs | None = None  # bus time of the value, for its speed
        self._is_complete, self._speed_mm_ns = False, 0.0
        self.doubt_mm: float | None = None

    # What the run asks

    @property
    def is_clear(self) -> bool:
        """Whether no edge of an earlier run is left; the CNC keeps none."""
        return not self.is_ordered

    @property
    def is_prepared(self) -> bool:
        """Whether everything is known that a latch will be checked with."""
        return True

    @property
    def is_actuated(self) -> bool | None:
        """Whether the signal has the level that the edge leads to; None while it is not enabled."""
        level = self._unit.writes.signal
        return None if level is None else level is self._wanted

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self._speed_mm_ns * self._task.cycle_ns

    def arm(self) -> None:
        """Wait for the signal from now on."""
        self.is_ordered, self._ordered_ns = True, self._clock.now_ns
        self.doubt_mm = self._link.doubt_mm = None

    def disarm(self) -> None:
        """Wait no longer, and forget the latch."""
        self.is_ordered = self.is_armed = self.has_latched = False
        self.latched_mm = self._latch_ns = None
        self._is_complete, self._speed_mm_ns = False, 0.0
        self.arrival.stamp = None

    def is_confirmed(self) -> bool:
        """Whether the value is proved: its axis has gone on by the cycles that its speed needs."""
        return self._latch_ns is None or self._is_complete

    # Each cycle

    @property
    def _wanted(self) -> bool:
        """The level that the edge leads to."""
        return self.edge == "POS"

    @property
    def _sync_ns(self) -> TimeNs:
        """Bus time of the SYNC whose actual position this cycle has."""
        return self._task.sync_ns.get(self.name, 0)

    def look(self) -> None:
        """Take this cycle's signal and position."""
        if self._link.has_actual:
            off_ns = self._task.clocks_off_ns.get(self.name, 0)
            self.history.take(self._sync_ns, self._link.actual_mm, off_ns)
        level = self._unit.writes.signal
        if self.is_ordered:
            self._check_task()
            self._check_enabled("probing_signal", level is not None)
            self.is_armed = level is not None
            if self.has_latched:
                self._complete()
            elif level is self._wanted and self._level is not None and level is not self._level:
                self._latch()
        self._level = level

    def take_event(self) -> None:
        """Latch now, as the signal of another axis is the one that counts (PLC_FIRST_EVENT)."""
        if self.is_ordered and not self.has_latched:
            self._latch()

    def _check_task(self) -> None:
        silent_ns = self._task.silent_ns(self._clock.now_ns)
        if silent_ns is not None:
            raise Alarm(900402, axis=self.name, ms=f"{silent_ns / MS:g}")

    def _check_enabled(self, unit: str, is_enabled: bool) -> None:
        """Refuse a unit that the PLC does not enable: at once in a run, else after the time that it
        may take for an answer.
        """
        waited_ns = self._clock.now_ns - self._ordered_ns
        if not is_enabled and (self.is_armed or waited_ns > self._task.watchdog_ns):
            raise Alarm(900401, axis=self.name, unit=unit)

    def _latch(self) -> None:
        """Take the value that belongs to the edge of this cycle.

        Where the telegram of its SYNC is missing the history gives the position, as for a stamp.
        """
        units = self._unit.writes.position_units
        self.has_latched, self._latch_ns = True, self._sync_ns
        if units is not None:
            self.latched_mm = units / UNITS_PER_MM
        elif self._link.has_actual:
            self.latched_mm = self._link.actual_mm

    def _complete(self) -> None:
        """Take speed, and position if it is not known yet, as soon as the samples around it are
        there: a stop may take longer than the history lasts.
        """
        at_ns = self._latch_ns
        if self._is_complete or at_ns is None or not self.history.reaches(at_ns):
            return
        position_mm, self._speed_mm_ns = self.history.at(at_ns)
        self._is_complete = True
        if self.latched_mm is None:
            self._note_doubt(self._doubt_mm(at_ns))
            self.latched_mm = position_mm

    def _doubt_mm(self, at_ns: TimeNs) -> float:
        a_mm_s2 = self._link.settings.acceleration_mm_s2
        return self.history.doubt_mm(at_ns, self._task.cycle_ns, a_mm_s2)

    def _note_doubt(self, doubt_mm: float) -> None:
        """Keep it with the value; what is more than an increment counts as unproved."""
        self.doubt_mm = doubt_mm or None
        if doubt_mm * self._link.settings.increments_per_mm > 1.0:
            self._link.doubt_mm = doubt_mm
            self._link.interpolated_latches += 1


class StampPort(SignalPort):
    """The latch of one axis by `timestamp`: source PLC_TIMESTAMP.

    The stamp is to be written in the cycle of the PLC that writes the edge of the signal. Raises
    besides Alarm 900403 for a stamp in the future, 900404 for one older than the history, 900405
    for one before the run and 900086 for one while the clocks of the line were apart.
    """

    def __init__(
        self, link: Drive, unit: ProbingUnit, task: PlcTask, clock: Clock, edge: str
    ) -> None:
        super().__init__(link, unit, task, clock, edge)
        self.arrival.clock = StampClock()
        self.arrival.delay_cycles = task.late_cycles

    def _latch(self) -> None:
        stamp_ns, now_ns = self._unit.writes.timestamp_ns, self._clock.now_ns
        if stamp_ns is None:
            raise Alarm(900401, axis=self.name, unit="timestamp")
        at_ns, oldest_ns = self._task.stamps.bus_ns(stamp_ns), self.history.oldest_ns
        if at_ns > now_ns:
            raise Alarm(900403, axis=self.name, ahead_us=f"{(at_ns - now_ns) / 1e3:.6g}")
        if oldest_ns is None or at_ns < oldest_ns:
            reach_ns = 0 if oldest_ns is None else now_ns - oldest_ns
            raise Alarm(
                900404,
                axis=self.name,
                age_ms=f"{(now_ns - at_ns) / MS:.6g}",
                reach_ms=f"{reach_ns / MS:.6g}",
            )
        if at_ns < self._ordered_ns:
            before_ns = self._ordered_ns - at_ns
            raise Alarm(900405, axis=self.name, before_ms=f"{before_ns / MS:.6g}")
        self.has_latched, self._latch_ns = True, at_ns
        self.arrival.stamp = at_ns & STAMP_MASK
        self._complete()

    def _doubt_mm(self, at_ns: TimeNs) -> float:
        """Return what the samples leave open, and the way in what clocks were apart.

        That is the reference clock from the control, and another one from that.
        """
        off_ns, limit_ns = self.history.clocks_off_ns(at_ns), self._task.clock_limit_ns
        if off_ns > limit_ns.get(self.name, off_ns):
            raise Alarm(
                900086,
                axis=self.name,
                us=f"{off_ns / 1e3:.6g}",
                limit_us=f"{limit_ns[self.name] / 1e3:g}",
            )
        return super()._doubt_mm(at_ns) + 2.0 * off_ns * abs(self._speed_mm_ns)
