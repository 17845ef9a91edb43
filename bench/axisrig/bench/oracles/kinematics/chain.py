"""Where a machine's tool is: every kinematic as a product of 4x4 matrices, many poses at once.

The last frame has the TCP as its origin and the direction from the TCP to the clamping point as
its z. Frames, signs and sources: docs/kinematics.md. Nothing of the kernel is used; the way back is
found by scipy from the way forward.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.kinematics.lists import Kinematics, Lists, Program, Written

Array = npt.NDArray[np.float64]

HEAD, ROBOT, UNIVERSAL, COUPLING = 9, 45, 91, 210
JOINTS, LINEAR = 6, 3


def shift(x: npt.ArrayLike, y: npt.ArrayLike, z: npt.ArrayLike) -> Array:
    """Return matrices (..., 4, 4) that shift by mm."""
    way = np.stack(np.broadcast_arrays(x, y, z), axis=-1).astype(float)
    matrix = np.zeros((*way.shape[:-1], 4, 4))
    matrix[..., range(4), range(4)] = 1.0
    matrix[..., :3, 3] = way
    return matrix


def turn(axis: Sequence[float], angle_deg: npt.ArrayLike) -> Array:
    """Return matrices (..., 4, 4) that turn right-handed about an axis through the origin."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - takes long to load

    angles = np.asarray(angle_deg, dtype=float)
    direction = np.asarray(axis, dtype=float)
    vectors = np.radians(angles)[..., None] * direction / np.linalg.norm(direction)
    matrix = np.zeros((*angles.shape, 4, 4))
    matrix[..., 3, 3] = 1.0
    rotations = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
    matrix[..., :3, :3] = rotations.reshape(*angles.shape, 3, 3)
    return matrix


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Chain:
    """The kinematic of one or two steps.

    ids: as a program chooses them. written: what lists say. program: what the program wrote into
    V.G.KIN_STEP[].ID[].PARAM[]. tool_mm: length of the tool.
    """

    def __init__(
        self, ids: Sequence[int], written: Written, program: Program, tool_mm: float
    ) -> None:
        self._lists = Lists(written, program)
        self._first = self._lists.of(0, ids[0])
        self._second = self._lists.of(1, ids[1]) if len(ids) > 1 else None
        self.tool_mm = tool_mm
        if self._first.type == COUPLING:
            low, high = self._first.words("group[0].chain")
            self._slide, self._robot = self._lists.of(0, low), self._lists.of(0, high)
            self._shares = self._shared()

    def frame(self, axes: npt.ArrayLike) -> Array:
        """Return the frames (n, 4, 4) at the TCP of axis positions (n, count), mm and degrees."""
        clamp = self._clamp(self._first, np.asarray(axes, dtype=float))
        longer = 0.0 if self._second is None else self._second.hd(1)
        return clamp @ shift(0, 0, -longer - self.length_mm(clamp))

    def tool(self, axes: npt.ArrayLike) -> Array:
        """Return the tool coordinates (n, count): x, y, z, then the orientation, mm and degrees.

        Where B of a robot is 90 or -90, A and C are one choice of many: compare frames there.
        """
        axes = np.asarray(axes, dtype=float)
        frame = self.frame(axes)
        place = frame[..., :3, 3]
        if self._first.type in (HEAD, UNIVERSAL):
            return np.concatenate([place, axes[..., LINEAR:]], axis=-1)
        from scipy.spatial.transform import Rotation  # noqa: PLC0415 - takes long to load

        angles = Rotation.from_matrix(frame[..., :3, :3]).as_euler("ZYX", degrees=True)
        own = axes[..., JOINTS:]
        if self._first.type == COUPLING:
            own = own - place @ self._shares.T
        return np.concatenate([place, angles[..., ::-1], own], axis=-1)

    def direction(self, axes: npt.ArrayLike) -> Array:
        """Return the direction (n, 3) from the TCP to the clamping point."""
        direction: Array = self.frame(axes)[..., :3, 2]
        return direction

    def clamp_mm(self, axes: npt.ArrayLike) -> Array:
        """Return the clamping point (n, 3) of the tool with its virtual length."""
        frame = self.frame(axes)
        point: Array = (frame @ shift(0, 0, self.length_mm(frame)))[..., :3, 3]
        return point

    def length_mm(self, frame: Array) -> Array:
        """Return the lengths (n,) of the tool at frames, virtually extended or not."""
        tilt = tilt_deg(frame[..., :3, 2])
        factor = np.ones_like(tilt) if self._second is None else _factor(self._second, tilt)
        return np.asarray(self.tool_mm * factor)

    def axes(self, tool: Sequence[float], near: Sequence[float]) -> Array:
        """Return the axis positions (count,) of tool coordinates, by Newton's method from near."""

        def missing(axes: Array) -> Array:
            difference = np.asarray(self.tool(axes[None])[0] - np.asarray(tool), dtype=float)
            difference[LINEAR:JOINTS] = (difference[LINEAR:JOINTS] + 180.0) % 360.0 - 180.0
            return difference

        from scipy.optimize import root  # noqa: PLC0415 - takes long to load

        found = root(missing, np.asarray(near, dtype=float), tol=1e-13)
        solution: Array = found.x
        return solution

    def _clamp(self, kinematic: Kinematics, axes: Array) -> Array:
        """Return the frame where the tool is clamped."""
        if kinematic.type == HEAD:
            return _head(kinematic, axes)
        if kinematic.type == ROBOT:
            return _robot(kinematic, axes)
        if kinematic.type == UNIVERSAL:
            return _universal(kinematic, axes)
        slide, robot = self._slide, self._robot
        base = _seen_from_below(slide) @ _universal(slide, axes[..., JOINTS:])
        return base @ _seen_from_below(robot) @ _robot(robot, axes[..., :JOINTS])

    def _shared(self) -> Array:
        """Return (axes, 3): times the TCP it is the motion that each linear axis takes."""
        priority = self._first.words("group[0].move_prio")
        base = _seen_from_below(self._slide)[:3, :3]
        ways = []
        for place, (_, direction, _) in enumerate(self._slide.axes()):
            locked = self._first.number(f"lock_dof[{JOINTS + place}]") > 0
            first = bool(priority) and self._lists.of(0, priority[0]).id != self._robot.id
            unit = np.asarray(direction) / np.linalg.norm(direction)
            ways.append(base @ unit if first and not locked else np.zeros(3))
        return np.asarray(np.linalg.pinv(np.array(ways).T), dtype=float)


