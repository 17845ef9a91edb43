"""Where an axis gets the distance from: the second encoder of its drive, or a variable of the PLC.

Both give millimetres in the convention of distance control: the value counts against the motor, it
falls when the tool lifts. Sources: P-AXIS-00230, 00418, 00422 to 00424; FCT-M3 5 and 12.8.4.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.plc.unit import Refreshed
from axisrig.kernel.time.clock import TimeNs

SECOND_ENCODER: Final = "SECOND_ENCODER"
VARIABLE: Final = "VARIABLE"
COUNTS: Final = 1 << 32  # of 60E4:1, after which it begins anew
LINEAR, MODULO = 1, 2
PERIODS_MAX: Final = 3
"""So many of its periods a sensor may be silent, where the rig says no other limit."""


@dataclass(frozen=True)
class SensorSettings:
    """How the sensor of an axis counts.

    numerator, denominator: P-AXIS-00422 and 00423, so many increments are so many 0.1 um.
    is_modulo: P-AXIS-00424. is_inverted: P-AXIS-00230. ref_offset_mm: P-AXIS-00418.
    """

    numerator: int = 1
    denominator: int = 1
    is_modulo: bool = False
    is_inverted: bool = False
    ref_offset_mm: float = 0.0

    @classmethod
    def read(cls, axis: ParameterSet) -> "SensorSettings":
        """Take the settings from the parameters of an axis."""
        mode = axis.integer("lr_hw[1].mode_act_pos")
        return cls(
            numerator=axis.integer("lr_hw[1].encoder_resolution_num"),
            denominator=axis.integer("lr_hw[1].encoder_resolution_denom"),
            is_modulo=mode == MODULO or (mode != LINEAR and axis.is_rotary),
            is_inverted=axis.flag("lr_hw[1].vz_istw"),
            ref_offset_mm=axis.mm("kenngr.dist_ctrl[0].ref_offset"),
        )


class EncoderSensor:
    """The second encoder: 60E4:1 of the SYNC that the actual position is of.

    A modulo encoder counts on where its 32 bits begin anew (P-AXIS-00424); between two values that
    come it must turn by less than half of them.
    """

    source: ClassVar[str] = SECOND_ENCODER

    def __init__(self, link: Drive, settings: SensorSettings) -> None:
        self._link, self._settings = link, settings
        self._count: int | None = None

    def period_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often the drive promises a value, None where it promises nothing."""
        return self._link.second_period_ns(cycle_ns)

    @property
    def age_cycles(self) -> int:
        """NC cycles since a telegram has delivered a value."""
        return self._link.second_age_cycles

    @property
    def exists(self) -> bool:
        """Whether the drive sends a second encoder."""
        return self._link.has_second

    def read_mm(self) -> float | None:
        """Return the sensor value, None until the drive has sent one. To be called every cycle."""
        count = self._link.second_increments
        if count is None:
            return None
        settings = self._settings
        if settings.is_modulo and self._count is not None:
            turned = (count - self._count + COUNTS // 2) % COUNTS - COUNTS // 2
            count = self._count + turned
        self._count = count
        value_mm = count * settings.denominator / (settings.numerator * UNITS_PER_MM)
        return (-value_mm if settings.is_inverted else value_mm) - settings.ref_offset_mm


class VariableSensor:
    """A V.E. variable in 0.1 um, which the PLC has normalised: it has its sign and resolution.

    name: as a program writes it, with or without `V.E.`. values: of the PLC, by the name after it.
    refreshed: those of them that come with a period.
    """

    source: ClassVar[str] = VARIABLE

    def __init__(
        self,
        name: str,
        values: Mapping[str, float],
        settings: SensorSettings,
        refreshed: Mapping[str, Refreshed] | None = None,
    ) -> None:
        self.name = name.removeprefix("V.E.")
        self._values, self._ref_offset_mm = values, settings.ref_offset_mm
        self._refreshed = {} if refreshed is None else refreshed

    def period_ns(self, _cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often the PLC promises a value, None where it promises nothing."""
        found = self._refreshed.get(self.name)
        return None if found is None else found.period_ns

    @property
    def age_cycles(self) -> int:
        """NC cycles since the PLC has delivered a value; 0 for one that has no age."""
        found = self._refreshed.get(self.name)
        return 0 if found is None else found.age_cycles

    @property
    def exists(self) -> bool:
        """Whether the PLC has such a variable."""
        return self.name in self._values

    def read_mm(self) -> float | None:
        """Return the sensor value, None without the variable."""
        value = self._values.get(self.name)
        return None if value is None else value / UNITS_PER_MM - self._ref_offset_mm


Sensor = EncoderSensor | VariableSensor
