"""Kinematic 9: a head with the rotary axes C and A on three linear axes, X Y Z C A.

With c = C + HD4 and a = A + HD3 the tool points from the TCP to its clamping point along
u = Rz(c) Rx(a) e_z, right-handed about +Z and +X (ISO 841), and

TCP = (X, Y, Z) + (HD7, HD8, 0) + Rz(c) [(HD6, HD5, -HD2) + Rx(a) (0, HD9, -(HD1 + L))]

with the tool length L. Source of the offsets: ISG kernel, KIN_TYP_9 (292664715); signs and zero
pose: docs/ambiguities.md.
"""

import math
from collections.abc import Sequence

from axisrig.kernel.kinematics.kinematic import Kinematic, Positions, Vector


class HeadCA(Kinematic):
    """The head; offsets: HD1 to HD9 in mm and degrees, missing ones are 0."""

    def __init__(
        self,
        offsets: Sequence[float],
        tool_mm: float,
        name: str = "9",
        axes: tuple[str, ...] = ("X", "Y", "Z", "C", "A"),
    ) -> None:
        super().__init__(name, (False, False, False, True, True), axes)
        self._hd = (*offsets, *(0.0,) * (9 - len(offsets)))
        self._tool_mm = tool_mm

    def forward(self, axes: Positions) -> Positions:
        """Give x, y, z of the TCP in mm, C and A in degrees."""
        x, y, z, c, a = axes
        dx, dy, dz = self._lever_mm(c, a)
        return (x + dx, y + dy, z + dz, c, a)

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give X, Y, Z in mm, C and A in degrees; every pose has one solution."""
        x, y, z, c, a = tool
        dx, dy, dz = self._lever_mm(c, a)
        return (x - dx, y - dy, z - dz, c, a)

    def direction(self, tool: Positions) -> Vector:
        """Give u; it depends on C and A alone."""
        c, a = math.radians(tool[3] + self._hd[3]), math.radians(tool[4] + self._hd[2])
        sine = math.sin(a)
        return (math.sin(c) * sine, -math.cos(c) * sine, math.cos(a))

    def length_mm(self, tool: Positions) -> float:
        """Give the length of the tool."""
        return self._tool_mm

    def _lever_mm(self, c_deg: float, a_deg: float) -> Vector:
        """Give the way from (X, Y, Z) of the axes to the TCP."""
        hd1, hd2, hd3, hd4, hd5, hd6, hd7, hd8, hd9 = self._hd
        c, a = math.radians(c_deg + hd4), math.radians(a_deg + hd3)
        cos_c, sin_c, cos_a, sin_a = math.cos(c), math.sin(c), math.cos(a), math.sin(a)
        down_mm = hd1 + self._tool_mm
        x = hd6
        y = hd5 + hd9 * cos_a + down_mm * sin_a
        z = -hd2 + hd9 * sin_a - down_mm * cos_a
        return (hd7 + cos_c * x - sin_c * y, hd8 + sin_c * x + cos_c * y, z)
