"""What the side view draws: some instants of the motion, packed, and the surface as planes."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.reports.kinematics.motion import PLACES, Motion, Signal
from axisrig.reports.parts.encode import encode_signal, pack

INSTANTS = 240
"""So many instants are drawn: a picture is about 900 px wide."""
DIGITS = 4
"""Decimal places of mm and degrees."""
PLANE_MM = 1e-3
"""A plane is one where no reading is farther from it."""
PLANES = 6
"""A surface that needs more of them one after the other is drawn where the beam met it."""
_UNIT = 1e-4
LEVEL = np.array([0.0, 0.0, 1.0])
_POINTS = {"clamp": "clamp_mm", "tcp": "tcp_mm", "programmed": "programmed_mm", "hit": "hit_mm"}
_NUMBERS = {
    "tilt": "tilt_deg",
    "length": "length_mm",
    "distance": "distance_mm",
    "depth": "depth_mm",
    "offset": "offset_mm",
    "moved": "moved_mm",
}
NEAR_MM = 5.0
"""A beam that ends so near to the surface works on it."""
_LEAST_TILT_DEG, _LEAST_WAY_MM = 1.0, 1.0
_USUAL, _LEAST_AWAY_MM = 3.0, 0.01


def scene(motion: Motion, tool: ToolFindings) -> dict[str, Any]:
    """Return the scene: `about` and `packed`, both texts, for `view.js`.

    about: JSON with rows and columns as the plots have them, the projections (name, directions of
    the picture to the right and up; the first one opens), the planes of the surface, ideal ones.
    """
    rows = instants(motion)
    columns, parts = [], []
    for name, values in _columns(motion, rows):
        head, part = encode_signal(values, 0 if values.dtype.kind == "i" else DIGITS)
        columns.append({"name": name, **vars(head)})
        parts.append(part)
    views = projections(motion)
    about = {
        "rows": len(rows),
        "columns": columns,
        "views": views,
        "planes": planes(motion),
        "ideal": ideal(motion, tool),
        "near_mm": NEAR_MM,
    }
    return {"about": json.dumps(about, separators=(",", ":")), "packed": pack(parts)}


def instants(motion: Motion) -> npt.NDArray[np.int64]:
    """Return rows that show the whole motion, INSTANTS at most: evenly in time and in the way.

    Half of them is even in time, half in what tool and offset did, so that short moves are seen.
    """
    count = len(motion.times_ns)
    if count <= INSTANTS:
        return np.arange(count)
    steps = np.linalg.norm(np.diff(motion.clamp_mm, axis=0), axis=1)
    steps += np.linalg.norm(np.diff(motion.tcp_mm, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    even = np.linspace(0, count - 1, INSTANTS // 2)
    found = np.rint(even).astype(np.int64)
    if way[-1] > 0.0:
        by_way = np.searchsorted(way, np.linspace(0.0, way[-1], INSTANTS // 2))
        found = np.concatenate([found, np.minimum(by_way, count - 1)])
    rows: npt.NDArray[np.int64] = np.unique(found)
    return rows


def _columns(motion: Motion, rows: npt.NDArray[np.int64]) -> list[tuple[str, npt.NDArray[Any]]]:
    found: list[tuple[str, npt.NDArray[Any]]] = [("time_ns", motion.times_ns[rows])]
    for name, source in _POINTS.items():
        points = getattr(motion, source)[rows]
        found += [(f"{name}_{place}", points[:, k]) for k, place in enumerate(PLACES)]
    found += [(name, getattr(motion, source)[rows]) for name, source in _NUMBERS.items()]
    return [*found, ("at_work", at_work(motion)[rows].astype(np.int64))]


def at_work(motion: Motion) -> npt.NDArray[np.bool_]:
    """Return the rows that the picture of the surface is about, shape (n,).

    Those in which distance control was not INACTIVE; without it those in which the beam ends about
    as near to the surface as it mostly does (an approach is none), and without a surface all.
    """
    if motion.is_on.any():
        return motion.is_on
    depth = motion.depth_mm
    if not np.isfinite(depth).any():
        return np.ones(len(depth), dtype=bool)
    away = np.abs(np.nan_to_num(depth, nan=np.inf))
    usual = away[away < NEAR_MM]
    limit = max(_USUAL * float(np.median(usual)), _LEAST_AWAY_MM) if len(usual) else NEAR_MM
    near: npt.NDArray[np.bool_] = away < min(limit, NEAR_MM)
    return near


# Projections


def projections(motion: Motion) -> list[dict[str, Any]]:
    """Return the views: name, axis to the right and up, the plane of the tilt first.

    The plane of the tilt is upright and has the tool where it is inclined most; the one along the
    path has the longest way of the TCP. Both only where there is such a direction.
    """
    views = []
    for name, across in (("tilt", tilt_direction(motion)), ("path", path_direction(motion))):
        if across is not None:
            views.append(_view(name, _words(across), across, (0.0, 0.0, 1.0)))
    views += [
        _view("X-Z", "X", (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        _view("Y-Z", "Y", (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        _view("X-Y", "X", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), up="Y"),
    ]
    return views


def _view(
    name: str,
    word: str,
    across: tuple[float, float, float],
    upwards: tuple[float, float, float],
    up: str = "Z",
) -> dict[str, Any]:
    return {"name": name, "right": across, "up": upwards, "x": f"{word} in mm", "y": f"{up} in mm"}


def tilt_direction(motion: Motion) -> tuple[float, float, float] | None:
    """Return the level direction in which the tool leans most; None where it never leans by 1 deg.

    Its larger part points in the positive direction of its axis.
    """
    row = int(np.argmax(motion.tilt_deg))
    if motion.tilt_deg[row] < _LEAST_TILT_DEG:
        return None
    return _forward(motion.direction[row, :2])


def path_direction(motion: Motion) -> tuple[float, float, float] | None:
    """Return the level direction of the longest programmed way; None where it is less than 1 mm.

    That is the first principal component of the places of the programmed TCP.
    """
    places = motion.programmed_mm[:, :2] - motion.programmed_mm[:, :2].mean(axis=0)
    _, _, ways = np.linalg.svd(places, full_matrices=False)
    if float(np.ptp(places @ ways[0])) < _LEAST_WAY_MM:
        return None
    return _forward(ways[0])


def _forward(level: Signal) -> tuple[float, float, float]:
    x, y = (level / np.linalg.norm(level)).round(9).tolist()
    sign = 1.0 if (x if abs(x) >= abs(y) else y) > 0.0 else -1.0
    return (sign * x + 0.0, sign * y + 0.0, 0.0)


def _words(direction: tuple[float, float, float]) -> str:
    """Name a level direction: an axis, or its angle from X towards Y."""
    x, y, _ = direction
    if abs(x) > 1.0 - 1e-6:
        return "X"
    if abs(y) > 1.0 - 1e-6:
        return "Y"
    return f"level way at {np.degrees(np.arctan2(y, x)):.4g}° from X to Y,"


# Surface


def planes(motion: Motion) -> list[dict[str, Any]]:
    """Return the planes n p = d that the readings fit, one after the other: a workpiece may move.

    Each has `begin_ms`, `normal`, `at_mm`; none where more than PLANES would be needed. A reading
    says two things: the place of the beam is on the plane, and the clamping point is h away from
    it. Both are linear in n and d; that n has length 1 and every residual is below PLANE_MM is the
    proof. Readings that leave n open take the normal before, or Z.
    """
    rows = np.flatnonzero(np.isfinite(motion.hit_mm[:, 0]) & np.isfinite(motion.distance_mm))
    found: list[dict[str, Any]] = []
    begin = 0
    known = [LEVEL]
    while begin < len(rows):
        end = _longest(motion, rows, begin, known)
        fitted = _fitted(motion, rows[begin:end], known)
        if fitted is None or len(found) == PLANES:
            return []
        normal, at_mm = fitted
        known = [normal, LEVEL]
        found.append(
            {
                "begin_ms": float(motion.times_ns[rows[begin]]) / 1e6,
                "normal": [round(float(part), 9) for part in normal],
                "at_mm": round(at_mm, 6),
            }
        )
        begin = end
    return found


def _longest(
    motion: Motion, rows: npt.NDArray[np.int64], begin: int, known: Sequence[Signal]
) -> int:
    """Return the end of the longest stretch from `begin` on that one plane fits."""
    low, high = begin + 1, len(rows)
    if _fitted(motion, rows[begin:high], known) is not None:
        return high
    while high - low > 1:
        middle = (low + high) // 2
        if _fitted(motion, rows[begin:middle], known) is None:
            high = middle
        else:
            low = middle
    return low


def _fitted(
    motion: Motion, rows: npt.NDArray[np.int64], known: Sequence[Signal]
) -> tuple[Signal, float] | None:
    """Return normal and distance from the origin of the plane that rows fit, None without.

    known: normals that are tried first.
    """
    # From their middle: what readings along a line leave open is 0 then, wherever the line is
    middle = motion.hit_mm[rows].mean(axis=0)
    hit, clamp = motion.hit_mm[rows] - middle, motion.clamp_mm[rows] - middle
    distance, count = motion.distance_mm[rows], len(rows)
    matrix = np.full((2 * count, 4), -1.0)
    matrix[:count, :3], matrix[count:, :3] = hit, clamp
    wanted = np.concatenate([np.zeros(count), distance])
    solutions = [np.append(normal, float(np.mean(hit @ normal))) for normal in known]
    solutions.append(np.linalg.lstsq(matrix, wanted, rcond=1e-9)[0])
    for found in solutions:
        has_length = abs(float(np.linalg.norm(found[:3])) - 1.0) < _UNIT
        if has_length and float(np.abs(matrix @ found - wanted).max()) < PLANE_MM:
            return found[:3], float(found[3] + found[:3] @ middle)
    return None


def ideal(motion: Motion, tool: ToolFindings) -> list[dict[str, Any]]:
    """Return the ideal surfaces that the program has given by SET_POS, each once.

    SET_POS counts along the normal from the origin of the coordinate system: n (p - p0) = SET_POS.
    In ACS it counts along an axis, which says nothing of the surface.
    """
    found: list[dict[str, Any]] = []
    guides = tool.guides
    last_ns = int(motion.times_ns[-1]) + 1
    ends = [*(guide.change.time_ns for guide in guides[1:]), last_ns][: len(guides)]
    for guide, end_ns in zip(guides, ends, strict=True):
        change = guide.change
        if change.mode in ("", "ACS") or not guide.is_used:
            continue
        rows = motion.is_on & (motion.times_ns >= change.time_ns) & (motion.times_ns < end_ns)
        normal = np.asarray(change.normal, dtype=float)
        for value in np.unique(motion.set_pos_mm[rows & np.isfinite(motion.set_pos_mm)]):
            at_mm = round(float(value + normal @ np.asarray(change.origin_mm, dtype=float)), 6)
            one = {"normal": normal.tolist(), "at_mm": at_mm}
            if one not in found and len(found) < PLANES:
                found.append(one)
    return found
