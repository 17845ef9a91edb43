"""Distance control of one axis: its sensor, its control, and the cycle in which the offset goes."""

from collections.abc import Mapping

from axisrig.kernel.channel.distance.sensing import Sensing
from axisrig.kernel.channel.distance.sensor import VARIABLE, EncoderSensor, Sensor, VariableSensor
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceControl, Reading
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.plc.unit import Refreshed, UnitState
from axisrig.kernel.time.clock import TimeNs


class AxisDistance(Sensing):
    """Distance control of one axis.

    values: V.E. variables, by the name after `V.E.`. refreshed: those that come with a period.
    """

    def __init__(
        self,
        link: Drive,
        settings: AxisDistanceSettings,
        values: Mapping[str, float],
        refreshed: Mapping[str, Refreshed],
        period_ns: TimeNs,
    ) -> None:
        self.name, self.settings = link.name, settings
        self._link, self._values, self._refreshed = link, values, refreshed
        self._encoder = EncoderSensor(link, settings.sensor)
        super().__init__(
            DistanceControl(f"axis {link.name}", settings.control, period_ns),
            self._encoder,
            period_ns,
            link.settings.sensor_age_limit_ms,
            is_optimized=settings.is_optimized,
            increment_mm=1.0 / link.settings.increments_per_mm,
        )

    def sensor_for(self, source: str, variable: str | None) -> Sensor:
        """Return the second encoder, or a variable of the PLC side."""
        if source != VARIABLE:
            return self._encoder
        settings = self.settings.sensor
        return VariableSensor(variable or "", self._values, settings, self._refreshed)

    def step(self) -> None:
        """Control with the values of this cycle; raises the alarms of the control."""
        if self.sensor_mm is None:
            return
        link = self._link
        held, override = self.is_held, self.override
        reading = Reading(
            self.sensor_mm, link.actual_mm, link.set_mm, held, self.silence(), override
        )
        self.control_within_limits(reading)

    def hand_over(self) -> Mapping[str, float]:
        """Return the offset that is sent in this cycle: none is left."""
        kept = {self.name: self.pending_mm}
        self.control.hand_over()
        self.forget_offset()
        return kept

    def show(self, state: UnitState) -> None:
        """Show the PLC what there is."""
        control = self.control
        state.state, state.source = control.state, control.source
        state.actual_offset_mm = control.offset_mm
        if control.has_read:
            state.surface_mm, state.distance_mm = control.surface_mm, control.distance_mm
