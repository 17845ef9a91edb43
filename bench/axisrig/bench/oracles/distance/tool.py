"""Where the offset of 3D distance control leads a tool, by chains of 4x4 matrices.

The offset o counts along the normal n of the surface that the control assumes: Z of the active
#CS, else of the machine. The tool moves by o/cos b along a direction d, cos b = d n: ECS along the
tool u, MCS along n; in ACS one axis moves by o. The axes follow from the shifted frame by Newton's
method, all rows at once. Lengths mm, angles degrees; axes (n, count).
Sources: FCT-M3 12.1, 12.4.3; docs/kinematics.md; docs/ambiguities.md.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axisrig.bench.oracles.kinematics.chain import JOINTS, Array, Chain
from axisrig.kernel.time.clock import TimeNs

ACS, ECS, MCS = "ACS", "ECS", "MCS"
STEEPEST_DEG = 85.0
"""Largest angle between tool and normal in ECS (docs/ambiguities.md)."""
_ROUNDS, _DISPLACEMENT = 6, 1e-4
_CLOSE = 1e-11
_SINGULAR = 1e-9


def seen_gain(
    way: Array,
    tool: Array,
    surface: Array,
    *,
    along_tool: bool = False,
    is_normalised: bool = False,
) -> float:
    """Return by how much a sensor value grows for 1 mm of offset over a plane.

    way: w of the clamping point for it. tool: u. surface: normal m. To the nearest point m w, along
    the tool m w/m u; times u_z where the PLC normalises it by the tilt to Z of the machine.
    """
    rise = float(way @ surface)
    if along_tool:
        rise /= float(tool @ surface)
    return rise * float(tool[2]) if is_normalised else rise


def inclined_gain(
    mode: str,
    tilt_deg: float,
    slope_deg: float,
    *,
    along_tool: bool = False,
    is_normalised: bool = False,
) -> float:
    """Return the same of a tool at b to the assumed normal n, here Z of the machine.

    tilt_deg: b. slope_deg: p, of the surface in the plane of the tilt, positive when its normal m
    is turned to the side of the tool: u m = cos(b - p). To the nearest point: ECS moves along u by
    1/cos b, so cos(b - p)/cos b = cos p + sin p tan b; MCS and ACS along n: cos p. Along the tool
    and normalised: ECS 1 over any surface; MCS, ACS cos p cos b/cos(b - p) = 1/(1 + tan p tan b).
    The limit of kp in CONST_DIST is divided by it.
    """
    tool, surface = _leaning_by(tilt_deg), _leaning_by(slope_deg)
    way = tool / tool[2] if mode == ECS else _leaning_by(0.0)
    return seen_gain(way, tool, surface, along_tool=along_tool, is_normalised=is_normalised)


def _leaning_by(angle_deg: float) -> Array:
    """Return the unit vector at an angle to Z, in the plane of Y and Z."""
    angle = math.radians(angle_deg)
    return np.array((0.0, math.sin(angle), math.cos(angle)))


def steepest_gain(tilt_deg: float) -> float:
    """Return the most of ECS to the nearest point at a tilt: 1/cos b, for a surface across u."""
    return 1.0 / math.cos(math.radians(tilt_deg))


@dataclass(frozen=True)
class ToolWay:
    """Where an offset acts. mode: ACS, ECS, MCS. axis: place of the one that moves in ACS.

    chain: of the kinematic, for ECS and MCS; count: its axes. normal, origin_mm: of the coordinate
    system. until_ns: SYNC from which on the kinematic is off, None = it stays on.
    """

    mode: str
    axis: int = 0
    chain: Chain | None = None
    count: int = 0
    normal: Sequence[float] = (0.0, 0.0, 1.0)
    origin_mm: Sequence[float] = (0.0, 0.0, 0.0)
    until_ns: TimeNs | None = None

    def _kinematic(self) -> Chain:
        assert self.chain is not None, f"{self.mode} has a kinematic"
        return self.chain

    def height_mm(self, axes: Array) -> Array:
        """Return where the clamping point is along the normal, shape (n,)."""
        if self.mode == ACS:
            return axes[:, self.axis]
        clamp = self._kinematic().clamp_mm(axes[:, : self.count])
        height: Array = (clamp - np.asarray(self.origin_mm)) @ np.asarray(self.normal)
        return height

    def share(self, axes: Array) -> Array:
        """Return the distance of a tool on the surface over SET_DIST: (L2/L) cos of its tilt."""
        if self.mode == ACS:
            return np.ones(len(axes))
        chain = self._kinematic()
        frame = chain.frame(axes[:, : self.count])
        stretched = chain.length_mm(frame) / chain.tool_mm if chain.tool_mm else 1.0
        share: Array = stretched * (frame[:, :3, 2] @ np.asarray(self.normal))
        return share

    def gain(
        self,
        axes: Array,
        surface: Sequence[float],
        *,
        along_tool: bool,
        is_normalised: bool = False,
    ) -> float:
        """Return `seen_gain` at a pose (1, count). surface: normal of the plane."""
        ones = np.full(len(axes), _DISPLACEMENT)
        points = [
            self._kinematic().clamp_mm(self.superposed(axes, sign * ones)[:, : self.count])
            for sign in (1.0, -1.0)
        ]
        way = (points[0] - points[1])[0] / (2.0 * _DISPLACEMENT)
        tool = self._kinematic().direction(axes[:, : self.count])[0]
        return seen_gain(
            way, tool, np.asarray(surface), along_tool=along_tool, is_normalised=is_normalised
        )

    def superposed(self, axes: Array, offset_mm: Array) -> Array:
        """Return the axes with an offset, shape (n, count of all)."""
        moved = np.array(axes, dtype=float)
        if self.mode == ACS:
            moved[:, self.axis] += offset_mm
            return moved
        if not len(axes):
            return moved
        own = moved[:, : self.count]
        way = self.way(own) * np.asarray(offset_mm)[:, None]
        moved[:, : self.count] = shifted(self._kinematic(), own, way)
        return moved

    def way(self, axes: Array) -> Array:
        """Return by how much the TCP moves for 1 mm of offset, shape (n, 3)."""
        normal = np.asarray(self.normal, dtype=float)
        if self.mode == MCS:
            return np.broadcast_to(normal, (len(axes), 3))
        direction = self._kinematic().direction(axes)
        cosine = np.maximum(direction @ normal, math.cos(math.radians(STEEPEST_DEG)))
        return np.asarray(direction / cosine[:, None])

    def rates(self, axes: Array) -> Array:
        """Return by how much each axis moves for 1 mm of offset, shape (n, count of all)."""
        ones = np.full(len(axes), _DISPLACEMENT)
        up, down = self.superposed(axes, ones), self.superposed(axes, -ones)
        return np.asarray((up - down) / (2.0 * _DISPLACEMENT))


def shifted(chain: Chain, axes: Array, way_mm: Array) -> Array:
    """Return the axes (n, count) that bring the tool by a way (n, 3) with its orientation kept.

    Newton's method from the axes on; of more than one solution the one that moves least.
    """
    wanted = chain.frame(axes).copy()
    wanted[:, :3, 3] += way_mm
    rest = chain.tool(axes)[:, JOINTS:]
    found = np.array(axes, dtype=float)
    for _ in range(_ROUNDS):
        missing = _missing(chain, found, wanted, rest)
        if not len(missing) or float(np.max(np.abs(missing))) < _CLOSE:
            break
        found = found - np.einsum(
            "nij,nj->ni", np.linalg.pinv(_slopes(chain, found, wanted, rest), _SINGULAR), missing
        )
    return found


def _missing(chain: Chain, axes: Array, wanted: Array, rest: Array) -> Array:
    """Return place, orientation (rotation vector, degrees) and further coordinates less those
    wanted.
    """
    frame = chain.frame(axes)
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - takes long to load

    turned = np.swapaxes(wanted[:, :3, :3], -1, -2) @ frame[:, :3, :3]
    vectors = np.degrees(Rotation.from_matrix(turned).as_rotvec())
    place = frame[:, :3, 3] - wanted[:, :3, 3]
    return np.concatenate([place, vectors, chain.tool(axes)[:, JOINTS:] - rest], axis=1)


def _slopes(chain: Chain, axes: Array, wanted: Array, rest: Array) -> Array:
    columns = []
    for place in range(axes.shape[1]):
        step = np.zeros(axes.shape[1])
        step[place] = _DISPLACEMENT
        up = _missing(chain, axes + step, wanted, rest)
        down = _missing(chain, axes - step, wanted, rest)
        columns.append((up - down) / (2.0 * _DISPLACEMENT))
    return np.stack(columns, axis=-1)


def tcp_slopes(chain: Chain, axes: Array) -> Array:
    """Return by how much the TCP moves for a unit of each axis, shape (n, 3, count)."""
    columns = []
    for place in range(axes.shape[1]):
        step = np.zeros(axes.shape[1])
        step[place] = _DISPLACEMENT
        up, down = (chain.frame(axes + sign * step)[:, :3, 3] for sign in (1.0, -1.0))
        columns.append((up - down) / (2.0 * _DISPLACEMENT))
    return np.stack(columns, axis=-1)