def tilt_deg(direction: Array) -> Array:
    """Return the angle between directions (..., 3) and Z."""
    level = np.linalg.norm(direction[..., :2], axis=-1)
    angles: Array = np.degrees(np.arctan2(level, direction[..., 2]))
    return angles


def _factor(k98: Kinematics, tilt: Array) -> Array:
    """Return L2 / L1 over the tilt: 1, then 1/cos, then frozen (FCT-M3 12.4.2)."""
    start, end, largest = k98.hd(2), k98.hd(3), k98.hd(4)
    if start >= 90.0:
        return np.ones_like(tilt)
    held = np.clip(tilt, start, end if end > 0.0 else largest)
    factor: Array = np.cos(np.radians(start)) / np.cos(np.radians(held))
    return np.where(tilt <= start, 1.0, factor)


def _head(k: Kinematics, axes: Array) -> Array:
    x, y, z, c, a = np.moveaxis(axes, -1, 0)
    return (
        shift(x + k.hd(7), y + k.hd(8), z)
        @ turn(Z, c + k.hd(4))
        @ shift(k.hd(6), k.hd(5), -k.hd(2))
        @ turn(X, a + k.hd(3))
        @ shift(0, k.hd(9), -k.hd(1))
    )


def _robot(k: Kinematics, axes: Array) -> Array:
    c1, b1, b2, a1, b3, a2 = np.moveaxis(axes, -1, 0)
    return (
        turn(Z, c1)
        @ shift(k.hd(11), 0, k.hd(7))
        @ turn(Y, b1 + k.hd(14))
        @ shift(0, 0, k.hd(8))
        @ turn(Y, b2 + k.hd(15))
        @ shift(k.hd(9), 0, -k.hd(12))
        @ turn(X, a1)
        @ turn(Y, b3)
        @ turn(X, a2)
        @ shift(k.hd(10), 0, 0)
        @ turn(Y, -90.0)
        @ shift(k.hd(2), k.hd(3), -k.hd(1))
        @ turn(Z, k.hd(6))
        @ turn(Y, k.hd(5))
        @ turn(X, k.hd(4))
    )


def _universal(k: Kinematics, axes: Array) -> Array:
    frame: Array = np.eye(4)
    described = k.axes()
    for place in k.order():
        rotary, direction, point = described[place]
        if rotary:
            there, back = shift(*point), shift(*(-value for value in point))
            frame = frame @ there @ turn(direction, axes[..., place]) @ back
        else:
            unit = np.asarray(direction) / np.linalg.norm(direction)
            frame = frame @ shift(*(axes[..., place] * part for part in unit))
    return frame @ shift(*k.lengths("zero_position")) @ _least_turn(k.vector("zero_orientation"))


def _least_turn(target: Sequence[float]) -> Array:
    """Return the smallest turn of Z to a direction."""
    x, y, z = target
    axis = X if x == 0.0 == y else (-y, x, 0.0)
    return turn(axis, np.degrees(np.arctan2(np.hypot(x, y), z)))


def _seen_from_below(k: Kinematics) -> Array:
    """Return where the base of a kinematic is; P-CHAN-00446 gives the place below seen from it."""
    x, y, z, a, b, c = k.lengths("base", 6)
    base = shift(x, y, z) @ turn(Z, c) @ turn(Y, b) @ turn(X, a)
    return np.asarray(np.linalg.inv(base), dtype=float)
