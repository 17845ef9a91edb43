"""Kinematic 45: an articulated robot with six rotary axes and a spherical wrist.

In the zero pose the upper arm is along +Z, the forearm and the normal of the flange along +X. With
b2 = B1 + HD14 and b3 = B2 + HD15 the flange is at

Rz(C1) [(HD11, 0, HD7) + Ry(b2) (0, 0, HD8) + Ry(b2 + b3) (HD9, 0, -HD12)] + R_flange (HD10, 0, 0)
R_flange = Rz(C1) Ry(b2 + b3) Rx(A1) Ry(B3) Rx(A2)

and the frame of the tool is R = R_flange Ry(-90) Rz(HD6) Ry(HD5) Rx(HD4). Its z is the direction
from the TCP to the clamping point; HD1 to HD3 and the length of the tool lead from the flange to
the TCP. Source of the offsets: ISG kernel, KIN_TYP_45 (292852107, 478197515); signs and zero pose:
docs/ambiguities.md.
"""

import math
from collections.abc import Sequence
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics.kinematic import Kinematic, Positions, Vector
from axisrig.kernel.kinematics.rotation import (
    POLE,
    Rotation,
    about_x,
    about_y,
    about_z,
    angles_deg,
    from_angles,
    inverse,
    near_turn_deg,
    product,
    turned,
)

SHOULDER_MM: Final = 1e-10  # distance of the wrist from the axis of joint 1 below which C1 is free
REACH_MM: Final = 1e-9


