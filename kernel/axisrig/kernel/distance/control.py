"""Distance control: from a sensor value to an offset, once per NC cycle.

It has no link to an axis, program or drive. Sensor values count against the motor: they fall when
the tool lifts, s = -g with the gap g, and are 0 where the tool touches the ideal surface
(FCT-M3 5). Laws:

surface (FCT-M3 5.1)            e = filter(actual + sensor - SET_POS) - offset
constant distance (5.2, 7.1)    e = SET_DIST - filter(d), d = -sensor; 3D (12.1): d + what an
                                inclined tool is nearer
both encoders (7.1)             e = SET_DIST - filter(d - (actual - sent))

and offset += limit(PID(e)); what the manuals leave open of PID and limit is in `law`. The surface
law compares with the offset that already acts, as its
deviation stays when it is compensated (docs/ambiguities.md).
"""

from collections import deque
from collections.abc import Mapping
from typing import Final

from axisrig.kernel.distance.controller import Controller
from axisrig.kernel.distance.filters import Filter, make_filter, memory_cycles
from axisrig.kernel.distance.limiter import UNLIMITED, AxesAllow, Limiter
from axisrig.kernel.distance.settings import DistanceSettings, field_name
from axisrig.kernel.distance.states import (
    FOLLOWING,
    REFUSED_PLC,
    DistanceCommand,
    DistanceState,
    Source,
    changes,
)
from axisrig.kernel.distance.supervision import Silence, change_alarm, deviation_alarm, range_alarm
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import TimeNs

# Newer and older ID
NO_SET_VALUE: Mapping[DistanceState, tuple[int, ...]] = {
    DistanceState.ACTIVE: (310024, 70335),
    DistanceState.ACTIVE_CONST_DIST: (900311,),
}
# Values that REF looks back on at most: longer than any mean, and than a low-pass above 1 Hz
STANDING_MAX: Final = 1000
ABSOLUTE_SENSOR, REFERENCED_WHILE_ON = (900312,), (900313,)


class Reading:
    """The values of one cycle, in mm.

    sensor_mm: sensor value. actual_mm: actual position of the same SYNC. sent_mm: total set
    position that was sent in the cycle before. is_held: feedhold or override 0 of the axis.
    silence: the sensor value is too old; None while it is not. override: of the axis, 1 = 100 %; it
    scales v_max. shorter_mm: by how much the distance is less than SET_DIST although the tool is
    where it should be, as an inclined one is. axes: what the axes allow the offset.
    """

    # Made in every cycle: a dataclass has a constructor that is never compiled
    def __init__(
        self,
        sensor_mm: float,
        actual_mm: float,
        sent_mm: float,
        is_held: bool = False,
        silence: Silence | None = None,
        override: float = 1.0,
        shorter_mm: float = 0.0,
        axes: AxesAllow = UNLIMITED,
    ) -> None:
        self.sensor_mm, self.actual_mm, self.sent_mm = sensor_mm, actual_mm, sent_mm
        self.is_held, self.silence, self.override = is_held, silence, override
        self.shorter_mm, self.axes = shorter_mm, axes


