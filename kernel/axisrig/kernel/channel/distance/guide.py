"""Where the offset of 3D distance control acts: along which direction, and on which axes.

The offset o of the channel is one number. It counts along the normal n of the surface; the tool
moves by o / cos b along a direction, b between direction and n:

ACS  one axis, which is n as well: as the control of that axis
MCS  along n, which is Z of the active #CS, else of the machine
ECS  along the tool, u from the TCP to the clamping point

so that o always is the change of the distance (FCT-M3 12.4.3; docs/ambiguities.md). Positions are
those of all axes of the channel, mm and degrees.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.kernel.kinematics import Kinematic, Vector

Positions = tuple[float, ...]

ACS, ECS, MCS = "ACS", "ECS", "MCS"
MODES = (ACS, ECS, MCS)
STEEPEST_DEG: Final = 85.0
"""Largest angle between tool and normal in ECS: an axis moves there by 11.5 times the offset."""
LEAST_COSINE = math.cos(math.radians(STEEPEST_DEG))
# Displacement for a rate: large against the rounding of positions, small against any lever
PROBE_MM: Final = 1e-3
# What the way through the kinematic leaves of a position that does not change
ROUNDING_MM: Final = 1e-9


class Guide:
    """What both kinds of guide offer. mode: as a program names it. axes: those it can move."""

    def __init__(self, mode: str, axes: Sequence[str]) -> None:
        self.mode, self.axes = mode, tuple(axes)

    def is_same(self, other: "Guide") -> bool:
        """Whether both move the same axes in the same way."""
        raise NotImplementedError

    def height_mm(self, positions: Positions) -> float:
        """Return where the clamping point is along the normal."""
        raise NotImplementedError

    def cosine(self, positions: Positions) -> float:
        """Return the cosine of the angle between direction and normal."""
        raise NotImplementedError

    def shortening(self, positions: Positions) -> float:
        """Return the distance of the clamping point as a share of SET_DIST, without an error."""
        raise NotImplementedError

    def superposed(self, positions: Positions, offset_mm: float) -> Positions:
        """Return where the axes are with an offset.

        Raises Alarm of the kinematic for a place out of reach and a singular pose.
        """
        raise NotImplementedError

    def rates(self, positions: Positions) -> tuple[float, ...]:
        """Return by how much each of `axes` moves for one mm of offset, mm/mm or degrees/mm."""
        raise NotImplementedError


class AxisGuide(Guide):
    """ACS: one axis moves, `index` of the positions."""

    def __init__(self, axis: str, index: int) -> None:
        super().__init__(ACS, (axis,))
        self._index = index

    def is_same(self, other: Guide) -> bool:
        """Whether it is the same axis."""
        return other.mode == ACS and other.axes == self.axes

    def height_mm(self, positions: Positions) -> float:
        """Return the position of the axis: the surface is where it counts."""
        return positions[self._index]

    def cosine(self, positions: Positions) -> float:
        """Return 1: the axis is the normal."""
        return 1.0

    def shortening(self, positions: Positions) -> float:
        """Return 1: nobody knows of an inclined tool."""
        return 1.0

    def superposed(self, positions: Positions, offset_mm: float) -> Positions:
        """Add the offset to the axis."""
        at = self._index
        return (*positions[:at], positions[at] + offset_mm, *positions[at + 1 :])

    def rates(self, positions: Positions) -> tuple[float, ...]:
        """Return one mm for one mm."""
        return (1.0,)


class ToolGuide(Guide):
    """MCS and ECS: the tool moves, and with it all axes of a kinematic.

    names: of all axes of the channel, those of the kinematic first. normal: unit vector n.
    origin_mm: from where SET_POS counts. Both in the coordinates of the machine.
    """

    def __init__(
        self,
        mode: str,
        kinematic: Kinematic,
        names: Sequence[str],
        normal: Vector,
        origin_mm: Vector,
    ) -> None:
        super().__init__(mode, names[: kinematic.count])
        self.kinematic, self.normal, self.origin_mm = kinematic, normal, origin_mm

    def is_same(self, other: Guide) -> bool:
        """Whether mode, kinematic and coordinate system are the same."""
        return (
            isinstance(other, ToolGuide)
            and other.mode == self.mode
            and other.kinematic is self.kinematic
            and other.normal == self.normal
            and other.origin_mm == self.origin_mm
        )

    def height_mm(self, positions: Positions) -> float:
        """Return n times the clamping point, from the origin of the coordinate system."""
        clamp_mm = self.kinematic.clamp_mm(self._tool(positions))
        origin_mm = self.origin_mm
        return _dot(
            self.normal,
            (
                clamp_mm[0] - origin_mm[0],
                clamp_mm[1] - origin_mm[1],
                clamp_mm[2] - origin_mm[2],
            ),
        )

    def cosine(self, positions: Positions) -> float:
        """Return the cosine of the angle between direction and normal; 1 in MCS."""
        return 1.0 if self.mode == MCS else self._leaning(self._tool(positions))

    def shortening(self, positions: Positions) -> float:
        """Return L2 / L times the cosine of the tilt of the tool to the normal (FCT-M3 12.1.2)."""
        tool = self._tool(positions)
        length_mm = self.kinematic.nominal_length_mm(tool)
        stretched = self.kinematic.length_mm(tool) / length_mm if length_mm else 1.0
        return stretched * self._leaning(tool)

    def superposed(self, positions: Positions, offset_mm: float) -> Positions:
        """Move the tool and let its axes follow; an axis that does not move keeps its bits."""
        count = self.kinematic.count
        near = positions[:count]
        tool = self.kinematic.forward(near)
        x, y, z = self._way(tool)
        moved = (
            tool[0] + offset_mm * x,
            tool[1] + offset_mm * y,
            tool[2] + offset_mm * z,
            *tool[3:],
        )
        found = self.kinematic.inverse(moved, near)
        kept = (
            before if abs(after - before) < ROUNDING_MM else after
            for before, after in zip(near, found, strict=True)
        )
        return (*kept, *positions[count:])

    def rates(self, positions: Positions) -> tuple[float, ...]:
        """Return the rates by a small displacement."""
        moved = self.superposed(positions, PROBE_MM)
        return tuple(
            (after - before) / PROBE_MM
            for before, after in zip(positions, moved[: len(self.axes)], strict=False)
        )

    def _tool(self, positions: Positions) -> Positions:
        return self.kinematic.forward(positions[: self.kinematic.count])

    def _leaning(self, tool: Positions) -> float:
        return _dot(self.kinematic.direction(tool), self.normal)

    def _way(self, tool: Positions) -> Vector:
        """Return the way of the tool for one mm of offset, bounded at the steepest angle."""
        if self.mode == MCS:
            return self.normal
        x, y, z = self.kinematic.direction(tool)
        cosine = max(_dot((x, y, z), self.normal), LEAST_COSINE)
        return (x / cosine, y / cosine, z / cosine)


class StayingGuide(ToolGuide):
    """The offset of a kinematic that has gone: it stays on its axes, and turns with nothing.

    left: where it acted until then. offset_mm, deltas_mm: what was sent last, and by axis what that
    superposed. Another offset, as one that runs out, moves each axis by its share of them.
    """

    def __init__(
        self,
        left: ToolGuide,
        offset_mm: float,
        names: Sequence[str],
        deltas_mm: Mapping[str, float],
    ) -> None:
        super().__init__(left.mode, left.kinematic, names, left.normal, left.origin_mm)
        self._offset_mm = offset_mm
        self._deltas_mm = tuple(deltas_mm.get(name, 0.0) for name in names)

    def is_same(self, other: Guide) -> bool:
        """Whether it is this one: an offset goes on by it nowhere else."""
        return other is self

    def cosine(self, positions: Positions) -> float:
        """Return 1: the tool may lean as it likes."""
        return 1.0

    def superposed(self, positions: Positions, offset_mm: float) -> Positions:
        """Add to each axis what it had, or its share of that."""
        if not self._offset_mm:
            return positions
        share = offset_mm / self._offset_mm
        pairs = zip(positions, self._deltas_mm, strict=True)
        return tuple(before + share * delta for before, delta in pairs)


def _dot(one: Vector, other: Vector) -> float:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
