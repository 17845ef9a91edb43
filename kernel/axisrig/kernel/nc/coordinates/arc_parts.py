"""Parts of an arc that end where the axes of a kinematic have a kink (docs/kinematics.md)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.coordinates.state import Arc


def arc_parts(
    arc: Arc, begin_mm: Mapping[str, float], kinematic: Kinematic | None, inside: Sequence[str]
) -> list[Arc]:
    """Return the parts of an arc, each of which ends at rest; the arc itself without a kink.

    begin_mm: where every axis is before it, in BASE. inside: the axes of the kinematic. The place
    at the share x of the angle w is M + r cos xw + b sin xw + h x (`kernel.motion.curves.Arc`).
    """
    if kinematic is None:
        return [arc]
    centre = {axis: arc.centre_mm.get(axis, at) for axis, at in begin_mm.items()}
    cosines = {axis: at - centre[axis] for axis, at in begin_mm.items()}
    radius_mm = math.hypot(*cosines.values())
    sines = {axis: radius_mm * arc.tangent.get(axis, 0.0) for axis in begin_mm}
    end_mm = {**begin_mm, **arc.target_mm}

    def round_mm(axis: str, angle: float) -> float:
        return cosines[axis] * math.cos(angle) + sines[axis] * math.sin(angle)

    rise = {a: end_mm[a] - centre[a] - round_mm(a, arc.angle_rad) for a in begin_mm}

    def place(axis: str, share: float) -> float:
        return centre[axis] + round_mm(axis, share * arc.angle_rad) + rise[axis] * share

    kinks = kinematic.kinks_along(lambda share: tuple(place(axis, share) for axis in inside))
    parts = []
    for first, last in pairwise((0.0, *kinks, 1.0)):
        target = arc.target_mm
        if last < 1.0:
            target = {axis: place(axis, last) for axis in arc.target_mm}
        angle = first * arc.angle_rad
        tangent = {
            axis: (sines[axis] * math.cos(angle) - cosines[axis] * math.sin(angle)) / radius_mm
            for axis in arc.tangent
        }
        parts.append(
            replace(
                arc,
                target_mm=target,
                centre_mm={axis: at + rise[axis] * first for axis, at in arc.centre_mm.items()},
                tangent=tangent if first > 0.0 else arc.tangent,
                angle_rad=(last - first) * arc.angle_rad,
            )
        )
    return parts
