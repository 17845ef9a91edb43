"""What the distance control of an axis and that of the channel have of their sensor in common."""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.channel.distance.sensor import (
    PERIODS_MAX,
    SECOND_ENCODER,
    VARIABLE,
    Sensor,
    VariableSensor,
)
from axisrig.kernel.distance import DistanceControl, DistanceState, Reading, Silence
from axisrig.kernel.distance.states import FOLLOWING
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, S, TimeNs

NO_VARIABLE, SOURCE_CHANGED, NO_SECOND_ENCODER = 310027, 310028, 310029
WITHOUT_AGE: Final = 900315
PASSED: Final = 900501
PERMILLE: Final = 1000
_ROUNDING_MM: Final = 1e-9


class Sensing:
    """A control with its sensor.

    sensor_mm: of this cycle, as the control counts it; None until there is one. is_held: the offset
    is held, by feedhold or override 0 of an axis. override: of the axis, 1 = 100 %. output_mm: the
    offset that was sent in the last cycle. age_limit_ms: None = after `PERIODS_MAX` periods.
    is_optimized: the offset is sent in the cycle that has computed it. increment_mm: the largest of
    the drives that it is sent to.
    """

    def __init__(
        self,
        control: DistanceControl,
        sensor: Sensor,
        period_ns: TimeNs,
        age_limit_ms: float | None,
        *,
        is_optimized: bool,
        increment_mm: float,
    ) -> None:
        self._increment_mm, self._last_step_mm = increment_mm, 0.0
        self.control, self.sensor = control, sensor
        self._period_ns, self._age_limit_ms = period_ns, age_limit_ms
        self._is_optimized = is_optimized
        self.sensor_mm: float | None = None
        self.is_held, self.override = False, 1.0
        self.output_mm = 0.0
        self._before_mm = 0.0  # offset of the cycle before, which is sent in this one
        self._without_age: set[str] = set()  # sensors that were warned of

    @property
    def is_moving(self) -> bool:
        """Whether the offset may change by itself."""
        state = self.control.state
        if state in FOLLOWING:
            return not self.control.is_dry_run
        return state is DistanceState.TURNING_OFF

    @property
    def has_offset(self) -> bool:
        """Whether an offset is there or on its way."""
        return bool(self.control.offset_mm or self.output_mm or self._before_mm)

    @property
    def has_surface(self) -> bool:
        """Whether the control knows where the surface is as soon as its sensor has a value."""
        return True

    @property
    def is_on_its_way(self) -> bool:
        """Whether the control has no offset any more and the last one has still to leave."""
        return self.has_offset and not self.control.offset_mm

    @property
    def is_idle(self) -> bool:
        """Whether it is off and leaves its axes where the program has them."""
        return self.control.state is DistanceState.INACTIVE and not self.has_offset

    def set_distance(self, set_dist_mm: float) -> Alarm | None:
        """Take SET_DIST; return a warning of it."""
        self.control.set_distance(set_dist_mm)
        return None

    # Sensor

    def sensor_for(self, source: str, variable: str | None) -> Sensor:
        """Return the sensor that a command names; raises Alarm 310029 for one that cannot be."""
        raise NotImplementedError

    def choose(self, source: str | None, variable: str | None) -> None:
        """Take another sensor (SENSOR_SOURCE, SENSOR_VAR); None leaves what is.

        Raises Alarm 310027, 310028, 310029.
        """
        if source is None and variable is None:
            return
        source = source or (VARIABLE if variable is not None else SECOND_ENCODER)
        if source == VARIABLE and variable is None and isinstance(self.sensor, VariableSensor):
            variable = self.sensor.name
        sensor = self.sensor_for(source, variable)
        is_other = source_word(sensor) != source_word(self.sensor)
        if self.control.state is not DistanceState.INACTIVE and is_other:
            raise Alarm(
                SOURCE_CHANGED,
                owner=self.control.owner,
                current=source_word(self.sensor),
                programmed=source_word(sensor),
            )
        self._require(sensor)
        if is_other:
            self.control.forget_readings()
        self.sensor = sensor
        self.take()

    def require_sensor(self) -> float:
        """Return the sensor value.

        Raises Alarm 310027 or 310029 when nothing measures it, 900314 when it is too old.
        """
        self._require(self.sensor)
        self.take()  # a program may begin in the cycle that has just powered the drives
        if self.sensor_mm is None:
            raise self._missing(self.sensor)
        silence = self.silence()
        if silence is not None:
            raise silence.alarm(self.control.owner, self.control.settings)
        return self.sensor_mm

    def may_reference(self) -> bool:
        """Whether REF can act, or will be refused: it waits for what the filter remembers."""
        is_known = self.sensor.exists and self.sensor_mm is not None
        return not is_known or self.control.may_reference()

    def age_warning(self) -> Alarm | None:
        """Return Alarm 900315 for a sensor whose silence nobody can notice; once for each."""
        source = source_word(self.sensor)
        if source in self._without_age or self.sensor.period_ns(self._period_ns) is not None:
            return None
        self._without_age.add(source)
        return Alarm(WITHOUT_AGE, owner=self.control.owner, source=source)

    def silence(self) -> Silence | None:
        """Return how long the sensor has been silent when that is too long, None when it is not."""
        promised_ns = self.sensor.period_ns(self._period_ns)
        if promised_ns is None:
            return None
        limit_ms = self._age_limit_ms
        limit_ms = PERIODS_MAX * promised_ns / MS if limit_ms is None else limit_ms
        age_ms = self.sensor.age_cycles * self._period_ns / MS
        return Silence(source_word(self.sensor), age_ms, limit_ms) if age_ms > limit_ms else None

    def _require(self, sensor: Sensor) -> None:
        if not sensor.exists:
            raise self._missing(sensor)

    def _missing(self, sensor: Sensor) -> Alarm:
        alarm_id = NO_VARIABLE if isinstance(sensor, VariableSensor) else NO_SECOND_ENCODER
        return Alarm(alarm_id, owner=self.control.owner, source=source_word(sensor))

    # Each cycle

    def read_mm(self) -> float | None:
        """Return the value of the sensor as the control counts it."""
        return self.sensor.read_mm()

    def take(self) -> None:
        """Take the sensor value of this cycle."""
        self.sensor_mm = self.read_mm()

    def control_within_limits(self, reading: Reading) -> None:
        """Let the control do its step; raises its alarms.

        Raises Alarm 900501 where the offset passes its own limits, P-AXIS-00415 and 00416 of an
        axis: it stays where it was then. An offset may stop at once, held or at the end of its
        range (docs/ambiguities.md).
        """
        control = self.control
        # FREEZE and ON in one cycle: it has stopped at once and begins again
        last_mm = self._last_step_mm if control.step_mm else 0.0
        before_mm, self._last_step_mm = control.offset_mm, 0.0
        control.step(reading)
        step_mm = control.offset_mm - before_mm
        settings, period_s = control.settings, self._period_ns / S
        v_mm_s = settings.v_max_mm_s * max(settings.v_weight_down_permille / PERMILLE, 1.0)
        a_mm_s2 = settings.a_mm_s2 * max(settings.a_weight_down_permille / PERMILLE, 1.0)
        most_mm = v_mm_s * period_s + self._increment_mm + _ROUNDING_MM
        change_mm = a_mm_s2 * period_s**2 + 2.0 * self._increment_mm + _ROUNDING_MM
        is_too_fast = abs(step_mm) > max(most_mm, abs(last_mm))
        stops = abs(control.offset_mm) >= settings.max_deviation_mm and step_mm * last_mm > 0.0
        is_too_hard = abs(step_mm - last_mm) > change_mm and not (
            step_mm == 0.0 or (stops and abs(step_mm) < abs(last_mm))
        )
        if is_too_fast or is_too_hard:
            speed, a = step_mm / period_s, (step_mm - last_mm) / period_s**2
            what = f"{speed:.6g} mm/s, {a:.6g} mm/s2"
            allowed = f"{v_mm_s:.6g} mm/s and {a_mm_s2:.6g} mm/s2"
            control.offset_mm = before_mm
            control.fail(Alarm(PASSED, owner=control.owner, what=what, allowed=allowed))
        self._last_step_mm = step_mm

    @property
    def pending_mm(self) -> float:
        """The offset that is sent in this cycle."""
        return self.control.offset_mm if self._is_optimized else self._before_mm

    def put_out(self) -> float:
        """Return the offset of this cycle. To be called once per cycle, after everything else."""
        self.output_mm = self.pending_mm
        self._before_mm = self.control.offset_mm
        return self.output_mm

    def hand_over(self) -> Mapping[str, float]:
        """Return by axis what positions take over: no offset is left."""
        raise NotImplementedError

    def forget_offset(self) -> None:
        """The interpolated position has taken the offset over: none is on its way any more."""
        self.output_mm = self._before_mm = self.control.offset_mm


def source_word(sensor: Sensor) -> str:
    """Name a sensor: SECOND_ENCODER, or VARIABLE with its name."""
    if isinstance(sensor, VariableSensor):
        name = sensor.name if sensor.name.startswith("V.") else f"V.E.{sensor.name}"
        return f"VARIABLE {name}" if sensor.name else "VARIABLE without SENSOR_VAR"
    return sensor.source
