"""Machining coordinate systems: where one is in the one below, and the way through it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAIN_AXES = 3


@dataclass(frozen=True, eq=False)
class Frame:
    """A coordinate system: lower = offset_mm + rotation · upper.

    offset_mm: shape (3,). rotation: shape (3, 3), orthonormal.
    """

    offset_mm: Array
    rotation: Array

    @classmethod
    def of(cls, components: Sequence[float]) -> "Frame":
        """Make the frame of `#CS ON[v1,v2,v3,a1,a2,a3]`: shifts in mm, angles in degrees.

        The right-handed turns run third angle about Z, second about the new Y, first about the
        newest X: R = Rz(a3) · Ry(a2) · Rx(a1).
        Source: programming manual, #CS; P-CHAN-00394, default rotation sequence.
        """
        x, y, z, *angles_deg = components
        a1, a2, a3 = np.radians(angles_deg)
        c1, c2, c3 = np.cos(a1), np.cos(a2), np.cos(a3)
        s1, s2, s3 = np.sin(a1), np.sin(a2), np.sin(a3)
        about_x = np.array([[1.0, 0.0, 0.0], [0.0, c1, -s1], [0.0, s1, c1]])
        about_y = np.array([[c2, 0.0, s2], [0.0, 1.0, 0.0], [-s2, 0.0, c2]])
        about_z = np.array([[c3, -s3, 0.0], [s3, c3, 0.0], [0.0, 0.0, 1.0]])
        return cls(np.array([x, y, z], dtype=np.float64), about_z @ about_y @ about_x)

    @classmethod
    def identity(cls) -> "Frame":
        """Make the frame of the axes themselves."""
        return cls(np.zeros(MAIN_AXES), np.eye(MAIN_AXES))

    @classmethod
    def shifted(cls, offset_mm: Sequence[float]) -> "Frame":
        """Make a frame that is not turned."""
        return cls(np.array(offset_mm, dtype=np.float64), np.eye(MAIN_AXES))

    def down(self, upper_mm: Array) -> Array:
        """Convert a position, shape (3,), to the coordinate system below."""
        lower: Array = self.offset_mm + self.rotation @ upper_mm
        return lower

    def up(self, lower_mm: Array) -> Array:
        """Convert a position, shape (3,), from the coordinate system below."""
        upper: Array = self.rotation.T @ (lower_mm - self.offset_mm)
        return upper

    def then(self, upper: "Frame") -> "Frame":
        """Put a frame that is relative to this one on top of it; the result is one frame."""
        return Frame(self.down(upper.offset_mm), self.rotation @ upper.rotation)
