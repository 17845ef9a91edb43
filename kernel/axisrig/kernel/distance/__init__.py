"""Distance control as far as it is independent of the axis: filters, controller, limits, states."""

from axisrig.kernel.distance.control import DistanceControl, Reading
from axisrig.kernel.distance.law import Derivative, DerivativeOf, DistanceLaw, StepLimiter
from axisrig.kernel.distance.objects import ChannelObject, CncObject, channel_objects, objects
from axisrig.kernel.distance.settings import DistanceSettings, names_newer
from axisrig.kernel.distance.states import (
    FOLLOWING,
    DistanceCommand,
    DistanceState,
    Source,
    changes,
)
from axisrig.kernel.distance.supervision import Silence

__all__ = [
    "FOLLOWING",
    "ChannelObject",
    "CncObject",
    "Derivative",
    "DerivativeOf",
    "DistanceCommand",
    "DistanceControl",
    "DistanceLaw",
    "DistanceSettings",
    "DistanceState",
    "Reading",
    "Silence",
    "Source",
    "StepLimiter",
    "changes",
    "channel_objects",
    "names_newer",
    "objects",
]
