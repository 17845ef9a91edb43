"""Kinematic 91: any chain of three linear and up to three rotary axes, as lists describe it.

Each axis has a direction and, if rotary, a point, both with all axes at 0. The chain begins at the
machine base: TCP = T1(q1) T2(q2) ... applied to the zero position, u the same without shifts. A
program writes x, y, z of the TCP and the rotary axes themselves (rtcp). Source: TF5240 universal
kinematic 278674827, 278739211, 278732555; what they leave open: docs/ambiguities.md.
"""

import math
from collections.abc import Sequence
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics.kinematic import Kinematic, Positions, Vector
from axisrig.kernel.kinematics.rotation import IDENTITY, Rotation, about, product, turned

LINEAR: Final = 3  # so many linear axes, and they come first
SINGULAR: Final = 1e-9  # volume of the directions of the linear axes


class ChainAxis:
    """One axis; direction: unit vector. point: on a rotary axis, in mm."""

    def __init__(self, is_rotary: bool, direction: Vector, point: Vector) -> None:
        self.is_rotary, self.direction, self.point = is_rotary, direction, point


class Universal(Kinematic):
    """axes: as the channel has them, linear ones first. chain: their order from the base on.

    zero_mm: where the tool is with all axes at 0, without its length. zero_direction: u there, a
    unit vector.
    """

    def __init__(
        self,
        axes: Sequence[ChainAxis],
        chain: Sequence[int],
        zero_mm: Vector,
        zero_direction: Vector,
        tool_mm: float,
        name: str = "91",
    ) -> None:
        super().__init__(name, tuple([axis.is_rotary for axis in axes]))
        self._chain = [(place, axes[place]) for place in chain]
        self._u, self._tool_mm = zero_direction, tool_mm
        u = zero_direction
        self._zero: Vector = (
            zero_mm[0] - tool_mm * u[0],
            zero_mm[1] - tool_mm * u[1],
            zero_mm[2] - tool_mm * u[2],
        )

    def forward(self, axes: Positions) -> Positions:
        """Give x, y, z of the TCP in mm, then the rotary axes in degrees."""
        return (*self._tcp(axes), *axes[LINEAR:])

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give the axes: rotary ones are given, linear ones follow from three equations."""
        x, y, z = self._tcp((0.0, 0.0, 0.0, *tool[LINEAR:]))
        a, b, c = self._ways(tool)
        det = _volume(a, b, c)
        if abs(det) < SINGULAR:
            pose = " ".join(f"{value:.4f}" for value in tool)
            reason = "its linear axes move in one plane only"
            raise Alarm(292016, name=self.name, pose=pose, reason=reason)
        d = (tool[0] - x, tool[1] - y, tool[2] - z)
        linear = (_volume(d, b, c) / det, _volume(a, d, c) / det, _volume(a, b, d) / det)
        return (*linear, *tool[LINEAR:])

    def direction(self, tool: Positions) -> Vector:
        """Give u; it depends on the rotary axes alone."""
        r = IDENTITY
        for place, axis in self._chain:
            if axis.is_rotary:
                r = product(r, about(axis.direction, tool[place]))
        return turned(r, self._u)

    def length_mm(self, tool: Positions) -> float:
        """Give the length of the tool."""
        return self._tool_mm

    def _tcp(self, axes: Positions) -> Vector:
        x, y, z = self._zero
        for place, axis in reversed(self._chain):
            if axis.is_rotary:
                px, py, pz = axis.point
                way = turned(about(axis.direction, axes[place]), (x - px, y - py, z - pz))
                x, y, z = px + way[0], py + way[1], pz + way[2]
            else:
                q, d = axes[place], axis.direction
                x, y, z = x + q * d[0], y + q * d[1], z + q * d[2]
        return (x, y, z)

    def _ways(self, tool: Positions) -> list[Vector]:
        """Give how the TCP moves with each linear axis, by their place in the channel."""
        ways: list[Vector] = [(0.0, 0.0, 0.0)] * LINEAR
        r: Rotation = IDENTITY
        for place, axis in self._chain:
            if axis.is_rotary:
                r = product(r, about(axis.direction, tool[place]))
            else:
                ways[place] = turned(r, axis.direction)
        return ways


def unit(v: Vector) -> Vector | None:
    """Return a vector of length 1, None for one without direction."""
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if length == 0.0:
        return None
    return (v[0] / length, v[1] / length, v[2] / length)


def _volume(a: Vector, b: Vector, c: Vector) -> float:
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
