"""Which kinematic was on when, with what it was built from."""

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
