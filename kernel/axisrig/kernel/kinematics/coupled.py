"""Kinematic 210: the robot 45 on one or two linear axes, a group of two stacked kinematics.

The channel has the six joints of the robot and then the linear axes. With constants of the lists
TCP = origin + sum q_k d_k + F (TCP of the robot), R = F (frame of its tool).

A program writes x, y, z, A, B, C of the TCP and a coordinate for each linear axis. move_prio says
who takes a motion of the TCP: where the linear axes are first, the coordinate of one is its
position less the coordinate of the TCP along it, so that it goes with the TCP; where the robot is
first, or for an axis that lock_dof holds, it is the position itself. What the robot cannot reach
then the nearest position of a linear axis makes up that is not locked. Source: TF5240 coupling
kinematics 654250123, 654197003, ISG kernel 654201995; decisions: docs/ambiguities.md.
"""

import math
from collections.abc import Sequence
from typing import Final

from axisrig.kernel.kinematics.kinematic import Kinematic, Positions, Vector
from axisrig.kernel.kinematics.robot import ArticulatedRobot
from axisrig.kernel.kinematics.rotation import (
    Rotation,
    angles_deg,
    from_angles,
    inverse,
    product,
    turned,
)

JOINTS: Final = 6
STEP_MM: Final = 1e-3  # the least step of the search for a place in reach
HALVINGS: Final = 60


class OnLinearAxes(Kinematic):
    """A robot on linear axes.

    ways: unit vectors of the linear axes in machine coordinates. origin_mm, frame: where the base
    of the robot is with them at 0. leads: whether an axis takes the motion of the TCP first.
    helps: whether it makes up for what the robot cannot reach.
    """

    def __init__(
        self,
        robot: ArticulatedRobot,
        ways: Sequence[Vector],
        origin_mm: Vector,
        frame: Rotation,
        leads: Sequence[bool],
        helps: Sequence[bool],
        name: str = "210",
    ) -> None:
        rotary = tuple([True] * JOINTS + [False] * len(ways))
        super().__init__(name, rotary, robot.axes)
        self._robot = robot
        self._ways = list(ways)
        self._origin_mm, self._frame = origin_mm, frame
        self._helps = list(helps)
        self._along = _along(self._ways, list(leads))

    def forward(self, axes: Positions) -> Positions:
        """Give x, y, z of the TCP, A, B, C of the tool and the coordinates of the linear axes."""
        place, r = self._robot.pose(axes)
        q = list(axes[JOINTS:])
        x, y, z = turned(self._frame, place)
        base = self._base(q)
        tcp = (x + base[0], y + base[1], z + base[2])
        own = [position - _dot(along, tcp) for position, along in zip(q, self._along, strict=True)]
        return (*tcp, *angles_deg(product(self._frame, r)), *own)

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give the joints of the robot and the linear axes."""
        tcp = (tool[0], tool[1], tool[2])
        r = product(inverse(self._frame), from_angles(tool[3], tool[4], tool[5]))
        q = [own + _dot(along, tcp) for own, along in zip(tool[JOINTS:], self._along, strict=True)]
        if self._excess_mm(tcp, r, q) > 0.0:
            q = self._within_reach(tcp, r, q)
        joints = self._robot.joints(self._seen(tcp, q), r, near[:JOINTS], tcp)
        return (*joints, *q)

    def direction(self, tool: Positions) -> Vector:
        """Give u, the third column of Rz(C) Ry(B) Rx(A)."""
        return self._robot.direction(tool)

    def length_mm(self, tool: Positions) -> float:
        """Give the length of the tool."""
        return self._robot.length_mm(tool)

    def _base(self, q: list[float]) -> Vector:
        x, y, z = self._origin_mm
        for position, way in zip(q, self._ways, strict=True):
            x, y, z = x + position * way[0], y + position * way[1], z + position * way[2]
        return (x, y, z)

    def _seen(self, tcp: Vector, q: list[float]) -> Vector:
        """Give the TCP as the robot sees it."""
        base = self._base(q)
        way = (tcp[0] - base[0], tcp[1] - base[1], tcp[2] - base[2])
        return turned(inverse(self._frame), way)

    def _excess_mm(self, tcp: Vector, r: Rotation, q: list[float]) -> float:
        return self._robot.excess_mm(self._seen(tcp, q), r)

    def _within_reach(self, tcp: Vector, r: Rotation, q: list[float]) -> list[float]:
        """Give the positions after the shortest motion of one axis that brings the robot there.

        Without one they stay, and the robot says that it cannot reach.
        """
        best, least = q, math.inf
        for axis, may_help in enumerate(self._helps):
            for sign in (1.0, -1.0):
                way = self._search(tcp, r, q, axis, sign) if may_help else math.inf
                if way < least:
                    best, least = _moved(q, axis, sign * way), way
        return best

    def _search(self, tcp: Vector, r: Rotation, q: list[float], axis: int, sign: float) -> float:
        """Give the way of an axis to the first place in reach, infinite without one.

        The excess falls at most as fast as the axis moves: a step as long as it passes nothing.
        """
        outside, inside = 0.0, 0.0
        excess = self._excess_mm(tcp, r, q)
        limit = excess + 2.0 * self._robot.reach_mm  # after that the robot is passed
        while excess > 0.0:
            outside = inside
            inside += max(excess, STEP_MM)
            if inside > limit:
                return math.inf
            excess = self._excess_mm(tcp, r, _moved(q, axis, sign * inside))
        for _ in range(HALVINGS):
            middle = 0.5 * (outside + inside)
            if self._excess_mm(tcp, r, _moved(q, axis, sign * middle)) > 0.0:
                outside = middle
            else:
                inside = middle
        return inside


def _moved(q: list[float], axis: int, way_mm: float) -> list[float]:
    moved = list(q)
    moved[axis] += way_mm
    return moved


def _along(ways: list[Vector], leads: list[bool]) -> list[Vector]:
    """Give the vectors whose product with the TCP is its coordinate along each axis that leads.

    Of two axes that lead, those of the plane that they span (dual vectors).
    """
    found: list[Vector] = [(0.0, 0.0, 0.0)] * len(ways)
    leading = [axis for axis, does in enumerate(leads) if does]
    if len(leading) == 1:
        found[leading[0]] = ways[leading[0]]
    elif len(leading) == 2:
        a, b = ways[leading[0]], ways[leading[1]]
        cosine = _dot(a, b)
        sine2 = 1.0 - cosine * cosine
        found[leading[0]] = _combined(a, b, cosine, sine2)
        found[leading[1]] = _combined(b, a, cosine, sine2)
    return found


def _combined(a: Vector, b: Vector, cosine: float, sine2: float) -> Vector:
    return (
        (a[0] - cosine * b[0]) / sine2,
        (a[1] - cosine * b[1]) / sine2,
        (a[2] - cosine * b[2]) / sine2,
    )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
