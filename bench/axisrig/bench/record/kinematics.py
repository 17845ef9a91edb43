"""Which kinematic was on when, with what it was built from; where 3D distance control acted."""

from dataclasses import dataclass

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class KinematicRecord(Frozen):
    """One #TRAFO ON. begin_ns, end_ns: NC cycles; it is off from end_ns on, None: to the end.

    axes: those that it contains. ids: of its steps. tool_mm: length of the tool. program: what the
    program had written into V.G.KIN_STEP[].ID[].PARAM[], each with its three indices.
    """

    begin_ns: TimeNs
    end_ns: TimeNs | None
    axes: tuple[str, ...]
    ids: tuple[int, ...]
    tool_mm: float
    program: tuple[tuple[tuple[int, int, int], float], ...] = ()


@dataclass(frozen=True)
class GuideChange(Frozen):
    """Where the offset of 3D distance control acts from a SYNC on.

    mode: ACS, MCS, ECS; empty while nothing says it. axis: that moves in ACS. normal, origin_mm: of
    the coordinate system, coordinates of the machine.
    """

    time_ns: TimeNs
    mode: str = ""
    axis: str = ""
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    origin_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
