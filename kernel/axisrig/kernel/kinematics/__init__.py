"""Kinematic transformations: from the axes of a machine to the tool, and back (docs/kinematics.md).

Axis positions and tool coordinates are tuples of the same length in mm and degrees.
"""

from axisrig.kernel.kinematics.build import build, check_axes, check_known
from axisrig.kernel.kinematics.coupled import OnLinearAxes
from axisrig.kernel.kinematics.data import KinematicData, Trafo
from axisrig.kernel.kinematics.extension import ExtendedTool
from axisrig.kernel.kinematics.head import HeadCA
from axisrig.kernel.kinematics.kinematic import Kinematic, Vector
from axisrig.kernel.kinematics.robot import ArticulatedRobot
from axisrig.kernel.kinematics.table import KinematicType, Offset, kinematic_types, offsets
from axisrig.kernel.kinematics.universal import ChainAxis, Universal

__all__ = [
    "ArticulatedRobot",
    "ChainAxis",
    "ExtendedTool",
    "HeadCA",
    "Kinematic",
    "KinematicData",
    "KinematicType",
    "Offset",
    "OnLinearAxes",
    "Trafo",
    "Universal",
    "Vector",
    "build",
    "check_axes",
    "check_known",
    "kinematic_types",
    "offsets",
]
