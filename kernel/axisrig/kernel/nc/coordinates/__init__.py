"""Coordinate systems of a channel: shifts, tools, planes, circles; all in mm, degrees and ACS.

`Coordinates` leads a programmed position through every shift to the axes and a latched one back.
Nothing here reads NC text; docs/coordinates.md has the order of all shifts as one picture.
"""

from axisrig.kernel.nc.coordinates.circle import CircleWords, GeometryError
from axisrig.kernel.nc.coordinates.frames import MAIN_AXES, Frame
from axisrig.kernel.nc.coordinates.shifts import Shifts
from axisrig.kernel.nc.coordinates.stack import Coordinates
from axisrig.kernel.nc.coordinates.state import Arc, Measured
from axisrig.kernel.nc.coordinates.tables import OffsetTables
from axisrig.kernel.nc.coordinates.tools import Tool, Tools
from axisrig.kernel.nc.coordinates.zero_offsets import ZeroOffsets

__all__ = [
    "MAIN_AXES",
    "Arc",
    "CircleWords",
    "Coordinates",
    "Frame",
    "GeometryError",
    "Measured",
    "OffsetTables",
    "Shifts",
    "Tool",
    "Tools",
    "ZeroOffsets",
]