class ArticulatedRobot(Kinematic):
    """The robot; offsets: HD1 to HD15 in mm and degrees, missing ones are 0.

    reach_mm: how far the wrist is from joint 1 at most.
    """

    def __init__(
        self,
        offsets: Sequence[float],
        tool_mm: float,
        name: str = "45",
        axes: tuple[str, ...] = ("X", "Y", "Z", "A", "B", "C"),
    ) -> None:
        super().__init__(name, (True,) * 6, axes)
        hd = (*offsets, *(0.0,) * (15 - len(offsets)))
        self._tool_mm = tool_mm
        self._base_mm, self._out_mm = hd[6], hd[10]
        self._zero2_deg, self._zero3_deg = hd[13], hd[14]
        self._upper_mm = hd[7]
        self._along_mm, self._down_mm = hd[8], hd[11]
        self._forearm_mm = math.hypot(hd[8], hd[11])
        self.reach_mm = abs(self._out_mm) + self._upper_mm + self._forearm_mm
        self._bend_deg = math.degrees(math.atan2(hd[11], hd[8]))
        tool = product(about_z(hd[5]), product(about_y(hd[4]), about_x(hd[3])))
        self._tool: Rotation = product(about_y(-90.0), tool)
        # From the wrist to the TCP in the frame of the flange
        clamp = turned(about_y(-90.0), (hd[1], hd[2], -hd[0]))
        length = turned(self._tool, (0.0, 0.0, -tool_mm))
        self._hand_mm: Vector = (
            hd[9] + clamp[0] + length[0],
            clamp[1] + length[1],
            clamp[2] + length[2],
        )

    def forward(self, axes: Positions) -> Positions:
        """Give x, y, z of the TCP in mm and A, B, C of the tool in degrees."""
        place, r = self.pose(axes)
        return (*place, *angles_deg(r))

    def inverse(self, tool: Positions, near: Positions) -> Positions:
        """Give the six joints in degrees, of eight solutions the nearest to `near`."""
        r = from_angles(tool[3], tool[4], tool[5])
        place = (tool[0], tool[1], tool[2])
        return self.joints(place, r, near, place)

    def direction(self, tool: Positions) -> Vector:
        """Give u, the third column of Rz(C) Ry(B) Rx(A)."""
        r = from_angles(tool[3], tool[4], tool[5])
        return (r[2], r[5], r[8])

    def length_mm(self, tool: Positions) -> float:
        """Give the length of the tool."""
        return self._tool_mm

    def pose(self, axes: Positions) -> tuple[Vector, Rotation]:
        """Give the TCP in mm and the frame of the tool."""
        b2 = axes[1] + self._zero2_deg
        b23 = b2 + axes[2] + self._zero3_deg
        base = about_z(axes[0])
        upper = turned(about_y(b2), (0.0, 0.0, self._upper_mm))
        lower = turned(about_y(b23), (self._along_mm, 0.0, -self._down_mm))
        wrist = turned(
            base, (self._out_mm + upper[0] + lower[0], 0.0, self._base_mm + upper[2] + lower[2])
        )
        hand = product(about_x(axes[3]), product(about_y(axes[4]), about_x(axes[5])))
        flange = product(product(base, about_y(b23)), hand)
        way = turned(flange, self._hand_mm)
        place = (wrist[0] + way[0], wrist[1] + way[1], wrist[2] + way[2])
        return place, product(flange, self._tool)

    def joints(self, place: Vector, r: Rotation, near: Positions, target: Vector) -> Positions:
        """Give the joints of a TCP in mm and a frame of the tool; raises Alarm as `inverse`.

        target: the TCP in machine coordinates, which an alarm shows.
        """
        flange = product(r, inverse(self._tool))
        wrist = self._wrist(place, flange)
        best: Positions = ()
        least = math.inf
        for c1_deg, out_mm in self._shoulders(wrist, near):
            for b2_deg, b3_deg in self._elbows(out_mm, wrist[2], target):
                for joints in self._hands(c1_deg, b2_deg, b3_deg, flange, near):
                    far = 0.0
                    for joint, other in zip(joints, near, strict=False):
                        far += (joint - other) * (joint - other)
                    if far < least:
                        best, least = joints, far
        if not best:
            excess_mm = self._excess_mm(wrist)
            reason = (
                f"the wrist would be {excess_mm:.4f} mm outside what upper arm and forearm reach,"
                f" {abs(self._upper_mm - self._forearm_mm):g} to"
                f" {self._upper_mm + self._forearm_mm:g} mm from joint 2"
            )
            raise Alarm(900443, name=self.name, pose=_written(target), reason=reason)
        return best

    def excess_mm(self, place: Vector, r: Rotation) -> float:
        """Give how far the wrist of a pose is out of reach, 0 inside.

        It changes at most as fast as the TCP moves.
        """
        return self._excess_mm(self._wrist(place, product(r, inverse(self._tool))))

    def _wrist(self, place: Vector, flange: Rotation) -> Vector:
        way = turned(flange, self._hand_mm)
        return (place[0] - way[0], place[1] - way[1], place[2] - way[2])

    def _excess_mm(self, wrist: Vector) -> float:
        least = math.inf
        out_mm = math.hypot(wrist[0], wrist[1])
        for signed_mm in (out_mm, -out_mm):
            d = math.hypot(signed_mm - self._out_mm, wrist[2] - self._base_mm)
            longest = d - (self._upper_mm + self._forearm_mm)
            shortest = abs(self._upper_mm - self._forearm_mm) - d
            least = min(least, max(longest, shortest, 0.0))
        return least

    def _shoulders(self, wrist: Vector, near: Positions) -> list[tuple[float, float]]:
        """Give C1 and how far out the wrist is then, in front and overhead."""
        out_mm = math.hypot(wrist[0], wrist[1])
        if out_mm < SHOULDER_MM:  # on the axis of joint 1: C1 stays, and the other way round
            return [(near[0], 0.0), (near[0] + 180.0, 0.0)]
        c1_deg = math.degrees(math.atan2(wrist[1], wrist[0]))
        return [(c1_deg, out_mm), (c1_deg + 180.0, -out_mm)]

    def _elbows(self, out_mm: float, height_mm: float, target: Vector) -> list[tuple[float, float]]:
        """Give b2 and b2 + b3, elbow up and down; empty out of reach.

        In the plane of the arm angles count from the horizontal downwards.
        """
        p, q = out_mm - self._out_mm, self._base_mm - height_mm
        d = math.hypot(p, q)
        long_mm, short_mm = self._upper_mm + self._forearm_mm, self._upper_mm - self._forearm_mm
        if d > long_mm + REACH_MM or d < abs(short_mm) - REACH_MM:
            return []
        if d < REACH_MM:
            reason = "the wrist is on joint 2 and the upper arm could have any direction"
            raise Alarm(292016, name=self.name, pose=_written(target), reason=reason)
        over = math.sqrt(max((long_mm - d) * (long_mm + d), 0.0))
        under = math.sqrt(max((d - short_mm) * (d + short_mm), 0.0))
        found = []
        for sign in (1.0, -1.0):
            bend = sign * 2.0 * math.atan2(over, under)
            inner = math.atan2(
                self._forearm_mm * math.sin(bend),
                self._upper_mm + self._forearm_mm * math.cos(bend),
            )
            upper = math.atan2(q, p) - inner
            b2_deg = math.degrees(upper) + 90.0
            found.append((b2_deg, math.degrees(upper + bend) - self._bend_deg))
        return found

    def _hands(
        self, c1_deg: float, b2_deg: float, b23_deg: float, flange: Rotation, near: Positions
    ) -> list[Positions]:
        """Give all six joints, with the wrist as it is and turned over.

        B3 and A2 follow from the rotation that is left after A1: where B3 is 0 they give the
        rotation back whatever A1 is, and A1 stays that of `near`.
        """
        arm = product(about_z(c1_deg), about_y(b23_deg))
        m = product(inverse(arm), flange)
        if math.hypot(m[3], m[6]) < POLE:
            choices = [near[3]]
        else:
            a1_deg = math.degrees(math.atan2(m[3], -m[6]))
            choices = [a1_deg, a1_deg + 180.0]
        found: list[Positions] = []
        for a1 in choices:
            rest = product(about_x(-a1), m)
            b3 = math.degrees(math.atan2(-rest[6], rest[0]))
            a2 = math.degrees(math.atan2(-rest[5], rest[4]))
            joints = (
                near_turn_deg(c1_deg, near[0]),
                near_turn_deg(b2_deg - self._zero2_deg, near[1]),
                near_turn_deg(b23_deg - b2_deg - self._zero3_deg, near[2]),
                near_turn_deg(a1, near[3]),
                near_turn_deg(b3, near[4]),
                near_turn_deg(a2, near[5]),
            )
            found.append(joints)
        return found


def _written(place: Vector) -> str:
    return "X {:.4f} Y {:.4f} Z {:.4f}".format(*place)
