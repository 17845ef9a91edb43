"""Control unit of the distance control of an axis on the HLI: MC_CONTROL_DISTANCE_CONTROL.

Sources: FCT-M3 8 and 10; TF5200 distance control 290206347 and 290209035. The manuals say
what the structures hold and not how it is named: these names, and 0.1 um as in FCT-M3 10, are ours.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from axisrig.bench.machine.plc.elements import SGN32, Kept, out_of_range, put, replaced, require
from axisrig.kernel.distance import DistanceCommand


@dataclass(slots=True)
class DistanceCommandElements(Kept):
    """HLI_DISTANCE_CONTROL_COMMAND; set_pos, set_dist in 0.1 um or 0.0001 deg.

    transition: one of HLI_DIST_CTRL_OFF, _ON, _FREEZE, _ON_CONST_DIST. None of an element leaves
    what is.
    """

    label: str = ""
    transition: int | None = None
    set_pos: int | None = None
    set_dist: int | None = None

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element. Raises UserError for another type, and for what is out of its range."""
        if element in ("transition", "set_pos", "set_dist") and value is not None:
            name = f"{self.label}.{element}"
            require(name, value, int)
            allowed = range(len(DistanceCommand)) if element == "transition" else SGN32
            if value not in allowed:
                raise out_of_range(name, value, allowed)
        put(self, element, value)


@dataclass(slots=True)
class DistanceStateElements(Kept):
    """HLI_DISTANCE_CONTROL_STATE; in 0.1 um or 0.0001 deg, 0 while nothing was sensed.

    state: one of HLI_DIST_CTRL_STATE_*. surface: actual position of the workpiece surface.
    distance: current distance. source: who commanded last, 0 the NC program, 1 the PLC.
    """

    state: int = 0
    surface: int = 0
    distance: int = 0
    source: int = 0
    actual_offset: int = 0


@dataclass(slots=True)
class DistanceControlUnit(Kept):
    """MC_CONTROL_DISTANCE_CONTROL: commands the distance control of an axis.

    command_semaphor_rw: the PLC sets it with a command, and the CNC takes it back when it has taken
    the command; what is changed meanwhile does not count. enable_w: without it commands wait.
    """

    label: str = ""
    enable_w: bool = False
    command_semaphor_rw: bool = False
    command_w: DistanceCommandElements = field(default_factory=DistanceCommandElements)
    state_r: DistanceStateElements = field(default_factory=DistanceStateElements)

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element. Raises UserError for one that a program sets to another type."""
        if element in ("enable_w", "command_semaphor_rw"):
            require(f"{self.label}.{element}", value, bool)
        kind = _STRUCTURES.get(element)
        if kind is not None and type(value) is not kind:
            name = f"{self.label}.{element}"
            raise replaced(name, value, f"{name}.{kind.__slots__[-1]}")
        put(self, element, value)


_STRUCTURES: Mapping[str, Any] = {
    "command_w": DistanceCommandElements,
    "state_r": DistanceStateElements,
}
