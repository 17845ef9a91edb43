"""What the channel takes from the parameter list of an axis for its distance control."""

from dataclasses import dataclass, field

from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.distance import DistanceSettings
from axisrig.kernel.parameters import ParameterSet


@dataclass(frozen=True)
class AxisDistanceSettings:
    """What an axis needs for its distance control.

    is_optimized: P-AXIS-00509, the offset is sent in the cycle that has computed it, not in the
    next one. checks_limits: P-AXIS-00428, software limit switches count the offset.
    """

    control: DistanceSettings
    sensor: SensorSettings = field(default_factory=SensorSettings)
    is_optimized: bool = False
    checks_limits: bool = False

    @classmethod
    def read(cls, axis: ParameterSet) -> "AxisDistanceSettings | None":
        """Take the settings from the parameters of an axis; None where it is not released."""
        if not axis.flag("lr_param.distance_control_on"):
            return None
        return cls(
            control=DistanceSettings.read(axis),
            sensor=SensorSettings.read(axis),
            is_optimized=axis.flag("kenngr.dist_ctrl[0].optimized_scheduling"),
            checks_limits=axis.flag("kenngr.dist_ctrl[0].check_sw_limit_switch"),
        )
