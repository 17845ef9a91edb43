"""What the channel takes from the parameter lists for its distance controls."""

from dataclasses import dataclass, field

from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.distance import DistanceSettings
from axisrig.kernel.distance.filters.build import OF_CHANNEL
from axisrig.kernel.distance.law import USUAL_LAW, DistanceLaw
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
    def read(
        cls, axis: ParameterSet, law: DistanceLaw = USUAL_LAW
    ) -> "AxisDistanceSettings | None":
        """Take the settings from the parameters of an axis; None where it is not released.

        law: choices of the rig.
        """
        if not axis.flag("lr_param.distance_control_on"):
            return None
        return cls(
            control=DistanceSettings.read(axis, law=law),
            sensor=SensorSettings.read(axis),
            is_optimized=axis.flag("kenngr.dist_ctrl[0].optimized_scheduling"),
            checks_limits=axis.flag("kenngr.dist_ctrl[0].check_sw_limit_switch"),
        )


RELEASED = "FCT_3D_DIST_CTRL"


@dataclass(frozen=True)
class ChannelDistanceSettings:
    """What the channel needs for 3D distance control.

    ref_offset_mm: P-CHAN-00805, the distance that the PLC gives where the tool touches the surface.
    is_optimized: P-CHAN-00818. checks_limits: P-CHAN-00809, software limit switches count what the
    offset moves. is_licensed: the option is there, else 21837.
    """

    control: DistanceSettings
    ref_offset_mm: float = 0.0
    is_optimized: bool = False
    checks_limits: bool = False
    is_licensed: bool = True

    @classmethod
    def read(
        cls, channel: ParameterSet, law: DistanceLaw = USUAL_LAW, *, is_licensed: bool = True
    ) -> "ChannelDistanceSettings | None":
        """Take the settings from the parameters of the channel; None without P-CHAN-00500.

        law: choices of the rig.
        """
        if channel.word("configuration.decoder.function") != RELEASED:
            return None
        return cls(
            control=DistanceSettings.read(channel, OF_CHANNEL, law),
            ref_offset_mm=channel.mm(f"{OF_CHANNEL}ref_offset"),
            is_optimized=channel.flag(f"{OF_CHANNEL}optimized_scheduling"),
            checks_limits=channel.flag(f"{OF_CHANNEL}check_sw_limit_switch"),
            is_licensed=is_licensed,
        )
