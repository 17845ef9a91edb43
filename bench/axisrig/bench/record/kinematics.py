"""What a run leaves of kinematics, and of where 3D distance control acted."""

from dataclasses import dataclass

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class KinematicChange(Frozen):
    """The kinematic of the channel from a SYNC on (#TRAFO).

    ids: of its steps, none while it is off. program: what the program wrote into
    V.G.KIN_STEP[step].ID[id].PARAM[index], as (step, id, index, value). tool_mm: length of the
    tool.
    """

    time_ns: TimeNs
    ids: tuple[int, ...] = ()
    program: tuple[tuple[int, int, int, float], ...] = ()
    tool_mm: float = 0.0


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
