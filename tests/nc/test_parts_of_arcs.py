"""Parts of an arc between kinks of a kinematic: together they are the arc, place by place."""

import math
from collections.abc import Mapping
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.nc.coordinates.arc_parts import arc_parts
from axisrig.kernel.nc.coordinates.circle import PlaneArc
from axisrig.kernel.nc.coordinates.state import Arc

SHARES = (0.0, 0.2, 0.5, 0.9, 1.0)
BEGIN_MM = {"Z": 4.0, "X": 8.0, "Y": -1.0, "A": 30.0, "B": 7.0}


def place(arc: Arc, begin_mm: Mapping[str, float], share: float) -> dict[str, float]:
    """M + r cos xw + b sin xw + h x: h is what the circle leaves to the end."""
    end_mm = {**begin_mm, **arc.target_mm}
    centre = {**begin_mm, **arc.centre_mm}
    r_mm = math.dist(begin_mm.values(), centre.values())

    def on_circle(axis: str, angle: float) -> float:
        ahead = r_mm * arc.tangent.get(axis, 0.0)
        beside = begin_mm[axis] - centre[axis]
        return centre[axis] + beside * math.cos(angle) + ahead * math.sin(angle)

    return {
        axis: on_circle(axis, share * arc.angle_rad)
        + share * (end_mm[axis] - on_circle(axis, arc.angle_rad))
        for axis in begin_mm
    }


def arc_of(degrees: float, target_mm: Mapping[str, float]) -> Arc:
    """About (5, 3) in X and Y from (8, -1): radius 5, to the left or right of it."""
    tangent = {"X": 0.8, "Y": 0.6} if degrees > 0 else {"X": -0.8, "Y": -0.6}
    plane = PlaneArc((8.0, -1.0), (5.0, 3.0), math.radians(degrees))
    angle_rad = abs(math.radians(degrees))
    return Arc(target_mm, {"X": 5.0, "Y": 3.0}, tangent, angle_rad, plane)


@pytest.mark.parametrize("kinks", [(0.25, 0.6), (0.5,), ()])
@pytest.mark.parametrize(
    ("degrees", "target_mm"),
    [
        (90.0, {"X": 9.0, "Y": 6.0}),
        (-90.0, {"X": 1.0, "Y": 0.0}),
        (360.0, {"X": 8.0, "Y": -1.0, "Z": 14.0}),  # a helix
        (90.0, {"X": 9.02, "Y": 5.99, "A": -50.0}),  # ends beside the circle; A comes along
    ],
)
def test_the_parts_of_an_arc_are_the_arc(
    degrees: float, target_mm: dict[str, float], kinks: tuple[float, ...]
) -> None:
    arc = arc_of(degrees, target_mm)
    shown: list[Any] = []

    def kinks_along(at: Any) -> tuple[float, ...]:
        shown.extend(at(share) for share in SHARES)
        return kinks

    kinematic: Any = SimpleNamespace(kinks_along=kinks_along)
    parts = arc_parts(arc, BEGIN_MM, kinematic, ("X", "Y", "Z", "A"))
    for share, axes in zip(SHARES, shown, strict=True):  # what the kinematic looks at
        wanted = place(arc, BEGIN_MM, share)
        assert axes == pytest.approx([wanted[axis] for axis in "XYZA"], abs=1e-12)
    bounds = (0.0, *kinks, 1.0)
    assert len(parts) == len(bounds) - 1
    begin_mm = dict(BEGIN_MM)
    for part, (first, last) in zip(parts, pairwise(bounds), strict=True):
        assert part.target_mm.keys() == target_mm.keys()
        assert math.hypot(*part.tangent.values()) == pytest.approx(1.0, abs=1e-12)
        for share in SHARES:
            wanted = place(arc, BEGIN_MM, first + share * (last - first))
            assert place(part, begin_mm, share) == pytest.approx(wanted, abs=1e-9), (first, share)
        begin_mm |= part.target_mm
    assert parts[-1].target_mm == target_mm  # bit by bit
    assert arc_parts(arc, BEGIN_MM, None, ()) == [arc]
