"""Geometry for programs that ship nowhere: rigs, planes, where a path meets them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Run = Callable[..., Any]
INCREMENT_MM = 10 / 2**20
# Half an increment of rounding, 1 nm of interpolation, 0.5 nm of %f, 0.5 nm of the crossing
ONE_AXIS_MM = INCREMENT_MM / 2 + 2e-6
# Set positions are rounded as well, so the path itself may lie beside the line
PATH_MM = INCREMENT_MM + 2e-6
A_MM_S2 = 1000.0


def starts(x: float, y: float, z: float) -> str:
    """Tables of a rig: where the axes stand first."""
    return "\n".join(
        f"[plant.{name}]\nstart = {{ position_start_mm = {value!r} }}"
        for name, value in zip("xyz", (float(x), float(y), float(z)), strict=True)
    )


def plane(normal: Any, surface_mm: float, more: str = "") -> str:
    """Table of a rig: the workpiece, n.p = surface, n towards free space."""
    x, y, z = (float(c) for c in normal)
    return (
        f"[plant.probe]\nstart = {{ normal_x = {x!r}, normal_y = {y!r}, normal_z = {z!r},"
        f" surface_mm = {float(surface_mm)!r}{more} }}"
    )


def show(*names: str) -> str:
    """Blocks that print variables as name=value."""
    return "\n".join(f'#MSG SYN["{name}=%f", V.A.{name}]' for name in names)


def near(values: list[float], tolerance_mm: float = ONE_AXIS_MM) -> Any:
    """Compare absolutely, in mm."""
    return pytest.approx(values, rel=0, abs=tolerance_mm)


def meets(start: Any, end: Any, normal: Any, surface_mm: float) -> Vector:
    """Where the straight line from start to end meets the plane n.p = surface."""
    p, q, n = (np.asarray(v, dtype=float) for v in (start, end, normal))
    share = (surface_mm - n @ p) / (n @ (q - p))
    assert 0 < share < 1
    point: Vector = p + share * (q - p)
    return point


def turned(a1: float, a2: float, a3: float) -> Vector:
    """Rz(a3) Ry(a2) Rx(a1), right-handed, degrees, element by element."""
    (s1, c1), (s2, c2), (s3, c3) = (
        (math.sin(math.radians(a)), math.cos(math.radians(a))) for a in (a1, a2, a3)
    )
    return np.array(
        [
            [c3 * c2, c3 * s2 * s1 - s3 * c1, c3 * s2 * c1 + s3 * s1],
            [s3 * c2, s3 * s2 * s1 + c3 * c1, s3 * s2 * c1 - c3 * s1],
            [-s2, c2 * s1, c2 * c1],
        ]
    )
