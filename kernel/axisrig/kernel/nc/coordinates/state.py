"""What a stack of coordinate systems consists of and gives: levels, axes, arcs, measured values."""

from collections.abc import Mapping
from dataclasses import dataclass

from axisrig.kernel.nc.coordinates.circle import PlaneArc
from axisrig.kernel.nc.coordinates.frames import Frame
from axisrig.kernel.nc.coordinates.shifts import Shifts


@dataclass
class Level:
    """One coordinate system of the stack with the shifts programmed in it, by axis.

    own: relative to the shifted system below. frame: down to the axes. zero_group: G54 is 1.
    """

    own: Frame
    frame: Frame
    carried_mm: dict[str, float]
    zero_mm: dict[str, float]
    reference_mm: dict[str, float]
    measurement_mm: dict[str, float]
    zero_group: int = 0

    @classmethod
    def begin(cls, own: Frame, frame: Frame, carried_mm: dict[str, float]) -> "Level":
        """Make a level in which no shift has been programmed yet."""
        none = dict.fromkeys(carried_mm, 0.0)
        return cls(own, frame, carried_mm, none, dict(none), dict(none))


@dataclass
class AxisState:
    """Where one axis is in the active coordinate system, and how it got there.

    absolute_mm: ABS. shifts: those that were in effect when it was programmed absolutely.
    programmed_mm: PCS of the last block that programmed it.
    """

    absolute_mm: float
    shifts: Shifts
    programmed_mm: float


@dataclass(frozen=True)
class Measured:
    """The values of one axis after a measuring run, in mm; see `variables.csv`."""

    acs_mm: float
    mess_mm: float
    pcs_mm: float
    offset_mm: float


@dataclass(frozen=True)
class Arc:
    """An arc in BASE; the fields are those of `canon.ArcMove`.

    plane: the same in the plane of the active coordinate system, in ABS.
    """

    target_mm: Mapping[str, float]
    centre_mm: Mapping[str, float]
    tangent: Mapping[str, float]
    angle_rad: float
    plane: PlaneArc
