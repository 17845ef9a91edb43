"""Kinematic transformations: from the axes of a machine to the tool, and back (docs/kinematics.md).

Axis positions and tool coordinates are tuples of the same length in mm and degrees.
"""

from axisrig.kernel.kinematics.head import HeadCA
from axisrig.kernel.kinematics.kinematic import Kinematic, Vector

__all__ = ["HeadCA", "Kinematic", "Vector"]
