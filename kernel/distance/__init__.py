"""Distance control as far as it knows no axis: filters, controller, limits, states."""

from kernel.distance.control import DistanceControl, Reading
from kernel.distance.objects import CncObject, objects
from kernel.distance.settings import DistanceSettings, names_newer
from kernel.distance.states import FOLLOWING, DistanceCommand, DistanceState, Source, changes
from kernel.distance.supervision import Silence

__all__ = [
    "FOLLOWING",
    "CncObject",
    "DistanceCommand",
    "DistanceControl",
    "DistanceSettings",
    "DistanceState",
    "Reading",
    "Silence",
    "Source",
    "changes",
    "names_newer",
    "objects",
]
