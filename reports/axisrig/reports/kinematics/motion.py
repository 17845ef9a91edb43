"""Where the tool was: of the plant's own truth, and as programmed by the oracle of kinematics.

Nothing comes from the kernel but the set positions that it sent and what it superposed on them.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.judge.kinematics.tool_findings import KinematicStretch, ToolFindings
from axisrig.bench.oracles.kinematics.chain import Chain, tilt_deg
from axisrig.bench.record.series import TIME, values_of

Signal = npt.NDArray[np.float64]

DEMAND_CYCLES = 2
"""At a SYNC an axis that follows exactly is where it was sent so many cycles before."""
CHANNEL = "channel"
PLACES = ("x", "y", "z")
_MOVED_MM = 1e-9
INACTIVE = 0


@dataclass(frozen=True)
class Motion:
    """The rows of a run in which a kinematic was on; mm and degrees, n rows.

    clamp_mm, tcp_mm: true, shape (n, 3); of the sensor's plant, else by the oracle from the true
    positions of the axes (the actual ones where there is no plant). programmed_mm: the TCP of the
    set positions without what distance control superposes. hit_mm: where the beam meets the
    surface. distance_mm: orthogonal distance of the clamping point. along_mm: along the tool.
    offset_mm: along the normal; moved_mm: along the direction. is_on: distance control was not
    INACTIVE. set_pos_mm: the surface that the program goes by. Not a number where nothing gives
    it.
    """

    times_ns: npt.NDArray[np.int64]
    clamp_mm: Signal
    tcp_mm: Signal
    programmed_mm: Signal
    hit_mm: Signal
    tilt_deg: Signal
    length_mm: Signal
    distance_mm: Signal
    along_mm: Signal
    offset_mm: Signal
    moved_mm: Signal
    set_pos_mm: Signal
    is_on: npt.NDArray[np.bool_]

    @property
    def direction(self) -> Signal:
        """Unit vectors (n, 3) from the TCP to the clamping point."""
        way = self.clamp_mm - self.tcp_mm
        unit: Signal = way / np.linalg.norm(way, axis=1, keepdims=True)
        return unit

    @property
    def depth_mm(self) -> Signal:
        """How far the beam reaches below the surface, along the tool; negative: it ends above."""
        depth: Signal = self.length_mm - self.along_mm
        return depth


def motion_of(trace: pa.Table, tool: ToolFindings) -> Motion | None:
    """Return the motion of the tool; None where no row has a kinematic on."""
    times = values_of(trace.column(TIME))
    parts = [
        _part(trace, tool, stretch, rows)
        for stretch in tool.kinematics
        if len(rows := _rows(times, stretch))
    ]
    if not parts:
        return None
    whole = [np.concatenate([getattr(p, name) for p in parts]) for name in Motion.__match_args__]
    return Motion(*whole)


def moved_mm(trace: pa.Table, tool: ToolFindings) -> Signal:
    """Return by how much distance control moves the tool along its direction, shape (rows,).

    That is o/cos b of FCT-M3 12.4.3: the TCP of the set positions less that of the set positions
    without the offset, with the sign of the offset. Not a number while no kinematic is on.
    """
    found = np.full(trace.num_rows, np.nan)
    times = values_of(trace.column(TIME))
    for stretch in tool.kinematics:
        rows = _rows(times, stretch)
        if len(rows):
            found[rows] = _moved(trace, tool, stretch, rows)
    return found


def chain_of(tool: ToolFindings, stretch: KinematicStretch) -> Chain:
    """Return the oracle of a kinematic that was on."""
    on = stretch.record
    return Chain(on.ids, tool.written, dict(on.program), on.tool_mm)


def column(trace: pa.Table, name: str) -> Signal | None:
    """Return a signal, shape (rows,); None for one that the trace lacks."""
    if name not in trace.column_names:
        return None
    values: Signal = values_of(trace.column(name)).astype(np.float64)
    return values


def _rows(times: npt.NDArray[np.int64], stretch: KinematicStretch) -> npt.NDArray[np.int64]:
    return np.flatnonzero((times >= stretch.record.begin_ns) & (times < stretch.end_ns))


def _part(
    trace: pa.Table, tool: ToolFindings, stretch: KinematicStretch, rows: npt.NDArray[np.int64]
) -> Motion:
    """The motion while one kinematic was on."""
    chain = chain_of(tool, stretch)
    base = _positions(trace, tool, stretch, "set") - _superposed(trace, stretch)
    late = np.maximum(rows - DEMAND_CYCLES, rows[0])
    programmed = chain.frame(base[late])[:, :3, 3]
    nothing = np.full(len(rows), np.nan)
    names = ("offset_mm", "set_pos_mm", "distance_state")
    offset, set_pos, state = (column(trace, f"{CHANNEL}.{name}") for name in names)
    return Motion(
        times_ns=values_of(trace.column(TIME))[rows],
        programmed_mm=programmed,
        offset_mm=nothing if offset is None else offset[rows],
        moved_mm=_moved(trace, tool, stretch, rows),
        set_pos_mm=nothing if set_pos is None else set_pos[rows],
        is_on=np.zeros(len(rows), dtype=bool) if state is None else state[rows] != INACTIVE,
        **_seen(trace, tool.sensor, rows),
        **_placed(trace, tool, stretch, rows),
    )


def _placed(
    trace: pa.Table, tool: ToolFindings, stretch: KinematicStretch, rows: npt.NDArray[np.int64]
) -> dict[str, Signal]:
    """Return where the tool was: clamping point, TCP, tilt, length."""
    sensor = tool.sensor
    if sensor is not None:
        return {
            "clamp_mm": _point(trace, f"{sensor}.clamping")[rows],
            "tcp_mm": _point(trace, f"{sensor}.tcp")[rows],
            "tilt_deg": _column(trace, f"{sensor}.tilt_deg")[rows],
            "length_mm": _column(trace, f"{sensor}.virtual_length_mm")[rows],
        }
    chain = chain_of(tool, stretch)
    has_truth = set(_names(tool, stretch, "truth")) <= set(trace.column_names)
    axes = _positions(trace, tool, stretch, "truth" if has_truth else "actual")[rows]
    frame = chain.frame(axes)
    return {
        "clamp_mm": chain.clamp_mm(axes),
        "tcp_mm": frame[:, :3, 3],
        "tilt_deg": tilt_deg(frame[:, :3, 2]),
        "length_mm": chain.length_mm(frame),
    }


def _seen(trace: pa.Table, sensor: str | None, rows: npt.NDArray[np.int64]) -> dict[str, Signal]:
    """Return what the plant of the sensor sees of the surface: place of the beam, distances."""
    if sensor is None:
        nothing = np.full(len(rows), np.nan)
        away = np.full((len(rows), 3), np.nan)
        return {"hit_mm": away, "distance_mm": nothing, "along_mm": nothing}
    valid = column(trace, f"{sensor}.valid")
    hits = np.ones(len(rows), dtype=bool) if valid is None else valid[rows] > 0.0
    orthogonal = column(trace, f"{sensor}.distance_true_mm")
    distance = np.where(hits, np.nan if orthogonal is None else orthogonal[rows], np.nan)
    along = np.where(hits, _column(trace, f"{sensor}.along_mm")[rows], np.nan)
    clamp, tcp = (_point(trace, f"{sensor}.{word}")[rows] for word in ("clamping", "tcp"))
    length = _column(trace, f"{sensor}.virtual_length_mm")[rows]
    hit = clamp - (clamp - tcp) * (along / length)[:, None]
    return {"hit_mm": hit, "distance_mm": distance, "along_mm": along}


def _moved(
    trace: pa.Table, tool: ToolFindings, stretch: KinematicStretch, rows: npt.NDArray[np.int64]
) -> Signal:
    offset = column(trace, f"{CHANNEL}.offset_mm")
    if offset is None:
        return np.full(len(rows), np.nan)
    chain = chain_of(tool, stretch)
    superposed = _superposed(trace, stretch)[rows]
    with_offset = _positions(trace, tool, stretch, "set")[rows]
    found = np.zeros(len(rows))
    is_off = np.abs(superposed).max(axis=1) > 0.0
    if is_off.any():
        there = chain.frame(with_offset[is_off])[:, :3, 3]
        here = chain.frame((with_offset - superposed)[is_off])[:, :3, 3]
        way = np.linalg.norm(there - here, axis=1)
        found[is_off] = np.where(way > _MOVED_MM, np.copysign(way, offset[rows][is_off]), 0.0)
    return found


def _names(tool: ToolFindings, stretch: KinematicStretch, word: str) -> list[str]:
    """Return the columns of positions of the axes of a kinematic, in its order."""
    turns = dict(zip(tool.axes, tool.rotary, strict=True))
    return [f"{axis}.{word}_{'deg' if turns[axis] else 'mm'}" for axis in stretch.record.axes]


def _positions(trace: pa.Table, tool: ToolFindings, stretch: KinematicStretch, word: str) -> Signal:
    """Return positions of the axes of a kinematic, shape (rows, axes)."""
    return np.stack([_column(trace, name) for name in _names(tool, stretch, word)], axis=1)


def _superposed(trace: pa.Table, stretch: KinematicStretch) -> Signal:
    """Return what distance control superposes on the axes of a kinematic, shape (rows, axes)."""
    names, nothing = set(trace.column_names), np.zeros(trace.num_rows)
    found = []
    for axis in stretch.record.axes:
        turned = f"{axis}.superposed_deg"
        one = column(trace, turned if turned in names else f"{axis}.superposed_mm")
        found.append(nothing if one is None else one)
    return np.stack(found, axis=1)


def _column(trace: pa.Table, name: str) -> Signal:
    """Return a signal that has to be there. Raises LookupError."""
    found = column(trace, name)
    if found is None:
        raise LookupError(f"no signal {name}")
    return found


def _point(trace: pa.Table, name: str) -> Signal:
    return np.stack([_column(trace, f"{name}_{place}_mm") for place in PLACES], axis=1)