class DistanceControl:
    """Distance control of an axis or of a channel, which `owner` names in alarms.

    Shown, in mm: offset_mm; of the last reading sensor_mm, distance_mm, surface_mm, as soon as
    there was one (has_read); of the control feedback_mm and, out of the filter, filtered_mm
    (deviation from SET_POS, or distance), error_mm, delta_mm before the limits and step_mm after
    them. zero_mm: what REF has made 0. set_pos_mm and set_dist_mm: in force, None while there is
    none.
    """

    def __init__(self, owner: str, settings: DistanceSettings, period_ns: TimeNs) -> None:
        self.owner, self.settings = owner, settings
        self._period_ns = period_ns
        self.state, self.source = DistanceState.INACTIVE, Source.NC
        self.is_dry_run = False
        self.set_pos_mm: float | None = None
        self.set_dist_mm: float | None = None
        self.offset_mm = 0.0
        self.sensor_mm = self.distance_mm = self.surface_mm = 0.0
        self.feedback_mm = self.filtered_mm = self.error_mm = 0.0
        self.delta_mm = self.step_mm = 0.0
        self._controller, self._limiter = Controller(period_ns), Limiter(period_ns)
        self._filter: Filter | None = None  # None while nothing is filtered
        self._is_filter_new = False
        self._mode = DistanceState.ACTIVE  # the law that the filter works for
        self._zero_mm = 0.0  # sensor value that REF has made 0
        # What the sensor has measured, newest last, since the axis was last sent anywhere
        self._standing: deque[float] = deque(maxlen=STANDING_MAX)
        self._sent_mm: float | None = None
        self._memory: tuple[DistanceSettings | None, int] = (None, 0)
        self._change_mm: float | None = None  # None while no value before counts
        self._has_reading = self.has_read = False
        self._known: set[DistanceState] = set()  # modes that have their set value
        self._requested: dict[str, float | str] = {}

    # Commands

    def command(
        self,
        command: DistanceCommand,
        source: Source,
        *,
        no_move: bool = False,
        dry_run: bool = False,
    ) -> None:
        """Change the state as `states.csv` says; a refused command changes nothing.

        no_move: OFF leaves the tool where it is; the owner has to take the offset over. dry_run: ON
        computes everything and moves nothing. Raises Alarm of the row, 310024 or 70335 without
        SET_POS, 900311 without SET_DIST, 310001 and 310003 for a filter that cannot be.
        """
        after = self._allowed(command, source)
        if after in FOLLOWING:
            self._switch_on(after, dry_run=dry_run)
        elif command is DistanceCommand.OFF:
            self._switch_off(after, no_move=no_move)
        else:
            self._hold(DistanceState.FREEZE)
        self.source = source

    def _allowed(self, command: DistanceCommand, source: Source) -> DistanceState:
        """Return the next state, or raise the alarm of a change that does not exist.

        A dry run puts nothing out, so that any mode may follow, as on FREEZE (%DIST_5 of FCT-M3 6).
        """
        before = DistanceState.FREEZE if self.is_dry_run else self.state
        change = changes()[before, command]
        if change.next is not None:
            return change.next
        raise self.settings.alarm(
            REFUSED_PLC if source is Source.PLC else change.alarm_ids,
            owner=self.owner,
            current=self.state.name,
            wanted=command.name,
            programmed=command.name,
        )

    def _switch_on(self, mode: DistanceState, *, dry_run: bool) -> None:
        if mode not in self._known and not dry_run:
            raise self.settings.alarm(NO_SET_VALUE[mode], owner=self.owner)
        if self.state not in FOLLOWING or self.is_dry_run:
            self._begin(mode)
        self.state, self.is_dry_run = mode, dry_run

    def _begin(self, mode: DistanceState) -> None:
        """Begin to follow: take over what was requested, with a filter for this law."""
        settings = self.settings.replaced(**self._requested)
        is_same = self._filter is not None and self._mode is mode
        if not is_same or settings.filter != self.settings.filter:
            self._set_filter(settings, is_new=not is_same)
        self.settings, self._requested, self._mode = settings, {}, mode
        if self.state is DistanceState.INACTIVE:
            self._has_reading = False  # it may be of another sensor
        self._controller.restart()

    def _set_filter(self, settings: DistanceSettings, *, is_new: bool) -> None:
        """Put a filter in place: a new one begins with its first value, else with what it gave.

        One that would give the same values as the old one is none: it goes on.
        """
        found, old = self._make_filter(settings), self._filter
        if not is_new and old is not None and found.character == old.character:
            return
        found.restart(self.filtered_mm)
        self._filter, self._is_filter_new = found, is_new

    def _make_filter(self, settings: DistanceSettings) -> Filter:
        return make_filter(settings.filter.kind, settings.filter, self._period_ns, self.owner)

    def _switch_off(self, after: DistanceState, *, no_move: bool) -> None:
        if no_move:
            self.offset_mm = 0.0
        if no_move or (after is DistanceState.INACTIVE and not self.offset_mm):
            self._hold(DistanceState.INACTIVE)
        else:
            self.state, self.is_dry_run = DistanceState.TURNING_OFF, False
            self._stop_comparing()

    def _hold(self, state: DistanceState) -> None:
        """Hold the offset from now on."""
        self.state, self.is_dry_run = state, False
        self._rest()
        if state is DistanceState.INACTIVE:
            self._stop_comparing()

    def _stop_comparing(self) -> None:
        self._filter = None
        self.feedback_mm = self.filtered_mm = self.error_mm = 0.0

    def _rest(self) -> None:
        self._limiter.rest()
        self.step_mm = 0.0

    def switch_off_kept(self) -> None:
        """Switch off after a reset or an error of the axis: the offset stays (FCT-M3 6)."""
        self._hold(DistanceState.INACTIVE)

    def hand_over(self) -> None:
        """Have no offset any more: it is part of the position of the owner."""
        self.offset_mm = 0.0

    # Values

    def set_surface(self, set_pos_mm: float) -> None:
        """Say where the ideal surface is (SET_POS); acts from the next cycle on."""
        self.set_pos_mm = set_pos_mm
        self._known.add(DistanceState.ACTIVE)

    def set_distance(self, set_dist_mm: float) -> None:
        """Say how far the tool is to stay away (SET_DIST); may change in every cycle."""
        self.set_dist_mm = set_dist_mm
        self._known.add(DistanceState.ACTIVE_CONST_DIST)

    def forget_set_values(self) -> None:
        """Forget SET_POS and SET_DIST, as program end and reset do; what is on goes on."""
        self._known.clear()
        if self.state is DistanceState.INACTIVE:
            self.set_pos_mm = self.set_dist_mm = None

    def program(self, **parameters: float | str) -> None:
        """Take parameters of the NC program, which act at once; names as `DistanceSettings`.

        A filter goes on from what it has given last. Raises Alarm 310001 or 310003 for a filter
        that cannot be, while one is needed.
        """
        settings = self.settings.replaced(**parameters)
        if self._filter is not None and settings.filter != self.settings.filter:
            self._set_filter(settings, is_new=self._is_filter_new)
        self.settings = settings
        for name in parameters:
            self._requested.pop(field_name(name), None)

    def request(self, name: str, value: float | str) -> None:
        """Take a parameter from a CNC object: it acts when control is switched on the next time.

        That is from INACTIVE or FREEZE (FCT-M3 7.6). Raises TypeError for an unknown name.
        """
        self.settings.replaced(**{name: value})
        self._requested[field_name(name)] = value

    def requested(self, name: str) -> float | str | None:
        """Return what was requested for a parameter and does not act yet, None without."""
        return self._requested.get(field_name(name))

    @property
    def zero_mm(self) -> float:
        """Sensor value that REF has made 0."""
        return self._zero_mm

    def check_position(self, sensor_mm: float) -> None:
        """Raise the alarm of a sensor outside its limits and their tolerance (CHECK_POS)."""
        alarm = range_alarm(self.owner, sensor_mm - self._zero_mm, self.settings)
        if alarm is not None:
            raise alarm

    def may_reference(self) -> bool:
        """Whether enough is known for REF: what the filter remembers, while the axis is at rest."""
        is_refused = self.settings.has_absolute_sensor or self.state is not DistanceState.INACTIVE
        return is_refused or len(self._standing) >= min(self._memory_cycles(), STANDING_MAX)

    def _memory_cycles(self) -> int:
        """Return what the filter remembers; 0 for one that cannot be, which `reference` reports."""
        settings, cycles = self._memory
        if settings is not self.settings:
            try:
                cycles = memory_cycles(self._make_filter(self.settings))
            except Alarm:
                cycles = 0
            self._memory = self.settings, cycles
        return cycles

    def listen(self, sensor_mm: float) -> None:
        """Take a sensor value while nothing says where the surface is."""
        self._standing.append(sensor_mm)
        self.has_read = True
        self.sensor_mm = sensor_mm - self._zero_mm
        self.distance_mm = -self.sensor_mm

    def forget_readings(self) -> None:
        """Forget what was read: another sensor measures from now on."""
        self._standing.clear()

    def reference(self, sensor_mm: float) -> None:
        """Make the present sensor value 0 (REF), as the filter gives it: one value is noisy.

        Raises Alarm 900312 for an absolute sensor, whose zero is P-AXIS-00418, and 900313 while
        control is not INACTIVE; 310001 and 310003 for a filter that cannot be.
        """
        if self.settings.has_absolute_sensor:
            raise self.settings.alarm(ABSOLUTE_SENSOR, owner=self.owner)
        if self.state is not DistanceState.INACTIVE:
            state = self.state.name
            raise self.settings.alarm(REFERENCED_WHILE_ON, owner=self.owner, current=state)
        smooth = self._make_filter(self.settings)
        standing_mm = self._standing or [sensor_mm]
        smooth.restart(standing_mm[0])
        for value_mm in standing_mm:
            self._zero_mm = smooth.step(value_mm)

    # Each cycle

    def step(self, reading: Reading) -> float:
        """Take the values of a cycle and return the offset for it, mm.

        Raises the alarms of `supervision`: the state is ERROR then; the offset is held,
        at its limit where it would have passed it.
        """
        self._take(reading)
        if self.state in FOLLOWING:
            self._follow(reading)
        elif self.state is DistanceState.TURNING_OFF:
            self._run_out(reading)
        else:
            self._rest()
            self.delta_mm = 0.0
            if self._filter is not None:
                self._compare(reading)
        return self.offset_mm

    def _take(self, reading: Reading) -> None:
        if reading.sent_mm != self._sent_mm:
            self._sent_mm = reading.sent_mm
            self._standing.clear()
        self._standing.append(reading.sensor_mm)
        sensor_mm = reading.sensor_mm - self._zero_mm
        self._change_mm = sensor_mm - self.sensor_mm if self._has_reading else None
        self._has_reading = self.has_read = True
        self.sensor_mm, self.distance_mm = sensor_mm, -sensor_mm
        self.surface_mm = reading.actual_mm + sensor_mm

    def _follow(self, reading: Reading) -> None:
        if not reading.is_held:
            self._supervise(reading)
        self._compare(reading)
        is_surface = self._mode is DistanceState.ACTIVE
        towards_mm = self.filtered_mm if is_surface else -self.filtered_mm
        self.delta_mm = self._controller.delta_mm(self.error_mm, towards_mm, self.settings)
        if reading.is_held or self.is_dry_run:
            self._rest()
            self._controller.settle(is_limited=True)
            return
        step_mm = self._limiter.limit(
            self.delta_mm, self.error_mm, self.settings, reading.override, reading.axes
        )
        self._controller.settle(is_limited=step_mm != self.delta_mm)
        self._move(step_mm)

    def _supervise(self, reading: Reading) -> None:
        alarm = None
        if reading.silence is not None:
            alarm = reading.silence.alarm(self.owner, self.settings)
        elif self._change_mm is not None:
            alarm = change_alarm(self.owner, self._change_mm, self._period_ns, self.settings)
        alarm = alarm or range_alarm(self.owner, self.sensor_mm, self.settings)
        if alarm is not None:
            self.delta_mm = self.step_mm = 0.0
            self._fail(alarm)

    def _compare(self, reading: Reading) -> None:
        """Filter what the law looks at and take the control error; 0 without a set value."""
        is_surface = self._mode is DistanceState.ACTIVE
        set_mm = self.set_pos_mm if is_surface else self.set_dist_mm
        raw_mm = self.surface_mm - (set_mm or 0.0) if is_surface else self.distance_mm
        if reading.shorter_mm and not is_surface:
            raw_mm += reading.shorter_mm
        if self.settings.both_encoders and not is_surface:
            raw_mm -= reading.actual_mm - reading.sent_mm
        assert self._filter is not None
        self.feedback_mm = raw_mm
        if self._is_filter_new:
            self._filter.restart(raw_mm)
            self._is_filter_new = False
        self.filtered_mm = self._filter.step(raw_mm)
        if set_mm is None:
            self.error_mm = 0.0
        elif is_surface:
            self.error_mm = self.filtered_mm - self.offset_mm
        else:
            self.error_mm = set_mm - self.filtered_mm

    def _move(self, step_mm: float) -> None:
        wanted_mm, limit_mm = self.offset_mm + step_mm, self.settings.max_deviation_mm
        offset_mm = min(max(wanted_mm, -limit_mm), limit_mm)
        self.step_mm = step_mm if offset_mm == wanted_mm else offset_mm - self.offset_mm
        self.offset_mm = offset_mm
        alarm = deviation_alarm(self.owner, wanted_mm, offset_mm, self.settings)
        if alarm is not None:
            self._fail(alarm)

    def fail(self, alarm: Alarm) -> None:
        """Hold the offset after an error that the owner has found; raises its alarm."""
        self.delta_mm = self.step_mm = 0.0
        self._fail(alarm)

    def _fail(self, alarm: Alarm) -> None:
        """Hold the offset from the next cycle on."""
        self.state, self.is_dry_run = DistanceState.ERROR, False
        self._limiter.rest()
        raise alarm

    def _run_out(self, reading: Reading) -> None:
        self.delta_mm = -self.offset_mm
        if reading.is_held:
            self._rest()
            return
        self.step_mm = self._limiter.run_out(
            self.offset_mm, self.settings, reading.override, reading.axes
        )
        self.offset_mm += self.step_mm
        if self.offset_mm == 0.0:
            self.state = DistanceState.INACTIVE
