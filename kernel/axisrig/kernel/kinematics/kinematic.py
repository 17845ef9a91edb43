"""What every kinematic offers (docs/kinematics.md).

A kinematic works on the first axes of its channel. Axis positions and tool coordinates are tuples
of the same length, in mm and degrees: x, y, z of the tool centre point (TCP), then the orientation
in the coordinates that a program writes.
"""

import math
from collections.abc import Callable

Positions = tuple[float, ...]
Vector = tuple[float, float, float]


def between(start: Positions, end: Positions, share: float) -> Positions:
    """Give the place after a share of the straight way from one place to another."""
    return tuple([a + (b - a) * share for a, b in zip(start, end, strict=True)])


class Kinematic:
    """Forward and inverse of one chain of axes; what it has to provide raises NotImplementedError.

    name: as `#KIN ID` chooses it. count: how many axes it needs. rotary: which of them are rotary.
    axes: their names where the kinematic has some. A compiled class takes no abstract base.
    """

    def __init__(self, name: str, rotary: tuple[bool, ...], axes: tuple[str, ...] = ()) -> None:
        self.name, self.count = name, len(rotary)
        self.rotary, self.axes = rotary, axes

    def forward(self, axes: Positions) -> Positions:
        """Give the tool coordinates of axis positions, both of shape (count,), mm and degrees."""
        raise NotImplementedError

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give the axis positions of tool coordinates, the solution nearest to `near`.

        Raises Alarm for a place out of reach and for a singular pose.
        """
        raise NotImplementedError

    def direction(self, tool: Positions) -> Vector:
        """Give the unit vector from the TCP to the tool clamping point, machine coordinates."""
        raise NotImplementedError

    def length_mm(self, tool: Positions) -> float:
        """Give the distance of the clamping point from the TCP, virtually extended or not."""
        raise NotImplementedError

    def nominal_length_mm(self, tool: Positions) -> float:
        """Give the length of the tool as its data has it, never extended."""
        return self.length_mm(tool)

    def kinks(self, start: Positions, end: Positions) -> tuple[float, ...]:
        """Give where the axes would change their speed at once on a straight way of the tool.

        They are shares of the way, above 0 and below 1 and in their order.
        """
        return self.kinks_along(lambda share: between(start, end, share))

    def kinks_along(self, place: Callable[[float], Positions]) -> tuple[float, ...]:
        """Give them of any way; place: gives the tool by the share. Here there are none."""
        return ()

    def tilt_deg(self, tool: Positions) -> float:
        """Give the angle between the tool and Z of the machine, 0 to 180 degrees."""
        x, y, z = self.direction(tool)
        return math.degrees(math.atan2(math.hypot(x, y), z))

    def clamp_mm(self, tool: Positions) -> Vector:
        """Give the tool clamping point, machine coordinates in mm."""
        length_mm, u = self.length_mm(tool), self.direction(tool)
        return (
            tool[0] + length_mm * u[0],
            tool[1] + length_mm * u[1],
            tool[2] + length_mm * u[2],
        )
